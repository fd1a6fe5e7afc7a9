"""Recompute the values of a certificate from a model and the tables of its run, and compare them with the program's own."""
import math
from dataclasses import dataclass, field

from deck import DeckError, at, integer, real
from kinds import KINDS
from pressures import pressures
from verification.elements import free_strains, places, strain_of, unit_strains
from verification.material import respond, von_mises
from verification.ties import angle, gather, pull_springs

# Names of the values in the summary; the keys are used here.
KEYS = {
    "equilibrium": "equilibrium_residual",
    "smallest_force": "smallest_force",
    "smallest_gap": "smallest_gap",
    "product": "largest_force_gap_product",
    "off_curve": "stress_off_curve",
    "energy": "energy_balance",
}


# For a force: sums over some elements of products with the displacements of up to six nodes, which are themselves rounded.
ROUNDINGS = 128 * 2.0 ** -52
# Residuals of freely expanding bodies are compared with this fraction of their stress if they were fixed.
PART_OF_HELD = 1e-3


@dataclass
class Element:
    """Stresses from its displacements, means over its points by volume. `change`: difference between the stress in the table and these;
    `noise`: strain error due to the rounding of the displacements; `edge`: distance of a point from its yield stress, divided by it."""
    stress: list
    change: list
    scales: list     # von Mises stress on the curve at each point
    limit: float     # yield stress; None if elastic
    equivalent: float
    peak: float      # largest equivalent stress of a point
    at: list         # coordinates of the points, with their equivalent stresses
    total: float
    secant: float
    plastic: bool
    edge: float
    noise: float
    largest: float   # stress of a point
    points: int
    inelastic: list  # thermal and plastic strains of the points

    def scale(self, largest, which=max):
        """Reference of the stress error: the stress on the curve, or the yield stress if not yielded; at most the largest stress of the model."""
        return max(which(self.scales), min(self.limit, largest)) if self.limit else largest

    def off_curve(self, largest):
        """Von Mises stress of the change, and its hydrostatic part, which the curve does not affect, over the largest stress."""
        if not self.limit:
            return max(map(abs, self.change)) / (largest or 1.0)
        return max(von_mises(self.change) / (self.scale(largest) or 1.0), abs(math.fsum(self.change[:3])) / 3 / (largest or 1.0))


@dataclass
class Recomputed:
    figures: dict = field(default_factory=dict)
    force: float = 0.0       # scales
    length: float = 0.0
    scale: float = 0.0       # of nodal forces
    spread: float = 0.0      # largest error in the column of gaps
    lost: float = 0.0        # fraction of the stresses and forces that is lost if a large prescribed rigid-body displacement leaves few digits for the strains
    most: float = 0.0        # largest possible force of the largest stress, over the scale
    stress: float = 0.0      # largest
    released: list = field(default_factory=list)   # work of the stresses on the thermal and plastic strains
    held_work: list = field(default_factory=list)  # of stresses, and the largest force, if these strains were fully restrained
    held_force: float = 0.0
    elements: dict = field(default_factory=dict)
    gaps: dict = field(default_factory=dict)
    pulls: dict = field(default_factory=dict)      # of springs
    angle: dict = field(default_factory=dict)      # of rotating master nodes
    arm: dict = field(default_factory=dict)        # largest value of each
    tangents: list = field(default_factory=list)   # friction force, its limit, tangential displacement, row of friction.csv, normal force, shear
    moment: dict = field(default_factory=dict)     # of their supports


def recompute_element(scene, tables, element, moved):
    """Element with its points, strains, and their stresses consistent with the means in the table. With flow theory, the independent
    solution gives the stresses (history.py).

    The tables hold means over the points of an element; the stress error of each point is assumed to be that of the mean."""
    name, nodes, section = scene.element[element]
    points = unit_strains(name, [scene.x[node] for node in nodes], section.thickness, section.plane_stress)
    strains = [strain_of(unit, moved, section.thickness is None) for _, unit in points]
    free = free_strains(name, nodes, section, scene.temperature, [volume for volume, _ in points])
    if scene.end:
        found, plastic = scene.end.points[element], scene.end.plastic[element]
    else:
        beyond = [[e - own for e in strain[:3]] + strain[3:] for strain, own in zip(strains, free)]
        found = [respond(strain, section.young, section.nu, section.plane_stress, section.points, scene.paper) for strain in beyond]
        plastic = [[0.0] * 4] * len(found)
    whole = math.fsum(volume for volume, _ in points)

    def mean(values):
        return math.fsum(volume * value for (volume, _), value in zip(points, values)) / whole

    own = [mean(stress[i] for stress, _, _ in found) for i in range(4)]
    change = [float(tables.elements[element][key]) - value for key, value in zip(("sx", "sy", "sz", "txy"), own)]
    stresses = [[s + c for s, c in zip(stress, change)] for stress, _, _ in found]
    limit = section.points[1][0] if section.points else math.inf
    steepest = max(abs(v) for _, unit in points for of in unit for each in of for v in each)
    equivalent = [von_mises(stress) for stress in stresses]
    on_curve = [von_mises(stress) for stress, _, _ in found]
    result = Element(own, change, on_curve, section.points[1][1] if section.points else None, mean(equivalent), max(equivalent),
                     list(zip(places(name, [scene.x[node] for node in nodes]), equivalent)), mean(total for _, total, _ in found), mean(secant for _, _, secant in found),
                     any(total > limit for _, total, _ in found) or any(map(any, plastic)), min(abs(total / limit - 1.0) for _, total, _ in found),
                     ROUNDINGS * steepest * max(abs(v) for pair in moved for v in pair),
                     max(abs(v) for stress in stresses for v in stress), len(points),
                     [[e + own for e in strain[:3]] + strain[3:] for strain, own in zip(plastic, free)])
    return result, points, strains, stresses, whole * steepest


def add_elements(scene, tables, u, rest, result):
    """Subtract the nodal forces of the stresses from `rest`. Return the largest sum of element forces at a node, the stored work, the stress of each
    element due to the rounding of the displacements, the largest force due to it, and the largest force of a unit stress."""
    magnitude, stored, lost, lost_force, reach = {}, [], {}, 0.0, 0.0
    for element, (_, nodes, section) in scene.element.items():
        own, points, strains, stresses, size = recompute_element(scene, tables, element, [u[node] for node in nodes])
        result.elements[element] = own
        noise = own.noise * section.young / (1.0 if section.plane_stress else 1.0 - 2.0 * section.nu)
        lost[element], lost_force, reach = noise, max(lost_force, noise * size), max(reach, size)
        result.stress = max(result.stress, own.largest, PART_OF_HELD * held_stress(scene, nodes, section))
        for (volume, _), stress, strain in zip(points, stresses, own.inelastic):
            result.released.append(volume * math.fsum(e * s for e, s in zip(strain, stress)))
            result.held_work.append(volume * section.young * max(map(abs, strain)) ** 2)
        for k in range(len(nodes)):
            sums = [math.fsum(volume * section.young * abs(sum(e * own for e, own in zip(strain, unit[k][c])))
                              for (volume, unit), strain in zip(points, own.inelastic)) for c in (0, 1)]
            result.held_force = max(result.held_force, *sums)
        force = [[[], []] for _ in nodes]
        for (volume, unit), strain, stress in zip(points, strains, stresses):
            stored.append(volume * math.fsum(s * e for s, e in zip(stress, strain)))
            for of, sums in zip(unit, force):
                for c in (0, 1):
                    sums[c].append(volume * sum(s * e for s, e in zip(stress, of[c])))
        for node, parts in zip(nodes, force):
            sums = [math.fsum(parts[c]) for c in (0, 1)]
            for c in (0, 1):
                rest.setdefault((node, c), []).append(-sums[c])
            magnitude.setdefault(node, []).append(max(map(abs, sums)))
    result.pulls = pull_springs(scene, u, rest, magnitude, stored)
    return max((math.fsum(m) for m in magnitude.values()), default=0.0), stored, lost, lost_force, reach


def held_stress(scene, nodes, section):
    """Stress along one axis if thermal expansion were fully restrained."""
    if scene.temperature is None:
        return 0.0
    return section.young * max(abs(section.expansion[0] * (scene.temperature(node) - section.expansion[1])) for node in nodes)


def recompute(scene, tables):
    """Recompute all values of the certificate, from displacements, forces, reactions and stresses."""
    if scene.deck.is_flow and not scene.end:
        raise DeckError("flow theory: stresses depend on all increments, and tables hold only the last one")
    result = Recomputed()
    u = {node: (float(row["ux"]), float(row["uy"])) for node, row in tables.nodes.items()}
    rest, works, given = {}, [], []
    element_force, stored, lost, lost_force, reach = add_elements(scene, tables, u, rest, result)
    for (node, i), values in scene.load.items():
        rest.setdefault((node, i), []).extend(values)
        works.append(math.fsum(values) * u[node][i])
    for node, row in tables.nodes.items():
        for i, key in enumerate(("rx", "ry")):
            rest.setdefault((node, i), []).append(float(row[key]))
            works.append(float(row[key]) * u[node][i])
    forces, gaps = [], []
    for name, pair in scene.pair.items():
        rubbed = tables.friction.get(name)
        friction = float(rubbed["friction_force"]) if rubbed else 0.0
        force = float(tables.contact[name]["force"])
        moved = math.fsum(w * u[node][i] * pair.normal[i] for node, w in pair.weights.items() for i in (0, 1))
        forces.append(force)
        gaps.append(pair.initial + moved)
        result.gaps[name] = gaps[-1]
        result.spread = max(result.spread, abs(gaps[-1] - float(tables.contact[name]["gap"])))
        works.append(force * moved)
        for node, w in pair.weights.items():
            for i in (0, 1):
                rest.setdefault((node, i), []).append(w * (force * pair.normal[i] + friction * pair.tangent[i]))
        if rubbed:
            moved = math.fsum(w * u[node][i] * pair.tangent[i] for node, w in pair.weights.items() for i in (0, 1))
            works.append(friction * moved)
            pressure = float(tables.contact[name]["pressure"] or 0.0)
            result.tangents.append((friction, float(rubbed["friction"]) * force, moved, rubbed, force, friction / force * pressure if force else 0.0))
    found = {master: angle(scene, u, master) for master in scene.rotating}
    result.angle, result.arm = ({master: pair[k] for master, pair in found.items()} for k in (0, 1))
    result.moment = {master: -math.fsum(gather(scene, rest, {}).get((master, 2), [])) for master in scene.rotating if (master, 2) in scene.held}
    works += [moment * result.angle[master] for moments in (scene.moment, result.moment) for master, moment in moments.items()]
    gathered = gather(scene, rest, result.moment)
    loads = [abs(math.fsum(values)) for values in scene.load.values()]
    result.force = max([abs(f) for f in forces] + loads, default=0.0)
    result.length = max([math.hypot(*v) for v in u.values()] + [abs(pair.initial) for pair in scene.pair.values()], default=0.0)
    scale = max(element_force, result.force, PART_OF_HELD * result.held_force)
    terms = math.fsum(map(abs, works)) + abs(math.fsum(stored)) + PART_OF_HELD * math.fsum(result.held_work)
    result.figures = {
        "equilibrium": max((abs(math.fsum(v)) / (result.arm[node] if c == 2 else 1.0) for (node, c), v in gathered.items()), default=0.0) / (scale or 1.0),
        "smallest_force": min(forces, default=0.0),
        "smallest_gap": min(gaps, default=0.0),
        "product": max((abs(f * g) for f, g in zip(forces, gaps)), default=0.0),
        "off_curve": max((own.off_curve(result.stress) for own in result.elements.values()), default=0.0),
        "energy": max(abs(math.fsum(works) - math.fsum(stored)), math.fsum(result.released) - math.fsum(stored)) / (terms or 1.0),
    }
    result.lost = max([part(lost_force, scale)] + [part(lost[element], own.scale(result.stress, min)) for element, own in result.elements.items()])
    result.scale = scale
    result.most = result.stress * reach / (scale or 1.0)
    return result


def part(lost, of):
    return lost / of if lost < of else math.inf if lost > 0.0 else 0.0


def pressure_error(scene, tables):
    """Largest pressure recomputed from the forces (None if pairs in contact have no pressure), and the largest difference from the table."""
    rows = [tables.contact[name] for name in scene.pair]
    number = {name: k for k, name in enumerate(scene.pair)}
    ours = pressures(scene.side, scene.x, scene.held, scene.leader, [(pair.node, pair.normal, pair.weights) for pair in scene.pair.values()],
                     [[number[name] for name in contact] for contact in scene.contacts],
                     [float(row["force"]) for row in rows], [row["status"] == "touching" for row in rows],
                     {number[name]: pair.stands_on for name, pair in scene.pair.items() if pair.stands_on})
    # A pressure that is computed as negative is not in the table.
    both = [(max(p or 0.0, 0.0), float(row["pressure"] or 0.0)) for p, row in zip(ours, rows)]
    touching = [p for p, row in zip(ours, rows) if row["status"] == "touching"]
    peak = None if touching and all(p is None for p in touching) else max((p for p, _ in both), default=0.0)
    return peak, max((abs(p - told) for p, told in both), default=0.0)


def check(scene, tables, tolerance, found=None):
    """Lines of the report and the number of faults."""
    found = found or recompute(scene, tables)
    figures, force, length, lost = found.figures, found.force, found.length, found.lost
    # The points of an element with several are known only to the stress error of the element's mean.
    sure = all(len(KINDS[name].points) == 1 for name, _, _ in scene.element.values())
    loose = tolerance if sure else max(tolerance, max(1.0, found.most) * (10 * float(tables.summary.get(KEYS["off_curve"], 0.0)) + scene.drift))
    scale = {"smallest_force": force, "smallest_gap": length, "product": force * length}
    bounds = {name: tolerance * scale.get(name, 1.0) for name in KEYS}
    bounds["equilibrium"] = bounds["energy"] = max(loose, lost)
    bounds["off_curve"] = max(tolerance, lost, scene.drift)
    allowed = {**bounds, "off_curve": max(tolerance, scene.off_curve + scene.drift) + 4 * lost}  # a large prescribed displacement leaves no digits in the tables
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
        # The mean of several points has at most the error of the worst; the references of both have the same uncertainty on either side.
        near = ours * (1 - 2 * float(told)) <= float(told) + bounds[name] and float(told) <= allowed[name] \
            if name == "off_curve" and not sure else abs(apart) <= bounds[name]
        line(key, ours, told, valid and near)
    line("gap column, largest error", found.spread, "", found.spread <= tolerance * length)
    if scene.pair:
        total = math.fsum(float(row["force"]) for row in tables.contact.values())
        told = tables.summary.get("total_contact_force", "nan")
        line("total_contact_force", total, told, abs(total - float(told)) <= tolerance * (total or 1.0))
        peak, worst = pressure_error(scene, tables)
        told = tables.summary.get("max_pressure", "nan")
        good = told == "" if peak is None else told != "" and abs(peak - float(told)) <= tolerance * (peak or 1.0)
        line("max_pressure", math.nan if peak is None else peak, told, good)
        line("pressure column, largest error", worst, "", worst <= tolerance * (peak or 1.0))
    for each in friction_lines(scene, found, tables, tolerance):
        line(*each)
    for key, ours, small in [*approaches(scene, tables, found), *of_ties(scene, found)]:
        told = tables.summary.get(key, "nan")
        line(key, ours, told, abs(ours - float(told)) <= tolerance * small)
    return lines, faults


def friction_lines(scene, found, tables, tolerance):
    """(name, value, the program's, agrees) of the friction: law, sums, counts, and columns of its table."""
    rows, bound = found.tangents, tolerance * found.force
    if not rows:
        return
    shear = max(abs(row[5]) for row in rows)
    told = tables.summary.get("max_shear", "nan")
    yield "max_shear", shear, told, abs(shear - float(told)) <= tolerance * shear
    for key, ours in (("total_friction_force", math.fsum(abs(force) for force, *_ in rows)),
                      ("friction_above_limit", max(0.0, *(abs(row[0]) - row[1] for row in rows)))):
        told = tables.summary.get(key, "nan")
        yield key, ours, told, abs(ours - float(told)) <= bound and (key != "friction_above_limit" or ours <= bound)
    for key, word in (("pairs_sticking", "sticks"), ("pairs_slipping", "slips")):
        ours, told = sum(row[3]["state"] == word for row in rows), tables.summary.get(key, "missing")
        yield key, ours, told, told == str(ours)
    given = {real(at(c, k)) for name, k in (("PGAP", 7), ("BFRIC", 4)) for c in scene.deck.of(name)}
    strange = sum(float(row[3]["friction"]) not in given for row in rows)
    yield "friction coefficients not in the deck", strange, "", not strange
    for column, number, small in (("limit", 1, bound), ("slid", 2, tolerance * found.length), ("force", 4, bound),
                                  ("shear", 5, tolerance * shear)):
        worst = max(abs(row[number] - float(row[3][column] or 0.0)) for row in rows)
        yield f"friction {column}, largest error", worst, "", worst <= small
    worst = max((row[1] - abs(row[0]) for row in rows if row[3]["state"] == "slips"), default=0.0)
    yield "friction of slipping pairs", worst, "", worst <= bound
    steps = [row for _, row in tables.rows(tables.path("increments"))] if tables.path("increments").exists() else []
    if not steps:
        return
    end = {**tables.summary, "increment": str(len(steps)), "friction_force": tables.summary.get("total_friction_force"),
           "approach": next((value for key, value in tables.summary.items() if key.startswith("approach_")), "")}
    for column, told in steps[-1].items():
        if column in end:
            yield f"increments {column}, last", float(end[column] or "nan"), told, told == end[column]
    start = tables.friction_before() if len(steps) == 1 else None   # the tables hold the ends of load cases only
    if start is None:
        return
    slips = [(start.get(name, (0.0, 0.0)), float(row["friction_force"]), float(row["slid"])) for name, row in tables.friction.items()]
    terms = math.fsum(abs(force) + abs(one) for (one, _), force, _ in slips) * found.length
    for column, ours in (("friction_work", math.fsum((one + force) / 2 * (begun - slid) for (one, begun), force, slid in slips)),
                         ("dissipated", math.fsum(force * (begun - slid) for (_, begun), force, slid in slips))):
        if column == "friction_work" or not scene.end:   # yielding dissipates, too
            yield f"increments {column}", ours, steps[0][column], abs(ours - float(steps[0][column])) <= tolerance * abs(ours) + ROUNDINGS * terms


def approaches(scene, tables, found):
    """(key, value, its scale) of each SUPORT DOF that is not fixed."""
    for c in scene.deck.of("SUPORT"):
        for i in range(1, len(c) - 1, 2):
            for digit in (c[i + 1] if c[i] else ""):
                node, component = integer(c[i]), {"1": 0, "2": 1, "6": 2}.get(digit)
                if component == 2 and node in found.angle and (node, 2) not in scene.held:
                    yield f"approach_{node}_6", found.angle[node], abs(found.angle[node]) + found.length / found.arm[node]
                elif component in (0, 1) and (node, component) not in scene.held:
                    yield f"approach_{node}_{digit}", float(tables.nodes[node][("ux", "uy")[component]]), found.length


def of_ties(scene, found):
    """The same for rotating master nodes and springs."""
    for master, turned in found.angle.items():
        yield f"angle_{master}", turned, abs(turned) + found.length / found.arm[master]
        if master in found.moment:
            yield f"moment_{master}", found.moment[master], abs(found.moment[master]) + found.scale * found.arm[master]
    for number, stiffness, _ in scene.springs:
        yield f"spring_{number}", found.pulls[number], abs(found.pulls[number]) + stiffness * found.length
