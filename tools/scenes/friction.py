"""Models with friction."""
import math

from .deck import STEEL, Deck
from .mesh import Mesh, block, graded, squared

#: Coefficient of friction, radius of each cylinder, Young's modulus and Poisson's ratio; the half-width of contact is 1.
MU, RADIUS, YOUNG, NU = 0.3, 1000.0, 1000.0, 0.3
#: Normal force that makes this half-width (Hertz), and its largest pressure.
NORMAL = math.pi * YOUNG / (4.0 * (1.0 - NU * NU)) / RADIUS
LARGEST = 2.0 * NORMAL / math.pi


def cattaneo(n=16, deep=20.0, lines=False, pushes=(0.6, -0.2), steps=1, yields=None, element="cquad4", growth=(1.35, 1.3), reach=1.4):
    """Two equal cylinders, pressed and then pushed along the contact. `pushes`: tangential loads over mu P, one after the other. `growth`: of
    the elements along the contact, beyond `reach`, and away from it. `yields`: the yield stress; the steel hardens by a hundredth."""
    fine = [i / n for i in range(int(reach * n) + 1)]
    half = fine + [fine[-1] + x for x in graded(growth[0] / n, growth[0], deep - fine[-1])[1:]]
    xs = [-x for x in reversed(half[1:])] + half
    ys = graded(0.8 / n, growth[1], deep)
    flat = (squared if element == "cquad4" else block)(xs, ys)
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
    for number in (1, 2) if yields else ():
        deck.yields(number, yields, YOUNG / 100.0)
    deck.hold(12, lower.line["top"], below)
    top = upper.line["top"]
    deck.platen(10 * above, 12, top, above)
    deck.card("SUPORT", above + top[0], 12)
    deck.wide("FORCE", 1, above + top[0], 0, NORMAL, 0.0, -1.0, 0.0)
    deck.wide("FORCE", 2, above + top[0], 0, MU * NORMAL, 1.0, 0.0, 0.0)
    near = [node for node in flat.line["bottom"] if abs(flat.point[node][0]) < reach + 0.5 / n]
    if lines:
        deck.contacts((near, above), (near, below))
        deck.rubs(1, MU)
    else:
        deck.upward()
        deck.pairs(10 * above + 1, [(below + node, above + node) for node in near], 21, friction=MU)
    for case, push in enumerate((0.0, *pushes), 1):
        deck.card("LOAD", case + 10, 1.0, 1.0, 1, float(push), 2)
        deck.card("NLPARM", case, steps if push or yields else 1)
        deck.load_case(f"PUSHED BY {push:g} MU P" if push else "PRESSED", case + 10, case)
    return deck


def traction(pushes, x):
    """Shear traction at x after these pushes over mu P, of which the second reverses the first (Cattaneo, Mindlin)."""
    def one(push):
        edge = math.sqrt(1.0 - push)
        return MU * LARGEST * (math.sqrt(max(0.0, 1.0 - x * x)) - edge * math.sqrt(max(0.0, 1.0 - (x / edge) ** 2)))

    return one(pushes[0]) - (2.0 * one((pushes[0] - pushes[1]) / 2.0) if len(pushes) > 1 else 0.0)


def largest_traction(pushes):
    """Largest magnitude of that traction."""
    return max(abs(traction(pushes, 0.0005 * k)) for k in range(2001))


#: Nodes of the half-plane in and beside the contact with a cylinder; stick half-width over a for mu .2, as that of a punch.
EVEN, STICK = [k / 80 for k in range(93)], 0.3604


def half_plane(places, mu, radius=None, steps=1, size=200.0):
    """A rigid flat punch or cylinder, pressed on an elastic half-plane; half of the model. `places`: nodes under it. The outer edges of the block, `size` half-widths
    from the middle, carry the stresses of a half-plane under this load (Flamant): with free edges the stick half-width would be 2 % larger for mu .2."""
    xs = places + [places[-1] + x for x in graded(1.12 * (places[-1] - places[-2]), 1.12, size - places[-1])[1:]]
    mesh = squared(xs, [-y for y in reversed(graded(0.4 * places[1], 1.12, size))])
    first, load = 80001, NORMAL / 2.0
    deck = Deck("PRESSED ON A HALF-PLANE", [], load_steps=steps)
    deck.body(mesh, 1)
    deck.material(1, YOUNG, NU)
    deck.hold(1, mesh.on(0, 0.0))
    deck.hold(2, [0])
    for k, x in enumerate(places):
        deck.grid(first + k, x, x * x / (2.0 * radius) if radius else 0.0)
    deck.card("SPC1", 1, 1, first, "THRU", first + len(places) - 1)
    deck.platen(90000, 2, range(len(places)), first)
    deck.push(first, load)
    outer = sorted((math.atan2(x, -y), node) for node, (x, y) in enumerate(mesh.point) if max(x, -y) > 0.999 * size)
    for (a, one), (b, other) in zip(outer, outer[1:]):
        across, up = (math.sin(a) ** 2 - math.sin(b) ** 2) / 2, (b - a) / 2 + (math.sin(2 * b) - math.sin(2 * a)) / 4
        for node in (one, other):
            deck.wide("FORCE", 1, node + 1, 0, 2.0 * load / math.pi, across, up, 0.0)
    deck.upward()
    deck.pairs(90001, [(mesh.line["top"][k] + 1, first + k) for k in range(len(places))], 21, friction=mu)
    return deck


def pull_off(friction=0.15, overlap=0.02, long=40.0, nu=0.0, around=8, pull=0.004):
    """A ring shrunk on a tube and pulled off along the axis, against Lame."""
    bore, fit, outer = 20.0, 40.0, 60.0
    inside = fit - overlap
    softness = (fit ** 2 + bore ** 2) / (fit ** 2 - bore ** 2) + (outer ** 2 + inside ** 2) / (outer ** 2 - inside ** 2)   # without Poisson's ratio
    pressure = STEEL * overlap / fit / softness
    area = 2 * math.pi * fit * long

    def wall(inside, outside, parts, rows):
        mesh = block([inside + (outside - inside) * i / parts for i in range(parts + 1)], [long * j / rows for j in range(rows + 1)])
        named = {"inner": mesh.on(0, inside), "outer": mesh.on(0, outside)}
        return Mesh(mesh.point, mesh.element, {**mesh.line, **named}).with_middles()

    tube, ring = wall(bore, fit, around, 2 * around), wall(inside, outer, around, 2 * around + 4)
    steps = 0.25, 0.5, 0.75, 1.0
    deck = Deck("A RING PULLED OFF ITS TUBE", [
        f"A ring of radii {fit:g} and {outer:g} is shrunk on a tube of radii {bore:g} and {fit:g}, overlap {overlap:g} in radius, both {long:g} long; steel with "
        f"Poisson's ratio {nu:g}. Then the lower end of the tube is moved down by {pull:g}, while the upper end of the ring is fixed. mu = {friction:g}. "
        "Axisymmetric; lines of non-matching meshes.",
        f"Known answer (Lame): mean pressure {pressure:.4f}, with Poisson's ratio 0 also while the ring is pulled. It slips off under mu p times the area, "
        f"{friction * pressure * area:.1f}."],
        from_geometry=False, rings=True)
    one, two = deck.bodies(("Tube", tube), ("Ring", ring))
    deck.material(1, STEEL, nu)
    deck.material(2, STEEL, nu)
    deck.hold(2, tube.line["bottom"], one)
    deck.hold(2, ring.line["top"], two)
    deck.contacts((tube.line["outer"], one), (ring.line["inner"], two))
    deck.rubs(1, friction)
    for case, part in enumerate((0.0, *steps), 1):
        for node in tube.line["bottom"]:
            deck.wide("SPCD", case + 10, one + node, 2, -part * pull)
        deck.card("NLPARM", case, 4 if part else 1)
        deck.load_case(f"PULLED BY {part * pull:g}" if part else "SHRUNK", case + 10, case)
    return deck
