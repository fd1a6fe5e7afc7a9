#!/usr/bin/env python3
"""test_faults.py PROGRAM: failures around a run. Files appear completely or not at all, and the exit status reports the failure."""
import csv
import fcntl
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = None
SMALL = ROOT / "input" / "hertz" / "hertz44.dat"
LARGE = ROOT / "input" / "pin_in_lug" / "pin_in_lug60.dat"
ALL = ("--tables", "all", "--vtk")   # all files
STOPS = 24   # number of moments at which a run is stopped


def sanitized():
    return b"__asan_init" in pathlib.Path(PROGRAM).read_bytes()


class Case(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)

    def run_it(self, *arguments, **options):
        options = {"stdout": subprocess.PIPE, "timeout": 120, **options}
        return subprocess.run([PROGRAM, *map(str, arguments)], stderr=subprocess.PIPE, **options)

    def check(self, run, status, *words):
        message = run.stderr.decode("latin-1")
        self.assertEqual(status, run.returncode, message)
        for word in words:
            self.assertIn(word, message)
        self.assertNotIn("Sanitizer", message)

    def files(self, directory):
        return {path.name: path.read_bytes() for path in sorted(directory.glob("*")) if path.is_file()}


class Places(Case):
    def test_a_file_instead_of_the_folder(self):
        place = self.directory / "out"
        place.write_text("mine")
        self.check(self.run_it(SMALL, "-o", place), 3, "out/hertz44.lst: cannot be written")
        self.assertEqual("mine", place.read_text())

    def test_folder_not_writable(self):
        # No user may make files here, not even root.
        self.check(self.run_it(SMALL, "-o", "/proc/self"), 3, "/proc/self/hertz44.lst: cannot be written")

    def test_folder_without_rights(self):
        if os.geteuid() == 0:
            self.skipTest("root may write anywhere")
        self.directory.chmod(0o555)
        self.check(self.run_it(SMALL, "-o", self.directory), 3, "cannot be written")

    def test_folder_within_one_that_is_not_there(self):
        self.check(self.run_it(SMALL, "-o", self.directory / "a" / "b"), 3, "cannot be written")

    def test_a_folder_of_the_name_of_a_table(self):
        for name in ("hertz44.lst", "hertz44.zones.csv", "hertz44.zones.csv.part"):
            with self.subTest(name), tempfile.TemporaryDirectory() as place:
                (pathlib.Path(place) / name).mkdir()
                self.check(self.run_it(SMALL, "-o", place), 3, "cannot be written")
                self.assertFalse([file for file in self.files(pathlib.Path(place)) if file.endswith(".part")])

    def test_deck_unreadable(self):
        missing, link, closed = (self.directory / name for name in ("missing.dat", "link.dat", "closed.dat"))
        link.symlink_to(missing)
        for deck in (missing, link, self.directory):
            with self.subTest(deck):
                self.check(self.run_it(deck, "-o", self.directory), 3, str(deck))
        if os.geteuid() != 0:
            closed.touch(0o000)
            self.check(self.run_it(closed), 3, "without permission to read it")

    def test_a_pipe_is_no_deck(self):
        self.check(self.run_it("/dev/stdin", "-o", self.directory, input=SMALL.read_bytes()), 3, "not a regular file")
        self.check(self.run_it("/dev/zero", "-o", self.directory), 3, "not a regular file")

    def test_a_deck_named_like_a_result_is_not_overwritten(self):
        deck = self.directory / "deck.lst"
        deck.write_bytes(SMALL.read_bytes())
        self.check(self.run_it(deck, "-o", self.directory), 3, "name the deck DECK.dat")
        self.assertEqual(SMALL.read_bytes(), deck.read_bytes())

    def test_results_of_an_earlier_run_go(self):
        """A run without an answer leaves no tables of an earlier one."""
        deck = self.directory / "deck.dat"
        deck.write_bytes((ROOT / "input" / "faults" / "pulled_apart.dat").read_bytes())
        (self.directory / "deck.contact.csv").write_text("old")
        self.check(self.run_it(deck, "-o", self.directory), 1)
        self.assertEqual({"deck.dat", "deck.lst", "deck.summary.csv"}, set(self.files(self.directory)))


class Choices(Case):
    def run_with(self, old, new):
        deck = self.directory / "deck.dat"
        deck.write_text((SMALL.parent / "hertz44_paper.dat").read_text().replace(old, new))
        return self.run_it(deck, "-o", self.directory, *ALL)

    def test_the_original_reports_its_error(self):
        self.check(self.run_with("", ""), 0, "formula (2-4) (MUP PAPER) is an approximation: stresses beyond yield are up to 10 % below")
        files = self.files(self.directory)
        c, young, limit, slope = (1 - 2 * .29) / 3, 20400, 85, 15 / (.12 - 85 / 20400)
        shortfall = 0
        for row in csv.DictReader(files["deck.elements.csv"].decode().splitlines()):
            total, secant = float(row["equivalent_strain"]), float(row["secant_modulus"])
            if row["state"] == "plastic":   # strain by (2-4), stress by (2-5); and the stress of the curve at that strain
                strain = total * (1 - c * limit / (total * secant))
                stress = strain * young / (young / secant - c)
                exact = (strain - limit / young + limit / slope) / (1 / slope - c / young)
                shortfall = max(shortfall, 1 - stress / exact)
        told = float(re.search(rb"stress_below_curve,(.*),", files["deck.summary.csv"]).group(1))
        self.assertAlmostEqual(shortfall, told, delta=1e-9)
        self.check(self.run_with("PARAM,ORIGINAL,YES", "PARAM,ORIGINAL,YES\nPARAM,MAXIT,2"), 1,
                   "(increase PARAM MAXIT, or remove ORIGINAL)")


class Disk(Case):
    def test_full_device(self):
        """Each table in turn is written to a full device."""
        self.check(self.run_it(SMALL, "-o", self.directory, *ALL), 0)
        whole = self.files(self.directory)
        for name in whole:
            (self.directory / f"{name}.part").symlink_to("/dev/full")
            self.check(self.run_it(SMALL, "-o", self.directory, *ALL), 3, f"{name}: cannot be written: is the disk full?")
            left = self.files(self.directory)
            self.assertNotIn(name, left)
            self.assertEqual({}, {other: text for other, text in left.items() if text != whole[other]})

    def test_file_size_limit(self):
        """Every limit on the size of a file gives complete files or none."""
        self.check(self.run_it(SMALL, "-o", self.directory, *ALL), 0)
        whole = self.files(self.directory)
        for most in range(0, max(map(len, whole.values())) + 512, 512):
            with tempfile.TemporaryDirectory() as place:
                run = self.run_it(SMALL, "-o", place, *ALL,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most)))
                left = self.files(pathlib.Path(place))
            self.assertEqual(0 if len(left) == len(whole) else 3, run.returncode)
            self.assertEqual({}, {name: text for name, text in left.items() if text != whole.get(name)})

    def test_small_file_system(self):
        place = self.directory / "small"
        place.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=24k", "tmpfs", place], capture_output=True).returncode:
            self.skipTest("no right to mount")
        try:
            self.check(self.run_it(SMALL, "-o", place, *ALL), 3, "is the disk full?")
            left = self.files(place)
        finally:
            subprocess.run(["umount", place], check=True)
        self.assertTrue(left)
        for name, text in left.items():
            self.assertFalse(name.endswith(".part"))
            self.assertTrue(text.endswith(b"\n"), name)


class Stopped(Case):
    def stop(self, number):
        """Stop runs at moments spread over the whole run; the remaining files are complete, with the same bytes."""
        self.check(self.run_it(LARGE, "-o", self.directory, *ALL, stdout=subprocess.DEVNULL), 0)
        begun = time.monotonic()
        self.check(self.run_it(LARGE, "-o", self.directory, *ALL, stdout=subprocess.DEVNULL), 0)
        length, whole, ended = time.monotonic() - begun, self.files(self.directory), []
        for k in range(STOPS):
            with tempfile.TemporaryDirectory() as place:
                run = subprocess.Popen([PROGRAM, LARGE, "-o", place, *ALL], stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
                time.sleep(length * 1.1 * (k + 0.5) / STOPS)
                run.send_signal(number)
                ended.append(run.wait(60))
                left = self.files(pathlib.Path(place))
                self.assertIn(left.pop("pin_in_lug60.lock", b""), (b"",))   # empty, and no longer locked
                yield ended[-1], left, whole, place
        self.assertIn(-number, ended, "no run was stopped before its end")

    def test_sigterm(self):
        for number in (signal.SIGTERM, signal.SIGINT):
            for status, left, whole, _ in self.stop(number):
                self.assertIn(status, (0, -number))
                self.assertEqual({}, {name: text for name, text in left.items() if text != whole.get(name)})

    def test_sigkill(self):
        for status, left, whole, place in self.stop(signal.SIGKILL):
            self.assertIn(status, (0, -signal.SIGKILL))
            named = {name: text for name, text in left.items() if not name.endswith(".part")}
            self.assertEqual({}, {name: text for name, text in named.items() if text != whole[name]})
            if len(named) < len(left):
                self.check(self.run_it(LARGE, "-o", place, *ALL), 0)
                self.assertEqual(whole, self.files(pathlib.Path(place)))

    def test_a_temporary_file_that_was_left_is_overwritten(self):
        (self.directory / "hertz44.lst.part").write_text("long ago\n" * 10000)
        self.check(self.run_it(SMALL, "-o", self.directory), 0)
        left = self.files(self.directory)
        self.assertNotIn("hertz44.lst.part", left)
        self.assertNotIn(b"long ago", left["hertz44.lst"])


class OneRunAtATime(Case):
    """Results belong to one run; the files with the name of a deck are that run's."""
    def deck(self, text=None):
        path = self.directory / "scene.dat"
        path.write_text(pathlib.Path(SMALL).read_text() if text is None else text)
        return path

    def test_the_second_refuses(self):
        with open(self.directory / "hertz44.lock", "w", encoding="ascii") as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            (self.directory / "hertz44.lst").write_text("of the other\n")
            run = self.run_it(SMALL, "-o", self.directory)
            self.assertEqual((3, b"", f"{self.directory}/hertz44.lst: another run is at work on these results: wait for it, "
                                      "or take another -o DIR\n".encode()), (run.returncode, run.stdout, run.stderr))
            self.assertEqual(b"of the other\n", self.files(self.directory)["hertz44.lst"])
            self.check(self.run_it(SMALL, "--check"), 0)
        self.check(self.run_it(SMALL, "-o", self.directory), 0)   # left over, without an owner
        self.assertNotIn("hertz44.lock", self.files(self.directory))

    def test_two_at_once(self):
        """One of them ends, and its files are complete; the others refuse, or run after it."""
        self.check(self.run_it(LARGE, "-o", self.directory, *ALL), 0)
        whole = self.files(self.directory)
        runs = [subprocess.Popen([PROGRAM, LARGE, "-o", self.directory, *ALL], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                for _ in range(6)]
        said = [run.communicate(timeout=100)[1] for run in runs]
        self.assertIn(0, [run.returncode for run in runs])
        for run, words in zip(runs, said):
            self.assertIn(run.returncode, (0, 3))
            self.assertEqual(run.returncode == 3, b"another run is at work" in words)
        self.assertEqual(whole, self.files(self.directory))

    def test_rejected_decks_leave_nothing(self):
        sound = self.deck()
        text = sound.read_text()
        for status, spoilt, options in ((2, text.replace("ENDDATA", ""), ()), (2, text.replace("MAT1", "MAT7"), ()),
                                        (3, text, ("--memory", "0.001")), (3, None, ())):
            self.deck(text)
            self.check(self.run_it(sound, "-o", self.directory, *ALL), 0)
            self.assertEqual(11, len(self.files(self.directory)))
            sound.unlink()
            if spoilt is not None:
                self.deck(spoilt)
            before = self.files(self.directory)
            run = self.run_it(sound, "-o", self.directory, "--check")
            self.assertEqual(before, self.files(self.directory))
            run = self.run_it(sound, "-o", self.directory, *ALL, *options)
            self.assertEqual(status, run.returncode, run.stderr)
            self.assertEqual({"scene.dat"} & set(before), set(self.files(self.directory)))

    def test_names_with_control_characters(self):
        name = "a\nb\x1b[31m\u009bx\u00e9=1"
        path = self.directory / f"{name}.dat"
        seen = "a\\x0Ab\\x1B[31m\\xC2\\x9Bx\u00e9=1"
        text = pathlib.Path(SMALL).read_text()
        for status, spoilt, options in ((0, text, ()), (0, text, ("--plan",)), (0, text, ("--timing", "--progress")), (3, text, ("--memory", "0.001")),
                                        (2, text.replace("ENDDATA", ""), ()), (3, None, ())):
            path.write_text(spoilt) if spoilt is not None else path.unlink()
            run = self.run_it(path, "-o", self.directory, *options)
            self.assertEqual(status, run.returncode, run.stderr)
            for stream in (run.stdout.decode(), run.stderr.decode()):
                self.assertEqual([], [c for c in stream if c != "\n" and (c < " " or "\x7f" <= c < "\xa0")])
                self.assertNotIn("a\nb", stream)
            self.assertIn(seen, run.stdout.decode() + run.stderr.decode())


class Remarks(Case):
    """All warnings and notes are in the listing, and counted in the summary."""
    BLOCK = ["BEGIN BULK", "GRID,1,,0.,0.", "GRID,2,,1.,0.", "GRID,3,,1.,1.", "GRID,4,,0.,1.", "CQUAD4,1,1,1,2,3,4",
             "PSHELL,1,1,1.,-1", "SPC1,1,12,1,2"]
    FORCE = "FORCE,1,3,,1.,0.,-1.,0."

    def solve(self, *cards, force=FORCE, damping="1.", place="."):
        path = self.directory / place / "scene.dat"
        path.parent.mkdir(exist_ok=True)
        path.write_text("\n".join([*self.BLOCK, f"MAT1,1,1000.,,.3,,,,{damping}", force, *cards, "ENDDATA", ""]))
        run = self.run_it(path, "-o", path.parent)
        self.check(run, 0)
        listing = (path.parent / "scene.lst").read_text()
        section = re.search(r"^(WARNINGS AND NOTES .*)\n((?:  .*\n)+)", listing, re.MULTILINE)
        summary = (path.parent / "scene.summary.csv").read_text().splitlines()[1:4]
        return run.stderr.decode(), section and section[1], section[2].splitlines() if section else [], summary

    def test_none(self):
        self.assertEqual(("", None, [], ["status,valid,", "warnings,0,", "notes,0,"]), self.solve(damping=""))

    def test_a_hundred_warnings(self):
        (self.directory / "there").mkdir()
        (self.directory / "there" / "lines.inc").write_text("".join(f"BLSEG,{k},1,2\n" for k in range(1, 51)))
        cards = ["INCLUDE 'lines.inc'", *(f"BLSEG,{k},1,2" for k in range(51, 101))]
        said, heading, lines, summary = self.solve(*cards, place="there")
        self.assertEqual("WARNINGS AND NOTES  (100 warnings, 1 note)", heading)
        self.assertEqual(["status,valid,", "warnings,100,", "notes,1,"], summary)
        remedy = "no BCONP names it; add a BCONP with it as SLAVE or MASTER, or remove the line"
        self.assertEqual(["  9:21-22: MAT1: field 9 (GE) has no effect (cards with it: 1)"] +
                         [f"  lines.inc:{k}:7{'-8' if k > 9 else ''}: warning: BLSEG {k}: {remedy}" for k in range(1, 51)] +
                         [f"  {k - 39}:7-{8 if k < 100 else 9}: warning: BLSEG {k}: {remedy}" for k in range(51, 101)], lines)
        self.assertIn("100 warnings (5 shown)\n", said)

    def test_of_the_answer(self):
        """Displacements are known, and not small, after everything else; a long text continues on the next line."""
        said, heading, lines, summary = self.solve(force="FORCE,1,3,,300.,0.,-1.,0.")
        self.assertEqual("WARNINGS AND NOTES  (1 warning, 1 note)", heading)
        self.assertEqual(["status,valid,", "warnings,1,", "notes,1,"], summary)
        text = "warning: displacements too large for small-displacement theory: rotation or strain exceeds 0.1 in 100 % of the volume (largest at 0.5000 0.5000); " \
               "equilibrium and contact use the undeformed shape"
        self.assertEqual(["  9:21-22: MAT1: field 9 (GE) has no effect (cards with it: 1)",
                          "  " + text[:text.index(" at 0.5000")], "    " + text[text.index("at 0.5000"):]], lines)
        self.assertEqual(f"{self.directory}/scene.dat: {text}\n", said)


class LimitLoad(Case):
    def test_its_status_and_load_factors(self):
        run = self.run_it(ROOT / "input" / "faults" / "punch_beyond.dat", "-o", self.directory, text=True)
        self.assertEqual(1, run.returncode)
        self.assertIn("punch_beyond  limit load at load factor 0.7000; last converged 0.6000:  p_max  3.64613E+03 (singular)", run.stdout)
        self.assertIn("limit load exceeded at load factor 0.7000: displacements grow without bound", run.stderr)
        self.assertIn("\nstatus,limit load,\n", (self.directory / "punch_beyond.summary.csv").read_text())


class Output(Case):
    def test_standard_output_is_full(self):
        with open("/dev/full", "wb") as full:
            for arguments in ([SMALL, "-o", self.directory], [SMALL, "--plan"], ["--cards"], ["--help"], ["--version"]):
                self.check(self.run_it(*arguments, stdout=full), 3, "standard output cannot be written")
        self.assertIn("hertz44.lst", self.files(self.directory))

    def test_standard_output_is_a_closed_pipe(self):
        """Decks run nevertheless."""
        read, write = os.pipe()
        os.close(read)
        self.check(self.run_it(SMALL, LARGE, "-o", self.directory, stdout=write), 3, "standard output cannot be written")
        os.close(write)
        self.assertLessEqual({"hertz44.lst", "pin_in_lug60.lst"}, set(self.files(self.directory)))

    def test_streams_are_closed(self):
        for descriptor, status in ((1, 3), (2, 0)):
            run = self.run_it(SMALL, "-o", self.directory, preexec_fn=lambda: os.close(descriptor))
            self.assertEqual(status, run.returncode)

    def test_quiet_needs_no_output(self):
        with open("/dev/full", "wb") as full:
            self.check(self.run_it(SMALL, "-o", self.directory, "--quiet", stdout=full), 0)


class Memory(Case):
    def test_the_forecast_is_above_the_limit(self):
        self.check(self.run_it(LARGE, "-o", self.directory, "--memory", "0.001"), 3, "the model needs about", "--memory allows 0.001000 GB")
        self.assertEqual({}, self.files(self.directory))

    def test_no_limit(self):
        for word in ("-1", "0", "0.0", ".", "1" * 400, "nan", "inf", "1e400", "", "2 3", ",", "1e", "GB"):
            with self.subTest(word):
                self.check(self.run_it(SMALL, "-o", self.directory, "--memory", word), 3, "give a positive number of GB")

    def limits(self, deck, kind):
        """Every limit gives an answer or a rejection, never a crash or an endless wait; a sufficient limit gives an answer."""
        if sanitized():
            self.skipTest("the address sanitizer maps more than any limit")
        seen = set()
        for megabytes in [*range(40, 400, 15), 500, 700, 1000, 2000]:
            def limit(most=megabytes * 1000000):
                resource.setrlimit(kind, (most, most))
            if not self.loads(limit):
                continue
            run = self.run_it(deck, "-o", self.directory, preexec_fn=limit)
            self.assertIn(run.returncode, (0, 3), (megabytes, run.stderr))
            if run.returncode == 3:
                self.assertIn(b"memory", run.stderr)
            seen.add(run.returncode)
        self.assertEqual({0, 3}, seen)

    def loads(self, limit):
        """Do the libraries load, so that the program begins? A shared OpenBLAS with threads allocates 134 MB for each core when it is
        loaded, and waits forever without them. A statically linked one is limited before that."""
        held_back = b"than OpenBLAS takes" in pathlib.Path(PROGRAM).read_bytes()
        try:
            return self.run_it("--version", preexec_fn=limit, timeout=60 if held_back else 2).returncode != 127
        except subprocess.TimeoutExpired:
            if held_back:
                raise
            return False

    def test_address_space(self):
        self.limits(LARGE, resource.RLIMIT_AS)

    def test_data(self):
        self.limits(SMALL, resource.RLIMIT_DATA)

    def test_messages_have_figures(self):
        if sanitized():
            self.skipTest("the address sanitizer maps more than any limit")
        for kind, most, message in ((resource.RLIMIT_AS, 150000000, "OpenBLAS needs 166 MB of memory, but less is free or allowed: "
                                     "raise ulimit -v or lower OMP_NUM_THREADS"),
                                    (resource.RLIMIT_STACK, 65536, "the stack is limited to 64 kB: raise ulimit -s to at least 256 kB")):
            with self.subTest(message):
                run = self.run_it(SMALL, "-o", self.directory, preexec_fn=lambda: resource.setrlimit(kind, (most, most)))
                self.check(run, 3, f"epcont: {message}")

    def test_small_stack(self):
        for option in ("--brief", "--plan"):
            with self.subTest(option):
                self.check(self.run_it(SMALL, option, "-o", self.directory, preexec_fn=lambda: resource.setrlimit(
                    resource.RLIMIT_STACK, (262144, 262144))), 0)


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main(verbosity=2)   # shows why a test is skipped
