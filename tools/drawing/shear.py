"""Panels of friction along each contact line: shear traction within its limits, and slip."""
import numpy as np

from drawing import pressures
from drawing.style import COLOURS, GREY

#: Formulas of the command line that begin so are values of the shear traction.
SHEAR = "shear:"


def has_friction(curves):
    return any(curve.rubs.any() for curve in curves)


def draw_shear(figure, run, curves, formulas):
    """Shear traction, its limits mu p of both signs, and known values."""
    axes, limit = figure.subplots(), "mu p and -mu p"
    for curve, colour in zip(curves, COLOURS * len(curves)):
        axes.plot(curve.s, curve.shear, "o-", ms=3, lw=1.0, color=colour, label=curve.name)
        for way in (1.0, -1.0):
            axes.plot(curve.s, way * curve.friction * curve.pressure, "--", lw=0.8, color=GREY, label=limit)
            limit = None
    pressures.draw_known(axes, curves, formulas)
    finish(axes, run, curves, f"shear traction, {run.stress_unit()}", "friction")


def draw_slip(figure, run, curves):
    """Slip since the beginning, of the pairs in contact."""
    axes = figure.subplots()
    for curve, colour in zip(curves, COLOURS * len(curves)):
        axes.plot(curve.s, np.where(curve.touching, curve.slid, np.nan), "o-", ms=3, lw=1.0, color=colour, label=curve.name)
    finish(axes, run, curves, "slip" + run.length_unit(), "slip")


def finish(axes, run, curves, what, title):
    axes.axhline(0.0, color=GREY, lw=0.5)
    axes.set(xlabel=curves[0].over + ("" if "angle" in curves[0].over else run.length_unit()), ylabel=what)
    axes.ticklabel_format(axis="y", scilimits=(-3, 4))
    axes.locator_params(axis="x", nbins=6)
    axes.legend(loc="best")
    axes.set_title(title)
