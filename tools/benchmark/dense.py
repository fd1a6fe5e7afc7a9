"""The dense contact problem of parts 2 and 7: half-plane, and epcont's solver in a process of its own (contact.f90)."""
import subprocess
import sys

import numpy as np

from process import ONE_THREAD

MODULUS, TOLERANCE = 20400.0 / (2 * (1 - 0.29 ** 2)), 1e-9


def half_plane(n, depth=0.0):
    """n strips on (-1, 1): displacement of their centres, `depth` strips below the surface (this smooths), zero at a distance of four half-lengths."""
    h = 2.0 / n
    d = h * abs(np.subtract.outer(np.arange(n), np.arange(n)))
    if depth:
        mean = np.log(np.hypot(d, depth * h))
    else:
        mean = ((d + h / 2) * np.log(d + h / 2) - (d - h / 2) * np.log(abs(d - h / 2))) / h - 1
    return np.ascontiguousarray(2 / (np.pi * MODULUS) * (np.log(4.0) - mean))


class Stalled(RuntimeError):
    """Result of a run that gave no answer after these seconds."""

    def __init__(self, seconds, pivots):
        super().__init__(f"stalled after {pivots} pivots")
        self.seconds = seconds


class Epcont:
    """Run bench_contact with one rule; with DGEMM, one product of matrices. `repeats`: of the solve; as many as the size asks for if absent."""

    def __init__(self, program, place, rule, repeats=None):
        self.program, self.place, self.rule, self.repeats = program, place, rule, repeats

    def prepare(self, flexibility, gap, load, motion=None, mu=()):
        """`motion`: rigid-body modes, one of ones if absent; `mu`: of the pairs, whose tangential rows follow them."""
        n = len(gap)
        motion = np.ones((n, 1)) if motion is None else motion
        with open(self.place / "problem", "wb") as file:
            np.array([n, motion.shape[1], len(mu)], np.int32).tofile(file)
            for part in (flexibility.T, motion.T, gap, np.atleast_1d(load), np.array(mu, float)):
                np.ascontiguousarray(part).tofile(file)
        command = [self.program, "problem", "forces", self.rule, str(self.repeats or (3 if n > 200 else 50))]

        def solve():
            run = subprocess.run(command, cwd=self.place, env=ONE_THREAD, capture_output=True, text=True, check=False)
            if run.returncode:
                sys.exit(run.stdout + run.stderr)
            seconds, *rest = run.stdout.split()
            if not rest:
                return None, float(seconds)
            _, pivots, state = rest
            if state != "0":
                raise Stalled(float(seconds), pivots)
            found = np.fromfile(self.place / "forces")
            self.approach = found[n:]
            return found[:n], float(seconds)
        return solve
