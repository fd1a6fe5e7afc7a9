#!/usr/bin/env python3
"""A sequence that is cut in two decks: the second continues from the saved end of the first (PARAM SAVE, RESTART).

Its results are those of the uninterrupted sequence, to the byte.
"""
import pathlib
import re
import subprocess
import tempfile
import unittest

from test_sequences import CASES, KINEMATIC, PROGRAM, blocks, hertz900, square, with_param

PATH = [(300.0, 0.0, 0.0), (0.0, 0.0, 0.0), (-300.0, 10.0, 50.0), (250.0, 0.0, 0.0)]


def cut(text, after):
    """Two decks, of the first load cases and of the others."""
    control, _, bulk = text.partition("BEGIN BULK\n")
    head, *cases = re.split(r"(?m)^(?=SUBCASE)", control)
    return (head + "".join(cases[:after]) + "BEGIN BULK\nPARAM,SAVE,YES\n" + bulk,
            "RESTART = first.restart\n" + head + "".join(cases[after:]) + "BEGIN BULK\n" + bulk)


def rows_of(table, case):
    """Head and rows of a load case in a file; without the column `subcase` of files of several load cases.

    Warnings are not compared: the summary counts those about other load cases of the deck, too.
    """
    head, *rows = (line for line in table.splitlines() if ",warnings," not in f",{line}")
    if not head.startswith("subcase,"):
        return [head, *rows]
    return [line.partition(",")[2] for line in (head, *rows) if line.partition(",")[0] in ("subcase", str(case))]


def section_of(listing, case):
    return re.search(rf"(?m)^SUBCASE {case}$.*?(?=^SUBCASE|^LOAD CASES)", listing, re.DOTALL)[0]


class Decks(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_deck(self, name, text, status=0, options=()):
        """Run a deck and return its output."""
        (self.folder / f"{name}.dat").write_text(text)
        done = subprocess.run([PROGRAM, *options, f"{name}.dat"], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual(status, done.returncode, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def read(self, name):
        return (self.folder / name).read_text()


class Continued(Decks):
    def check(self, text, after, many):
        """Tables, sections of the listing and files for ParaView of the load cases after the cut."""
        options = ["--tables", "all", "--vtk"]
        self.run_deck("whole", text, options=options)
        for name, part in zip(("first", "last"), cut(text, after)):
            self.run_deck(name, part, options=options)
        for case in range(after + 1, many + 1):
            several = after + 1 < many
            for table in self.folder.glob("whole.*.csv"):
                rows = rows_of(table.read_text(), case)
                if len(rows) > 1 and (several or table.name != "whole.cases.csv"):
                    self.assertEqual(rows, rows_of(self.read(table.name.replace("whole", "last")), case), table.name)
            for grid in self.folder.glob(f"whole.case{case}.*vtu"):
                name = grid.name.replace("whole", "last") if several else grid.name.replace(f"whole.case{case}", "last")
                self.assertEqual(grid.read_bytes(), (self.folder / name).read_bytes())
            if several:
                self.assertEqual(section_of(self.read("whole.lst"), case), section_of(self.read("last.lst"), case))
        self.assertIn(f"\n  starts from the end of SUBCASE {after} in first.restart\n", self.read("last.lst"))

    def test_square(self):
        for method in "NEWTON", "INISTR":
            self.check(with_param(square(PATH, [3, 4, 5, 6], KINEMATIC), f"METHOD,{method}"), 2, 4)

    def test_cylinders(self):
        """Triangles in contact. One load case comes before the cut, or one after it."""
        for after in 1, 2, 3:
            self.check(hertz900([1.0, 0.5, 0.2, 1.1], [4, 3, 5, 4]), after, 4)

    def test_blocks(self):
        """Temperatures, springs, equations, mass loads; contact is off in the fourth case."""
        for rule in "CONRY", "JOINED":
            for after in 1, 3, 4, 6:
                self.check(with_param(blocks(CASES), f"RULE,{rule}"), after, 7)

    def test_friction(self):
        """Where pairs stick and slip depends on the loads before, also without plastic strain. Contact is off in the fourth case."""
        for kind in "PLASTIC", None:
            for after in 2, 3, 4:
                text = blocks(CASES, kind).replace("BCONP,1,1,2\n", "BCONP,1,1,2,,,1\nBFRIC,1,,,.3\n")
                self.check(text, after, len(CASES))

    def test_increments_that_accuracy_chooses(self):
        text = hertz900([1.0, 0.3, 1.2], [1, 1, 1]).replace("NLPARM,1,1\n", "").replace("NLPARM = 1\n", "")
        self.check(with_param(text, "ACCURACY,.02"), 1, 3)


class Refused(Decks):
    """Exact messages."""

    def setUp(self):
        super().setUp()
        self.first, self.last = cut(square(PATH, [3, 4, 5, 6]), 2)
        self.run_deck("first", self.first)
        self.saved = (self.folder / "first.restart").read_bytes()

    def check(self, fault, remedy, text=None):
        said = self.run_deck("last", text or self.last, 2)
        self.assertIn(f"last.dat:1:11-23: RESTART: first.restart {fault}\n  RESTART = first.restart\n            ^^^^^^^^^^^^^ {remedy}\n", said)
        self.assertIn("last  rejected\n", said)
        self.assertFalse((self.folder / "last.lst").exists())

    def test_file(self):
        again = "run the deck that has saved it again"
        path = self.folder / "first.restart"
        for data, fault, remedy in (
                (b"", "is not a restart file", "give the DECK.restart that PARAM SAVE YES writes"),
                (self.first.encode(), "is not a restart file of this version of epcont", "give the DECK.restart that PARAM SAVE YES writes"),
                (self.saved[:-8], "is incomplete or damaged", again),
                (self.saved[:32], "is incomplete or damaged", again),
                (self.saved + self.saved, "is incomplete or damaged", again),
                (self.saved[:100] + bytes([self.saved[100] ^ 1]) + self.saved[101:], "is incomplete or damaged", again),
                (self.saved[:8] + self.saved[16:24] + self.saved[16:], "is not a restart file of this version of epcont",
                 "give the DECK.restart that PARAM SAVE YES writes")):
            path.write_bytes(data)
            self.check(fault, remedy)
        path.unlink()
        self.check("cannot be read", "give the DECK.restart that PARAM SAVE YES writes, relative to the folder of this deck")
        path.mkdir()
        self.check("cannot be read", "give the DECK.restart that PARAM SAVE YES writes, relative to the folder of this deck")

    def test_other_model(self):
        for what, old, new in (("GRIDs", "GRID,4,,0.,1.", "GRID,4,,0.,1.1"),
                               ("elements", "CQUAD4,1,1,1,2,3,4", "CQUAD4,1,1,2,3,4,1"),
                               ("properties or materials", "PSHELL,1,1,1.", "PSHELL,1,1,2."),
                               ("properties or materials", ",240.0", ",241.0"),
                               ("supports, SUPORT, RBE2, MPC or springs", "SPC1,1,2,2", "SPC1,1,12,2"),
                               ("GRAV or RFORCE", "ENDDATA", "GRAV,9,,1.,1.\nENDDATA")):
            self.assertIn(old, self.last)
            text = self.last.replace(old, new)
            if what[:4] == "GRAV":   # mass
                text = text.replace(",,0.3\n", ",,0.3,1.\n")
                self.run_deck("first", self.first.replace(",,0.3\n", ",,0.3,1.\n"))
            self.check(f"is the end of another model: {what} differ", f"use the same {what} in both decks", text)

    def test_relative_to_the_deck(self):
        (self.folder / "deeper").mkdir()
        self.run_deck("deeper/last", self.last.replace("first.restart", "'../first.restart'"))
        self.run_deck("deeper/last", self.last.replace("first.restart", str(self.folder / "first.restart")))

    def test_no_end(self):
        """A file of an earlier run goes, too."""
        not_reached = "first.restart: not written: the last load case did not reach its end, or nothing can yield or slip\n"
        limit = self.first.replace(",240.0", ",24.0").replace("23333.333333333332", "0.0")
        self.assertNotEqual(limit, self.first)
        self.assertIn(not_reached, self.run_deck("first", limit, 1))
        self.assertFalse((self.folder / "first.restart").exists())
        unused = self.first.replace("MATS1,1", "MATS1,2").replace("ENDDATA", "MAT1,2,1.,,.3\nENDDATA")
        self.assertIn(not_reached, self.run_deck("first", unused, 1))


if __name__ == "__main__":
    unittest.main()
