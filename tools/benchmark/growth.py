"""Part 5: growth of time and memory of whole runs from 6 000 to 2 000 000 unknowns, with the number of pairs as the square root of the unknowns
and as a twentieth of them.

A row ends at a size that exceeds the limits according to `--plan`, or that is rejected.
"""
import re
import statistics
import sys

from process import peak, settled, timed
from scenes import many

SIZES = (6000, 20000, 63000, 200000, 630000, 2000000)
#: Required exponents.
TIME_POWER, MEMORY_POWER = 1.15, 1.05
#: Number of pairs for a number of unknowns.
KINDS = {"pairs as the square root": lambda unknowns: round(unknowns ** 0.5), "pairs a twentieth": lambda unknowns: unknowns // 20}
#: Limits of a run according to its plan: operations, MB; and with --quick.
MOST, MOST_QUICK = (3e12, 16000.0), (1.6e11, 4000.0)
SHORT, LONG = 5.0, 30.0


def forecast(program, deck, place):
    """Operations and MB by --plan; None if the deck is rejected."""
    status, _, _, out = timed([program, "--plan", deck], place)
    found = re.search(r"^  memory (\d+) MB.*, operations ([\d.E+]+)", out, re.MULTILINE)
    return None if status or not found else (float(found[2]), float(found[1]))


def size(program, place, unknowns, pairs, turns, most):
    """One row; None if the run is not possible."""
    deck = place / "growth.dat"
    deck.write_text(many.blocks(pairs, unknowns // 2, load=19000.0).text(), encoding="ascii")
    expected = forecast(program, deck.name, place)
    if expected is None or expected[0] > most[0] or expected[1] > most[1]:
        return None
    command = [program, "--memory", str(most[1] / 500), deck.name]
    status, memory, first, out = peak(command, place)
    if status:
        sys.exit(f"epcont: exit status {status}\n{out}")
    runs = [(settled if first < SHORT else timed)(command, place) for _ in range(turns if first < LONG else 1)]
    return {"unknowns": unknowns, "pairs": pairs, "cpu": statistics.median(run[1] for run in runs), "memory": memory,
            "operations": expected[0], "forecast_memory": expected[1]}


def growth(place, program, turns, quick, say):
    """Rows of each series, from the smallest to the largest possible size."""
    found = {}
    for kind, pairs in KINDS.items():
        found[kind] = []
        for unknowns in SIZES:
            row = size(str(program), place, unknowns, pairs(unknowns), turns, MOST_QUICK if quick else MOST)
            if row is None:
                say(f"{kind}: {unknowns} unknowns: beyond what a run may take")
                break
            say(f"{kind}: {row}")
            found[kind].append(row)
    return found
