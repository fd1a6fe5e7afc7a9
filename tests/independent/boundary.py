"""The edges that belong to one element only: their body's side, their length, and the pressure on them. Standard library only.

Nodes have any names: rows of arrays, or ids.
"""
from dataclasses import dataclass
from math import cos, fmod, pi, radians, sin, sqrt

from kinds import solved

#: For an edge from 0 to 1 with two or three nodes (end, end, middle): coefficients of the shape functions [node][power].
WAYS = {n: list(zip(*solved([[t ** p for p in range(n)] for t in (0.0, 1.0, 0.5)[:n]],
                            [[float(i == j) for j in range(n)] for i in range(n)]))) for n in (2, 3)}


@dataclass(frozen=True)
class Side:
    nodes: tuple        # end, end, mid-side node or nothing
    inner: tuple        # the centre of the element's corners
    thickness: float    # None if axisymmetric

    def depth(self, radius):
        return 2 * pi * radius if self.thickness is None else self.thickness


def boundary(elements, x):
    """The edges that belong to one element, by their ends. `elements`: (type, nodes in the order of the card, thickness or None)."""
    found = {}
    for kind, nodes, thickness in elements:
        corners = [x[nodes[i]] for i in kind.corners()]
        inner = tuple(sum(corner[c] for corner in corners) / len(corners) for c in (0, 1))
        for side in kind.sides:
            names = tuple(nodes[i] for i in side)
            found.setdefault(frozenset(names[:2]), []).append(Side(names, inner, thickness))
    return {ends: sides[0] for ends, sides in found.items() if len(sides) == 1}


#: Five Gauss points from 0 to 1 and their weights: exact for a linear pressure on a curved edge of an axisymmetric element.
NEAR, FAR = (sqrt(5 - sign * 2 * sqrt(10 / 7)) / 6 for sign in (1, -1))
GAUSS = [(0.5 + at, weight / 1800) for at, weight in ((0.0, 512), (-NEAR, 322 + 13 * sqrt(70)), (NEAR, 322 + 13 * sqrt(70)),
                                                      (-FAR, 322 - 13 * sqrt(70)), (FAR, 322 - 13 * sqrt(70)))]


def side_points(x):
    """For each of five Gauss points on an edge: shape function values, coordinates, tangent times its weight, position from 0 to 1.

    x: its ends, and its mid-side node if it has one."""
    shape = WAYS[len(x)]
    for t, part in GAUSS:
        values = [sum(c * t ** p for p, c in enumerate(column)) for column in shape]
        slopes = [sum(p * c * t ** (p - 1) for p, c in enumerate(column) if p) for column in shape]
        place = [sum(v * point[c] for v, point in zip(values, x)) for c in (0, 1)]
        yield values, place, [part * sum(v * point[c] for v, point in zip(slopes, x)) for c in (0, 1)], t


def edge_forces(side, x, first, pressures, angle):
    """(node, direction, force) of a pressure that is linear between the ends; `angle` rotates it from the inward
    normal, in degrees."""
    a, b = side.nodes[:2] if side.nodes[0] == first else side.nodes[1::-1]
    nodes = [a, b, *side.nodes[2:]]
    along = x[b][0] - x[a][0], x[b][1] - x[a][1]
    left = along[0] * (side.inner[1] - x[a][1]) > along[1] * (side.inner[0] - x[a][0])
    turn = radians(fmod(angle, 360.0)) + (pi / 2 if left else -pi / 2)
    for values, place, tangent, t in side_points([x[node] for node in nodes]):
        traction = (pressures[0] + (pressures[1] - pressures[0]) * t) * side.depth(place[0])
        push = (tangent[0] * cos(turn) - tangent[1] * sin(turn), tangent[0] * sin(turn) + tangent[1] * cos(turn))
        for node, value in zip(nodes, values):
            for c in (0, 1):
                yield node, c, value * traction * push[c]
