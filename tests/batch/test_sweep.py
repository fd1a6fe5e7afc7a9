#!/usr/bin/env python3
"""tools/sweep: values in the fields of decks as the program reads them, or refused; all decks or none."""
import csv
import os
import subprocess
import time
import unittest

from common import PROGRAM, ROOT, SMALL, Case

TEXT = SMALL.read_text()
SMALL_FIELD = TEXT.replace("MAT1    1       20400.          .29", "MAT1    1       %E%             %nu%")
LARGE_FIELD = TEXT.replace("MAT1    1       20400.          .29", "MAT1*   1               %E%                             %nu%")
FREE_FIELD = TEXT.replace("MAT1    1       20400.          .29", "MAT1,1,%E%,,%nu%")


class Sweep(Case):
    def sweep(self, status, deck, table, name="s.in", directory="set"):
        (self.place / name).parent.mkdir(exist_ok=True, parents=True)
        (self.place / name).write_text(deck)
        (self.place / "t.csv").write_text(table, encoding="utf-8")
        return self.run_it(status, name, "t.csv", "-o", directory, tool="sweep")

    def cards(self, name, card):
        lines = (self.place / "set" / name).read_text().splitlines()
        return [line for line in lines if line.startswith(card)]

    def refused(self, deck, table, *words):
        run = self.sweep(3, deck, table)
        for word in words:
            self.assertIn(word, run.stderr)
        self.assertFalse((self.place / "set").exists())

    def checked(self):
        """The program accepts every deck."""
        for path in (self.place / "set").glob("*.dat"):
            run = subprocess.run([PROGRAM, "--check", path], capture_output=True, text=True)
            self.assertEqual(0, run.returncode, run.stderr)


class Fields(Sweep):
    def test_small_field(self):
        self.sweep(0, SMALL_FIELD, "E,nu\n20400,0.29\n2.04e4,.3\n66666.666666,1E-1\n2040000000,0.123456789\n1e-7,.25\n")
        self.assertEqual(["MAT1    1       20400.          0.29"], self.cards("s_1.dat", "MAT1"))
        self.assertEqual(["MAT1    1       2.04e4          .3"], self.cards("s_2.dat", "MAT1"))
        self.assertEqual(["MAT1    1       66666.67        .1"], self.cards("s_3.dat", "MAT1"))
        self.assertEqual(["MAT1    1       2.04+9          .1234568"], self.cards("s_4.dat", "MAT1"))
        self.assertEqual(["MAT1    1       1.-7            .25"], self.cards("s_5.dat", "MAT1"))
        self.checked()

    def test_large_and_free_field(self):
        for deck in (LARGE_FIELD, FREE_FIELD):
            self.sweep(0, deck, "E,nu\n20400,0.29\n20400.123456789,1e-3\n0.3333333333333333333,0.30000000000000004\n")
            self.checked()
        self.assertEqual(["MAT1,1,20400.123456789,,.001"], self.cards("s_2.dat", "MAT1"))
        self.assertEqual(["MAT1,1,0.3333333333333333333,,0.30000000000000004"], self.cards("s_3.dat", "MAT1"))
        self.sweep(0, LARGE_FIELD, "E,nu\n0.3333333333333333333,0.30000000000000004\n")
        self.assertEqual(["MAT1*   1               .333333333333333" + " " * 16 + ".3"], self.cards("s_1.dat", "MAT1"))

    def test_continued_lines_and_other_kinds(self):
        deck = TEXT.replace("GRID*   3                               0.01565936000   1.226200000E-04\n*       0.0",
                            "GRID*   3                               0.01565936000   1.226200000E-04\n*       %z%")
        deck = deck.replace("PARAM   GAPGEOM YES", "PARAM   GAPGEOM %geom%\nPARAM   MAXIT   %most%")
        self.sweep(0, deck, "z,geom,most\n0,YES,7.0\n0.,no,12\n")
        self.assertEqual(["*       0."], [line for line in self.cards("s_1.dat", "*") if line.endswith("0.")])
        self.assertEqual(["PARAM   GAPGEOM YES", "PARAM   MAXIT   7"], [line for line in self.cards("s_1.dat", "PARAM") if "E  " not in line][-2:])
        self.checked()

    def test_values_arrive_in_the_answer(self):
        self.sweep(0, TEXT.replace("FORCE   1       41      0       5. ", "FORCE   1       41      0       %P%"), "deck,P\na,5\nb,5.000\n")
        self.run_it(0, "--list", "set/sweep.csv", "-o", "out")
        self.run_it(0, SMALL, "-o", "alone")
        for row in self.table():
            self.assertEqual(self.table("alone")[0]["p_max"], row["p_max"])
        self.assertEqual([("set/a.dat", "5"), ("set/b.dat", "5.000")], [(row["deck"], row["P"]) for row in self.table()])

    def test_line_ends_of_other_systems(self):
        self.sweep(0, SMALL_FIELD.replace("\n", "\r\n"), "E,nu\r\n20400,0.29\r\n")
        self.assertEqual(["MAT1    1       20400.          0.29"], self.cards("s_1.dat", "MAT1"))
        self.checked()

    def test_titles_comments_and_includes(self):
        for path in (ROOT / "input" / "include").glob("*.*"):
            self.deck(f"sub/{path.name}", path)
        deck = (self.place / "sub" / "patch_case.dat").read_text().replace("mesh.inc", "%part%.inc")
        self.sweep(0, "$ %part%, 99 % of 100 %\n" + deck, "part\nmesh\n", "sub/s.in")
        text = (self.place / "set" / "s_1.dat").read_text()
        self.assertTrue(text.startswith("$ mesh, 99 % of 100 %\n"))
        self.assertIn("../sub/mesh.inc", text)
        self.checked()


class Refusals(Sweep):
    def test_values_that_do_not_fit(self):
        line = SMALL_FIELD.splitlines().index("MAT1    1       %E%             %nu%") + 1
        for value, words in (("1.23456e-5", "8 columns hold only 1.2346-5"), ("-1.23456789e-12", "8 columns hold only -1.23-12"), ("x", "not a real: write it as"),
                             ("1e400", "out of the range of reals: give a value between"), ("1.5e400", "out of the range of reals"), ("\uff12.5", "not a real: write it as"), ("\u0663.0", "not a real: write it as"),
                             ("nan", "not a real: write it as"), ("1 2", "not a real: write it as")):
            with self.subTest(value):
                self.refused(SMALL_FIELD, f"E,nu\n20400,.3\n{value},.3\n", f"t.csv:3: column E, {value!r}: s.in:{line}:17-24: MAT1 field 3 (E): ",
                             words, "\ntools/sweep: 1 error, nothing is written\n")

    def test_continued_large_fields(self):
        """A small-field line after half a row of large fields begins a new row."""
        deck = TEXT.replace("MAT1    1       20400.          .29", "MAT1*   1               20400.                          .29\n+       %a%")
        self.refused(deck, "a\nx\n", ":9-16: MAT1 field 12 (ST): not a real: write it as")
        deck = deck.replace("+       %a%", "*       %a%")
        self.refused(deck, "a\nx\n", ":9-24: MAT1 field 6 (RHO): not a real: write it as")

    def test_kinds(self):
        deck = SMALL_FIELD.replace("FORCE   1       41      0 ", "FORCE   1       %node%  0 ").replace("PARAM   GAPGEOM YES", "PARAM   GAPGEOM %geom%")
        self.refused(deck, "E,nu,node,geom\n1.,.3,41.5,NO\n1.,.3,41,long_words\n1.,.3,123456789,NO\n",
                     "(G): not a whole number: give one", "not a word: give at most 8 characters", "9 characters in a field of 8", "3 errors, nothing")

    def test_digits_of_other_scripts(self):
        deck = SMALL_FIELD.replace("FORCE   1       41      0 ", "FORCE   1       %node%  0 ")
        self.refused(deck, "E,nu,node\n1.,.3,\uff14\uff11\n", "t.csv:2: column node, '\uff14\uff11': s.in:", "(G): not a whole number: give one")
        for card, value in (("XYZ     ", "\uff15"), ("PARAM   NOSUCH  ", "\uff15")):   # of an unknown type
            self.refused(deck.replace("BEGIN BULK", f"BEGIN BULK\n{card}%x%"), f"E,nu,node,x\n1.,.3,41,{value}\n", f"column x, '{value}'", ": not a ")

    def test_unlike_rows_of_one_deck(self):
        """A field of 8 columns rounds both to the same value: whatever the titles, they would be one deck."""
        line = SMALL_FIELD.splitlines().index("MAT1    1       %E%             %nu%") + 1
        more = ": use a large field (a * after the card's name) or free format (commas)"
        for deck in (SMALL_FIELD, SMALL_FIELD.replace("CEND", "CEND\n$ %E%")):
            k = line + (deck != SMALL_FIELD)
            run = self.sweep(3, deck, "E,nu\n66666.671,.3\n1.,.3\n66666.672,.3\n66666.67,0.30\n66666.671,.31\n")
            self.assertEqual(f"t.csv:4: the same deck as line 2: column E, '66666.671' and '66666.672': s.in:{k}:17-24: MAT1 field 3 (E): "
                             f"both are 66666.67: 8 columns hold 7 digits{more}\n"
                             f"t.csv:5: the same deck as line 2: column E, '66666.671' and '66666.67': s.in:{k}:17-24: MAT1 field 3 (E): "
                             f"both are 66666.67: 8 columns hold 7 digits{more}\ntools/sweep: 2 errors, nothing is written\n", run.stderr)
            self.assertFalse((self.place / "set").exists())
        line = FREE_FIELD.splitlines().index("MAT1,1,%E%,,%nu%") + 1
        self.refused(FREE_FIELD, "E,nu\n0.12345678901234567891,.3\n0.12345678901234567892,.3\n",
                     "t.csv:3: the same deck as line 2: column E, '0.12345678901234567891' and '0.12345678901234567892': "
                     f"s.in:{line}:8-10: MAT1 field 3 (E): both are 0.12345678901234567892: a real holds 16 digits\n")

    def test_like_rows_and_other_decks(self):
        """The same number in another form is accepted; a free field distinguishes values that a small one does not."""
        self.sweep(0, SMALL_FIELD, "E,nu\n20400,.3\n2.04e4,0.30\n20400.0,.3\n")
        self.sweep(0, FREE_FIELD, "E,nu\n66666.671,.3\n66666.672,.3\n", directory="free")
        self.assertNotEqual((self.place / "free" / "s_1.dat").read_text(), (self.place / "free" / "s_2.dat").read_text())

    def test_places(self):
        self.refused(SMALL_FIELD.replace("%E%     ", "%young% "), "E,nu\n1.,.3\n", "%young% has no column in t.csv: use one of E, nu")
        self.refused(SMALL_FIELD.replace("%E%     ", "1%E%    "), "E,nu\n1.,.3\n", "%E% does not fill a field")
        self.refused(SMALL_FIELD.replace("%E%             ", "%modulus%       "), "modulus,nu\n1.,.3\n", "does not fill a field: use a shorter name")
        self.refused(TEXT, "E\n1.\n", "no placeholder in the deck: add one, such as %E%")

    def test_tables(self):
        for table, words in (("", "t.csv:1: not a header: give each column a name"), ("E,E\n1,2\n", "each name only once"), ("E,nu\n", "no values: add a row"),
                             ("E,nu\n1.\n", "t.csv:2: wrong number of values: give 2, one per column"), ("E,nu\n1.,.3,4\n", "t.csv:2: wrong number of values: give 2, one per column"), ("E\n1,2\n", "t.csv:2: wrong number of values: give 1, one per column\n"), ("deck,E,nu\n../x,1.,.3\n", "use letters, digits"),
                             ("deck,E,nu\na,1.,.3\nA.dat,1.,.3\n", "deck A.dat occurs twice"), ("deck,E,nu,status\na,1.,.3,4\n", "column status is also in batch.csv"),
                             ("deck,E,nu\na.csv,1.,.3\n", "without .lst or .csv")):
            with self.subTest(table):
                self.refused(SMALL_FIELD, table, words)

    def test_files_that_are_not_text(self):
        (self.place / "s.in").write_text(SMALL_FIELD)
        (self.place / "t.csv").write_bytes(b"E,nu\n1.,.3\n\xff\xfe,.3\n")
        self.assertIn("t.csv:3: not UTF-8", self.run_it(3, "s.in", "t.csv", "-o", "set", tool="sweep").stderr)
        self.assertIn("nowhere.csv: cannot be read: No such file", self.run_it(3, "s.in", "nowhere.csv", "-o", "set", tool="sweep").stderr)
        self.assertIn("nowhere.in: cannot be read: No such file", self.run_it(3, "nowhere.in", "t.csv", "-o", "set", tool="sweep").stderr)
        for program in ("/bin/true", "/bin/false"):
            self.assertIn("give a working epcont", self.run_it(3, "s.in", "t.csv", "-o", "set", "--program", program, tool="sweep").stderr)

    def test_a_missing_include(self):
        self.refused(SMALL_FIELD.replace("ENDDATA", "INCLUDE 'nowhere.inc'\nENDDATA"), "E,nu\n1.,.3\n", "INCLUDE: nowhere.inc: no such file")


class Sets(Sweep):
    def test_an_earlier_sweep_is_renewed_other_files_are_not(self):
        self.sweep(0, SMALL_FIELD, "deck,E,nu\na,1.,.3\nb,2.,.3\n")
        self.sweep(0, SMALL_FIELD, "deck,E,nu\na,3.,.3\n")
        self.assertEqual(["MAT1    1       3.              .3"], self.cards("a.dat", "MAT1"))
        (self.place / "set" / "mine.dat").write_text("mine")
        self.assertIn("mine.dat exists, and not from an earlier sweep", self.sweep(3, SMALL_FIELD, "deck,E,nu\nmine,3.,.3\n").stderr)
        self.assertEqual("mine", (self.place / "set" / "mine.dat").read_text())

    def test_a_sweep_csv_of_another_program(self):
        (self.place / "set").mkdir()
        for text in (b"\xff\xfe\0", b"", b"name\nx\n"):
            (self.place / "set" / "sweep.csv").write_bytes(text)
            self.assertIn("sweep.csv exists, and not from an earlier sweep", self.sweep(3, SMALL_FIELD, "E,nu\n1.,.3\n").stderr)
            self.assertEqual(text, (self.place / "set" / "sweep.csv").read_bytes())

    def test_faults_leave_an_earlier_sweep_as_it_was(self):
        self.sweep(0, SMALL_FIELD, "deck,E,nu\na,1.,.3\nb,2.,.3\n")
        before = {path.name: path.read_bytes() for path in (self.place / "set").iterdir()}
        self.sweep(3, SMALL_FIELD, "deck,E,nu\na,5.,.3\nb,x,.3\n")
        self.assertEqual(before, {path.name: path.read_bytes() for path in (self.place / "set").iterdir()})

    def test_a_full_disk_leaves_nothing(self):
        place = self.place / "small"
        place.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", place], capture_output=True).returncode:
            self.skipTest("no right to mount")
        try:
            rows = "".join(f"{k}.,.3\n" for k in range(1, 40))
            self.assertIn("cannot be written", self.sweep(3, SMALL_FIELD, "E,nu\n" + rows, directory="small/set").stderr)
            self.assertEqual([], os.listdir(place))
        finally:
            subprocess.run(["umount", place], check=True)

    def test_nothing_is_left_behind(self):
        (self.place / "set").mkdir()
        (self.place / "set" / "b.dat").mkdir()
        self.assertIn("set/b.dat exists, and not from an earlier sweep", self.sweep(3, SMALL_FIELD, "deck,E,nu\na,1.,.3\nb,2.,.3\n").stderr)
        self.assertEqual(["b.dat"], os.listdir(self.place / "set"))
        name = "a" * 300
        for table, directory, words in ((f"deck,E,nu\nb,1.,.3\n{name},1.,.3\n", "new/deep/set", f"new/deep/set/{name}.dat.part: cannot be written: File name too long"),
                                        ("E,nu\n1.,.3\n", f"new/{name}", f"new/{name}: cannot be written: File name too long"),
                                        (f"deck,E,nu\n{name[:251]},1.,.3\n", "new/set", ".dat.part: cannot be written: File name too long"),
                                        ("E,nu\n1.,.3\n", "s.in/set", "s.in/set: cannot be written: Not a directory")):
            self.assertIn(words, self.sweep(3, SMALL_FIELD, table, directory=directory).stderr)
            self.assertEqual(["s.in", "set", "t.csv"], sorted(path.name for path in self.place.iterdir() if path.name != "fake"))

    def test_the_command_that_follows(self):
        run = self.sweep(0, SMALL_FIELD, "E,nu\n1.,.3\n", directory="a set")
        self.assertEqual("1 deck; tools/batch --list 'a set/sweep.csv' -o 'a set/results'\n", run.stdout)

    def test_a_large_table(self):
        """The comparison of rows takes linear time."""
        begun = time.monotonic()
        self.sweep(0, "BEGIN BULK\nMAT1,1,%E%\nENDDATA\n", "E\n" + "".join(f"{k}.\n" for k in range(1, 2001)))
        self.assertLess(time.monotonic() - begun, 20)
        self.assertEqual(2001, len(os.listdir(self.place / "set")))

    def test_numbers_have_equal_widths(self):
        self.sweep(0, SMALL_FIELD, "E,nu\n" + "1.,.3\n" * 12)
        with open(self.place / "set" / "sweep.csv", newline="") as file:
            self.assertEqual([f"s_{k:02d}.dat" for k in range(1, 13)], [row["deck"] for row in csv.DictReader(file)])


if __name__ == "__main__":
    unittest.main(verbosity=2)   # shows why a test is skipped
