"""Solve the two cylinders, elastic, with scikit-fem: the whole program is timed.

    python scikit_fem.py MESH condense|cholmod|splu

MESH: nodes, elements and lines in numpy's .npz. scikit-fem assembles the stiffness. An active set method gives forces and
approach, which are printed as JSON with the seconds after the imports. No stresses, no tables.

`condense` is the usual way to write contact with scikit-fem: in each step the nodes of the active set are fixed on the
plane, the system is condensed and solved by scipy's SuperLU with its defaults, and the next set follows from the reactions. The others use
epcont's method, as fast as scikit-fem's parts allow: one integration point per element, one factorization with fixed
platen, by CHOLMOD or by SuperLU with order and pivots for symmetric matrices, one solution for each contact node, and the
active set method on their flexibility alone.
"""
import sys
import time

begun = time.perf_counter()
import json  # noqa: E402

import numpy as np  # noqa: E402
import scipy.sparse as sparse  # noqa: E402
from scipy.sparse.linalg import splu  # noqa: E402
from skfem import Basis, ElementTriP1, ElementVector, MeshTri, condense  # noqa: E402
from skfem.models.elasticity import lame_parameters, linear_elasticity  # noqa: E402

YOUNG, NU, LOAD = 20400.0, 0.29, 5.0


def solver(matrix, kind):
    if kind == "cholmod":
        from sksparse.cholmod import cholesky

        return cholesky(matrix.tocsc())
    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve


def contact(flexibility, gap):
    """R >= 0, w = gap + F R - q >= 0, R.w = 0, sum R = LOAD."""
    n = len(gap)
    active = np.ones(n, bool)
    for _ in range(10 * n):
        a = np.flatnonzero(active)
        system = np.block([[flexibility[np.ix_(a, a)], -np.ones((len(a), 1))], [np.ones((1, len(a))), np.zeros((1, 1))]])
        answer = np.linalg.solve(system, np.append(-gap[a], LOAD))
        force, q = np.zeros(n), answer[-1]
        force[a] = answer[:-1]
        wrong = np.where(active, force < 0, gap + flexibility @ force - q < -1e-15)
        if not wrong.any():
            return force, q
        active ^= wrong
    sys.exit("no active set found")


def by_flexibility(stiffness, dof, data, kind):
    touch = data["touch"]
    held = np.concatenate([dof[0, data["axis"]], dof[1, data["top"]]])
    free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
    place = np.full(stiffness.shape[0], -1)
    place[free] = np.arange(len(free))
    rows = place[dof[1, touch]]
    load = np.zeros((len(free), len(rows)))
    load[rows, np.arange(len(rows))] = 1.0
    response = solver(sparse.csr_matrix(stiffness)[free][:, free], kind)(load)
    force, q = contact(response[rows], data["point"][touch, 1])
    displacement = np.zeros(stiffness.shape[0])
    displacement[free] = response @ force
    displacement[dof[1]] -= q
    return force, q, displacement


def by_condensing(stiffness, dof, data):
    touch, gap = data["touch"], data["point"][data["touch"], 1]
    axis, top, pairs = dof[0, data["axis"]], dof[1, data["top"]], dof[1, touch]
    active = np.ones(len(touch), bool)
    for _ in range(10 * len(touch)):
        # solutions for unit approach and for closed gaps: the load determines the approach
        given = np.zeros((2, stiffness.shape[0]))
        given[0, top] = -1.0
        given[1, pairs[active]] = -gap[active]
        held = np.concatenate([axis, top, pairs[active]])
        matrix, right, _, free = condense(stiffness, x=given[0], D=held)
        other = -(stiffness @ given[1])[free]
        given[:, free] = splu(matrix.tocsc()).solve(np.column_stack([right, other])).T
        reaction = (stiffness @ given.T)[pairs]
        q = (LOAD - reaction[:, 1].sum()) / reaction[:, 0].sum()
        displacement = q * given[0] + given[1]
        force = np.where(active, q * reaction[:, 0] + reaction[:, 1], 0.0)
        wrong = np.where(active, force < 0, gap + displacement[pairs] < -1e-15)
        if not wrong.any():
            return force, q, displacement
        active ^= wrong
    sys.exit("no active set found")


def main():
    data, kind, imported = np.load(sys.argv[1]), sys.argv[2], time.perf_counter()
    basis = Basis(MeshTri(data["point"].T.copy(), data["element"].T.copy()), ElementVector(ElementTriP1()),
                  intorder=None if kind == "condense" else 0)
    stiffness = linear_elasticity(*lame_parameters(YOUNG, NU)).assemble(basis)
    if kind == "condense":
        force, q, displacement = by_condensing(stiffness, basis.nodal_dofs, data)
    else:
        force, q, displacement = by_flexibility(stiffness, basis.nodal_dofs, data, kind)
    now = time.perf_counter()
    print(json.dumps({"force": force.tolist(), "approach": -q, "imports": imported - begun, "rest": now - imported,
                      "largest": float(abs(displacement).max())}))


main()
