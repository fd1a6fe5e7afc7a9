#!/usr/bin/env python3
"""Flow theory: one load step is total theory, more steps converge to the known limit, and load cases are independent."""
import csv
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["EPCONT_PROGRAM"]
#: Decks of `input` that yield, with NEWTON.
DECKS = ["bar/bar", "cook/cook", "hertz/hertz330", "hertz/hertz44", "hertz/hertz900", "insert_joint/insert_joint", "joint_lines/joint_lines",
         "one_element/one_element", "tube/tube12", "tube/tube16", "tube/tube_cquad4", "tube/tube_ctria6", "tube/tube_hardening",
         "tube/tube_near_incompressible"]
#: Load steps of hertz900: largest pressure, and the approach (an independent program).
HERTZ900 = {1: (199.112, -.00141228), 2: (198.026, -.00141204), 5: (195.518, -.00140948), 10: (194.341, -.00140762), 20: (193.662, -.00140642),
            40: (193.320, -.00140571)}


def solve(text, folder, *options):
    """All tables of a deck: {name of the table: rows}; and the summary."""
    deck = pathlib.Path(folder) / "deck.dat"
    deck.write_text(text)
    run = subprocess.run([PROGRAM, *options, deck.name], cwd=folder, capture_output=True, text=True, timeout=120)
    if run.returncode != 0:
        raise AssertionError(run.stdout + run.stderr)
    tables = {}
    for path in sorted(deck.parent.glob("deck.*.csv")):
        with open(path) as file:
            tables[path.name] = list(csv.reader(line for line in file if not line.startswith("#")))
    return tables, {row[0]: row[1] for row in tables["deck.summary.csv"]}


def with_steps(text, steps, *cards):
    """A deck with this number of load steps of flow theory."""
    control, _, bulk = text.partition("BEGIN BULK\n")
    return control + "NLPARM = 77\nBEGIN BULK\n" + "\n".join([f"NLPARM,77,{steps}", "PARAM,THEORY,FLOW", *cards, bulk])


class FlowTheory(unittest.TestCase):

    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def assert_same(self, expected, found, place):
        """Numbers agree to 1e-9 of the largest in their column, all else exactly."""
        self.assertEqual(len(expected), len(found), place)
        for column in range(len(expected[0])):
            a, b = ([row[column] for row in rows] for rows in (expected, found))
            try:
                a, b = [float(x) for x in a[1:]], [float(x) for x in b[1:]]
            except ValueError:
                self.assertEqual(a, b, place)
                continue
            largest = max(map(abs, a), default=0.)
            for x, y in zip(a, b):
                self.assertLessEqual(abs(x - y), 1e-9 * largest, f"{place}, {expected[0][column]}")

    def test_one_load_step_is_total_theory(self):
        for deck in DECKS:
            text = re.sub(r"PARAM[ ,]+METHOD.*\n", "", (ROOT / "input" / f"{deck}.dat").read_text())
            expected, found = solve(text, self.folder, "--tables", "all")[0], solve(with_steps(text, 1), self.folder, "--tables", "all")[0]
            self.assertEqual(expected.keys() | {"deck.increments.csv", "deck.plastic.csv"}, found.keys())
            for name in expected:
                if name not in ("deck.summary.csv", "deck.history.csv"):   # their words and rounding errors
                    self.assert_same(expected[name], found[name], f"{deck}: {name}")

    def test_nonlinear_elastic_material_in_increments(self):
        """Its energy is not quadratic: the trapezoidal rule of the certificate does not apply."""
        text = re.sub(r"PARAM[ ,]+(METHOD|TOL).*\n", "", (ROOT / "input/hertz/hertz44.dat").read_text()).replace("PLASTIC", "NLELAST")
        expected, found = solve(text, self.folder)[1], solve(with_steps(text, 3), self.folder)[1]
        self.assertAlmostEqual(float(expected["max_pressure"]), float(found["max_pressure"]), delta=1e-6)

    def test_more_load_steps(self):
        text = (ROOT / "input/hertz/hertz900.dat").read_text()
        for steps, (pressure, approach) in HERTZ900.items():
            summary = solve(with_steps(text, steps), self.folder)[1]
            self.assertAlmostEqual(pressure, float(summary["max_pressure"]), delta=6e-4)
            self.assertAlmostEqual(approach, float(summary["approach_865_2"]), delta=6e-9)


if __name__ == "__main__":
    unittest.main()
