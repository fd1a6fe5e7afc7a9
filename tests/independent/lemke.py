"""Lemke's algorithm for linear complementarity problems, and contact with friction as such a problem (Klarbring)."""
import numpy as np

#: Smallest entry that may be a pivot; perturbation against ties, relative to the largest entry of q; pivots per variable.
LEAST_PIVOT, PERTURBED, PATIENCE = 1e-11, 1e-13, 50


def lemke(matrix, q, cover=None):
    """Which w of w = q + matrix z, w >= 0, z >= 0, w z = 0 are basic? None if the path ends with a ray. `cover`: covering vector; ones."""
    n = len(q)
    start = q / (abs(q).max() or 1.0) + PERTURBED * np.random.default_rng(n).random(n)
    if (start >= 0.0).all():
        return np.ones(n, bool)
    cover = np.ones(n) if cover is None else cover
    table = np.hstack([np.eye(n), -matrix, -cover[:, None], start[:, None]])
    basis, entering, k = np.arange(n), 2 * n, int(np.argmin(start / cover))
    for _ in range(PATIENCE * n):
        table[k] /= table[k, entering]
        others = np.arange(n) != k
        table[others] -= np.outer(table[others, entering], table[k])
        basis[k], leaving = entering, basis[k]
        if leaving == 2 * n:
            return np.isin(np.arange(n), basis)
        entering = (leaving + n) % (2 * n)
        column = table[:, entering]
        able = column > LEAST_PIVOT
        ratio = np.where(able, table[:, -1] / np.where(able, column, 1.0), np.inf)
        if not able.any():
            return None
        k = int(np.argmin(ratio))
        last = np.flatnonzero(basis == 2 * n)[0]
        k = last if ratio[last] <= ratio[k] * (1 + 1e-12) else k
    return None


def friction_states(flexibility, start, slides, mu, cover=None):
    """For each pair: is it open, and the sign of its slip (0: it sticks, or has no friction); None without an answer. `flexibility` and `start`: of the
    gaps, then of the slips of the pairs `slides`. Variables: R, T + mu R and the slip against the tangent; gap, slip along it, and mu R - T."""
    n, s = len(start) - len(slides), len(slides)
    f = flexibility.copy()
    f[:, slides] -= f[:, n:] * mu
    unit = abs(f).max() or 1.0
    matrix = np.block([[f / unit, np.vstack([np.zeros((n, s)), np.eye(s)])], [np.zeros((s, n)), -np.eye(s), np.zeros((s, s))]])
    matrix[n + s + np.arange(s), slides] = 2 * mu
    basic = lemke(matrix, np.concatenate([start, np.zeros(s)]), cover)
    if basic is None:
        return None
    sign = np.zeros(n, int)
    sign[slides] = basic[n:n + s].astype(int) - ~basic[n + s:]
    return basic[:n], sign
