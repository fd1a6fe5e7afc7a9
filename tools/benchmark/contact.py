"""Part 2: the dense contact problem alone, in one process: epcont's contact solver and packages for quadratic programs.

    min 1/2 R'F R + g0'R,  1'R = P,  R >= 0        (one rigid-body mode; the multiplier of 1'R = P is the approach q)

    python contact.py BENCH_CONTACT DIRECTORY REPEATS LIMIT N...      prints a JSON row for each problem, size and program

epcont is timed with its simplex (CONRY), from the start and from the correct active set (WARM), and compared with one dgemm of the size of F.
F is that of strips of uniform pressure on a half-plane; in two problems the displacement is that some strip widths below the surface. A program that takes longer than LIMIT seconds
skips the larger sizes of that problem. Data are in memory before the clock starts; times are processor times.
"""
import json
import pathlib
import statistics
import sys
import time

import daqp
import highspy
import numpy as np
import osqp
import piqp
import quadprog
import scipy.sparse as sparse

from dense import MODULUS, TOLERANCE, Epcont, half_plane


def problem(kind, n):
    """F, g0, P."""
    x = (2 * np.arange(n) + 1.0) / n - 1
    if kind == "half-plane":  # a cylinder: two thirds of the nodes are in contact
        return half_plane(n), x * x / 100, np.pi * MODULUS * (2 / 3) ** 2 / 200
    if kind == "flat":
        return half_plane(n), np.zeros(n), 10.0
    if kind == "ties":  # steps: many nodes come into contact at one load
        return half_plane(n), np.floor(8 * x * x + 1e-9) / 800, np.pi * MODULUS * (2 / 3) ** 2 / 200
    flexibility = half_plane(n, depth=SMOOTHED[kind])  # half of the nodes are loaded, the others open
    force = np.where(abs(x) < 0.5, 1 + np.cos(2 * np.pi * x), 0.0)
    clear = np.where(abs(x) < 0.5, 0.0, 1e-4 * (0.1 + abs(x)))
    gap = clear - flexibility @ force
    return flexibility, gap - gap.min(), force.sum()


#: Ill-conditioned: depth of the displacements in strips.
SMOOTHED = {"half loaded, condition 1e6": 3.0, "half loaded, condition 1e10": 6.0}
KINDS = ("half-plane", "flat", "ties", *SMOOTHED)


def violation(flexibility, gap, load, force):
    """Largest |min(R/|R|, w/(|F||R|))| and |sum R - P|/P, with |R| the largest force and |F| the largest row sum; q is the force-weighted mean of g0 + F R."""
    w = gap + flexibility @ force
    w -= w @ force / force.sum()
    largest = abs(force).max()
    size = abs(flexibility).sum(axis=1).max() * largest
    return float(max(abs(np.minimum(force / largest, w / size)).max(), abs(force.sum() / load - 1)))


def scaled(package):
    """Input of a package: forces are divided by their mean, so that its tolerances are meaningful; their sum is their number."""
    def prepare(flexibility, gap, load):
        unit = load / len(gap)
        top = abs(flexibility).max() * unit
        solve = package(flexibility * (unit / top), gap / top)
        return lambda: unit * solve()
    return prepare


def by_quadprog(f, g):
    n = len(g)
    c, b = np.hstack([np.ones((n, 1)), np.eye(n)]), np.append(float(n), np.zeros(n))
    return lambda: quadprog.solve_qp(f, -g, c, b, 1)[0]


def by_daqp(f, g):
    n = len(g)
    a = np.ones((1, n))
    upper, lower = np.append(np.full(n, 1e30), float(n)), np.append(np.zeros(n), float(n))
    sense = np.append(np.zeros(n), 5).astype(np.int32)

    def solve():
        x, _, flag, _ = daqp.solve(f, g, a, upper, lower, sense, primal_tol=TOLERANCE)
        if flag < 1:
            raise RuntimeError(f"flag {flag}")
        return x
    return solve


def by_piqp(f, g):
    n = len(g)
    f, a = np.asfortranarray(f), np.asfortranarray(np.ones((1, n)))

    def solve():
        solver = piqp.DenseSolver()
        solver.settings.eps_abs = solver.settings.eps_rel = TOLERANCE
        solver.setup(f, g, a, np.array([float(n)]), x_l=np.zeros(n))
        if solver.solve() != piqp.PIQP_SOLVED:
            raise RuntimeError(str(solver.result.info.status))
        return np.array(solver.result.x)
    return solve


def by_osqp(f, g):
    n = len(g)
    f = sparse.csc_matrix(np.triu(f))
    a = sparse.vstack([sparse.csc_matrix(np.ones((1, n))), sparse.eye(n)], format="csc")
    lower, upper = np.append(float(n), np.zeros(n)), np.append(float(n), np.full(n, np.inf))

    def solve():
        solver = osqp.OSQP()
        solver.setup(f, g, a, lower, upper, verbose=False, eps_abs=TOLERANCE, eps_rel=TOLERANCE, max_iter=20000, polishing=True,
                     time_limit=float(sys.argv[4]))
        found = solver.solve(raise_error=False)
        return found.x
    return solve


def by_highs(f, g):
    n = len(g)
    lower = sparse.csc_matrix(np.tril(f))
    model = highspy.HighsModel()
    lp = model.lp_
    lp.num_col_, lp.num_row_ = n, 1
    lp.col_cost_, lp.col_lower_, lp.col_upper_ = g, np.zeros(n), np.full(n, highspy.kHighsInf)
    lp.row_lower_ = lp.row_upper_ = np.array([float(n)])
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = np.arange(n + 1), np.zeros(n, int), np.ones(n)
    model.hessian_.dim_, model.hessian_.format_ = n, highspy.HessianFormat.kTriangular
    model.hessian_.start_, model.hessian_.index_, model.hessian_.value_ = lower.indptr, lower.indices, lower.data

    def solve():
        solver = highspy.Highs()
        for name, value in (("output_flag", False), ("threads", 1), ("time_limit", float(sys.argv[4])), ("primal_feasibility_tolerance", TOLERANCE),
                            ("dual_feasibility_tolerance", TOLERANCE), ("qp_regularization_value", 0.0)):
            solver.setOptionValue(name, value)
        solver.passModel(model)
        solver.run()
        if solver.getModelStatus() != highspy.HighsModelStatus.kOptimal:
            raise RuntimeError(str(solver.getModelStatus()))
        return np.array(solver.getSolution().col_value)
    return solve


def main():
    place = pathlib.Path(sys.argv[2])
    ours = {"epcont": "CONRY", "epcont WARM": "WARM", "dgemm": "DGEMM"}
    programs = {name: Epcont(sys.argv[1], place, rule).prepare for name, rule in ours.items()}
    packages = {"quadprog": by_quadprog, "HiGHS": by_highs, "DAQP": by_daqp, "PIQP": by_piqp, "OSQP": by_osqp}
    programs |= {name: scaled(package) for name, package in packages.items()}
    repeats, limit, sizes = int(sys.argv[3]), float(sys.argv[4]), [int(n) for n in sys.argv[5:]]
    for kind in KINDS:
        tried = list(programs)
        for n in sizes:
            data = problem(kind, n)
            condition = float(np.linalg.cond(data[0]))
            solve, spent, worst, note = {name: programs[name](*data) for name in tried}, {}, {}, {}
            for _ in range(repeats if n > 200 else 3 * repeats):
                for name in [name for name in tried if name not in note]:
                    begun = time.process_time()
                    try:
                        force = solve[name]()
                    except (RuntimeError, ValueError) as error:
                        note[name] = str(error).strip().splitlines()[-1]
                        spent.setdefault(name, []).append(getattr(error, "seconds", time.process_time() - begun))
                        continue
                    taken = time.process_time() - begun
                    if name in ours:
                        force, taken = force
                    spent.setdefault(name, []).append(taken)
                    if force is None:
                        worst[name] = None
                    elif np.isfinite(force).all() and abs(force).max() > 0:
                        worst[name] = max(worst.get(name) or 0.0, violation(*data, force))
                    else:
                        note[name] = "no answer"
            for name in tried:
                print(json.dumps({"problem": kind, "n": n, "condition": condition, "program": name, "cpu": statistics.median(spent[name]),
                                  "violation": worst.get(name), "note": note.get(name, ""),
                                  "ratio": None if "epcont" in note else statistics.median(a / b for a, b in zip(spent[name], spent["epcont"]))}),
                      flush=True)
            tried = [name for name in tried if statistics.median(spent[name]) < limit or name == "epcont"]


main()
