"""Pictures of runs, as PNG and SVG.

    tools/plot contact ELASTIC.dat PLASTIC.dat -o NAME     pressure along the contact, stresses down the axis (Fig. 6)
    tools/plot section ELASTIC.dat PLASTIC.dat -o NAME     equivalent stress and yielded zone in the section (Fig. 7)

Both are for a body with a line of symmetry x = 0 that touches a rigid plane (a quarter of two equal cylinders), solved
elastic and with yielding on one mesh. Stresses are those of the elements, averaged nowhere. The decks are run in a
temporary directory; Hertz's closed form is drawn from E, NU, the load carried and the curvature of the gaps. NAME.png and
NAME.svg are written, the same bytes on every run.
"""
import argparse
import csv
import pathlib
import subprocess
import sys
import tempfile

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.collections import LineCollection  # noqa: E402
from matplotlib.colors import BoundaryNorm  # noqa: E402

TOP = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOP / "tests" / "independent"))
from deck import at, read, real  # noqa: E402

ELASTIC, PLASTIC, THEORY = "#4477aa", "#cc3311", "#222222"
plt.rcParams.update({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8,
                     "legend.frameon": False, "svg.hashsalt": "epcont", "svg.fonttype": "path", "figure.dpi": 110})


class Run:
    """A deck and the tables it gives, as arrays."""

    def __init__(self, path):
        with tempfile.TemporaryDirectory() as place:
            run = subprocess.run([TOP / "build/release/epcont", path, "-o", place, "--tables", "all"], capture_output=True,
                                 text=True, check=False)
            if run.returncode:
                sys.exit(f"{path}: exit status {run.returncode}\n{run.stdout}{run.stderr}")
            self.nodes, self.elements, self.contact = (self.table(place, path.stem, name)
                                                       for name in ("nodes", "elements", "contact"))
        deck = read(path)
        row = {int(node): i for i, node in enumerate(self.nodes["node"])}
        self.x = np.array([self.nodes["x"], self.nodes["y"]], float).T
        corners = {int(card[1]): [row[int(node)] for node in card[3:6]] for card in deck.of("CTRIA3")}
        self.corner = np.array([corners[int(element)] for element in self.elements["element"]])
        self.young, self.nu = next((real(card[2]), real(card[4])) for card in deck.of("MAT1"))
        self.unit = {at(c, 1): at(c, 2) for c in deck.of("PARAM")}.get("UNITS", "")
        self.plastic = np.array([state == "plastic" for state in self.elements["state"]])
        self.stress = {key: np.array(self.elements[key], float)
                       for key in ("sx", "sy", "sz", "equivalent_stress")}
        self.pressure = np.array(self.contact["pressure"], float)
        self.pair_x = np.array(self.contact["x"], float)

    @staticmethod
    def table(place, stem, name):
        with open(pathlib.Path(place) / f"{stem}.{name}.csv", newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        return {key: [row[key] for row in rows] for key in rows[0]}

    def beside_axis(self, reach):
        """Elements with an edge on x = 0, nearest first, and the heights of their centres."""
        centre = self.x[self.corner].mean(axis=1)
        on_axis = (abs(self.x[:, 0]) < 1e-9 * reach)[self.corner].sum(axis=1) == 2
        found = np.flatnonzero(on_axis & (centre[:, 1] < reach))
        found = found[np.argsort(centre[found, 1])]
        return found, centre[found, 1]

    def edge_of_yielding(self):
        """The edges round the yielded elements, but for those on x = 0. [edges, 2, 2]"""
        count = {}
        for a, b, c in self.corner[self.plastic]:
            for ends in ((a, b), (b, c), (c, a)):
                count[tuple(sorted(ends))] = count.get(tuple(sorted(ends)), 0) + 1
        edges = [self.x[list(ends)] for ends, times in sorted(count.items()) if times == 1]
        return [ends for ends in edges if abs(ends[:, 0]).max() > 1e-9 * abs(self.x).max()]

    def hertz(self):
        """Half-width and largest pressure of Hertz for this load and this curvature."""
        load = 2 * sum(map(float, self.contact["force"]))
        gap = np.array(self.contact["initial_gap"], float)
        radius = (self.pair_x ** 4).sum() / (2 * gap * self.pair_x ** 2).sum()
        b = np.sqrt(4 * load * radius * (1 - self.nu ** 2) / (np.pi * self.young))
        return b, 2 * load / (np.pi * b)


def stress_unit(run):
    """KGF-MM says kgf/mm2; other words say it themselves."""
    force, _, length = run.unit.partition("-")
    names = {"KGF": "kgf", "N": "N", "MM": "mm", "M": "m"}
    return f"{names.get(force, force)}/{names.get(length, length)}$^2$" if length else "force/length$^2$"


def contact(elastic, plastic):
    """The paper's Fig. 6."""
    b, p0 = elastic.hertz()
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    x = np.linspace(0, 1, 200)
    left.plot(b * x, p0 * np.sqrt(1 - x ** 2), color=THEORY, lw=1.2, label="Hertz")
    for run, colour, mark, name in ((elastic, ELASTIC, "o", "elastic"), (plastic, PLASTIC, "s", "elastoplastic")):
        pressed = np.flatnonzero(run.pressure > 0)
        shown = np.append(pressed, pressed[-1] + 1) if pressed[-1] + 1 < len(run.pair_x) else pressed
        left.plot(run.pair_x[shown], run.pressure[shown], mark + "-", ms=4, lw=1.0, color=colour, label=name)
    unit = stress_unit(elastic)
    left.set(xlabel="distance from the axis of symmetry" + length_unit(elastic), ylabel=f"contact pressure, {unit}", xlim=(0, None), ylim=(0, None))
    left.legend()

    s = np.linspace(0, 4, 400)
    root = np.sqrt(1 + s * s)
    closed = {"sx": -p0 * ((1 + 2 * s * s) / root - 2 * s), "sy": -p0 / root}
    closed["sz"] = elastic.nu * (closed["sx"] + closed["sy"])
    for key, dash, name in (("sx", "--", r"$\sigma_x$"), ("sz", ":", r"$\sigma_z$"), ("sy", "-", r"$\sigma_y$")):
        right.plot(b * s, closed[key], dash, color=THEORY, lw=1.2)
        for run, colour, mark in ((elastic, ELASTIC, "o"), (plastic, PLASTIC, "s")):
            beside, height = run.beside_axis(4 * b)
            right.plot(height, run.stress[key][beside], dash, marker=mark, ms=3, color=colour, lw=0.9)
        right.annotate(name, (4 * b, closed[key][-1]), (6, 0), textcoords="offset points", va="center", fontsize=12)
    for colour, mark, name in ((THEORY, "", "Hertz, elastic"), (ELASTIC, "o", "elastic"), (PLASTIC, "s", "elastoplastic")):
        right.plot([], [], marker=mark, ms=4, lw=1.0, color=colour, label=name)
    right.set(xlabel="distance from the contact, on the axis" + length_unit(elastic), ylabel=f"stress, {unit}", xlim=(0, 4 * b))
    right.legend(loc="lower right")
    for axes, name in ((left, "(a)"), (right, "(b)")):
        axes.set_title(name, loc="left", fontsize=11)
    return figure


def length_unit(run):
    """`, mm` for KGF-MM; nothing for other words."""
    length = run.unit.partition("-")[2]
    return f", {length.lower()}" if length in ("MM", "M") else ""


def section(elastic, plastic):
    """The paper's Fig. 7, the elastic section mirrored beside it."""
    b, _ = elastic.hertz()
    width, height = 3.6 * b, 5 * b
    figure, axes = plt.subplots(figsize=(7.2, 4.5), layout="constrained")
    top = max(run.stress["equivalent_stress"].max() for run in (elastic, plastic))
    levels = np.arange(0, 10 * np.ceil(top / 10) + 1, 10)
    colours = plt.get_cmap("viridis")
    for run, side in ((elastic, -1), (plastic, 1)):
        near = (abs(run.x[run.corner]).min(axis=1) < (width, height)).all(axis=1)
        # Thousands of triangles: an image in the SVG. Not antialiased: or the background shows between them.
        filled = axes.tripcolor(side * run.x[:, 0], run.x[:, 1], run.corner[near], facecolors=run.stress["equivalent_stress"][near],
                                cmap=colours, norm=BoundaryNorm(levels, colours.N), edgecolors="none", antialiased=False,
                                rasterized=True)
    axes.add_collection(LineCollection(plastic.edge_of_yielding(), colors="white", linewidths=1.1, capstyle="round"))
    axes.axvline(0, color="white", lw=0.8)
    place = {"xycoords": "axes fraction", "color": "white", "va": "top"}
    axes.annotate("elastic", (0.03, 0.97), **place)
    axes.annotate("elastoplastic; the line encloses\nthe elements that have yielded", (0.97, 0.97), ha="right", **place)
    axes.set(xlim=(-width, width), ylim=(0, height), aspect="equal", ylabel="distance from the contact plane" + length_unit(plastic),
             xlabel="distance from the axis of symmetry" + length_unit(plastic))
    figure.colorbar(filled, label=f"equivalent stress, {stress_unit(plastic)}", ticks=levels[::2])
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", choices=["contact", "section"])
    parser.add_argument("elastic", type=pathlib.Path)
    parser.add_argument("plastic", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="name without .png and .svg")
    options = parser.parse_args()
    figure = {"contact": contact, "section": section}[options.picture](Run(options.elastic), Run(options.plastic))
    options.output.parent.mkdir(parents=True, exist_ok=True)
    for kind, metadata in (("png", {"Software": None}), ("svg", {"Date": None, "Creator": None})):
        figure.savefig(options.output.with_name(f"{options.output.name}.{kind}"), metadata=metadata, dpi=120)
    return 0


if __name__ == "__main__":
    sys.exit(main())
