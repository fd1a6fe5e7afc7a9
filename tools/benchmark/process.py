"""Run whole programs: processor time, wall time, peak memory.

A short run is timed directly after an untimed run of the same program, so that it does not pay for caches filled by another program, or
for pages that the host of a virtual machine has taken back (they cost more than clearing).

Memory is that of a run under GNU time: wait4's ru_maxrss of a child is at least the size of this process. Processor time (user and
system) is wait4's, of a separate run.
"""
import os
import subprocess
import time

ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "CCX_NPROC_EQUATION_SOLVER": "1",
              "CCX_NPROC_STIFFNESS": "1", "CCX_NPROC_RESULTS": "1"}


def timed(command, place, threads=1):
    """(exit status, processor seconds, wall seconds, standard output)."""
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
    """As `timed`, after an untimed run of the same command."""
    timed(command, place, threads)
    return timed(command, place, threads)


def peak(command, place, threads=1):
    """(exit status, peak memory in MB, processor seconds, standard output)."""
    status, cpu, _, out = timed(["/usr/bin/time", "-q", "-f", "%M", "-o", "memory", *command], place, threads)
    return status, int((place / "memory").read_text().split()[-1]) / 1024, cpu, out
