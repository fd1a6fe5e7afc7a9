"""Recompute every column of the tables and every key of the summary, cell by cell; unread ones are listed.

The certificate's tolerance is relative to the largest force or length. A cell's tolerance is relative to the cell itself and to the
terms that it is summed from, so that a small wrong value is found, too.
"""
import math

from tables import rows as table_rows
from verification.material import von_mises
from verification.run import number
from verification.scene import node_of
from verification.ties import tied_cells
from verification.zones import zones

#: Difference of a sum in another order, relative to its largest term, and as a fraction of another tolerance.
ROUNDING, OF_TOLERANCE = 1e-13, 1e-4
#: A residual equals the program's, up to this factor for the order of its sums.
LIKE = 8.0
UNITS = {"status": "", "max_pressure": "force/length2", "total_contact_force": "force", "pairs_in_contact": "", "plastic_elements": "",
         "iterations": "", "pivots": "", "max_equivalent_stress": "force/length2", "max_displacement": "length", "equilibrium_residual": "",
         "smallest_force": "force", "smallest_gap": "length", "largest_force_gap_product": "force*length", "stress_off_curve": "",
         "max_equivalent_stress_element": "", "max_equivalent_stress_x": "length", "max_equivalent_stress_y": "length",
         "lowest_temperature": "temperature", "highest_temperature": "temperature", "curve_tolerance": "", "stress_off_curve_limit": "", "energy_balance": "", "load_factor": "",
         "total_friction_force": "force", "pairs_sticking": "", "pairs_slipping": "", "friction_above_limit": "force"}
#: Values that are only rounding in a valid answer: compared with their tolerance, not digit by digit.
BOUNDS = ("equilibrium_residual", "smallest_force", "smallest_gap", "largest_force_gap_product", "energy_balance", "stress_off_curve_limit",
          "friction_above_limit")


def unit_of(key):
    """Columns and keys that are not read."""
    kind, _, number_of = key.partition("_")
    if kind == "approach":
        return "radian" if number_of.endswith("_6") else "length"
    return UNITS.get(key, {"angle": "radian", "moment": "force*length", "spring": "force"}.get(kind))


class Report:
    """Lines in the form of the certificate's; for each column the cell with the largest difference relative to its tolerance."""

    def __init__(self, rounding):
        self.lines, self.faults, self.rounding = [], 0, rounding

    def line(self, name, ours, told, good):
        self.faults += not good
        shown = f"{ours:24.16E}" if isinstance(ours, float) else f"{str(ours):>24s}"
        self.lines.append(f"{name:30s} {shown} {told:>26s}  {'ok' if good else 'WRONG'}")

    def column(self, name, cells):
        """`cells`: (row, ours, told, allowed); texts must be equal, numbers within the allowed difference."""
        worst = None
        for row, ours, told, allowed in cells:
            if not isinstance(ours, float):
                off = 0.0 if str(ours) == told else math.inf
            elif told == "":
                off = math.inf
            else:
                off = abs(float(told) - ours)
                off = off / allowed if allowed > 0.0 else math.inf if off > 0.0 else 0.0
            if worst is None or off > worst[0]:
                worst = off, row, ours, told
        if worst:
            self.line(f"{name} {worst[1]}", worst[2], worst[3], worst[0] <= 1.0)


def check_columns(scene, tables, found, tolerance):
    """Lines of the report and the number of faults. `found`: the result of recompute."""
    report = Report(max(ROUNDING, OF_TOLERANCE * tolerance))
    check_nodes(report, scene, tables, found, tolerance)
    check_elements(report, scene, tables, found, tolerance)
    if scene.pair:
        check_contact(report, scene, tables, found, tolerance)
        check_zones(report, scene, tables, tolerance)
        check_bodies(report, scene, tables, tolerance)
    check_summary(report, scene, tables, found, tolerance)
    return report.lines, report.faults


def check_nodes(report, scene, tables, found, tolerance):
    rows = tables.nodes
    for c, (place, move, reaction) in enumerate((("x", "ux", "rx"), ("y", "uy", "ry"))):
        report.column(f"nodes {place}", ((n, scene.x[n][c], row[place], 0.0) for n, row in rows.items()))
        # A rigid-body displacement satisfies an MPC to the tolerance of the certificate: the coefficients have the digits of their fields.
        rounding = tolerance if scene.sums else report.rounding
        small = rounding * found.length
        held = [(n, scene.given[n, c], rows[n][move], small) for n in rows if (n, c) in scene.held]
        report.column(f"nodes {move}, held or tied,", held + list(tied_cells(scene, tables, found, rounding, c, move)))
        free = [(n, 0.0, row[reaction], 0.0) for n, row in rows.items() if (n, c) not in scene.held]
        report.column(f"nodes {reaction}, not held,", free)


def check_elements(report, scene, tables, found, tolerance):
    told = float(tables.summary.get("stress_off_curve") or 0.0)
    columns = {name: [] for name in ("x", "y", "sx", "sy", "sz", "txy", "equivalent_stress", "equivalent_strain", "secant_modulus", "state")}

    def put(name, ours, allowed):
        columns.setdefault(name, []).append((element, ours, row[name], allowed))

    for element, own in found.elements.items():
        row, section = tables.elements[element], scene.element[element][2]
        places = [scene.x[node] for node in scene.element[element][1]]
        for c, name in enumerate("xy"):
            put(name, math.fsum(p[c] for p in places) / len(places), report.rounding * max(abs(p[c]) for p in places))
        stiffness = section.young / (1.0 if section.plane_stress else 1.0 - 2.0 * section.nu)
        noise = own.noise * stiffness + report.rounding * own.largest
        # If yielded, or not yet yielded in the last solve, a stress differs from its curve by the iteration error.
        loose = (told + report.rounding + scene.drift) * (own.scale(found.stress) + found.stress) if own.plastic or own.edge < 10 * told else 0.0
        for k, name in enumerate(("sx", "sy", "sz", "txy")):
            put(name, own.stress[k], loose + noise + tolerance * abs(own.stress[k]))
        mean = [float(row[name]) for name in ("sx", "sy", "sz", "txy")]
        ours, allowed = (von_mises(mean), report.rounding * own.largest) if own.points == 1 else (own.equivalent, loose + noise)
        put("equivalent_stress", ours, allowed + tolerance * ours)
        if "max_equivalent_stress" in row:
            peak = ours if own.points == 1 else own.peak
            put("max_equivalent_stress", peak, allowed + tolerance * peak)
        if "max_x" in row:
            # If several points are equally high within their stress errors, any of them counts.
            highest = [place for place, value in own.at if value >= own.peak - 2 * (allowed + tolerance * own.peak)]
            place = min(highest, key=lambda place: math.dist(place, (float(row["max_x"]), float(row["max_y"]))))
            for c, name in enumerate(("max_x", "max_y")):
                put(name, place[c], report.rounding * max(abs(p[c]) for p in places))
        put("equivalent_strain", own.total, own.noise + (tolerance + scene.drift) * own.total)
        part = own.noise / own.total if own.total else 0.0
        put("secant_modulus", own.secant, own.secant * (tolerance + scene.drift + part * (own.plastic or own.edge < part)))
        state = "plastic" if own.plastic else "elastic"
        if own.edge < tolerance + part and row["state"] in ("plastic", "elastic"):
            state = row["state"]   # at the yield stress, within rounding
        put("state", state, 0.0)
    for name, cells in columns.items():
        report.column(f"elements {name}", cells)


def check_contact(report, scene, tables, found, tolerance):
    rows = tables.contact
    size = max(abs(v) for place in scene.x.values() for v in place)

    def column(name, value, small=None, closed=0.0):
        """`value`: expected value of a pair and table value; `small`: largest term of its sum, None if exact; `closed`: tolerance of a cell
        for a pair in contact."""
        cells = []
        for pair, own in scene.pair.items():
            ours, told = value(pair, own), rows[pair][name]
            allowed = 0.0 if small is None else tolerance * abs(ours) + report.rounding * small
            cells.append((pair, ours, told, max(allowed, closed * (rows[pair]["status"] == "touching"))))
        report.column(f"contact {name}", cells)

    column("x", lambda _, own: scene.x[own.ends[1]][0])
    column("y", lambda _, own: scene.x[own.ends[1]][1])
    column("gb", lambda _, own: own.ends[1])
    column("ga", lambda pair, own: int(rows[pair]["ga"]) if near(own, rows[pair]["ga"]) else own.ends[0])
    column("nx", lambda _, own: float(own.normal[0]), 1.0)
    column("ny", lambda _, own: float(own.normal[1]), 1.0)
    column("initial_gap", lambda _, own: own.initial, size)
    column("gap", lambda pair, _: found.gaps[pair], found.length + size, tolerance * found.length)   # as the certificate has it
    states = []
    for pair, row in rows.items():
        word, force, gap = row["status"], float(row["force"]), float(row["gap"])
        # Without force and gap both states are correct.
        sure = "touching" if force > 0.0 else "open" if abs(gap) > report.rounding * (found.length + size) else word if word in ("touching", "open") else "open"
        states.append((pair, sure, word, 0.0))
    report.column("contact status", states)


def near(pair, told):
    """Is it, within rounding, the master node with the largest weight of a pair?"""
    parts = {node: -weight for node, weight in pair.weights.items() if node != pair.ends[1]}
    return parts.get(int(told), 0.0) >= (1 - 1e-9) * max(parts.values())


def check_zones(report, scene, tables, tolerance):
    rows = tables.contact
    touching = {pair: rows[pair]["status"] == "touching" for pair in scene.pair}
    force, pressure = ({pair: float(rows[pair][name] or -1.0) for pair in scene.pair} for name in ("force", "pressure"))
    told = [tables.zones[k] for k in sorted(tables.zones)]
    ours = zones(scene, touching, force, pressure, {(int(row["first_pair"]), int(row["last_pair"])) for row in told})
    report.line("zones", len(ours), str(len(told)), len(ours) == len(told) and sorted(tables.zones) == list(range(1, len(told) + 1)))
    if len(ours) != len(told):
        return
    rank = {pair: k for k, pair in enumerate(scene.pair)}
    for column, attribute in (("first_pair", "first"), ("last_pair", "last"), ("force", "force"), ("max_pressure", "peak"),
                              ("half_width_last_pair", "width"), ("half_width", "half_width")):
        cells = []
        for k, (own, row) in enumerate(zip(ours, told), 1):
            value = getattr(own, attribute)
            value = "" if value is None or attribute == "peak" and value < 0.0 else node_of(value)
            small = math.fsum(abs(force[pair]) for pair in rank) if attribute == "force" else own.width
            cells.append((k, value, row[column], tolerance * abs(value) + report.rounding * small if isinstance(value, float) else 0.0))
        report.column(f"zones {column}", cells)


def check_bodies(report, scene, tables, tolerance):
    """Resultant contact force on each body that has elements."""
    body, bodies = scene.bodies(), {}
    for name, nodes, _ in scene.element.values():
        bodies.setdefault(body[nodes[0]], []).extend(nodes)
    terms = {b: [] for b in bodies}
    for pair, own in scene.pair.items():
        force, friction = float(tables.contact[pair]["force"]), float(tables.friction.get(pair, {}).get("friction_force", 0.0))
        for node, weight in own.weights.items():
            if body[node] in terms:
                terms[body[node]].append([weight * (force * own.normal[c] + friction * own.tangent[c]) for c in (0, 1)])
    order = list(dict.fromkeys(body[node] for node in tables.nodes))   # bodies are numbered by their first nodes, including bodies of single nodes
    firsts = {next(node for node in tables.nodes if body[node] == b): b for b in order if b in bodies}
    told = {int(row["first_node"]): row for row in tables.bodies.values()}
    ours = {order.index(b) + 1: first for first, b in firsts.items()}
    report.line("bodies body, first_node", len(ours), str(len(told)), ours == {number: int(row["first_node"]) for number, row in tables.bodies.items()})
    for c, name in enumerate(("force_x", "force_y")):
        cells = []
        for first, b in firsts.items():
            if first not in told:
                continue
            ours, all_of_it = math.fsum(each[c] for each in terms[b]), math.fsum(math.hypot(*each) for each in terms[b])
            value = "" if c == 0 and scene.has_rings else ours
            cells.append((first, value, told[first][name], tolerance * abs(ours) + report.rounding * all_of_it))
        report.column(f"bodies {name}, first node", cells)


def check_summary(report, scene, tables, found, tolerance):
    """Compare counts, maxima, words and units; the values of the certificate are compared elsewhere."""
    summary = tables.summary

    def largest(values):
        return max(values, default=0.0)

    rows = list(tables.nodes.values())
    wanted = {
        "pairs_in_contact": sum(row["status"] == "touching" for row in tables.contact.values()),
        "plastic_elements": sum(row["state"] == "plastic" for row in tables.elements.values()),
        "iterations": len(tables.history),
        "pivots": sum(int(row["pivots"]) for row in tables.history.values()),
        "max_equivalent_stress": largest(float(row.get("max_equivalent_stress", row["equivalent_stress"])) for row in tables.elements.values()),
        "max_displacement": largest(math.hypot(float(row["ux"]), float(row["uy"])) for row in rows),
        "load_factor": 1.0,
    }
    if not scene.pair:
        wanted["total_contact_force"] = 0.0
    deviations = scene.deviations()
    if any(deviations):
        wanted.update(lowest_temperature=min(deviations), highest_temperature=max(deviations))
    for key, ours in wanted.items():
        told = summary.get(key, "missing")
        good = told == str(ours) if isinstance(ours, int) else told != "missing" and abs(number(told, tables.path("summary"), key) - ours) <= tolerance * abs(ours)
        report.line(key, ours, told, good)
    check_highest(report, tables, tolerance)
    if tables.case is not None:
        check_case(report, tables)
    if tables.history:
        last = tables.history[max(tables.history)]
        report.line("history pairs_in_contact, last", wanted["pairs_in_contact"], last["pairs_in_contact"], last["pairs_in_contact"] == str(wanted["pairs_in_contact"]))
        least, most = scene.end.yielding if scene.end else [wanted["plastic_elements"]] * 2   # with flow theory: those that yield in the last increment
        report.line("history plastic_elements, last", most, last["plastic_elements"], least <= int(last["plastic_elements"]) <= most)
        report.line("history load_factor, last", 1.0, last["load_factor"], float(last["load_factor"]) == 1.0)
        report.line("history iteration", len(tables.history), str(max(tables.history)), max(tables.history) == len(tables.history))
    asked = max(tolerance, scene.off_curve)
    told = summary.get("curve_tolerance", "nan")
    report.line("curve_tolerance", asked, told, abs(float(told) - asked) <= 1e-14 * asked)
    limit = summary.get("stress_off_curve_limit", "nan")
    report.line("stress_off_curve_limit", float(told), limit, float(told) * (1 - 1e-14) <= float(limit) <= 2 * float(told))
    residual, ours = float(summary.get("equilibrium_residual", "nan")), found.figures["equilibrium"]
    # The stress errors of yielded points differ from that of their mean, and the tables hold only the mean.
    several = any(own.points > 1 and own.plastic for own in found.elements.values())
    loose = max(1.0, found.most) * (10 * float(summary.get("stress_off_curve", 0.0)) + scene.drift) if several else 0.0
    report.line("residual, of the program's", ours, f"{residual:.16E}", ours <= LIKE * residual + report.rounding + found.lost + loose)
    for key in sorted(summary):
        unit = unit_of(key)
        if unit is not None and tables.units[key] != unit:
            report.line(f"unit of {key}", unit, tables.units[key], False)
    report.line("status", "valid", summary.get("status", "missing"), summary.get("status") == "valid")


def check_case(report, tables):
    """Compare a row of the table of load cases with the summary and the zone with the largest pressure."""
    rows = [row for row in table_rows(tables.path("cases")) if row["subcase"] == str(tables.case)]
    row = rows[0] if len(rows) == 1 else {}
    leading = [zone for zone in tables.zones.values() if zone["max_pressure"] == tables.summary.get("max_pressure")]
    wanted = {"approach": next((value for key, value in tables.summary.items() if key.startswith("approach_")), ""), **tables.summary}
    wrong = [key for key, told in row.items() if key != "subcase" and told != wanted.get(key, "")
             and not (key == "half_width" and (told == "" or told in [zone[key] for zone in leading]))]
    report.line("cases.csv", len(rows), " ".join(wrong), len(rows) == 1 and not wrong)


def check_highest(report, tables, tolerance):
    """Element and point with the largest stress; if several are equal, any of them counts."""
    if not any("max_x" in own for own in tables.elements.values()):
        return
    told = tables.summary.get("max_equivalent_stress_element", "missing")
    row = tables.elements.get(int(told) if told.isdigit() else None, {})
    highest = max(float(own.get("max_equivalent_stress", 0.0)) for own in tables.elements.values())
    report.line("max_equivalent_stress_element", highest, told, float(row.get("max_equivalent_stress", "nan")) >= highest * (1 - tolerance))
    for c in "xy":
        key = f"max_equivalent_stress_{c}"
        report.line(key, float(row.get(f"max_{c}", "nan")), tables.summary.get(key, "missing"), row.get(f"max_{c}") == tables.summary.get(key))


def not_read(tables):
    """Lines that name the unread columns and keys, and those compared with a bound only."""
    keys = [key for key in tables.summary if unit_of(key) is None]
    files = sorted(path.name for path in tables.directory.glob(f"{glob_safe(tables.stem)}.*")
                   if path.name not in {tables.path(name).name for name in ("summary", "nodes", "elements", "contact", "zones", "bodies", "history", "cases", "increments", "plastic", "friction")})
    lines = [f"not read: {name}.csv {', '.join(columns)}" for name, columns in (("summary", keys), *tables.unread.items()) if columns]
    if tables.path("increments").exists():
        lines.append("not read: increments.csv half_width, iterations; with friction, only its last row is")
    if len(tables.history) > 1:
        lines.append("not read: history.csv pairs_in_contact, plastic_elements, load_factor, but of its last row")
    lines += [f"not read: {', '.join(files)}"] if files else []
    lines.append(f"held to their tolerance, not to their digits: {', '.join(key for key in BOUNDS if key in tables.summary)}")
    return lines


def glob_safe(text):
    return "".join(f"[{c}]" if c in "*?[" else c for c in text)
