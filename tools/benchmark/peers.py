"""Part 5: order, factor and two solves compared with PARDISO (MKL) and CHOLMOD on the same systems."""
import os
import pathlib
import statistics
import subprocess
import sys

from process import ONE_THREAD
from solve_part import bare, deck_of, ours

HERE = pathlib.Path(__file__).resolve().parent
NODES = (42000, 170000)
#: Largest ratio of our time to theirs.
WANTED = 0.5
#: CHOLMOD's best methods, by their names in bench_bare; without F, which takes minutes there.
WAYS = tuple(f"CHOLMOD supernodal, {ordering}, forward" for ordering in ("AMD", "METIS", "NESDIS"))
#: Allowed difference of the displacements: PARDISO refines its solution, and errors grow with the condition.
SAME = 1e-6


def pardiso(system):
    """Processor seconds; None if MKL is not available."""
    run = subprocess.run([sys.executable, HERE / "pardiso.py", system], env={**os.environ, **ONE_THREAD, "MKL_NUM_THREADS": "1"},
                         capture_output=True, text=True, check=False)
    if run.returncode:
        return None
    *seconds, error = map(float, run.stdout.split())
    if not error < SAME:
        sys.exit(f"pardiso: displacements off by {error}")
    return sum(seconds)


def mine(release, deck, *system):
    """Seconds of whole solves: of the loads, and of the loads with contact."""
    found = ours(release, deck, *system)
    return found["equations"], sum(found[what] for what in ("ordering", "factor", "load_gap", "displacements"))


def theirs(release, system, say):
    """Seconds of each program."""
    found = {name: seconds["ordering"] + seconds["factor"] + 2 * seconds["displacements"]
             for name, seconds in bare(release, system, ("--solves", *WAYS)).items()}
    by_mkl = pardiso(system)
    if by_mkl is None:
        say("PARDISO is not there: pip install pypardiso")
    else:
        found["PARDISO"] = by_mkl
    return found


def one(release, place, nodes, turns, say):
    deck, system = deck_of(place, nodes), place / "system"
    equations, _ = mine(release, deck, system)
    runs = [(mine(release, deck)[1], theirs(release, system, say)) for _ in range(turns)]
    system.unlink()
    row = {"equations": int(equations), "ours": statistics.median(run[0] for run in runs), "wanted": WANTED,
           "theirs": {name: {"seconds": statistics.median(run[1][name] for run in runs),
                             "ratio": statistics.median(run[0] / run[1][name] for run in runs)} for name in runs[0][1]}}
    say(f"{row}")
    return row


def peers(release, place, turns, quick, say):
    return [one(release, place, nodes, turns, say) for nodes in (NODES[:1] if quick else NODES)]
