"""PARAM PRECIS and ACCURACY: what they choose, what their answers are worth, and the words of it."""
import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "accuracy"))
import chance  # noqa: E402

PROGRAM = os.environ["EPCONT_PROGRAM"]
INPUT = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"]) / "input"
FIGURE = "error that single precision leaves"


class Dial(unittest.TestCase):
    def run_deck(self, name, *parameters, **more):
        return self.run_text((INPUT / f"{name}.dat").read_text(), *parameters, **more)

    def run_text(self, text, *parameters, left_out="none", words={}, memory="16"):
        """The run, the listing and the contact pressures of a deck with further PARAMs, one left out, words replaced."""
        names = [parameter.split(",")[0] for parameter in parameters] + [left_out]
        text = "".join(line for line in text.splitlines(True) if not re.match(rf"PARAM +({'|'.join(names)}) ", line))
        for old, new in words.items():
            self.assertIn(old, text)
            text = text.replace(old, new)
        text = text.replace("BEGIN BULK\n", "BEGIN BULK\n" + "".join(f"PARAM,{parameter}\n" for parameter in parameters), 1)
        with tempfile.TemporaryDirectory() as directory:
            where = pathlib.Path(directory)
            (where / "deck.dat").write_text(text)
            run = subprocess.run([PROGRAM, where / "deck.dat", "-o", where, "--memory", memory], capture_output=True, text=True)
            listing = where / "deck.lst"
            table = where / "deck.contact.csv"
            rows = csv.DictReader(table.read_text().splitlines() if table.exists() else [])
            pressures = [float(row["pressure"] or 0) for row in rows]
            return run, listing.read_text() if listing.exists() else "", pressures

    def difference(self, some, others):
        return max(abs(a - b) for a, b in zip(some, others, strict=True)) / max(others)

    def figure(self, listing, name):
        return float(re.search(rf"^  {re.escape(name)} +(\S+)$", listing, re.MULTILINE)[1])

    def test_single_says_what_it_leaves(self):
        for deck in ("hertz/hertz330_elastic", "hertz/hertz330", "flange/flange"):
            with self.subTest(deck):
                run, listing, pressures = self.run_deck(deck, "PRECIS,SINGLE")
                _, _, exact = self.run_deck(deck)
                self.assertEqual(0, run.returncode)
                self.assertIn("  factors in single precision, not refined (SINGLE); where that fails, all is solved anew in double\n", listing)
                if deck == "flange/flange" and "(factors in double: " in listing:
                    continue   # with a condition of 3E6 the kernels of the BLAS decide whether single precision does
                error = self.figure(listing, FIGURE)
                self.assertLess(1e-7, self.difference(pressures, exact))
                self.assertLess(self.difference(pressures, exact), 10*error)
                self.assertLess(error, 0.01)
                tolerance = float(re.search(r"^CERTIFICATE .*; tolerance (\S+)\)", listing, re.MULTILINE)[1])
                self.assertAlmostEqual(1.0, tolerance/(10*error), delta=1e-3)
                self.assertNotIn("digits that rounding leaves", listing)
                self.assertNotIn("rounding in the contact forces", listing)

    def test_forces_that_are_less_exact_than_strains(self):
        """Two flat blocks, a fine mesh: forces of its pairs are off by five times what strains are."""
        scene = chance.Scene("stack", False, (1000.0, 3000.0), whole=True, wide=(1.0, 1.0), deep=(0.3, 0.3))
        text = chance.make(scene, "cquad4", chance.Fineness(60.0, 1.4, 1.0, 0.0, 1.0, 0.0, 0)).text()
        _, listing, pressures = self.run_text(text, "PRECIS,SINGLE")
        _, _, exact = self.run_text(text, "PRECIS,DOUBLE")
        if "(factors in double: " in listing:   # the certificate has refused what single precision leaves
            self.assertEqual(exact, pressures)
        else:
            self.assertLess(0.5*self.difference(pressures, exact), self.figure(listing, FIGURE))

    def test_mixed_is_as_certain_as_double(self):
        run, listing, _ = self.run_deck("hertz/hertz330", "PRECIS,MIXED")
        self.assertEqual(0, run.returncode)
        self.assertIn("  factors in single precision, refined to double (MIXED); where that fails, all is solved anew in double\n", listing)
        self.assertIn("; tolerance 1.000E-09)\n", listing)
        self.assertNotIn(FIGURE, listing)
        self.assertNotIn("factors in double", listing)

    def test_double_says_nothing_of_it(self):
        _, listing, _ = self.run_deck("hertz/hertz330", "PRECIS,DOUBLE")
        _, plain, _ = self.run_deck("hertz/hertz330", "UNITS,KGF-MM")
        self.assertNotIn("single precision", listing)
        self.assertNotIn("ACCURACY 0", listing)
        self.assertIn("digits that rounding leaves", plain)

    def test_memory_of_factors_halves(self):
        """What is told is the whole run's, of which the factors are a part."""
        with tempfile.TemporaryDirectory() as directory:
            deck, memory = pathlib.Path(directory) / "deck.dat", []
            subprocess.run([sys.executable, "-B", INPUT.parent / "tools/decks", "hertz", "42000", "-o", deck], check=True, capture_output=True)
            text = deck.read_text()
            for precision in ("DOUBLE", "MIXED", "SINGLE"):
                deck.write_text(text.replace("BEGIN BULK\n", f"BEGIN BULK\nPARAM,PRECIS,{precision}\n", 1))
                plan = subprocess.run([PROGRAM, "--plan", deck], check=True, capture_output=True, text=True).stdout
                memory.append(float(re.search(r"^  memory (\d+) MB", plan, re.MULTILINE)[1]))
        self.assertEqual(memory[1], memory[2])
        self.assertLess(memory[1], 0.8*memory[0])

    def test_double_where_single_leaves_nothing(self):
        """In one solve, and in an iteration whose changes fall no more, but by chance: which the kernels of the BLAS decide."""
        for deck in ("tube/tube_near_incompressible", "tube/tube_limit"):
            run, listing, _ = self.run_deck(deck, "PRECIS,SINGLE")
            self.assertEqual(0, run.returncode)
            if deck == "tube/tube_limit" and "(factors in double: " not in listing:
                self.assertLess(self.figure(listing, FIGURE), 0.01)
                continue
            self.assertIn("    (factors in double: in single precision they left an error of more than 0.01000, or no answer)\n", listing)
            self.assertIn("; tolerance 1.000E-09)\n", listing)
            self.assertNotIn(FIGURE, listing)

    def test_double_where_single_is_not_certified(self):
        """A wavy contact of 201 pairs: what single precision leaves is below TOL, but bodies pass through each other by it."""
        text = (pathlib.Path(__file__).parent / "single_strip.bdf").read_text()
        run, listing, pressures = self.run_text(text, "PRECIS,SINGLE")
        _, _, exact = self.run_text(text, "PRECIS,DOUBLE")
        self.assertEqual(0, run.returncode, run.stderr)
        self.assertLess(self.difference(pressures, exact), 0.01)

    def test_double_where_nothing_can_be_refined(self):
        words = {".4999": ".4999999"}
        run, listing, _ = self.run_deck("tube/tube_near_incompressible", "PRECIS,MIXED", words=words)
        double, _, _ = self.run_deck("tube/tube_near_incompressible", "PRECIS,DOUBLE", words=words)
        self.assertEqual(double.returncode, run.returncode)
        self.assertIn("    (factors in double: in single precision there was no answer that refinement could reach)\n", listing)

    def test_memory_that_double_would_need(self):
        """A limit between the two: single precision has its turn, and where it fails double is refused."""
        for precision, deck, status in (("SINGLE", "tube/tube_near_incompressible", 3), ("MIXED", "tube/tube_near_incompressible", 3),
                                        ("SINGLE", "hertz/hertz330_elastic", 0), ("MIXED", "hertz/hertz330_elastic", 0)):
            with self.subTest(deck, precision=precision):
                words = {".4999": ".4999999"} if status else {}
                needs = [re.search(r"the scene needs about (\S+) GB", self.run_deck(deck, f"PRECIS,{each}", words=words, memory=".000000001")[0].stderr)[1]
                         for each in (precision, "DOUBLE")]
                between = f"{sum(map(float, needs))/2:.9f}"
                run, listing, pressures = self.run_deck(deck, f"PRECIS,{precision}", words=words, memory=between)
                self.assertEqual(status, run.returncode, run.stderr)
                if status:
                    self.assertRegex(run.stderr, rf"deck.dat: factors in single precision \({precision}\) give no answer to be trusted, and in"
                                     rf" double the scene needs about {needs[1]} GB of memory, and --memory allows \S+ GB\n")
                    self.assertTrue(run.stdout.startswith("deck  out of memory"), run.stdout)
                    self.assertIn("  *NOT VALID*  out of memory: factors in single precision", listing)
                    self.assertEqual([], pressures)
                run, _, _ = self.run_deck(deck, f"PRECIS,{precision}", words=words, memory=f"{0.9*float(needs[0]):.9f}")
                self.assertEqual(3, run.returncode)
                self.assertIn(f"deck.dat: the scene needs about {needs[0]} GB", run.stderr)

    def test_the_plan_tells_of_both(self):
        single, double = [self.run_deck("pin_in_lug/pin_in_lug", f"PRECIS,{precision}")[1] for precision in ("MIXED", "DOUBLE")]
        needed = re.search(r"  memory (\d+ MB), operations", double)[1]
        self.assertRegex(single, rf"  memory \d+ MB \(in double {needed}\), operations")

    def test_faults(self):
        for value in ("0.0", "1.0", "-0.1"):
            run, _, _ = self.run_deck("hertz/hertz44", f"ACCURACY,{value}")
            self.assertEqual(2, run.returncode)
            self.assertIn("PARAM ACCURACY: field 3 (VALUE) is out of range\n", run.stderr)
            self.assertIn(" a real above 0.0 to below 1.0\n", run.stderr)

    def test_what_accuracy_chooses(self):
        chosen = "  ACCURACY {}\n".format
        cases = [("hertz/hertz330_elastic", ["ACCURACY,0.1"], "0.1000 chooses PRECIS SINGLE"),
                 ("hertz/hertz330_elastic", ["ACCURACY,0.01"], "0.01000 chooses PRECIS MIXED"),
                 ("hertz/hertz330", ["ACCURACY,0.1"], "0.1000 chooses TOL 0.01000, METHOD NEWTON, PRECIS SINGLE"),
                 ("hertz/hertz330", ["ACCURACY,0.01"], "0.01000 chooses TOL 0.001000, METHOD NEWTON, PRECIS DOUBLE"),
                 ("hertz/hertz330", ["ACCURACY,0.03", "METHOD,SECANT"], "0.03000 chooses TOL 6.000E-05, PRECIS DOUBLE"),
                 ("hertz/hertz330", ["ACCURACY,0.03", "METHOD,SECANT", "TOL,0.01", "PRECIS,MIXED"],
                  "0.03000 chooses nothing: the deck sets all itself")]
        for deck, parameters, words in cases:
            with self.subTest(words):
                run, listing, _ = self.run_deck(deck, *parameters)
                self.assertEqual(0, run.returncode)
                self.assertIn(chosen(words), listing)

    def test_solution_is_ten_times_as_exact_as_wanted(self):
        for deck in ("hertz/hertz44", "hertz/hertz330", "insert_joint/insert_joint"):
            _, _, exact = self.run_deck(deck, "METHOD,NEWTON", "TOL,1.E-10")
            for parameters in (["METHOD,AUTO"], ["METHOD,SECANT"], ["METHOD,INISTR"]):
                for wanted in (0.1, 0.02, 0.003):
                    with self.subTest(deck=deck, method=parameters, wanted=wanted):
                        run, _, pressures = self.run_deck(deck, f"ACCURACY,{wanted}", *parameters, left_out="TOL")
                        self.assertEqual(0, run.returncode)
                        self.assertLess(self.difference(pressures, exact), 0.1*wanted)

    def test_words_about_the_mesh(self):
        wanted = "  wanted error of contact pressures {}\n".format
        _, listing, _ = self.run_deck("hertz/hertz330_elastic", "ACCURACY,0.5")
        self.assertIn(wanted("                 0.5000"), listing)
        self.assertRegex(listing, r"\n    reached: the error of the mesh is estimated at \d\.\dE-\d\d\n")
        _, listing, _ = self.run_deck("hertz/hertz330_elastic", "ACCURACY,0.001")
        self.assertRegex(listing, r"\n  refine first: element \d+")
        self.assertRegex(listing, r"\n    not reached: the mesh, not the dial, is the limit: its error is estimated at \d\.\dE-\d\d; "
                                  r"refine the elements named above\n")
        _, listing, _ = self.run_deck("flat_punch/flat_punch", "ACCURACY,0.01")
        self.assertIn("\n    not to be had: the largest pressure is unbounded: it grows with every finer mesh\n", listing)
        _, listing, _ = self.run_deck("tube/tube16", "ACCURACY,0.01")
        self.assertIn("\n    (of the mesh's error nothing is known: no pressure, or too few pairs in contact)\n", listing)
        _, listing, _ = self.run_deck("hertz/hertz330_elastic", "UNITS,KGF-MM")
        self.assertNotIn("wanted error", listing)


if __name__ == "__main__":
    unittest.main()
