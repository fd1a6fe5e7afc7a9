"""Contact between lines on ordered meshes of any element. The slave line is the coarser one, the master's mesh `finer` times finer: in the
opposite case pressures oscillate."""
import math

from .deck import STEEL, Deck
from .elastic import along_layer
from .lines import nearest
from .mesh import graded
from .patches import arc, even, halves, join, patch, straight, walk

#: Elements with mid-side nodes.
QUADRATIC = ("ctria6", "cquad8")


def grid(xs, ys, element):
    """A rectangle of elements between these coordinates."""
    (left, right), (low, high) = (xs[0], xs[-1]), (ys[0], ys[-1])
    return join([patch(straight((left, low), (right, low), halves(xs)), straight((left, high), (right, high), halves(xs)),
                       straight((left, low), (left, high), halves(ys)), straight((right, low), (right, high), halves(ys)))], element)


def persson(half):
    """Pin in a hole of the same material, half angle of contact in degrees: E* clearance/P and largest pressure times R/P."""
    b = math.tan(math.radians(half) / 2)
    c = 1 + b * b
    return ((2 - math.log(c) - 2 * b ** 4) / (math.pi * b * b * c),
            2 * b / (math.pi * math.sqrt(c)) + math.log((math.sqrt(c) + b) / (math.sqrt(c) - b)) / (2 * math.pi * b * b * c))


def pin_in_lug(half=45.0, around=24, finer=1.4, size=30.0, element="ctria6"):
    """Pin in the hole of a large lug, non-matching meshes: Persson's half angle is given, the clearance follows."""
    radius, load, stiff = 10.0, 1000.0, STEEL / (1 - 0.09)
    if not 0 < half < 84.8:   # above it, Persson's pin has no clearance
        raise ValueError(f"half {half:g}: give an angle above 0 and below 84.8")
    slack, top = persson(half)
    clearance = slack * load / stiff
    around = 4 * round(around / 4)
    quarter, c = around // 4, 0.55 * radius
    corner = c / math.sqrt(2)
    depth = even(max(2, round(around * 0.16)))
    s, lug_around = even(quarter), 2 * round(around * finer / 2)
    square = [patch(straight((0.0, -corner), (corner, -corner), s), straight((0.0, corner), (corner, corner), s),
                    straight((0.0, -corner), (0.0, corner), even(2 * quarter)), straight((corner, -corner), (corner, corner), even(2 * quarter)))]
    places = [(0.0, -corner), (corner, -corner), (corner, corner), (0.0, corner)]
    for k, (begin, end) in enumerate(((-90, -45), (-45, 45), (45, 90))):
        parts = even(2 * quarter if k == 1 else quarter)
        outer = arc((0.0, 0.0), radius, begin, end, parts)
        square.append(patch(straight(places[k], places[k + 1], parts), outer, straight(places[k], outer[0], depth),
                            straight(places[k + 1], outer[-1], depth)))
    pin = join(square, element)
    hole = radius + clearance
    outward = halves(graded(math.pi * hole / lug_around, 1.5 if element in QUADRATIC else 1.3, (size - 1) * radius))
    turns = even(lug_around)
    lug = join([patch(arc((0.0, 0.0), hole, 90, -90, turns), arc((0.0, 0.0), size * radius, 90, -90, turns),
                      straight((0.0, hole), (0.0, size * radius), outward), straight((0.0, -hole), (0.0, -size * radius), outward))], element)
    deck = Deck("PIN IN A LUG, CONTACT BETWEEN LINES", [
        f"A pin, R = {radius:g}, in a hole larger by {clearance:.7f} in radius, of the same material, in a lug of {size:g} R fixed at its outer "
        f"edge; {load:g} a mm at the axis of the pin. Non-matching meshes. Half of the model, x >= 0; half of the load. The two are concentric "
        "at first and touch nowhere.",
        f"Known answer (Persson): touching up to {half:g} degrees, largest pressure {top * load / radius:.4f}."], from_geometry=False)
    one, two = deck.bodies(("Pin", pin), ("Lug", lug))
    deck.steel(2)
    deck.hold(1, pin.on(0, 0.0), one)
    outside = walk(lug, (0.0, -size * radius), (0.0, size * radius))
    deck.hold(1, [n for n in lug.on(0, 0.0) if n not in outside], two)
    deck.hold(12, outside, two)
    centre = one + nearest(pin, (0.0, 0.0))
    deck.push(centre, load / 2)
    deck.contacts((walk(pin, (0.0, -radius), (radius, 0.0)), one), (walk(lug, (hole, 0.0), (0.0, -hole)), two))
    return deck


def nafems(across=5.0, finer=1.4, element="ctria6"):
    """NAFEMS R0094 no. 1: a steel cylinder on an aluminium block."""
    radius, b = 50.0, 6.21463
    growth = 1.5 if element in QUADRATIC else 1.25

    def around_core(across, surface, deep, long, below):
        """A core of squares at the contact and two patches around it, right of the axis, y into the body. `surface`: points on it for
        fractions of its length `long`; `deep`, `below`: corners of the body, to the right and on the axis."""
        parts = round(1.6 * across)
        core, step = 1.6 * b, 1.6 * b / parts
        e, out = even(parts), halves(graded(step * growth, growth, 100.0))
        a, corner = surface(core / long), (core, core + surface(core / long)[1])
        axis = (0.0, core)
        return [patch([surface(s * core / long) for s in e], straight(axis, corner, e), straight((0.0, 0.0), axis, e), straight(a, corner, e)),
                patch([surface(core / long + s * (1 - core / long)) for s in out], straight(corner, deep, out), straight(a, corner, e),
                      straight(surface(1.0), deep, e)),
                patch(straight(axis, corner, e), straight(below, deep, e), straight(axis, below, out), straight(corner, deep, out))]

    def on_disc(s):  # s = 0 at the contact, 1 at the height of the axis; the core is core/far of it
        angle = s * math.pi / 2
        return radius * math.sin(angle), radius * (1 - math.cos(angle))

    disc = join(around_core(across, on_disc, (25.0, radius), radius * math.pi / 2, (0.0, radius)), element)
    block = around_core(across * finer, lambda s: (100.0 * s, 0.0), (100.0, 200.0), 100.0, (0.0, 200.0))
    below = join([[[(x, -y) for x, y in row] for row in rows] for rows in block], element)
    deck = Deck("CYLINDER ON A BLOCK, CONTACT BETWEEN LINES", [
        "A steel cylinder, R = 50 mm, on an aluminium block, 200 x 200 mm; 35 kN a mm of length (NAFEMS R0094 no. 1). Half of "
        "the model, x >= 0; a platen at its axis replaces the upper half of the cylinder. Non-matching meshes.",
        "Known answer (Hertz): p_max 3585.36 MPa, b 6.21463 mm."], from_geometry=False)
    one, two = deck.bodies(("Cylinder", disc), ("Block", below))
    deck.material(1, STEEL, 0.3)
    deck.material(2, 70000.0, 0.3)
    deck.hold(1, disc.on(0, 0.0), one)
    deck.hold(1, below.on(0, 0.0), two)
    deck.hold(2, below.on(1, -200.0), two)
    top = disc.on(1, radius)
    deck.platen(10 * two, 2, top, one)
    deck.push(one + top[0], 17500.0)
    deck.contacts((walk(disc, (0.0, 0.0), (radius * math.sin(0.5), radius * (1 - math.cos(0.5)))), one),
                  (walk(below, (40.0, 0.0), (0.0, 0.0)), two))
    return deck


def layer_lines(n=20, element="ctria6"):
    """Layer on a rigid base without friction, point load: receding contact of lines."""
    xs = along_layer(n)
    rows = 10 if element in QUADRATIC else 16
    layer = grid(xs, [0.5 * (1 - math.cos(math.pi * j / rows)) for j in range(rows + 1)], element)
    parts = round(1.3 * 1.6 / xs[1])
    base = grid([1.6 * i / parts for i in range(parts + 1)], [-0.1, 0.0], "ctria3" if element == "ctria6" else element)
    deck = Deck("LAYER ON A RIGID BASE, CONTACT BETWEEN LINES", [
        "An elastic layer of height h = 1 lies on a rigid frictionless base (elements whose nodes are all fixed); P = 100 on a point of "
        "its surface. It lifts off at the sides: receding contact, whose width does not depend on P. Half of the model, x >= 0; half of P.",
        "Known answer: half contact a = 0.85699 h, pressure under the load p(0) = 0.96033 P/h = 96.033."], from_geometry=False)
    one, two = deck.bodies(("Layer", layer), ("Base", base))
    deck.material(1, 1000.0, 0.3)
    deck.material(2, 1000.0, 0.3)
    deck.hold(1, layer.on(0, 0.0), one)
    deck.hold(12, range(len(base.point)), two)
    load = one + nearest(layer, (0.0, 1.0))
    deck.push(load, 50.0)
    deck.contacts((walk(layer, (0.0, 0.0), (1.5, 0.0)), one), (walk(base, (1.6, 0.0), (0.0, 0.0)), two))
    return deck


def flat_match(lines=True, element="cquad4"):
    """Two blocks with matching meshes at a flat line, under an uneven pressure; as pairs, or as lines."""
    xs = [0.0, 0.6, 1.3, 2.0, 2.8, 3.5, 4.0]
    lower, upper = grid([-2.0, -1.2, -0.5] + xs + [4.6, 5.4, 6.5], [-3.0, -2.0, -1.2, -0.5, 0.0], element), grid(xs, [0.0, 0.6, 1.4, 2.5], element)
    deck = Deck("FLAT LINE, MATCHING MESHES: " + ("LINES" if lines else "PAIRS"), [
        "A block on a larger one, meshes that match at the flat contact; pressure 10 on the left half of the upper face, 4 on the right: it "
        "tilts, two rigid-body modes. One model in two decks: flat_pairs.dat by CGAP, flat_lines.dat by BLSEG and BCONP.",
        "Known: both give the same answer, to rounding; 28 in all."], from_geometry=False)
    one, two = deck.bodies(("Upper block", upper), ("Lower block", lower))
    deck.material(1, 3000.0, 0.3)
    deck.material(2, 1000.0, 0.3)
    deck.hold(12, lower.on(1, -3.0), two)
    deck.hold(1, [nearest(upper, (0.0, 2.5))], one)
    deck.card("SUPORT", one + nearest(upper, (0.0, 2.5)), 2, one + nearest(upper, (4.0, 2.5)), 2)
    top = walk(upper, (4.0, 2.5), (0.0, 2.5))
    half = top.index(nearest(upper, (2.0, 2.5)))
    deck.press(upper, top[:half + 1], 4.0, one)
    deck.press(upper, top[half:], 10.0, one)
    touching, facing = walk(upper, (0.0, 0.0), (4.0, 0.0)), walk(lower, (4.0, 0.0), (0.0, 0.0))
    if lines:
        deck.contacts((touching, one), (facing, two))
    else:
        deck.upward()
        deck.pairs(100 * two, [(two + a, one + b) for a, b in zip(reversed(facing), touching)], 21)
    return deck
