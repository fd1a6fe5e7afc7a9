"""Models with friction."""
import math

from .deck import Deck
from .mesh import Mesh, graded, squared

#: Coefficient of friction, radius of each cylinder, Young's modulus and Poisson's ratio; the half-width of contact is 1.
MU, RADIUS, YOUNG, NU = 0.3, 1000.0, 1000.0, 0.3
#: Normal force that makes this half-width (Hertz), and its largest pressure.
NORMAL = math.pi * YOUNG / (4.0 * (1.0 - NU * NU)) / RADIUS
LARGEST = 2.0 * NORMAL / math.pi


def cattaneo(n=16, deep=20.0, lines=False, pushes=(0.6, -0.2), steps=1):
    """Two equal cylinders, pressed and then pushed along the contact. `pushes`: tangential loads over mu P, one after the other."""
    fine = [i / n for i in range(int(1.4 * n) + 1)]
    half = fine + [fine[-1] + x for x in graded(1.35 / n, 1.35, deep - fine[-1])[1:]]
    xs = [-x for x in reversed(half[1:])] + half
    ys = graded(0.8 / n, 1.3, deep)
    flat = squared(xs, ys)
    bow = [min(x * x / (2.0 * RADIUS) * (1.0 - y / deep), 1.0) for x, y in flat.point]
    upper = Mesh([(x, y + b) for (x, y), b in zip(flat.point, bow)], flat.element, flat.line)
    lower = Mesh([(x, -y) for x, y in upper.point], [nodes[::-1] for nodes in flat.element], flat.line)
    deck = Deck("TWO CYLINDERS PRESSED, THEN PUSHED", [
        f"Two equal cylinders, R = {RADIUS:g}, pressed by P = {NORMAL:.5f}, then pushed along the contact, back and forth. Their parts near the contact are "
        f"blocks {deep:g} half-widths high, held at the outer sides, which do not rotate. mu = {MU:g}. "
        + ("Contact of lines." if lines else "Contact of pairs of nodes."),
        f"Known answer (Cattaneo, Mindlin): half-width a = 1, p_max = {LARGEST:.5f}; under Q = {pushes[0]:g} mu P the middle sticks up to "
        f"c = {math.sqrt(max(0.0, 1.0 - pushes[0])):.5f}" + (f", then under {pushes[1]:g} mu P up to {math.sqrt(1.0 - (pushes[0] - pushes[1]) / 2.0):.5f}."
                                                   if len(pushes) > 1 else ".")], from_geometry=not lines)
    below, above = deck.bodies(("Lower cylinder", lower), ("Upper cylinder", upper))
    deck.material(1, YOUNG, NU)
    deck.material(2, YOUNG, NU)
    deck.hold(12, lower.line["top"], below)
    top = upper.line["top"]
    deck.platen(10 * above, 12, top, above)
    deck.card("SUPORT", above + top[0], 12)
    deck.wide("FORCE", 1, above + top[0], 0, NORMAL, 0.0, -1.0, 0.0)
    deck.wide("FORCE", 2, above + top[0], 0, MU * NORMAL, 1.0, 0.0, 0.0)
    near = [node for node in flat.line["bottom"] if abs(flat.point[node][0]) < 1.4 + 0.5 / n]
    if lines:
        deck.contacts((near, above), (near, below))
        deck.rubs(1, MU)
    else:
        deck.upward()
        deck.pairs(10 * above + 1, [(below + node, above + node) for node in near], 21, friction=MU)
    for case, push in enumerate((0.0, *pushes), 1):
        deck.card("LOAD", case + 10, 1.0, 1.0, 1, float(push), 2)
        deck.card("NLPARM", case, steps if push else 1)
        deck.load_case(f"PUSHED BY {push:g} MU P" if push else "PRESSED", case + 10, case)
    return deck


def traction(pushes, x):
    """Shear traction at x after these pushes over mu P, of which the second reverses the first (Cattaneo, Mindlin)."""
    def one(push):
        edge = math.sqrt(1.0 - push)
        return MU * LARGEST * (math.sqrt(max(0.0, 1.0 - x * x)) - edge * math.sqrt(max(0.0, 1.0 - (x / edge) ** 2)))

    return one(pushes[0]) - (2.0 * one((pushes[0] - pushes[1]) / 2.0) if len(pushes) > 1 else 0.0)
