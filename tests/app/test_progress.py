"""Progress and timing: who sees them, that they disappear, and that they do not affect results."""
import os
import pathlib
import pty
import select
import subprocess
import tempfile
import time
import unittest

PROGRAM, ROOT = os.environ["EPCONT_PROGRAM"], pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])
YIELDING = ROOT / "input" / "hertz" / "hertz44.dat"
ELASTIC = ROOT / "input" / "hertz" / "hertz44_elastic.dat"
REJECTED = ROOT / "input" / "faults" / "no_suport.dat"
STAGES = ["reading", "model", "plan", "numbering", "stiffness", "factor", "flexibility", "contact", "displacements", "yielding",
          "stresses", "certificate", "accuracy", "writing"]
TIME = r"\d+ s"
SOLVE = rf"{TIME}, iteration \d+, load factor \d\.\d+, change \S+( \S+)?, yielded \d+, in contact \d+"


class Case(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.place = pathlib.Path(directory.name)

    def run_it(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, cwd=self.place)

    def on_terminal(self, *arguments, columns=None, both=False):
        """Status, standard output and everything that a terminal on standard error (or on both) receives."""
        master, slave = pty.openpty()
        if columns:
            import fcntl
            import struct
            import termios
            fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        run = subprocess.Popen([PROGRAM, *map(str, arguments)], stderr=slave, cwd=self.place,
                               stdout=slave if both else subprocess.PIPE, stdin=subprocess.DEVNULL)
        os.close(slave)
        seen = b""
        while select.select([master], [], [], 60)[0]:
            try:
                piece = os.read(master, 65536)
            except OSError:   # the other end is closed
                break
            if not piece:
                break
            seen += piece
        os.close(master)
        output = "" if both else run.stdout.read().decode()
        if not both:
            run.stdout.close()
        return run.wait(60), output, seen.decode().replace("\r\n", "\n")

    @staticmethod
    def screen(seen):
        """Final content of a terminal: a carriage return goes back to the first column, and later text replaces earlier text."""
        rows = []
        for line in seen.split("\n"):
            row = ""
            for part in line.split("\r"):
                row = part + row[len(part):]
            rows.append(row.rstrip())
        return "\n".join(rows)

    def results(self, folder):
        return {path.name: path.read_bytes() for path in (self.place / folder).iterdir()}


class Progress(Case):
    def test_none_without_terminal(self):
        run = self.run_it(YIELDING)
        self.assertEqual((0, ""), (run.returncode, run.stderr))

    def test_none_of_a_short_run(self):
        status, _, seen = self.on_terminal(ELASTIC)
        self.assertEqual((0, ""), (status, seen))

    def test_lines_in_a_file(self):
        run = self.run_it(YIELDING, "--progress")
        lines = run.stderr.splitlines()
        self.assertTrue(run.stderr.endswith("\n"))
        self.assertNotIn("\r", run.stderr)
        self.assertRegex(lines[0], rf"^hertz44: {TIME}, solving: \S+ operations$")
        history = (self.place / "hertz44.history.csv").read_text().splitlines()[1:]
        self.assertEqual(len(history) + 1, len(lines))
        for k, (line, row) in enumerate(zip(lines[1:], history), 1):
            self.assertRegex(line, rf"^hertz44: {SOLVE}$")
            row = row.split(",")
            self.assertIn(f", iteration {k}, load factor 1.000, change {float(row[1]):.1E}"[:-3], line)
            self.assertTrue(line.endswith(f", yielded {row[4]}, in contact {row[3]}"), line)

    def test_elastic_run(self):
        """The operations of the solve, then its results."""
        lines = self.run_it(ELASTIC, "--progress").stderr.splitlines()
        self.assertEqual(2, len(lines))
        self.assertRegex(lines[0], rf"^hertz44_elastic: {TIME}, solving: \S+ operations$")
        self.assertRegex(lines[1], rf"^hertz44_elastic: {SOLVE}$")

    def test_one_line_that_goes(self):
        status, output, seen = self.on_terminal(YIELDING, "--progress")
        self.assertEqual(0, status)
        self.assertEqual("", self.screen(seen))
        self.assertNotIn("\n", seen)
        drawn = [part.rstrip() for part in seen.split("\r") if part.strip()]
        self.assertEqual(8, len(drawn))
        for line in drawn:
            self.assertLess(len(line), 80)
        self.assertRegex(output, r"^hertz44  valid  p_max .*\n$")

    def test_width(self):
        """Lines are cut at the last column, so that each is erased."""
        wide = self.on_terminal(YIELDING, "--progress", columns=200)[2].split("\r")
        self.assertRegex(wide[3].rstrip(), rf"^hertz44: {SOLVE}$")
        for columns in (20, 40, 60, 81):
            _, _, seen = self.on_terminal(YIELDING, "--progress", columns=columns)
            self.assertEqual("", self.screen(seen))
            for part in seen.split("\r"):
                self.assertLess(len(part), columns)

    def test_nothing_is_mixed(self):
        """Output, messages and progress on one terminal: the remaining text is that without progress."""
        decks = [YIELDING, REJECTED, ELASTIC, ROOT / "input" / "faults" / "pulled_apart.dat"]
        plain, told = (self.on_terminal(*decks, *options, both=True) for options in ([], ["--progress"]))
        self.assertEqual(plain[0], told[0])
        self.assertEqual(self.screen(plain[2]), self.screen(told[2]))
        self.assertIn("\r", told[2])

    def test_standard_output_has_none_of_it(self):
        self.assertEqual(self.run_it(YIELDING).stdout, self.run_it(YIELDING, "--progress", "--timing").stdout)

    def test_long_run(self):
        """On a terminal a run of more than a second shows progress, except with --quiet; elsewhere it does not."""
        deck, text = self.place / "long.dat", (ROOT / "input" / "tube" / "tube16.dat").read_text()
        for steps in (1000, 1800, 3200, 5600, 10000):
            deck.write_text(text.replace("BEGIN BULK\n", f"BEGIN BULK\nPARAM,NLOAD,{steps}\n"))
            begun = time.monotonic()
            status, _, seen = self.on_terminal(deck, "-o", "a")
            self.assertEqual(0, status)
            if time.monotonic() - begun > 1.5:
                break
        self.assertEqual("", self.screen(seen))
        self.assertRegex(seen, r"\rlong: \d")
        self.assertRegex(seen, r", iteration \d+, load factor 1\.000, change ")
        self.assertEqual((0, "", ""), self.on_terminal(deck, "-o", "b", "--quiet"))
        run = self.run_it(deck, "-o", "c")
        self.assertEqual((0, ""), (run.returncode, run.stderr))
        self.assertEqual(self.results("a"), self.results("b"))
        self.assertEqual(self.results("a"), self.results("c"))


class Timing(Case):
    def table(self, text, stem):
        """Rows of a timing table by their names; it must be complete."""
        lines = text.splitlines()
        self.assertTrue(all(line.startswith(f"{stem}: ") for line in lines), text)
        rows = [line[len(stem) + 2:].split() for line in lines]
        self.assertEqual(["stage", "wall", "s", "processor", "s"], rows[0])
        self.assertEqual(STAGES + ["all", "peak"], [row[0] for row in rows[1:]])
        self.assertEqual(["peak", "memory", "MB"], [rows[-1][0], rows[-1][1], rows[-1][3]])
        for row in rows[1:-1]:
            self.assertRegex(" ".join(row), r"^\w+ \d+\.\d{4} \d+\.\d{4}$")
        self.assertGreater(float(rows[-1][2]), 1.0)
        times = {row[0]: [float(x) for x in row[1:]] for row in rows[1:-1]}
        for k in (0, 1):
            self.assertAlmostEqual(times["all"][k], sum(times[stage][k] for stage in STAGES), delta=0.001)
        return times

    def test_table(self):
        run = self.run_it(YIELDING, "--timing")
        times = self.table(run.stderr, "hertz44")
        self.assertGreater(times["all"][0], 0.0)

    def test_many_decks(self):
        """Each deck has its own table, also the rejected one: it was read, but nothing was solved."""
        run = self.run_it(YIELDING, REJECTED, "--timing")
        lines = run.stderr.splitlines(keepends=True)
        self.table("".join(line for line in lines if line.startswith("hertz44: ")), "hertz44")
        times = self.table("".join(line for line in lines if line.startswith("no_suport: ")), "no_suport")
        self.assertEqual([0.0, 0.0], times["factor"])

    def test_work_shows_its_layer(self):
        """A large mesh: most of the time is in the parts that grow with it, and all of it within the run."""
        deck = self.place / "large.dat"
        subprocess.run([ROOT / "tools" / "decks", "hertz", "6000", "--plastic", "-o", deck], check=True)
        times = self.table(self.run_it(deck, "--timing").stderr, "large")
        for stage in STAGES:
            self.assertGreater(times[stage][0], 0.0, stage)
        self.assertGreater(times["factor"][0] + times["reading"][0] + times["yielding"][0], 0.25 * times["all"][0])

    def test_listing_has_none_of_it(self):
        self.run_it(YIELDING, "-o", "plain", "--tables", "all")
        self.run_it(YIELDING, "-o", "timed", "--tables", "all", "--timing", "--progress")
        self.assertEqual(self.results("plain"), self.results("timed"))


if __name__ == "__main__":
    unittest.main()
