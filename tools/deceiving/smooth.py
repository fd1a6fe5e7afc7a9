"""Families of models whose outlines are round in contact, or conform: family(pick, n) draws one and meshes it n times finer."""
import math

from deceiving.drawing import Draw, base, family
from deceiving.scenes import RINGS
from deceiving.shapes import cells, disc, nose, number_of, plate_with_hole, profiled, profiled_up


@family
def cylinder_on_block(pick, n):
    d = Draw(pick, n, h=(0.1, 0.3))
    radius, half = pick.uniform(0.8, 4.0), pick.uniform(0.4, 0.7)
    shift = pick.uniform(-0.3, 0.3)
    gap = pick.choice([0.0, 0.0, 0.02])
    turned = pick.random() < 0.3
    floor = base(d, -1.6, 1.7)
    body = d.slave()
    profiled(body, [shift - half, shift, shift + half], 1.0, lambda x: gap + nose(radius, shift)(x), d.h_slave)
    a, b = (shift - half, gap + nose(radius)(half)), (shift + half, gap + nose(radius)(half))
    d.press(body, shift + half, shift - half, 1.0, gap + 0.02, half)
    d.either(body.line(a, b), floor.line((1.7, 0.0), (-1.6, 0.0)), 0.8 if turned else 0.2)
    return d.scene


@family
def sprung_platen(pick, n):
    """A round nose under a platen that rotates (RBE2, MOMENT), with an eccentric force and two springs to the ground; an equation (MPC) connects
    each spring to the platen."""
    d = Draw(pick, n, h=(0.1, 0.3))
    half, radius = pick.uniform(0.4, 0.7), pick.uniform(0.8, 4.0)
    floor = base(d, -1.6, 1.7)
    body = d.slave()
    profiled(body, [-half, 0.0, half], 1.0, nose(radius), d.h_slave)
    nodes = body.line((half, 1.0), (-half, 1.0))
    force = d.strain * min(body.young, d.young) * half
    scene = d.scene
    master, *ends = [len(scene.nodes) + k for k in range(5)]
    scene.nodes += [(pick.uniform(-0.3, 0.3) * half, 1.3), (-1.5, 1.3), (1.5, 1.3), (-1.5, 0.8), (1.5, 0.8)]
    scene.rotating.append((master, [*nodes, *ends[:2]], force * pick.uniform(-0.2, 0.2)))
    scene.hold([master, *ends[2:]], "1")
    scene.forces.append((master, (0.0, -force)))
    for end, foot in zip(ends[:2], ends[2:]):
        scene.equations.append([(foot, "2", 1.0), (end, "2", -pick.choice([1.0, 0.5]))])
        scene.springs.append((foot, "2", d.young * 10.0 ** pick.uniform(-3, -1)))
    d.either(body.line((-half, nose(radius)(half)), (half, nose(radius)(half))), floor.line((1.7, 0.0), (-1.6, 0.0)), 0.2)
    return scene


@family
def pin_in_hole(pick, n):
    """A disc in the round hole of a plate, moved or pressed; whole outlines or the lower half."""
    d = Draw(pick, n, h=(0.12, 0.3))
    clearance = pick.choice([0.0, 0.001, 0.01, 0.05, 0.2])
    half_only = pick.random() < 0.3
    body = d.slave()
    c = disc(body, (0.0, 0.0), 1.0, d.h_slave)
    plate = d.master()
    plate_with_hole(plate, (0.0, -clearance), 1.0 + clearance, 3.0, d.h_master, 0.5)
    low = -clearance - 3.0
    d.hold(plate, (-3.0, low), (3.0, low))
    x = d.scene.nodes
    inside = [k for k in body.at.values() if max(map(abs, x[k])) <= c + 1e-9]
    if d.force:
        d.scene.platen(inside, 0.01 * d.young)
    else:
        d.scene.hold(inside, "12", (0.02 * d.sway, -0.02))
    s = math.sqrt(0.5)
    r = 1.0 + clearance
    if half_only:
        d.either(body.line((-s, -s), (s, -s)), plate.line((r * s, -clearance - r * s), (-r * s, -clearance - r * s)), 0.4)
    else:
        d.either(body.line((s, s)), plate.line((r * s, -clearance + r * s)), 0.4)
    return d.scene


@family
def far_travel(pick, n):
    """A body that comes down through a large gap: some of its nodes are within SEARCH, others are not."""
    d = Draw(pick, n, h=(0.12, 0.3))
    slope = pick.uniform(0.2, 1.0)
    kind = pick.choice(["slope", "round"])
    floor = base(d, -1.6, 1.7)
    body = d.slave()
    gap = pick.uniform(0.0, 2.0) * d.h
    half = pick.uniform(0.6, 1.0)
    soft = pick.random() < 0.6

    def profile(x):
        return gap + (slope * abs(x) if kind == "slope" else nose(1.05)(x))
    xs = [-half, 0.0, half]
    top = profile(half) + 0.5
    profiled(body, xs, top, profile, d.h_slave)
    if soft:
        body.young = d.young * 1e-2
    d.force, d.sway = False, 0.0   # a relative tangential displacement of more than an edge is beyond linear kinematics
    d.press(body, half, -half, top, gap + pick.choice([0.05, 0.3]), half)
    d.either(body.line((-half, profile(half)), (half, profile(half))), floor.line((1.7, 0.0), (-1.6, 0.0)), 0.3)
    return d.scene


@family
def nose_in_groove(pick, n):
    """A round nose, or a wedge, in a V."""
    d = Draw(pick, n, h=(0.12, 0.35))
    v = math.tan(math.radians(pick.choice([15, 20, 30, 45, 60])))
    kind = pick.choice(["round", "wedge", "same"])
    groove = d.master()
    deep = min(0.8 * v, 1.2)
    half = deep / v
    profiled_up(groove, [-1.4, -half, 0.0, half, 1.4], -0.8, lambda x: min(0.0, -deep + v * abs(x)) + deep, d.h_master)
    d.hold(groove, (-1.4, -0.8), (1.4, -0.8))
    body = d.slave()
    w = 0.6 * half
    slope = v if kind == "same" else v * pick.choice([0.8, 1.25])
    radius = w * pick.uniform(1.05, 1.6)
    shape = nose(radius) if kind == "round" else lambda x: slope * abs(x)
    lift = max(v * abs(x) - shape(x) for x in [w * k / 200 for k in range(201)])

    def profile(x):
        return shape(x) + lift
    xs, top = [-w, 0.0, w], profile(w) + 0.6
    # If edges turn by more than 35 degrees, the curve has corners: three times finer it would be another model.
    profiled(body, xs, top, profile, min(d.h_slave, w / 3 / n) if kind == "round" else d.h_slave, d.h_slave)
    d.sway = pick.choice([0.0, 0.0, 0.3])
    d.press(body, w, -w, top, 0.02, w)
    d.either(body.line((-w, profile(w)), (w, profile(w))), groove.line((1.4, deep), (-1.4, deep)), 0.4)
    return d.scene


@family
def roller(pick, n):
    """A disc between two plates."""
    d = Draw(pick, n, h=(0.15, 0.35))
    floor = base(d, -1.5, 1.6)
    body = d.slave()
    body.young = d.young * pick.choice([1.0, 3.0, 0.2])
    c = disc(body, (0.0, 1.0), 1.0, d.h_slave)
    lid = d.master()
    cells(lid, [-1.3, 1.4], [2.0, 2.8], d.h_master, up=max(0.2, d.h_master))
    d.hold(lid, (1.4, 2.8), (-1.3, 2.8), "12", (0.0, -0.04))
    x = d.scene.nodes
    inside = [k for k in body.at.values() if max(abs(x[k][0]), abs(x[k][1] - 1.0)) <= c + 1e-9]
    d.scene.hold(inside, "12", (0.0, -0.02))
    turn = pick.choice([0.0, 0.0, 1.0])
    own = body.line((math.sqrt(0.5), 1 + math.sqrt(0.5)))
    d.either(own, floor.line((1.6, 0.0), (-1.5, 0.0)), turn)
    d.either(own, lid.line((-1.3, 2.0), (1.4, 2.0)), turn)
    return d.scene


@family
def rings(pick, n):
    """Axisymmetric bodies: a shrink fit, a ring on a ring, a punch on the axis."""
    d = Draw(pick, n, RINGS)
    kind = pick.choice(["fit", "punch", "ring"])
    d.force = kind != "fit" and pick.random() < 0.5
    d.sway = 0.0
    if kind == "fit":
        inner, outer = d.slave(), d.master()
        over, gap = pick.choice([0.0, 0.01]), pick.choice([0.0, 0.003])
        low, high = pick.uniform(-0.3, 0.3), pick.uniform(0.7, 1.3)
        cells(inner, [1.0, 1.5], [0.0, 1.0], d.h_slave)
        cells(outer, [1.5 + gap, 2.2], [low, high], d.h_master)
        d.hold(inner, (1.0, 0.0), (1.5, 0.0), "2")
        d.hold(outer, (1.5 + gap, low), (2.2, low), "2")
        d.hold(inner, (1.0, 1.0), (1.0, 0.0), "1", (gap + 0.01, 0.0))
        d.either(inner.line((1.5, 0.0), (1.5, 1.0)), outer.line((1.5 + gap, high), (1.5 + gap, low)))
        return d.scene
    floor = d.master()
    cells(floor, [0.0, 2.0], [-1.0, 0.0], d.h_master, up=max(d.h_master, 0.2))
    d.hold(floor, (0.0, -1.0), (2.0, -1.0), "12")
    d.hold(floor, (0.0, 0.0), (0.0, -1.0), "1")
    body = d.slave()
    left = 0.0 if kind == "punch" else pick.uniform(0.3, 0.8)
    right = left + pick.uniform(0.5, 1.0)
    radius = pick.choice([None, 1.5, 3.0])
    gap = pick.choice([0.0, 0.01])
    middle = left if kind == "punch" else (left + right) / 2

    def profile(x):
        return gap + (nose(radius, middle)(x) if radius else 0.0)
    xs = [left, right] if kind == "punch" else [left, middle, right]
    profiled(body, xs, 1.0, profile, d.h_slave)
    if kind == "punch":
        d.hold(body, (0.0, 1.0), (0.0, gap), "1")
    d.press(body, right, left, 1.0, gap + 0.02, right - left)
    d.either(body.line((left, profile(left)), (right, profile(right))), floor.line((2.0, 0.0), (0.0, 0.0)))
    return d.scene


@family
def shrink_fit(pick, n):
    """A disc in a ring that is too narrow for it; whole outlines that conform."""
    d = Draw(pick, n, h=(0.15, 0.4))
    over, outer = pick.choice([0.001, 0.005, 0.02]), pick.uniform(1.5, 2.5)
    body = d.slave()
    c = disc(body, (0.0, 0.0), 1.0, d.h_slave)
    x, m = d.scene.nodes, number_of(1.4, d.h_slave)
    held = c * max(k / m for k in range(m % 2, m + 1, 2) if k <= max(1, m / 2)) + 1e-9   # on lines of the coarse mesh: the same when finer
    d.scene.hold([k for k in body.at.values() if max(map(abs, x[k])) <= held])
    ring = d.master()
    turns = number_of(1.57, d.h_master)
    for k in range(4):
        ring.patch(lambda s, t: ((1 - over + (outer - 1 + over) * s) * math.cos(math.pi * (k + t) / 2),
                                 (1 - over + (outer - 1 + over) * s) * math.sin(math.pi * (k + t) / 2)),
                   number_of(outer - 1, max(d.h_master, 0.25)), turns)
    d.hold(ring, (outer * math.sqrt(0.5), -outer * math.sqrt(0.5)), (outer, 0.0))
    d.either(body.line((math.sqrt(0.5), math.sqrt(0.5))), ring.line((1.0 - over, 0.0)), 0.4)
    return d.scene


@family
def spun_fit(pick, n):
    """The same, while both rotate about its centre."""
    scene = shrink_fit(pick, n)
    scene.nodes.append((0.0, 0.0))
    scene.hold([len(scene.nodes) - 1])
    scene.spins.append((len(scene.nodes) - 1, math.sqrt(pick.uniform(1e-4, 5e-3) * scene.bodies[0].young) / (2 * math.pi)))
    return scene


@family
def own_weight(pick, n):
    """A body on a floor, pressed by its weight alone, unconstrained in rotation; its upper side stays level."""
    d = Draw(pick, n, h=(0.12, 0.3))
    radius, half, lean = pick.uniform(0.8, 4.0), pick.uniform(0.4, 0.7), pick.choice([0.0, 0.0, 0.2, -0.5])
    floor = base(d, -1.6, 1.7)
    body = d.slave()
    profiled(body, [-half, 0.0, half], 1.0, nose(radius), d.h_slave)
    top = body.line((half, 1.0), (-half, 1.0))
    d.scene.platens.append((top[0], "2", top[1:]))
    d.scene.free.append((top[0], "2"))
    d.scene.hold(top, "1")
    weight = d.strain * min(body.young, d.young)
    d.scene.gravity.append((lean * weight, -weight))
    d.either(body.line((-half, nose(radius)(half)), (half, nose(radius)(half))), floor.line((1.7, 0.0), (-1.6, 0.0)), 0.8)
    return d.scene


@family
def half_of_it(pick, n):
    """Half of a symmetric model: lines end on the symmetry line, at a tip, on a flat or on an arc."""
    d = Draw(pick, n, h=(0.12, 0.35))
    kind = pick.choice(["flat", "round", "tip", "hollow"])
    floor = base(d, 0.0, 1.7)
    d.scene.hold(floor.line((0.0, 0.0), (0.0, -1.0))[:-1], "1")
    body = d.slave()
    half, gap = pick.uniform(0.5, 1.0), pick.choice([0.0, 0.01])
    slope = math.tan(math.radians(pick.choice([5, 15, 25, 40])))

    def profile(x):
        return gap + {"flat": 0.0, "round": nose(1.5)(x), "tip": slope * x, "hollow": 0.1 * slope * (half - x)}[kind]
    top = max(profile(0.0), profile(half)) + 0.6
    profiled(body, [0.0, half], top, profile, d.h_slave)
    d.scene.hold(body.line((0.0, top), (0.0, profile(0.0)))[1:], "1")
    d.sway = 0.0
    d.press(body, half, 0.0, top, gap + 0.02, half)
    d.either(body.line((0.0, profile(0.0)), (half, profile(half))), floor.line((1.7, 0.0), (0.0, 0.0)), 0.4)
    return d.scene
