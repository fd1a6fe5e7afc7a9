#!/usr/bin/env python3
"""The listing reports the attempts, if there was more than one, and their reasons."""
import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parent.parent.parent


def attempts(deck, *cards):
    """The line of the listing about attempts, with some cards added to the deck; empty if there was only one."""
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder) / "deck.dat"
        copy.write_text((SOURCE / deck).read_text().replace("BEGIN BULK\n", "\n".join(["BEGIN BULK", *cards, ""]), 1))
        subprocess.run([os.environ["EPCONT_PROGRAM"], "--quiet", copy, "-o", folder], capture_output=True, check=False)
        listing, = pathlib.Path(folder).glob("*.lst")
        return [line.strip() for line in listing.read_text().splitlines() if line.startswith("  attempts: ")]


class Attempts(unittest.TestCase):

    def test_one_attempt_is_not_reported(self):
        self.assertEqual(attempts("input/hertz/hertz44.dat"), [])

    def test_nodes_that_came_near(self):
        self.assertEqual(attempts("tests/found/bar_across_a_vee.bdf"),
                         ["attempts: (1) CONRY: nodes without a pair came near; (2) more pairs: valid"])

    def test_other_rule(self):
        self.assertEqual(attempts("tests/found/g10_6.bdf", "PARAM,RULE,JOINED"),
                         ["attempts: (1) JOINED: no active set found; (2) CONRY: valid"])

    def test_refinement(self):
        self.assertEqual(attempts("tests/found/oblique150x1.bdf"),
                         ["attempts: (1) CONRY: residuals, or digits lost; (2) 2 steps of refinement: valid"])

    def test_more_load_steps(self):
        self.assertEqual(attempts("tests/found/changes_that_stay.dat"),
                         ["attempts: (1) CONRY: not converged; (2) 5 load steps: ill-conditioned"])

    def test_each_load_case_has_its_own(self):
        self.assertEqual(attempts("tests/found/cases_that_come_near.bdf"),
                         ["attempts: (1) CONRY: nodes without a pair came near; (2) more pairs: valid"])


if __name__ == "__main__":
    unittest.main()
