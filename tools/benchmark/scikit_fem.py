"""The two cylinders, elastic, by scikit-fem: the whole program that is timed.

    python scikit_fem.py MESH cholmod|splu

MESH: numpy's .npz of the nodes, elements and lines. scikit-fem assembles the stiffness; CHOLMOD or SuperLU factors it with
the platen held; the flexibility of the contact nodes comes from one solution for each; an active set gives forces and
approach. Prints them as JSON, and the seconds after the imports. No stresses, no tables.
"""
import sys
import time

begun = time.perf_counter()
import json  # noqa: E402

import numpy as np  # noqa: E402
import scipy.sparse as sparse  # noqa: E402
from scipy.sparse.linalg import splu  # noqa: E402
from skfem import Basis, ElementTriP1, ElementVector, MeshTri  # noqa: E402
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


def main():
    data, kind, imported = np.load(sys.argv[1]), sys.argv[2], time.perf_counter()
    basis = Basis(MeshTri(data["point"].T.copy(), data["element"].T.copy()), ElementVector(ElementTriP1()), intorder=0)
    stiffness = linear_elasticity(*lame_parameters(YOUNG, NU)).assemble(basis)
    dof, touch = basis.nodal_dofs, data["touch"]
    held = np.concatenate([dof[0, data["axis"]], dof[1, data["top"]]])
    free = np.setdiff1d(np.arange(basis.N), held)
    place = np.full(basis.N, -1)
    place[free] = np.arange(len(free))
    rows = place[dof[1, touch]]
    load = np.zeros((len(free), len(rows)))
    load[rows, np.arange(len(rows))] = 1.0
    response = solver(sparse.csr_matrix(stiffness)[free][:, free], kind)(load)
    force, q = contact(response[rows], data["point"][touch, 1])
    displacement = np.zeros(basis.N)
    displacement[free] = response @ force
    displacement[dof[1]] -= q
    now = time.perf_counter()
    print(json.dumps({"force": force.tolist(), "approach": -q, "imports": imported - begun, "rest": now - imported,
                      "largest": float(abs(displacement).max())}))


main()
