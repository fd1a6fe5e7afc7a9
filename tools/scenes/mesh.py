"""Meshes: blocks, rings, discs."""
import math


def corners_of(nodes):
    """Number of corners of an element with these nodes."""
    return {3: 3, 4: 4, 6: 3, 8: 4}[len(nodes)]


class Mesh:
    """Points and elements (their corners; with six or eight points also the mid-side nodes, the first after the first corner);
    `line` lists the points of a named line, in order."""

    def __init__(self, point, element, line):
        self.point, self.element, self.line = point, element, line

    def on(self, axis, value):
        return [i for i, p in enumerate(self.point) if abs(p[axis] - value) < 1e-9 * max(1.0, abs(value))]

    def side(self, a, b):
        """The element with the edge from point a to point b."""
        return next(k for k, nodes in enumerate(self.element) if a in nodes and b in nodes)

    def with_middles(self, curved=lambda a, b: None):
        """The same triangles with mid-side nodes, also in the lines. `curved(a, b)` gives the position of the
        mid-side node between two points of a curved boundary, or None if the edge is straight."""
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


def round_origin(a, b):
    """For `with_middles`: edges whose ends are equally far from the origin follow the circle around it."""
    return on_circle((0.0, 0.0), math.hypot(*a))(a, b)


def on_circle(centre, radius):
    """For `with_middles`: edges whose ends lie on a circle follow it."""
    def curved(a, b):
        if any(abs(math.dist(p, centre) - radius) > 1e-6 * radius for p in (a, b)):
            return None
        x, y = (a[0] + b[0]) / 2 - centre[0], (a[1] + b[1]) / 2 - centre[1]
        scale = radius / math.hypot(x, y)
        return centre[0] + scale * x, centre[1] + scale * y
    return curved


def first_free(*meshes):
    """The power of ten above every number of nodes and elements: ids of a second body begin after it."""
    return 10 ** len(str(max(max(len(mesh.point), len(mesh.element)) for mesh in meshes)))


def graded(first, growth, length):
    """Coordinates from 0 to length, with spacing `first` times powers of `growth`, scaled to fit."""
    places, step = [0.0], first
    while places[-1] < length - 0.5 * step:
        places.append(places[-1] + step)
        step *= growth
    return [p * length / places[-1] for p in places]


def without_unused(point, element, line):
    """The mesh, without points that no element uses."""
    used = sorted({node for nodes in element for node in nodes})
    place = {old: new for new, old in enumerate(used)}
    return Mesh([point[i] for i in used], [tuple(place[c] for c in nodes) for nodes in element],
                {name: [place[i] for i in nodes if i in place] for name, nodes in line.items()})


def cells(columns, rows):
    """The squares of a grid whose points are numbered row by row: their row and column, and their corners."""
    for j in range(rows - 1):
        for i in range(columns - 1):
            a = j * columns + i
            yield i, j, (a, a + 1, a + columns + 1, a + columns)


def block(xs, ys):
    """Triangulated grid; the diagonals change direction only at x = 0: changes in every cell make contact pressures oscillate."""
    squares = squared(xs, ys)
    triangle = []
    for i, _, (a, b, c, d) in cells(len(xs), len(ys)):
        triangle += [(a, b, c), (a, c, d)] if xs[i] + xs[i + 1] < 0 else [(a, b, d), (b, c, d)]
    return Mesh(squares.point, triangle, squares.line)


def squared(xs, ys):
    """Grid of quadrilaterals."""
    n = len(xs)
    point = [(x, y) for y in ys for x in xs]
    return Mesh(point, [corners for _, _, corners in cells(n, len(ys))],
                {"bottom": list(range(n)), "top": list(range(len(point) - n, len(point)))})


def zip_rows(lower, upper, point, triangle):
    """Triangles between two rows of points that begin and end at the same coordinates: the shorter diagonal first."""
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
    """Quarter of a disc that stands on the origin, centre (0, radius): rings around the origin, b/n apart up to 1.6 b and
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


def quarter_disc_squared(radius, n, core, layers):
    """The quarter disc in quadrilaterals, standing on the origin: a core of n x n at the origin, `core` wide, and around it
    layers of 2 n that grow evenly. Lines as in `quarter_disc`."""
    def height(x):  # of the circle, without the rounding of radius - sqrt
        return x * x / (radius + math.sqrt(radius * radius - x * x))

    def ring(k):
        """From the circle to x = 0: even angles about the origin; first a square with blunt corners, last the top."""
        along = k / layers
        first = core ** (1 - along) * (math.sqrt(2.0) * radius) ** along
        begin = math.asin(first / (2.0 * radius))
        row = []
        for i in range(2 * n + 1):
            part = i / (2 * n)
            angle, bend = begin + (math.pi / 2 - begin) * part, math.pi / 2 * min(part, 1 - part)
            near = core / (math.cos(bend) + 0.25 * math.sin(bend))
            far = radius / math.sin(math.pi / 4 * (1 + part))
            r = near ** (1 - along) * far ** along
            row.append((r * math.cos(angle) if i < 2 * n else 0.0, r * math.sin(angle)))
        row[0] = (first * math.sqrt(1.0 - (first / (2.0 * radius)) ** 2), first * first / (2.0 * radius))
        return [(x, radius) for x, _ in row] if k == layers else row

    row = ring(0)
    right, top, corner = row[:n + 1], row[:n - 1:-1], row[n]
    point = []
    for j in range(n + 1):
        for i in range(n + 1):
            s, t = i / n, j / n
            x = right[0][0] * s
            low, left = (x, height(x)), (0.0, top[0][1] * t)
            point.append(tuple((1 - t) * low[c] + t * top[i][c] + (1 - s) * left[c] + s * right[j][c]
                               - s * (1 - t) * right[0][c] - t * (1 - s) * top[0][c] - s * t * corner[c] for c in (0, 1)))
    element = [corners for _, _, corners in cells(n + 1, n + 1)]
    before = [j * (n + 1) + n for j in range(n)] + [n * (n + 1) + i for i in range(n, -1, -1)]
    arc, axis = list(range(n + 1)), [j * (n + 1) for j in range(n + 1)]
    for k in range(1, layers + 1):
        now = list(range(len(point), len(point) + 2 * n + 1))
        point += ring(k)
        element += [(before[i], now[i], now[i + 1], before[i + 1]) for i in range(2 * n)]
        arc.append(now[0])
        axis.append(now[-1])
        before = now
    return Mesh(point, element, {"arc": arc, "axis": axis, "top": before})


def quarter_plane(radii):
    """The quarter x >= 0, y <= 0 about the origin, in triangles on rings of these radii. Lines: `surface`, `axis`, `outer`."""
    point, triangle, surface, axis, before, last = [(0.0, 0.0)], [], [0], [0], [0], 0.0
    for r in radii:
        parts = max(1, round(math.pi / 2 * r / (r - last)))
        row = list(range(len(point), len(point) + parts + 1))
        point += [(r, 0.0)] + [(r * math.cos(a), -r * math.sin(a)) for a in (math.pi / 2 * i / parts for i in range(1, parts))]
        point.append((0.0, -r))
        zip_rows(row, before, point, triangle)
        surface.append(row[0])
        axis.append(row[-1])
        before, last = row, r
    return Mesh(point, triangle, {"surface": surface, "axis": axis, "outer": before})


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
