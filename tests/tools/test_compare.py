"""Tests of tools/compare and tools/accept."""
import contextlib
import io
import pathlib
import unittest

import common

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


class Files(Case):
    def test_directories_both_ways(self):
        for name in ("old/a.lst", "new/a.lst", "old/b.csv"):
            self.write(name, "a\n")
        old, new = self.place / "old", self.place / "new"
        self.assertEqual(self.run_tool(compare, old, new), 1)
        self.assertIn("b.csv: only here", self.output)
        self.assertEqual(self.run_tool(compare, new, old), 1)
        self.write("new/b.csv", "a\n")
        self.assertEqual(self.run_tool(compare, old, new), 0)

    def test_unreadable(self):
        self.assertEqual(self.run_tool(compare, self.place / "none.lst", self.write("a.lst", "a\n")), 2)
        self.assertEqual(self.run_tool(compare, self.place, self.place), 0)
        (self.place / "empty").mkdir()
        self.assertEqual(self.run_tool(compare, self.place / "empty", self.place / "empty"), 2)
        self.assertIn("no .lst or .csv in them", self.output)
        for suffix in ("lst", "csv"):
            self.assertEqual(self.verdict("", "", suffix=suffix), 2)
            self.assertIn(f"compare: {self.place}/old.{suffix}: nothing in it: a listing or a table would be right\n", self.output)
            strange = self.place / f"strange.{suffix}"
            strange.write_bytes(b"a\n\xff\n")
            self.assertEqual(self.run_tool(compare, self.write(f"a.{suffix}", "a\n"), strange), 2)
            self.assertIn(f"compare: {strange}:2: not a text in UTF-8", self.output)

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
