"""Mesh of Gmsh: nodes, elements of the named surfaces, edges of the named lines, named points."""
import multiprocessing
import re
from collections import Counter
from dataclasses import dataclass, field

import gmsh

from .faults import Faults, Rejected, listed, spot

#: Corners and nodes of the Gmsh element types that have a card, by their number.
SURFACES = {2: (3, 3), 3: (4, 4), 9: (3, 6), 16: (4, 8)}
LINES = {1: 2, 8: 3}
NAMES = {10: "quadrilaterals of nine nodes"}
POINT, LINE, SURFACE = 0, 1, 2
DIMENSIONS = {"point": POINT, "curve": LINE, "surface": SURFACE}
KIND = {POINT: "Physical Point", LINE: "Physical Curve", SURFACE: "Physical Surface"}


@dataclass
class Mesh:
    file: str = ""
    place: dict = field(default_factory=dict)      # node: (x, y, z)
    bodies: dict = field(default_factory=dict)     # surface: elements, each (corners, nodes), counterclockwise
    lines: dict = field(default_factory=dict)      # line: edges, each (start, end) or (start, end, mid-side node)
    points: dict = field(default_factory=dict)     # point: nodes

    def sides(self):
        """The bodies' elements at each pair of corners that an edge joins: (body, number in the body, mid-side node or None)."""
        found = {}
        for name, elements in self.bodies.items():
            for k, (corners, nodes) in enumerate(elements):
                for i in range(corners):
                    middle = nodes[corners + i] if len(nodes) > corners else None
                    found.setdefault(frozenset((nodes[i], nodes[(i + 1) % corners])), []).append((name, k, middle))
        return found


def read_mesh(path, faults: Faults):
    """Read the mesh of a .msh, or mesh a .geo: in a separate process, which `Exit;` in a drawing ends."""
    check_file(path, faults)
    receiver, sender = multiprocessing.Pipe(duplex=False)
    child = multiprocessing.get_context("fork").Process(target=send_mesh, args=(path, faults, sender))
    child.start()
    sender.close()
    try:
        mesh, faults.errors, faults.notes, failed = receiver.recv()
    except EOFError:
        mesh, failed = None, ""
    child.join()
    if failed:
        raise RuntimeError(failed)
    if mesh is None and not faults.errors:
        how = f"signal {-child.exitcode}" if child.exitcode < 0 else f"exit status {child.exitcode}"
        faults.add("mesh", f"{path.name} ends Gmsh before the mesh is complete ({how})", "correct the drawing until Gmsh itself meshes it, without Exit;")
    faults.end_stage()
    return mesh


def send_mesh(path, faults, sender):
    """The mesh, or None, with the faults, and failures of this program."""
    mesh, failed = None, ""
    try:
        mesh = mesh_of(path, faults)
    except Rejected:
        pass
    except Exception as error:   # the waiting process reports it
        failed = f"{type(error).__name__}: {error}"
    sender.send((mesh, faults.errors, faults.notes, failed))


def check_file(path, faults):
    """Checks without Gmsh."""
    text = b""
    if path.suffix.lower() not in (".geo", ".msh"):
        faults.add("mesh", f"{path.name} is neither .geo nor .msh", "give a script or a mesh of Gmsh")
    elif not path.is_file():
        beside = sorted(p.name for p in path.parent.glob("*") if p.suffix in (".geo", ".msh"))
        faults.add("mesh", f"there is no file {path.name} beside the model file", f"use one of: {listed(beside)}")
    else:
        try:
            text = path.read_bytes()
        except OSError as error:
            faults.add("mesh", f"{path.name} cannot be read: {error.strerror}", "make it readable")
    faults.end_stage()
    if path.suffix.lower() == ".geo" and text.rpartition(b"\n")[2].count(b";") > 1:
        faults.note("mesh", f"the last line of {path.name} does not end with a line break: Gmsh reads only the first of its commands")


def is_old(path):
    """A mesh in MSH 1 or 2: elements have their group beside them, and are repeated for each group."""
    with open(path, "rb") as file:
        head = file.read(100).split()
    return path.suffix.lower() == ".msh" and (head[:1] == [b"$NOD"] or head[:1] == [b"$MeshFormat"] and head[1:2] < [b"3"])


def mesh_of(path, faults):
    gmsh.initialize(["gmsh"], readConfigFiles=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.logger.start()
        open_file(path, faults)
        return collect(path, faults)
    finally:
        gmsh.finalize()


def open_file(path, faults):
    failed = ""
    try:
        gmsh.open(str(path))
        if path.suffix.lower() == ".geo" and len(gmsh.model.mesh.getElements(SURFACE)[0]) == 0:
            gmsh.model.mesh.generate(2)
    except Exception as error:   # Gmsh raises no more specific exceptions
        failed = str(error)
    log = gmsh.logger.get()
    told = [line for line in log if line.startswith("Error")] or ([failed] if failed else [])
    for line in told[:3]:   # one mistake makes Gmsh report several errors
        match = re.fullmatch(r"(?:Error\s*: )?(?:'.*?', line (\d+): )?(.*)", line, re.DOTALL)
        faults.add("mesh", f"{path.name}{f', line {match[1]}' if match[1] else ''}: Gmsh says: {match[2]}",
                   "correct the drawing until Gmsh itself opens and meshes it without an error")
    for line in log:
        check_warning(path, line, faults)
    faults.end_stage()


def check_warning(path, line, faults):
    """A part that Gmsh leaves out of a group would be missing in a contact or a support, and change the answer."""
    match = re.fullmatch(r"Warning\s*: (.*)", line, re.DOTALL)
    lost = match and re.fullmatch(r"Skipping unknown (\w+) (\d+) in physical (\w+) (\d+)", match[1])
    if lost:
        kind, entity, dimension, group = lost.groups()
        name = gmsh.model.getPhysicalName(DIMENSIONS.get(dimension, POINT), int(group)) or group
        faults.add("mesh", f"{path.name} has no {kind} {entity}, which its Physical {dimension.capitalize()} '{name}' names",
                   f"name {kind}s of the drawing; give each body in contact its own: no Coherence, no BooleanFragments")
    elif match:
        faults.note("mesh", f"{path.name}: Gmsh warns: {match[1]}")


def collect(path, faults):
    mesh = Mesh(path.name)
    for dimension in (LINE, SURFACE):
        check_parts(path, dimension, faults)
    tags, values, _ = gmsh.model.mesh.getNodes()
    mesh.place = {int(tag): tuple(float(v) for v in values[3 * i:3 * i + 3]) for i, tag in enumerate(tags)}
    check_groups(mesh, faults)
    owner = {}
    for name, entities in groups(SURFACE):
        mesh.bodies[name] = [element for entity in entities for element in surface(entity, mesh, name, faults)]
        for entity in entities:
            if owner.setdefault(entity, name) != name:
                faults.add("mesh", f"surface {entity} of {path.name} is in two groups: {owner[entity]}, {name}", "put it in one group only")
    for name, entities in groups(LINE):
        mesh.lines[name] = list({frozenset(side): side for entity in entities for side in line(entity)}.values())
    for name, entities in groups(POINT):
        mesh.points[name] = [int(tag) for entity in entities for tag in gmsh.model.mesh.getNodes(POINT, entity)[0]]
    faults.end_stage()
    return mesh


def groups(dimension):
    """(name, entities) of each named group; each entity once, in either direction."""
    found = {}
    for _, tag in gmsh.model.getPhysicalGroups(dimension):
        name = gmsh.model.getPhysicalName(dimension, tag)
        if name:
            found.setdefault(name, {}).update((abs(int(e)), None) for e in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag))
    return found.items()


def check_groups(mesh, faults):
    """Surfaces without a group, groups without a name."""
    grouped = {abs(int(e)) for _, tag in gmsh.model.getPhysicalGroups(SURFACE) for e in gmsh.model.getEntitiesForPhysicalGroup(SURFACE, tag)}
    for dimension, tag in gmsh.model.getPhysicalGroups():
        if dimension in KIND and not gmsh.model.getPhysicalName(dimension, tag):
            said = KIND[dimension]
            if dimension == SURFACE:
                faults.add("mesh", f"{said}({tag}) of {mesh.file} has no name", f'{said}("name") = ' + "{...};")
            else:
                faults.note("mesh", f"{said}({tag}) of {mesh.file} has no name and is ignored")
        if dimension == 3:
            faults.add("mesh", f"{mesh.file} has a Physical Volume", "use surfaces in the plane z = 0 as bodies")
    if not grouped:
        faults.add("mesh", f"{mesh.file} has no Physical Surface, so there are no bodies", 'Physical Surface("name") = {...};')
    for _, entity in gmsh.model.getEntities(SURFACE):
        if grouped and entity not in grouped:
            faults.note("mesh", f"surface {entity} of {mesh.file} is in no Physical Surface and is left out")


def check_parts(path, dimension, faults):
    """In an old mesh each element of a curve or surface must exist for each of its groups: Gmsh gives a group the whole curve."""
    for _, entity in gmsh.model.getEntities(dimension):
        groups_of = gmsh.model.getPhysicalGroupsForEntity(dimension, entity)
        times = Counter()
        for kind, tags, nodes in zip(*gmsh.model.mesh.getElements(dimension, entity)):
            count = len(nodes) // max(len(tags), 1)
            times.update(frozenset(map(int, nodes[count * i:count * (i + 1)])) for i in range(len(tags)))
        old = is_old(path) or any(number > 1 for number in times.values())
        if old and len(groups_of) > 1 and set(times.values()) - {len(groups_of)}:
            names = [gmsh.model.getPhysicalName(dimension, group) or str(group) for group in groups_of]
            faults.add("mesh", f"{('curve', 'surface')[dimension - 1]} {entity} of {path.name} is in the groups {listed(names)}, but not all of its "
                       "elements are in all of them", "give each curve and surface its own number, the second tag of its elements in MSH 2, "
                       "as Gmsh itself writes it; or use MSH 4.1")


def surface(entity, mesh, name, faults):
    """Elements of a surface, counterclockwise, each once."""
    found = {}
    for kind, tags, nodes in zip(*gmsh.model.mesh.getElements(SURFACE, entity)):
        if int(kind) not in SURFACES:
            said = NAMES.get(int(kind)) or gmsh.model.mesh.getElementProperties(int(kind))[0]
            faults.add(f"[body.{name}]", f"{len(tags)} of its elements in {mesh.file} are {said}, which epcont does not support",
                       "use triangles of three or six nodes, quadrilaterals of four (Mesh.ElementOrder = 1) or eight "
                       "(Mesh.SecondOrderIncomplete = 1)")
            continue
        corners, count = SURFACES[int(kind)]
        for i in range(len(tags)):
            own = [int(node) for node in nodes[count * i:count * (i + 1)]]
            found.setdefault(frozenset(own), (corners, turned(own, corners, mesh.place)))
    return found.values()


def turned(nodes, corners, place):
    """The nodes counterclockwise from the same first corner: corners, then mid-side nodes."""
    x = [place[node] for node in nodes[:corners]]
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(x, x[1:] + x[:1]))
    if area >= 0.0:
        return nodes
    return nodes[:1] + nodes[1:corners][::-1] + nodes[corners:][::-1]


def line(entity):
    """Edges of a curve; those with more than three nodes belong to surfaces that are rejected."""
    for kind, tags, nodes in zip(*gmsh.model.mesh.getElements(LINE, entity)):
        count = LINES.get(int(kind), 0)
        for i in range(len(tags) if count else 0):
            yield tuple(int(node) for node in nodes[count * i:count * (i + 1)])


def describe(mesh, nodes):
    """Positions of the first few nodes."""
    return ", ".join(spot(mesh.place[node]) for node in nodes[:3]) + (", ..." if len(nodes) > 3 else "")
