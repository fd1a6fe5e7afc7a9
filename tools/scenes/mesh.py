"""Meshes: blocks, rings, discs."""
import math


class Mesh:
    """Points and elements (their corners; with six points also the middles of the sides, the first behind the first corner);
    `line` says which points lie on a named line, in order."""

    def __init__(self, point, element, line):
        self.point, self.element, self.line = point, element, line

    def on(self, axis, value):
        return [i for i, p in enumerate(self.point) if abs(p[axis] - value) < 1e-9 * max(1.0, abs(value))]


    def side(self, a, b):
        """The element with the side from point a to point b."""
        return next(k for k, nodes in enumerate(self.element) if a in nodes and b in nodes)

    def with_middles(self, curved=lambda a, b: None):
        """The same triangles with a point in the middle of each side, and in the lines. `curved(a, b)` gives the place of the
        middle between two places on a curved boundary, or None where the side is straight."""
        point, middle = list(self.point), {}

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                (xa, ya), (xb, yb) = point[key[0]], point[key[1]]
                middle[key] = len(point)
                point.append(curved(point[key[0]], point[key[1]]) or ((xa + xb) / 2, (ya + yb) / 2))
            return middle[key]

        element = [(a, b, c, between(a, b), between(b, c), between(c, a)) for a, b, c in self.element]
        line = {name: [n for a, b in zip(nodes, nodes[1:]) for n in (a, between(a, b))] + nodes[-1:]
                for name, nodes in self.line.items()}
        return Mesh(point, element, line)


def on_circle(centre, radius):
    """For `with_middles`: sides whose ends lie on a circle follow it."""
    def curved(a, b):
        if any(abs(math.dist(p, centre) - radius) > 1e-6 * radius for p in (a, b)):
            return None
        x, y = (a[0] + b[0]) / 2 - centre[0], (a[1] + b[1]) / 2 - centre[1]
        scale = radius / math.hypot(x, y)
        return centre[0] + scale * x, centre[1] + scale * y
    return curved


def first_free(*meshes):
    """The power of ten above every count of nodes and elements: ids of a second body begin after it."""
    return 10 ** len(str(max(max(len(mesh.point), len(mesh.element)) for mesh in meshes)))


def graded(first, growth, length):
    """Places from 0 to length, spacing `first` times powers of `growth`, stretched to fit."""
    places, step = [0.0], first
    while places[-1] < length - 0.5 * step:
        places.append(places[-1] + step)
        step *= growth
    return [p * length / places[-1] for p in places]


def without_unused(point, element, line):
    """The mesh of the points that elements use."""
    used = sorted({node for nodes in element for node in nodes})
    place = {old: new for new, old in enumerate(used)}
    return Mesh([point[i] for i in used], [tuple(place[c] for c in nodes) for nodes in element],
                {name: [place[i] for i in nodes if i in place] for name, nodes in line.items()})


def block(xs, ys):
    """Triangulated grid; the diagonals turn over at x = 0 only: turning in every cell ripples the contact pressures."""
    n = len(xs)
    point = [(x, y) for y in ys for x in xs]
    triangle = []
    for j in range(len(ys) - 1):
        for i in range(n - 1):
            a, b, c, d = j * n + i, j * n + i + 1, (j + 1) * n + i + 1, (j + 1) * n + i
            triangle += [(a, b, c), (a, c, d)] if xs[i] + xs[i + 1] < 0 else [(a, b, d), (b, c, d)]
    return Mesh(point, triangle, {"bottom": list(range(n)), "top": list(range(len(point) - n, len(point)))})


def zip_rows(lower, upper, point, triangle):
    """Triangles between two rows of points that begin and end side by side: the shorter diagonal first."""
    i = j = 0
    while i < len(lower) - 1 or j < len(upper) - 1:
        step_lower = math.dist(point[lower[i + 1]], point[upper[j]]) if i < len(lower) - 1 else math.inf
        step_upper = math.dist(point[lower[i]], point[upper[j + 1]]) if j < len(upper) - 1 else math.inf
        if step_lower <= step_upper:
            triangle.append((lower[i], lower[i + 1], upper[j]))
            i += 1
        else:
            triangle.append((lower[i], upper[j + 1], upper[j]))
            j += 1


def quarter_disc(radius, b, n, growth=None):
    """Quarter of a disc that stands on the origin, centre (0, radius): rings round the origin, b/n apart out to 1.6 b and
    then growing. Lines: `arc` from the origin along the circle, `axis` x = 0, `top`."""
    core, h = 1.6 * b, b / n
    growth = growth or 1.0 + h / core
    radii = [h * (k + 1) for k in range(round(core / h))]
    outside = graded(h * growth, growth, radius - radii[-1])
    radii += [radii[-1] + r for r in outside[1:]]
    step = radii[-1] - radii[-2]
    beyond = max(2, round((math.sqrt(2.0) - 1.0) * radius / step))
    radii[-1] = radius
    radii += [radius * (1.0 + (math.sqrt(2.0) - 1.0) * (k + 1) / beyond) for k in range(beyond)]
    point, triangle, arc, top, axis, before = [(0.0, 0.0)], [], [0], [], [0], [0]
    for k, r in enumerate(radii):
        step = r - (radii[k - 1] if k else 0.0)
        last = k == len(radii) - 1
        begin = math.asin(min(r / (2.0 * radius), 1.0))
        end = math.pi / 2 if r <= radius else math.asin(radius / r)
        parts = 0 if last else max(1, round(r * (end - begin) / step))
        row = []
        for i in range(parts + 1):
            angle = begin + (end - begin) * i / max(parts, 1)
            place = (r * math.cos(angle), r * math.sin(angle))
            if i == 0:  # on the circle: x^2 + (y - R)^2 = R^2
                place = (r * math.sqrt(1.0 - (r / (2.0 * radius)) ** 2), r * r / (2.0 * radius))
            if i == parts and r <= radius:
                place = (0.0, r)
            elif i == parts:
                place = (math.sqrt(max(r * r - radius * radius, 0.0)), radius)
            row.append(len(point))
            point.append(place if not last else (radius, radius))
        zip_rows(before, row, point, triangle)
        arc.append(row[0])
        if r <= radius:
            axis.append(row[-1])
        if r >= radius:
            top.append(row[-1])
        before = row
    return Mesh(point, triangle, {"arc": arc, "axis": axis, "top": top})


def rings(radii, around, opening=math.pi / 2, begin=0.0):
    """Part of a ring, counter-clockwise; lines `inner`, `outer`."""
    point = []
    for r in radii:
        for i in range(around + 1):
            angle = begin + opening * i / around
            place = (r * math.cos(angle), r * math.sin(angle))
            point.append(tuple(0.0 if abs(v) < 1e-12 * r else v for v in place))
    flat = block([float(i) for i in range(around + 1)], [float(j) for j in range(len(radii))])
    triangle = [(a, c, b) for a, b, c in flat.element]
    n = around + 1
    return Mesh(point, triangle, {"inner": list(range(n)), "outer": list(range(len(point) - n, len(point)))})


def half_disc(radius, around):
    """Half of a disc, x >= 0, centre at the origin; equal angles on its edge, fewer towards the centre. Line: `edge`."""
    point, triangle, step = [(0.0, 0.0)], [], math.pi * radius / around
    depths = graded(step, 1.12, radius)
    before = [0]
    for depth in reversed(depths[:-1]):
        r = radius - depth
        parts = around if depth < 2.5 * step else max(2, round(math.pi * r / (depths[depths.index(depth) + 1] - depth)))
        row = []
        for i in range(parts + 1):
            angle = math.pi * i / parts
            row.append(len(point))
            point.append((0.0 if i in (0, parts) else r * math.sin(angle), -r * math.cos(angle)))
        zip_rows(before, row, point, triangle)
        before = row
    return Mesh(point, triangle, {"edge": before})
