"""Strains at the integration points of an element, from the displacements of its nodes, and the volumes of the points."""
import math
from functools import cache

from kinds import KINDS


@cache
def reference(name):
    """Shape functions of each integration point and their derivatives by both coordinates."""
    kind = KINDS[name]
    return list(zip(kind.shapes(), kind.shapes(0), kind.shapes(1)))


def unit_strains(name, x, thickness, plane_stress):
    """[(volume, [(of ux, of uy) of each node])] of each point: strains xx, yy, zz, xy of a unit displacement."""
    kind, points = KINDS[name], []
    apart = [[p[c] - x[0][c] for c in (0, 1)] for p in x]   # exact, far from the origin
    for weight, (value, by_a, by_b) in zip(kind.weights, reference(name)):
        xa, ya, xb, yb = (sum(s * p[c] for s, p in zip(slope, apart)) for slope in (by_a, by_b) for c in (0, 1))
        twice = xa * yb - xb * ya
        radius = sum(v * p[0] for v, p in zip(value, x))
        depth = 2 * math.pi * radius if kind.ring else thickness
        unit = []
        for v, a, b in zip(value, by_a, by_b):
            dx, dy = (a * yb - b * ya) / twice, (b * xa - a * xb) / twice
            unit.append(([dx, 0.0, v / radius if kind.ring else 0.0, dy], [0.0, dy, 0.0, dx]))
        points.append((abs(twice) * weight * depth, unit))
    if name == "CQUAD4" and not plane_stress:
        even_out(points)
    return points


def places(name, x):
    """Coordinates of the integration points."""
    return [[sum(v * p[c] for v, p in zip(value, x)) for c in (0, 1)] for value, _, _ in reference(name)]


def free_strains(name, nodes, section, temperature, volumes):
    """Thermal strain of each point along each axis, if unrestrained."""
    if temperature is None:
        return [0.0] * len(volumes)
    a, none_at = section.expansion
    found = [math.fsum(v * a * (temperature(node) - none_at) for v, node in zip(value, nodes)) for value, _, _ in reference(name)]
    if name == "CQUAD4" and not section.plane_stress:   # the volume strain at each point is that of the whole element
        found = [math.fsum(volume * e for volume, e in zip(volumes, found)) / math.fsum(volumes)] * len(found)
    return found


def even_out(points):
    """The volume strain at each point is that of the whole element."""
    whole = math.fsum(volume for volume, _ in points)
    for k in range(4):
        for c in (0, 1):
            mean = math.fsum(volume * sum(unit[k][c][:3]) for volume, unit in points) / whole
            for _, unit in points:
                change = (mean - sum(unit[k][c][:3])) / 3
                unit[k][c][:3] = [value + change for value in unit[k][c][:3]]


def strain_of(unit, u, ring):
    """Strains from displacements of the nodes; a common translation is subtracted first, so that it adds no rounding."""
    travel = (0.0 if ring else u[0][0], u[0][1])
    return [sum(of[c][i] * (moved[c] - travel[c]) for of, moved in zip(unit, u) for c in (0, 1)) for i in range(4)]
