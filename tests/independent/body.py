"""Nodal forces of gravity and rotation, exact: all integrands are polynomials of the reference coordinates. Standard library only.

A polynomial is a dictionary: coefficients by powers.
"""
from functools import cache
from math import factorial, pi


def times(p, q):
    product = {}
    for (i, j), a in p.items():
        for (k, m), b in q.items():
            product[i + k, j + m] = product.get((i + k, j + m), 0.0) + a * b
    return product


def combined(terms):
    """The sum of factors times polynomials."""
    total = {}
    for factor, p in terms:
        for power, c in p.items():
            total[power] = total.get(power, 0.0) + factor * c
    return total


def derived(p, c):
    return {(i - (c == 0), j - (c == 1)): (i, j)[c] * a for (i, j), a in p.items() if (i, j)[c]}


def integral(p, corners):
    """Integrate over the triangle (0, 0), (1, 0), (0, 1), or the square from -1 to 1."""
    if corners == 3:
        return sum(c * factorial(i) * factorial(j) / factorial(i + j + 2) for (i, j), c in p.items())
    return sum(4.0 * c / ((i + 1) * (j + 1)) for (i, j), c in p.items() if i % 2 == j % 2 == 0)


@cache
def shapes_of(kind):
    """Shape functions."""
    return [dict(zip(kind.powers, column)) for column in zip(*kind.coefficients)]


def body_forces(kind, x, thickness, density, loads):
    """(fx, fy) of each node. `loads`: (acceleration, centre, revolutions, angular acceleration) of each."""
    shapes = shapes_of(kind)
    apart = [[p[c] - x[0][c] for c in (0, 1)] for p in x]
    place = [combined((p[c], shape) for p, shape in zip(apart, shapes)) for c in (0, 1)]
    area = combined([(1.0, times(derived(place[0], 0), derived(place[1], 1))), (-1.0, times(derived(place[0], 1), derived(place[1], 0)))])
    corners = len(kind.corners())
    mass = combined([(density * (1.0 if integral(area, corners) > 0.0 else -1.0), area)])
    if kind.ring:
        mass = times(mass, combined([(2.0 * pi, place[0]), (2.0 * pi * x[0][0], {(0, 0): 1.0})]))
    else:
        mass = combined([(thickness, mass)])
    pull = [{}, {}]
    for acceleration, centre, spin, growth in loads:
        arm = [combined([(1.0, place[c]), (x[0][c] - centre[c], {(0, 0): 1.0})]) for c in (0, 1)]
        arm[1] = {} if kind.ring else arm[1]
        squared, twist = (2.0 * pi * spin) ** 2, 2.0 * pi * growth
        for c, across in ((0, -twist), (1, twist)):
            pull[c] = combined([(1.0, pull[c]), (acceleration[c], {(0, 0): 1.0}), (squared, arm[c]), (across, arm[1 - c])])
    weighed = [times(mass, force) for force in pull]
    return [[integral(times(shape, force), corners) for force in weighed] for shape in shapes]
