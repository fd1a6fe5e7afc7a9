"""Pictures of runs, as PNG and SVG.

    tools/plot contact ELASTIC.dat PLASTIC.dat -o NAME     pressure along the contact, stresses down the axis (Fig. 6)
    tools/plot section ELASTIC.dat PLASTIC.dat -o NAME     equivalent stress and yielded zone in the section (Fig. 7)

Both are for a body with a line of symmetry x = 0 that touches a rigid plane (a quarter of two equal cylinders), solved
elastic and with yielding on one mesh. The decks are run in a temporary directory; Hertz's closed form is drawn from E, NU,
the load carried and the curvature of the gaps. NAME.png and NAME.svg are written, the same bytes on every run.
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
from matplotlib.tri import Triangulation  # noqa: E402

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
        self.corner = np.array([[row[int(node)] for node in card[3:6]] for card in deck.of("CTRIA3")])
        self.young, self.nu = next((real(card[2]), real(card[4])) for card in deck.of("MAT1"))
        self.unit = {at(c, 1): at(c, 2) for c in deck.of("PARAM")}.get("UNITS", "")
        self.plastic = np.array([state == "plastic" for state in self.elements["state"]])
        self.stress = {key: np.array(self.elements[key], float)
                       for key in ("sx", "sy", "sz", "txy", "equivalent_stress", "equivalent_strain")}
        self.pressure = np.array(self.contact["pressure"], float)
        self.pair_x = np.array(self.contact["x"], float)

    @staticmethod
    def table(place, stem, name):
        with open(pathlib.Path(place) / f"{stem}.{name}.csv", newline="", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        return {key: [row[key] for row in rows] for key in rows[0]}

    def at_nodes(self, key):
        """Element values at the nodes: means weighted by area."""
        p = self.x[self.corner]
        area = abs(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])) / 2
        total, weight = np.zeros(len(self.x)), np.zeros(len(self.x))
        np.add.at(total, self.corner, (area * self.stress[key])[:, None])
        np.add.at(weight, self.corner, area[:, None])
        return total / np.where(weight > 0, weight, 1)

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
    for key, dash, name in (("sy", "-", r"$\sigma_y$"), ("sx", "--", r"$\sigma_x$"), ("sz", ":", r"$\sigma_z$")):
        right.plot(b * s, closed[key], dash, color=THEORY, lw=1.2)
        for run, colour in ((elastic, ELASTIC), (plastic, PLASTIC)):
            axis = np.flatnonzero((abs(run.x[:, 0]) < 1e-12) & (run.x[:, 1] < 4 * b))
            axis = axis[np.argsort(run.x[axis, 1])]
            axis = axis[np.isin(axis, run.corner)]
            right.plot(run.x[axis, 1], run.at_nodes(key)[axis], dash, color=colour, lw=1.4)
        right.plot([], [], dash, color="0.4", label=name)
    for colour, name in ((THEORY, "closed form, elastic"), (ELASTIC, "elastic"), (PLASTIC, "elastoplastic")):
        right.plot([], [], color=colour, label=name)
    right.set(xlabel="depth below the contact, on the axis" + length_unit(elastic), ylabel=f"stress, {unit}", xlim=(0, 4 * b))
    right.legend(loc="lower right", ncols=2)
    return figure


def length_unit(run):
    """`, mm` for KGF-MM; nothing for other words."""
    length = run.unit.partition("-")[2]
    return f", {length.lower()}" if length in ("MM", "M") else ""


def yield_strain(run):
    """Between the largest equivalent strain that is elastic and the smallest that is not."""
    strain = run.stress["equivalent_strain"]
    return (strain[run.plastic].min() + strain[~run.plastic].max()) / 2


def section(elastic, plastic):
    """The paper's Fig. 7, the elastic section mirrored beside it."""
    b, _ = elastic.hertz()
    figure, axes = plt.subplots(figsize=(7.2, 5.0), layout="constrained")
    top = max(elastic.at_nodes("equivalent_stress").max(), plastic.at_nodes("equivalent_stress").max())
    levels = np.linspace(0, 10 * np.ceil(top / 10), 17)
    for run, side in ((elastic, -1), (plastic, 1)):
        shape = Triangulation(side * run.x[:, 0], run.x[:, 1], run.corner)
        filled = axes.tricontourf(shape, run.at_nodes("equivalent_stress"), levels=levels, cmap="viridis")
        # Lines of the background would show between the bands.
        filled.set_edgecolor("face")
    axes.tricontour(shape, plastic.at_nodes("equivalent_strain"), levels=[yield_strain(plastic)], colors="white", linewidths=1.8)
    axes.axvline(0, color="white", lw=0.8)
    place = {"xycoords": "axes fraction", "color": "white", "va": "top"}
    axes.annotate("elastic", (0.03, 0.97), **place)
    axes.annotate("elastoplastic; the line encloses\nwhat has yielded", (0.97, 0.97), ha="right", **place)
    axes.set(xlim=(-3.6 * b, 3.6 * b), ylim=(0, 5 * b), aspect="equal", xlabel="distance from the axis of symmetry" + length_unit(plastic),
             ylabel="depth below the contact" + length_unit(plastic))
    figure.colorbar(filled, label=f"equivalent stress, {stress_unit(plastic)}", shrink=0.9)
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
        figure.savefig(options.output.with_name(f"{options.output.name}.{kind}"), metadata=metadata)
    return 0


if __name__ == "__main__":
    sys.exit(main())
