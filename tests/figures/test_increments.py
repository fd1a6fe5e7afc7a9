#!/usr/bin/env python3
"""Increments of flow theory: their table, their stated error, and contact that is lost while the loads go down."""
import csv
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["EPCONT_PROGRAM"]
#: Limit of ever smaller increments of hertz900 at full load (an independent program).
LIMIT = {"max_pressure": 192.98, "approach_865_2": -0.0014050}


def run(cases, cards, errors=False):
    """hertz900 with these SUBCASEs: {table: rows}, standard output or errors, exit status."""
    head, _, bulk = (ROOT / "input/hertz/hertz900.dat").read_text().partition("BEGIN BULK\n")
    with tempfile.TemporaryDirectory() as folder:
        deck = pathlib.Path(folder) / "deck.dat"
        deck.write_text(head.replace("LOAD = 1\n", "") + cases + "BEGIN BULK\n" + cards + bulk)
        done = subprocess.run([PROGRAM, deck.name], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
        tables = {}
        for path in deck.parent.glob("deck.*.csv"):
            with open(path) as file:
                tables[path.name.split(".")[1]] = list(csv.DictReader(line for line in file if not line.startswith("#")))
        return tables, done.stderr if errors else done.stdout, done.returncode


class Increments(unittest.TestCase):

    def test_stated_error_covers_the_true_one(self):
        for many in 1, 2, 5, 10, 20, 40:
            tables, _, status = run("LOAD = 1\nNLPARM = 1\n", f"PARAM,THEORY,FLOW\nNLPARM,1,{many}\n")
            self.assertEqual(0, status)
            summary = {row["key"]: float(row["value"]) for row in tables["summary"] if row["key"].removeprefix("increment_error_") in LIMIT}
            for key, limit in LIMIT.items():
                error, stated = abs(summary[key] - limit), summary["increment_error_" + key]
                self.assertLessEqual(error, stated, f"{key}, {many}")
                self.assertLessEqual(stated, 6 * error, f"{key}, {many}")
            self.assertEqual([(k + 1) / many for k in range(many)], [float(row["load_factor"]) for row in tables["increments"]])

    def test_accuracy_chooses_their_number(self):
        """PARAM ACCURACY doubles the increments until the stated error is within it, unless NINC says their number."""
        for wanted, many in (0.02, 16), (0.005, 64):
            tables, _, status = run("LOAD = 1\n", f"PARAM,THEORY,FLOW\nPARAM,ACCURACY,{wanted}\n")
            self.assertEqual(0, status)
            summary = {row["key"]: row["value"] for row in tables["summary"]}
            self.assertLessEqual(float(summary["increment_error_max_pressure"]), wanted * float(summary["max_pressure"]))
            self.assertEqual(many, len(tables["increments"]))
        tables = run("LOAD = 1\nNLPARM = 1\n", "PARAM,THEORY,FLOW\nPARAM,ACCURACY,.005\nNLPARM,1,3\n")[0]
        self.assertEqual(3, len(tables["increments"]))

    def test_contact_is_lost(self):
        """Up to P, then to -P/10: contact is lost where the load changes its sign, at 1/1.1 of the second SUBCASE."""
        tables, said, status = run("SUBCASE 1\nLOAD = 1\nNLPARM = 1\nSUBCASE 2\nLOAD = 2\nNLPARM = 1\nSUBCASE 3\nLOAD = 1\n",
                                   "NLPARM,1,10\nFORCE,2,865,,.5,0.,1.,0.\n")
        self.assertEqual(1, status)   # since SUBCASE 3 is not solved
        self.assertEqual(["valid", "contact lost", "not solved"], [row["status"] for row in tables["cases"]])
        second = [row for row in tables["increments"] if row["subcase"] == "2"]
        self.assertLess(float(second[-1]["load_factor"]), 1 / 1.1)
        self.assertGreater(float(second[-1]["load_factor"]), 1 / 1.1 - 1 / 640)
        self.assertIn("SUBCASE 2  contact lost after load factor 0.90", said)
        self.assertIn("SUBCASE 3  not solved", said)

    def test_no_increment_converges(self):
        """The results are those at the end of the SUBCASE before; those of the next one do not exist."""
        tables, said, status = run("SUBCASE 1\nLOAD = 1\nNLPARM = 1\nSUBCASE 2\nLOAD = 2\nNLPARM = 2\nSUBCASE 3\nLOAD = 1\n",
                                   "NLPARM,1,4\nNLPARM,2,4,,,,1\nLOAD,2,1.,1.5,1\n")
        self.assertEqual(1, status)
        self.assertEqual(["valid", "not converged", "not solved"], [row["status"] for row in tables["cases"]])
        one, two = ([(row["force"], row["pressure"], row["gap"]) for row in tables["contact"] if row["subcase"] == case] for case in "12")
        self.assertEqual(one, two)
        self.assertEqual({"1"}, {row["subcase"] for row in tables["increments"]})
        third = tables["cases"][2]
        self.assertEqual({"3", "not solved", ""}, set(third.values()))
        self.assertEqual([("3", "status", "not solved"), ("3", "warnings", "0"), ("3", "notes", "0")],
                         [(row["subcase"], row["key"], row["value"]) for row in tables["summary"] if row["subcase"] == "3"])
        self.assertIn("SUBCASE 2  not converged  p_max", said)

    def test_what_to_do(self):
        """Limits of iterations, and INISTR with little hardening; INISTR needs many iterations after yielding."""
        for method, remedy in ("NEWTON", "use more load steps (NLPARM)"), ("INISTR", "use METHOD NEWTON"):
            _, said, status = run("LOAD = 1\nNLPARM = 1\n", f"PARAM,THEORY,FLOW\nPARAM,METHOD,{method}\nNLPARM,1,1,,,,2\n", errors=True)
            self.assertEqual(1, status)
            self.assertIn(f"of the largest (increase PARAM MAXIT, or {remedy})", said)


if __name__ == "__main__":
    unittest.main()
