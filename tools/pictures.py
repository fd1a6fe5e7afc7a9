"""A picture of any deck: equivalent stress on the deformed bodies, and the contact pressures.

    tools/picture DECK.dat -o NAME.png [--scale 10] [--near X,Y,HALF_WIDTH]... [--along x|y|angle] [--split] [--known FORMULA]...

One panel shows the whole, one each place that --near names, the last one the pressures of each BCONP's slave nodes over their x,
y or angle round the origin (degrees from downwards). A --known formula in that abscissa `s` is drawn beside them, for example
"3585.36*sqrt(1-(s/6.21463)**2)". Elements have one colour each, the yielded ones are enclosed.
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
from matplotlib.collections import LineCollection, PolyCollection  # noqa: E402

TOP = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(TOP / "tests" / "independent"))
from deck import ids, read  # noqa: E402

plt.rcParams.update({"font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8, "legend.frameon": False})
COLOURS = ["#4477aa", "#cc3311", "#228833", "#aa3377"]


class Run:
    """What a deck gives: elements' corners round about (with middles), places, displacements, stresses, pairs by BCONP."""

    def __init__(self, path):
        with tempfile.TemporaryDirectory() as place:
            run = subprocess.run([TOP / "build/release/epcont", path, "-o", place, "--tables", "all"], capture_output=True,
                                 text=True, check=False)
            if run.returncode:
                sys.exit(f"{path}: exit status {run.returncode}\n{run.stdout}{run.stderr}")
            nodes, elements, self.pairs = (list(csv.DictReader(open(pathlib.Path(place) / f"{path.stem}.{name}.csv", encoding="ascii")))
                                           for name in ("nodes", "elements", "contact"))
        deck = read(path)
        self.x = {int(n["node"]): np.array([float(n["x"]), float(n["y"])]) for n in nodes}
        self.u = {int(n["node"]): np.array([float(n["ux"]), float(n["uy"])]) for n in nodes}
        order = {"CTRIA3": [0, 1, 2], "CTRAX3": [0, 1, 2], "CQUAD4": [0, 1, 2, 3], "CTRIA6": [0, 3, 1, 4, 2, 5], "CTRAX6": range(6)}
        cards = {int(card[1]): (card[0], [int(n) for n in card[3:9] if n]) for name in order for card in deck.of(name)}
        self.around = [[cards[int(e["element"])][1][i] for i in order[cards[int(e["element"])][0]]] for e in elements]
        self.stress = np.array([float(e["equivalent_stress"]) for e in elements])
        self.plastic = np.array([e["state"] == "plastic" for e in elements])
        line = {int(card[1]): {int(n) for n in ids(card[2:])} for card in deck.of("BLSEG")}
        self.groups = [(int(card[1]), [p for p in self.pairs if int(p["gb"]) in line[int(card[2])]]) for card in deck.of("BCONP")]
        self.groups = self.groups or [(0, self.pairs)]

    def edges(self, chosen):
        """Sides that belong to one of the chosen elements only."""
        count = {}
        for nodes in (n for n, wanted in zip(self.around, chosen) if wanted):
            for ends in zip(nodes, nodes[1:] + nodes[:1]):
                key = tuple(sorted(ends))
                count[key] = count.get(key, 0) + 1
        return [key for key, times in count.items() if times == 1]


def bodies(axes, run, scale, limits, window):
    place = {n: run.x[n] + scale * run.u[n] for n in run.x}
    drawn = PolyCollection([[place[n] for n in nodes] for nodes in run.around], array=run.stress, cmap="viridis", clim=limits,
                           edgecolors="face", linewidths=0.2, rasterized=True)
    axes.add_collection(drawn)
    if window:
        axes.add_collection(PolyCollection([[place[n] for n in nodes] for nodes in run.around], facecolors="none", edgecolors="white",
                                           linewidths=0.15))
    axes.add_collection(LineCollection([[place[n] for n in ends] for ends in run.edges(np.ones(len(run.around), bool))],
                                       colors="black", linewidths=0.6))
    axes.add_collection(LineCollection([[place[n] for n in ends] for ends in run.edges(run.plastic)], colors="red", linewidths=0.8))
    axes.set_aspect("equal")
    axes.autoscale()
    if window:
        x, y, half = window
        axes.set(xlim=(x - half, x + half), ylim=(y - half, y + half))
    return drawn


def pressures(axes, run, groups, along, formulas):
    pressed = np.array([[float(p["x"]), float(p["y"])] for _, pairs in groups for p in pairs if float(p["force"]) > 0])
    along = along or "xy"[int(np.argmax(np.ptp(pressed, axis=0)))]

    def abscissa(pair):
        x, y = float(pair["x"]), float(pair["y"])
        return {"x": x, "y": y, "angle": np.degrees(np.arctan2(x, -y))}[along]

    shown = []
    for (number, pairs), colour in zip(groups, COLOURS):
        rows = sorted((abscissa(p), float(p["pressure"] or 0)) for p in pairs)
        pressed = [i for i, (_, p) in enumerate(rows) if p > 0]
        if not pressed:
            continue
        rows = rows[max(pressed[0] - 1, 0):pressed[-1] + 2]
        shown += [s for s, _ in rows]
        axes.plot(*zip(*rows), "o-", ms=3, lw=0.9, color=colour, label=f"BCONP {number}" if number else "pairs")
    s = np.linspace(min(shown), max(shown), 801)
    names = {name: getattr(np, name) for name in ("sqrt", "log", "tan", "radians", "pi", "maximum", "sin", "cos")}
    with np.errstate(invalid="ignore", divide="ignore"):
        for k, formula in enumerate(formulas):
            axes.plot(s, eval(formula, names, {"s": s}), color="black", lw=1.0, label="" if k else "known")
    axes.set(xlabel=along if along != "angle" else "angle, degrees", ylabel="contact pressure", ylim=(0, None))
    axes.legend()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--scale", type=float, default=1.0, help="of the displacements, where the whole is drawn")
    parser.add_argument("--near", type=lambda text: [float(v) for v in text.split(",")], action="append", default=[])
    parser.add_argument("--along", choices=["x", "y", "angle"], help="x or y, whichever is longer, if not given")
    parser.add_argument("--split", action="store_true", help="a panel of pressures for each BCONP")
    parser.add_argument("--known", action="append", default=[])
    parser.add_argument("--top", type=float, help="largest stress of the colours (else that of all but 1 %% of the elements)")
    options = parser.parse_args()
    run = Run(options.deck)
    groups = [[group] for group in run.groups] if options.split else [run.groups]
    panels = 1 + len(options.near)
    figure, axes = plt.subplots(1, panels + len(groups), figsize=(3.4 * (panels + len(groups)), 3.2), layout="constrained")
    limits = (0.0, options.top or np.quantile(run.stress, 0.99))
    for panel, window in zip(axes, [None] + options.near):
        drawn = bodies(panel, run, 1.0 if window else options.scale, limits, window)
    figure.colorbar(drawn, ax=axes[:panels], label="equivalent stress", extend="max", shrink=0.9)
    for panel, group in zip(axes[panels:], groups):
        pressures(panel, run, group, options.along, options.known)
    axes[0].set_title(f"displacements x {options.scale:g}", fontsize=9)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(options.output, metadata={"Software": None}, dpi=80)
    return 0


if __name__ == "__main__":
    sys.exit(main())
