"""The paper's Fig. 6 and Fig. 7: an elastic and a plastic run of one mesh, and Hertz's closed form.

For a body with symmetry line x = 0 in contact with a rigid plane (a quarter of two equal cylinders), three-node triangles. Stresses
are element stresses, without averaging; Hertz's closed form uses E, NU, the load carried and the curvature of the gaps.
"""
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm

from drawing.run import Refused
from drawing.style import BLUE as ELASTIC
from drawing.style import DARK as THEORY
from drawing.style import RED as PLASTIC


def check(run):
    """Reject other models, and runs without a valid answer."""
    if run.exit_status:
        raise Refused(f"{run.path}: {run.status}: give two decks with valid runs\n{run.message}", run.exit_status)
    if len(run.lines) != 1 or not run.lines[0].touching.any() or any(len(nodes) != 3 for nodes in run.around) or not run.lines[0].x[:, 0].any():
        raise Refused(f"{run.path}: not a quarter of two cylinders of CTRIA3 in one contact, as `tools/decks hertz` writes it; for any "
                      f"other deck: tools/plot {run.path}", 2)


def hertz(run):
    """Half-width and largest pressure of Hertz for this load and this curvature."""
    line, = run.lines
    load = 2 * line.force.sum()
    s = line.x[:, 0]
    radius = (s ** 4).sum() / (2 * line.gap * s ** 2).sum()
    b = np.sqrt(4 * load * radius * (1 - run.nu ** 2) / (np.pi * run.young))
    return b, 2 * load / (np.pi * b)


def beside_axis(run, reach):
    """Elements with an edge on x = 0, nearest first, and the heights of their centres."""
    corner = np.array(run.around)
    centre = run.x[corner].mean(axis=1)
    on_axis = (abs(run.x[:, 0]) < 1e-9 * reach)[corner].sum(axis=1) == 2
    found = np.flatnonzero(on_axis & (centre[:, 1] < reach))
    found = found[np.argsort(centre[found, 1])]
    return found, centre[found, 1]


def contact(elastic, plastic):
    """Fig. 6: pressure along the contact, stresses down the axis."""
    b, p0 = hertz(elastic)
    figure, (left, right) = plt.subplots(1, 2, figsize=(10.0, 4.2), layout="constrained")
    x = np.linspace(0, 1, 200)
    left.plot(b * x, p0 * np.sqrt(1 - x ** 2), color=THEORY, lw=1.2, label="Hertz")
    for run, colour, mark, name in ((elastic, ELASTIC, "o", "elastic"), (plastic, PLASTIC, "s", "elastoplastic")):
        line, = run.lines
        shown = slice(None, np.flatnonzero(line.touching)[-1] + 2)
        left.plot(line.x[shown, 0], line.pressure[shown], mark + "-", ms=4, lw=1.0, color=colour, label=name)
    unit, length = elastic.stress_unit(), elastic.length_unit()
    left.set(xlabel="distance from the axis of symmetry" + length, ylabel=f"contact pressure, {unit}", xlim=(0, None), ylim=(0, None))
    left.legend()

    s = np.linspace(0, 4, 400)
    root = np.sqrt(1 + s * s)
    closed = {"sx": -p0 * ((1 + 2 * s * s) / root - 2 * s), "sy": -p0 / root}
    closed["sz"] = elastic.nu * (closed["sx"] + closed["sy"])
    for key, dash, name in (("sx", "--", r"$\sigma_x$"), ("sz", ":", r"$\sigma_z$"), ("sy", "-", r"$\sigma_y$")):
        right.plot(b * s, closed[key], dash, color=THEORY, lw=1.2)
        for run, colour, mark in ((elastic, ELASTIC, "o"), (plastic, PLASTIC, "s")):
            beside, height = beside_axis(run, 4 * b)
            right.plot(height, run.stress[key][beside], dash, marker=mark, ms=3, color=colour, lw=0.9)
        right.annotate(name, (4 * b, closed[key][-1]), (6, 0), textcoords="offset points", va="center", fontsize=12)
    for colour, mark, name in ((THEORY, "", "Hertz, elastic"), (ELASTIC, "o", "elastic"), (PLASTIC, "s", "elastoplastic")):
        right.plot([], [], marker=mark, ms=4, lw=1.0, color=colour, label=name)
    right.set(xlabel="distance from the contact, on the axis" + length, ylabel=f"stress, {unit}", xlim=(0, 4 * b))
    right.legend(loc="lower right")
    for axes, name in ((left, "(a)"), (right, "(b)")):
        axes.set_title(name, loc="left", fontsize=11)
    return figure


def section(elastic, plastic):
    """Fig. 7: equivalent stress and yielded zone, with the elastic section mirrored beside it."""
    b, _ = hertz(elastic)
    width, height = 3.6 * b, 5 * b
    figure, axes = plt.subplots(figsize=(7.2, 4.5), layout="constrained")
    top = max(run.stress["equivalent_stress"].max() for run in (elastic, plastic))
    levels = np.arange(0, 10 * np.ceil(top / 10) + 1, 10)
    colours = plt.get_cmap("viridis")
    for run, side in ((elastic, -1), (plastic, 1)):
        corner = np.array(run.around)
        near = (abs(run.x[corner]).min(axis=1) < (width, height)).all(axis=1)
        # Thousands of triangles: an image in the SVG. Without antialiasing, so that the background does not show between them.
        filled = axes.tripcolor(side * run.x[:, 0], run.x[:, 1], corner[near], facecolors=run.stress["equivalent_stress"][near],
                                cmap=colours, norm=BoundaryNorm(levels, colours.N), edgecolors="none", antialiased=False,
                                rasterized=True)
    edges = [plastic.x[list(ends)] for ends in sorted(plastic.sides(plastic.plastic))]
    off_axis = [ends for ends in edges if abs(ends[:, 0]).max() > 1e-9 * abs(plastic.x).max()]
    axes.add_collection(LineCollection(off_axis, colors="white", linewidths=1.1, capstyle="round"))
    axes.axvline(0, color="white", lw=0.8)
    place = {"xycoords": "axes fraction", "color": "white", "va": "top"}
    axes.annotate("elastic", (0.03, 0.97), **place)
    axes.annotate("elastoplastic; the line encloses\nthe elements that have yielded", (0.97, 0.97), ha="right", **place)
    axes.set(xlim=(-width, width), ylim=(0, height), aspect="equal", ylabel="distance from the contact plane" + plastic.length_unit(),
             xlabel="distance from the axis of symmetry" + plastic.length_unit())
    figure.colorbar(filled, label=f"equivalent stress, {plastic.stress_unit()}", ticks=levels[::2])
    return figure
