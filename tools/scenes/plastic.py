"""Models that yield."""
import math

from .deck import Deck
from .elastic import flat_punch
from .mesh import Mesh, block, cells, first_free, graded, rings, round_origin, squared, without_unused


def grid(xs, ys):
    """Cells of two triangles, with the diagonal in opposite directions in alternate cells."""
    squares = squared(xs, ys)
    triangle = []
    for i, j, (a, b, c, d) in cells(len(xs), len(ys)):
        triangle += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    return Mesh(squares.point, triangle, squares.line)


def tube(title, known, pressure, young, stress, hardening, nu=0.3, inner=100.0, outer=200.0, parts=20,
         element="ctria3"):
    """Thick tube under inner pressure, plane strain, one quarter."""
    around = max(2, parts * 6 // 5)
    flat = (squared if element == "cquad4" else grid)(list(range(around + 1)), list(range(parts + 1)))
    ring = rings([inner + (outer - inner) * j / parts for j in range(parts + 1)], around)
    mesh = Mesh(ring.point, [nodes[:1] + nodes[:0:-1] for nodes in flat.element], ring.line)
    if element == "ctria6":
        mesh = mesh.with_middles(round_origin)
    squares = {"ctria3": "squares of two triangles", "ctria6": "squares of two six-node triangles", "cquad4": "quadrilaterals"}[element]
    deck = Deck(title, [
        f"A thick tube, radii {inner:g} and {outer:g}, inner pressure {pressure:g}, plane strain, total theory; one quarter, "
        f"{parts} x {around} {squares}. Nothing touches: no flexibility, no simplex.", known], from_geometry=False)
    deck.body(mesh, 1)
    deck.material(1, young, nu)
    deck.yields(1, stress, hardening)
    deck.hold(1, mesh.on(0, 0.0))
    deck.hold(2, mesh.on(1, 0.0))
    deck.press(mesh, mesh.line["inner"], pressure)
    return deck


def tube_flat(pressure, answer, parts=20, element="ctria3"):
    return tube("THICK TUBE, NO HARDENING", "E = 210, nu = 0.3, yield stress 0.24, perfectly plastic. Known answer: " + answer +
                "; first yield at 0.1037503, limit load 0.1920906.", pressure, 210.0, 0.24, 0.0, parts=parts, element=element)


def tube_locking(nu, answer, pressure=60.0, parts=10, element="cquad4"):
    """A nearly incompressible tube, elastic or plastic: elements that lock are too stiff."""
    return tube("THICK TUBE, NEARLY INCOMPRESSIBLE", f"E = 100000, nu = {nu:g}, yield stress 100, perfectly plastic. Known answer: {answer}.",
                pressure, 1.0e5, 100.0, 0.0, nu, 1.0, 2.0, parts, element)


def tube_hardening(parts=20):
    return tube("THICK TUBE, HARDENING", "E = 210000, nu = 0.3, yield stress 240, Et = 21000. Known answer: u(a) 0.154232, u(b) "
                "0.0957301, plastic radius 126.535.", 150.0, 210000.0, 240.0, 21000.0 / 0.9, parts=parts)


def bar():
    """A bar pulled in plane stress along a curve of five points."""
    mesh = grid([0.0, 1.0, 2.0, 3.0, 4.0], [0.0, 0.5, 1.0])
    deck = Deck("BAR IN TENSION", [
        "A bar, 4 x 1, pulled by 330 in plane stress, on a curve of five points (E = 200000; yield 250).",
        "Known answer: stress 330 everywhere; strain 0.01 + (330 - 320)/(380 - 320) 0.04 = 0.0166667, of which the curve's "
        "points are (0.01, 320) and (0.05, 380); end displacement 0.0666667; Poisson's ratio of the secant body 0.5 - (0.5 - "
        "0.3) E'/E = 0.4802, E' = 19800: sideways strain -0.00800333."], strain=False, from_geometry=False)
    deck.body(mesh, 1)
    deck.material(1, 200000.0, 0.3)
    deck.follows(1, [(0.0, 0.0), (0.00125, 250.0), (0.004, 290.0), (0.01, 320.0), (0.05, 380.0)])
    deck.hold(1, mesh.on(0, 0.0))
    deck.hold(2, mesh.line["bottom"])
    end = mesh.on(0, 4.0)
    deck.press(mesh, end, -330.0)
    return deck


def one_element():
    """Squares of two triangles in a state of uniform strain, sy = 0."""
    deck = Deck("UNIFORM STRAIN", [
        "Three squares of two triangles, plane strain, pulled in x and free in y: sx = 300 and 350 with Et = 21000, sx = 275 "
        "perfectly plastic. E = 210000, nu = 0.3, yield stress 240.",
        "Known answers, sx -> ex, ey, sz: 300 -> 2.13574758E-3, -1.34364875E-3, 115.851885; 350 -> 3.93080718E-3, "
        "-2.97684146E-3, 150.832007; 275 -> 2.05328221E-3, -1.32411241E-3, 107.814145 (limit 277.128). Squares have side 1: "
        "strains are the displacements of nodes 3, 13, 23."], from_geometry=False)
    deck.card("PARAM", "TOL", "1.E-10")
    square = block([0.0, 1.0], [0.0, 1.0])
    for k, (pull, hardening) in enumerate([(300.0, 21000.0 / 0.9), (350.0, 21000.0 / 0.9), (275.0, 0.0)]):
        first = 10 * k + 1
        shifted = Mesh([(x + 2.0 * k, y) for x, y in square.point], [(0, 1, 2), (0, 2, 3)], {})
        shifted.point = [shifted.point[i] for i in (0, 1, 3, 2)]
        deck.body(shifted, k + 1, first)
        deck.material(k + 1, 210000.0, 0.3)
        deck.yields(k + 1, 240.0, hardening)
        deck.hold(1, [0, 3], first)
        deck.hold(2, [0, 1], first)
        deck.press(shifted, [1, 2], -pull, first)
    return deck


def one_element_flow():
    """The first of these squares by flow theory."""
    deck = Deck("UNIFORM STRAIN, FLOW THEORY", [
        "A square of two triangles, plane strain, pulled in x by 300 and free in y, in 100 load steps of flow theory. E = 210000, "
        "nu = 0.3, yield stress 240, Et = 21000.",
        "Known answer: ex 2.1169E-3 in 100 load steps; in ever more ex 2.11434387E-3, ey -1.31270880E-3, sz 120.858415. Total theory: "
        "ex 2.13574758E-3. The square has side 1: strains are the displacements of node 3."], from_geometry=False, load_steps=100)
    deck.card("PARAM", "THEORY", "FLOW")
    square = block([0.0, 1.0], [0.0, 1.0])
    square = Mesh([square.point[i] for i in (0, 1, 3, 2)], [(0, 1, 2), (0, 2, 3)], {})
    deck.body(square, 1)
    deck.material(1, 210000.0, 0.3)
    deck.yields(1, 240.0, 21000.0 / 0.9)
    deck.hold(1, [0, 3])
    deck.hold(2, [0, 1])
    deck.press(square, [1, 2], -300.0)
    return deck


def rolling(ratio=3.9, passes=10, n=4, step=2, length=8):
    """A Hertz pressure with `n` elements in a half-width, which moves by `step` elements from load case to load case. The half plane repeats itself
    after `length` half-widths."""
    columns, deep, shear = length * n, 6.0, 200.0
    fine = [j / n for j in range(n + n // 2 + 1)]
    mesh = squared([i / n for i in range(columns + 1)], [-y for y in reversed(fine + [fine[-1] + y for y in graded(1.3 / n, 1.3, deep - fine[-1])[1:]])])
    deck = Deck("MOVING HERTZ PRESSURE", [
        f"A Hertz pressure of half-width a = 1 moves along the face of a half plane, by {step / n:g} from load case to load case, in {passes} passes. The "
        f"half plane repeats itself after {length}: both sides of this block have the same displacements (RBE2). Plane strain, E = 210000, nu = 0.3, "
        f"perfectly plastic; the yield stress in shear is k = {shear:g}, the largest pressure p0 = {ratio:g} k.",
        "Known answer: up to p0/k = 4.000, where the largest shear stress along the face, p0/4, is k, later passes cause "
        "less and less plastic strain (shakedown). Above that, each pass causes about the same plastic strain as the one before."], from_geometry=False)
    deck.body(mesh, 1)
    deck.material(1, 210000.0, 0.3)
    deck.yields(1, math.sqrt(3.0) * shear, 0.0)
    deck.hold(12, mesh.line["bottom"])
    free = first_free(mesh)
    for row, (left, right) in enumerate(zip(mesh.on(0, 0.0)[1:], mesh.on(0, float(length))[1:])):
        deck.card("RBE2", free + row, left + 1, 12, right + 1)

    def force(x):   # of the pressure left of x
        x = max(-1.0, min(1.0, x))
        return ratio * shear / 2 * (x * math.sqrt(1.0 - x * x) + math.asin(x))

    top, places = mesh.line["top"], range(0, columns, step)
    for case, place in enumerate(places, 1):
        for i in range(-n, n):
            at = (place + i) % columns
            deck.press(mesh, top[at:at + 2], n * (force((i + 1) / n) - force(i / n)), case=case)
    for turn in range(1, passes + 1):
        for case, place in enumerate(places, 1):
            deck.load_case(f"PASS {turn}, AT {place / n:g}", case)
    return deck


def cook(n=24, stress=None):
    """Cook's membrane: a tapered panel, sheared at its end."""
    flat = grid([i / n for i in range(n + 1)], [j / n for j in range(n + 1)])
    point = [(48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s)) for s, t in flat.point]
    mesh = Mesh(point, flat.element, flat.line)
    words = ["Cook's membrane: a panel 48 long, 44 high at its fixed end and 16 at the other, where a shear of 1 in all pulls it "
             "up. Plane stress, E = 1, nu = 1/3."]
    if stress:
        words.append(f"Bilinear, yield stress {stress:g}, H = 0.05. No closed form: the answer is compared with an independent program.")
    else:
        words.append("Known answer (converged, elastic): 23.964 up at the middle of the end, 25.165 at its upper corner. Linear "
                     "triangles come near it slowly.")
    deck = Deck("COOK'S MEMBRANE" + (", YIELDING" if stress else ""), words, strain=False, from_geometry=False)
    deck.body(mesh, 1)
    deck.material(1, 1.0, 1.0 / 3.0)
    if stress:
        deck.yields(1, stress, 0.05)
    deck.hold(12, mesh.on(0, 0.0))
    deck.press(mesh, mesh.on(0, 48.0), 1.0 / 16.0, theta=-90.0)
    return deck


def punch_limit(stress=23.0, steps=1, element="ctria3", n=12, size=12.0, growth=(1.4, 1.25)):
    """The flat punch on a perfectly plastic block."""
    deck = flat_punch(n, size, 1.0e5, element, growth)
    if element != "ctria3":
        deck.title = f"RIGID FLAT PUNCH, LIMIT LOAD, {element.upper()}"
        deck.words = ["The rigid flat punch on a block that yields without hardening, with elements that can flow without change "
                      "of volume. The block is deeper than 8.74 a: a shallower one, on a base without friction, would flow through to the "
                      "base under less (Hill).", f"Yield stress {stress:g}, mean pressure 100: {100 / stress:.3f} times it. Fully plastic flow "
                      "of a half plane begins at (2 + pi)/sqrt(3) = 2.968 times."]
        if steps > 1:
            deck.card("PARAM", "NLOAD", steps)
    elif steps == 1:
        deck.title = "RIGID FLAT PUNCH NEAR THE LIMIT LOAD"
        deck.words = ["The rigid flat punch on a block that yields without hardening: near the limit load of this mesh.",
                      f"Yield stress {stress:g}, mean pressure 100: {100 / stress:.3f} times it. Fully plastic flow of a half "
                      "plane begins at (2 + pi)/sqrt(3) = 2.968 times; linear triangles cannot flow without change of volume, "
                      "and this mesh carries 5.31 times (found by load steps; then displacements pass 10000 "
                      "times the elastic ones)."]
    else:
        deck.title = "RIGID FLAT PUNCH BEYOND THE LIMIT LOAD"
        deck.words = [f"The rigid flat punch on a block that yields without hardening (yield stress {stress:g}), under more than it "
                      f"carries, in {steps} load steps. The run says so, shows the last load that was carried, and ends with exit status 1."]
        deck.card("PARAM", "NLOAD", steps)
    deck.yields(1, stress, 0.0)
    return deck


def insert_joint(clearance=0.01, load=110.0, finest=0.25):
    """The paper's second model: a tongue in a socket, bent by a load at its end. The walls are thick, so that they stay elastic."""
    half = graded(finest, 1.3, 14.0)
    overlap = [-28.0 + x for x in half] + [-x for x in reversed(half[:-1])]
    outside = graded(finest, 1.3, 30.0)[1:]
    across = [-4.0, -3.7, -3.2, -2.0, 0.0, 2.0, 3.2, 3.7, 4.0]
    tongue = block(overlap + outside, across)
    wall = graded(0.3, 1.6, 16.0)
    inner = 4.0 + clearance
    rows = [-inner - w for w in reversed(wall)] + [-2.0, 0.0, 2.0] + [inner + w for w in wall]
    columns = [-40.0, -37.5, -35.0, -32.5, -30.0, -29.0] + overlap
    whole = block(columns, rows)
    middle = [(sum(whole.point[i][0] for i in c) / 3, sum(whole.point[i][1] for i in c) / 3) for c in whole.element]
    socket = without_unused(whole.point, [c for c, (x, y) in zip(whole.element, middle) if x < -30.0 or abs(y) > inner], {})
    deck = Deck("INSERT JOINT: A TONGUE IN A SOCKET", [
        f"A steel tongue, 8 high, sits 28 deep in a socket with a clearance of {clearance:g} above and below, and is bent by "
        f"{load:g} a mm at its end, 30 outside. Only contact restrains it, vertically and in rotation (two rigid-body modes, two "
        "SUPORT DOFs); a support at its middle keeps it from sliding out. Pairs on both faces.",
        "Bilinear, E = 210000, yield stress 240, H = 4000. It touches below at the mouth and above at its inner end. Known by "
        "statics: the two resultants differ by the load, and their lever is that of the load over the socket. Yielding is local: "
        "the tongue's skins and the socket's edge at the mouth. Both edges are sharp: pressures there grow with the mesh."], from_geometry=True)
    _, first = deck.bodies(("Tongue", tongue), ("Socket", socket))
    free = first - 1
    for number in (1, 2):
        deck.material(number, 210000.0, 0.3)
        deck.yields(number, 240.0, 4000.0)
    deck.hold(12, socket.on(0, -40.0), first)
    middle = next(i for i, (x, y) in enumerate(tongue.point) if abs(x) < 1e-9 and y == 0.0)
    deck.hold(1, [middle])
    end = tongue.on(0, 30.0)
    deck.card("SUPORT", 1 + tongue.on(0, -28.0)[0], 2, 1 + end[0], 2)
    for node in end:
        deck.card("FORCE", 1, 1 + node, 0, load / len(end), 0.0, -1.0, 0.0)
    deck.upward()
    at = {(round(x, 6), round(y, 6)): i for i, (x, y) in enumerate(socket.point)}
    below = [(first + at[round(tongue.point[i][0], 6), round(-inner, 6)], 1 + i) for i in tongue.line["bottom"] if tongue.point[i][0] < 1e-9]
    above = [(1 + i, first + at[round(tongue.point[i][0], 6), round(inner, 6)]) for i in tongue.line["top"] if tongue.point[i][0] < 1e-9]
    deck.pairs(10 * free + 1, below + above, 21)
    return deck
