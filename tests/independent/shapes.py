"""Elements from monomials: no shape function is written down here, all come from the places of the reference nodes.

A function on an element is a sum of monomials of the reference coordinates, as many as nodes; the one that is 1 at a node and 0
at the others is a column of the inverse of the matrix of monomials at the nodes. Nodes may turn either way round.
"""
from dataclasses import dataclass

import numpy as np

THIRD, HALF = 1 / 3, 1 / 2
GAUSS = np.array([-np.sqrt(0.6), 0.0, np.sqrt(0.6)]) / 2 + 0.5, np.array([5.0, 8.0, 5.0]) / 18


@dataclass(frozen=True)
class Kind:
    """Reference nodes in the order of the card, powers of the monomials, integration points with weights; sides as places in the
    card (end, end, middle or nothing)."""
    nodes: tuple
    powers: tuple
    points: tuple
    weight: float
    sides: tuple
    ring: bool = False

    def monomials(self, places, derived=None):
        """Of all places [place, monomial], or their derivatives by one coordinate."""
        places, powers = np.asarray(places, float), np.array(self.powers)
        factor = np.ones(len(powers))
        if derived is not None:
            factor = powers[:, derived].astype(float)
            powers = powers.copy()
            powers[:, derived] = np.maximum(powers[:, derived] - 1, 0)
        return factor * np.prod(places[:, None, :] ** powers[None], axis=2)

    def shapes(self, derived=None):
        """Shape functions, or derivatives, at the integration points [point, node]."""
        return self.monomials(self.points, derived) @ np.linalg.inv(self.monomials(self.nodes))

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
    "CTRAX3": Kind(*TRIANGLE, ring=True),
    "CTRAX6": Kind(((0, 0), (HALF, 0), (1, 0), (HALF, HALF), (0, 1), (0, HALF)), QUADRATIC, INSIDE, 1 / 6,
                   ((0, 2, 1), (2, 4, 3), (4, 0, 5)), ring=True),
}


def folded(kind, x):
    """Whether an element turns over at some corner: x [element, node, 2]."""
    inverse = np.linalg.inv(kind.monomials(kind.nodes))
    slope = np.stack([kind.monomials(kind.nodes, c) @ inverse for c in (0, 1)], axis=1)[kind.corners()]
    sense = np.sign(np.linalg.det(np.einsum("pcn,enj->epcj", slope, x)))
    return np.any(sense != sense[:, :1], axis=1)


def strain_matrices(kind, x, thickness, mean_dilatation):
    """Strains xx yy zz xy of nodal displacements [element, point, 4, 2 nodes] and volumes [element, point].

    x [element, node, 2]; rings take the circumference for their thickness. With `mean_dilatation` the change of volume at all
    points is that of the whole element."""
    value = kind.shapes()
    slope = np.stack([kind.shapes(0), kind.shapes(1)], axis=1)            # [point, coordinate, node]
    jacobian = np.einsum("pcn,enj->epcj", slope, x)
    gradient = np.linalg.solve(jacobian, np.broadcast_to(slope, (len(x),) + slope.shape))
    volume = abs(np.linalg.det(jacobian)) * kind.weight
    b = np.zeros(gradient.shape[:2] + (4, 2 * len(kind.nodes)))
    b[:, :, 0, 0::2] = b[:, :, 3, 1::2] = gradient[:, :, 0]
    b[:, :, 1, 1::2] = b[:, :, 3, 0::2] = gradient[:, :, 1]
    if kind.ring:
        radius = np.einsum("pn,en->ep", value, x[:, :, 0])
        b[:, :, 2, 0::2] = value / radius[:, :, None]
        volume = volume * 2 * np.pi * radius
    else:
        volume = volume * thickness[:, None]
    if mean_dilatation.any():
        here = b[:, :, :3].sum(axis=2)
        whole = np.einsum("ep,epk->ek", volume, here) / volume.sum(axis=1)[:, None]
        change = np.where(mean_dilatation[:, None, None], whole[:, None] - here, 0.0) / 3
        b[:, :, :3] += change[:, :, None]
    return b, volume


def side_points(x):
    """Of each of three Gauss points on a side: shape functions, place, tangent times its part, way along from 0 to 1.

    x: its ends, and its middle where it has one."""
    nodes = np.array([0.0, 1.0, 0.5])[:len(x)]
    powers = np.arange(len(x))
    inverse = np.linalg.inv(nodes[:, None] ** powers)
    for t, part in zip(*GAUSS):
        values = (t ** powers) @ inverse
        slopes = (powers * t ** np.maximum(powers - 1, 0)) @ inverse
        yield values, values @ x, part * (slopes @ x), t
