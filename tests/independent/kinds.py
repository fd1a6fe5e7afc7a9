"""Element types from monomials: shape functions follow from the coordinates of the reference nodes.

A function on an element is a sum of monomials of the reference coordinates, as many as nodes; the one that is 1 at a node and 0
at the others has the coefficients that solve the system of the monomials at the nodes. Standard library only.
"""
from dataclasses import dataclass
from functools import cached_property
from math import prod, sqrt

THIRD, HALF = 1 / 3, 1 / 2
GAUSS = (HALF - sqrt(0.15), HALF, HALF + sqrt(0.15)), (5 / 18, 8 / 18, 5 / 18)


def solved(matrix, rights):
    """x of matrix x = rights, both lists of rows."""
    rows = [list(row) + list(right) for row, right in zip(matrix, rights)]
    for k in range(len(rows)):
        pivot = max(range(k, len(rows)), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        rows[k] = [value / rows[k][k] for value in rows[k]]
        for i in range(len(rows)):
            if i != k and rows[i][k]:
                factor = rows[i][k]
                rows[i] = [value - factor * other for value, other in zip(rows[i], rows[k])]
    return [row[len(rows):] for row in rows]


@dataclass(frozen=True)
class Kind:
    """Reference nodes in the order of the card, powers of the monomials, integration points with weights; edges as positions in the
    card (end, end, mid-side node or nothing)."""
    nodes: tuple
    powers: tuple
    points: tuple
    weight: float | tuple   # weight of each point, or one for all
    sides: tuple
    ring: bool = False

    @cached_property
    def weights(self):
        return self.weight if isinstance(self.weight, tuple) else (self.weight,) * len(self.points)

    def monomial(self, place, power, derived=None):
        """A monomial at a point, or its derivative by one coordinate."""
        if derived is None:
            return prod(x ** p for x, p in zip(place, power))
        lower = [p - (c == derived) for c, p in enumerate(power)]
        return power[derived] * self.monomial(place, lower) if power[derived] else 0.0

    @cached_property
    def coefficients(self):
        """Coefficients of the shape functions [monomial][node]."""
        return solved([[self.monomial(place, power) for power in self.powers] for place in self.nodes],
                      [[float(i == j) for j in range(len(self.nodes))] for i in range(len(self.nodes))])

    def shapes(self, derived=None, places=None):
        """Shape functions, or derivatives, at points, by default the integration points [point][node]."""
        columns = list(zip(*self.coefficients))
        terms = [[self.monomial(place, power, derived) for power in self.powers] for place in places or self.points]
        return [[sum(term * c for term, c in zip(row, column)) for column in columns] for row in terms]

    def corners(self):
        return [side[0] for side in self.sides]


LINEAR, QUADRATIC = ((0, 0), (1, 0), (0, 1)), ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))
SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))
TRIANGLE = ((0, 0), (1, 0), (0, 1)), LINEAR, ((THIRD, THIRD),), 0.5, ((0, 1), (1, 2), (2, 0))
INSIDE = ((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3))

KINDS = {
    "CTRIA3": Kind(*TRIANGLE),
    "CTRIA6": Kind(((0, 0), (1, 0), (0, 1), (HALF, 0), (HALF, HALF), (0, HALF)), QUADRATIC, INSIDE, 1 / 6,
                   ((0, 1, 3), (1, 2, 4), (2, 0, 5))),
    "CQUAD4": Kind(SQUARE, ((0, 0), (1, 0), (0, 1), (1, 1)), tuple((x / 3 ** 0.5, y / 3 ** 0.5) for x, y in SQUARE), 1.0,
                   ((0, 1), (1, 2), (2, 3), (3, 0))),
    "CQUAD8": Kind((*SQUARE, (0, -1), (1, 0), (0, 1), (-1, 0)), (*QUADRATIC, (2, 1), (1, 2)),
                   tuple((2 * x - 1, 2 * y - 1) for y in GAUSS[0] for x in GAUSS[0]),
                   tuple(4 * v * w for w in GAUSS[1] for v in GAUSS[1]), ((0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))),
    "CTRAX3": Kind(*TRIANGLE, ring=True),
    "CTRAX6": Kind(((0, 0), (HALF, 0), (1, 0), (HALF, HALF), (0, 1), (0, HALF)), QUADRATIC, INSIDE, 1 / 6,
                   ((0, 2, 1), (2, 4, 3), (4, 0, 5)), ring=True),
}
