"""Strains and volumes of many elements at once, from the shape functions of kinds.py. Nodes may be in either direction."""
import numpy as np


def folded(kind, x):
    """Does an element fold over at a corner? x [element, node, 2]."""
    slope = np.stack([kind.shapes(c, kind.nodes) for c in (0, 1)], axis=1)[kind.corners()]
    sense = np.sign(np.linalg.det(np.einsum("pcn,enj->epcj", slope, x)))
    return np.any(sense != sense[:, :1], axis=1)


def strain_matrices(kind, x, thickness, mean_dilatation):
    """Strains xx yy zz xy of nodal displacements [element, point, 4, 2 nodes] and volumes [element, point].

    x [element, node, 2]; axisymmetric elements have the circumference as thickness. With `mean_dilatation` the volume strain at all
    points is that of the whole element."""
    value = np.array(kind.shapes())
    slope = np.stack([kind.shapes(0), kind.shapes(1)], axis=1)            # [point, coordinate, node]
    jacobian = np.einsum("pcn,enj->epcj", slope, x)
    gradient = np.linalg.solve(jacobian, np.broadcast_to(slope, (len(x),) + slope.shape))
    volume = abs(np.linalg.det(jacobian)) * np.array(kind.weights)
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
