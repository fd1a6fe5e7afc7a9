"""Find the nodes of the model's names in the mesh's groups, for supports, loads and contacts, or report errors."""
import math

from .faults import likely, listed, spot
from .lines import chains, nodes_of
from .mesh import describe

APART = "give each body its own points and curves: no Coherence, no BooleanFragments, and Geometry.AutoCoherence = 0 in "
NEGLIGIBLE = 1e-9    # relative to the model size: a distance that counts as zero


def check_bodies(scene, mesh, faults):
    """Check surfaces and tables: one each, with supported elements, in the plane."""
    for name in scene.bodies:
        if name not in mesh.bodies:
            faults.add(f"[body.{name}]", f"{mesh.file} has no Physical Surface of that name",
                       f"its surfaces: {listed(mesh.bodies)}{likely(name, mesh.bodies)}")
    for name in mesh.bodies:
        if name not in scene.bodies:
            faults.add("[body]", f"the surface '{name}' of {mesh.file} has no table", f'add [body.{name}] and below it material = "..."')
    faults.go_on()
    for name, elements in mesh.bodies.items():
        if not elements:
            faults.add(f"[body.{name}]", f"the surface has no elements in {mesh.file}", "mesh the surface")
        elif scene.rings and any(corners == 4 for corners, _ in elements):
            faults.add(f"[body.{name}]", "axisymmetric bodies cannot have quadrilaterals", f"remove Recombine Surface from {mesh.file}, or use another kind")
    for side, owners in mesh.sides().items():
        if len({middle for _, _, middle in owners}) > 1:
            faults.add("[body]", f"elements with and without mid-side nodes have a common edge in {mesh.file}, at {describe(mesh, sorted(side))} "
                       f"({listed(sorted({owner[0] for owner in owners}))})", "use one element order for joined bodies (Mesh.ElementOrder)")
            break
    faults.end_stage()
    flatten(scene, mesh, faults)


def flatten(scene, mesh, faults):
    """Nodes of bodies only, with coordinates rounded to twelve digits of the model size: Gmsh writes 22.5049999999934 for 22.505."""
    used = [node for elements in mesh.bodies.values() for _, nodes in elements for node in nodes]
    places = [mesh.place[node] for node in used]
    size = max(max(place[c] for place in places) - min(place[c] for place in places) for c in (0, 1, 2))
    digits = 12 - math.ceil(math.log10(size or 1.0))
    mesh.place = {node: tuple(round(v, digits) + 0.0 for v in mesh.place[node]) for node in dict.fromkeys(used)}
    for name, elements in mesh.bodies.items():
        nodes = list(dict.fromkeys(node for _, own in elements for node in own))
        outside = [node for node in nodes if abs(mesh.place[node][2]) > NEGLIGIBLE * size]
        if outside:
            faults.add(f"[body.{name}]", f"{len(outside)} of its nodes are not in the plane z = 0, the first at {mesh.place[outside[0]]}",
                       f"draw the surface in x and y in {mesh.file}")
        beyond = [node for node in nodes if scene.rings and mesh.place[node][0] < -NEGLIGIBLE * size]
        if beyond:
            farthest = min(mesh.place[node] for node in beyond)
            faults.add(f"[body.{name}]", f"{len(beyond)} of its nodes lie at negative radius, the farthest at {spot(farthest)}",
                       "in axisymmetric models x is the radius, 0 or above, and y the axis: move the body")
    faults.end_stage()


class Groups:
    """Named lines and points; errors name the key of the model that uses them."""

    def __init__(self, mesh, faults):
        self.mesh, self.faults, self.used, self.sides = mesh, faults, set(), mesh.sides()

    def find(self, where, name, points_too=True):
        """Nodes of a line or a point, all of them on bodies; empty after an error."""
        mesh = self.mesh
        self.used.add(name)
        if name in mesh.lines and name in mesh.points and points_too:
            self.faults.add(where, f"{mesh.file} has both a line and a point '{name}'", "give them different names")
            return []
        if name in mesh.lines:
            nodes = nodes_of(mesh.lines[name])
        elif name in mesh.points and points_too:
            nodes = mesh.points[name]
        else:
            self.unknown(where, name, points_too)
            return []
        return [] if self.apart(where, name, nodes) else nodes

    def apart(self, where, name, nodes):
        """Report a group with nodes that are not on bodies, or a line that is not made of element edges with their mid-side nodes."""
        sides = self.mesh.lines[name] if name in self.mesh.lines else []
        owners = {side: self.sides.get(frozenset(side[:2]), []) for side in sides}
        for side, own in owners.items():
            if any((middle,) != (side[2:] or (None,)) for _, _, middle in own):
                what = "two nodes on six-node triangles" if len(side) == 2 else "three nodes on elements without mid-side nodes"
                self.faults.add(where, f"'{name}' has an edge of {what}, at {describe(self.mesh, side[:2])}",
                                f"give lines and surfaces the same order in {self.mesh.file} (Mesh.ElementOrder)")
                return True
        strange = [node for node in nodes if node not in self.mesh.place]
        alone = next((side for side in sides if not owners[side]), None)
        if strange or not nodes:
            what = f"{len(strange)} of the {len(nodes)} nodes of '{name}' are not on a body" if nodes else f"'{name}' has no nodes"
            self.faults.add(where, what, "use the boundary of a named surface; embed points within one by Point{..} In Surface{..} in " + self.mesh.file)
        elif alone:
            self.faults.add(where, f"'{name}' has an edge that no element has, at {describe(self.mesh, alone[:2])}", "draw the line along element edges")
        return bool(strange or not nodes or alone)

    def unknown(self, where, name, points_too):
        mesh = self.mesh
        names = list(mesh.lines) + (list(mesh.points) if points_too else [])
        if name in mesh.bodies:
            what = f"'{name}' is a surface of {mesh.file}"
        elif name in mesh.points:
            what = f"'{name}' is a point of {mesh.file}"
        else:
            what = f"{mesh.file} has no {'line or point' if points_too else 'line'} '{name}'"
        points = f"; its points: {listed(mesh.points)}" if points_too else ""
        self.faults.add(where, what, f"its lines: {listed(mesh.lines)}{points}{likely(name, names)}")

    def boundary(self, where, name):
        """(edge, body, element) of each edge of a line along a boundary; empty after an error."""
        if not self.find(where, name, points_too=False):
            return []
        found = []
        for side in self.mesh.lines[name]:
            owners = self.sides.get(frozenset(side[:2]), [])
            if len(owners) != 1:
                what = "between two elements"
                bodies = f" ({listed(sorted({owner[0] for owner in owners}))})"
                self.faults.add(where, f"'{name}' has an edge {what}{bodies}, at {describe(self.mesh, side[:2])}",
                                "draw the line along the outside; give each body in contact its own curves and points")
                return []
            found.append((side, *owners[0][:2]))
        return found

    def share_nodes(self, where, slave, master):
        """Report bodies in contact that share nodes but no edges."""
        bodies = [{self.sides[frozenset(side[:2])][0][0] for side in self.mesh.lines[name]} for name in (slave, master)]
        for one, other in sorted((one, other) for one in bodies[0] for other in bodies[1] - {one}):
            common = set.intersection(*({node for _, nodes in self.mesh.bodies[name] for node in nodes} for name in (one, other)))
            joined = any({one, other} <= {owner[0] for owner in owners} for owners in self.sides.values())
            if common and not joined:
                self.faults.add(where, f"Gmsh's Coherence has glued '{one}' and '{other}': they share {len(common)} node{'s' * (len(common) != 1)}, the first at "
                                f"{spot(self.mesh.place[min(common)])}", APART + self.mesh.file)
                return True
        return False

    def chain(self, where, name):
        """Nodes of a line in one piece, in order; empty after an error."""
        if not self.boundary(where, name):
            return []
        pieces = chains(self.mesh.lines[name])
        if pieces is not None and len(pieces) == 1:
            return pieces[0]
        if pieces is None:
            self.faults.add(where, f"'{name}' branches", "use one line from end to end")
        else:
            ends = "; ".join(f"{spot(self.mesh.place[piece[0]])} to {spot(self.mesh.place[piece[-1]])}" for piece in pieces[:4])
            self.faults.add(where, f"'{name}' is in {len(pieces)} pieces: {ends}", "make a Physical Curve and a [[contact]] for each piece")
        return []

    def note_unused(self):
        for names, kind in ((self.mesh.lines, "line"), (self.mesh.points, "point")):
            for name in names:
                if name not in self.used:
                    self.faults.note("mesh", f"the {kind} '{name}' of {self.mesh.file} is not used")
