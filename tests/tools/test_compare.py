"""Tests of tools/compare and tools/accept."""
import contextlib
import io
import os
import pathlib
import re
import subprocess
import sys
import unittest

import common
from common import ROOT

compare = common.load("compare")
accept = common.load("accept")


class Case(common.Case):
    def write(self, name, text):
        path = self.place / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return str(path)

    def run_tool(self, tool, *arguments):
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            status = tool.main([str(argument) for argument in arguments])
        self.output = output.getvalue()
        return status

    def verdict(self, reference, new, *options, suffix="lst"):
        return self.run_tool(compare, self.write(f"old.{suffix}", reference), self.write(f"new.{suffix}", new), *options)


class Structure(Case):
    def test_same(self):
        self.assertEqual(self.verdict("a 1 2.0\n\n  b\n", "a 1 2.0\n\n  b\n"), 0)

    def test_missing_and_added_lines(self):
        self.assertEqual(self.verdict("a\nb\nc\n", "a\nc\n"), 1)
        self.assertIn("old.lst:2: line missing", self.output)
        self.assertEqual(self.verdict("a\nc\n", "a\nb\nc\n"), 1)
        self.assertIn("new.lst:2: line not in", self.output)

    def test_words_and_whole_numbers_are_exact(self):
        self.assertEqual(self.verdict("1 open 2.0\n", "1 shut 2.0\n"), 1)
        self.assertIn("new.lst:1:3: shut", self.output)
        self.assertEqual(self.verdict("1000000\n", "1000001\n"), 1)

    def test_columns(self):
        self.assertEqual(self.verdict("1.0 2.0\n", "1.0\n"), 1)
        self.assertIn("new.lst:1: 1 column, reference 2", self.output)
        self.assertEqual(self.verdict("a,b\n1.0,2.0\n", "a\n1.0\n", suffix="csv"), 1)

    def test_number_for_word(self):
        self.assertEqual(self.verdict("1.0\n", "none\n"), 1)


class Numbers(Case):
    def test_relative_tolerance(self):
        self.assertEqual(self.verdict("p 1.00000\n", "p 1.00009\n"), 0)
        self.assertEqual(self.verdict("p 1.00000\n", "p 1.00020\n"), 1)
        self.assertIn("new.lst:1:3: 1.00020", self.output)
        self.assertEqual(self.verdict("p 1.00000\n", "p 1.00020\n", "--relative", "1e-3"), 0)

    def test_absolute_tolerance_is_of_the_column(self):
        reference = "1 1000.0 1.0\n2 0.0 1.0\n"
        self.assertEqual(self.verdict(reference, "1 1000.0 1.0\n2 0.0009 1.0\n"), 0)
        self.assertEqual(self.verdict(reference, "1 1000.0 1.0\n2 0.0011 1.0\n"), 1)

    def test_a_line_of_words_has_its_own_scale(self):
        self.assertEqual(self.verdict("force 1000.0\nshift 0.0001\n", "force 1000.0\nshift 0.0002\n"), 1)

    def test_csv_scale_is_of_the_column_or_of_the_key(self):
        self.assertEqual(self.verdict("pair,x\n1,1e3\n2,0.0\n", "pair,x\n1,1e3\n2,1e-4\n", suffix="csv"), 0)
        self.assertEqual(self.verdict("key,value\na,1e3\nb,0.0\n", "key,value\na,1e3\nb,1e-4\n", suffix="csv"), 1)
        self.assertIn("new.csv:3:value", self.output)

    def test_fortran_forms(self):
        self.assertEqual(self.verdict("-0.1E+02 .5 1.0E-100 1.0-100\n", "-1.0D+01 5E-1 1.0-100 0.1E-99\n"), 0)

    def test_nan_infinity_and_overflow_never_agree(self):
        for word in ("NaN", "-Infinity", "******"):
            self.assertEqual(self.verdict(f"a {word}\n", f"a {word}\n"), 1)
            self.assertEqual(self.verdict("a 1.0\n", f"a {word}\n"), 1)

    def test_bounds(self):
        self.assertEqual(self.verdict("r < 1E-12\n", "r < 1E-12\n"), 0)
        self.assertEqual(self.verdict("r < 1E-12\n", "r 0.3E-11\n"), 0)
        self.assertEqual(self.verdict("r 0.3E-11\n", "r < 1E-12\n"), 0)
        self.assertEqual(self.verdict("r < 1E-12\n", "r 0.3E-09\n"), 1)
        self.assertEqual(self.verdict("r < 1E-12\n", "r 0.0\n"), 0)
        self.assertEqual(self.verdict("r < 1E-12\n", "r -0.3E-11\n"), 0)
        self.assertEqual(self.verdict("r < 1E-12\n", "r -1.0\n"), 1)

    def test_a_bound_is_no_word_for_any_bound(self):
        for old, new in (("< 1E-12", "< 1E+12"), ("< 1E+12", "< 1E-12"), ("6.0E-03", "< 1E+12"), ("6.0E-03", "< 1E-12"), ("0.0", "< 1E-12"),
                         ("< 1E-12", "< 1E-9"), ("< 1E-9", "< 1E-12")):
            self.assertEqual(self.verdict(f"r {old}\n", f"r {new}\n"), 1, (old, new))
            self.assertIn(f"new.lst: 1 of 1 reals differ from {self.place}/old.lst\n", self.output)
            self.assertIn(f"{self.place}/new.lst:1:3: {new}, reference {self.place}/old.lst:1:3: {old}\n", self.output)
        for old, new in (("< 1E-12", "< 1E-10"), ("< 1E-10", "< 1E-12")):
            self.assertEqual(self.verdict(f"r {old}\n", f"r {new}\n"), 0, (old, new))

    def test_punctuation_is_no_part_of_a_number(self):
        self.assertEqual(self.verdict("(x=1.00000, 5.00000%)\n", "(x=1.00001, 5.00001%)\n"), 0)

    def test_worst_differences_are_named(self):
        self.verdict("a 1000.0\nb 1.0\n", "a 1001.0\nb 1.5\n")
        self.assertIn("worst absolute difference 1.000E+00 at " + str(self.place / "new.lst") + ":1:3", self.output)
        self.assertIn("worst relative difference 3.333E-01 at " + str(self.place / "new.lst") + ":2:3", self.output)


SUMMARY = {"status": "valid", "warnings": "0", "max_pressure": "2.0", "approach_7_2": "-1.0E-3", "condition": "5.0E3", "energy_balance": "1.0E-15",
           "mesh_error_max_pressure": "1.0E-1"}
PAIRS = ["5,1.0,2.0,1.0E-19,touching", "6,0.5,1.0,0.0,touching"]


class Folders(Case):
    def deck(self, folder, name="a", pairs=PAIRS, case="", **changes):
        """The tables of a deck, with other values of some keys; None removes a key."""
        head, before = ("subcase,", case + ",") if case else ("", "")
        summary = {key: value for key, value in {**SUMMARY, **changes}.items() if value is not None}
        for table, columns, rows in (("summary", "key,value,unit", [f"{key},{value}," for key, value in summary.items()]),
                                     ("contact", "pair,force,pressure,gap,status", pairs)):
            path = self.place / folder / f"{name}.{table}.csv"
            text = path.read_text() if case and path.exists() else head + columns + "\n"
            self.write(f"{folder}/{path.name}", text + "".join(before + row + "\n" for row in rows))

    def judged(self, status, verdict):
        self.assertEqual((self.run_tool(compare, self.place / "old", self.place / "new"), self.output.splitlines()[-1]), (status, verdict), self.output)

    def test_noise_times_and_words_are_no_results(self):
        for folder, seconds, noise in (("old", "1.0", "1.0E-15"), ("new", "2.0", "-3.0E-13")):
            for name in ("a", "b"):
                self.deck(folder, name, [PAIRS[0].replace("1.0E-19", noise.replace("E-1", "E-2")), PAIRS[1]], energy_balance=noise, condition=seconds,
                          warnings=seconds[0], approach_7_2="-1.000000001E-3" if folder == "new" else "-1.0E-3")
                self.write(f"{folder}/{name}.lst", f"epcont {seconds}\n\nPLAN\n  memory {seconds} MB\n")
            self.write(f"{folder}/batch.csv", f"deck,status,seconds,memory_MB,p_max\nx/a.dat,valid,{seconds},8,2.0\nx/b.dat,valid,{seconds},9,2.0\n")
        self.judged(0, "2 decks: the same")

    def test_the_worst_figure_is_named(self):
        for name in ("a", "b", "c"):
            self.deck("old", name)
        self.deck("new", "a")
        self.deck("new", "b", approach_7_2="-1.00005E-3")
        self.deck("new", "c", max_pressure="2.00062")
        self.judged(1, "3 decks: 1 the same, 2 differ; worst: p_max of deck c, 3.1E-04")
        self.assertIn("approach_7_2 of deck b, 5.0E-05\n", self.output)

    def test_figures_come_before_estimates(self):
        self.deck("old")
        self.deck("new", mesh_error_max_pressure="2.0E-1", max_pressure="2.002")
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: p_max of deck a, 1.0E-03")
        self.deck("new", mesh_error_max_pressure="2.0E-1")
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: mesh_error_max_pressure of deck a, 5.0E-02")

    def test_rows_of_tables(self):
        self.deck("old")
        self.deck("new", pairs=[PAIRS[0], "6,0.501,1.0,0.0,touching"])
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: force of pair 6 of deck a, 1.0E-03")
        self.deck("new", pairs=PAIRS[:1])
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: force of pair 6 of deck a, missing in the second folder")
        self.deck("new", pairs=[*PAIRS, PAIRS[1].replace("6,", "7,")])
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: force of pair 7 of deck a, only in the second folder")

    def test_missing_figures_differ_and_new_ones_do_not(self):
        self.deck("old")
        self.deck("new", spring_7="1.0")
        self.judged(0, "1 deck: the same")
        self.deck("new", approach_7_2=None)
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: approach_7_2 of deck a, missing in the second folder")
        for folder, pressure in (("old", "3.0"), ("new", "4.0")):
            self.deck(folder, status="not converged", max_pressure=pressure)
        self.judged(0, "1 deck: the same")
        self.deck("old")
        self.deck("new", status="overlap", max_pressure="3.0")
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: status of deck a, valid -> overlap")
        self.deck("new", max_pressure="")
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: p_max of deck a, 2.0 -> nothing")
        self.deck("new")
        (self.place / "new/a.contact.csv").unlink()
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: contact of deck a, missing in the second folder")

    def test_missing_decks(self):
        self.deck("old", "a")
        self.deck("old", "b")
        self.deck("new", "b")
        self.judged(1, "2 decks: 1 the same, 1 differs; worst: deck a, only in the first folder")
        self.deck("new", "a")
        self.deck("new", "c")
        self.judged(1, "3 decks: 2 the same, 1 differs; worst: deck c, only in the second folder")

    def test_a_difference_counts_once(self):
        """Also if the results are in a folder of the folder, or are in batch.csv too."""
        for folder, pressure in (("old", "2.0"), ("new", "2.002")):
            for below in ("", "/study"):
                self.write(f"{folder}{below}/batch.csv", f"deck,status,p_max\nx/a.dat,valid,{pressure}\n")
                self.deck(folder + below, max_pressure=pressure)
        self.judged(1, "2 decks: 0 the same, 2 differ; worst: p_max of deck a, 1.0E-03")
        for folder in ("old", "new"):
            for path in (self.place / folder).glob("*.csv"):
                path.unlink()
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: p_max of deck study/a, 1.0E-03")
        self.assertEqual(len(self.output.splitlines()), 1)

    def test_load_cases(self):
        """Each is compared with its own case, and scale."""
        for folder in ("old", "new"):
            self.deck(folder, case="3", max_pressure="2000.0")
            self.deck(folder, case="7", max_pressure="2.0" if folder == "old" else "2.0002")
        self.judged(1, "1 deck: 0 the same, 1 differs; worst: p_max of SUBCASE 7 of deck a, 1.0E-04")

    def test_listings_without_tables(self):
        listing = (ROOT / "tests/listings/hertz44.lst").read_text()
        old = self.write("old/hertz44.lst", listing)
        self.write("new/hertz44.lst", listing.replace("< 1E-12", "0.3E-12").replace("memory 8 MB", "memory 9 MB").replace("5597.4", "5600.1"))
        self.judged(0, "1 deck: the same")
        for text, other, words in (("2.03751E+02", "2.03772E+02", "p_max of deck hertz44, 1.0E-04"), ("1.59530E+00", "1.59547E+00", "force of pair 302 of deck hertz44, 3.4E-05"),
                                   ("-1.28530E-03", "-1.28543E-03", "approach of GRID 41 direction 2 of deck hertz44, 1.0E-04"),
                                   ("3.13199E-02", "3.13299E-02", "half_width_last_pair of zone 1 of deck hertz44, 3.2E-04")):
            self.write("new/hertz44.lst", listing.replace(text, other))
            self.judged(1, f"1 deck: 0 the same, 1 differs; worst: {words}")
        self.assertEqual(listing, pathlib.Path(old).read_text())


@unittest.skipUnless("EPCONT_PROGRAM" in os.environ, "no program")
class Runs(Case):
    """The same program twice, with other threads and kernels, and with a load that is larger by 1E-4."""
    DECKS = ("hertz/hertz44.dat", "hertz/hertz44_elastic.dat", "flat_match/flat_pairs.dat", "off_centre/off_centre.dat")

    def batch(self, folder, decks, **environment):
        subprocess.run([sys.executable, ROOT / "tools/batch", *decks, "-o", self.place / folder, "--program", os.environ["EPCONT_PROGRAM"]], check=True,
                       capture_output=True, env={**os.environ, **environment})

    def run_all(self, folder, decks, **environment):
        subprocess.run([os.environ["EPCONT_PROGRAM"], *decks, "-o", self.place / folder, "--tables", "all", "--quiet"], check=True, capture_output=True,
                       env={**os.environ, **environment})

    def verdict_of(self, *folders):
        status = self.run_tool(compare, *(self.place / folder for folder in folders))
        return status, self.output.splitlines()[-1]

    def test_twice(self):
        decks = [ROOT / "input" / name for name in self.DECKS]
        for folder in ("one", "two"):
            self.batch(folder, decks)
        self.assertEqual(self.verdict_of("one", "two"), (0, "4 decks: the same"))
        for folder, environment in (("usual", {}), ("other", {"OPENBLAS_CORETYPE": "Prescott", "OMP_NUM_THREADS": "3"})):
            (self.place / folder).mkdir()
            self.run_all(folder, decks, **environment)
        self.assertEqual(self.verdict_of("usual", "other"), (0, "4 decks: the same"))

    def test_a_larger_load(self):
        deck = self.place / "hertz44_elastic.dat"
        for folder, load in (("one", "5."), ("two", "5.0005")):
            deck.write_text(re.sub(r"(?m)^(FORCE +1 +41 +0 +)5\. {6}", lambda match: match[1] + load.ljust(8), (ROOT / "input/hertz/hertz44_elastic.dat").read_text()))
            self.batch(folder, [deck, ROOT / "input/flat_match/flat_pairs.dat"])
        status, verdict = self.verdict_of("one", "two")
        self.assertEqual(status, 1)
        self.assertRegex(verdict, r"^2 decks: 1 the same, 1 differs; worst: \S+( of \w+ \d+)? of deck \S*hertz44_elastic, \d\.\dE-0[45]$")


class Files(Case):
    def test_unreadable(self):
        self.assertEqual(self.run_tool(compare, self.place / "none.lst", self.write("a.lst", "a\n")), 2)
        (self.place / "empty").mkdir()
        self.assertEqual(self.run_tool(compare, self.place / "empty", self.place / "empty"), 2)
        self.assertIn("no results of epcont or tools/batch: give folders with results", self.output)
        for suffix in ("lst", "csv"):
            self.assertEqual(self.verdict("", "", suffix=suffix), 2)
            self.assertIn(f"compare: {self.place}/old.{suffix}: empty file: give a listing or a table\n", self.output)
            strange = self.place / f"strange.{suffix}"
            strange.write_bytes(b"a\n\xff\n")
            self.assertEqual(self.run_tool(compare, self.write(f"a.{suffix}", "a\n"), strange), 2)
            self.assertIn(f"compare: {strange}:2: not UTF-8 text: give a listing or a table", self.output)

    def test_accept(self):
        new = self.write("new/a.lst", "epcont 1\na 2.0\n")
        reference = pathlib.Path(self.write("references/a.lst", "epcont 1\na 1.0\n"))
        options = ("--references", reference.parent)
        self.assertEqual(self.run_tool(accept, new, *options), 1)
        self.assertIn("-a 1.0\n+a 2.0\n", self.output)
        self.assertEqual(reference.read_text(), "epcont 1\na 1.0\n")
        self.assertEqual(self.run_tool(accept, new, "--yes", *options), 0)
        self.assertEqual(reference.read_text(), "epcont 1\na 2.0\n")
        self.assertEqual(self.run_tool(accept, new, *options), 0)
        self.assertEqual(self.output, "")

    def test_only_listings_are_accepted(self):
        for text in (b"", b"a deck\n", b"\xff\n"):
            (self.place / "a.lst").write_bytes(text)
            self.assertEqual(self.run_tool(accept, self.place / "a.lst", "--yes", "--references", self.place / "none"), 2)
            self.assertIn("a.lst: not a listing of epcont", self.output)
        self.assertEqual(self.run_tool(accept, self.place / "b.lst"), 2)
        self.assertIn("b.lst: No such file", self.output)


if __name__ == "__main__":
    unittest.main()
