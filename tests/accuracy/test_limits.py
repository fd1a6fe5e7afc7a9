#!/usr/bin/env python3
"""Singular largest pressures are called singular with every element type and every kind of contact; those of smooth
contact never are, on any mesh.

    test_limits.py PROGRAM
"""
import itertools
import pathlib
import subprocess
import sys
import tempfile
import unittest

import chance
import curved
from chance import quads
from score_by_chance import figures_of, solve

PROGRAM = sys.argv.pop(1)
UNBOUNDED, NOT_RESOLVED = "singular: diverges with mesh refinement", "mesh too coarse: too few pairs in contact where it is largest"
GIVEN = r"^\d\.\dE[-+]\d\d +[\d.]+ %$"
#: Kinds of contact.
TOUCH = {"pairs": {}, "rigid": {"rigid": True}, "lines": {"lines": True}, "exchanged": {"lines": True, "exchanged": True}}


def said(family, element, pairs, touch, **more):
    """Text of the listing about the largest pressure."""
    scene = chance.Scene(family, element in chance.RINGS, (1000.0, 1500.0), **TOUCH[touch], **more)
    scene.load = chance.nominal_load(scene)
    mesh = chance.Fineness(pairs, 1.3, 0.8 if touch == "exchanged" else 1.4, 0.4, 1.0, 0.0, 1)   # the slave is the coarser one
    summary, zones, listing = solve(PROGRAM, chance.make(scene, element, mesh))
    largest = max(zones, key=lambda zone: float(zone["max_pressure"]))
    words = figures_of(summary, [largest], listing)["p"][2]
    # The value, the summary of the listing and the tables have the same text.
    word = words.split(":")[0] if ":" in words else "bounded"
    beside = next(line for line in listing.splitlines() if line.startswith("  largest pressure "))
    if not (word == largest["max_pressure_is"] == summary["max_pressure_is"] and beside.endswith(words) == (word != "bounded")):
        return f"{words!r} in ACCURACY, {beside!r}, {summary['max_pressure_is']!r} in the summary, {largest['max_pressure_is']!r} in the zones"
    return words


class Limits(unittest.TestCase):
    def each(self, check, touches=tuple(TOUCH), **more):
        """Check the text for each element type, for half of the model and, in the plane, for all of it."""
        for element, touch in itertools.product(chance.PLANE + chance.RINGS, touches):
            for pairs, whole in ((3.4, False), (7.0, element in chance.PLANE and more["family"] != "sharp punch")):
                with self.subTest(element=element, touch=touch, pairs=pairs, **more):
                    check(UNBOUNDED, said(element=element, touch=touch, pairs=pairs, whole=whole, **more))

    def test_a_tip(self):
        self.each(self.assertEqual, family="wedge")

    def test_a_sharp_edge(self):
        self.each(self.assertEqual, ("pairs", "lines", "exchanged"), family="sharp punch")

    def test_smooth_contact(self):
        for family in ("round", "rounded punch"):
            self.each(self.assertNotEqual, family=family, lasts=2.2)

    def test_flush_ends(self):
        """Two blocks of equal width end together: pressures are finite there."""
        for element, touch in itertools.product(chance.PLANE, ("pairs", "lines", "exchanged")):
            with self.subTest(element=element, touch=touch):
                self.assertRegex(said("stack", element, 5.0, touch, whole=True, wide=(1.0, 1.0), deep=(2.0, 2.0)), GIVEN)

    def test_fixed_base(self):
        """A base of elements whose nodes are all fixed, cut off at the symmetry line, has no corner there."""
        for element in chance.PLANE:
            with self.subTest(element=element):
                self.assertRegex(figures_of(*solve(PROGRAM, quads.layer_lines(11, element)))["p"][2], GIVEN)

    def test_the_line_of_a_run(self):
        with tempfile.TemporaryDirectory() as place:
            for deck, words in (("flat_punch/flat_punch", r" \(singular\)"), ("hertz/hertz44_elastic", "")):
                path = pathlib.Path(__file__).resolve().parents[2] / "input" / f"{deck}.dat"
                run = subprocess.run([PROGRAM, path, "-o", place], capture_output=True, text=True, check=True)
                self.assertRegex(run.stdout, rf"^{path.stem}  valid  p_max +\d\.\d{{5}}E[-+]\d\d{words}  approach +-\d\.\d{{5}}E[-+]\d\d\n$")

    def test_whole_circles(self):
        """A closed zone has no end, and its even pressure (Lame) has an error estimate."""
        for element in chance.PLANE:
            for hole, pin in ((60, 40), (40, 8), (60, 12), (30, 24)):
                with self.subTest(element=element, hole=hole, pin=pin):
                    pressure, estimate, words = figures_of(*solve(PROGRAM, curved.press_fit(element, hole, pin)))["p"]
                    self.assertRegex(words, GIVEN)
                    self.assertLess(abs(pressure - curved.lame()), estimate)

    def test_chords(self):
        """Mid-side nodes on the chords of a cylinder make the gap oscillate: errors of pressure and approach are several times those on the arc."""
        for straight in (False, True):
            scene = curved.Cylinder("ctria6", 24, 30, 10, straight_sides=straight)
            figures = figures_of(*solve(PROGRAM, scene.deck()))
            for key, true in (("p", 837.6), ("q1", curved.APPROACH[400.0, 1.0])):
                with self.subTest(straight=straight, figure=key):
                    self.assertLess(abs(figures[key][0] - true), figures[key][1])

    def test_too_few_pairs(self):
        for element in chance.PLANE:
            self.assertEqual(NOT_RESOLVED, said("round", element, 0.6 if element != "ctria6" else 0.3, "rigid", lasts=4.0))


if __name__ == "__main__":
    unittest.main()
