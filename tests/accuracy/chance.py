"""Random models for the score of the error estimates, with contacts that no deck of the repository has.

A seed gives a model: the shapes of two bodies (cylinders and balls, on flats, in grooves, in holes; rounded and sharp
punches; wedges; layers; stacks of blocks; eccentric loads), their materials, whether they yield, and their contact (CGAP pairs, lines, a rigid
side). Mesh size and element type are given separately. All lengths are relative to the half-width, about 1.
"""
import dataclasses
import math
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from scenes import quads  # noqa: E402
from scenes.deck import Deck  # noqa: E402
from scenes.mesh import corners_of, first_free  # noqa: E402
from scenes.patches import join, walk  # noqa: E402

PLANE, RINGS = ("ctria3", "ctria6", "cquad4"), ("ctrax3", "ctrax6")
FAMILIES = ("round",) * 4 + ("groove", "rounded punch", "sharp punch", "wedge", "layer", "tilted", "hole", "stack")
#: Models whose largest pressure is singular.
SHARP = ("sharp punch", "wedge")


@dataclasses.dataclass
class Scene:
    """The model, without its mesh."""
    family: str
    rings: bool
    young: tuple            # of the upper body and the lower
    stress: float = 0.0     # yield stress; 0 if elastic
    hardening: float = 0.0  # relative to Young's modulus
    yielding: float = 0.0   # load over that of first yield
    nu: float = 0.3
    rigid: bool = False     # the lower body
    lines: bool = False     # contact between lines, otherwise CGAP pairs
    exchanged: bool = False # the upper body's line is the master
    whole: bool = False     # both sides of the symmetry line
    sheet: bool = False
    radius: float = 10.0
    flat: float = 0.5       # of a rounded punch; loaded width of a layer
    other: float = 0.0      # curvature of the lower body
    load: float = 1.0
    width: float = 1.0      # half-width of the contact, as computed
    lasts: float = 1.6      # extent of the pairs relative to it
    wide: tuple = (10.0, 10.0)
    deep: tuple = (10.0, 10.0)


@dataclasses.dataclass
class Fineness:
    """Mesh of a model."""
    pairs: float            # elements in half of the contact
    growth: float           # growth of elements away from it
    finer: float            # the other body
    shift: float            # random shift of the nodes along the surface, relative to an element
    stretch: float          # depth of the first element over its length along the surface
    jitter: float           # random shift of the nodes inside
    seed: int


def draw(seed, rings, yielding):
    """Draw a model from the seed alone."""
    chance = random.Random(f"{seed} {rings} {yielding}")
    families = [f for f in FAMILIES if not (rings and f in ("tilted", "hole", "groove", "stack"))]
    family = chance.choice(families)
    rigid = family in ("round", "rounded punch", "wedge", "layer") and chance.random() < 0.3
    ratio = math.exp(chance.uniform(0.0, math.log(20.0)))
    young = (1000.0, 1000.0 * ratio) if chance.random() < 0.5 else (1000.0 * ratio, 1000.0)
    scene = Scene(family, rings, young, nu=chance.uniform(0.1, 0.45), rigid=rigid, flat=chance.uniform(0.3, 0.9))
    scene.lines = not rigid and (family in ("groove", "hole", "tilted") or chance.random() < (0.3 if rings else 0.5))
    scene.exchanged = family != "hole" and chance.random() < 0.3
    scene.whole = family in ("tilted", "stack") or not rings and family not in ("layer", "hole", "sharp punch") and chance.random() < 0.4
    scene.sheet = not rings and chance.random() < 0.2
    scene.radius = 1.0 / math.exp(chance.uniform(math.log(0.02), math.log(0.2)))
    scene.other = {"groove": -chance.uniform(0.3, 0.9), "round": chance.choice((0.0, 0.0, chance.uniform(0.2, 2.0)))}.get(family, 0.0) / scene.radius
    scene.wide = tuple(min(chance.uniform(5.0, 20.0), 0.8 * scene.radius) for _ in range(2))
    scene.deep = tuple(max(0.0, profile(scene, k, scene.wide[k])) + chance.uniform(4.0, 20.0) for k in range(2))
    if family == "stack":
        scene.wide = 1.0, 1.0
    if family == "layer":
        scene.deep = chance.uniform(0.4, 0.9), scene.deep[1]
    if yielding:
        scene.yielding = chance.uniform(1.0, 3.0)
        scene.hardening = chance.choice((0.0, chance.uniform(0.0, 0.1), chance.uniform(0.0, 0.1), chance.uniform(0.0, 0.02)))
    if family == "hole":
        scene.flat = chance.uniform(25.0, 75.0)
        scene.radius = 1.0 / math.radians(scene.flat)
    scene.load = nominal_load(scene)
    return scene


def draw_crowned(seed, rings):
    """A crowned punch on a plate, with lines, and its coarse mesh: the slave line is finer than the master line."""
    chance = random.Random(f"crowned {seed} {rings}")
    ratio = math.exp(chance.uniform(0.0, math.log(5.0)))
    scene = Scene("round", rings, (1000.0, 1000.0 * ratio) if chance.random() < 0.5 else (1000.0 * ratio, 1000.0), nu=chance.uniform(0.2, 0.4), lines=True)
    scene.exchanged = chance.random() < 0.3
    scene.whole = not rings and chance.random() < 0.7
    scene.radius = 1.0 / math.exp(chance.uniform(math.log(0.02), math.log(0.2)))
    punch = min(chance.uniform(2.0, 6.0), 0.8 * scene.radius)
    scene.wide = punch, punch * chance.uniform(1.5, 3.0)
    scene.deep = profile(scene, 0, punch) + chance.uniform(3.0, 10.0), chance.uniform(3.0, 10.0)
    scene.load = nominal_load(scene)
    finer = chance.uniform(1.2, 3.0)
    mesh = Fineness(pairs=math.exp(chance.uniform(math.log(3.0), math.log(15.0))), growth=chance.uniform(1.1, 1.3),
                    finer=finer if scene.exchanged else 1.0 / finer, shift=chance.choice((0.0, 0.5, chance.random())), stretch=chance.uniform(0.6, 1.3),
                    jitter=0.0, seed=0)
    return scene, mesh


def compliance(scene):
    bodies = 1 if scene.rigid else 2
    return sum((1.0 if scene.sheet else 1.0 - scene.nu ** 2) / young for young in scene.young[:bodies])


def nominal_load(scene):
    """Load that gives a half-width of about 1 (Hertz, Ciavarella), for half of the model in the plane."""
    curvature, stiff = 1.0 / scene.radius + scene.other, 1.0 / compliance(scene)
    if scene.rings:
        return 4.0 / 3.0 * stiff / scene.radius
    if scene.family in ("rounded punch", "tilted"):
        angle = math.asin(scene.flat)
        return stiff * scene.flat ** 2 / (4.0 * scene.radius) * ((math.pi - 2 * angle) / (2 * scene.flat ** 2) - 1 / math.tan(angle))
    if scene.family == "sharp punch":
        return stiff / scene.radius
    if scene.family == "stack":   # slender: a larger load would give large displacements
        return stiff / scene.radius / 250.0
    return math.pi / 8.0 * stiff * curvature


def fineness(chance):
    """A typical coarse mesh, with 3 to 20 pairs in the zone."""
    return Fineness(pairs=math.exp(chance.uniform(math.log(3.0), math.log(20.0))), growth=chance.uniform(1.12, 1.5), finer=chance.choice((1.0, chance.uniform(0.8, 2.0))),
                    shift=chance.random(), stretch=chance.uniform(0.6, 1.3), jitter=chance.choice((0.0, 0.0, 0.15)), seed=chance.randrange(10 ** 6))


def known(level):
    """Two fine meshes for the true values: the second gives the error of the first."""
    return Fineness((34.0, 17.0)[level], (1.14, 1.28)[level], 1.0, 0.37, 1.0, 0.0, 0)


def places(step, core, end, growth, shift=0.0, most=math.inf):
    """From 0 to the end: equal steps in the core, the first one shifted, then growing ones, up to the longest."""
    count = max(2, math.ceil(core / step - shift))
    found = [0.0] + [step * (k + shift) for k in range(1, count + 1)]
    while found[-1] < end:
        step = min(step * growth, max(step, most))
        found.append(found[-1] + step)
    if len(found) > 2 and end - found[-2] < 0.5 * step:
        found.pop(-2)
    found[-1] = end
    return found


def with_halves(at):
    return [at[0]] + [p for a, b in zip(at, at[1:]) for p in ((a + b) / 2, b)]


def body(scene, which, mesh, xs, element):
    """Columns at the points xs under a profile, from the surface to a depth."""
    chance = random.Random(mesh.seed + which)
    step = scene.width / mesh.pairs * (1.0 if which == 0 else 1.0 / mesh.finer)
    deep = scene.deep[which]
    most = scene.wide[which] if scene.family == "stack" else math.inf   # a column bends: no element is longer than half of its width
    ys = with_halves(places(step * mesh.stretch, step, deep, mesh.growth, most=most))
    xs = with_halves(xs)
    up = 1 if which == 0 else -1
    moved = {(i, j): tuple(chance.uniform(-mesh.jitter, mesh.jitter) for _ in range(2)) for j in range(2, len(ys) - 1, 2) for i in range(2, len(xs) - 1, 2)}
    rows = []
    for j, y in enumerate(ys):
        row = []
        for i, x in enumerate(xs):
            a = b = 0.0
            if (i, j) in moved and mesh.jitter:
                a = moved[i, j][0] * min(xs[i + 2] - x, x - xs[i - 2])
                b = moved[i, j][1] * min(ys[j + 2] - y, y - ys[j - 2])
            top = profile(scene, which, x + a)
            row.append((x + a, up * (top + (deep - top) * (y + b) / deep)))
        rows.append(row)
    found = join([rows if which == 0 else rows[::-1]], element.replace("trax", "tria"))
    if mesh.jitter:
        straighten(found, set(rows[0]))
    return found


def straighten(mesh, surface=()):
    """Put mid-side nodes between their corners, except those of the surface."""
    for nodes in mesh.element:
        for k, middle in enumerate(nodes[3:] if len(nodes) == 6 else ()):
            if mesh.point[middle] not in surface:
                a, b = mesh.point[nodes[k]], mesh.point[nodes[(k + 1) % 3]]
                mesh.point[middle] = (a[0] + b[0]) / 2, (a[1] + b[1]) / 2


def profile(scene, which, x):
    """Depth of the surface profile at x."""
    x = abs(x)
    if which == 1:
        return scene.other * x * x / 2
    if scene.family in ("round", "groove"):
        return x * x / (2 * scene.radius)
    if scene.family in ("rounded punch", "tilted"):
        return max(0.0, x - scene.flat) ** 2 / (2 * scene.radius)
    if scene.family == "wedge":
        return x / scene.radius
    return 0.0


def columns(scene, which, mesh):
    """Points along the surface."""
    step = scene.width / mesh.pairs * (1.0 if which == 0 or not scene.lines else 1.0 / mesh.finer)
    end = scene.wide[which]
    if scene.family == "sharp punch":
        inside = [1.0 - x for x in reversed(places(step * 0.5, 0.1, 1.0, mesh.growth))]
        if which == 0:
            return inside
        if scene.lines:
            inside = [1.0 - x for x in reversed(places(step * 0.5 / mesh.finer, 0.1, 1.0, mesh.growth))]
        return inside + [1.0 + x for x in places(inside[-1] - inside[-2], 0.1, end, mesh.growth)[1:]]
    if scene.family == "stack":
        count = math.ceil(1.0 / step)
        return [k / count for k in range(-count, count + 1)]
    core = (scene.lasts - 0.1) * scene.width
    right = places(step, core, end, mesh.growth, mesh.shift if scene.whole and which == 0 else 0.0)
    if scene.family == "wedge" and scene.whole:
        right = places(step, core, end, mesh.growth)
    if scene.family == "layer" and which == 0:
        near = min(range(1, len(right)), key=lambda i: abs(right[i] - scene.flat))
        right[near] = scene.flat
    if not scene.whole:
        return right
    return [-x for x in reversed(places(step, core, end, mesh.growth, 1.0 - mesh.shift if which == 0 and scene.family != "wedge" else 0.0))] + right[1:]


def make(scene, element, mesh):
    """The deck of a model. `element`: type of both bodies, or a pair for the upper body and the lower."""
    if scene.family == "hole":
        return hole(scene, element, mesh)
    deck = Deck(scene.family.upper(), [f"{scene}", f"{mesh}"], rings=scene.rings, strain=not scene.sheet, from_geometry=not scene.lines)
    elements = (element, element) if isinstance(element, str) else element
    xs = columns(scene, 0, mesh)
    upper = body(scene, 0, mesh, xs, elements[0])
    reach = scene.lasts * scene.width
    if not scene.lines and not scene.rigid:   # opposite nodes coincide as far as there may be contact
        near = [x for x in xs if abs(x) <= (1.0 if scene.family == "sharp punch" else reach) + 1e-9]
        other = near if scene.family == "stack" else near + beyond(scene, mesh, near)
        if scene.whole and scene.family != "stack":
            other = [-x for x in reversed(beyond(scene, mesh, [-x for x in reversed(near)]))] + other
    elif not scene.rigid:
        other = columns(scene, 1, mesh)
    lower = None if scene.rigid else body(scene, 1, mesh, other, elements[1])
    free = first_free(*(m for m in (upper, lower) if m))
    one, two = 1, free + 1
    deck.body(upper, 1, one)
    material(deck, 1, scene)
    surface = on_surface(scene, upper, 0, reach)
    if not scene.rigid:
        deck.body(lower, 2, two)
        material(deck, 2, scene)
        bottom = [n for n, (x, y) in enumerate(lower.point) if abs(y + scene.deep[1]) < 1e-9]
        deck.hold(12 if scene.whole else 2, bottom, two)
        if not scene.whole:
            deck.hold(1, [n for n, (x, _) in enumerate(lower.point) if x == 0.0], two)
        facing = on_surface(scene, lower, 1, reach * (1.3 if scene.lines else 1.0))
    high = max(y for _, y in upper.point)
    top = sorted((n for n, (x, y) in enumerate(upper.point) if abs(y - high) < 1e-9), key=lambda n: upper.point[n][0])
    load(deck, scene, upper, top, one, free)
    if scene.rigid:
        deck.ground([(upper.point[n][0], 0.0) for n in surface], two)
        facing = range(len(surface))
    if scene.lines:
        ends = [upper.point[n] for n in (surface[0], surface[-1])]
        deck.segments(1, walk(upper, *ends), one)
        ends = [lower.point[n] for n in (facing[-1], facing[0])]
        deck.segments(2, walk(lower, *ends), two)
        deck.touches(1, *((2, 1) if scene.exchanged else (1, 2)))
    else:
        deck.upward()
        deck.pairs(10 * free + 1, [(two + b, one + a) for a, b in zip(surface, facing)], 21)
    return deck


def beyond(scene, mesh, near):
    """Points of the lower body beyond those opposite the upper one."""
    step = near[-1] - near[-2]
    return [near[-1] + x for x in places(step * mesh.growth, step, scene.wide[1] - near[-1], mesh.growth)[1:]]


def on_surface(scene, mesh, which, reach):
    """Nodes of a surface within SEARCH, with corners of elements at both ends."""
    up = 1 if which == 0 else -1
    corners = {n for nodes in mesh.element for n in nodes[:corners_of(nodes)]}
    if scene.family in ("sharp punch", "stack"):
        reach = 1.0 if not scene.lines or which == 0 else 1.5
    near = [n for n, (x, y) in enumerate(mesh.point) if abs(x) <= reach + 1e-9 and abs(y * up - profile(scene, which, x)) < 1e-9]
    near.sort(key=lambda n: mesh.point[n][0])
    while near[0] not in corners:
        near.pop(0)
    while near[-1] not in corners:
        near.pop()
    return near


def load(deck, scene, upper, top, one, free):
    """Load by a platen; layers, stacks and tilted punches by a pressure."""
    if not scene.whole:
        deck.hold(1, [n for n, (x, _) in enumerate(upper.point) if x == 0.0], one)
    else:
        deck.hold(1, [min(top, key=lambda n: abs(upper.point[n][0]))], one)
    if scene.family == "layer":
        pressed = [n for n in top if upper.point[n][0] <= scene.flat + 1e-9]
        area = math.pi * scene.flat ** 2 if scene.rings else scene.flat
        deck.press(upper, pressed, scene.load / area, one)
        deck.card("SUPORT", one + top[0], 2)
    elif scene.family in ("tilted", "stack"):
        corners = {n for nodes in upper.element for n in (nodes[:3] if len(nodes) == 6 else nodes)}
        line = [n for n in top if n in corners]
        wide = scene.wide[0]
        for a, b in zip(line, line[1:]):
            value = [scene.load / wide * (1.0 + 0.6 * scene.flat / wide * upper.point[n][0] / wide) for n in (a, b)]
            deck.card("PLOADX1", 1, one + upper.side(a, b), *value, one + a, one + b)
        deck.card("SUPORT", one + top[0], 2, one + top[-1], 2)
    else:
        deck.platen(10 * free, 2, top, one)
        deck.card("SUPORT", one + top[0], 2)
        deck.wide("FORCE", 1, one + top[0], 0, scene.load * (2.0 if scene.whole else 1.0), 0.0, -1.0, 0.0)


def material(deck, number, scene):
    """Yield stresses of both bodies, in proportion to their moduli; none if the model is elastic."""
    young = scene.young[number - 1]
    deck.material(number, float(f"{young:.5g}"), float(f"{scene.nu:.4f}"))
    if scene.stress > 0.0 and (scene.young[number - 1] == min(scene.young) or scene.young[0] == scene.young[1]):
        deck.yields(number, scene.stress, scene.hardening * young)


def hole(scene, element, mesh):
    """A pin in a hole, with two materials."""
    around = max(12.0, mesh.pairs * 360.0 / scene.flat)
    deck = quads.pin_in_lug(scene.flat, around, max(1.0, mesh.finer), 8.0, element)
    at = [i for i, line in enumerate(deck.lines) if line.startswith("MAT1")]
    scale = quads.STEEL / min(scene.young)
    for number, i in zip((1, 2), at):
        young = scale * scene.young[number - 1]
        deck.lines[i] = "MAT1".ljust(8) + str(number).ljust(8) + f"{young:.1f}".ljust(8)[:8] + " " * 8 + f"{scene.nu:.4f}"
        if scene.stress > 0.0 and scene.young[number - 1] == min(scene.young):
            deck.yields(number, scene.stress, scene.hardening * young)
    return deck
