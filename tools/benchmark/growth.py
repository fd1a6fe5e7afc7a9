"""Part 5: how time and memory of whole runs grow from 6 000 to 2 000 000 unknowns, with pairs as the square root of the unknowns and as
their twentieth part.

A size that `--plan` forecasts more for than a run may take ends its row; so does one that is refused.
"""
import re
import statistics
import sys

from process import peak, settled, timed
from scenes import many

SIZES = (6000, 20000, 63000, 200000, 630000, 2000000)
#: What is wanted of the powers.
TIME_POWER, MEMORY_POWER = 1.15, 1.05
#: Pairs for so many unknowns.
KINDS = {"pairs as the square root": lambda unknowns: round(unknowns ** 0.5), "pairs a twentieth": lambda unknowns: unknowns // 20}
#: What a run may take by its plan: operations, MB; and with --quick.
MOST, MOST_QUICK = (3e12, 16000.0), (1.6e11, 4000.0)
SHORT, LONG = 5.0, 30.0


def forecast(program, deck, place):
    """Operations and MB by --plan; None where the deck is refused."""
    status, _, _, out = timed([program, "--plan", deck], place)
    found = re.search(r"^  memory (\d+) MB.*, operations ([\d.E+]+)", out, re.MULTILINE)
    return None if status or not found else (float(found[2]), float(found[1]))


def size(program, place, unknowns, pairs, turns, most):
    """A row; None where there is none."""
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
    """Rows of each kind, from the smallest size to the largest that can be had."""
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
