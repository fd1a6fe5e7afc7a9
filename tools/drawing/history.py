"""A panel of the iteration: changes, stress errors, number of pairs in contact and of yielded elements."""
import numpy as np
from matplotlib.ticker import LogLocator, NullLocator

from drawing.style import BLUE, DARK, GREEN, GREY, RED


def draw(figure, run):
    """Two plots on logarithmic scales, one above the other; grey lines mark the start of load steps."""
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    n = run.history["iteration"]
    mark = "o-" if len(n) <= 40 else "-"
    for key, colour, name in (("change", BLUE, "change"), ("stress_error", RED, "stress error")):
        positive = run.history[key] > 0
        above.semilogy(n[positive], run.history[key][positive], mark, ms=3, lw=1.0, color=colour, label=name)
    for key, colour, name in (("pairs_in_contact", DARK, "pairs touching"), ("plastic_elements", GREEN, "elements yielded")):
        positive = run.history[key] > 0
        if positive.any():
            below.semilogy(n[positive], run.history[key][positive], mark, ms=3, lw=1.0, color=colour, label=name)
    for axes in (above, below):
        for first in np.flatnonzero(np.diff(run.history["load_factor"])):
            axes.axvline(n[first] + 0.5, color=GREY, lw=0.5)
        axes.legend()
        low, high = below.get_ylim()
    low, high = low / 1.5, high * 1.5
    below.set(xlabel="iteration", ylim=(low, high))
    if high < 100 * low:   # powers of ten alone would be too few
        below.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        below.yaxis.set_minor_locator(NullLocator())
    below.yaxis.set_major_formatter("{x:g}")
    below.xaxis.get_major_locator().set_params(integer=True)
    above.set_title(f"iteration, {len(n)} solves")
