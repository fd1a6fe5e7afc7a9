"""Flow theory in sequences of SUBCASEs: known answers, random histories by both programs, and tools/verify, which finds wrong cells."""
import contextlib
import csv
import io
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests" / "tools"), str(pathlib.Path(__file__).parent)]
import common  # noqa: E402
from compare import AGREE, COARSE, REFUSED, compare, run  # noqa: E402
from solve import solve  # noqa: E402
from write_random import write  # noqa: E402

PROGRAM = pathlib.Path(os.environ["EPCONT_PROGRAM"]).resolve()
verify = common.load("verify")
#: A bar of one element in plane stress, E = 210000, yield stress 240, tangent modulus 21000, with a stress of 300, -300, 300 and 0: strain at the end
#: of each SUBCASE, exact with any increments.
BAR = {1: (.004, .0011428571428571429, .004, .0025714285714285714), 2: (.004, -.004, .004, .0025714285714285714)}

#: A random model with friction that yields.
YIELDS = 1


def wrong_in(found, folder, case):
    worst, faults = compare(found, folder, "deck", case)
    return faults + [kind for kind, (value, _) in worst.items() if value > 1e-8]


def bar(hardening):
    text = (ROOT / "input/one_element/one_element_flow.dat").read_text()
    text = text.replace("LOAD = 1\nNLPARM = 1\n", "".join(f"SUBCASE {k}\nLOAD = {load}\nNLPARM = 1\n" for k, load in enumerate((1, 2, 1, 3), 1)))
    text = text.replace("NLPARM  1       100", "NLPARM,1,3\nLOAD,2,-1.,1.,1\nLOAD,3,0.,1.,1").replace("STRAIN\n", "STRESS\n")
    return text.replace("*       1               1  ", f"*       1               {hardening}  ")


class Histories(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def solved(self, text):
        deck = self.folder / "deck.dat"
        deck.write_text(text)
        subprocess.run([PROGRAM, deck, "-o", self.folder, "--tables", "all", "--quiet"], check=True, stderr=subprocess.DEVNULL)
        return deck

    def verified(self, deck):
        with contextlib.redirect_stdout(io.StringIO()):
            return verify.main([str(deck), str(self.folder), "--quiet"])

    def test_known_strains(self):
        for hardening, strains in BAR.items():
            deck = self.solved(bar(hardening))
            with open(self.folder / "deck.nodes.csv") as file:
                told = [float(row["ux"]) for row in csv.DictReader(file) if row["node"] == "3"]
            own = [next(row[3] for row in found["nodes"][1] if row[0] == 3) for _, found, _ in solve(deck)]
            for expected, one, other in zip(strains, own, told, strict=True):
                self.assertAlmostEqual(expected, one, delta=1e-12)
                self.assertAlmostEqual(expected, other, delta=1e-12)

    def test_random_histories(self):
        words = [(deck, *found) for deck in write(self.folder, 5, 18, histories=True) for found in run(PROGRAM, deck, 1e-8)]
        for deck, case, word, said in words:
            self.assertIn(word, (AGREE, REFUSED, COARSE), f"{deck.name} SUBCASE {case}: {said}")
        self.assertGreater(sum(word == AGREE for _, _, word, _ in words), 10)

    def test_random_friction(self):
        """Pairs stick, slip either way and open; bodies that friction alone restrains; elastic and yielding."""
        words = [(deck, *found) for deck in write(self.folder, 20, 1, friction=True) for found in run(PROGRAM, deck, 1e-8)]
        for deck, case, word, said in words:
            self.assertIn(word, (AGREE, REFUSED, COARSE), f"{deck.name} SUBCASE {case}: {said}")
        self.assertGreater(sum(word == AGREE for _, _, word, _ in words), 50)

    def test_friction_is_compared(self):
        """A wrong force, slip or state is found."""
        deck = self.solved(write(self.folder, 1, 1, friction=True)[0].read_text())
        number, found, _ = next(solve(deck))
        self.assertEqual([], wrong_in(found, self.folder, number))
        for row, column, value in ((0, 2, 0.1), (0, 5, 0.1), (0, 7, "open")):
            own = found["friction"][1][row][column]
            found["friction"][1][row][column] = value
            self.assertNotEqual([], wrong_in(found, self.folder, number), column)
            found["friction"][1][row][column] = own

    def test_deck_of_input(self):
        deck = self.solved((ROOT / "input/hertz/hertz330_unloaded.dat").read_text())
        self.assertEqual(0, self.verified(deck))

    def test_verify_finds_wrong_cells(self):
        self.check_wrong_cells(write(self.folder, 5, 18, histories=True)[4], ("elements", "sx"), ("increments", "max_pressure"), ("plastic", "accumulated"))

    def test_verify_finds_wrong_friction(self):
        """Of a model that yields: there verify needs the independent history."""
        self.check_wrong_cells(write(self.folder, YIELDS + 1, 1, friction=True)[YIELDS], ("friction", "friction_force"), ("friction", "slip"))

    def check_wrong_cells(self, deck, *cells):
        deck = self.solved(deck.read_text())
        self.assertEqual(0, self.verified(deck))
        for table, column in cells:
            path = self.folder / f"deck.{table}.csv"
            text = path.read_text()
            rows = list(csv.DictReader(text.splitlines()))
            last = [row for row in rows if row["subcase"] == rows[-1]["subcase"]]
            row = max(last, key=lambda row: abs(float(row[column])))
            row[column] = repr(float(row[column]) * (1 + 1e-5))
            path.write_text("\n".join([",".join(rows[0]), *(",".join(row.values()) for row in rows), ""]))
            self.assertEqual(1, self.verified(deck), f"{table} {column}")
            path.write_text(text)


if __name__ == "__main__":
    unittest.main()
