"""The figures of a certificate, recomputed from a scene and the tables of its run, and held against the program's own."""
import math
import pathlib

import tables
from deck import integer
from kinds import KINDS
from pressures import pressures
from verification.elements import strain_of, unit_strains
from verification.material import stress_of

# Names of the figures in the summary; the key on the left is ours.
KEYS = {
    "equilibrium": "equilibrium_residual",
    "smallest_force": "smallest_force",
    "smallest_gap": "smallest_gap",
    "product": "largest_force_gap_product",
    "off_curve": "stress_off_curve",
    "energy": "energy_balance",
}


# Of a force: sums over some elements of products with the displacements of up to six nodes, which are rounded themselves.
ROUNDINGS = 128 * 2.0 ** -52


class TableFault(ValueError):
    """A table that cannot be what epcont has written for the deck: which, where, why."""


class Tables:
    def __init__(self, directory, stem):
        self.directory, self.stem = pathlib.Path(directory), stem
        self.summary = tables.summary(self.path("summary"))
        for key, value in self.summary.items():
            if key in KEYS.values() or key in ("total_contact_force", "max_pressure") or key.startswith("approach_"):
                number(value, self.path("summary"), key)
        self.nodes = self.read("nodes", "node", "ux", "uy", "rx", "ry")
        self.elements = self.read("elements", "element", "sx", "sy", "sz", "txy")
        self.contact = self.read("contact", "pair", "nx", "ny", "force", "gap") if self.path("contact").exists() else {}

    def path(self, name):
        return self.directory / f"{self.stem}.{name}.csv"

    def read(self, name, key, *columns):
        """Rows by number; these columns are numbers."""
        found = {}
        for line, row in enumerate(tables.rows(self.path(name)), 2):
            if None in row.values():
                raise TableFault(f"{self.path(name)}:{line}: the line is cut off")
            for column in (key, *columns):
                number(row.get(column), f"{self.path(name)}:{line}", column)
            found[int(row[key])] = row
        return found

    def hold(self, scene):
        """All that the deck has must be in the tables."""
        for name, what, wanted, found in (("nodes", "node", {node for _, nodes, _ in scene.element.values() for node in nodes}, self.nodes),
                                          ("elements", "element", scene.element, self.elements), ("contact", "pair", scene.pair, self.contact)):
            lacking = sorted(set(wanted) - set(found))
            if lacking:
                raise TableFault(f"{self.path(name)}: no {what} {lacking[0]}: the table of another deck, or cut off")


def number(text, place, name):
    try:
        float(text)
    except (TypeError, ValueError):
        raise TableFault(f"{place}: {name}: {'no such column' if text is None else f'{text!r} is no number'}") from None


def add_elements(scene, tables, u, rest):
    """Nodal forces of the stresses are taken off `rest`. Largest element forces summed at a node, work stored, largest distance
    of a mean stress in the tables from that on the curve (relative), largest stress, the stress and force that rounding of the displacements makes, the
    largest force of a unit stress.

    The tables hold means over the points of an element; what a point has is taken to be off the curve as much as the mean."""
    magnitude, stored, off, largest, lost, lost_force, reach = {}, [], [], 0.0, 0.0, 0.0, 0.0
    for element, (name, nodes, section) in scene.element.items():
        points = unit_strains(name, [scene.x[node] for node in nodes], section.thickness, section.plane_stress)
        moved = [u[node] for node in nodes]
        strains = [strain_of(unit, moved, section.thickness is None) for _, unit in points]
        stresses = [stress_of(strain, section.young, section.nu, section.plane_stress, section.points, scene.paper)
                    for strain in strains]
        whole = math.fsum(volume for volume, _ in points)
        told = [float(tables.elements[element][key]) for key in ("sx", "sy", "sz", "txy")]
        change = [t - math.fsum(volume * s[i] for (volume, _), s in zip(points, stresses)) / whole for i, t in enumerate(told)]
        off.append((change, max(map(von_mises, stresses)), section.points))
        stiffness = section.young / (1.0 if section.plane_stress else 1.0 - 2.0 * section.nu)
        steepest = max(abs(v) for _, unit in points for of in unit for each in of for v in each)
        own = ROUNDINGS * stiffness * steepest * max(abs(v) for pair in moved for v in pair)
        lost, lost_force = max(lost, own), max(lost_force, own * whole * steepest)
        reach = max(reach, whole * steepest)
        force = [[[], []] for _ in nodes]
        for (volume, unit), strain, stress in zip(points, strains, stresses):
            stress = [s + c for s, c in zip(stress, change)]
            largest = max(largest, *map(abs, stress))
            stored.append(volume * math.fsum(s * e for s, e in zip(stress, strain)))
            for of, own in zip(unit, force):
                for c in (0, 1):
                    own[c].append(volume * sum(s * e for s, e in zip(stress, of[c])))
        for node, own in zip(nodes, force):
            sums = [math.fsum(own[c]) for c in (0, 1)]
            for c in (0, 1):
                rest.setdefault((node, c), []).append(-sums[c])
            magnitude.setdefault(node, []).append(max(map(abs, sums)))
    off = max((distance(*each, largest) for each in off), default=0.0)
    return max((math.fsum(m) for m in magnitude.values()), default=0.0), stored, off, largest, lost, lost_force, reach


def von_mises(stress):
    x, y, z, xy = stress
    return math.sqrt(0.5 * ((x - y)**2 + (y - z)**2 + (z - x)**2) + 3 * xy**2)


def distance(change, curve, points, largest):
    """How far a stress is off its curve, `curve` being von Mises stress there. An elastic one: the largest component, of the largest
    stress. A yielding one: von Mises stress, of that of the curve or of the yield stress; and the mean part, of the largest stress."""
    if not points:
        return max(map(abs, change)) / (largest or 1.0)
    scale = max(curve, min(points[1][1], largest))
    return max(von_mises(change) / (scale or 1.0), abs(math.fsum(change[:3])) / 3 / (largest or 1.0))


def recompute(scene, tables):
    """The figures, and the scales of force and length; the largest error in the column of gaps; the part of the stresses and
    forces that is lost, where a travel leaves few digits of the strains; the largest force that the largest stress could make, over
    the scale."""
    u = {node: (float(row["ux"]), float(row["uy"])) for node, row in tables.nodes.items()}
    rest, works, given = {}, [], []
    element_force, stored, off, largest, lost, lost_force, reach = add_elements(scene, tables, u, rest)
    for (node, i), values in scene.load.items():
        rest.setdefault((node, i), []).extend(values)
        works.append(math.fsum(values) * u[node][i])
    for node, row in tables.nodes.items():
        for i, key in enumerate(("rx", "ry")):
            rest.setdefault((node, i), []).append(float(row[key]))
            works.append(float(row[key]) * u[node][i])
    forces, gaps, spread = [], [], 0.0
    for name, pair in scene.pair.items():
        force = float(tables.contact[name]["force"])
        moved = math.fsum(w * u[node][i] * pair.normal[i] for node, w in pair.weights.items() for i in (0, 1))
        forces.append(force)
        gaps.append(pair.initial + moved)
        spread = max(spread, abs(gaps[-1] - float(tables.contact[name]["gap"])))
        works.append(force * moved)
        for node, w in pair.weights.items():
            for i in (0, 1):
                rest.setdefault((node, i), []).append(w * force * pair.normal[i])
    gathered = {}
    for freedom, values in rest.items():
        for _ in range(50):
            freedom = scene.leader.get(freedom, freedom)
        gathered.setdefault(freedom, []).extend(values)
    loads = [abs(math.fsum(values)) for values in scene.load.values()]
    force_scale = max([abs(f) for f in forces] + loads, default=0.0)
    length_scale = max([math.hypot(*v) for v in u.values()] + [abs(pair.initial) for pair in scene.pair.values()], default=0.0)
    scale = max(element_force, force_scale)
    terms = math.fsum(map(abs, works)) + abs(math.fsum(stored))
    figures = {
        "equilibrium": max((abs(math.fsum(v)) for v in gathered.values()), default=0.0) / (scale or 1.0),
        "smallest_force": min(forces, default=0.0),
        "smallest_gap": min(gaps, default=0.0),
        "product": max((abs(f * g) for f, g in zip(forces, gaps)), default=0.0),
        "off_curve": off,
        "energy": max(abs(math.fsum(works) - math.fsum(stored)), -math.fsum(stored)) / (terms or 1.0),
    }
    return figures, force_scale, length_scale, spread, max(part(lost, largest), part(lost_force, scale)), \
        largest * reach / (scale or 1.0)


def part(lost, of):
    return lost / of if lost < of else math.inf if lost > 0.0 else 0.0


def pressure_error(scene, tables):
    """Largest pressure, recomputed from the forces, and the largest difference from the table."""
    rows = [tables.contact[name] for name in scene.pair]
    number = {name: k for k, name in enumerate(scene.pair)}
    ours = pressures(scene.side, scene.x, scene.held, [(pair.node, pair.normal) for pair in scene.pair.values()],
                     [[number[name] for name in contact] for contact in scene.contacts],
                     [float(row["force"]) for row in rows], [row["status"] == "touching" for row in rows])
    # A pressure that comes out below zero is not told.
    both = [(max(p or 0.0, 0.0), float(row["pressure"] or 0.0)) for p, row in zip(ours, rows)]
    return max((p for p, _ in both), default=0.0), max((abs(p - told) for p, told in both), default=0.0)


def check(scene, tables, tolerance):
    """Lines of the report and the number of faults."""
    figures, force, length, spread, lost, most = recompute(scene, tables)
    # The points of an element with several are known only as well as its mean lies on the curve.
    sure = all(len(KINDS[name].points) == 1 for name, _, _ in scene.element.values())
    loose = tolerance if sure else max(tolerance, 10 * max(1.0, most) * float(tables.summary.get(KEYS["off_curve"], 0.0)))
    scale = {"smallest_force": force, "smallest_gap": length, "product": force * length}
    bounds = {name: tolerance * scale.get(name, 1.0) for name in KEYS}
    bounds["equilibrium"] = bounds["energy"] = max(loose, lost)
    bounds["off_curve"] = max(tolerance, lost)
    allowed = {**bounds, "off_curve": max(tolerance, scene.off_curve) + 4 * lost}  # of a travel the tables leave no digits
    lines, faults = [], 0

    def line(name, ours, theirs, good):
        nonlocal faults
        faults += not good
        lines.append(f"{name:30s} {ours:24.16E} {theirs:>26s}  {'ok' if good else 'WRONG'}")

    for name, key in KEYS.items():
        told, ours = tables.summary.get(key), figures[name]
        if told is None:
            line(key, ours, "missing", False)
            continue
        valid = ours >= -bounds[name] if name.startswith("smallest") else ours <= allowed[name]
        apart = float(told) - ours
        # The mean of some points is not farther off than the worst of them; the largest stress, of which both are parts, is known but for
        # as much on either side.
        near = ours * (1 - 2 * float(told)) <= float(told) + bounds[name] and float(told) <= allowed[name] \
            if name == "off_curve" and not sure else abs(apart) <= bounds[name]
        line(key, ours, told, valid and near)
    line("gap column, largest error", spread, "", spread <= tolerance * length)
    if scene.pair:
        total = math.fsum(float(row["force"]) for row in tables.contact.values())
        told = tables.summary.get("total_contact_force", "nan")
        line("total_contact_force", total, told, abs(total - float(told)) <= tolerance * (total or 1.0))
        peak, worst = pressure_error(scene, tables)
        told = tables.summary.get("max_pressure", "nan")
        line("max_pressure", peak, told, abs(peak - float(told)) <= tolerance * (peak or 1.0))
        line("pressure column, largest error", worst, "", worst <= tolerance * (peak or 1.0))
    for c in scene.deck.of("SUPORT"):
        for i in range(1, len(c) - 1, 2):
            for digit in (c[i + 1] if c[i] else ""):
                if digit in "12":
                    key = f"approach_{integer(c[i])}_{digit}"
                    ours = float(tables.nodes[int(c[i])]["ux" if digit == "1" else "uy"])
                    told = tables.summary.get(key, "nan")
                    line(key, ours, told, abs(ours - float(told)) <= tolerance * length)
    return lines, faults
