"""Curved contact on typical meshes: press fits of whole circles with different divisions, cylinders and balls on blocks
whose elements grow away from the contact by a power, with curved or straight edges."""
import dataclasses
import math
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from chance import straighten, with_halves  # noqa: E402
from scenes.deck import Deck  # noqa: E402
from scenes.patches import arc, even, join, patch, straight  # noqa: E402

YOUNG, NU = 1.0e5, 0.3
#: For the cylinder and the ball.
RADIUS, WIDE, DEEP = 10.0, 4.0, 8.0


def lame(pressure=100.0, inside=0.5, outside=3.0, middle=1.0, ratio=1.0, nu=NU, overlap=0.0):
    """Contact pressure of a pin in a hole that is fixed outside, with a pressure in its bore; `ratio`: modulus of the hole over that of the pin."""
    young = YOUNG
    low = inside ** 2 / (middle ** 2 - inside ** 2)
    # radial displacement of each at the contact: a times the bore's pressure - b times the contact's; c times the contact's
    a = 2.0 * (1.0 - nu ** 2) * middle * low / young
    b = (1.0 + nu) * middle * low * ((1.0 - 2.0 * nu) * (middle / inside) ** 2 + 1.0) / young
    grow = 1.0 / middle - middle / outside ** 2   # u = k (r - outside**2/r): zero outside
    c = (1.0 + nu) * (outside ** 2 - middle ** 2) / middle / ((1.0 / (1.0 - 2.0 * nu)) + (outside / middle) ** 2) / (young * ratio)
    return (a * pressure + overlap) / (b + c)


def whole_ring(inside, outside, around, layers, element, straight_sides):
    """A ring of elements in two halves that share their ends, with the nodes of its inner and outer circle."""
    def half(begin):
        e = even(around // 2)
        ends = [tuple(r * f(math.radians(begin)) for f in (math.cos, math.sin)) for r in (inside, outside)]
        other = [tuple(-x for x in place) for place in ends]
        return patch(arc((0, 0), inside, begin, begin + 180, e), arc((0, 0), outside, begin, begin + 180, e),
                     straight(*ends, even(layers)), straight(*other, even(layers)))
    mesh = join([half(0), half(180)], element)
    circle = [sorted((n for n, p in enumerate(mesh.point) if abs(math.hypot(*p) - r) < 1e-6), key=lambda n: math.atan2(*mesh.point[n][::-1]) % (2 * math.pi - 1e-9))
              for r in (inside, outside)]
    if straight_sides:
        straighten(mesh)
    return mesh, circle


def press_fit(element, hole, pin, layers=3, ratio=1.0, inside=0.5, exchanged=False, straight_sides=False, pressure=100.0, stress=0.0, hardening=0.0, sheet=False):
    """A pin pressed by a pressure in its bore into a hole that is fixed outside. `hole`, `pin`: elements around."""
    deck = Deck("PRESS FIT OF WHOLE CIRCLES", ["A pin in a hole, unlike divisions."], from_geometry=False, strain=not sheet)
    bodies = [whole_ring(1.0, 3.0, hole, layers, element, straight_sides), whole_ring(inside, 1.0, pin, layers, element, straight_sides)]
    first = [1, 100001]
    for k, (mesh, circle) in enumerate(bodies):
        deck.body(mesh, k + 1, first[k])
        deck.material(k + 1, YOUNG * (ratio if k == 0 else 1.0), NU)
        if stress:
            deck.yields(k + 1, stress, hardening * YOUNG)
    (outer, (hole_circle, rim)), (inner, (bore, pin_circle)) = bodies
    deck.hold(12, rim, first[0])
    deck.hold(2, [bore[0], bore[len(bore) // 2]], first[1])
    deck.hold(1, [min(bore, key=lambda n: abs(inner.point[n][0]) - 1e-9 * inner.point[n][1])], first[1])
    deck.press(inner, bore + bore[:1], pressure, first[1])
    deck.segments(1, pin_circle + pin_circle[:1], first[1])
    deck.segments(2, hole_circle[:1] + hole_circle[::-1], first[0])   # the body is outside
    deck.touches(1, *((2, 1) if exchanged else (1, 2)))
    return deck


@dataclasses.dataclass
class Cylinder:
    """A cylinder, or a ball, on a block. Node coordinates are a power of uniform ones."""
    element: str
    across: int             # number of elements of the upper body's surface
    below: int              # the same for the block
    layers: int
    power: float = 2.0      # exponent of the coordinates along the surface
    deep: float = 2.2       # exponent in depth
    load: float = 400.0
    ratio: float = 1.0      # ratio to the block's modulus
    straight_sides: bool = False
    exchanged: bool = False
    stress: float = 0.0
    hardening: float = 0.0
    sheet: bool = False

    @property
    def rings(self):
        return self.element.startswith("ctrax")

    @property
    def stiff(self):
        one = 1.0 if self.sheet else 1.0 - NU ** 2
        return 1.0 / (one / YOUNG + one / (YOUNG * self.ratio))

    def hertz(self):
        """Half-width, largest pressure."""
        if self.rings:
            b = (3 * self.load * RADIUS / (4 * self.stiff)) ** (1 / 3)
            return b, 3 * self.load / (2 * math.pi * b * b)
        b = math.sqrt(4 * self.load * RADIUS / math.pi / self.stiff)
        return b, 2 * self.load / math.pi / b

    def deck(self):
        deck = Deck("CYLINDER ON A BLOCK", [f"{self}"], from_geometry=False, rings=self.rings, strain=not self.sheet)
        kind = self.element.replace("trax", "tria")
        first = [1, 100001]
        for k, (count, wide) in enumerate(((self.below, 1.2 * WIDE), (self.across, WIDE))):
            at = [2.0 * i / count - 1.0 for i in range(count + 1)]
            if self.rings:
                at = [i / count for i in range(count + 1)]
            xs = with_halves([math.copysign(wide * abs(t) ** self.power, t) for t in at])
            depth = with_halves([DEEP * (j / self.layers) ** self.deep for j in range(self.layers + 1)])
            rows = []
            for d in depth if k == 1 else depth[::-1]:
                rows.append([])
                for x in xs:
                    top = RADIUS - math.sqrt(RADIUS ** 2 - x * x) if k == 1 else 0.0
                    rows[-1].append((x, top + (DEEP - top) * d / DEEP) if k == 1 else (x, -d))
            mesh = join([rows], kind)
            surface = [min(range(len(mesh.point)), key=lambda n, p=p: math.dist(mesh.point[n], p)) for p in rows[0 if k == 1 else -1]]
            far = [n for n, p in enumerate(mesh.point) if abs(abs(p[1]) - DEEP) < 1e-9]
            straighten(mesh)
            if not self.straight_sides and len(mesh.element[0]) == 6 and k == 1:
                for n in surface:
                    x = mesh.point[n][0]
                    mesh.point[n] = x, RADIUS - math.sqrt(RADIUS ** 2 - x * x)
            if kind != "ctria6":
                surface = surface[::2]
            deck.body(mesh, k + 1, first[k])
            deck.material(k + 1, YOUNG * (self.ratio if k == 0 else 1.0), NU)
            if self.stress:
                deck.yields(k + 1, self.stress, self.hardening * YOUNG)
            used = {n for nodes in mesh.element for n in nodes}
            far = [n for n in far if n in used]
            if self.rings:
                deck.hold(1, [n for n in used if mesh.point[n][0] == 0.0], first[k])
            if k == 0:
                deck.hold(2 if self.rings else 12, far, first[k])
            else:
                deck.platen(900000, 2, far, first[k])
                if not self.rings:
                    deck.hold(1, [min(far, key=lambda n: abs(mesh.point[n][0]))], first[k])
                deck.card("SUPORT", first[k] + far[0], 2)
                deck.wide("FORCE", 1, first[k] + far[0], 0, self.load, 0.0, -1.0, 0.0)
            deck.segments(k + 1, surface if k == 1 else surface[::-1], first[k])
        deck.touches(1, *((1, 2) if self.exchanged else (2, 1)))
        return deck


#: Limits of fine meshes with six-node edges on the curve (112 across, 36 layers): approaches of the cylinder, by load and ratio of
#: moduli, and of the ball, by load.
APPROACH = {(100.0, 1.0): -0.00566444, (400.0, 1.0): -0.0194535, (1000.0, 1.0): -0.0433596, (100.0, 4.0): -0.00374472,
            (400.0, 4.0): -0.0129793, (1000.0, 4.0): -0.0291418}
BALLS = {10.0: -0.00123382, 40.0: -0.00310325, 150.0: -0.00748432}
#: Yielded: models, with largest pressure, half-width, approach.
YIELDING_FITS = (({"stress": 80.0, "hardening": 0.02}, 38.8775), ({"stress": 60.0, "hardening": 0.1}, 45.5711),
                 ({"stress": 90.0, "hardening": 0.01, "ratio": 3.0, "inside": 0.6}, 57.235),
                 ({"stress": 60.0, "hardening": 0.03, "ratio": 0.5, "inside": 0.4}, 31.3178))
YIELDING = (({"load": 400.0, "stress": 350.0, "hardening": 0.02}, 721.8, 0.3280, -0.0199477),
            ({"load": 400.0, "stress": 450.0, "hardening": 0.1}, 822.5, 0.3073, -0.0194827),
            ({"load": 1000.0, "stress": 550.0, "hardening": 0.05}, 1129.5, 0.5284, -0.0448416),
            ({"load": 1000.0, "ratio": 4.0, "stress": 800.0, "hardening": 0.03}, 1543.8, 0.3923, -0.0294325),
            ({"load": 100.0, "stress": 200.0, "hardening": 0.05}, 393.1, 0.1551, -0.00569685))
YIELDING_BALLS = (({"load": 40.0, "stress": 250.0, "hardening": 0.05}, 505.4, 0.1831, -0.0031649),
                  ({"load": 150.0, "stress": 350.0, "hardening": 0.02}, 733.3, 0.2876, -0.0077448))
#: Their own errors, for the largest pressure and the half-width.
DOUBT = {"p": 1.0e-3, "b": 1.0e-2, "q": 3.0e-4}
ELEMENTS = ("ctria3", "ctria6", "cquad4", "ctrax3", "ctrax6")


def press_fits(seed, element, yielding):
    """A random one: (name, true values, deck)."""
    chance = random.Random(f"press fit {seed} {element} {yielding}")
    if yielding:
        more, true = chance.choice(YIELDING_FITS)
    else:
        more = {"ratio": math.exp(chance.uniform(-1.5, 1.5)), "inside": chance.uniform(0.3, 0.75)}
        true = lame(**more)
    hole, pin = (max(12, 4 * round(math.exp(chance.uniform(math.log(8), math.log(80))) / 4)) for _ in range(2))
    more = {**more, "hole": hole, "pin": pin, "layers": chance.randint(2, 6), "exchanged": chance.random() < 0.3,
            "straight_sides": chance.random() < 0.5}
    return f"press fit {seed} {element} {more}", {"p": true}, lambda: press_fit(element, **more)


def cylinders(seed, element, yielding):
    """A random cylinder or ball."""
    chance = random.Random(f"cylinder {seed} {element} {yielding}")
    rings = element.startswith("ctrax")
    if yielding:
        more, *true = chance.choice(YIELDING_BALLS if rings else YIELDING)
    elif rings:
        more = {"load": chance.choice(tuple(BALLS))}
    else:
        more = dict(zip(("load", "ratio"), chance.choice(tuple(APPROACH))))
    across = math.exp(chance.uniform(math.log(20), math.log(70))) / (2 if rings else 1)
    below = across * chance.choice((1.25, math.exp(chance.uniform(-0.4, 0.8))))
    scene = Cylinder(element, round(across), round(below), chance.randint(8, 28), chance.uniform(1.6, 2.4), chance.uniform(1.6, 2.6),
                     straight_sides=chance.random() < 0.5, exchanged=chance.random() < 0.3, **more)
    if not yielding:
        b, p = scene.hertz()
        true = p, b, BALLS[scene.load] if rings else APPROACH[scene.load, scene.ratio]
    return f"{seed} {scene}", dict(zip("pbq", true)), scene.deck


def draw(first, count):
    """Press fits, and cylinders and balls on blocks, elastic and yielded, with each element type: (name, true values, deck, element)."""
    for seed in range(first, first + count):
        for element in ELEMENTS:
            for yielding in (False, True):
                if not element.startswith("ctrax"):
                    yield (*press_fits(seed, element, yielding), element)
                yield (*cylinders(seed, element, yielding), element)
