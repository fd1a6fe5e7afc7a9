"""Hertz's problems: two equal cylinders, elastic and plastic; a ball on a flat."""
import math

from .deck import Deck
from .mesh import first_free, graded, on_circle, quarter_disc, quarter_disc_squared, quarter_plane, round_origin


def disc_of(radius, b, wanted, element="ctria3"):
    """The quarter disc whose number of nodes is closest to the given one."""
    if element == "cquad4":
        candidates = [disc_squared(radius, b, k) for k in range(2, 100) if wanted < 60 * k * k < 40 * wanted]
        return min(candidates, key=lambda mesh: abs(len(mesh.point) - wanted))
    corners = wanted // 4 if element == "ctria6" else wanted
    candidates = [quarter_disc(radius, b, k / 10) for k in range(10 if corners < wanted else 20, 60 if corners < 400 else 400)
                  if 8.0 * (k / 10) ** 2 < 2 * corners < 60.0 * (k / 10) ** 2]
    best = min(candidates or [quarter_disc(radius, b, 40.0)], key=lambda mesh: abs(len(mesh.point) - corners))
    low, high = 1.0, 64.0
    if len(best.point) < 0.9 * corners:  # not finer at the contact, but farther away
        while abs(len(best.point) - corners) > 0.05 * corners and high / low > 1.01:
            far = math.sqrt(low * high)
            best = quarter_disc(radius, b, 40.0, 1.0 + 1.0 / 64.0 / far)
            low, high = (far, high) if len(best.point) < corners else (low, far)
    return curved(best, radius, element)


def curved(mesh, radius, element):
    """With mid-side nodes on the circle, if the elements have them."""
    return mesh.with_middles(on_circle((0.0, radius), radius)) if element.endswith("6") else mesh


def disc_squared(radius, b, n, far=1.0):
    """Quadrilaterals, n of them in a core 1.6 b wide."""
    core = 1.6 * b
    return quarter_disc_squared(radius, n, core, round(far * math.log(1.2 * radius / core) / math.log(1 + math.pi / (4 * n))))


def disc_spaced(spacing, far=1.0, b=0.0239, element="ctria3"):
    """The quarter disc with this spacing at the contact; the elements grow `far` times slower away from it."""
    if element == "cquad4":
        return disc_squared(1.0, b, max(2, round(1.6 * b / spacing)), far)
    return curved(quarter_disc(1.0, b, b / spacing, 1.0 + spacing / (1.6 * b) / far), 1.0, element)


#: The paper's steel: bilinear, kgf/mm2.
STEEL = [(0.0, 0.0), (85.0 / 20400.0, 85.0), (0.12, 100.0)]


def touching(mesh, reach, line="arc"):
    """Nodes of a line within SEARCH, up to a corner of an element."""
    corners = {node for nodes in mesh.element for node in (nodes[:3] if len(nodes) == 6 else nodes)}
    near = [node for node in mesh.line[line] if mesh.point[node][0] < reach]
    return near if near[-1] in corners else near[:-1]


def hertz(mesh, plastic=False, b=0.0239, increments=None):
    """Two equal cylinders as in hertz44, on a mesh that resolves the contact. `increments`: a load history, with so many until full load."""
    kind = "ELASTOPLASTIC" if plastic else "ELASTIC"
    words = ["Two equal steel cylinders, R = 1 mm, P = 10 kgf a mm of length; "
             f"{'bilinear steel' if plastic else 'elastic'}. Units kgf, mm. One quarter: x = 0 is a line "
             "of symmetry, y = 0 the plane of symmetry between the cylinders (fixed nodes), y = 1 a platen with half of P."]
    if increments:
        words.append(f"Flow theory in a sequence: loaded in {increments} increments, unloaded to a thousandth in {increments // 2}, and loaded "
                     f"again in {increments // 2}. The second loading ends in the state of the first.")
    elif plastic:
        words.append("Known answer (converged, total theory): p_max 198.42, half-width 0.030, approach 0.00142 (half of 0.00284).")
    else:
        words.append("Known answer (Hertz): p_max 266.27, b 0.0239; approach 0.00132 (half of Johnson's 0.00264).")
    element = {3: "", 4: "CQUAD4, ", 6: "CTRIA6, "}[len(mesh.element[0])]
    deck = Deck(f"TWO EQUAL STEEL CYLINDERS, {len(mesh.point)} NODES, {element}{kind}" + (", UNLOADED" if increments else ""), words, units="KGF-MM")
    touch = touching(mesh, (1.9 if plastic else 1.5) * b)
    first = first_free(mesh)
    deck.body(mesh, 1)
    deck.material(1, 20400.0, 0.29)
    if plastic:
        deck.follows(1, STEEL)
    deck.hold(1, mesh.line["axis"])
    deck.platen(10 * first, 2, mesh.line["top"])
    deck.push(mesh.line["top"][0] + 1, 5.0)
    if increments:
        deck.sequence(("LOADED", 1.0, increments), ("UNLOADED", 0.001, increments // 2), ("LOADED AGAIN", 1.0, increments // 2))
    deck.remark("Plane between the cylinders, and the pairs")
    deck.ground([(mesh.point[node][0], 0.0) for node in touch], first + 1)
    deck.upward()
    deck.pairs(10 * first + 1, [(first + 1 + i, node + 1) for i, node in enumerate(touch)], 21)
    return deck



def ball(element="ctrax6", n=4, rigid=False, far=0.6, part=0.02):
    """A ball on a flat, axisymmetric: n elements across the contact, whose radius is `part` of the ball's."""
    radius, young, nu = 10.0, 210000.0, 0.3
    a = part * radius
    stiff = young / (1 - nu * nu) / (1 if rigid else 2)
    load = 4 * stiff * a ** 3 / (3 * radius)
    growth = 1.0 + 1.0 / (1.6 * n) / far
    disc = quarter_disc(radius, a, n, growth)
    corners = [disc.point[node][0] for node in disc.line["arc"]]
    reach = [x for x in corners if x < 1.5 * a]
    disc = curved(disc, radius, element)
    touch = touching(disc, 1.5 * a)
    flat = "a rigid flat" if rigid else "a flat of the same steel"
    deck = Deck(f"BALL ON A {'RIGID' if rigid else 'DEFORMABLE'} FLAT, {element.upper()}", [
        f"A steel ball, R = {radius:g} mm, E = {young:g}, nu = {nu:g}, pressed on {flat} by {load:.3f} N, the force on the whole "
        "ring. The upper half of the ball is left out: the plane y = R is a platen. Axisymmetric: x is the radius, y the axis."
        + ("" if rigid else f" The flat is half of a ball of radius {radius:g}, fixed at its round side."),
        f"Known answer (Hertz): contact radius {a:g}, p_max {3 * load / (2 * math.pi * a * a):.2f}, approach "
        f"{a * a / radius:g} between far points: it depends on their distance and supports here."], rings=True)
    free = first_free(disc)
    deck.body(disc, 1)
    deck.material(1, young, nu)
    deck.hold(1, disc.line["axis"])
    if not rigid:
        beyond = graded((reach[-1] - reach[-2]) * growth, growth, radius - reach[-1])
        base = quarter_plane(reach[1:] + [reach[-1] + x for x in beyond[1:]])
        base = base.with_middles(round_origin) if element.endswith("6") else base
        first = free = first_free(disc, base)
        first += 1
        deck.remark("Flat")
        deck.body(base, 1, first)
        deck.hold(1, [node for node in base.line["axis"] if node not in base.line["outer"]], first)
        deck.hold(12, base.line["outer"], first)
        facing = [first + node for node in base.line["surface"][:len(touch)]]
    else:
        deck.remark("Flat")
        deck.ground([(disc.point[node][0], 0.0) for node in touch], free + 1)
        facing = range(free + 1, free + 1 + len(touch))
    deck.platen(10 * free, 2, disc.line["top"])
    deck.push(disc.line["top"][0] + 1, load)
    deck.upward()
    deck.pairs(10 * free + 1, [(there, node + 1) for there, node in zip(facing, touch)], 21)
    return deck
