"""Panels of tools/plot for load histories: their curves and their choice of elements, for one body and for two."""
import os
import pathlib
import sys
import tempfile
import unittest
import unittest.mock

import numpy as np

ROOT = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests/figures")]
from blocks import two_blocks  # noqa: E402
from drawing import figure, loading  # noqa: E402
from drawing.run import Run  # noqa: E402

#: Two blocks: the upper one is pressed on the wider one below, by SPCD, and lifted.
BLOCKS = """SOL 106
CEND
SPC = 1
NLPARM = 1
SUBCASE 1
LOAD = 1
SUBCASE 2
LOAD = 2
BEGIN BULK
NLPARM,1,4
PARAM,PLANE,STRAIN
PSHELL,1,1,1.
MAT1,1,1000.,,.3
MATS1,1,,PLASTIC,20.,1,1,2.
SPC1,1,12,101,THRU,113
SPC1,1,1,19,THRU,27
SPC1,1,2,19,THRU,27
BLSEG,1,1,THRU,9
BLSEG,2,153,THRU,165
BCONP,1,1,2
"""


def blocks(last):
    text = BLOCKS + two_blocks(lower=1)
    for case, down in (1, -0.03), (2, last):
        text += "".join(f"SPCD,{case},{node},2,{down}\n" for node in range(19, 28))
    return text + "ENDDATA\n"


class Plot(unittest.TestCase):
    def setUp(self):
        self.enterContext(unittest.mock.patch("drawing.run.PROGRAM", pathlib.Path(os.environ["EPCONT_PROGRAM"]).resolve()))
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def run_of(self, text):
        deck = self.folder / "deck.dat"
        deck.write_text(text)
        return Run(deck)

    def test_cylinders(self):
        run = Run(ROOT / "input/hertz/hertz330_unloaded.dat")
        found = loading.cases(run)
        self.assertEqual(["SUBCASE 1, loaded", "SUBCASE 2, unloaded", "SUBCASE 3, loaded"], [name for name, _ in found])
        self.assertEqual([8, 5, 5], [len(values["approach"]) for _, values in found])
        for (_, one), (_, other) in zip(found, found[1:]):
            self.assertEqual(one["approach"][-1], other["approach"][0])
        self.assertEqual(("2", "SUBCASE 2 (0.1 % of the force)"), (loading.unloaded_case(run.increments)[0], run.unloaded))
        self.assertEqual((108, 46.106), ((run.accumulated > 0).sum(), round(run.residual["sx"].max(), 3)))
        chosen, depth = loading.below_contact(run)
        point = max(run.pressed, key=lambda row: float(row["pressure"]))
        self.assertGreater(len(chosen), 20)
        self.assertTrue((np.diff(depth) > 0).all() and depth[0] > 0)
        for e in chosen:
            x = run.x[run.around[e]][:, 0]
            self.assertTrue(x.min() <= float(point["x"]) <= x.max())
        self.assertEqual(["shape", "yielded", "yielded", "contact", "history", "history", "history"], [kind for kind, *_ in figure.panels(run, ())])
        figure.draw(run)

    def test_two_bodies_without_approach_that_separate(self):
        run = self.run_of(blocks(-0.002))
        self.assertEqual(0, run.exit_status, run.message)
        _, depth = loading.below_contact(run)
        self.assertTrue((depth < 0).any() and (depth > 0).any())
        self.assertEqual(12, len(depth))   # both sides of an edge between elements
        self.assertFalse(np.isfinite(loading.cases(run)[0][1]["approach"]).any())
        figure.draw(run, "history")

    def test_loading_only(self):
        run = self.run_of(blocks(-0.04))
        self.assertIsNone(run.unloaded)
        self.assertEqual(2, sum(kind == "history" for kind, *_ in figure.panels(run, ())))

    def test_friction(self):
        """Shear within its limits, known values beside it, and slip; no history of a force that stays the same."""
        run = Run(ROOT / "input/cattaneo/cattaneo.dat", 3)
        line, = run.lines
        self.assertTrue((abs(line.shear) <= line.friction * line.pressure * (1 + 1e-12)).all())
        self.assertGreater(abs(line.shear).max(), 0.07)
        self.assertEqual(["shape", "shape", "contact", "friction", "friction"], [kind for kind, *_ in figure.panels(run, ())])
        with unittest.mock.patch("drawing.pressures.known_values", side_effect=lambda formula, s: 0.0 * s + len(formula)) as known:
            figure.draw(run, "friction", ["s", "shear:s**2"])
        self.assertEqual(["s**2"], [call.args[0] for call in known.call_args_list])
        self.assertEqual(2, sum(kind == "history" for kind, *_ in figure.panels(Run(ROOT / "input/dovetail_friction/dovetail_friction.dat"), ())))

    def test_without_contact_the_iteration_is_drawn(self):
        run = Run(ROOT / "input/one_element/one_element_flow.dat")
        self.assertEqual(1, sum(kind == "history" for kind, *_ in figure.panels(run, ())))
        self.assertEqual([], run.pressed)


if __name__ == "__main__":
    unittest.main()
