"""tools/verify: each single edit of a table is found, or its column is named as not read."""
import contextlib
import csv
import io
import os
import pathlib
import random
import re
import shutil
import subprocess
import unittest

import common
from common import ROOT

PROGRAM = str(pathlib.Path(os.environ["EPCONT_PROGRAM"]).resolve())
verify = common.load("verify")
HERTZ, LINES, RING = (ROOT / "input" / name for name in ("hertz/hertz44.dat", "flat_match/flat_lines.dat", "from_gmsh/press_fit.dat"))
TABLES = ("summary", "nodes", "elements", "contact", "zones", "bodies", "history")
WORDS = {"touching": "open", "open": "touching", "plastic": "elastic", "elastic": "plastic"}
#: Smallest value, relative to the largest of a column, that is not rounding.
SEEN = 1e-9


def changed(value):
    """A value with a relative change of 1e-6, or another word; None for an empty cell and zero."""
    try:
        number = float(value)
    except ValueError:
        return WORDS.get(value, value and "x" + value[1:])
    if value.lstrip("-").isdigit():
        return str(int(value) + 1)
    return repr(number * (1 + 1e-6)) if number else ""


def size(value):
    try:
        return abs(float(value))
    except ValueError:
        return 0.0


class Case(common.Case):
    def solved(self, deck):
        subprocess.run([PROGRAM, deck, "-o", self.place, "--tables", "all", "--quiet"], check=True, stderr=subprocess.DEVNULL)

    def told(self, deck, *options):
        """Exit status and output."""
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            status = verify.main([str(deck), str(self.place), *options])
        return status, output.getvalue()

    def path(self, deck, table):
        return self.place / f"{deck.stem}.{table}.csv"

    def rows(self, deck, table):
        return list(csv.reader(self.path(deck, table).read_text().splitlines()))

    def spoilt(self, deck, table, rows):
        """Result of a run with these rows of a table; the table is restored."""
        path = self.path(deck, table)
        whole = path.read_text()
        path.write_text("".join(",".join(row) + "\n" for row in rows))
        try:
            return self.told(deck)
        finally:
            path.write_text(whole)


class Edits(Case):
    def edits(self, deck, table, rng, several):
        """(row, column) of some cells of each column: the largest, and others above rounding."""
        rows = self.rows(deck, table)
        for column in range(len(rows[0])):
            cells = [k for k in range(1, len(rows)) if changed(rows[k][column])]
            if table != "summary":
                largest = max((size(rows[k][column]) for k in cells), default=0.0)
                cells = [k for k in cells if size(rows[k][column]) >= SEEN * largest]
                first = max(cells, key=lambda k: size(rows[k][column]), default=None)
                cells = ([first] if cells else []) + rng.sample(cells, min(several, len(cells)))
            yield from ((k, column) for k in cells)

    def check(self, deck, several, *more):
        self.solved(deck)
        status, text = self.told(deck)
        self.assertEqual(0, status, text)
        unread = [line.partition(": ")[2] for line in text.splitlines() if line.startswith(("not read", "held to"))]
        rng, found, named = random.Random(5), 0, 0
        for table in (*TABLES, *more):
            for k, column in self.edits(deck, table, rng, several):
                rows = self.rows(deck, table)
                name = rows[k][0] if table == "summary" else rows[0][column]
                old, rows[k][column] = rows[k][column], changed(rows[k][column])
                status, text = self.spoilt(deck, table, rows)
                words = f"{deck.name} {table}, row {rows[k][0]}, {rows[0][column]}: {old} -> {rows[k][column]}\n{text}"
                self.assertNotIn("Traceback", text, words)
                if status == 0:
                    last = name not in ("pairs_in_contact", "plastic_elements", "load_factor") or table != "history" or k < len(rows) - 1
                    self.assertTrue(last and any(name in line for line in unread), words)
                found, named = found + (status != 0), named + (status == 0)
        self.assertGreater(found, 2 * named)

    def test_pairs_beyond_yield(self):
        self.check(HERTZ, 2)

    def test_load_cases(self):
        """Each is compared with its own rows, with its sets, supports and contacts."""
        cards = HERTZ.read_text().split("BEGIN BULK")[1]
        held = "".join(line.replace("SPC1    1", "SPC1    2") + "\n" for line in cards.splitlines() if line.startswith("SPC1"))
        deck = self.place / "cases.dat"
        deck.write_text("SPC = 1\nSUBCASE 7\nLOAD = 11\nSUBCASE 3\nLOAD = 12\nSUBCASE 5\nSPC = 2\nLOAD = 50\nBCONTACT = NONE\nBEGIN BULK\n"
                        "LOAD,11,2.0,0.3,1\nLOAD,12,1.0,0.5,1,0.25,1\nSPCD,50,41,2,-1.-4\nSPC,2,41,2,0.0" + cards.replace("ENDDATA", held + "ENDDATA"))
        self.solved(deck)
        status, said = self.told(deck)
        self.assertEqual((status, [line for line in said.splitlines() if line.startswith("SUBCASE")]), (0, ["SUBCASE 7", "SUBCASE 3", "SUBCASE 5"]), said)
        path = self.place / "cases.nodes.csv"
        rows = path.read_text()
        path.write_text(rows.replace("\n3,41,", "\n5,41,", 1))
        self.assertIn("no node 41", self.told(deck)[1])
        path.write_text(rows)
        moved = deck.read_text().replace("LOAD,12,1.0,0.5", "LOAD,12,1.0,0.6")
        deck.write_text(moved)
        self.assertEqual(self.told(deck)[0], 1)

    def test_lines(self):
        self.check(LINES, 1)

    def test_friction(self):
        deck = self.place / "friction.dat"
        cards = re.sub(r"(?m)^BCONP .*", "BCONP,1,1,2,,,7", LINES.read_text())
        deck.write_text(cards.replace("ENDDATA", "BFRIC,7,,,0.02\nENDDATA"))
        self.check(deck, 2, "friction", "increments")

    def test_ties(self):
        """MPC and MPCADD with springs (CELAS1); an RBE2 that rotates under a MOMENT, fixed there or not, with a spring (CELAS2)."""
        for name, case, held in (("bolt", "MPC = 3\nSPC = 1\nLOAD = 1\n", "SPC1,1,1,5,10,15,26,32\n"), ("tilting_platen", "LOAD = 2\n", ""), ("tilting_platen", "LOAD = 2\n", "SPC1,1,6,33\n")):
            with self.subTest(name + held):
                cards = (ROOT / f"input/{name}/{name}.dat").read_text().split("BEGIN BULK\n")[1]
                cards = re.sub("(?m)^(MAT1 .*)0.0$", r"\g<1>0.3", re.sub("(?m)^(FORCE   2 .* 10000. +)0.0", r"\g<1>0.2", cards))   # no column is only noise
                deck = self.place / f"{name}.dat"
                deck.write_text(f"{case}BEGIN BULK\n{held}" + (cards.replace("SUPORT  33      6\n", "") if held else cards))
                self.check(deck, 1)
                keys = [row[0].partition("_")[0] for row in self.rows(deck, "summary")]
                self.assertEqual([key for key in ("spring", "angle", "moment") if key in keys], ["spring"] + ["angle"] * (name != "bolt") + ["moment"] * held.startswith("SPC1,1,6"))


class Joined(Case):
    def test_gaps_and_bodies_but_for_rounding(self):
        """Joined bodies give gaps of pairs in contact of 5e-13 of the displacements, and forces on bodies that cancel within rounding."""
        for name in ("lost_on_a_travel.dat", "slide_rot0p001.bdf"):
            deck = self.place / name
            deck.write_text((ROOT / "tests/found" / name).read_text().replace("BEGIN BULK\n", "BEGIN BULK\nPARAM,RULE,JOINED\n", 1))
            self.solved(deck)
            self.assertEqual(self.told(deck, "--quiet"), (0, ""), name)
        rows = self.rows(deck, "contact")
        column = rows[0].index("gap")
        touching = next(row for row in rows if row[-1] == "touching")
        touching[column] = "1.0E-6"
        self.assertRegex(self.spoilt(deck, "contact", rows)[1], "(?m)^contact gap .*WRONG$")


class Wholesale(Case):
    """Faults of more than a single cell."""

    def setUp(self):
        super().setUp()
        self.solved(HERTZ)

    def wrong(self, table, change, *words, status=1):
        rows = self.rows(HERTZ, table)
        code, text = self.spoilt(HERTZ, table, change(rows))
        self.assertEqual(status, code, text)
        for word in words:
            self.assertRegex(text, word)

    def test_stresses_doubled(self):
        def doubled(rows):
            last = 1 + rows[0].index("max_equivalent_stress")
            return [rows[0]] + [[*row[:3], *(repr(2 * float(value)) for value in row[3:last]), *row[last:]] for row in rows[1:]]
        self.wrong("elements", doubled, r"(?m)^elements sx .*WRONG$", r"(?m)^equilibrium_residual .*WRONG$", r"(?m)^max_equivalent_stress .*WRONG$")

    def test_a_row_twice_or_too_many(self):
        for table, key, row in (("nodes", "node", 7), ("elements", "element", 7), ("contact", "pair", 2), ("zones", "zone", 1), ("history", "iteration", 2)):
            self.wrong(table, lambda rows: [*rows, rows[row]], rf"hertz44\.{table}\.csv:\d+: {key} \d+ occurs twice", status=2)
        self.wrong("summary", lambda rows: [*rows, *(row for row in rows if row[0] == "max_pressure")], r"hertz44.summary.csv:\d+: max_pressure occurs twice", status=2)
        for table, key in (("nodes", "node"), ("elements", "element"), ("contact", "pair")):
            self.wrong(table, lambda rows: [*rows, ["77777", *rows[1][1:]]], f"{key} 77777 is not in the deck: the table is of another deck", status=2)
        self.wrong("zones", lambda rows: [*rows, ["2", *rows[1][1:]]], r"(?m)^zones +1 +2  WRONG$")
        self.wrong("history", lambda rows: rows[:-1], r"(?m)^iterations +6 +7  WRONG$")

    def test_values_that_are_not_numbers(self):
        for word in ("nan", "inf", "1e999"):
            self.wrong("nodes", lambda rows: [*rows[:9], [*rows[9][:3], word, *rows[9][4:]], *rows[10:]], f"hertz44.nodes.csv:10: ux: '{word}' is not a finite number", status=2)
        for key, status, words in (("total_contact_force", 2, "total_contact_force: '' is not a number"), ("max_pressure", 1, r"(?m)^max_pressure .*WRONG$")):
            self.wrong("summary", lambda rows: [row if row[0] != key else [key, "", row[2]] for row in rows], words, status=status)

    def test_a_status_that_is_not_valid(self):
        self.wrong("summary", lambda rows: [row if row[0] != "status" else ["status", "not certified", ""] for row in rows],
                   r"(?m)^status +valid +not certified  WRONG$")

    def test_columns_of_later_versions(self):
        """Unknown columns and keys are named, and are no faults."""
        def widened(rows):
            return [[*rows[0], "largest_stress"]] + [[*row, "1.5"] for row in rows[1:]]
        rows = self.rows(HERTZ, "elements")
        self.assertRegex(self.spoilt(HERTZ, "elements", widened(rows))[1], "(?m)^not read: elements.csv (.*, )?largest_stress$")
        rows = self.rows(HERTZ, "summary")
        status, text = self.spoilt(HERTZ, "summary", [*rows, ["remarks", "BCONP 1: a word", ""], ["penetration", "1.0E-3", "length"]])
        self.assertEqual(0, status, text)
        self.assertRegex(text, "(?m)^not read: summary.csv .*factorizations, .*condition, .*, weak_pairs, remarks, penetration$")
        self.assertRegex(text, "(?m)^not read: bodies.csv mesh_error_x, mesh_error_y$")
        self.assertRegex(text, "(?m)^not read: hertz44.lst$")

    def test_quiet(self):
        self.assertEqual((0, ""), self.told(HERTZ, "--quiet"))

    def test_a_missing_table(self):
        for table in ("zones", "history"):
            shutil.move(self.path(HERTZ, table), self.place / "aside")
            status, text = self.told(HERTZ)
            self.assertEqual(2, status)
            self.assertIn(f"hertz44.{table}.csv: no such file: write it again with epcont", text)
            shutil.move(self.place / "aside", self.path(HERTZ, table))


if __name__ == "__main__":
    unittest.main()
