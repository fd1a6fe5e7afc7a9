"""tools/paraview: pictures without overlapping items, and messages about decks that it cannot draw. Status 77: no ParaView."""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np
from matplotlib.image import imread

TOP = pathlib.Path(__file__).resolve().parents[2]
DECK = TOP / "input" / "from_gmsh" / "blocks.dat"
WHITE = 0.99
USAGE = "usage: tools/paraview [-h] [-o NAME.png] [--scale SCALE]"


class Pictures(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.place = pathlib.Path(directory.name)

    def run_it(self, *arguments):
        run = subprocess.run([TOP / "tools" / "paraview", *arguments], cwd=self.place, capture_output=True, text=True)
        self.assertNotIn("Traceback", run.stderr)
        return run

    def drawn(self, name, *arguments):
        run = self.run_it(*arguments)
        self.assertEqual(0, run.returncode, run.stderr)
        return imread(self.place / name)[:, :, :3]

    def test_whole(self):
        """Rows between body and colour scales, and between body and heading, are white."""
        picture = self.drawn("blocks.paraview.png", DECK, "--scale", "20")
        self.assertEqual((440, 550, 3), picture.shape)
        inked = (picture.min(axis=2) < WHITE).any(axis=1)
        self.assertFalse(inked[336:346].any() or inked[28:32].any(), np.flatnonzero(inked))
        self.assertTrue(inked[40:330].all())
        self.assertTrue(inked[5:25].any() and inked[350:370].any())

    def test_near(self):
        picture = self.drawn("near.png", DECK, "-o", "near.png", "--near=1.5,2,1")
        self.assertEqual((440, 1000, 3), picture.shape)
        self.assertGreater((picture[:, 505:].min(axis=2) < WHITE).mean(), 0.5)

    def test_rejected(self):
        run = self.run_it(TOP / "input" / "faults" / "no_suport.dat", "-o", "no.png")
        self.assertEqual((2, False), (run.returncode, (self.place / "no.png").exists()))
        self.assertIn("unconstrained rigid-body mode", run.stderr)

    def test_usage(self):
        for arguments, said in ((("--near", "2"), "argument --near: '2': three numbers and commas, a place and half the height above zero, such as 2.0,-0.5,1.5"),
                                (("--near", "1,2,0"), "argument --near: '1,2,0': three"),
                                (("-o", "a.jpg"), "-o a.jpg: not a PNG file: give a name that ends in .png")):
            with self.subTest(arguments):
                run = self.run_it(DECK, *arguments)
                self.assertEqual(2, run.returncode)
                self.assertIn(f"tools/paraview: error: {said}", run.stderr)
                self.assertTrue(run.stderr.startswith(USAGE), run.stderr)


if __name__ == "__main__":
    if not shutil.which("pvpython"):
        print("skipped: no pvpython")
        sys.exit(77)
    unittest.main()
