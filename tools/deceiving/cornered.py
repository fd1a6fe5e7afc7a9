"""Families of models whose outlines have corners in contact: family(pick, n) draws one and meshes it n times finer."""
import math

from deceiving.drawing import Draw, base, family
from deceiving.shapes import cells, profiled


@family
def block_on_block(pick, n):
    """A punch on a wider block, or a wide block on a narrower one; no node of one is at a corner of the other."""
    d = Draw(pick, n)
    width, shift = pick.uniform(0.5, 1.5), pick.uniform(-0.4, 0.4)
    left, right = -pick.uniform(1.2, 2.0), pick.uniform(1.2, 2.0)
    gap = pick.choice([0.0, 0.0, 0.01, 0.2])
    height = pick.uniform(0.5, 1.2)
    floor = base(d, left, right)
    a, b = shift - width / 2, shift + width / 2
    body = d.block(a, b, gap, gap + height)
    d.press(body, b, a, gap + height, gap + d.strain, width)
    d.either(body.line((a, gap), (b, gap)), floor.line((right, 0.0), (left, 0.0)))
    return d.scene


@family
def closed_outlines(pick, n):
    """The same with the whole outline as one line, for one body or both; some are thin."""
    d = Draw(pick, n)
    width, shift = pick.uniform(0.5, 1.5), pick.uniform(-0.4, 0.4)
    left, right = -pick.uniform(1.2, 2.0), pick.uniform(1.2, 2.0)
    gap = pick.choice([0.0, 0.0, 0.01, 0.2])
    height = pick.choice([0.1, 0.3, 1.0])
    depth = pick.choice([0.15, 0.5, 1.0])
    which = pick.choice([1, 2, 3])
    floor = base(d, left, right, depth)
    a, b = shift - width / 2, shift + width / 2
    body = d.block(a, b, gap, gap + height)
    d.press(body, b, a, gap + height, gap + d.strain * height, width)
    own = body.line((a, gap)) if which & 1 else body.line((a, gap), (b, gap))
    d.either(own, floor.line((right, 0.0)) if which & 2 else floor.line((right, 0.0), (left, 0.0)))
    return d.scene


@family
def wedge_on_flat(pick, n):
    """A wedge of any angle whose tip meets the block between nodes, or at one."""
    d = Draw(pick, n)
    slopes = [math.tan(math.radians(pick.choice([5, 12, 17, 20, 30, 40, 50]))) for _ in range(2)]
    if pick.random() < 0.5:
        slopes[1] = slopes[0]
    shift = pick.uniform(-0.3, 0.3)
    gap = pick.choice([0.0, 0.0, 0.01])
    floor = base(d, -1.5, 1.5)
    body = d.slave()
    half = pick.uniform(0.4, 1.0)

    def profile(x):
        return gap + (shift - x) * slopes[0] if x < shift else gap + (x - shift) * slopes[1]
    xs = [shift - half, shift, shift + half]
    top = max(map(profile, xs)) + pick.uniform(0.3, 0.8)
    profiled(body, xs, top, profile, d.h_slave)
    d.press(body, xs[2], xs[0], top, gap + 0.03, half * 0.5)
    d.either(body.line((xs[0], profile(xs[0])), (xs[2], profile(xs[2]))), floor.line((1.5, 0.0), (-1.5, 0.0)))
    return d.scene


@family
def chamfers(pick, n):
    """A flat foot with chamfers of 10 to 45 degrees, one or several edges long, in its line."""
    d = Draw(pick, n)
    angle = math.tan(math.radians(pick.choice([10, 15, 20, 25, 30, 34, 36, 40, 45])))
    flat, length = pick.uniform(0.3, 0.8), pick.choice([0.1, 0.25, 0.5])
    gap = pick.choice([0.0, 0.0, 0.02])
    floor = base(d, -2.0, 1.9)
    body = d.slave()
    two = pick.random() < 0.5

    def profile(x):
        return gap + angle * max(0.0, abs(x) - flat) * (1.0 if x > 0 or two else 0.5)
    xs = [-flat - length, -flat, flat, flat + length]
    profiled(body, xs, 1.0, profile, d.h_slave)
    d.press(body, xs[3], xs[0], 1.0, gap + pick.choice([0.01, 0.05]), 2 * flat)
    d.either(body.line((xs[0], profile(xs[0])), (xs[3], profile(xs[3]))), floor.line((1.9, 0.0), (-2.0, 0.0)))
    return d.scene


@family
def steps(pick, n):
    """A wide block over a floor with a step: the upper level carries it, with its corner between nodes of the block."""
    d = Draw(pick, n)
    step = pick.choice([0.05, 0.2, 0.5])
    at, more = pick.uniform(-0.5, 0.5), pick.random() < 0.4
    shift, width = pick.uniform(-0.2, 0.2), pick.uniform(1.0, 2.0)
    floor = d.master()
    x2 = at + pick.uniform(0.2, 0.6)
    xs = [-2.0, at, x2, 2.0] if more else [-2.0, at, 2.0]
    up = [1] if more else [0]
    cells(floor, xs, [-1.0, 0.0, step], d.h_master, up=max(d.h_master, 0.2), full=lambda i, j: j == 0 or i in up)
    d.hold(floor, (-2.0, -1.0), (2.0, -1.0))
    a, b = shift - width / 2, shift + width / 2
    body = d.block(a, b, step, step + 0.8)
    d.press(body, b, a, step + 0.8, d.strain * 2, 0.5)
    first = step if not more else 0.0
    d.either(body.line((a, step), (b, step)), floor.line((2.0, 0.0), (-2.0, first)))
    return d.scene


@family
def concave_corner(pick, n):
    """A block pushed into an L, straight down beside the wall or into the corner."""
    d = Draw(pick, n)
    side, below = pick.choice([0.0, 0.0, 0.01, 0.1]), pick.choice([0.0, 0.0, 0.01, 0.1])
    width, height = pick.uniform(0.5, 1.2), pick.uniform(0.5, 1.2)
    wall = pick.uniform(0.3, 1.5)
    corner = d.master()
    cells(corner, [-1.0, 0.0, 2.0], [-1.0, 0.0, wall], d.h_master, lambda i, j: i == 0 or j == 0)
    d.hold(corner, (-1.0, -1.0), (2.0, -1.0))
    body = d.block(side, side + width, below, below + height)
    into = pick.choice([0.0, 0.5, 1.0])
    dx, dy = -(side + 0.02) * into, -(below + 0.02)
    d.hold(body, (side + width, below + height), (side, below + height), "12", (dx, dy))
    how = pick.choice(["both", "floor", "whole"])
    own = {"both": lambda: body.line((side, below + height), (side + width, below)),
           "floor": lambda: body.line((side, below), (side + width, below)),
           "whole": lambda: body.line((side, below))}[how]()
    d.either(own, corner.line((2.0, 0.0), (0.0, wall)), 0.4)
    return d.scene


@family
def keyway(pick, n):
    """A key pushed into a U: its lower side, its flanks, or its whole outline in contact with the groove."""
    d = Draw(pick, n)
    half, deep = pick.uniform(0.3, 0.8), pick.uniform(0.4, 1.0)
    side, below = pick.choice([0.0, 0.0, 0.005, 0.1]), pick.choice([0.0, 0.01, 0.1])
    groove = d.master()
    w = half + side
    cells(groove, [-w - 0.8, -w, w, w + 0.8], [-0.8, 0.0, deep], d.h_master, lambda i, j: i != 1 or j == 0)
    d.hold(groove, (-w - 0.8, -0.8), (w + 0.8, -0.8))
    key = d.slave()
    height = deep + pick.choice([-0.2, 0.3])
    cells(key, [-half, half], [below, below + height], d.h_slave)
    push = pick.choice([0.0, 0.0, 1.0])
    d.hold(key, (half, below + height), (-half, below + height), "12", (push * (side + 0.01), -below - 0.02))
    how = pick.choice(["lower", "flanks", "whole"])
    own = {"lower": lambda: key.line((-half, below), (half, below)),
           "flanks": lambda: key.line((-half, below + height), (half, below + height)),
           "whole": lambda: key.line((-half, below))}[how]()
    wide = pick.random() < 0.4
    theirs = groove.line((w + 0.8, deep), (-w - 0.8, deep)) if wide else groove.line((w, deep), (-w, deep))
    d.either(own, theirs, 0.4)
    return d.scene


@family
def t_in_slot(pick, n):
    """A T pulled against the lips of its slot."""
    d = Draw(pick, n, h=(0.12, 0.3))
    stem, head, thick, deep = pick.uniform(0.2, 0.4), pick.uniform(0.6, 0.9), pick.uniform(0.2, 0.4), pick.uniform(0.2, 0.4)
    side, lip = pick.choice([0.02, 0.1]), pick.choice([0.0, 0.01])
    slot = d.master()
    w, u, top = head + side, stem + side, thick + 0.05
    cells(slot, [-w - 0.6, -w, -u, u, w, w + 0.6], [-0.5, 0.0, top, top + deep], d.h_master,
          lambda i, j: j == 0 or i in (0, 4) or (j == 2 and i != 2))
    d.hold(slot, (-w - 0.6, -0.5), (w + 0.6, -0.5))
    tee = d.slave()
    y = top - lip
    cells(tee, [-head, -stem, stem, head], [y - thick, y, y + deep + 0.5], d.h_slave, lambda i, j: j == 0 or i == 1)
    d.hold(tee, (stem, y + deep + 0.5), (-stem, y + deep + 0.5), "12", (pick.choice([0.0, 0.5]) * side, lip + 0.01))
    own = tee.line((-head, y - thick)) if pick.random() < 0.5 else tee.line((-stem, y + deep + 0.5), (stem, y + deep + 0.5))
    d.either(own, slot.line((u, top + deep), (-u, top + deep)), 0.4)
    return d.scene


@family
def feet(pick, n):
    """A body on two or three feet of different length: those that start farther than SEARCH come into contact too."""
    d = Draw(pick, n, h=(0.12, 0.35))
    count = pick.choice([2, 3])
    hang = [0.0] + [pick.choice([0.0, 0.2, 0.5, 1.0]) for _ in range(count - 1)]
    pick.shuffle(hang)
    xs, legs, x = [0.0], [], 0.0
    for k in range(count):
        legs.append((x, x + pick.uniform(0.2, 0.4)))
        x = legs[-1][1] + pick.uniform(0.3, 0.6)
        xs += [legs[-1][1], x]
    xs.pop()
    floor = base(d, -0.8, xs[-1] + 0.9)
    body = d.slave()
    levels = sorted(set(hang)) + [1.5, 1.9]
    cells(body, xs, levels, d.h_slave,
          lambda i, j: levels[j] >= 1.5 or (i % 2 == 0 and levels[j] >= hang[i // 2]))
    travel = pick.choice([0.02, max(hang) + 0.02])
    d.hold(body, (xs[-1], 1.9), (0.0, 1.9), "12", (0.0, -travel))
    d.either(body.line((0.0, hang[0]), (xs[-1], hang[-1])), floor.line((xs[-1] + 0.9, 0.0), (-0.8, 0.0)), 0.4)
    return d.scene


@family
def two_masters(pick, n):
    """One line over two bodies: adjacent, apart, or of different height."""
    d = Draw(pick, n)
    apart, lower = pick.choice([0.0, 0.05, 0.4]), pick.choice([0.0, 0.0, 0.01])
    at = pick.uniform(-0.3, 0.3)
    one, two = d.master(), d.master()
    two.young = d.young * pick.choice([1.0, 0.3, 5.0])
    a, b = at - apart / 2, at + apart / 2
    h = pick.choice([d.h_master, d.h_master * 0.6])
    cells(one, [-1.5, a], [-1.0, 0.0], d.h_master, up=max(d.h_master, 0.2))
    cells(two, [b, 1.6], [-1.0 - lower, -lower], h, up=max(h, 0.2))
    d.hold(one, (-1.5, -1.0), (a, -1.0))
    d.hold(two, (b, -1.0 - lower), (1.6, -1.0 - lower))
    width, shift = pick.uniform(0.9, 2.4), pick.uniform(-0.2, 0.2)
    p, q = shift - width / 2, shift + width / 2
    body = d.block(p, q, 0.0, 0.8)
    d.press(body, q, p, 0.8, d.strain, width)
    turn = 0.0 if pick.random() < 0.7 else 1.0
    d.either(body.line((p, 0.0), (q, 0.0)), one.line((a, 0.0), (-1.5, 0.0)), turn)
    d.either(body.line((p, 0.0), (q, 0.0)), two.line((1.6, -lower), (b, -lower)), turn)
    return d.scene


@family
def line_twice(pick, n):
    """The same nodes under two ids, or lines that overlap."""
    d = Draw(pick, n)
    width = pick.uniform(0.6, 1.4)
    floor = base(d, -1.5, 1.6)
    a, b = -width / 2, width / 2
    body = d.block(a, b, 0.0, 0.8)
    d.press(body, b, a, 0.8, d.strain, width)
    own, theirs = body.line((a, 0.0), (b, 0.0)), floor.line((1.6, 0.0), (-1.5, 0.0))
    if pick.random() < 0.3:
        own, theirs = theirs, own
    d.scene.contact(own, theirs)
    how = pick.choice(["slave", "reversed", "part", "master", "both ways"])
    step = (len(own) - 1) // (len(d.scene.corners(own)) - 1)
    middle = len(own) // 2 // step * step
    other = {"slave": (own, theirs), "reversed": (own[::-1], theirs), "part": (own[:max(step, middle) + 1], theirs),
             "master": (own, theirs[::-1]), "both ways": (theirs, own)}[how]
    scene = d.scene
    scene.lines[3], scene.lines[4] = other
    scene.contacts.append((3, 4))
    scene.needed = 1
    scene.note = how
    return scene


@family
def wall_and_floor(pick, n):
    """A block on a floor near a wall of it, with clearance: the wall must not carry the floor's load."""
    d = Draw(pick, n)
    play = pick.choice([0.001, 0.02, 0.1, 0.3])
    width = pick.uniform(0.6, 1.2)
    corner = d.master()
    wall = pick.uniform(0.3, 1.2)
    two = pick.random() < 0.4
    right = [play + width + play, play + width + play + 0.6] if two else [2.0]
    cells(corner, [-0.6, 0.0] + right, [-0.8, 0.0, wall], d.h_master, lambda i, j: i in (0, 2) or j == 0)
    d.hold(corner, (-0.6, -0.8), (right[-1], -0.8))
    body = d.block(play, play + width, 0.0, 0.8)
    d.press(body, play + width, play, 0.8, d.strain, width)
    whole = pick.random() < 0.4
    own = body.line((play, 0.0)) if whole else body.line((play, 0.0), (play + width, 0.0))
    d.either(own, corner.line((right[0], wall if two else 0.0), (0.0, wall)), 0.4)
    return d.scene


@family
def edge_on_edge(pick, n):
    """Two blocks that overlap over a part of their width."""
    d = Draw(pick, n)
    lap = pick.uniform(0.15, 0.8)
    low = d.master()
    cells(low, [-1.2, 0.0], [-1.0, 0.0], d.h_master)
    d.hold(low, (-1.2, -1.0), (0.0, -1.0))
    body = d.block(-lap, 1.0, 0.0, 0.8)
    d.press(body, 1.0, -lap, 0.8, d.strain, lap)
    more = pick.choice([0, 1, 2])
    own = body.line((-lap, 0.8 if more else 0.0), (1.0, 0.0))
    d.either(own, low.line((0.0, -1.0 if more == 2 else 0.0), (-1.2, 0.0)))
    return d.scene


@family
def stack(pick, n):
    """A stack of three or four bodies with different widths and mesh sizes."""
    d = Draw(pick, n)
    below, right = base(d, -1.4, 1.5), 1.5
    upper = below.line((1.5, 0.0), (-1.4, 0.0))
    y = 0.0
    count = pick.choice([2, 3])
    for k in range(count):
        body = d.scene.body(d.kinds[k % 2], d.young * pick.choice([1.0, 0.2, 4.0]), 0.3)
        a, b, height = -pick.uniform(0.3, 1.3), pick.uniform(0.3, 1.3), pick.uniform(0.25, 0.7)
        cells(body, [a, b], [y, y + height], d.h * pick.choice([1.0, 0.7, 0.4]), up=d.h)
        d.either(body.line((a, y), (b, y)), upper)
        y += height
        upper = body.line((b, y), (a, y))
        if k < count - 1:   # between walls, and unconstrained vertically
            wall = d.scene.corners(body.line((a, y), (a, y - height)))
            d.hold(body, (a, y), (a, y - height), "1")
            d.scene.free.append((wall[(len(wall) - 1) // n // 2 * n], "2"))
    d.press(body, b, a, y, d.strain * y, b - a)
    return d.scene


@family
def beam_over_bump(pick, n):
    """A slender beam bent over a bump of the floor, or down on the floor beside it."""
    d = Draw(pick, n, h=(0.15, 0.3))
    bump, w = pick.choice([0.02, 0.05, 0.15]), pick.uniform(0.1, 0.4)
    at = pick.uniform(-0.3, 0.3)
    floor = d.master()
    cells(floor, [-2.0, at - w, at + w, 2.0], [-0.6, 0.0, bump], d.h_master, up=max(d.h_master, 0.15), full=lambda i, j: j == 0 or i == 1)
    d.hold(floor, (-2.0, -0.6), (2.0, -0.6))
    body = d.slave()
    cells(body, [-1.6, 1.6], [bump, bump + 0.3], d.h_slave, up=0.15)
    move = pick.choice([0.5, 1.0, 1.1]) * bump
    for x in (-1.6, 1.6):
        d.hold(body, (x, bump) if x > 0 else (x, bump + 0.3), (x, bump + 0.3) if x > 0 else (x, bump), "12", (0.0, -move))
    d.either(body.line((-1.6, bump), (1.6, bump)), floor.line((2.0, 0.0), (-2.0, 0.0)), 0.4)
    return d.scene


@family
def polygon_block(pick, n):
    """A block rotated by any angle that comes down on a corner, with its whole outline or two sides as line."""
    d = Draw(pick, n)
    floor = base(d, -1.6, 1.7)
    angle = math.radians(pick.choice([5, 20, 35, 45, 60]))
    c, s = math.cos(angle), math.sin(angle)
    body = d.slave()
    shift = pick.uniform(-0.3, 0.3)
    gap = pick.choice([0.0, 0.01])

    def turned(u, v):
        return (shift + c * u - s * v, gap + s * u + c * v)
    cells(body, [0.0, 1.0], [0.0, 0.8], d.h_slave, shape=turned)
    d.scene.hold(body.line(turned(1.0, 0.8), turned(0.0, 0.8)), "12", (0.0, -gap - 0.03))
    own = body.line(turned(0.0, 0.0)) if pick.random() < 0.4 else body.line(turned(0.0, 0.8), turned(1.0, 0.0))
    d.either(own, floor.line((1.7, 0.0), (-1.6, 0.0)))
    return d.scene


@family
def pockets(pick, n):
    """A floor of teeth, gaps or pins under a wide block: many corners of the master between slave nodes."""
    d = Draw(pick, n, h=(0.2, 0.5))
    teeth = pick.choice([2, 3, 4])
    wide, deep = 2.4 / teeth * pick.uniform(0.2, 0.8), pick.choice([0.1, 0.4])
    pitch = 2.4 / teeth
    floor = d.master()
    xs = [-1.4]
    for k in range(teeth):
        middle = -1.2 + pitch * (k + 0.5)
        xs += [middle - wide / 2, middle + wide / 2]
    xs.append(1.4)
    cells(floor, xs, [-0.6, -deep, 0.0], d.h_master, up=max(d.h_master, 0.15), full=lambda i, j: j == 0 or i % 2 == 1)
    d.hold(floor, (-1.4, -0.6), (1.4, -0.6))
    body = d.slave()
    width = pick.uniform(0.8, 2.6)
    cells(body, [-width / 2, width / 2], [0.0, 0.8], d.h_slave)
    d.press(body, width / 2, -width / 2, 0.8, d.strain, 0.5)
    d.either(body.line((-width / 2, 0.0), (width / 2, 0.0)), floor.line((1.4, -deep), (-1.4, -deep)))
    return d.scene


@family
def flush(pick, n):
    """Bodies of equal width, or slightly wider at either end."""
    d = Draw(pick, n)
    left, right = (pick.choice([0.0, 0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3, 0.03]) * pick.choice([-1.0, 1.0]) for _ in range(2))
    floor = base(d, -1.0, 1.1)
    a, b = -1.0 + left, 1.1 + right
    body = d.block(a, b, 0.0, 0.7)
    d.press(body, b, a, 0.7, d.strain, 2.0)
    further = pick.random() < 0.3
    own = body.line((a, 0.7), (b, 0.7)) if further else body.line((a, 0.0), (b, 0.0))
    d.either(own, floor.line((1.1, -1.0), (-1.0, -1.0)) if pick.random() < 0.2 else floor.line((1.1, 0.0), (-1.0, 0.0)))
    return d.scene
