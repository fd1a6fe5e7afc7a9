"""Messages of tools for wrong options, for missing, empty, binary or other files, and for folders that cannot be written.

The exit status is not 0, there is no traceback, and the message names the fault.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import common
from common import ROOT

PROGRAM = str(pathlib.Path(os.environ["EPCONT_PROGRAM"]).resolve())
DECK = ROOT / "input" / "hertz" / "hertz44.dat"
BINARY = bytes(range(255, -1, -1)) * 8


class Case(common.Case):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.kept.cleanup)
        subprocess.run([PROGRAM, DECK, "-o", cls.kept.name, "--tables", "all", "--quiet"], check=True)

    def setUp(self):
        super().setUp()
        shutil.copytree(self.kept.name, self.place / "out")
        shutil.copy(DECK, self.place)
        (self.place / "folder").mkdir()
        (self.place / "empty.dat").write_bytes(b"")
        (self.place / "binary.dat").write_bytes(BINARY)

    def refused(self, tool, arguments, status, words):
        with self.subTest(tool=tool, arguments=arguments):
            run = subprocess.run([sys.executable, "-B", ROOT / "tools" / tool, *arguments.split()], cwd=self.place, capture_output=True, text=True,
                                 timeout=60)
            self.assertEqual(status, run.returncode, run.stdout + run.stderr)
            self.assertNotIn("Traceback", run.stderr)
            self.assertIn(words, run.stderr)


class Calls(Case):
    def test_usage(self):
        for tool, status in (("batch", 3), ("sweep", 3), ("paraviews.py", 2), ("compare", 2), ("decks", 2), ("verify", 2), ("accept", 2)):
            self.refused(tool, "", status, "--list FILE" if tool == "batch" else "required")
            self.refused(tool, "a b c d --nonsense", status, "")
            run = subprocess.run([sys.executable, "-B", ROOT / "tools" / tool, "--help"], capture_output=True, text=True)
            self.assertEqual((0, ""), (run.returncode, run.stderr), tool)
            self.assertIn("usage: ", run.stdout)

    def test_help_needs_no_package(self):
        for tool in ("plots.py", "paraviews.py"):
            run = subprocess.run([sys.executable, "-S", "-B", ROOT / "tools" / tool, "--help"], capture_output=True, text=True)
            self.assertEqual((0, ""), (run.returncode, run.stderr), tool)
            self.assertIn("usage: ", run.stdout)

    def test_closed_pipe(self):
        """A closed pipe ends a tool silently."""
        for tool in ("accept", "batch", "compare", "deceive", "decks", "fuzz", "mutate", "sweep", "verify", "convergence.py", "paraviews.py", "plots.py", "tradeoffs.py"):
            for arguments in ("--help",), ("hertz44.dat", "out"):
                if arguments[0] == "--help" or tool == "verify":
                    reader, writer = os.pipe()
                    os.close(reader)
                    run = subprocess.run([sys.executable, "-B", ROOT / "tools" / tool, *arguments], cwd=self.place, stdout=writer, stderr=subprocess.PIPE, text=True)
                    os.close(writer)
                    self.assertNotRegex(run.stderr, "(?i)broken ?pipe", tool)
                    if "ModuleNotFoundError" not in run.stderr:   # packages that tools/make_venv provides
                        self.assertEqual((run.stderr, run.returncode), ("", -signal.SIGPIPE), tool)

    def test_paraview(self):
        for near in ("0,0", "0,0,1,2", "x", ",,", "0,0,-1", "0,0,nan", "inf,0,1"):
            self.refused("paraviews.py", f"hertz44.dat --near {near}", 2, f"--near: '{near}': three numbers and commas")
        for scale in ("x", "nan", "0"):
            self.refused("paraviews.py", f"hertz44.dat --scale {scale}", 2, f"--scale: '{scale}': a number above zero")
        for name in ("x", "x.pdf"):
            self.refused("paraviews.py", f"hertz44.dat -o {name}", 2, f"-o {name}: not a PNG file: give a name that ends in .png")

    def test_decks(self):
        for arguments, words in (("hertz x", "x: give a whole number of at least 90"), ("hertz 0 -o h.dat", "0: give a whole number of at least 90"),
                                 ("hertz --plastic --increments 1", "1: give a whole number of at least 2"),
                                 ("hertz --increments 8", "--increments: elastic bodies have no memory: add --plastic"),
                                 ("hertz --spacing 0 -o h.dat", "0: give a number above 0"), ("hertz --spacing nan -o h.dat", "nan: give a number above 0"),
                                 ("hertz --spacing 100 -o h.dat", "hertz: these parameters give no mesh"),
                                 ("hertz 330 -o folder", "folder: cannot be written: Is a directory"),
                                 ("tube -n 0 -o h.dat", "0: give a whole number of at least 1"), ("tube --young 1e400 -o h.dat", "1e400: give a number above 0"),
                                 ("tube --inner 2 --outer 1 -o h.dat", "give an inner radius below the outer one"),
                                 ("tube -o hertz44.dat/h.dat", "hertz44.dat: cannot be written: File exists"),
                                 ("block -n 0 -o h.dat", "0: give a whole number of at least 1"), ("ball --part 3 -o h.dat", "ball: these parameters give no mesh"),
                                 ("gears --z1 0 -o h.dat", "0: give a whole number of at least 1"), ("gears --load nan -o h.dat", "nan: give a number"),
                                 ("pin_in_lug --half 120 -o h.dat", "half 120: give an angle above 0 and below 84.8")):
            self.refused("decks", arguments, 2, words)
        self.assertFalse((self.place / "h.dat").exists())


class Verify(Case):
    def spoil(self, table, text):
        path = self.place / "out" / f"hertz44.{table}.csv"
        whole = path.read_bytes()
        path.write_bytes(text(whole) if callable(text) else text)
        return path, whole

    def test_decks(self):
        for deck, words in (("missing.dat", "missing.dat: No such file"), ("folder", "folder: Is a directory"), ("empty.dat", "empty.dat: not understood: no ENDDATA"),
                            ("binary.dat", "binary.dat: not understood: no ENDDATA")):
            self.refused("verify", f"{deck} out", 2, f"tools/verify: {words}")

    def test_tables(self):
        self.refused("verify", "hertz44.dat folder", 2, "folder/hertz44.summary.csv: No such file or directory: write the tables with epcont hertz44.dat -o folder --tables all")
        self.refused("verify", "hertz44.dat empty.dat", 2, "empty.dat/hertz44.summary.csv: Not a directory")
        for table, text, words in (("nodes", BINARY, "the line is incomplete"), ("nodes", b"", "no node 1: the table is incomplete or of another deck"),
                                   ("nodes", lambda whole: b"\n".join(whole.split(b"\n")[:20]), "no node 20: "),
                                   ("nodes", lambda whole: whole[:1500], "the line is incomplete"), ("nodes", lambda whole: whole.replace(b"ux", b"vx", 1), ":2: ux: no such column"),
                                   ("elements", lambda whole: b"\n".join(whole.split(b"\n")[:9]), "no element 9: "),
                                   ("contact", lambda whole: b"\n".join(whole.split(b"\n")[:5]), "no pair 305: "),
                                   ("summary", lambda whole: whole.replace(b"max_pressure,", b"max_pressure,x", 1), "max_pressure: 'x")):
            path, whole = self.spoil(table, text)
            self.refused("verify", "hertz44.dat out", 2, words)
            path.write_bytes(whole)


if __name__ == "__main__":
    unittest.main()
