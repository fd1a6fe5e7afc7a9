"""The two cylinders, elastic, by scikit-fem: the whole program that is timed.

    python scikit_fem.py MESH condense|cholmod|splu

MESH: numpy's .npz of the nodes, elements and lines. scikit-fem assembles the stiffness. An active set gives forces and
approach, which are printed as JSON with the seconds after the imports. No stresses, no tables.

`condense` is how contact is written with what scikit-fem has: in each step the nodes of the active set are held on the
plane, the rest is condensed and solved, by scipy's SuperLU as it comes, and the set is that of the reactions. The others do
what epcont does, as fast as scikit-fem's parts allow: one integration point an element, one factorization with the platen
held, by CHOLMOD or by SuperLU with an order and pivots for symmetric matrices, one solution for each contact node, and the
active set on their flexibility alone.
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
    sys.exit("no set of contacts found")


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
        # what an approach of 1 does, and what closing the gaps does: the load tells how much of the first
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
    sys.exit("no set of contacts found")


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
