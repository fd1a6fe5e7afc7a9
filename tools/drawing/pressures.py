"""Panels of contact pressures along each contact line."""
import numpy as np

from drawing.run import Refused
from drawing.style import COLOURS, RED

#: A line that covers more than this angle of a circle [degrees] is shown over the angle.
BENT = 20.0
#: Up to two pressures above this multiple of all others are cut off.
ALONE = 3.0
#: Functions that a --known formula may use.
NAMES = {name: getattr(np, name) for name in ("sqrt", "log", "tan", "radians", "pi", "maximum", "minimum", "sin", "cos", "exp", "abs")}


class Curve:
    """Pressures of the part of a line in contact and its first open neighbours, in order."""

    def __init__(self, line):
        self.name = line.name
        self.over, s = abscissa(line.x, line.touching)
        order = np.argsort(s, kind="stable")
        pressed = np.flatnonzero(line.touching[order])
        shown = order[max(pressed[0] - 1, 0):pressed[-1] + 2]
        self.s, self.pressure, self.touching = s[shown], line.pressure[shown], line.touching[shown]
        self.rubs, self.friction, self.shear, self.slid = (value[shown] for value in (line.rubs, line.friction, line.shear, line.slid))


def abscissa(x, touching):
    """Abscissa of a line, and its value at each pair: an angle, x, y, or the length along it."""
    used = x[touching] if touching.sum() > 1 else x
    if len(used) >= 5:
        # The circle |x|^2 + a.x + c = 0 through the points, by least squares.
        middle, size = used.mean(axis=0), max(np.ptp(used, axis=0).max(), 1e-300)
        at = (used - middle) / size
        (a, b, c), *_ = np.linalg.lstsq(np.c_[at, np.ones(len(at))], -(at ** 2).sum(axis=1), rcond=None)
        centre, radius = np.array([-a / 2, -b / 2]), np.sqrt(max((a * a + b * b) / 4 - c, 0.0))
        off = abs(np.hypot(*(at - centre).T) - radius).max()
        middle_angle = np.arctan2(*-centre[::-1])
        turned = np.angle(np.exp(1j * (np.arctan2(*((x - middle) / size - centre).T[::-1]) - middle_angle)), deg=True)
        if off < 2e-3 * radius and np.ptp(turned[touching]) > BENT:
            around = ", ".join(f"{value:.3g}" for value in np.round(middle + size * centre, 6 - int(np.ceil(np.log10(size * radius)))) + 0.0)
            return f"angle round ({around}), degrees", turned + np.degrees(middle_angle)
    wide, high = np.ptp(used, axis=0)
    if high <= 0.3 * wide:
        return "x", x[:, 0]
    if wide <= 0.3 * high:
        return "y", x[:, 1]
    return "length along the line", np.r_[0.0, np.cumsum(np.hypot(*np.diff(x, axis=0).T))]


def curves_together(run):
    """Curves that fit into one panel: with the same abscissa, and not far apart for their widths."""
    panels = []
    for curve in (Curve(line) for line in run.lines if line.touching.any()):
        for panel in panels:
            both = np.concatenate([c.s for c in panel + [curve]])
            if panel[0].over == curve.over and np.ptp(both) <= 2.5 * max(np.ptp(c.s) for c in panel + [curve]):
                panel.append(curve)
                break
        else:
            panels.append([curve])
    return panels


def known_values(formula, s):
    """Values of a formula of the command line at the points s."""
    try:
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.broadcast_to(eval(formula, {"__builtins__": {}}, {**NAMES, "s": s}), s.shape).astype(float)
    except Exception as error:  # any exception is an error in the user's formula
        raise Refused(f'--known "{formula}": {error}; give a formula in s, such as "3585.36*sqrt(1-(s/6.21463)**2)", with {", ".join(NAMES)}') from error


def draw_known(axes, curves, formulas):
    """Draw known values along the curves."""
    ends = np.concatenate([curve.s for curve in curves])
    s = np.linspace(ends.min(), ends.max(), 801)
    label = "known"
    for formula in formulas:
        value = known_values(formula, s)
        if np.isfinite(value).any():
            axes.plot(s, value, color="black", lw=1.0, label=label)
            label = ""


def draw(figure, run, curves, formulas):
    axes = figure.subplots()
    for curve, colour in zip(curves, COLOURS * len(curves)):
        axes.plot(curve.s, curve.pressure, "o-", ms=3, lw=1.0, color=colour, label=curve.name)
    draw_known(axes, curves, formulas)
    highest = np.sort(np.concatenate([curve.pressure for curve in curves]))[::-1]
    top = highest[0]
    if len(highest) > 5 and top > ALONE * highest[2]:  # a sharp edge: not a result, and it would hide the others
        top = 1.5 * highest[2]
        axes.annotate(f"largest: {highest[0]:.4g}, at an edge", (0.5, 0.98), xycoords="axes fraction", ha="center", va="top", color=RED)
    length = "" if "angle" in curves[0].over else run.length_unit()
    axes.set(xlabel=curves[0].over + length, ylabel=f"contact pressure, {run.stress_unit()}", ylim=(0, 1.15 * top or 1.0))
    axes.locator_params(axis="x", nbins=6)
    axes.legend(loc="best" if top == highest[0] else "center")
    axes.set_title("contact pressure")
