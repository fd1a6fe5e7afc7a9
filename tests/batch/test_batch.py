#!/usr/bin/env python3
"""tools/batch on this machine: the table, places, resuming, and programs that crash, hang or write half a file."""
import collections
import os
import pathlib
import re
import signal
import subprocess
import sys
import time
import unittest

from common import PROGRAM, ROOT, SMALL, Case  # and the modules of tools
from batching.outcome import first_fault
from batching.slurm import Watch


class Whole(Case):
    def test_warnings(self):
        """Warnings are counted, the first is shown, and the closing line has the total."""
        blseg = "BLSEG,7,1,2\n"
        text = SMALL.read_text().replace("ENDDATA", blseg + "ENDDATA")
        self.deck("a.dat")
        (self.place / "b.dat").write_text(text)
        run = self.run_it(0, "a.dat", "b.dat", "-o", "out")
        rows = self.table()
        self.assertEqual([("0", ""), ("1", f"{text[:text.index(blseg)].count(chr(10)) + 1}:7: warning: BLSEG 7: no BCONP names it; add a BCONP "
                                           "with it as SLAVE or MASTER, or remove the line")],
                         [(row["warnings"], row["first_warning"]) for row in rows])
        self.assertIn("2 valid (1 of them with warnings)\n", run.stdout)

    def test_no_formulas(self):
        """Also in names and values from a table of decks; numbers stay numbers."""
        self.decks("=1+1.dat", "b.dat")
        (self.place / "list.csv").write_text("deck,+a\n=1+1.dat,@SUM(1)\nb.dat,-1.5\n")
        self.run_it(0, "--list", "list.csv", "-o", "out")
        rows = self.table()
        self.assertEqual([("./=1+1.dat", "'@SUM(1)"), ("b.dat", "-1.5")], [(row["deck"], row["'+a"]) for row in rows])

    def test_a_row_a_deck_in_the_order_of_the_list(self):
        self.decks("b.dat", "a.dat", "c_rejected.dat")
        run = self.run_it(1, "b.dat", "c_rejected.dat", "a.dat", "missing.dat", "-o", "out", "-j", "2")
        rows = self.table()
        self.assertEqual(["b.dat", "c_rejected.dat", "a.dat", "missing.dat"], [row["deck"] for row in rows])
        self.assertEqual(["valid", "rejected", "valid", "refused"], [row["status"] for row in rows])
        self.assertEqual(["0", "2", "0", "3"], [row["exit_status"] for row in rows])
        self.assertEqual("c_rejected.dat:77:1-4: the body of GRID 101 has 1 unconstrained rigid-body mode: it can translate along (0.0, 1.000)", rows[1]["message"])
        self.assertEqual("missing.dat: no such file", rows[3]["message"])
        self.assertIn("4 decks in ", run.stdout)
        self.assertIn("2 valid, 1 refused, 1 rejected", run.stdout)
        self.assertIn("\n  c_rejected.dat: rejected: c_rejected.dat:77:1-4: the body", run.stdout)
        self.assertIn("\n  missing.dat: refused: no such file", run.stdout)

    def test_load_cases(self):
        """One row per case; a deck without cases has one row, without a number."""
        cards = SMALL.read_text().split("BEGIN BULK")[1]
        (self.place / "cases.dat").write_text(f"SUBCASE 7\nLOAD = 1\nSUBCASE 3\nLOAD = 99\nBEGIN BULK\nLOAD,99,-1.0,1.0,1{cards}")
        self.decks("plain.dat")
        for options in [], ["--one-table"]:
            with self.subTest(options):
                run = self.run_it(1, "cases.dat", "plain.dat", "-o", "out", *options)
                rows = self.table("out")
                self.assertEqual([(row["subcase"], row["status"]) for row in rows], [("7", "valid"), ("3", "no equilibrium"), ("", "valid")])
                self.assertEqual([row["p_max"] == rows[2]["p_max"] for row in rows], [True, False, True])
                self.assertIn("2 decks, 3 load cases in ", run.stdout)
                self.assertIn("cases.dat SUBCASE 3: no equilibrium: the load moves the body of GRID 1", run.stdout)

    def test_sequences(self):
        """A load case in which the last contact opens has results and exit status 0; those after it have rows without results."""
        text = (ROOT / "input/hertz/hertz330_unloaded.dat").read_text().replace("LOAD    12      1.      .001 ", "LOAD    12      1.      -.1  ")
        (self.place / "three.dat").write_text(text)
        (self.place / "two.dat").write_text(text.partition("SUBCASE 3")[0] + "BEGIN BULK" + text.partition("BEGIN BULK")[2])
        for options in [], ["--one-table"]:
            with self.subTest(options):
                run = self.run_it(1, "two.dat", "three.dat", "-o", "out", *options)
                rows = self.table("out")
                self.assertEqual([(row["subcase"], row["status"]) for row in rows],
                                 [("1", "valid"), ("2", "contact lost"), ("1", "valid"), ("2", "contact lost"), ("3", "not solved")])
                self.assertEqual([bool(row["p_max"]) for row in rows], [True, True, True, True, False])
                self.assertIn("two.dat SUBCASE 2: contact lost: no contact is left after load factor 0.9062", run.stdout)
                self.assertIn("three.dat SUBCASE 3: not solved: it starts from the end", run.stdout)
        self.run_it(0, "two.dat", "-o", "lost")

    def test_titles_and_warnings_of_load_cases(self):
        """SUBTITLE and LABEL, those above the first SUBCASE for all; a warning of a case is in its row, even if the deck has only notes."""
        cards = SMALL.read_text().split("BEGIN BULK")[1]
        (self.place / "cases.dat").write_text("LABEL = of all\nSUBCASE 7\nSUBTITLE = first, of two\nLOAD = 1\nSUBCASE 3\nlabel=heavy\nLOAD = 99\nBEGIN BULK\n"
                                              f"LOAD,99,4000.0,1.0,1\nFORCE,77,41,,1.0,0.0,1.0{cards}")
        for options in [], ["--one-table"]:
            self.run_it(0, "cases.dat", "-o", "out", *options)
            rows = self.table()
            self.assertEqual([(row["subtitle"], row["label"]) for row in rows], [("first, of two", "of all"), ("", "heavy")])
            self.assertEqual([row["first_warning"].partition(":")[0] for row in rows], ["", "warning"])

    def test_half_width_and_approach(self):
        """The zone with the largest pressure; all approaches in one column; also with one table."""
        deck = self.deck("roller.dat", ROOT / "input" / "hertz" / "hertz_ctria6.dat")
        renamed = re.sub(r"(?m)^(SUPORT +|RBE2 +\d+ +|FORCE +\d+ +)41 ", r"\g<1>43 ", SMALL.read_text()).replace("      43      44", "      41      44")
        (self.place / "other.dat").write_text(renamed)
        self.decks("small.dat")
        for options in [], ["--one-table"]:
            self.run_it(0, deck, "other.dat", "small.dat", "-o", "out", *options)
            rows = self.table()
            self.assertEqual([row["approach_dof"] for row in rows][1:], ["43 2", "41 2"])
            self.assertEqual(rows[1]["approach"][:10], rows[2]["approach"][:10])
            self.assertEqual((rows[2]["half_width"], rows[2]["half_width_error"][:3]), ("2.35958E-02", "0.4"))
            self.assertGreater(float(rows[0]["half_width"]), 0.0)

    def test_figures_are_those_of_the_summary(self):
        self.decks("a.dat")
        self.run_it(0, "a.dat", "-o", "out")
        row = self.table()[0]
        summary = dict(line.split(",")[:2] for line in (self.place / "out" / "a.summary.csv").read_text().splitlines())
        self.assertEqual("49", row["nodes"])
        self.assertEqual(summary["max_pressure"], row["p_max"])
        self.assertEqual(summary["approach_41_2"], row["approach"])
        error = float(summary["mesh_error_max_pressure"]) / float(summary["max_pressure"])
        self.assertAlmostEqual(error, float(row["p_max_error"]), delta=5e-3 * error)
        self.assertLess(float(row["certificate_part"]), 1)
        self.assertGreater(float(row["seconds"]), 0)

    def test_a_pressure_without_limit(self):
        self.decks("a.dat")
        deck = self.deck("b.dat", ROOT / "input" / "flat_punch" / "flat_punch.dat")
        self.run_it(0, "a.dat", deck, "-o", "out")
        self.assertEqual(["bounded", "singular"], [row["p_max_is"] for row in self.table()])

    def test_the_worst_figure_is_relative_to_its_tolerance(self):
        deck = self.deck("a.dat", ROOT / "input" / "hertz" / "hertz44.dat")
        self.run_it(0, deck, "-o", "out")
        summary = dict(line.split(",")[:2] for line in (self.place / "out" / "a.summary.csv").read_text().splitlines())
        row = self.table()[0]
        self.assertEqual("stress error", row["certificate"])
        self.assertAlmostEqual(float(summary["stress_off_curve"]) / 0.1, float(row["certificate_part"]), delta=5e-3)   # two digits

    def test_memory_of_a_large_deck(self):
        deck = self.deck("a.dat", ROOT / "input" / "pin_in_hole" / "pin_in_hole.dat")
        self.run_it(0, deck, "-o", "out")
        memory = self.table()[0]["memory_MB"]
        self.assertTrue(memory == "" or 15 < float(memory) < 5000, memory)   # unknown below Python's own memory

    def test_memory_limit_is_passed_on(self):
        self.deck("a.dat", ROOT / "input" / "pin_in_hole" / "pin_in_hole.dat")
        self.run_it(1, "a.dat", "-o", "out", "--memory", "0.0001")
        self.assertIn("--memory allows", self.table()[0]["message"])

    def test_same_bytes_as_alone(self):
        self.decks(*(f"d{k}.dat" for k in range(6)))
        self.run_it(0, *(f"d{k}.dat" for k in range(6)), "-o", "out", "-j", "3")
        subprocess.run([PROGRAM, SMALL, "-o", self.place / "alone"], check=True, stdout=subprocess.DEVNULL)
        wanted = (self.place / "alone" / "hertz44_elastic.lst").read_bytes()
        for k in range(6):
            self.assertEqual(wanted, (self.place / "out" / f"d{k}.lst").read_bytes())


class Places(Case):
    def test_equal_names_are_kept_apart(self):
        self.decks("one/a.dat", "two/deep/a.dat", "two/b.dat")
        self.run_it(0, "one/a.dat", "two/deep/a.dat", "two/b.dat", "-o", "out")
        found = sorted(str(path.relative_to(self.place / "out")) for path in (self.place / "out").rglob("*.lst"))
        self.assertEqual(["one/a.lst", "two/b.lst", "two/deep/a.lst"], found)

    def test_a_deck_named_twice_runs_once(self):
        self.decks("a.dat", "b.dat")
        self.run_it(0, "a.dat", "./a.dat", self.place / "a.dat", "b.dat", "-o", "out", "--program", self.fake)
        self.assertEqual(["a.dat", "b.dat"], self.calls())
        self.assertEqual(["a.dat", "b.dat"], [row["deck"] for row in self.table()])

    def test_two_decks_of_one_stem_in_one_folder(self):
        self.decks("a.dat", "a.bdf")
        run = self.run_it(3, "a.dat", "a.bdf", "-o", "out")
        self.assertIn("a.dat and a.bdf would write the same files", run.stderr)
        self.assertFalse((self.place / "out").exists())

    def test_names_that_mislead(self):
        """No cell is taken for a formula by a spreadsheet, and no name breaks a line of the screen."""
        names = ["=1+1.dat", "+a.dat", "@b.dat", "rejected\n  c.dat: valid"]
        self.decks(*names)
        run = self.run_it(1, *names, "-o", "out")
        self.assertEqual(["./=1+1.dat", "./+a.dat", "./@b.dat", "rejected\n  c.dat: valid"], [row["deck"] for row in self.table()])
        self.assertEqual(["valid"] * 3 + ["rejected"], [row["status"] for row in self.table()])
        self.assertIn("\n  rejected\\n  c.dat: valid: rejected: ", run.stdout)

    def test_odd_names(self):
        names = ["-x.dat", "with blank.dat", "comma,\"quote.dat", "ünïcode.dat", "a.b.dat", "no_suffix"]
        self.decks(*names)
        (self.place / "list").write_text("\n".join(names) + "\n")
        self.run_it(0, "--list", "list", "-o", "out dir")
        self.assertEqual(["valid"] * 6, [row["status"] for row in self.table("out dir")])
        self.assertTrue((self.place / "out dir" / "a.b.lst").exists())


class Lists(Case):
    def test_comments_and_folders(self):
        self.decks("sub/a.dat", "sub/b.dat")
        (self.place / "sub" / "list").write_text("# a comment\n\n  a.dat  \n$ another\nb.dat")
        self.run_it(0, "--list", "sub/list", "-o", "out")
        self.assertEqual({"sub/a.dat": "valid", "sub/b.dat": "valid"}, self.words())

    def test_a_table_hands_its_columns_on(self):
        self.decks("sub/a.dat", "sub/b.dat")
        (self.place / "sub" / "list.csv").write_text("\ufeffdeck,young,note\na.dat,1.5,\"x, y\"\nb.dat,2.5,\n")
        self.run_it(0, "--list", "sub/list.csv", "-o", "out")
        self.assertEqual([("1.5", "x, y", "valid"), ("2.5", "", "valid")],
                         [(row["young"], row["note"], row["status"]) for row in self.table()])

    def test_a_table_keeps_every_row(self):
        """A deck in several rows runs once; each row has its answer, in the order of the table."""
        self.decks("sub/a.dat", "sub/b.dat", "sub/rejected.dat")
        (self.place / "sub" / "list.csv").write_text("case,deck\n1,a.dat\n2,b.dat\n3,./a.dat\n4,rejected.dat\n5,rejected.dat\n")
        run = self.run_it(1, "--list", "sub/list.csv", "-o", "out", "--program", self.fake)
        wanted = [("1", "sub/a.dat", "valid"), ("2", "sub/b.dat", "valid"), ("3", "sub/a.dat", "valid"), ("4", "sub/rejected.dat", "rejected"),
                  ("5", "sub/rejected.dat", "rejected")]
        self.assertEqual(wanted, [(row["case"], row["deck"], row["status"]) for row in self.table()])
        rows = self.table()
        self.assertEqual({**rows[0], "case": "3"}, rows[2])
        self.assertEqual(["a.dat", "b.dat", "rejected.dat"], self.calls())
        self.assertRegex(run.stdout, r"^3 decks in \S+ s: 2 valid, 1 rejected\n  sub/rejected.dat: rejected: .*\nout/batch.csv ")
        self.run_it(1, "--list", "sub/list.csv", "-o", "out", "--program", self.fake, "--resume")
        self.assertEqual(wanted, [(row["case"], row["deck"], row["status"]) for row in self.table()])
        self.assertEqual(["rejected.dat"], self.calls())

    def test_bad_lists(self):
        for name, text, words in (("empty", "# nothing\n", "no deck in the list"), ("binary", "a.dat\nb\0.dat\n", "binary:2: not a text"),
                                  ("a.csv", "name\nx\n", "a.csv:1: no column `deck`: add it"),
                                  ("b.csv", "deck,x\na.dat\n", "b.csv:2: wrong number of values: give 2, one per column"), ("c.csv", "deck,status\na.dat,1\n", "column status"),
                                  ("d.csv", "deck,x\n,1\n", "d.csv:2: the deck has no name: give one")):
            with self.subTest(name):
                (self.place / name).write_text(text)
                self.assertIn(words, self.run_it(3, "--list", name, "-o", "out").stderr)
                self.assertFalse((self.place / "out").exists())
        self.assertIn("missing: the list cannot be read", self.run_it(3, "--list", "missing", "-o", "out").stderr)

    def test_usage(self):
        self.decks("a.dat")
        for arguments in ([], ["a.dat"], ["-o", "out"], ["a.dat", "--list", "x", "-o", "out"], ["a.dat", "-o", "out", "-j", "0"],
                          ["a.dat", "-o", "out", "-j", "x"], ["a.dat", "-o", "out", "--seconds", "0"], ["a.dat", "-o", "out", "--chunk", "2"],
                          ["a.dat", "-o", "out", "--seconds", "nan"], ["a.dat", "-o", "out", "--memory", "-1"], ["--collect", "out"],
                          ["a.dat", "-o", "out", "--resum"], ["a.dat", "-o", "out", "--partition=x"], ["a.dat", "-o", "out", "--slurm", "-p"]):
            with self.subTest(arguments):
                self.assertIn("tools/batch: ", self.run_it(3, *arguments).stderr)
        for words, right in ((["--slurm", "--partition", "short", "a.dat"], "--partition short: write options of sbatch as --name=value"),
                             (["--slurm", "-p", "short", "a.dat"], "-p short: write options of sbatch as --name=value"),
                             (["--collect", "out", "-j", "2"], "--collect DIR with -j 2: use it only with --no-wait"),
                             (["--collect=out", "a.dat", "--resume"], "--collect DIR with a.dat --resume"),
                             (["--collect", "out", "--partition=short"], "--collect DIR with --partition=short: use it only with --no-wait")):
            with self.subTest(words):
                self.assertIn(right, self.run_it(3, *words, "-o", "out").stderr if "--collect" not in words[0] else self.run_it(3, *words).stderr)
        self.assertIn("no such program: run tools/build", self.run_it(3, "a.dat", "-o", "out", "--program", "nowhere").stderr)
        self.assertIn("give a working epcont", self.run_it(3, "a.dat", "-o", "out", "--program", "/bin/false").stderr)
        self.assertIn("give a working epcont", self.run_it(3, "a.dat", "-o", "out", "--program", "/bin/true").stderr)
        self.assertIn("cannot be written", self.run_it(3, "a.dat", "-o", "a.dat").stderr)

    def test_an_invalid_plan(self):
        (self.place / "out" / ".batch").mkdir(parents=True)
        for text in ("{}", "[]", "{\"decks\": [3]}", '{"decks": [["a.dat", "a", {"x": "1"}, 9]]}', "\0"):
            (self.place / "out" / ".batch" / "plan.json").write_text(text)
            self.assertIn("start the batch again", self.run_it(3, "--collect", "out").stderr)

    def test_bytes_of_another_encoding(self):
        """Arguments are passed on unchanged."""
        self.decks("a.dat")
        (self.place / "list.csv").write_bytes(b"deck,note\na.dat,Gr\xf6\xdfe\n")
        self.run_it(0, "--list", "list.csv", "-o", "out")
        self.assertIn(b",Gr\xf6\xdfe,", (self.place / "out" / "batch.csv").read_bytes())


class Misbehaving(Case):
    def test_a_full_disk(self):
        """The run is reported with its status; the table is complete."""
        self.decks(*(f"d{k}.dat" for k in range(12)))
        small = self.place / "small"
        small.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=48k", "tmpfs", small], capture_output=True).returncode:
            self.skipTest("no right to mount")
        try:
            run = self.run_it(3, *(f"d{k}.dat" for k in range(12)), "-o", "small/out")
            self.assertIn("cannot be written", run.stderr)
            self.assertEqual(12, len(self.table("small/out")))
        finally:
            subprocess.run(["umount", small], check=True)

    def test_one_that_fails_stops_no_other(self):
        names = ["segfault.dat", "killed.dat", "ended.dat", "hangs.dat", "deaf.dat", "half.dat", "silent.dat", "strange.dat", "chatter.dat", "lies.dat", "cut.dat",
                 "a.dat", "b.dat"]
        self.decks(*names)
        run = self.run_it(1, *names, "-o", "out", "-j", "2", "--seconds", "3", "--program", self.fake)
        self.assertEqual({"segfault.dat": "crashed", "killed.dat": "killed", "ended.dat": "killed", "hangs.dat": "timed out", "deaf.dat": "timed out",
                          "half.dat": "incomplete", "silent.dat": "incomplete", "strange.dat": "internal error", "chatter.dat": "rejected",
                          "lies.dat": "incomplete", "cut.dat": "incomplete", "a.dat": "valid", "b.dat": "valid"}, self.words())
        self.assertIn("segfault.dat: crashed: by SIGSEGV", run.stdout)
        self.assertIn("ended.dat: killed: by SIGTERM", run.stdout)
        self.assertIn("hangs.dat: timed out: no end within 3 s", run.stdout)
        self.assertIn("strange.dat: internal error: exit status 77", run.stdout)
        self.assertIn("chatter.dat: rejected: a line of chatter 0\n", run.stdout)
        self.nothing_runs()

    def test_small_decks_share_a_process_and_bad_ones_run_alone(self):
        names = [f"d{k:02d}.dat" for k in range(60)]
        names[5:5] = ["segfault.dat", "half.dat", "a_rejected.dat", "strange.dat", "killed.dat"]
        names[20:20] = ["full.dat"]
        names[40:40] = ["b_rejected.dat", "hangs.dat", "other/segfault.dat", "missing.dat"]
        self.decks(*(name for name in names if name != "missing.dat"))
        (self.place / "list").write_text("\n".join(names))
        self.run_it(1, "--list", "list", "-o", "out", "--seconds", "2", "--program", self.fake)
        words = {"segfault": "crashed", "half": "incomplete", "a_rejected": "rejected", "strange": "internal error", "killed": "killed",
                 "b_rejected": "rejected", "hangs": "timed out", "full": "refused", "missing": "refused"}
        rows = self.table()
        self.assertEqual(names, [row["deck"] for row in rows])
        self.assertEqual([words.get(os.path.basename(name)[:-4], "valid") for name in names], [row["status"] for row in rows])
        self.assertEqual(["2"] * 2, [row["exit_status"] for row in rows if row["status"] == "rejected"])
        self.assertIn("a_rejected.dat:77:1-4: ", rows[7]["message"])
        called = self.calls()
        self.assertLess(called.count("d00.dat"), 3)
        self.assertEqual([], [name for name in names if os.path.basename(name) not in called])

    def test_shared_processes_give_the_same_bytes(self):
        names = [f"d{k:02d}.dat" for k in range(30)]
        self.decks(*names)
        self.run_it(0, *names, "-o", "out", "--program", self.fake)
        self.assertEqual(names, self.calls())
        self.run_it(0, "d07.dat", "-o", "alone")
        for suffix in (".lst", ".summary.csv", ".contact.csv", ".history.csv"):
            wanted = (self.place / "alone" / f"d07{suffix}").read_bytes()
            self.assertEqual([], [name for name in names if (self.place / "out" / (name[:-4] + suffix)).read_bytes() != wanted])

    def test_one_table(self):
        """All values of the summaries are columns, for valid and other answers; the only other files are listings, the same as without the option."""
        names = [f"d{k:02d}.dat" for k in range(20)]
        self.decks(*names, "z_rejected.dat")
        apart = self.deck("apart.dat", ROOT / "input" / "faults" / "pulled_apart.dat")
        self.run_it(1, *names, "z_rejected.dat", apart, "-o", "out", "--one-table", "--program", self.fake)
        rows = self.table()
        self.run_it(0, "d07.dat", "-o", "alone")
        summary = [line.split(",")[:2] for line in (self.place / "alone" / "d07.summary.csv").read_text().splitlines()[1:]]
        self.assertGreater(len(summary), 30)
        own = {"status": "status", "warnings": "warnings", "max_pressure": "p_max", "max_pressure_is": "p_max_is"}
        self.assertEqual([value for _, value in summary], [rows[7][own.get(key, f"summary_{key}")] for key, _ in summary])
        self.assertEqual(["rejected", "no equilibrium"], [row["status"] for row in rows[-2:]])
        self.assertEqual({""}, {value for key, value in rows[-2].items() if key.startswith("summary_")})
        self.assertEqual("0", rows[-1]["summary_notes"])
        self.assertEqual(sorted([name[:-4] + ".lst" for name in names] + ["apart.lst", "batch.csv"]),
                         sorted(path.name for path in (self.place / "out").iterdir() if path.is_file()))
        self.assertEqual((self.place / "alone" / "d07.lst").read_bytes(), (self.place / "out" / "d07.lst").read_bytes())

    def test_one_table_and_many_do_not_mix(self):
        self.decks("a.dat", "b.dat")
        for options in ((), ("--one-table",), ()):
            (self.place / "calls").unlink(missing_ok=True)
            self.run_it(0, "a.dat", "b.dat", "-o", "out", "--resume", "--program", self.fake, *options)
            self.assertEqual(["a.dat", "b.dat"], self.calls())

    def test_a_deck_that_changes_while_others_run(self):
        """The digest recorded is that of the file as it was run."""
        from batching.decks import Deck, fingerprint, inputs_of, look_at
        deck = Deck(str(self.deck("a.dat")))
        look_at(deck)
        self.assertEqual(fingerprint(deck.path), (deck.digest, deck.size))
        self.assertEqual(deck.digest, inputs_of(deck))
        (self.place / "a.dat").write_text(SMALL.read_text() + "$\n")
        self.assertEqual(fingerprint(deck.path)[0], inputs_of(deck))
        self.assertNotEqual(deck.digest, inputs_of(deck))
        (self.place / "b.dat").write_text("INCLUDE 'a.dat'\n")
        including = Deck(str(self.place / "b.dat"))
        look_at(including)
        self.assertEqual("", including.digest)   # a change of an included file may go unnoticed

    def test_warnings_are_no_faults(self):
        said = "a.dat:3:9-16: warning: a remark\n  GRID 1\n  ^^^^\na.dat:5:1-4: unknown card\n  GRIT 1\na.dat:9: later\n"
        self.assertEqual("a.dat:5:1-4: unknown card", first_fault(said))
        self.assertEqual("", first_fault("a.dat:3:9: warning: a remark\n  GRID 1\na.dat: 1 warning\n"))
        self.assertEqual("a.dat: not to be trusted", first_fault("a.dat: warning: no place\na.dat: 30 warnings (20 shown)\na.dat: not to be trusted\n"))

    def test_results_of_an_earlier_run_are_not_taken(self):
        self.decks("a_silent.dat")
        self.run_it(0, "a_silent.dat", "-o", "out")
        self.run_it(1, "a_silent.dat", "-o", "out", "--program", self.fake)
        self.assertEqual({"a_silent.dat": "incomplete"}, self.words())


class Resumed(Case):
    def again(self, status, *arguments):
        self.run_it(status, "--list", "list", "-o", "out", "--resume", "--program", self.fake, *arguments)
        return self.calls()

    def setUp(self):
        super().setUp()
        self.decks("a.dat", "b.dat", "c_rejected.dat", "d_segfault.dat")
        self.deck("e.dat", ROOT / "input" / "faults" / "pulled_apart.dat")
        (self.place / "list").write_text("a.dat\nb.dat\nc_rejected.dat\nd_segfault.dat\ne.dat\n")
        self.first = self.again(1)

    def test_decks_with_a_listing_are_kept(self):
        self.assertEqual(["a.dat", "b.dat", "c_rejected.dat", "d_segfault.dat", "e.dat"], self.first)
        before = self.table()
        self.assertEqual(["c_rejected.dat", "d_segfault.dat"], self.again(1))
        self.assertEqual([before[k] for k in (0, 1, 4)], [self.table()[k] for k in (0, 1, 4)])
        self.assertEqual("no equilibrium", before[4]["status"])

    def test_a_changed_deck_runs(self):
        path = self.place / "a.dat"
        times = path.stat()
        path.write_bytes(path.read_bytes().replace(b"20400.", b"20500."))
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))   # a copy may be older than the listing, and differ
        self.assertEqual(["a.dat", "c_rejected.dat", "d_segfault.dat"], self.again(1))

    def test_a_touched_deck_does_not(self):
        (self.place / "a.dat").touch()
        self.assertEqual(["c_rejected.dat", "d_segfault.dat"], self.again(1))

    def test_a_cut_or_missing_listing_runs(self):
        listing = self.place / "out" / "a.lst"
        listing.write_bytes(listing.read_bytes()[:-20])
        (self.place / "out" / "b.lst").unlink()
        self.assertEqual(["a.dat", "b.dat", "c_rejected.dat", "d_segfault.dat"], self.again(1))

    def test_another_version_runs(self):
        self.fake.write_text(self.fake.read_text().replace(f'exec "{PROGRAM}" --version', "{ echo epcont 9.9; exit 0; }", 1))
        self.assertEqual(5, len(self.again(1)))

    def test_another_build_of_the_version_runs(self):
        """A copy elsewhere, of any age, is the same program; other bytes are another one."""
        self.fake = self.fake.rename(self.place / "moved")
        os.utime(self.fake)
        self.assertEqual(["c_rejected.dat", "d_segfault.dat"], self.again(1))
        with open(self.fake, "a") as file:
            file.write("# built again\n")
        self.assertEqual(5, len(self.again(1)))

    def test_without_resume_all_run(self):
        self.run_it(1, "--list", "list", "-o", "out", "--program", self.fake)
        self.assertEqual(5, len(self.calls()))

    def test_a_changed_include_runs(self):
        for path in (ROOT / "input" / "include").glob("*.*"):
            self.deck(path.name, path)
        included = list((ROOT / "input" / "include").glob("*.inc"))
        self.assertTrue(included)
        (self.place / "list").write_text("a.dat\npatch_case.dat\n")
        self.assertEqual(["patch_case.dat"], self.again(0))
        self.assertEqual([], self.again(0))
        for path in included:
            with open(self.place / path.name, "a") as file:
                file.write("$ a remark\n")
        self.assertEqual(["patch_case.dat"], self.again(0))

    def test_a_journal_that_was_cut_off(self):
        kept, here = (self.place / "out" / ".batch" / f"{name}.journal" for name in ("kept", "here"))
        text = here.read_bytes()
        here.write_bytes(text[:text.rindex(b'"row"') + 30])   # the end record of the last deck, in its middle
        self.assertEqual(3, len(self.again(1)))
        self.assertEqual(2, len(kept.read_text().splitlines()))
        self.assertEqual(["c_rejected.dat", "d_segfault.dat"], self.again(1))


class StoppedBatch(Case):
    def begin(self, *arguments):
        names = ["a.dat", "b.dat", "hangs.dat", "z.dat"]
        self.decks(*names)
        process = subprocess.Popen(self.command("batch", *names, "-o", "out", "--program", self.fake, *arguments), cwd=self.place,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        until = time.monotonic() + 60
        while not (self.place / "pids").exists() and time.monotonic() < until:
            time.sleep(0.02)
        return process

    def test_sigint_and_sigterm(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number):
                process = self.begin()
                process.send_signal(number)
                said, errors = process.communicate(timeout=30)
                self.assertEqual(128 + number, process.returncode, errors)
                self.nothing_runs()
                words = self.words()
                self.assertEqual(["a.dat", "b.dat", "hangs.dat", "z.dat"], list(words))
                self.assertEqual("not run", words["hangs.dat"])
                self.assertIn("not run", said)
                self.calls()
                (self.place / "pids").unlink()
                (self.place / "calm").write_text("")
                self.run_it(0, *words, "-o", "out", "--resume", "--program", self.fake)
                ended = [name for name, word in words.items() if word == "valid"]
                self.assertEqual(sorted(set(words) - set(ended)), self.calls())
                (self.place / "calm").unlink()

    def test_sigkill_leaves_a_whole_table_and_finished_decks(self):
        """All decks except the hanging one have ended; the batch is killed immediately, its children are not."""
        process = self.begin("-j", "4")
        until = time.monotonic() + 60
        while len(list((self.place / "out").glob("*.history.csv"))) < 3 and time.monotonic() < until:
            time.sleep(0.02)
        time.sleep(0.3)
        process.kill()
        process.communicate()
        self.assertEqual(4, len(self.table()))
        run = self.run_it(3, "a.dat", "-o", "out", "--resume", "--program", self.fake)
        self.assertIn("another tools/batch or one of its runs is still active there", run.stderr)
        for pid in (self.place / "pids").read_text().split():
            os.killpg(int(pid), signal.SIGKILL)
        self.run_it(1, "--collect", "out")
        self.assertEqual({"a.dat": "valid", "b.dat": "valid", "hangs.dat": "not run", "z.dat": "valid"}, self.words())

    def test_two_batches_in_one_folder(self):
        process = self.begin()
        self.assertIn("another tools/batch or one of its runs is still active there", self.run_it(3, "a.dat", "-o", "out").stderr)
        process.terminate()
        process.communicate()


# Runs the tasks immediately, in sequence. (tests/slurm/run uses a real Slurm.)
SBATCH = """#!/bin/sh
cat > {folder}/script
for word; do case $word in --array=*) tasks=${{word#--array=}} ;; esac; done
echo "$@" >> {folder}/submitted
for task in $(echo "$tasks" | tr , ' '); do SLURM_ARRAY_TASK_ID=$task sh {folder}/script > /dev/null 2>&1; done
wc -l < {folder}/submitted
"""
SQUEUE = """#!/bin/sh
[ -e {folder}/answers ] && exit 0
touch {folder}/answers
exit 1
"""
SCONTROL = """#!/bin/sh
echo "JobId=1 JobState=NODE_FAIL Reason=None"
"""


class StandIn(Case):
    """A Slurm of three scripts."""

    def setUp(self):
        super().setUp()
        for name, text in (("sbatch", SBATCH), ("squeue", SQUEUE), ("scontrol", SCONTROL)):
            path = self.place / "bin" / name
            path.parent.mkdir(exist_ok=True)
            path.write_text(text.format(folder=self.place))
            path.chmod(0o755)
        self.environment = {**os.environ, "PATH": f"{self.place / 'bin'}:{os.environ['PATH']}"}

    def submit(self, status, names, *arguments):
        (self.place / "list").write_text("\n".join(names))
        run = self.run_it(status, "--list", "list", "-o", "out", "--slurm", "--program", self.fake, *arguments, env=self.environment)
        return run, (self.place / "submitted").read_text().splitlines()

    def test_killed_tasks_are_submitted_again_then_reported(self):
        names = [f"d{k}.dat" for k in range(5)] + ["killed.dat", "rejected.dat"] + [f"e{k}.dat" for k in range(5)]
        self.decks(*names)
        run, submitted = self.submit(1, names, "--chunk", "4", "--partition=short", "--mem=2G", "-j", "2")
        words = {"killed.dat": "lost", "rejected.dat": "rejected"}
        self.assertEqual({name: words.get(name, "valid") for name in names}, self.words())
        self.assertEqual(3, len(submitted))
        self.assertIn("--array=0,1,2 ", submitted[0])
        self.assertRegex(submitted[1], "--array=[012] ")
        for line in submitted:
            self.assertTrue(line.endswith("--cpus-per-task=2 --partition=short --mem=2G"), line)
        self.assertIn("killed.dat: lost: killed 3 times, last: NODE_FAIL; see out/.batch/task", run.stdout)
        self.assertIn("squeue does not answer", run.stderr)
        self.assertEqual(3, self.calls().count("killed.dat"))

    def test_none_is_lost_for_anothers_sake(self):
        """A task whose time limit expires repeatedly: each deck that takes too long ends one, then the decks after it run."""
        sbatch = self.place / "bin" / "sbatch"
        sbatch.write_text(sbatch.read_text().replace("sh " + str(self.place), "timeout 3 sh " + str(self.place)))
        (self.place / "bin" / "scontrol").write_text("#!/bin/sh\necho JobState=TIMEOUT Reason=None\n")
        names = ["hangs1.dat", "hangs2.dat", "hangs3.dat", "d1.dat", "d2.dat", "d3.dat"]
        self.decks(*names)
        run, submitted = self.submit(1, names, "--chunk", "6")
        self.assertEqual({name: "lost" if "hangs" in name else "valid" for name in names}, self.words())
        self.assertEqual(4, len(submitted))
        self.assertIn("task 0: TIMEOUT, 6 decks left; submitted again\n", run.stderr)
        self.assertIn("task 0: TIMEOUT, 3 decks left; given up after 4 times\n", run.stderr)
        self.assertIn("hangs2.dat: lost: killed 4 times, last: TIMEOUT; see out/.batch/task0.out", run.stdout)
        self.assertEqual(3, sum(name.startswith("d") for name in self.calls()))

    def test_when_a_task_is_given_up(self):
        """A cancelled task is submitted three times; also one that makes no progress."""
        for why, begun, wanted in (("TIMEOUT", [{}, {}], [False, True]), ("CANCELLED by 0", [{}, {"a": 0}], [True, True]),
                                   ("TIMEOUT", [{}, {"a": 0}, {"a": 0}], [False, False, True]), ("TIMEOUT", [{"a": 0}, {"a": 1}], [False, False]),
                                   ("TIMEOUT", [{"a": 1, "b": 1}], [True])):
            watch = Watch(None, {"jobs": [{"id": str(k), "tasks": [0]} for k in range(3)]}, "")
            self.assertEqual(wanted, [watch.given_up(0, ["a", "b"], collections.Counter(each), why) for each in begun], (why, begun))
        watch = Watch(None, {"jobs": [{"id": "1", "tasks": [0]}]}, "")
        self.assertFalse(watch.given_up(0, ["a"], collections.Counter(a=1), "CANCELLED"))

    def test_resume_submits_the_rest_only(self):
        names = [f"d{k}.dat" for k in range(6)]
        self.decks(*names)
        self.assertIn("6 decks in 3 tasks", self.submit(0, names, "--chunk", "2")[0].stderr)
        (self.place / "d3.dat").write_bytes((self.place / "d3.dat").read_bytes().replace(b"20400.", b"20500."))
        run, submitted = self.submit(0, names, "--resume")
        self.assertIn("1 deck in 1 task\n", run.stderr)
        self.assertEqual(2, len(submitted))
        self.assertEqual(2, self.calls().count("d3.dat"))
        self.submit(0, names, "--resume")
        self.assertEqual(2, len((self.place / "submitted").read_text().splitlines()))

    def test_sbatch_that_reads_no_script(self):
        """It may end before the script is written; the batch continues."""
        self.decks("a.dat")
        (self.place / "bin" / "sbatch").write_text("#!/bin/sh\nexec <&-\necho no such partition >&2\nexit 1\n")
        for _ in range(20):
            run = self.run_it(3, "a.dat", "-o", "out", "--slurm", "--program", self.fake, env=self.environment)
            self.assertEqual("tools/batch: sbatch: no such partition\n", run.stderr)

    def test_waiting_that_is_stopped(self):
        """With its own exit status; the job continues."""
        self.decks("a.dat")
        (self.place / "bin" / "sbatch").write_text("#!/bin/sh\necho 7\n")
        (self.place / "bin" / "squeue").write_text("#!/bin/sh\necho 7 0\n")
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            process = subprocess.Popen(self.command("batch", "a.dat", "-o", "out", "--slurm", "--program", self.fake), cwd=self.place, env=self.environment,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            self.assertEqual("job 7: 1 deck in 1 task\n", process.stderr.readline())
            time.sleep(0.5)
            process.send_signal(number)
            said, errors = process.communicate(timeout=30)
            self.assertEqual(128 + number, process.returncode, errors)
            self.assertIn("the job continues", errors)
            self.assertIn("1 deck in ", said)
            self.assertEqual({"a.dat": "not run"}, self.words())

    def test_no_slurm(self):
        self.decks("a.dat")
        run = self.run_it(3, "a.dat", "-o", "out", "--slurm", "--program", self.fake, env={**os.environ, "PATH": self.path_without()})
        self.assertIn("sbatch cannot be started", run.stderr)

    def path_without(self):
        """Only the shell's own tools."""
        folder = self.place / "few"
        folder.mkdir()
        for name in ("sh", "cat", "env"):
            os.symlink(f"/bin/{name}", folder / name)
        return str(folder)


if __name__ == "__main__":
    unittest.main(verbosity=2)   # shows why a test is skipped
