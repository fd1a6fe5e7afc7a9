"""Part 7: the dense contact problem with friction, in one process: epcont's solver, an augmented Lagrangian, Siconos, and Lemke's algorithm.

    gap = g0 + F_nn R + F_nt T - q_n >= 0,  R >= 0,  R gap = 0;   slip = F_tn R + F_tt T - q_t,  |T| <= mu R,  T against the slip

    python friction.py BENCH_CONTACT DIRECTORY REPEATS LIMIT N...      prints a JSON row for each problem, size and program

Half-plane: a punch or cylinder of n strips, pressed by P and pushed by mu P/2 in one step; F has the coupling of Poisson's ratio 0.3. epcont solves it with the
rigid-body modes q; the others get the q that it has found, for which epcont is timed as well (`fixed`). A program that takes longer than LIMIT seconds skips the larger sizes.
Random problems: with epcont and with Lemke's algorithm (tests/independent/lemke.py), which has weak springs on the rigid-body modes.
Data are in memory before the clock starts; times are processor times.
"""
import ctypes
import json
import pathlib
import statistics
import sys
import time

import numpy as np

from dense import MODULUS, TOLERANCE, Epcont, Stalled, half_plane

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "independent"))
from lemke import friction_states  # noqa: E402

MU, COUPLING = 0.3, 0.4 / 1.4
KINDS = ("flat", "cylinder")
#: Stiffness of Lemke's springs, relative to 1/F. Random problems: sizes, and number of each.
WEAK, RANDOM, EACH = 1e-7, (20, 50, 100), 30


def problem(kind, n):
    """F, g0, A, loads."""
    x, one = (2 * np.arange(n) + 1.0) / n - 1, half_plane(n)
    across = COUPLING / MODULUS * np.sign(np.subtract.outer(np.arange(n), np.arange(n)))
    gap = x * x / 100 if kind == "cylinder" else np.zeros(n)
    load = np.pi * MODULUS * (2 / 3) ** 2 / 200 if kind == "cylinder" else 10.0
    motion = np.zeros((2 * n, 2))
    motion[:n, 0] = motion[n:, 1] = 1.0
    return np.block([[one, across], [across.T, one]]), np.append(gap, np.zeros(n)), motion, np.array([load, MU * load / 2])


def random_problem(chance, n, m):
    """A random definite F, and m modes that the pairs restrain in n directions (0, 1 or 3), as in tests/contact/random_friction.f90."""
    half, angle, at = chance.uniform(-1, 1, (2 * n, 2 * n + 1)), chance.uniform(0, 2 * np.pi, n), chance.uniform(-1, 1, (2, n))
    ways = np.concatenate([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]], axis=1)
    at, mu = np.tile(at, 2), chance.choice([0.1, 0.3, 0.6, 1.0])
    motion = {0: np.zeros((2 * n, 0)), 1: np.append(np.ones(n), chance.uniform(-1, 1, n))[:, None],
              3: np.column_stack([*ways, at[0] * ways[1] - at[1] * ways[0]])}[m]
    force = chance.uniform(0, 1, n)
    gap = np.append(0.3 * chance.uniform(0, 1, n), np.zeros(n)) + chance.uniform(-1, 1, 2 * n) - 0.5 * (m > 0)
    return half @ half.T, gap, motion, motion.T @ np.append(force, mu * force * chance.uniform(-1, 1, n)), np.full(n, mu)


def violation(flexibility, gap, mu, force):
    """Largest of |min(R, w/|F|)| and |T - (T - slip/|F|, within mu R)| over the largest force, with |F| the largest row sum; `gap`: with the rigid-body modes."""
    n = len(mu)
    w = (gap + flexibility @ force) / abs(flexibility).sum(axis=1).max()
    normal, bound = np.minimum(force[:n], w[:n]), mu * np.maximum(force[:n], 0)
    return float(max(abs(normal).max(), abs(force[n:] - np.clip(force[n:] - w[n:], -bound, bound)).max()) / abs(force).max())


def unknown_forces(closed, sign, mu):
    """Rows with unknown forces, and all forces of these."""
    n = len(mu)
    rows = np.flatnonzero(np.append(closed, closed & (sign == 0)))
    drive = np.eye(2 * n)
    drive[n:, :n] -= np.diag(mu * sign)
    return rows, drive[:, rows]


def augmented(flexibility, gap, mu):
    """Augmented Lagrangian: forces of the last step plus a penalty; each step ends when a semismooth Newton method no longer changes states."""
    n, stiff = len(mu), 100 / np.diag(flexibility).mean()

    def solve():
        force = np.zeros(2 * n)
        for _ in range(100):
            before, states = force.copy(), None
            for _ in range(100):
                trial = before - stiff * (gap + flexibility @ force)
                closed, bound = trial[:n] > 0, mu * np.maximum(trial[:n], 0)
                sign = np.where(closed & (abs(trial[n:]) > bound), -np.sign(trial[n:]), 0)
                if states is not None and (closed == states[0]).all() and (sign == states[1]).all():
                    break
                states = closed, sign
                rows, drive = unknown_forces(closed, sign, mu)
                matrix = flexibility[rows] @ drive
                matrix[np.diag_indices(len(rows))] += 1 / stiff
                force = drive @ np.linalg.solve(matrix, before[rows] / stiff - gap[rows])
            if violation(flexibility, gap, mu, force) <= TOLERANCE:
                return force
        raise RuntimeError("no answer")
    return solve


def lemke_of(flexibility, gap, mu):
    def solve():
        found = friction_states(flexibility, gap, np.arange(len(mu)), mu)
        if found is None:
            raise RuntimeError("ray")
        return forces_of(flexibility, gap, np.zeros((len(gap), 0)), np.zeros(0), mu, found)[0]
    return solve


def forces_of(flexibility, gap, motion, load, mu, states):
    """Forces and q of the states (open, sign of the slip)."""
    rows, drive = unknown_forces(~states[0], states[1], mu)
    m = motion.shape[1]
    matrix = np.block([[flexibility[rows] @ drive, -motion[rows]], [-motion.T @ drive, np.zeros((m, m))]])
    x = np.linalg.lstsq(matrix, -np.append(gap[rows], load), rcond=1e-14)[0]
    return drive @ x[:len(rows)], x[len(rows):]


class FrictionProblem(ctypes.Structure):
    _fields_ = [("dimension", ctypes.c_int), ("contacts", ctypes.c_int), ("matrix", ctypes.c_void_p), ("q", ctypes.c_void_p), ("mu", ctypes.c_void_p)]


class SolverOptions(ctypes.Structure):
    """Its first fields."""
    _fields_ = [("solver", ctypes.c_int), ("is_set", ctypes.c_bool), ("integers", ctypes.c_int), ("integer", ctypes.POINTER(ctypes.c_int)), ("reals", ctypes.c_int),
                ("real", ctypes.POINTER(ctypes.c_double))]


def siconos(number):
    """Solver of Siconos (Friction_cst.h) in units of the largest F and the largest gap; None if the library is missing."""
    try:
        library = ctypes.CDLL("libsiconos_numerics.so")
    except OSError:
        return None
    for name in ("NM_create_from_data", "solver_options_create"):
        getattr(library, name).restype = ctypes.c_void_p
    options = library.solver_options_create(number)
    options_of = ctypes.cast(options, ctypes.POINTER(SolverOptions)).contents
    options_of.integer[0], options_of.real[0] = 1000000, TOLERANCE / 10

    def prepare(flexibility, gap, mu):
        n, top, unit = len(mu), abs(flexibility).max(), abs(gap).max()
        order = np.arange(2 * n).reshape(2, n).T.ravel()   # normal and tangent of each pair
        matrix = np.asfortranarray(flexibility[np.ix_(order, order)] / top)
        q, reaction, velocity, mu = gap[order] / unit, np.zeros(2 * n), np.zeros(2 * n), np.array(mu)
        kept = matrix, q, mu, reaction, velocity   # as long as the library uses them
        address = [ctypes.c_void_p(part.ctypes.data) for part in kept]
        stored = library.NM_create_from_data(0, 2 * n, 2 * n, address[0])
        own = FrictionProblem(2, n, stored, address[1], address[2])

        def solve():
            kept[3][:] = kept[4][:] = 0.0
            info = library.fc2d_driver(ctypes.byref(own), address[3], address[4], ctypes.c_void_p(options))
            if info:
                raise RuntimeError(f"info {info}")
            force = np.empty(2 * n)
            force[order] = kept[3] * unit / top
            return force
        return solve
    return prepare


def timed(solve):
    """Its forces and processor time."""
    begun = time.process_time()
    found = solve()
    return found if isinstance(found, tuple) else (found, time.process_time() - begun)


def half_planes(program, place, repeats, limit, sizes):
    others = {"augmented Lagrangian": augmented, "Siconos NSGS": siconos(400), "Siconos CPG": siconos(402), "Siconos Lemke": siconos(404)}
    ours = {}
    for name in ("epcont", "fixed", "frictionless"):
        (place / name).mkdir()
        ours[name] = Epcont(program, place / name, "CONRY")
    for kind in KINDS:
        tried = {name: prepare for name, prepare in others.items() if prepare}
        for n in sizes:
            flexibility, gap, motion, load = problem(kind, n)
            mu = np.full(n, MU)
            solve = {"epcont": ours["epcont"].prepare(flexibility, gap, load, motion, mu)}
            solve["epcont"]()
            total = gap - motion @ ours["epcont"].approach
            solve |= {"fixed": ours["fixed"].prepare(flexibility, total, np.zeros(0), np.zeros((2 * n, 0)), mu),
                      "frictionless": ours["frictionless"].prepare(flexibility[:n, :n], gap[:n], load[0])}
            solve |= {name: prepare(flexibility, total, mu) for name, prepare in tried.items()}
            spent, worst, note = {name: [] for name in solve}, {}, {}
            for _ in range(repeats):
                for name in [name for name in solve if name not in note]:
                    try:
                        force, seconds = timed(solve[name])
                    except RuntimeError as error:
                        note[name] = str(error)
                        continue
                    spent[name].append(seconds)
                    if name != "frictionless":
                        worst[name] = max(worst.get(name, 0.0), violation(flexibility, total, mu, force))
            for name, seconds in spent.items():
                ratio = statistics.median(a / b for a, b in zip(seconds, spent["epcont"])) if seconds else None
                print(json.dumps({"problem": kind, "n": n, "program": name, "cpu": statistics.median(seconds) if seconds else None, "ratio": ratio,
                                  "violation": worst.get(name), "note": note.get(name, "")}), flush=True)
            tried = {name: prepare for name, prepare in tried.items() if name not in note and statistics.median(spent[name]) < limit}


def random_problems(program, place):
    """Answers of epcont and of Lemke's algorithm: how many are right, and how often both are the same."""
    ours, chance = Epcont(program, place, "CONRY", 1), np.random.default_rng(1)
    for n in RANDOM:
        for m in (0, 1, 3):
            count = dict.fromkeys(("epcont", "Lemke", "both", "same"), 0)
            for _ in range(EACH):
                flexibility, gap, motion, load, mu = random_problem(chance, n, m)
                soft = flexibility + motion @ motion.T / (WEAK / abs(flexibility).max())
                answers = {}
                try:
                    force, _ = ours.prepare(flexibility, gap, load, motion, mu)()
                    answers["epcont"] = force, ours.approach
                except Stalled:
                    pass
                states = friction_states(soft, gap - motion @ load / (WEAK / abs(flexibility).max()), np.arange(n), mu)
                if states:
                    answers["Lemke"] = forces_of(flexibility, gap, motion, load, mu, states)
                right = {name: force for name, (force, q) in answers.items() if violation(flexibility, gap - motion @ q, mu, force) < 1e-7 and
                         abs(motion.T @ force - load).max(initial=0.0) < 1e-7 * abs(force).max()}
                for name in right:
                    count[name] += 1
                if len(right) == 2:
                    count["both"] += 1
                    count["same"] += bool(abs(right["epcont"] - right["Lemke"]).max() < 1e-6 * abs(right["epcont"]).max())
            print(json.dumps({"problem": "random", "n": n, "modes": m, "number": EACH, **count}), flush=True)


def main():
    program, place, (repeats, limit, *sizes) = sys.argv[1], pathlib.Path(sys.argv[2]), map(int, sys.argv[3:])
    half_planes(program, place, repeats, limit, sizes)
    random_problems(program, place)


if __name__ == "__main__":
    main()
