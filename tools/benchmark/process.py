"""Runs of whole programs: processor time, wall time, peak memory.

A short run is timed right after one of the same program that is not: what another program left in caches, and pages that
the host of a virtual machine took back after it (they cost more than clearing them does), are not its own.

Memory is that of a run under GNU time (wait4's ru_maxrss: of a child of this process it would be this process's own, if
that is larger). Processor time, user and system, is wait4's of a run of its own.
"""
import os
import subprocess
import time

ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1",
              "CCX_NPROC_STIFFNESS": "1", "CCX_NPROC_RESULTS": "1"}


def timed(command, place, threads=1):
    """(exit status, seconds of processor, seconds of wall, standard output)."""
    environment = {**ONE_THREAD, "OMP_NUM_THREADS": str(threads)}
    with open(place / "stdout", "w+", encoding="utf-8", errors="replace") as out:
        start = time.perf_counter()
        child = subprocess.Popen(command, cwd=place, env=environment, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.perf_counter() - start
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        return child.returncode, usage.ru_utime + usage.ru_stime, wall, out.read()


def settled(command, place, threads=1):
    """As `timed`, of a run that follows another of the same."""
    timed(command, place, threads)
    return timed(command, place, threads)


def peak(command, place, threads=1):
    """(exit status, peak memory in MB, seconds of processor, standard output)."""
    status, cpu, _, out = timed(["/usr/bin/time", "-q", "-f", "%M", "-o", "memory", *command], place, threads)
    return status, int((place / "memory").read_text().split()[-1]) / 1024, cpu, out
