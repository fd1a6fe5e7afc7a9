"""Models of elastic bodies."""
import math

from .deck import Deck
from .mesh import block, first_free, graded, half_disc, quarter_disc, rings, squared


def cylinder_on_block(n=6.0):
    """NAFEMS R0094 no. 1: bodies of two materials."""
    b = 6.21463
    disc = quarter_disc(50.0, b, n)
    touch = [node for node in disc.line["arc"] if disc.point[node][0] < 1.5 * b]
    xs = [disc.point[node][0] for node in touch]
    beyond = graded((xs[-1] - xs[-2]) * 1.15, 1.2, 100.0 - xs[-1])
    xs += [xs[-1] + x for x in beyond[1:]]
    ys = [-y for y in reversed(graded(b / n, 1.2, 200.0))]
    base = block(xs, ys)
    deck = Deck("CYLINDER ON A BLOCK OF ANOTHER MATERIAL", [
        "A steel cylinder, R = 50 mm, on an aluminium block, 200 x 200 mm; 35 kN a mm of length (NAFEMS R0094 no. 1). Half of "
        "the model, x >= 0, upper half of the cylinder left out: the plane through its axis is a platen. Both bodies deform.",
        "Known answer (Hertz): p_max 3585.36 MPa, b 6.21463 mm."])
    _, first = deck.bodies(("Cylinder", disc), ("Block", base))
    free = first - 1
    deck.material(1, 210000.0, 0.3)
    deck.material(2, 70000.0, 0.3)
    deck.hold(1, disc.line["axis"])
    deck.hold(1, base.on(0, 0.0), first)
    deck.hold(2, base.line["bottom"], first)
    deck.platen(10 * free, 2, disc.line["top"])
    deck.push(disc.line["top"][0] + 1, 17500.0)
    deck.upward()
    deck.pairs(10 * free + 1, [(first + base.line["top"][i], node + 1) for i, node in enumerate(touch)], 21)
    return deck


def flat_punch(n=12, size=12.0, young=1000.0, element="ctria3", growth=(1.4, 1.25)):
    """Rigid flat punch on a block, all gaps zero. `growth` of the elements beside the punch, and below it."""
    xs = [math.sin(math.pi / 2 * i / n) for i in range(n + 1)]
    xs[-1] = 1.0
    xs += [1.0 + x for x in graded(1.0 - xs[-2], growth[0], size - 1.0)[1:]]
    ys = [-y for y in reversed(graded(0.4 / n, growth[1], size))]
    mesh = (squared if element == "cquad4" else block)(xs, ys)
    if element == "ctria6":
        mesh = mesh.with_middles()
    surface = [node for node in mesh.line["top"] if mesh.point[node][0] <= 1.0]
    deck = Deck("RIGID FLAT PUNCH", [
        "A rigid flat punch of half width a = 1 on an elastic block; all gaps are zero at first, so that every step of the "
        "contact search is a tie. Half of the model, x >= 0. The punch is nodes without elements, tied by RBE2; its rigid-body "
        "mode is the SUPORT. Half of P = 200 on it.",
        f"Known answer (half space): p = P/(pi sqrt(a^2 - x^2)), 63.66 at the middle; grows without bound at the edge. The "
        f"block is {size:g} a wide and deep."])
    deck.body(mesh, 1)
    deck.material(1, young, 0.3)
    deck.hold(1, mesh.on(0, 0.0))
    deck.hold(2, mesh.line["bottom"])
    deck.remark("Punch")
    free = first_free(mesh)
    first = free + 1
    for i, node in enumerate(surface):
        deck.grid(first + i, mesh.point[node][0], 0.0)
    deck.card("SPC1", 1, 1, first, "THRU", first + len(surface) - 1)
    deck.platen(10 * free, 2, range(len(surface)), first)
    deck.push(first, 100.0)
    deck.upward()
    deck.pairs(10 * free + 1, [(node + 1, first + i) for i, node in enumerate(surface)], 21)
    return deck


def off_centre(n=10, size=10.0, shift=0.25):
    """A stiff punch with an eccentric load: two rigid-body modes."""
    inside = [math.sin(math.pi / 2 * i / n) for i in range(-n, n + 1)]
    inside[0], inside[n], inside[-1] = -1.0, 0.0, 1.0
    near = min(range(2 * n + 1), key=lambda i: abs(inside[i] - shift))
    shift = inside[near]
    beyond = [1.0 + x for x in graded(1.0 - inside[-2], 1.5, size - 1.0)[1:]]
    base = block([-x for x in reversed(beyond)] + inside + beyond, [-y for y in reversed(graded(0.5 / n, 1.3, size))])
    punch = block(inside, graded(0.1, 1.3, 1.0))
    deck = Deck("STIFF PUNCH LOADED OFF CENTRE", [
        f"A nearly rigid punch (an elastic body 10000 times stiffer than the block), half width a = 1, loaded by P = 100 at e = "
        f"{shift:.6f} off its middle: two rigid-body modes, sinking and tilting, with two SUPORT DOFs at its upper corners. All "
        "gaps are zero at first.",
        f"Known answer (half space): p = P/(pi sqrt(a^2 - x^2)) (1 + 2 e x/a^2), 31.83 at the middle, slope there "
        f"{31.830989 * 2 * shift:.4f}. All pairs touch, since e < a/2."])
    _, first = deck.bodies(("Block", base), ("Punch", punch))
    free = first - 1
    deck.material(1, 1000.0, 0.3)
    deck.material(2, 1.0e7, 0.3)
    deck.hold(12, base.line["bottom"])
    top = punch.line["top"]
    deck.hold(1, [top[n]], first)
    deck.card("SUPORT", first + top[0], 2, first + top[-1], 2)
    deck.card("FORCE", 1, first + top[near], 0, 100.0, 0.0, -1.0, 0.0)
    deck.upward()
    surface = [node for node in base.line["top"] if abs(base.point[node][0]) <= 1.0]
    deck.pairs(10 * free + 1, [(node + 1, first + i) for i, node in enumerate(surface)], 21)
    return deck


def along_layer(n):
    """Points along a layer of height 1, with equal spacing in the contact: n of them in half of it."""
    step = 0.85699 / (n - 0.5)
    xs = [step * i for i in range(int(1.6 / step) + 1)]
    return xs + [xs[-1] + x for x in graded(step * 1.2, 1.3, 6.0 - xs[-1])[1:]]


def layer(n=20):
    """Layer on a rigid base without friction, point load: receding contact."""
    xs, half = along_layer(n), 16
    ys = [0.5 * (1 - math.cos(math.pi * j / half)) for j in range(half + 1)]
    mesh = block(xs, ys)
    touch = [node for node in mesh.line["bottom"] if mesh.point[node][0] < 1.5]
    deck = Deck("LAYER ON A RIGID BASE, POINT LOAD", [
        "An elastic layer of height h = 1 lies on a rigid frictionless base; P = 100 on a point of its surface. It lifts off "
        "at the sides: receding contact, whose width does not depend on P. Half of the model, x >= 0; half of P.",
        "Known answer: half contact a = 0.85699 h, pressure under the load p(0) = 0.96033 P/h = 96.033."])
    deck.body(mesh, 1)
    deck.material(1, 1000.0, 0.3)
    deck.hold(1, mesh.on(0, 0.0))
    load = mesh.line["top"][0] + 1
    deck.push(load, 50.0)
    free = first_free(mesh)
    first = free + 1
    deck.ground([mesh.point[node] for node in touch], first)
    deck.upward()
    deck.pairs(10 * free + 1, [(first + i, node + 1) for i, node in enumerate(touch)], 21)
    return deck


def shrink(around=16):
    """Shrink fit of two tubes against Lame."""
    a, c, b, overlap, young, nu = 50.0, 75.0, 100.0, 0.05, 210000.0, 0.3
    stiff = young / (1 - nu * nu)
    pressure = stiff * overlap / c * (b * b - c * c) * (c * c - a * a) / (2 * c * c * (b * b - a * a))
    parts = max(4, around // 2)
    inner = rings([a + (c - a) * j / parts for j in range(parts + 1)], around)
    outer = rings([c + (b - c) * j / parts for j in range(parts + 1)], around)
    deck = Deck("SHRINK FIT OF TWO TUBES", [
        "A tube of radii 75 and 100 shrunk on a tube of radii 50 and 75, overlap 0.05 in radius: negative initial gaps (PGAP) "
        "of coincident nodes, whose normals are the x-axes of a CORD2R each. No load. One quarter, supports in the lines of "
        "symmetry.",
        f"Known answer (Lame, plane strain): the same pressure everywhere, {pressure:.4f}."], from_geometry=False)
    free = first_free(inner, outer)
    first = free + 1
    for mesh, start, prop in ((inner, 1, 1), (outer, first, 2)):
        deck.body(mesh, prop, start)
        deck.hold(1, mesh.on(0, 0.0), start)
        deck.hold(2, mesh.on(1, 0.0), start)
    deck.steel(2)
    for i, (p, q) in enumerate(zip(inner.line["outer"], outer.line["inner"])):
        x, y = outer.point[q]
        frame, edge = 1 + i, [f if abs(f) > 1e-12 else 0.0 for f in (x / c, y / c)]
        deck.wide("CORD2R", frame, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, edge[0], edge[1], 0.0)
        deck.card("CGAP", 10 * free + 1 + i, 21, p + 1, q + first, "", "", "", frame)
    deck.card("PGAP", 21, -overlap)
    return deck


def pin(around=60):
    """Pin in a slightly larger hole of the same material: conforming contact, Persson's half angle of 45 degrees."""
    clearance, young, nu, outside = 0.001, 210000.0, 0.3, 20.0
    load = young / (1 - nu * nu) * clearance / 2.82312
    disc = half_disc(1.0, around)
    parts = graded(math.pi / around, 1.25, outside - 1.0)
    plate = rings([1.0 + clearance] + [1.0 + p for p in parts[1:]], around, math.pi, -math.pi / 2)
    deck = Deck("PIN IN A HOLE", [
        f"A pin, R = 1, in a hole larger by 0.001 in radius, same material, plate of 20 R fixed at its outer edge; P = {load:.4f} at "
        "the axis of the pin. Conforming contact: the normals are radial, each from the plate's node to the pin's (no CORD2R). "
        "The two are concentric at first, without contact. Half of the model, x >= 0; half of P.",
        f"Known answer (Persson): touching up to 45 degrees, largest pressure 0.88211 P/R = {0.88211 * load:.4f}."])
    _, first = deck.bodies(("Pin", disc), ("Plate", plate))
    free = first - 1
    deck.steel(2)
    deck.hold(1, disc.on(0, 0.0))
    inner = plate.on(0, 0.0)
    outer = plate.line["outer"]
    deck.hold(1, [node for node in inner if node not in outer], first)
    deck.hold(12, outer, first)
    deck.push(1, load / 2)
    count = round(around * 75 / 180)
    for i in range(count + 1):
        deck.card("CGAP", 10 * free + 1 + i, 21, first + plate.line["inner"][i], 1 + disc.line["edge"][i], 1.0, 0.0, 0.0)
    deck.card("PGAP", 21, 0.0)
    return deck


def patch(force_up=False, support=True):
    """Two blocks, flat interface, uniform pressure; variants have no solution."""
    lower = block([0.0, 0.7, 1.2, 2.1, 3.0], [0.0, 0.6, 1.1, 2.0])
    upper = block([0.0, 0.7, 1.2, 2.1, 3.0], [2.0, 2.5, 3.2, 4.0])
    if force_up:
        title, words = "A BODY PULLED AWAY", [
            "The upper block of the contact patch test pulled upwards, away from contact: there is no equilibrium. The run "
            "says so, names the body and ends with exit status 1."]
    elif not support:
        title, words = "A BODY WITHOUT SUPORT", [
            "The contact patch test without its SUPORT card: the upper block can translate in direction 2, and no card says "
            "that this mode is to be solved for. A deck error that prints the SUPORT card to paste; exit status 2."]
    else:
        title, words = "CONTACT PATCH TEST", [
            "Two blocks of different materials, one on the other, matching lines at a flat interface; pressure 10 on the upper "
            "face. They slide on each other without friction.",
            "Known answer, exact on any mesh: pressure 10 at every pair, sy = -10 in every element, sx = txy = 0; approach "
            "-q (1 - nu^2) (H1/E1 + H2/E2) = -10 (0.84 x 2/1000 + 0.91 x 2/3000) = -0.0228666667 of the upper face."]
    deck = Deck(title, words)
    first = 101
    deck.body(lower, 1)
    deck.body(upper, 2, first)
    deck.material(1, 1000.0, 0.4, 2.0)
    deck.material(2, 3000.0, 0.3, 2.0)
    deck.hold(1, lower.on(0, 0.0))
    deck.hold(1, upper.on(0, 0.0), first)
    deck.hold(2, lower.line["bottom"])
    top = upper.line["top"]
    if support:
        deck.card("SUPORT", first + top[-1], 2)
    for i in range(len(top) - 1):
        element = upper.side(top[i], top[i + 1])
        value = -10.0 if force_up else 10.0
        deck.card("PLOADX1", 1, first + element, value, value, first + top[i], first + top[i + 1])
    deck.upward()
    deck.pairs(1001, [(1 + p, first + q) for p, q in zip(lower.line["top"], upper.line["bottom"])], 21)
    return deck
