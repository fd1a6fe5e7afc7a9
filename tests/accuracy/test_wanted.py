"""PARAM ACCURACY: its choices, the accuracy reached, and its messages."""
import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.environ["EPCONT_PROGRAM"]
INPUT = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"]) / "input"
sys.path.insert(0, str(INPUT.parent / "tools"))
from scenes import many  # noqa: E402


class Wanted(unittest.TestCase):
    def run_deck(self, name, *parameters, **more):
        return self.run_text((INPUT / f"{name}.dat").read_text(), *parameters, **more)

    def run_text(self, text, *parameters, left_out="none"):
        """The run, the listing and the contact pressures of a deck with further PARAMs and one removed."""
        names = [parameter.split(",")[0] for parameter in parameters] + [left_out]
        text = "".join(line for line in text.splitlines(True) if not re.match(rf"PARAM +({'|'.join(names)}) ", line))
        text = text.replace("BEGIN BULK\n", "BEGIN BULK\n" + "".join(f"PARAM,{parameter}\n" for parameter in parameters), 1)
        with tempfile.TemporaryDirectory() as directory:
            where = pathlib.Path(directory)
            (where / "deck.dat").write_text(text)
            run = subprocess.run([PROGRAM, where / "deck.dat", "-o", where], capture_output=True, text=True)
            listing = where / "deck.lst"
            table = where / "deck.contact.csv"
            rows = csv.DictReader(table.read_text().splitlines() if table.exists() else [])
            pressures = [float(row["pressure"] or 0) for row in rows]
            return run, listing.read_text() if listing.exists() else "", pressures

    def difference(self, some, others):
        return max(abs(a - b) for a, b in zip(some, others, strict=True)) / max(others)

    def test_twelve_modes_have_an_error(self):
        """The upper six of 14 bodies that rise and rotate, which have the largest modes; equal for both contact solvers."""
        found = {}
        for rule in ("CONRY", "JOINED"):
            run, listing, _ = self.run_text(many.stack(15, 6, 4).text(), f"RULE,{rule}")
            self.assertEqual(0, run.returncode)
            found[rule] = dict(re.findall(r"^ *mesh: approach of GRID (\d+) direction 2 +(\S+)", listing, re.MULTILINE))
        self.assertEqual([str(100 * body + end) for body in range(9, 15) for end in (29, 35)], list(found["CONRY"]))
        self.assertEqual(found["CONRY"], found["JOINED"])

    def test_faults(self):
        for value in ("0.0", "1.0", "-0.1"):
            run, _, _ = self.run_deck("hertz/hertz44", f"ACCURACY,{value}")
            self.assertEqual(2, run.returncode)
            self.assertIn("PARAM ACCURACY: field 3 (VALUE) is out of range\n", run.stderr)
            self.assertIn(" a real above 0.0 to below 1.000\n", run.stderr)

    def test_choices_of_accuracy(self):
        chosen = "  ACCURACY {}\n".format
        cases = [("hertz/hertz330_elastic", ["ACCURACY,0.1"], "0.1000 chooses nothing: no iteration, or TOL and METHOD are in the deck"),
                 ("hertz/hertz330", ["ACCURACY,0.1"], "0.1000 chooses TOL 0.01000, METHOD NEWTON"),
                 ("hertz/hertz330", ["ACCURACY,0.01"], "0.01000 chooses TOL 0.001000, METHOD NEWTON"),
                 ("hertz/hertz330", ["ACCURACY,0.03", "METHOD,SECANT"], "0.03000 chooses TOL 6.000E-05"),
                 ("hertz/hertz330", ["ACCURACY,0.03", "METHOD,SECANT", "TOL,0.01"],
                  "0.03000 chooses nothing: no iteration, or TOL and METHOD are in the deck")]
        for deck, parameters, words in cases:
            with self.subTest(words):
                run, listing, _ = self.run_deck(deck, *parameters)
                self.assertEqual(0, run.returncode)
                self.assertIn(chosen(words), listing)

    def test_solution_is_ten_times_as_exact_as_wanted(self):
        for deck in ("hertz/hertz44", "hertz/hertz330", "insert_joint/insert_joint"):
            _, _, exact = self.run_deck(deck, "METHOD,NEWTON", "TOL,1.E-10")
            for parameters in (["METHOD,AUTO"], ["METHOD,SECANT"], ["METHOD,INISTR"]):
                for wanted in (0.1, 0.02, 0.003):
                    with self.subTest(deck=deck, method=parameters, wanted=wanted):
                        run, _, pressures = self.run_deck(deck, f"ACCURACY,{wanted}", *parameters, left_out="TOL")
                        self.assertEqual(0, run.returncode)
                        self.assertLess(self.difference(pressures, exact), 0.1*wanted)

    def test_words_about_the_mesh(self):
        wanted = "  wanted error of contact pressures {}\n".format
        _, listing, _ = self.run_deck("hertz/hertz330_elastic", "ACCURACY,0.5")
        self.assertIn(wanted("                 0.5000"), listing)
        self.assertRegex(listing, r"\n    reached: the estimated mesh error is \d\.\dE-\d\d\n")
        _, listing, _ = self.run_deck("hertz/hertz330_elastic", "ACCURACY,0.001")
        self.assertRegex(listing, r"\n  refine elements \d+")
        self.assertRegex(listing, r"\n    not reached: the estimated mesh error is \d\.\dE-\d\d\n")
        _, listing, _ = self.run_deck("flat_punch/flat_punch", "ACCURACY,0.01")
        self.assertIn("\n    not possible: the largest pressure is singular\n", listing)
        _, listing, _ = self.run_deck("tube/tube16", "ACCURACY,0.01")
        self.assertIn("\n    unknown: no pair has a pressure\n", listing)
        _, listing, _ = self.run_deck("hertz/hertz330_elastic", "UNITS,KGF-MM")
        self.assertNotIn("wanted error", listing)


if __name__ == "__main__":
    unittest.main()
