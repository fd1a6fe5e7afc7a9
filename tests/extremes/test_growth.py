"""Cost of a stack of bodies grows linearly: with four times as many bodies each stage takes about four times as long, not sixteen."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from scene import PROGRAM

DECKS = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])/"tools"/"decks"
#: Stages that run for each body or contact of lines (contact itself is solved for all of them at once).
STAGES = ("model", "plan", "numbering", "flexibility", "stresses", "accuracy")


def seconds(bodies, directory):
    """Processor time of all these stages; the shortest of three runs."""
    deck = pathlib.Path(directory)/f"stack{bodies}.dat"
    subprocess.run([sys.executable, DECKS, "stack", "--bodies", str(bodies), "--across", "6", "--rows", "6", "-o", deck],
                   check=True, stdout=subprocess.DEVNULL)
    turns = []
    for _ in range(3):
        run = subprocess.run([PROGRAM, deck, "-o", directory, "--timing", "--quiet"], capture_output=True, text=True,
                             timeout=200, env={**os.environ, "OMP_NUM_THREADS": "1"}, check=True)
        stages = dict(re.findall(r": (\w+) +[\d.]+ +([\d.]+)$", run.stderr, re.MULTILINE))
        turns.append(sum(float(stages[stage]) for stage in STAGES))
    return min(turns)


class Growth(unittest.TestCase):
    def test_stack(self):
        with tempfile.TemporaryDirectory() as directory:
            few, many = (seconds(bodies, directory) for bodies in (250, 1000))
        self.assertLess(many, 7*few, f"{few} s, {many} s")


if __name__ == "__main__":
    unittest.main()
