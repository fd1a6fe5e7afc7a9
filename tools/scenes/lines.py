"""Joints of two bodies with contact between boundary lines; their meshes do not match."""
import math

from .deck import Deck
from .fill import arc, fill, finest, segment
from .mesh import rings, round_origin


def nearest(mesh, place, nodes=None):
    return min(nodes or range(len(mesh.point)), key=lambda n: (mesh.point[n][0] - place[0]) ** 2 + (mesh.point[n][1] - place[1]) ** 2)


def lip(radius, long):
    """An edge that falls along an arc: depth, and angle of the arc in degrees."""
    turn = math.asin(long / radius)
    return radius * (1 - math.cos(turn)), math.degrees(turn)


def joint_lines(load=110.0, pull=400.0, clearance=0.01, radius=30.0, edge=4.0, fine=0.26, growth=0.5, elastic=False):
    """Tongue in a socket, bent and pulled."""
    inner, tip = 4.0 + clearance, -28.0 + edge
    fall, turn = lip(radius, edge)
    tongue = fill([("below", arc((tip, -4.0 + radius), radius, -90 - turn, -90)),
                   ("below", segment((tip, -4.0), (4.0, -4.0))), (None, segment((4.0, -4.0), (30.0, -4.0))),
                   ("end", segment((30.0, -4.0), (30.0, 4.0))), (None, segment((30.0, 4.0), (4.0, 4.0))),
                   ("above", segment((4.0, 4.0), (tip, 4.0))), ("above", arc((tip, 4.0 - radius), radius, 90, 90 + turn)),
                   ("face", segment((-28.0, 4.0 - fall), (-28.0, 0.0))), ("face", segment((-28.0, 0.0), (-28.0, -4.0 + fall)))],
                  finest([((-edge, -4.0), fine / 1.3, 0.7), ((tip, 4.0), fine, 0.7)], growth, 2.5))
    socket = fill([("below", segment((-29.0, -inner), (-edge, -inner))), ("below", arc((-edge, -inner - radius), radius, 90, 90 - turn)),
                   (None, segment((0.0, -inner - fall), (0.0, -20.0))), (None, segment((0.0, -20.0), (-40.0, -20.0))),
                   ("wall", segment((-40.0, -20.0), (-40.0, 20.0))), (None, segment((-40.0, 20.0), (0.0, 20.0))),
                   (None, segment((0.0, 20.0), (0.0, inner + fall))), ("above", arc((-edge, inner + radius), radius, -90 + turn, -90)),
                   ("above", segment((-edge, inner), (-29.0, inner))), (None, arc((-29.0, inner - 1.0), 1.0, 90, 180)),
                   (None, segment((-30.0, inner - 1.0), (-30.0, 1.0 - inner))), (None, arc((-29.0, 1.0 - inner), 1.0, 180, 270))],
                  finest([((-edge, -inner), fine, 0.7), ((tip, inner), fine / 1.3, 0.7)], growth, 6.0))
    lever, apart = 30.0 + edge, 28.0 - 2 * edge
    deck = Deck("INSERT JOINT, CONTACT BETWEEN LINES", [
        f"A steel tongue, 8 high, sits 28 deep in a socket with a clearance of {clearance:g} above and below. At its end, 30 outside, "
        f"it is bent by {load:g} a mm and pulled by {pull:g}, which a tie at its inner end takes. Vertically and in rotation only "
        "contact restrains it: two SUPORT DOFs. Lines of non-matching meshes; the slave is the coarser one at either place: the "
        "socket below, the tongue above. Edges fall off along arcs, so that pressures converge.",
        ("Elastic." if elastic else "Bilinear, E = 210000, yield stress 240, H = 4000.") + f" Known by statics: it touches below at the mouth "
        f"and above at its inner end, the resultants differ by the load; with the two at the ends of the straight parts, {lever:g} and "
        f"{apart:g} apart: {load * (1 + lever / apart):.1f} and {load * lever / apart:.1f}."],
        from_geometry=False)
    one, two = deck.bodies(("Tongue", tongue), ("Socket", socket))
    for number in (1, 2):
        deck.material(number, 210000.0, 0.3)
        if not elastic:
            deck.yields(number, 240.0, 4000.0)
    deck.hold(12, socket.line["wall"], two)
    tied, end = nearest(tongue, (-28.0, 0.0)), nearest(tongue, (30.0, 0.0), tongue.line["end"])
    deck.hold(1, [tied])
    deck.card("SUPORT", one + tied, 2, one + end, 2)
    deck.press(tongue, tongue.line["end"], load / 8.0, one, 90.0)
    deck.press(tongue, tongue.line["end"], -pull / 8.0, one)
    deck.press(tongue, tongue.line["face"], -pull / (8.0 - 2 * fall), one)
    deck.contacts((socket.line["below"], two), (tongue.line["below"], 1), (tongue.line["above"], 1), (socket.line["above"], two))
    return deck


def ring_joint(press=20000.0, inside=20.0, clearance=0.02, crown=20.0, radius=30.0, edge=5.0, fine=0.38, growth=0.7):
    """Spigot and socket of a pipe: axisymmetric, pressed together, with inner pressure."""
    bore, wall, deep, long, flat = 50.0, 6.0, 30.0, 110.0, 2.0
    outer = bore + wall
    wide, middle = outer + clearance, bore + wall / 2
    (high, turn), (fall, turned) = lip(crown, flat), lip(radius, edge)
    spigot = fill([(None, segment((bore, high + 1.0), (middle - flat, high))),
                   ("nose", arc((middle, crown), crown, -90 - turn, -90)), ("nose", arc((middle, crown), crown, -90, -90 + turn)),
                   (None, segment((middle + flat, high), (outer, high + 1.0))),
                   ("outer", segment((outer, high + 1.0), (outer, deep + 4.0))), (None, segment((outer, deep + 4.0), (outer, long))),
                   ("end", segment((outer, long), (bore, long))), ("bore", segment((bore, long), (bore, high + 1.0)))],
                  finest([((middle, 0.0), fine / 7, fine / 2), ((outer, deep - edge), fine / 1.3, fine)], growth, 3.0))
    socket = fill([("shoulder", segment((wide - 1.0, 0.0), (bore, 0.0))), ("bore", segment((bore, 0.0), (bore, -60.0))),
                   ("end", segment((bore, -60.0), (bore + 10.0, -60.0))), (None, segment((bore + 10.0, -60.0), (bore + 10.0, -16.0))),
                   (None, segment((bore + 10.0, -16.0), (wide + 10.0, -10.0))), (None, segment((wide + 10.0, -10.0), (wide + 10.0, deep))),
                   (None, segment((wide + 10.0, deep), (wide + fall, deep))),
                   ("inner", arc((wide + radius, deep - edge), radius, 180 - turned, 180)),
                   ("inner", segment((wide, deep - edge), (wide, 1.0))), (None, arc((wide - 1.0, 1.0), 1.0, 0, -90))],
                  finest([((middle, 0.0), fine / 9, fine / 2), ((wide, deep - edge), fine, fine),
                          ((wide - 0.5, 0.5), 0.7, 0.0)], growth, 5.0))
    area = math.pi * (outer ** 2 - bore ** 2)
    along = -press / area
    hoop = inside * 2 * bore ** 2 / (outer ** 2 - bore ** 2)
    grows = outer / 210000.0 * (hoop - 0.3 * along)
    b = math.sqrt(8 * press / (2 * math.pi * middle) * crown * 0.91 / (math.pi * 210000.0))
    deck = Deck("SPIGOT AND SOCKET, RINGS", [
        f"A pipe of radii {bore:g} and {outer:g} stands {deep:g} deep in the socket of another, clearance {clearance:g}; pressed down by "
        f"{press:g} in all, inner pressure {inside:g} on both bores. Rings of six nodes (x: radius, y: axis; forces are totals of "
        "the ring). Two contacts: the spigot's nose, rounded, on the shoulder, its outside in the socket. Its way down is the SUPORT.",
        f"Known: the shoulder carries {press:g}; there, by Hertz, p_max {press / (math.pi * middle) / (math.pi * b):.2f}, half-width {b:.5f}; far "
        f"from the joint the pipe's outside grows by {grows:.7f} (Lame)."], from_geometry=False, rings=True)
    one, two = deck.bodies(("Spigot", spigot), ("Socket", socket))
    deck.steel(2)
    deck.hold(2, socket.line["end"], two)
    deck.card("SUPORT", one + spigot.line["end"][0], 2)
    deck.press(spigot, spigot.line["end"], press / area, one)
    deck.press(spigot, spigot.line["bore"], inside, one)
    deck.press(socket, socket.line["bore"], inside, two)
    deck.contacts((spigot.line["nose"], one), (socket.line["shoulder"], two), (socket.line["inner"], two), (spigot.line["outer"], one))
    return deck


def flange(bolt=960.0, pull=400.0, radius=100.0, edge=10.0, fine=0.5, growth=0.5):
    """Bolted flanges that open: half of a T-stub on another."""
    low, turn = lip(radius, edge)

    def half(thick, width, high, up, name, size):
        """Web at x = 0..5, flange up to `width`; upwards, or its mirror image below."""
        s = 1 if up else -1
        curves = [(name, segment((0.0, 0.0), (width - edge, 0.0))),
                  (name, arc((width - edge, s * radius), radius, -s * 90, s * (turn - 90))),
                  (None, segment((width, s * low), (width, s * thick))), (None, segment((width, s * thick), (38.0, s * thick))),
                  ("head", segment((38.0, s * thick), (26.0, s * thick))), (None, segment((26.0, s * thick), (10.0, s * thick))),
                  (None, arc((10.0, s * (thick + 5.0)), 5.0, -s * 90, -s * 180)),
                  (None, segment((5.0, s * (thick + 5.0)), (5.0, s * high))), ("end", segment((5.0, s * high), (0.0, s * high))),
                  ("axis", segment((0.0, s * high), (0.0, 0.0)))]
        if not up:  # in the opposite direction, so that the body is on the left
            curves = [(n, lambda t, c=c: c(1.0 - t)) for n, c in reversed(curves)]
        return fill(curves, size)

    upper = half(12.0, 50.0, 50.0, True, "joint", finest([((50.0 - edge, 0.0), fine, 2.0), ((30.0, 0.0), 5 * fine, 10.0)], growth, 5.0))
    lower = half(18.0, 56.0, 50.0, False, "joint", finest([((50.0 - edge, 0.0), fine / 1.3, 2.0), ((30.0, 0.0), 4 * fine, 10.0)], growth, 6.0))
    deck = Deck("BOLTED FLANGES, RECEDING JOINT", [
        f"Half of two flanges (x = 0: symmetry), 12 and 18 thick, drawn together by a bolt of {bolt:g} a mm (pressure under head and nut, x = 26 to "
        f"38) and pulled apart by {pull:g} at the webs. All gaps are zero at first; the joint opens at the web and is pressed at its outer "
        f"edge (prying). There the faces fall off with R = {radius:g} over the last {edge:g}, so that pressures converge.",
        f"Known: the contact force is bolt less pull, {bolt - pull:g}."], from_geometry=False)
    one, two = deck.bodies(("Upper flange", upper), ("Lower flange", lower))
    deck.steel(2)
    deck.hold(1, upper.line["axis"], one)
    deck.hold(1, lower.line["axis"], two)
    deck.hold(2, lower.line["end"], two)
    deck.card("SUPORT", one + upper.line["end"][0], 2)
    for mesh, first in ((upper, one), (lower, two)):
        deck.press(mesh, mesh.line["head"], bolt / 12.0, first)
    deck.press(upper, upper.line["end"], -pull / 5.0, one)
    deck.contacts((upper.line["joint"], one), (lower.line["joint"], two))
    return deck


def spinning_disc(spin=120.0, overlap=0.05, around=12, density=7.85e-9):
    """A rim shrunk on a rotating disc, against Lame."""
    bore, fit, outer, young, nu = 50.0, 100.0, 150.0, 210000.0, 0.3
    shrunk = young * overlap / fit * (outer ** 2 - fit ** 2) * (fit ** 2 - bore ** 2) / (2 * fit ** 2 * (outer ** 2 - bore ** 2))
    pull = (3 + nu) / 8 * density * (2 * math.pi * spin) ** 2 * (bore ** 2 + outer ** 2 - (bore * outer / fit) ** 2 - fit ** 2)

    def ring(inside, outside, parts, count):
        return rings([inside + (outside - inside) * j / parts for j in range(parts + 1)], count).with_middles(round_origin)

    disc = ring(bore, fit, max(2, around // 2), around)
    rim = ring(fit - overlap, outer, max(2, 2 * around // 3), max(around + 1, 4 * around // 3))
    deck = Deck("RIM SHRUNK ON A DISC THAT SPINS", [
        f"A rim of radii {fit:g} and {outer:g} shrunk on a disc with a bore of radius {bore:g}, overlap {overlap:g} in radius, both of steel, in "
        f"plane stress; they rotate {spin:g} times a second (RFORCE). One quarter, supports on the symmetry lines; lines of non-matching meshes.",
        f"Known answer (Lame, with centrifugal loads): the pressure at rest, {shrunk:.4f}, less the radial stress of the rotation there in "
        f"a disc of one piece, {pull:.4f}: {shrunk - pull:.4f}. The rim separates at {spin * math.sqrt(shrunk / pull):.2f} a second."],
        strain=False, from_geometry=False)
    first = deck.bodies(("Disc", disc), ("Rim", rim))
    for number, (mesh, start) in enumerate(zip((disc, rim), first), 1):
        deck.hold(1, mesh.on(0, 0.0), start)
        deck.hold(2, mesh.on(1, 0.0), start)
        deck.material(number, young, nu, 20.0, density)
    deck.card("RFORCE", 1, "", "", spin, 0.0, 0.0, 1.0)
    deck.contacts((disc.line["outer"], first[0]), (rim.line["inner"], first[1]))
    return deck
