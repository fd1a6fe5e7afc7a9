#!/usr/bin/env python3
"""Small models of many pairs and bodies (tools/decks blocks, strip, stack, dovetail): valid, and consistent with statics; as inputs of
CalculiX they have the same parts."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[2] / folder) for folder in ("tools", "tools/benchmark")]
import calculix_deck  # noqa: E402
import tables  # noqa: E402
from scenes import many  # noqa: E402

PROGRAM = os.environ["EPCONT_PROGRAM"]


class Many(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.place = pathlib.Path(place.name)

    def solve(self, deck):
        """Summary and zones in contact of a valid answer."""
        (self.place / "a.dat").write_text(deck.text(), encoding="ascii")
        run = subprocess.run([PROGRAM, "a.dat"], cwd=self.place, capture_output=True, text=True, check=False)
        self.assertEqual(0, run.returncode, run.stdout + run.stderr)
        return tables.summary(self.place / "a.summary.csv"), tables.rows(self.place / "a.contact.csv")

    def test_blocks(self):
        for yields in (False, True):
            summary, pairs = self.solve(many.blocks(60, 1500, load=20000.0, yields=yields))
            self.assertAlmostEqual(20000.0, float(summary["total_contact_force"]), delta=1e-4)
            self.assertEqual(60, len(pairs))
            self.assertEqual(yields, int(summary["plastic_elements"]) > 0)
            self.assertEqual({"bounded"}, {summary["max_pressure_is"]})

    def test_so_many_nodes(self):
        for pairs, nodes in ((60, 1500), (200, 4000), (100, 2200)):
            count = many.blocks(pairs, nodes).text().count("\nGRID*")
            self.assertLess(abs(count / nodes - 1), 0.03)

    def test_strip(self):
        summary, pairs = self.solve(many.strip(100, 3))
        self.assertEqual((100, "100"), (len(pairs), summary["pairs_in_contact"]))
        self.assertAlmostEqual(1e4, float(summary["total_contact_force"]), delta=1e-4)

    def test_stack(self):
        """Each contact carries all of the load."""
        summary, pairs = self.solve(many.stack(4, 6, 5))
        self.assertEqual(3 * 7, len(pairs))
        self.assertAlmostEqual(3 * 100.0, float(summary["total_contact_force"]), delta=1e-3)

    def test_dovetail(self):
        """Flanks at 60 degrees: each carries the pulling force, along its normal."""
        summary, _ = self.solve(many.dovetail(fine=0.4, growth=0.4))
        self.assertAlmostEqual(2000.0, float(summary["total_contact_force"]), delta=5.0)

    def test_calculix(self):
        deck = many.dovetail(fine=0.6, growth=0.5, yields=True).text()
        calculix_deck.write(self.place / "a.inp", deck, "NODE TO SURFACE", "SPOOLES", 1.0)
        lines = (self.place / "a.inp").read_text().splitlines()
        elements = deck.count("\nCTRIA3")
        begin = [k for k, line in enumerate(lines) if line.startswith("*ELEMENT")]
        listed = sum(next(n for n, line in enumerate(lines[k + 1:]) if line.startswith("*")) for k in begin)
        self.assertEqual(elements, listed)
        self.assertEqual(deck.count("\nGRID*"), next(k for k, line in enumerate(lines[1:]) if line.startswith("*")))
        self.assertEqual(2, sum(line.startswith("*CONTACT PAIR") for line in lines))
        self.assertEqual(deck.count("\nPLOADX1"), sum(",P" in line and line[0].isdigit() for line in lines))
        self.assertEqual(2, sum(line == "*PLASTIC" for line in lines))
        self.assertIn("*NSET, NSET=TOLD", lines)
        moved = next(line for line in deck.splitlines() if line.startswith("SUPORT"))[8:16].strip()
        self.assertEqual(moved, lines[lines.index("*NSET, NSET=TOLD") + 1])

    def test_sides_of_elements(self):
        """Corners are listed counter-clockwise, and the edge of a line belongs to its element."""
        cards = calculix_deck.Cards(many.blocks(20, 200).text())
        point, element = calculix_deck.corners(cards)
        side = calculix_deck.sides(element)
        for _, nodes in element.values():
            (ax, ay), (bx, by), (cx, cy) = (point[n] for n in nodes)
            self.assertGreater((bx - ax) * (cy - ay) - (cx - ax) * (by - ay), 0.0)
        for _, *line in cards.whole("BLSEG", 0):
            for a, b in zip(line, line[1:]):
                number, k = side[frozenset((a, b))]
                self.assertEqual({a, b}, {element[number][1][k - 1], element[number][1][k % 3]})


if __name__ == "__main__":
    unittest.main()
