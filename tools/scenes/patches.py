"""Meshes from four-sided patches, of any element: two triangles of 3 or 6 nodes in each cell, or a quadrilateral.

A side of a patch is a list of points, alternately a corner of an element and a mid-side node; `straight` and `arc` make them.
"""
import math

from .mesh import Mesh, corners_of


def halves(places):
    """The points and those halfway between them: fractions of a side, from 0 to 1."""
    first, last = places[0], places[-1]
    inside = [p for a, b in zip(places, places[1:]) for p in ((a + b) / 2, b)]
    return [(p - first) / (last - first) for p in [first] + inside]


def even(parts):
    """Fractions of a side of equal elements."""
    return halves([i / parts for i in range(parts + 1)])


def straight(a, b, fractions):
    return [(a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])) for s in fractions]


def arc(centre, radius, begin, end, fractions):
    """Angles in degrees from the x-axis, counter-clockwise."""
    angle = [math.radians(begin + s * (end - begin)) for s in fractions]
    return [(centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t)) for t in angle]


def lengths(side):
    """Arc lengths of the points of a side, as fractions of the whole."""
    run = [0.0]
    for a, b in zip(side, side[1:]):
        run.append(run[-1] + math.dist(a, b))
    return [r / run[-1] for r in run]


def patch(bottom, top, left, right):
    """Rows of points between four sides (Coons): bottom and top run from left to right, the others upwards."""
    across = [(a + b) / 2 for a, b in zip(lengths(bottom), lengths(top))]
    up = [(a + b) / 2 for a, b in zip(lengths(left), lengths(right))]
    assert len(bottom) == len(top) and len(left) == len(right)
    rows = []
    for j, t in enumerate(up):
        rows.append([tuple((1 - t) * bottom[i][k] + t * top[i][k] + (1 - s) * left[j][k] + s * right[j][k]
                           - (1 - t) * ((1 - s) * bottom[0][k] + s * bottom[-1][k])
                           - t * ((1 - s) * top[0][k] + s * top[-1][k]) for k in (0, 1)) for i, s in enumerate(across)])
    return rows


def join(patches, element):
    """One mesh of patches that share sides. `element`: ctria3, ctria6, cquad4, cquad8."""
    point, found, cells = [], {}, []
    size = max(abs(x) for rows in patches for row in rows for place in row for x in place)
    grain = 1e-7 * size

    def number(place):
        i, j = round(place[0] / grain), round(place[1] / grain)
        near = [found[key] for key in ((i + a, j + b) for a in (0, -1, 1) for b in (0, -1, 1)) if key in found]
        if not near:
            found[i, j] = len(point)
            point.append(tuple(0.0 if abs(x) < grain * 1e-3 else x for x in place))
        return near[0] if near else len(point) - 1

    for rows in patches:
        for j in range(0, len(rows) - 1, 2):
            for i in range(0, len(rows[0]) - 1, 2):
                a, b, c, d = rows[j][i], rows[j][i + 2], rows[j + 2][i + 2], rows[j + 2][i]
                ab, bc, cd, da, m = rows[j][i + 1], rows[j + 1][i + 2], rows[j + 2][i + 1], rows[j + 1][i], rows[j + 1][i + 1]
                if element in ("cquad4", "cquad8"):
                    wanted = [(a, b, c, d, ab, bc, cd, da)[:int(element[-1])]]
                elif math.dist(a, c) <= math.dist(b, d) * (1 + 1e-9):
                    wanted = [(a, b, c, ab, bc, m), (a, c, d, m, cd, da)]
                else:
                    wanted = [(a, b, d, ab, m, da), (b, c, d, bc, cd, m)]
                cells += [nodes[:3] if element == "ctria3" else nodes for nodes in wanted]
    return Mesh(point, [tuple(number(place) for place in nodes) for nodes in cells], {})


def boundary(mesh):
    """The next node of each node along the boundary, the body on the left; mid-side nodes included."""
    after = {}
    for nodes in mesh.element:
        corners = nodes[:corners_of(nodes)]
        (xa, ya), (xb, yb), (xc, yc) = (mesh.point[n] for n in corners[:3])
        turn = 1 if (xb - xa) * (yc - ya) > (xc - xa) * (yb - ya) else -1
        for k, a in enumerate(corners):
            b = corners[(k + 1) % len(corners)]
            after[(a, b) if turn > 0 else (b, a)] = nodes[len(corners) + k] if len(nodes) > len(corners) else None
    follows = {}
    for (a, b), middle in after.items():
        if (b, a) not in after:
            if middle is None:
                follows[a] = b
            else:
                follows[a], follows[middle] = middle, b
    return follows


def walk(mesh, begin, end):
    """The nodes of the boundary from the corner nearest to one point to that nearest to another, the body on the left."""
    follows = boundary(mesh)
    corners = {n for nodes in mesh.element for n in nodes[:corners_of(nodes)]}
    node, last = (min(corners & follows.keys(), key=lambda n: math.dist(mesh.point[n], place)) for place in (begin, end))
    nodes = [node]
    while node != last or len(nodes) == 1:
        node = follows[node]
        nodes.append(node)
    return nodes
