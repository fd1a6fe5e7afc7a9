"""Triangles of a given size between curves: Delaunay's triangulation of points from a quadtree, smoothed."""
import math

from .mesh import without_unused


def segment(a, b):
    return lambda s: (a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]))


def arc(centre, radius, begin, end):
    """Angles in degrees, counter-clockwise from the x-axis."""
    def curve(s):
        t = math.radians(begin + s * (end - begin))
        return centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t)
    return curve


def finest(places, growth, largest):
    """A size that grows with the distance from some points: (point, size there, distance to which it is constant)."""
    def size(x, y):
        return min([largest] + [h + growth * max(0.0, math.hypot(x - c[0], y - c[1]) - reach) for c, h, reach in places])
    return size


def divide(curve, size, samples=4000):
    """Parameters that divide a curve into edges of this size, with angles of at most 30 degrees."""
    places = [curve(i / samples) for i in range(samples + 1)]
    count, way = [0.0], None
    for p, q in zip(places, places[1:]):
        before, way = way, math.atan2(q[1] - p[1], q[0] - p[0])
        turn = 0.0 if before is None else abs(math.remainder(way - before, 2 * math.pi))
        count.append(count[-1] + max(math.dist(p, q) / size((p[0] + q[0]) / 2, (p[1] + q[1]) / 2), turn / math.radians(30.0)))
    parts = max(1, round(count[-1]))
    cuts, k = [0.0], 0
    for i in range(1, parts):
        wanted = i * count[-1] / parts
        while count[k + 1] < wanted:
            k += 1
        cuts.append((k + (wanted - count[k]) / (count[k + 1] - count[k])) / samples)
    return cuts + [1.0]


def delaunay(point):
    """Triangles, counter-clockwise (Bowyer and Watson)."""
    xs, ys = [p[0] for p in point], [p[1] for p in point]
    x, y, r = (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2, 50 * max(max(xs) - min(xs), max(ys) - min(ys))
    n = len(point)
    point = list(point) + [(x - 2 * r, y - r), (x + 2 * r, y - r), (x, y + 2 * r)]
    third = {(n, n + 1): n + 2, (n + 1, n + 2): n, (n + 2, n): n + 1}  # triangle to the left of each edge

    def turn(a, b, p):
        return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])

    def inside_circle(a, b, c, p):
        ax, ay, bx, by, cx, cy = a[0] - p[0], a[1] - p[1], b[0] - p[0], b[1] - p[1], c[0] - p[0], c[1] - p[1]
        return ((ax * ax + ay * ay) * (bx * cy - cx * by) - (bx * bx + by * by) * (ax * cy - cx * ay)
                + (cx * cx + cy * cy) * (ax * by - bx * ay)) > 0.0

    cell = r / 50 / math.sqrt(n)
    last = (n, n + 1)
    for i in sorted(range(n), key=lambda i: (int(ys[i] / cell), xs[i] if int(ys[i] / cell) % 2 else -xs[i])):
        p, (a, b) = point[i], last
        if turn(point[a], point[b], p) < 0:
            a, b = b, a
        while True:  # walk to the triangle that contains p
            c = third[a, b]
            if turn(point[b], point[c], p) < 0:
                a, b = c, b
            elif turn(point[c], point[a], p) < 0:
                a, b = a, c
            else:
                break
        hole, rim = [(a, b), (b, c), (c, a)], []
        for side in ((a, b), (b, c), (c, a)):
            del third[side]
        while hole:
            a, b = hole.pop()
            c = third.get((b, a))
            if c is not None and (inside_circle(point[b], point[a], point[c], p) or turn(point[a], point[b], p) <= 0):
                for side in ((b, a), (a, c), (c, b)):
                    del third[side]
                hole += [(a, c), (c, b)]
            else:
                rim.append((a, b))
        sides = set(rim)
        rim = [(a, b) for a, b in rim if (b, a) not in sides]
        for a, b in rim:
            third[a, b], third[b, i], third[i, a] = i, a, b
        last = rim[0]
    return sorted({(a, b, c) for (a, b), c in third.items() if max(a, b, c) < n and a < b and a < c})


def winding(polygon, x, y):
    inside = False
    for (xa, ya), (xb, yb) in zip(polygon, polygon[1:] + polygon[:1]):
        if (ya > y) != (yb > y) and x < xa + (y - ya) / (yb - ya) * (xb - xa):
            inside = not inside
    return inside


def leaves(x, y, width, size):
    """Centres of the squares of a quadtree that are no larger than the size there."""
    if width <= 1.0 * size(x, y):
        return [(x, y)]
    quarter = width / 4
    return [leaf for dx in (-quarter, quarter) for dy in (-quarter, quarter) for leaf in leaves(x + dx, y + dy, width / 2, size)]


def fill(pieces, size, middles=True, rounds=8):
    """A body between closed curves, each (name or None, curve from 0 to 1), the body on the left. `line`: the nodes on the
    curves of a name. With `middles` triangles of six nodes, on the curves."""
    point, line, middle = [], {}, {}
    for name, curve in pieces:
        cuts = divide(curve, size)
        first = len(point)
        point += [curve(s) for s in cuts[:-1]]
        nodes = list(range(first, len(point) + 1))
        for k, (s, t) in enumerate(zip(cuts, cuts[1:])):
            middle[nodes[k]] = curve((s + t) / 2)
        if name:
            line[name] = line[name] + nodes[1:] if name in line and line[name][-1] == nodes[0] else nodes
    rim = len(point)
    line = {name: [n % rim for n in nodes] for name, nodes in line.items()}
    polygon = list(point)
    xs, ys = [p[0] for p in point], [p[1] for p in point]
    width = max(max(xs) - min(xs), max(ys) - min(ys)) * 1.01
    for i, (x, y) in enumerate(leaves((min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2, width, size)):
        h = size(x, y)
        x, y = x + 0.05 * h * math.sin(12.9 * i), y + 0.05 * h * math.sin(78.2 * i)
        if winding(polygon, x, y) and all(math.hypot(x - p[0], y - p[1]) > 0.6 * h for p in polygon):
            point.append((x, y))
    for sweep in range(rounds):
        triangle = within(point, polygon)
        if sweep == rounds - 1:
            break
        moment = [[0.0, 0.0, 0.0] for _ in point]
        for nodes in triangle:  # towards the centres of the triangles around a point, with more weight if they are too large
            (xa, ya), (xb, yb), (xc, yc) = (point[n] for n in nodes)
            x, y = (xa + xb + xc) / 3, (ya + yb + yc) / 3
            weight = abs((xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)) / size(x, y) ** 3
            for n in nodes:
                moment[n][0] += weight * x
                moment[n][1] += weight * y
                moment[n][2] += weight
        for n in range(rim, len(point)):
            if moment[n][2] > 0.0:
                point[n] = (moment[n][0] / moment[n][2], moment[n][1] / moment[n][2])
    mesh = without_unused(point, triangle, line)
    if len(mesh.point) != len(point):
        raise ValueError("no triangle uses some points of the boundary")
    sides = {tuple(sorted(side)) for a, b, c in triangle for side in ((a, b), (b, c), (c, a))}
    if any(tuple(sorted((n, (n + 1) % rim))) not in sides for n in range(rim)):
        raise ValueError("a boundary edge is cut: refine the mesh")
    if not middles:
        return mesh
    at = {point[n]: n for n in range(rim)}

    def curved(a, b):
        m, n = at.get(a, -1), at.get(b, -1)
        if m >= 0 and n == (m + 1) % rim:
            return middle[m]
        return middle[n] if n >= 0 and m == (n + 1) % rim else None
    return mesh.with_middles(curved)


def within(point, polygon):
    """The triangles inside a polygon whose corners are the first points."""
    rim = len(polygon)
    triangle = []
    for a, b, c in delaunay(point):
        (xa, ya), (xb, yb), (xc, yc) = point[a], point[b], point[c]
        area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)
        longest = max(math.dist(point[a], point[b]), math.dist(point[b], point[c]), math.dist(point[c], point[a]))
        if area < 1e-6 * longest ** 2 or max(a, b, c) < rim and not winding(polygon, (xa + xb + xc) / 3, (ya + yb + yc) / 3):
            continue
        triangle.append((a, b, c))
    return triangle
