"""One figure with all panels of a run."""
import matplotlib.pyplot as plt
import numpy as np

from drawing import KINDS, bodies, history, loading, pressures, shear
from drawing.run import Refused
from drawing.style import SMALL

WIDTH, HEIGHT = 9.2, 3.0  # height of a row of panels [inches]


def panels(run, formulas):
    """(type, share of the width, drawing) of each panel of this run."""
    scale = bodies.factor(run)
    found = [("shape", width(bodies.proportion(run)),
              lambda figure: bodies.draw(figure, run, f"displacements x {scale:g}" if run.solved else "as it was before the load", scale))]
    near = bodies.windows(run)
    if run.plastic.any():
        window = bodies.yielded_window(run)
        found.append(("yielded", width(bodies.proportion(run, window)),
                      lambda figure: bodies.draw(figure, run, f"yielded (red): {run.plastic.sum()} of {len(run.plastic)} elements", 1, window, run.plastic)))
        if run.unloaded:
            found.append(("yielded", width(bodies.proportion(run, window)),
                          lambda figure: bodies.draw(figure, run, f"plastic strain, {run.unloaded}", 1, window, run.accumulated > 0.0, run.accumulated)))
        near = [view for view in near if view[1] < window[1] / 4]
    for view in near:
        found.append(("shape", width(bodies.proportion(run, view)),
                      lambda figure, view=view: bodies.draw(figure, run, "at the contact, x 1", 1, view)))
    sheared = [formula.removeprefix(shear.SHEAR) for formula in formulas if formula.startswith(shear.SHEAR)]
    pressed = [formula for formula in formulas if not formula.startswith(shear.SHEAR)]
    for curves in pressures.curves_together(run):
        found.append(("contact", 1.0, lambda figure, curves=curves: pressures.draw(figure, run, curves, pressed)))
        if shear.has_friction(curves):
            found += [("friction", 1.0, lambda figure, curves=curves: shear.draw_shear(figure, run, curves, sheared)),
                      ("friction", 1.0, lambda figure, curves=curves: shear.draw_slip(figure, run, curves))]
    if run.pressed:
        found += [("history", 1.0, lambda figure: loading.draw(figure, run)), ("history", 1.0, lambda figure: loading.draw_pressures(figure, run))]
        if run.unloaded:
            found.append(("history", 1.0, lambda figure: loading.draw_residual(figure, run)))
    elif len(run.history.get("iteration", ())) > 1 and (run.plastic.any() or not run.increments):
        found.append(("history", 1.0, lambda figure: history.draw(figure, run)))
    return found


def width(proportion):
    """Share of the width for bodies of this width over height, including the colour scale."""
    return float(np.clip(0.3 + 0.75 * proportion, 0.65, 1.5))


@plt.rc_context(SMALL)
def draw(run, only=None, formulas=()):
    """The figure; `only`: panels of this kind."""
    every = panels(run, formulas)
    shown = [(share, drawing) for kind, share, drawing in every if only in (None, kind)]
    if not shown:
        why = {"contact": "no pair touches" if run.lines else "it has no contact", "yielded": "nothing yields", "friction": "it has no friction",
               "history": "it is solved at once, without iteration"}[only]
        there = ", ".join(kind for kind in KINDS if kind in {kind for kind, *_ in every})
        raise Refused(f"{run.path}: nothing to draw for --only {only}: {why}; available: {there}")
    rows = [list(part) for part in np.array_split(np.array(shown, object), -(-len(shown) // 3))]
    figure = plt.figure(figsize=(WIDTH if len(shown) > 1 else WIDTH / 2, HEIGHT * len(rows) + 0.3), layout="constrained")
    heading = f"{run.path.name}: {run.title}" if run.title else run.path.name
    figure.suptitle(heading + ("" if run.exit_status == 0 else f"  ({run.status})"), fontsize=10)
    for part, row in zip(np.atleast_1d(figure.subfigures(len(rows), 1)), rows):
        for place, (_, drawing) in zip(np.atleast_1d(part.subfigures(1, len(row), width_ratios=[share for share, _ in row])), row):
            drawing(place)
    return figure
