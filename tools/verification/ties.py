"""Ties between DOFs, from the displacements in the tables: rotations of RBE2, MPC, springs. A DOF is (node, component): 0 and 1
along x and y, 2 the rotation of the master node of an RBE2."""
import math


def angle(scene, u, master):
    """The rotation that gives the displacement of the farthest dependent node, and its lever arm."""
    far = max((node for node, c in scene.sums if (master, 2) in scene.sums[node, c]), key=lambda node: math.dist(scene.x[node], scene.x[master]))
    arm, moved = ([values[far][c] - values[master][c] for c in (0, 1)] for values in (scene.x, u))
    squared = arm[0] ** 2 + arm[1] ** 2
    return (arm[0] * moved[1] - arm[1] * moved[0]) / squared, math.sqrt(squared)


def pull_springs(scene, u, rest, magnitude, stored):
    """Forces of ties by id; they are added to the nodal forces, to the sums of magnitudes at nodes, and to the stored work."""
    pulls = {}
    for number, stiffness, ends in scene.springs:
        stretch = math.fsum(sign * u[end[0]][end[1]] for sign, end in zip((-1.0, 1.0), ends) if end)
        pulls[number] = stiffness * stretch
        stored.append(stiffness * stretch * stretch)
        for sign, end in zip((-1.0, 1.0), ends):
            if end:
                rest.setdefault(end, []).append(-sign * pulls[number])
                magnitude.setdefault(end[0], []).append(abs(pulls[number]))
    return pulls


def gather(scene, rest, moments):
    """Forces on independent DOFs, and moments on rotations, from the forces on all DOFs."""
    gathered = {(master, 2): [moment] for master, moment in scene.moment.items()}
    for master, moment in moments.items():
        gathered.setdefault((master, 2), []).append(moment)
    for dof, values in rest.items():
        for master, weight in scene.terms.get(dof, {dof: 1.0}).items():
            gathered.setdefault(master, []).extend(weight * value for value in values)
    return gathered


def tied_cells(scene, tables, found, rounding, component, column):
    """Cells of a column of displacements: dependent DOFs from their terms."""
    for (node, c), terms in scene.terms.items():
        if c == component:
            parts = [weight * (found.angle[master] if k == 2 else float(tables.nodes[master][("ux", "uy")[k]])) for (master, k), weight in terms.items()]
            yield node, math.fsum(parts), tables.nodes[node][column], rounding * (found.length + math.fsum(map(abs, parts)))
