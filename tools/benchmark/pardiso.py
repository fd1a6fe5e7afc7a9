"""Order, factor and two solves by PARDISO (Intel's MKL), one thread, for a system written by bench_ours.

    python pardiso.py SYSTEM        prints processor seconds of ordering, factor, two solves, and the largest error

Medians of as many runs as fit into three tenths of a second, without the first of several.
"""
import statistics
import sys
import time

import numpy as np
import pypardiso
import scipy.sparse as sparse

LEAST_SECONDS, MOST_RUNS = 0.3, 50
POSITIVE_DEFINITE, ORDER, FACTOR, SOLVE = 2, 11, 22, 33


def read(path):
    """The upper triangle by rows (the file has the lower one; its entries are to be summed), and displacements."""
    with open(path, "rb") as file:
        n, entries = np.fromfile(file, np.int32, 5)[:2]
        row, column = np.fromfile(file, np.int32, entries) - 1, np.fromfile(file, np.int32, entries) - 1
        value = np.fromfile(file, np.float64, entries)
    with open(path, "rb") as file:
        file.seek(-8 * int(n), 2)
        displacement = np.fromfile(file, np.float64, n)
    matrix = sparse.coo_matrix((value, (column, row)), shape=(n, n)).tocsr()
    matrix.sum_duplicates()
    return matrix, displacement


def run(matrix, force):
    """Seconds of the three stages, and the last solution."""
    solver = pypardiso.PyPardisoSolver(mtype=POSITIVE_DEFINITE)
    seconds, found = [], None
    for phases in ((ORDER,), (FACTOR,), (SOLVE, SOLVE)):
        begun = time.process_time()
        for phase in phases:
            solver.set_phase(phase)
            found = solver._call_pardiso(matrix, force)
        seconds.append(time.process_time() - begun)
    solver.free_memory(everything=True)
    return seconds, found


def main():
    matrix, displacement = read(sys.argv[1])
    whole = matrix + sparse.triu(matrix, 1).T
    force = np.asfortranarray((whole @ displacement).reshape(-1, 1))
    runs, worst = [], 0.0
    while not runs or sum(map(sum, runs)) < LEAST_SECONDS and len(runs) < MOST_RUNS:
        seconds, found = run(matrix, force)
        runs.append(seconds)
        worst = max(worst, abs(found[:, 0] - displacement).max() / abs(displacement).max())
    runs = runs[1:] or runs
    print(*(statistics.median(values) for values in zip(*runs)), worst)


main()
