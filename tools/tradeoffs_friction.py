"""Friction in `tools/tradeoff --friction`: increments against the error, contact solvers, and the price compared with frictionless contact."""
import csv
import statistics

from process import peak, timed
from report import short, table
from scenes import friction, many

RULES = "CONRY", "JOINED"
NUMBERS = 1, 2, 5, 10, 20, 40
#: Models for the price: name, deck of a fineness, and the fineness for some 300, 900 and 3 000 nodes.
SCENES = (("cylinders, pairs", lambda n: friction.cattaneo(n), (1, 4, 18)), ("cylinders, lines", lambda n: friction.cattaneo(n, lines=True), (1, 4, 18)),
          ("dovetail", lambda fine: many.dovetail(fine=fine, growth=0.4, friction=0.1), (1.7, 0.55, 0.15)))
#: Runs of a choice; a run of more seconds is not repeated.
TURNS, LONG = 5, 5.0


def solve(epcont, place, text, *cards):
    """Median of the processor time [s]."""
    (place / "scene.dat").write_text(text.replace("ENDDATA", "\n".join([*cards, "ENDDATA"])), encoding="ascii")
    command = [str(epcont), "scene.dat"]
    status, _, cpu, out = peak(command, place)
    if status:
        raise SystemExit(f"exit status {status}\n{out}")
    return cpu if cpu > LONG else statistics.median(timed(command, place)[1] for _ in range(TURNS))


def rows_of(place, name):
    with open(place / f"scene.{name}.csv") as file:
        return list(csv.DictReader(file))


def value(place, key, case=None):
    return next((float(row["value"]) for row in rows_of(place, "summary") if row["key"] == key and row["value"] and row.get("subcase", case) == case), None)


def of_cylinder(place):
    """Relative error of the stick half-width over that of the contact, whose square of the pressure falls linearly at its end; and the error that is stated."""
    closed = [(float(row["x"]), float(row["force"]) ** 2) for row in rows_of(place, "friction") if float(row["force"]) > 0.0]
    (one, a), (other, b) = closed[-3:-1]
    stick = value(place, "stick_half_width")
    stated = value(place, "increment_error_stick_half_width")
    return abs(stick / (other + (other - one) * b / (a - b)) / friction.STICK - 1.0), stated and stated / stick


def increments(epcont, place):
    lines = []
    for number in NUMBERS:
        cpu = solve(epcont, place, friction.half_plane(friction.EVEN, 0.2, friction.RADIUS, number).text())
        error, stated = of_cylinder(place)
        pushed = solve(epcont, place, friction.cattaneo(32, steps=number).text())
        sticks = [value(place, "stick_half_width", case) for case in "23"]
        lines.append([number, short(cpu), f"{100 * error:.1f}", "" if stated is None else f"{100 * stated:.1f}", short(pushed), *(f"{stick:.6f}" for stick in sticks)])
    return table(["increments", "cylinder on a half-plane, s", "error, %", "stated, %", "two cylinders pushed, s", "stick half-width, .6 mu P", "-.2 mu P"], lines)


def prices(epcont, place):
    lines = []
    for name, make, sizes in SCENES:
        for size in sizes:
            text = make(size).text()
            nodes = text.count("\nGRID")
            times = [solve(epcont, place, text, f"PARAM   RULE    {rule}") for rule in RULES]
            pairs = len({row["pair"] for row in rows_of(place, "friction")})
            lines.append([name, nodes, pairs, *(short(1000 * cpu) for cpu in times), f"{times[1] / times[0]:.1f}"])
    return table(["model", "nodes", "pairs", *(f"{rule}, ms" for rule in RULES), "ratio"], lines)


def against_frictionless(epcont, place):
    """The half-plane, where friction may be left out: a step with and without it, and ten increments."""
    lines = []
    for parts in (20, 80):
        places = [k / parts for k in range(int(1.15 * parts) + 1)]
        for rule in RULES:
            card = f"PARAM   RULE    {rule}"
            bare, one, ten = (solve(epcont, place, friction.half_plane(places, 0.2, friction.RADIUS, steps).text(), card, *more)
                              for steps, more in ((1, ["PARAM   FRICTIONNO"]), (1, []), (10, [])))
            lines.append([len(places), rule, short(1000 * bare), f"{one / bare:.1f}", f"{ten / bare:.1f}"])
    return table(["pairs", "rule", "frictionless, ms", "friction, times", "in ten increments, times"], lines)


def page(epcont, place):
    return "\n\n".join([
        "## Friction", "`tools/tradeoff --friction`. Processor seconds of the whole process on one thread, medians of five runs. Each model with increments runs twice, for the "
        "error of the increments.", increments(epcont, place), prices(epcont, place), against_frictionless(epcont, place)])
