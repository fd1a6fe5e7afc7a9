"""Panels of bodies: the whole deformed model, contact regions, and yielded zones."""
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from drawing.style import DARK, GREY, RED

#: Displacements are enlarged until the largest is this fraction of the model's size ...
SEEN = 0.08
#: ... but no farther than the overlap of bodies, due to closed gaps that are enlarged too, is this fraction of it.
OVERLAP = 0.01
#: Elements below this fraction of a panel's size have fainter edges, and then none.
FAINT = 0.05


def factor(run):
    """Enlargement of the displacements: 1, 2 or 5 times a power of ten, at least 1."""
    largest = np.hypot(*run.u.T).max()
    if largest == 0.0:
        return 1
    most = SEEN * run.size() / largest
    closed = max((abs(line.gap[line.touching]).max() for line in run.lines if line.touching.any()), default=0.0)
    if closed > 0.0:
        most = min(most, 1 + OVERLAP * run.size() / closed)
    if most < 2:
        return 1
    power = 10.0 ** np.floor(np.log10(most))
    return next(step * power for step in (5, 2, 1) if step * power <= most * (1 + 1e-9))


def windows(run):
    """Regions of the two zones with the largest forces, if these are small in the model: (centre, half width)."""
    found = []
    for _, first, last in sorted(run.zones, reverse=True)[:2]:
        ends = (run.x + run.u)[[first, last]]
        half = 2.0 * max(np.hypot(*(ends[1] - ends[0])), 0.5 * largest_side(run, first))
        centre = ends.mean(axis=0)
        if 2 * half < 0.4 * run.size() and all(abs(centre - other).max() > half + wide for other, wide in found):
            found.append((centre, half))
    return found


def largest_side(run, node):
    """Longest edge of the elements at a node; of any element if it has none."""
    near = [nodes for nodes in run.around if node in nodes] or run.around
    return max(np.hypot(*(run.x[a] - run.x[b])) for nodes in near for a, b in zip(nodes, nodes[1:] + nodes[:1]))


def yielded_window(run):
    """Centre and half width of a square around the yielded elements."""
    place = (run.x + run.u)[sorted({node for nodes, yes in zip(run.around, run.plastic) if yes for node in nodes})]
    low, high = place.min(axis=0), place.max(axis=0)
    return (low + high) / 2, 0.65 * (high - low).max()


def frame(place, window):
    """Limits of x and y: the window, without its empty margins."""
    low, high = place.min(axis=0), place.max(axis=0)
    margin = 0.02 * (high - low).max()
    if window:
        centre, half = window
        margin = 0.04 * half
        low, high = np.maximum(low, centre - half), np.minimum(high, centre + half)
    return np.array([low - margin, high + margin]).T


def proportion(run, window=None):
    """Width over height of a panel's content."""
    wide, high = np.ptp(frame(run.x + run.u, window), axis=1)
    return wide / high


def draw(figure, run, heading, scale=1, window=None, yielded=None, strain=None):
    """Equivalent stress, or plastic strain, on the displaced bodies; yielded elements outlined; undeformed outlines if enlarged."""
    axes = figure.subplots()
    place = run.x + scale * run.u
    limits = frame(place if window else np.concatenate([place, run.x]), window)
    shapes = [place[nodes] for nodes in run.around]
    seen = np.array([bool((shape.max(axis=0) > limits[:, 0]).all() and (shape.min(axis=0) < limits[:, 1]).all()) for shape in shapes])
    value, name = (run.stress["equivalent_stress"], f"equivalent stress, {run.stress_unit()}") if strain is None else (strain, "accumulated plastic strain")
    wide, high = np.ptp(limits, axis=1)
    if run.solved:
        drawn = PolyCollection(shapes, array=value, cmap="viridis", clim=(0.0, np.quantile(value[seen], 0.99) or 1.0), edgecolors="face",
                               linewidths=0.2)
        axes.add_collection(drawn)
        beside = wide < 2 * high
        bar = [1.04, 0.0, 0.05 * high / wide, 1.0] if beside else [0.0, -0.25 - 0.03 * wide / high, 1.0, 0.02 * wide / high]
        figure.colorbar(drawn, cax=axes.inset_axes(bar), extend="max", orientation="vertical" if beside else "horizontal",
                        label=name)
    # Edges of very small elements would hide the colours: they are drawn fainter.
    sizes = np.array([np.ptp(shape, axis=0).min() for shape in shapes]) / max(wide, high)
    faint = np.clip((sizes / FAINT)**2, 0.0, 1.0)
    large = [shape for shape, part in zip(shapes, faint) if part > 0.1]
    axes.add_collection(PolyCollection(large, facecolors="none" if run.solved else "#dde4ec", edgecolors="white" if run.solved else GREY,
                                       linewidths=0.25 * faint[faint > 0.1]))
    outline = run.sides()
    if scale != 1:
        axes.add_collection(LineCollection([run.x[list(ends)] for ends in outline], colors=GREY, linewidths=0.6))
    axes.add_collection(LineCollection([place[list(ends)] for ends in outline], colors="black", linewidths=0.6))
    if yielded is not None:
        axes.add_collection(LineCollection([place[list(ends)] for ends in run.sides(yielded)], colors=RED, linewidths=1.1))
    axes.plot(*place[run.bare].T, "s", ms=2, color=DARK)
    axes.set(xlim=limits[0], ylim=limits[1], aspect="equal")
    axes.locator_params(axis="x", nbins=int(np.clip(5 * wide / high, 1, 5)))
    axes.locator_params(axis="y", nbins=int(np.clip(5 * high / wide, 2, 5)))
    axes.set_title(heading)
