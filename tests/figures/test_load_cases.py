#!/usr/bin/env python3
"""Load cases: each gives the results of a separate deck, whatever the other cases, their order, and the contact solver."""
import csv
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM = os.environ["EPCONT_PROGRAM"]
INPUT = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"]) / "input"
SAME = 1e-9
FACTORS = [0.5, 1.0, 0.25, 1.0]
#: The results are the same; the path may differ.
OF_THE_WAY = {"condition", "rounding_error_force", "contact_amplification", "iteration_error_displacement", "iteration_error_force", "load_factor",
              "stress_off_curve", "curve_tolerance", "energy_balance", "equilibrium_residual", "largest_force_gap_product", "smallest_gap",
              "smallest_force", "stress_off_curve_limit", "factorizations", "pivots"}

#: The left one .05 above the floor, the right one .3, beyond SEARCH.
TWO_FEET = (
    "PARAM,SEARCH,0.1|PARAM,PLANE,STRAIN|PSHELL,1,1,1.0|MAT1,1,1000.0,,0.3|"
    "GRID,1,,-1.0,-1.0|GRID,2,,5.0,-1.0|GRID,3,,5.0,0.0|GRID,4,,-1.0,0.0|CQUAD4,1,1,1,2,3,4|SPC1,1,12,1,2|"
    "GRID,21,,0.0,0.05|GRID,22,,1.0,0.05|GRID,23,,1.0,1.0|GRID,24,,0.0,1.0|CQUAD4,2,1,21,22,23,24|"
    "GRID,31,,3.0,0.3|GRID,32,,4.0,0.3|GRID,33,,4.0,1.0|GRID,34,,3.0,1.0|CQUAD4,3,1,31,32,33,34|"
    "CQUAD4,4,1,23,22,31,34|SPC1,1,12,24,23,34,33|BLSEG,1,21,22,31,32|BLSEG,2,4,3|BCONP,1,1,2|ENDDATA|")


def bulk(path):
    """The cards of a deck, and the set of its loads."""
    text = path.read_text()
    cards = text[re.search(r"^BEGIN BULK.*\n", text, re.M).end():]
    return cards, int(re.search(r"^(?:FORCE|PLOADX1)[ ,]+(\d+)", cards, re.M).group(1))


def run(deck, *options):
    """Run a deck in a folder of its own: exit status, the rows of its tables by name."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "deck.dat"
        path.write_text(deck)
        status = subprocess.run([PROGRAM, path, *options], capture_output=True, cwd=folder, check=False).returncode
        tables = {}
        for name in ["summary", "contact", "zones", "bodies", "nodes", "elements"]:
            file = path.with_suffix("." + name + ".csv")
            if file.exists():
                tables[name] = list(csv.DictReader(file.open()))
        tables["listing"] = path.with_suffix(".lst").read_bytes() if path.with_suffix(".lst").exists() else b""
        return status, tables


def of_factors(path, factors, above="", param=""):
    """A deck of many cases, each the loads of a deck times a factor."""
    cards, loads = bulk(path)
    cases = "".join(f"SUBCASE {k}\n LOAD = {1000 + k}\n" for k in range(1, len(factors) + 1))
    sums = "".join(f"LOAD,{1000 + k},2.0,{0.5 * factor!r},{loads}\n" for k, factor in enumerate(factors, 1))
    return f"SOL 101\nCEND\n{above}{cases}BEGIN BULK\n{param}{sums}{cards}"


def of_one(path, factor, above="", param=""):
    """The same with one factor, without cases."""
    cards, loads = bulk(path)
    return f"SOL 101\nCEND\n{above}LOAD = 1000\nBEGIN BULK\n{param}LOAD,1000,1.0,{factor!r},{loads}\n{cards}"


class LoadCases(unittest.TestCase):
    """Cases compared with single decks."""

    def compare(self, rows, own, table):
        """Rows of a case are those of its own deck, except columns about the path."""
        self.assertEqual(len(rows), len(own), table)
        for column in own[0] if own else []:
            values = [[row[column] for row in side] for side in (rows, own)]
            try:
                numbers = [[float(value) if value else -1.0 for value in side] for side in values]
            except ValueError:
                if table != "summary":
                    self.assertEqual(values[0], values[1], column)
                continue
            scale = max([abs(number) for number in numbers[1]] + [1e-30])
            if column.startswith("mesh_error"):
                scale *= 1e3    # a difference of near fields
            for one, other in zip(*numbers):
                self.assertLessEqual(abs(one - other), SAME * scale, f"{table} {column}")

    def check(self, name, above="", param="", factors=tuple(FACTORS)):
        status, all_of_them = run(of_factors(INPUT / name, factors, above, param))
        worst = 0
        for k, factor in enumerate(factors, 1):
            one, own = run(of_one(INPUT / name, factor, above, param))
            worst = max(worst, one)
            for table in ["contact", "zones", "nodes", "elements"]:
                rows = [row for row in all_of_them.get(table, []) if row["subcase"] == str(k)]
                self.compare(rows, own.get(table, []), f"{name} case {k} {table}")
            figures = {row["key"]: row["value"] for row in all_of_them["summary"] if row["subcase"] == str(k)}
            for row in own["summary"]:
                if row["key"] in OF_THE_WAY or row["key"].startswith(("worst_", "largest_p", "allowed_", "mesh_error")):
                    continue
                try:
                    wanted = float(row["value"])
                except ValueError:
                    self.assertEqual(figures[row["key"]], row["value"], row["key"])
                    continue
                self.assertAlmostEqual(float(figures[row["key"]]), wanted, delta=1e-8 * max(abs(wanted), 1e-12), msg=f"{name} {k} {row['key']}")
        self.assertEqual(status, worst, name)
        return [int(row["value"]) for row in all_of_them["summary"] if row["key"] == "factorizations"]

    def test_models(self):
        tables = "DISPLACEMENT = ALL\nSTRESS = ALL\n"
        for name in ["hertz/hertz44_elastic.dat", "cylinder_on_block/cylinder_on_block.dat", "layer_lines/layer_lines.dat", "roller/roller.dat",
                     "ball/ball_on_flat.dat", "off_centre/off_centre.dat"]:
            with self.subTest(name):
                self.assertEqual(sum(self.check(name, tables)[1:]), 0, "factored again")

    def test_yielding(self):
        """Each case begins with the factors of the unloaded state, not with those of the case before."""
        self.check("hertz/hertz44.dat", "STRESS = ALL\n")

    def test_rules(self):
        for rule in ["CONRY", "JOINED"]:
            with self.subTest(rule):
                self.check("layer_lines/layer_lines.dat", param=f"PARAM,RULE,{rule}\n")

    def test_after_a_case_without_equilibrium(self):
        for rule in "CONRY", "JOINED":
            status, tables = run(of_factors(INPUT / "ball/ball_on_flat.dat", [1.0, -1.0, 0.5], param=f"PARAM,RULE,{rule}\n"))
            self.assertEqual(status, 1)
            self.assertEqual([row["value"] for row in tables["summary"] if row["key"] == "status"], ["valid", "no equilibrium", "valid"])

    def test_in_proportion(self):
        """If loads grow or fall while the contacts stay, much is kept from case to case."""
        for rule in ["CONRY", "JOINED"]:
            for name in ["layer_lines/layer_lines.dat", "hertz/hertz44_elastic.dat"]:
                with self.subTest(rule + " " + name):
                    self.check(name, "STRESS = ALL\n", f"PARAM,RULE,{rule}\n", (0.9, 0.91, 0.92, 0.93, 0.5, 0.51, 0.52))

    def test_same_bytes_on_any_number_of_threads(self):
        factors = [0.05 * k for k in range(1, 13)] + [1.0 - 0.07 * k for k in range(13)]
        for name, rule in (("layer_lines/layer_lines", "AUTO"), ("layer_lines/layer_lines", "JOINED"), ("hertz/hertz44", "AUTO")):
            deck = of_factors(INPUT / f"{name}.dat", factors, param=f"PARAM,RULE,{rule}\n")
            listings = set()
            for threads in "1", "2", "3":
                os.environ["OMP_NUM_THREADS"] = threads
                status, tables = run(deck)
                self.assertEqual(status, 0)
                listings.add(tables["listing"])
            del os.environ["OMP_NUM_THREADS"]
            self.assertEqual(len(listings), 1, name)

    def test_many(self):
        """Each of many cases equals a separate deck."""
        self.check("hertz/hertz44.dat", factors=tuple(0.04 * k for k in range(1, 26)))

    def test_pairs_of_one_case(self):
        """If nodes come near in one case, the other cases do not get their pairs, in any order."""
        before, cards = (INPUT.parent / "tests/found/cases_that_come_near.bdf").read_text().split("BEGIN BULK\n")
        cases = re.findall(r"SUBCASE \d+\n((?:  .*\n)*)", before)
        alone = [run(f"{case}BEGIN BULK\n{cards}")[1] for case in cases]
        self.assertGreater(len({len(own["contact"]) for own in alone}), 1)
        for order in (0, 1, 2), (2, 1, 0), (1, 0, 2):
            deck = "".join(f"SUBCASE {k}\n{cases[one]}" for k, one in enumerate(order, 1))
            status, tables = run(f"{deck}BEGIN BULK\n{cards}")
            self.assertEqual(status, 0)
            for k, one in enumerate(order, 1):
                for table in "contact", "zones", "bodies":
                    rows = [row for row in tables[table] if row["subcase"] == str(k)]
                    self.compare(rows, alone[one][table], f"{order} {k} {table}")
        self.assertEqual(tables["listing"].decode().count("this load case was solved again with 2 more pairs"), 1)

    def test_nodes_that_come_near(self):
        """The cases before the first one with near nodes do not get their pairs."""
        cards = TWO_FEET.replace("|", "\n")
        cases = "".join(f"SUBCASE {k}\nSPC = 1\nLOAD = {k}\n" for k in range(1, 25))
        moved = "".join(f"SPCD,{k},{node},2,{-0.017 * k:.3f}\n" for k in range(1, 25) for node in (24, 23, 34, 33))
        outputs = set()
        for threads in "1", "2":
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder) / "feet.dat"
                path.write_text(f"{cases}BEGIN BULK\n{moved}{cards}")
                done = subprocess.run([PROGRAM, path], capture_output=True, cwd=folder, check=False, text=True,
                                      env={**os.environ, "OMP_NUM_THREADS": threads})
                outputs.add(done.stdout + path.with_suffix(".lst").read_text())
                rows = list(csv.DictReader(path.with_suffix(".contact.csv").open()))
        self.assertEqual(len(outputs), 1)
        self.assertEqual(len(done.stdout.splitlines()), 24)
        self.assertEqual(done.stdout.splitlines()[1], "feet SUBCASE 2  valid  p_max          0.0 (no contact)")
        touching = [int(row["subcase"]) for row in rows if row["pair"] == "31" and row["status"] == "touching"]
        self.assertEqual(touching, list(range(touching[0], 25)))
        self.assertEqual([len([row for row in rows if row["subcase"] == k]) for k in ("1", "24")], [2, 4])
        for k in 1, 2, touching[0] - 1, touching[0]:
            own = run(f"SPC = 1\nLOAD = {k}\nBEGIN BULK\n{moved}{cards}")[1]["contact"]
            self.compare([row for row in rows if row["subcase"] == str(k)], own, "contact")

    def test_wanted_accuracy(self):
        """The worst of all cases is named."""
        for accuracy, words in (("0.1", "0.1000, worst in SUBCASE 1: not reached: the estimated mesh error is 1.7E-01"),
                                ("0.5", "0.5000, worst in SUBCASE 1: reached: the estimated mesh error is 1.7E-01")):
            deck = of_factors(INPUT / "hertz/hertz44_elastic.dat", [0.5, 1.0, 0.25], param=f"PARAM,ACCURACY,{accuracy}\n")
            last = run(deck)[1]["listing"].decode().splitlines()[-1]
            self.assertEqual(last, f"  wanted error of contact pressures {words}")

    def test_names_with_xml_characters(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / 'a&b<"c.dat'
            path.write_text(of_factors(INPUT / "hertz/hertz44_elastic.dat", [1.0, 2.0]))
            subprocess.run([PROGRAM, path, "--vtk", "--quiet"], cwd=folder, check=True)
            sets = xml.etree.ElementTree.parse(path.with_suffix(".pvd")).getroot()[0]
            self.assertEqual([one.attrib["file"] for one in sets], ['a&b<"c.case1.vtu', 'a&b<"c.case2.vtu'])

    def test_the_largest_status_is_that_of_the_run(self):
        """A case without equilibrium does not affect the others."""
        cards, loads = bulk(INPUT / "hertz/hertz44_elastic.dat")
        deck = f"SUBCASE 1\nLOAD = {loads}\nSUBCASE 2\nLOAD = 99\nSUBCASE 3\nLOAD = {loads}\nBEGIN BULK\nLOAD,99,-1.0,1.0,{loads}\n{cards}"
        status, tables = run(deck)
        self.assertEqual(status, 1)
        self.assertEqual([row["value"] for row in tables["summary"] if row["key"] == "status"], ["valid", "no equilibrium", "valid"])

    def test_contact_off_and_on(self):
        """Without contact a case that supports alone restrain has an answer; penetration gives a warning."""
        cards, loads = bulk(INPUT / "hertz/hertz44_elastic.dat")
        held = cards.replace("SPC1    1", "SPC1    2")
        held = "".join(line + "\n" for line in held.split("\n") if line.startswith("SPC1"))
        deck = (f"LOAD = {loads}\nSPC = 1\nSUBCASE 1\nSUBCASE 2\nSPC = 2\nBCONTACT = NONE\nLOAD = 50\nSUBCASE 3\nSPC = 2\nLOAD = 50\n"
                f"BEGIN BULK\nSPC,2,41,2,0.0\nSPCD,50,41,2,-1.0-4\n{held}{cards}")
        status, tables = run(deck)
        self.assertEqual(status, 0)
        touching = [row for row in tables["contact"] if row["status"] == "touching"]
        self.assertEqual({row["subcase"] for row in touching}, {"1", "3"})

    def test_order(self):
        """Lines on standard output and in the tables have the order of the deck, although the second case is solved last."""
        cards, loads = bulk(INPUT / "hertz/hertz44_elastic.dat")
        held = "".join(line + "\n" for line in cards.replace("SPC1    1", "SPC1    2").split("\n") if line.startswith("SPC1"))
        deck = (f"SPC = 1\nSUBCASE 8\nLOAD = {loads}\nSUBCASE 3\nSPC = 2\nLOAD = 50\nSUBCASE 5\nLOAD = 51\n"
                f"BEGIN BULK\nSPC,2,41,2,0.0\nSPCD,50,41,2,-1.0-2\nLOAD,51,-1.0,1.0,{loads}\n{held}{cards}")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "deck.dat"
            path.write_text(deck)
            done = subprocess.run([PROGRAM, path], capture_output=True, text=True, cwd=folder, check=False)
            self.assertEqual([line.split()[:4] for line in done.stdout.splitlines()],
                             [["deck", "SUBCASE", "8", "valid"], ["deck", "SUBCASE", "3", "valid"], ["deck", "SUBCASE", "5", "no"]])
            cases = list(csv.DictReader(path.with_suffix(".cases.csv").open()))
        self.assertEqual(["8", "3", "5"], [row["subcase"] for row in cases])
        self.assertEqual([True, True, False], [bool(row["pairs_in_contact"] and row["plastic_elements"]) for row in cases])

    def test_files_of_an_earlier_run(self):
        """ParaView's steps are the cases with an answer; the next run of the deck, with other cases or none, leaves none of them."""
        cards, loads = bulk(INPUT / "hertz/hertz44_elastic.dat")
        cases = f"SUBCASE 4\nLOAD = {loads}\nSUBCASE 7\nLOAD = 99\nBEGIN BULK\nLOAD,99,-1.0,1.0,{loads}\n{cards}"
        with tempfile.TemporaryDirectory() as folder:
            deck = pathlib.Path(folder) / "deck.dat"

            def vtk(text):
                deck.write_text(text)
                subprocess.run([PROGRAM, deck, "--vtk", "--quiet"], capture_output=True, cwd=folder, check=False)
                return sorted(path.name for path in deck.parent.glob("*.vtu"))

            self.assertEqual(vtk(cases), ["deck.case4.contact.vtu", "deck.case4.vtu"])
            self.assertEqual(re.findall('file="(.*)"', deck.with_suffix(".pvd").read_text()), ["deck.case4.vtu"])
            row = list(csv.DictReader(deck.with_suffix(".cases.csv").read_text().splitlines()))[1]
            self.assertEqual([row["approach"], row["equilibrium_residual"], row["mesh_error_energy_norm"], row["mesh_error_max_pressure"]], [""] * 4)
            self.assertEqual(vtk(cases.replace("SUBCASE 4", "SUBCASE 5")), ["deck.case5.contact.vtu", "deck.case5.vtu"])
            self.assertEqual(vtk(f"BEGIN BULK\n{cards}".replace("LOAD,99", "$")), ["deck.contact.vtu", "deck.vtu"])
            self.assertFalse(deck.with_suffix(".pvd").exists())


if __name__ == "__main__":
    unittest.main()
