"""Models of many pairs, many bodies, many unknowns for part 5 of `tools/bench`. Steel, plane strain, contact between lines."""
import math

from .deck import STEEL, Deck
from .fill import arc, fill, segment
from .lines import nearest
from .mesh import Mesh, squared, zip_rows

#: Parts of the full pull of a dovetail with friction, and the increments of each.
SPIN, INCREMENTS = (0.5, 1.0, 0.5, 1.0), 8
#: Bilinear: yield stress and hardening slope, N/mm2.
YIELD, HARDENING = 200.0, 2000.0


def growth_for(sides, nodes, deep, most=2.0):
    """Growth factor of rows with which a block with a given number of edges at its fine end has a given number of nodes."""
    low, high = 1.0, most
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if counted(sides, middle, deep) > nodes else (low, middle)
    return high


def counted(sides, growth, deep):
    return sum(parts + 1 for _, parts in rows_of(sides, growth, deep))


def rows_of(sides, growth, deep):
    """Rows from the fine end: depth, over the width of the block, and number of edges; each as deep as its edges are long."""
    rows, depth, parts = [(0.0, sides)], 0.0, float(sides)
    while depth < deep:
        depth += 1.0 / parts
        parts = max(2.0, parts / growth)
        rows.append((depth, round(parts)))
    return [(depth * deep / rows[-1][0], parts) for depth, parts in rows]


def coarsening(width, deep, sides, growth, surface=lambda x: 0.0, up=True):
    """A block whose triangles grow away from its fine end, which is y = `surface`. Lines: `fine`, `far`."""
    way, point, triangle, before, fine = (1.0 if up else -1.0), [], [], None, None
    for depth, parts in rows_of(sides, growth, deep / width):
        row = list(range(len(point), len(point) + parts + 1))
        fades = 1.0 - depth * width / deep
        for i in range(parts + 1):
            x = width * (i / parts - 0.5)
            point.append((x, way * depth * width + fades * surface(x)))
        if before:
            zip_rows(*((before, row) if up else (row, before)), point, triangle)
        fine = fine or row
        before = row
    return Mesh(point, triangle, {"fine": fine, "far": before})


def blocks(pairs=1500, nodes=43000, crown=0.12, load=20000.0, yields=False):
    """A crowned block on another, with about these numbers of pairs and nodes: fine along the contact, coarser away from it."""
    width, deep, finer = 100.0, 60.0, 1.15
    upper = coarsening(width, deep, pairs - 1, growth_for(pairs, nodes / (1 + finer), deep / width), lambda x: crown * (2 * x / width) ** 2)
    sides = round(finer * pairs)
    lower = coarsening(width, deep, sides, growth_for(sides, finer * nodes / (1 + finer), deep / width), up=False)
    deck = Deck("A CROWNED BLOCK ON ANOTHER", [
        f"Two steel blocks, {width:g} wide and {deep:g} high; the lower side of the upper one is a parabola that rises by {crown:g} to its ends. "
        f"A force of {load:g} a mm on the top, which stays straight; the bottom is fixed. " + ("Bilinear." if yields else "Elastic.")],
        from_geometry=False)
    one, two = deck.bodies(("Upper block", upper), ("Lower block", lower))
    deck.steel(2)
    if yields:
        for number in (1, 2):
            deck.yields(number, YIELD, HARDENING)
    deck.card("PARAM", "SEARCH", 2.0 * crown)   # all nodes are candidates, however fine the mesh
    top = upper.line["far"]
    deck.hold(12, lower.line["far"], two)
    deck.hold(1, [nearest(upper, (0.0, deep), top)])
    deck.platen(2 * two, 2, top)   # eight digits, for any number of elements
    deck.push(one + top[0], load)
    deck.contacts((upper.line["fine"], one), (list(reversed(lower.line["fine"])), two))
    return deck


def strip(pairs=2800, rows=14):
    """A strip on another of the same mesh, with the ratio of pairs to rows equal to that of length to height; pressed along its whole length."""
    width = 100.0
    high = width * rows / (pairs - 1)
    xs = [width * i / (pairs - 1) for i in range(pairs)]
    ys = [high * j / rows for j in range(rows + 1)]
    upper, lower = squared(xs, ys), squared(xs, [y - high for y in ys])
    deck = Deck("A STRIP ON ANOTHER", [f"Two steel strips, {width:g} long and {high:g} high, quadrilaterals; the bottom of the lower one is fixed, the "
                                       "top of the upper one stays straight and is pressed by 100 on each unit of length. All pairs are in contact."],
                from_geometry=False)
    one, two = deck.bodies(("Upper strip", upper), ("Lower strip", lower))
    deck.steel(2)
    top = upper.line["top"]
    deck.hold(12, lower.line["bottom"], two)
    deck.hold(1, [top[pairs // 2]])
    deck.platen(2 * two, 2, top)   # eight digits, for any number of elements
    deck.push(one + top[0], 100.0 * width)
    deck.contacts((upper.line["bottom"], one), (list(reversed(lower.line["top"])), two))
    return deck


def stack(bodies=30, across=40, rows=33):
    """Stacked blocks, each unconstrained vertically and in rotation."""
    width = 10.0
    high = width * rows / across
    ticks = [width * i / across for i in range(across + 1)]
    mesh = [squared(ticks, [high * (b + j / rows) for j in range(rows + 1)]) for b in range(bodies)]
    deck = Deck("A STACK OF BLOCKS", [f"{bodies} steel blocks, {width:g} wide and {high:g} high, one upon the other; the lowest is fixed, the "
                                      "uppermost pressed by 10 a mm. Only contact with their neighbours restrains the others: two SUPORT DOFs each."],
                from_geometry=False)
    first = deck.bodies(*((f"Block {b + 1}", mesh[b]) for b in range(bodies)))
    deck.steel(bodies)
    deck.hold(12, mesh[0].line["bottom"], first[0])
    for b in range(1, bodies):
        top = mesh[b].line["top"]
        deck.hold(1, [nearest(mesh[b], (width / 2, high * (b + 0.5)))], first[b])
        deck.card("SUPORT", first[b] + top[0], 2, first[b] + top[-1], 2)
    top = mesh[-1].line["top"]
    for k, node in enumerate(top):
        deck.card("FORCE", 1, first[-1] + node, 0, 10.0 * width / across * (0.5 if k in (0, across) else 1.0), 0.0, -1.0, 0.0)
    deck.contacts(*(line for b in range(1, bodies)
                    for line in ((mesh[b].line["bottom"], first[b]), (list(reversed(mesh[b - 1].line["top"])), first[b - 1]))))
    return deck


def beside(a, b, fine, growth, largest):
    """A size that grows with the distance from a segment and from its mirror image in x = 0."""
    long = math.dist(a, b)

    def size(x, y):
        x = abs(x)
        along = max(0.0, min(1.0, ((x - a[0]) * (b[0] - a[0]) + (y - a[1]) * (b[1] - a[1])) / long ** 2))
        return min(largest, fine + growth * math.hypot(x - a[0] - along * (b[0] - a[0]), y - a[1] - along * (b[1] - a[1])))
    return size


def symmetrical(half, above, below, size):
    """A body from the right half of its outline, upwards from its lowest point: the left half is its mirror image, with `other` for `flank`."""
    def mirrored(place):
        return -place[0], place[1]

    def image(curve):
        return lambda s: mirrored(curve(1.0 - s))

    first, last = half[0][1](0.0), half[-1][1](1.0)
    return fill([(below, segment(mirrored(first), first)), *half, (above, segment(last, mirrored(last))),
                 *((name and "other", image(curve)) for name, curve in reversed(half))], size, middles=False)


def dovetail(fine=0.034, growth=0.18, pull=1000.0, yields=False, friction=0.0):
    """A dovetail pulled out of its groove: two oblique flanks, rounded at their ends. With friction the pull rises and falls."""
    slope, blunt, deep, high, wide = math.radians(60.0), 2.0, 15.0, 30.0, 45.0
    along, out = (math.cos(slope), -math.sin(slope)), (math.sin(slope), math.cos(slope))   # of the right flank of the tongue
    turned = 90.0 - math.degrees(slope)

    def at(place, by, way):
        return place[0] + by * way[0], place[1] + by * way[1]

    mouth = (10.0, 0.0)
    begin, end = at(mouth, blunt, along), at(mouth, deep / out[0] - blunt, along)
    inside, outside = at(end, -blunt, out), at(begin, blunt, out)
    neck, shore = at(mouth, -6.0, along), (outside[0], outside[1] + blunt)
    tongue = symmetrical([("flank", arc(inside, blunt, -90.0, turned)), ("flank", segment(end, neck)),
                          (None, segment(neck, (neck[0], high)))], "top", None, beside(begin, end, fine, growth, 4.0))
    base = at(end, 2.5 * blunt, along)
    groove = symmetrical([(None, segment((wide, -50.0), (wide, shore[1]))), (None, segment((wide, shore[1]), shore)),
                          ("flank", arc(outside, blunt, 90.0, 180.0 + turned)), ("flank", segment(begin, base))], None, "bottom",
                         beside(begin, end, fine / 1.2, growth, 8.0))
    deck = Deck("A DOVETAIL IN ITS GROOVE", [
        f"A steel dovetail, flanks at {math.degrees(slope):g} degrees, is pulled out of its groove by {pull:g} a mm. Non-matching meshes, fine along the flanks, whose "
        "ends are rounded. " + ("Bilinear." if yields else "Elastic.") + " Only contact restrains it: two SUPORT DOFs.",
        *(rise_and_fall(pull, out, friction) if friction else [f"Known by statics: each flank carries {pull / 2 / out[1]:.1f}."])], from_geometry=False)
    one, two = deck.bodies(("Dovetail", tongue), ("Block", groove))
    deck.steel(2)
    if yields:
        for number in (1, 2):
            deck.yields(number, YIELD, HARDENING)
    top = tongue.line["top"]
    deck.hold(12, groove.line["bottom"], two)
    deck.hold(1, [nearest(tongue, (0.0, high), top)])
    deck.card("SUPORT", one + top[0], 2, one + top[-1], 2)
    deck.press(tongue, top, -pull / (2 * neck[0]), one)
    deck.contacts(*((mesh.line[line], first) for line in ("flank", "other") for mesh, first in ((tongue, one), (groove, two))))
    if friction:
        deck.rubs(1, friction)
        deck.rubs(2, friction)
        deck.sequence(*((f"{100.0 * math.sqrt(part):.0f} % OF THE SPEED", part, INCREMENTS) for part in SPIN))
    return deck


def rise_and_fall(pull, out, friction):
    """The known forces of the flanks of a dovetail with friction, all of which slips."""
    up, down = (pull / 2 / (out[1] + way * friction * out[0]) for way in (1.0, -1.0))
    return [f"It is the root of a blade: the pull grows with the square of the speed, up to {pull:g}, down and up again. mu = {friction:g}. Each load case has "
            f"{INCREMENTS} increments.",
            "Known by statics, as long as all of the flanks slips: each carries P/2/(cos a + mu sin a) while the pull P rises, and "
            f"P/2/(cos a - mu sin a) after it has fallen enough, with a = 60 degrees: {SPIN[0] * up:.2f}, {up:.2f}, {SPIN[2] * down:.2f} and {up:.2f} "
            f"at the ends of the load cases. Without friction: {pull / 2 / out[1]:.1f} at full speed."]
