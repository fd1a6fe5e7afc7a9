"""Teeth of gears, and a roller between its races: Hertz's contact of real machine parts."""
import math

from .deck import Deck
from .fill import arc, fill, finest, segment
from .lines import nearest


def hertz(load, curvature, young=210000.0, nu=0.3):
    """Half-width and largest pressure of two bodies of the same material."""
    stiff = young / (2 * (1 - nu * nu))
    b = math.sqrt(4 * load / (math.pi * stiff * curvature))
    return b, 2 * load / (math.pi * b)


def tooth(module, teeth, up, fine, growth, angle=20.0):
    """A tooth with its part of the rim; its pitch point is the origin, the outer normal of its flank is along y."""
    alpha = math.radians(angle)
    pitch = module * teeth / 2
    base, root, tip, round_ = pitch * math.cos(alpha), pitch - 1.25 * module, pitch + module, 0.38 * module
    inside, opening = root - 2.0 * module, 1.8 * math.pi / teeth
    begins = math.pi / (2 * teeth) + math.tan(alpha) - alpha  # angle of the involute on the base circle
    turned = math.radians(90.0 if up else 270.0) - (math.pi / (2 * teeth) - alpha + math.pi / 2)
    px, py = pitch * math.cos(math.pi / (2 * teeth)), pitch * math.sin(math.pi / (2 * teeth))

    def place(x, y):
        x, y = x - px, y - py
        return x * math.cos(turned) - y * math.sin(turned), x * math.sin(turned) + y * math.cos(turned)

    def polar(radius, theta):
        return place(radius * math.cos(theta), radius * math.sin(theta))

    def involute(side, t):
        return polar(base * math.sqrt(1 + t * t), side * (begins - t + math.atan(t)))

    def circle(radius, begin, end):
        return lambda s: polar(radius, begin + s * (end - begin))

    # The fillet's centre lies on the flank's parallel curve, also an involute; or the flank continues along the radius.
    high = root + round_
    t0 = (math.sqrt(max(high * high - base * base, 0.0)) - round_) / base
    if t0 > 0:
        normal = begins - t0 + math.pi / 2
        cx, cy = (base * math.cos(begins - t0) + (base * t0 + round_) * math.cos(normal),
                  base * math.sin(begins - t0) + (base * t0 + round_) * math.sin(normal))
    else:
        t0, normal = 0.0, begins + math.pi / 2
        foot = math.sqrt(high * high - round_ * round_)
        cx, cy = (foot * math.cos(begins) + round_ * math.cos(normal), foot * math.sin(begins) + round_ * math.sin(normal))
    middle = math.atan2(cy, cx)

    def fillet(side, way):
        def curve(s):
            theta = normal + math.pi + (s if way > 0 else 1 - s) * (middle - normal)
            return place(cx + round_ * math.cos(theta), side * (cy + round_ * math.sin(theta)))
        return curve

    last, tp = math.sqrt((tip / base) ** 2 - 1), math.tan(alpha)
    tip_angle = begins - last + math.atan(last)
    foot_radius = math.sqrt(high * high - round_ * round_)
    straight = [] if t0 > 0 else [(None, segment(polar(base, begins), polar(foot_radius, begins)))]
    back = [] if t0 > 0 else [(None, segment(polar(foot_radius, -begins), polar(base, -begins)))]
    pieces = [(None, circle(root, -opening, -middle)), (None, fillet(-1, -1)), *back,
              (None, lambda s: involute(-1, t0 + s * (last - t0))), (None, circle(tip, -tip_angle, tip_angle)),
              ("flank", lambda s: involute(1, last + s * (tp - last))), ("flank", lambda s: involute(1, tp + s * (t0 - tp))), *straight,
              (None, fillet(1, 1)), (None, circle(root, middle, opening)),
              ("rim", segment(polar(root, opening), polar(inside, opening))), ("rim", circle(inside, opening, -opening)),
              ("rim", segment(polar(inside, -opening), polar(root, -opening)))]
    spots = [((0.0, 0.0), fine, 5 * fine)] + [(fillet(side, 1)(0.5), 0.16 * module, 0.1 * module) for side in (1, -1)]
    return fill(pieces, finest(spots, growth, 0.8 * module))


def gears(module=4.0, z1=20, z2=40, load=600.0, across=3.5, finer=1.3, growth=0.5):
    """A pair of involute teeth in contact at the pitch point."""
    radius = [module * z / 2 * math.sin(math.radians(20.0)) for z in (z1, z2)]
    b, p0 = hertz(load, 1 / radius[0] + 1 / radius[1])
    one_mesh = tooth(module, z1, True, b / across, growth)
    two_mesh = tooth(module, z2, False, b / across / finer, growth)
    deck = Deck("TEETH OF TWO SPUR GEARS", [
        f"A tooth of a gear of {z1} teeth and one of {z2}, module {module:g}, pressure angle 20 degrees, that touch at the pitch point; plane strain. "
        f"The line of action is y. The lower rim moves as one along it, pushed by {load:g} a mm; the upper rim is fixed. Lines of "
        "non-matching meshes on the two flanks, from fillet to tip.",
        f"Known answer (Hertz, the involutes' radii of curvature there, {radius[0]:.4f} and {radius[1]:.4f}): p_max {p0:.2f}, half-width {b:.5f}."],
        from_geometry=False)
    one, two = deck.bodies((f"Tooth of {z1}", one_mesh), (f"Tooth of {z2}", two_mesh))
    deck.steel(2)
    rim = one_mesh.line["rim"]
    deck.hold(1, rim, one)
    deck.hold(12, two_mesh.line["rim"], two)
    deck.platen(10 * two, 2, rim, one)
    deck.push(one + rim[0], load, 1.0)
    deck.contacts((one_mesh.line["flank"], one), (two_mesh.line["flank"], two))
    return deck


def roller(radius=5.0, inner=20.0, load=1000.0, across=3.0, finer=1.3, growth=0.5):
    """A roller between the races of a bearing, half of it."""
    outer, wall, opening = inner + 2 * radius, 8.0, 25.0
    wide = [hertz(load, 1 / radius + sign / race) for sign, race in ((1, inner), (-1, outer))]
    (b1, p1), (b2, p2) = wide
    low, high, middle = (0.0, inner), (0.0, outer), (0.0, inner + radius)
    body = fill([("below", arc(middle, radius, -90, 0)), ("above", arc(middle, radius, 0, 90)),
                 ("axis", segment(high, middle)), ("axis", segment(middle, low))],
                finest([(low, b1 / across, 1.4 * b1), (high, b2 / across, 1.4 * b2)], growth, 1.0))
    begin = 90 - opening

    def sector(inside, outside, place, size):
        return fill([("inside", lambda s: arc((0.0, 0.0), inside, begin, 90)(1 - s)),
                     (None, segment(arc((0.0, 0.0), inside, begin, 90)(0.0), arc((0.0, 0.0), outside, begin, 90)(0.0))),
                     ("outside", arc((0.0, 0.0), outside, begin, 90)), ("axis", segment((0.0, outside), (0.0, inside)))],
                    finest([(place, *size)], growth, 2.0))

    inside = sector(inner - wall, inner, low, (b1 / across / finer, 1.5 * b1))
    outside = sector(outer, outer + wall, high, (b2 / across / finer, 1.5 * b2))
    deck = Deck("ROLLER BETWEEN TWO RACES", [
        f"A roller, R = {radius:g}, between the inner race of a bearing (R = {inner:g}, convex) and the outer one (R = {outer:g}, hollow); plane "
        f"strain, half of it, x >= 0. The bore of the inner race moves up as one with half of {load:g} a mm; the outside of the outer race "
        "is fixed. The roller and the inner race are unconstrained in y: two SUPORT DOFs.",
        f"Known answer (Hertz): inner contact p_max {p1:.2f}, half-width {b1:.5f}; outer contact {p2:.2f}, {b2:.5f}."], from_geometry=False)
    one, two, three = deck.bodies(("Roller", body), ("Inner race", inside), ("Outer race", outside))
    deck.steel(3)
    for mesh, first in ((body, one), (inside, two), (outside, three)):
        deck.hold(1, mesh.line["axis"], first)
    deck.hold(12, [n for n in outside.line["outside"] if n not in outside.line["axis"]], three)
    deck.hold(2, [n for n in outside.line["outside"] if n in outside.line["axis"]], three)
    bore = inside.line["inside"]
    deck.platen(10 * three, 2, bore, two)
    deck.card("SUPORT", one + nearest(body, middle), 2, two + bore[0], 2)
    deck.card("FORCE", 1, two + bore[0], 0, load / 2, 0.0, 1.0, 0.0)
    deck.contacts((body.line["below"], one), (inside.line["outside"], two), (body.line["above"], one), (outside.line["inside"], three))
    return deck
