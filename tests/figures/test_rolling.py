#!/usr/bin/env python3
"""A Hertz pressure that moves along a perfectly plastic half plane: it shakes down below p0 = 4 k, and not above."""
import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from scenes.plastic import rolling  # noqa: E402

PASSES = 7
#: k/G of the material.
ELASTIC = 200.0 / (210000.0 / 2.6)


def strains(ratio):
    """Largest plastic strain that each pass adds to an element, over k/G. The mesh is coarse."""
    deck = rolling(ratio, PASSES, n=3, step=3, length=6)
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "deck.dat"
        path.write_text(deck.text(), encoding="ascii")
        subprocess.run([os.environ["EPCONT_PROGRAM"], "--tables", "all", path.name], cwd=folder, check=True, capture_output=True, timeout=120)
        with open(path.with_suffix(".plastic.csv")) as file:
            rows = [(int(row["subcase"]), float(row["accumulated"])) for row in csv.DictReader(file)]
    cases = rows[-1][0] // PASSES
    passes = [[accumulated for case, accumulated in rows if case == turn * cases] for turn in range(1, PASSES + 1)]
    return [max(b - a for a, b in zip(before, after)) / ELASTIC for before, after in zip([[0.0] * len(passes[0]), *passes], passes)]


class Rolling(unittest.TestCase):

    def test_shakes_down(self):
        strain = strains(3.6)
        self.assertGreater(strain[0], 0.5)
        self.assertLess(strain[-1], 1e-4)

    def test_does_not_shake_down(self):
        strain = strains(4.4)
        self.assertGreater(strain[-1], 0.2)
        self.assertGreater(strain[-1], 0.98 * strain[-2])


if __name__ == "__main__":
    unittest.main()
