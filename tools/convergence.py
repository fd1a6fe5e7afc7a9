"""Convergence of results to known answers for each element type: tables, and a picture.

    tools/convergence                                  tables
    tools/convergence -o input/hertz/pictures/convergence     and NAME.png, NAME.svg

Two equal cylinders, elastic: the approach against Johnson's 2 P (1 - nu^2)/(pi E) (2 ln(4 R/b) - 1), the largest pressure
against Hertz's. A thick tube, yielded (p = 0.16): u(a), the mean over the inner nodes, against the one-dimensional
integration along the radius. The decks are those of tools/scenes, run in a temporary directory; times are the shortest of
three whole runs (one, if it takes a second), including reading and writing; only times differ between machines and runs.
Unknowns: equations of the bodies, as `epcont --plan` counts them.
"""
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import tables
from scenes import cylinders, plastic
from wording import parser_of, run

TOP = pathlib.Path(__file__).resolve().parent.parent
EPCONT = TOP / "build/release/epcont"
ELEMENTS = ("ctria3", "cquad4", "ctria6")

# Two cylinders: P, R, E, nu.
P, R, E, NU = 10.0, 1.0, 20400.0, 0.29
B = math.sqrt(4 * P * (R / 2) * 2 * (1 - NU * NU) / (math.pi * E))
P_MAX = 2 * P / (math.pi * B)
APPROACH = P * (1 - NU * NU) / (math.pi * E) * (2 * math.log(4 * R / B) - 1)   # half of the cylinders'
U_A = 0.1835687
#: Elements across the contact; elements through the wall. Six-node triangles are twice as large. Not only integers: the position of the
#: end of contact within an element matters.
ACROSS = {"ctria3": (3.3, 4.7, 6, 8.5, 10.5, 12.5, 14.5, 16, 24.3, 32.7, 48.5), "cquad4": (2, 3, 4, 5, 6, 7, 8, 12, 16, 24, 32, 48),
          "ctria6": (1, 1.3, 1.7, 2, 2.5, 2.7, 3.3, 3.7, 4, 4.7, 6, 8.5, 12.3, 16.7, 24.3)}
PARTS = {"ctria3": (5, 10, 20, 40, 80), "cquad4": (5, 10, 20, 40, 80), "ctria6": (3, 5, 10, 20, 40)}


def solve(deck, place):
    """Summary of a run, its unknowns, and its time; the tables stay beside the deck."""
    path = pathlib.Path(place) / "scene.dat"
    path.write_text(deck.text(), encoding="ascii")
    spent = []
    while len(spent) < 3 and sum(spent) < 1.0:
        start = time.perf_counter()
        run = subprocess.run([EPCONT, path, "-o", place, "--tables", "all"], capture_output=True, text=True, check=False)
        spent.append(time.perf_counter() - start)
        if run.returncode:
            sys.exit(f"{deck.title}: exit status {run.returncode}\n{run.stdout}{run.stderr}")
    plan = subprocess.run([EPCONT, "--plan", path], capture_output=True, text=True, check=True).stdout
    bodies = plan[plan.index("equations"):]
    unknowns = sum(int(row.split()[2]) for row in re.findall(r"^ +\d+ +\d+ +\d+ .*$", bodies, re.MULTILINE))
    return tables.summary(path.with_suffix(".summary.csv")), unknowns, min(spent)


def two_cylinders(element, across, place):
    """Unknowns, errors of approach and largest pressure, seconds."""
    mesh = cylinders.disc_squared(R, B, round(1.6 * across)) if element == "cquad4" else cylinders.disc_spaced(B / across, b=B, element=element)
    summary, unknowns, seconds = solve(cylinders.hertz(mesh, b=B), place)
    approach = next(float(value) for key, value in summary.items() if key.startswith("approach"))
    return unknowns, -approach / APPROACH - 1, float(summary["max_pressure"]) / P_MAX - 1, seconds


def inner_displacement(path):
    """Mean radial displacement of the inner nodes of a tube, from the tables of its run."""
    nodes = [[float(row[key]) for key in ("x", "y", "ux", "uy")] for row in tables.rows(path.with_suffix(".nodes.csv"))]
    inner = [math.hypot(ux, uy) for x, y, ux, uy in nodes if abs(math.hypot(x, y) - 100.0) < 1e-6]
    return sum(inner) / len(inner)


def tube(element, parts, place):
    """Unknowns, error of u(a), seconds."""
    _, unknowns, seconds = solve(plastic.tube_flat(0.16, "", parts, element), place)
    return unknowns, inner_displacement(pathlib.Path(place) / "scene.dat") / U_A - 1, seconds


def needed(rows, error=1e-3):
    """Unknowns above which the error stays below the limit, interpolated between two meshes in logarithmic scales; None if never."""
    beyond = [i for i, row in enumerate(rows) if abs(row[1]) > error]
    if not beyond or beyond[-1] + 1 == len(rows):
        return None
    (n0, e0), (n1, e1) = rows[beyond[-1]][:2], rows[beyond[-1] + 1][:2]
    part = math.log(error / abs(e0)) / math.log(abs(e1 / e0))
    return round(n0 * (n1 / n0) ** part)


def draw(contact, wall, name):
    from drawing import style  # imported here, so that the tables need only Python
    from drawing.style import plt

    figure, panels = plt.subplots(1, 3, figsize=(12.5, 4.2), layout="constrained", sharey=True)
    for axes, rows, column, title in ((panels[0], contact, 1, "two cylinders: approach"), (panels[1], contact, 2, "two cylinders: largest pressure"),
                                      (panels[2], wall, 1, "tube beyond yield: u(a)")):
        for element, (colour, mark) in style.ELEMENTS.items():
            axes.loglog([row[0] for row in rows[element]], [100 * abs(row[column]) for row in rows[element]], mark + "-", ms=4, lw=1.1,
                        color=colour, label=element.upper())
        axes.axhline(0.1, color="#999999", lw=0.7, dashes=(4, 3))
        axes.set(title=title, xlabel="unknowns", ylim=(1e-3, None))
    panels[0].set_ylabel("error, %")
    panels[0].legend()
    style.save(figure, name)


def check_folder(parser, output):
    """Check before minutes of runs that the files can be written."""
    if not output:
        return
    try:
        output.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        parser.error(f"-o {output}: {error.filename}: {error.strerror}")
    if not os.access(output.parent, os.W_OK):
        parser.error(f"-o {output}: {output.parent} cannot be written")


def main():
    parser = parser_of(__doc__, "tools/convergence")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="name of the picture, without .png and .svg")
    options = parser.parse_args()
    check_folder(parser, options.output)
    with tempfile.TemporaryDirectory() as place:
        contact = {element: [two_cylinders(element, n, place) for n in ACROSS[element]] for element in ELEMENTS}
        wall = {element: [tube(element, n, place) for n in PARTS[element]] for element in ELEMENTS}
    print("| two cylinders | unknowns | approach off by | p_max off by | seconds |\n| --- | --- | --- | --- | --- |")
    for element in ELEMENTS:
        for unknowns, approach, pressure, seconds in contact[element]:
            print(f"| {element.upper()} | {unknowns} | {approach:+.3%} | {pressure:+.3%} | {seconds:.3f} |")
    print("\n| tube | unknowns | u(a) off by | seconds |\n| --- | --- | --- | --- |")
    for element in ELEMENTS:
        for unknowns, error, seconds in wall[element]:
            print(f"| {element.upper()} | {unknowns} | {error:+.3%} | {seconds:.3f} |")
    print("\n| unknowns for 0.1 % | approach | tube |\n| --- | --- | --- |")
    for element in ELEMENTS:
        print(f"| {element.upper()} | {needed(contact[element])} | {needed(wall[element])} |")
    if options.output:
        draw(contact, wall, options.output)
    return 0


if __name__ == "__main__":
    run(main)
