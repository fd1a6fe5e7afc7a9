#!/usr/bin/env python3
"""Models of tools/deceive and their twins, mirrored, moved, renumbered: neither rounding nor the order of nodes decides estimates.

Usage: EPCONT_PROGRAM=... test_twins.py
"""
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from deceiving.judging import Judge, twins_of  # noqa: E402
from deceiving.scenes import Twin, deck  # noqa: E402
from tables import rows, summary  # noqa: E402

#: Family, number; rounding once decided these.
SCENES = (("nose_in_groove", 0, "two pairs at the tip: which is the neighbour of the next, and which belong to the zone"),
          ("nose_in_groove", 2, "rounding in the coordinates of straight flanks was waves as high as the tip"),
          ("shrink_fit", 0, "a zone that goes all around, cut where the deck begins it"),
          ("concave_corner", 2, "the first of the nodes beside a corner, which may be fixed, gave the compliance of a body"))
NEAR = 1e-5   # relative rounding of a value


def figures(folder, name):
    """Estimates, and the names of pressures: sorted values by key, without the numbers of zones, bodies and nodes."""
    found = {}
    for key, value in summary(folder / f"{name}.summary.csv").items():
        if key.startswith("mesh_error") or key == "max_pressure_is":
            found.setdefault(re.sub(r"_\d.*", "", key), []).append(value)
    for row in rows(folder / f"{name}.bodies.csv"):
        found.setdefault("bodies", []).extend((row["mesh_error_x"], row["mesh_error_y"]))
    for row in rows(folder / f"{name}.zones.csv"):
        found.setdefault("zones", []).extend((row["force"], row["half_width"], row["max_pressure_is"]))
    return {key: sorted(values, key=lambda text: (float(text), "") if text[-1:].isdigit() else (0.0, text))
            for key, values in found.items()}


def solved(decks, read):
    """Solve decks; return what `read` takes from the results of each, by folder and name."""
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for k, text in enumerate(decks):
            (folder / f"{k}.dat").write_text(text)
        subprocess.run([os.environ["EPCONT_PROGRAM"], "--quiet", *(f"{k}.dat" for k in range(len(decks)))], cwd=folder, check=True,
                       stderr=subprocess.DEVNULL)
        return [read(folder, str(k)) for k in range(len(decks))]


def beam_on_posts(unit):
    """A deck in this unit of length, newtons; the posts are crowned."""
    cards, elements = ["BEGIN BULK", "PARAM,PLANE,STRAIN", f"MAT1,1,{2e11 / unit**2:.9E},,0.3", f"PSHELL,1,1,{unit}"], 0
    for first, left, columns, low, high in ((100, 0.0, 8, 1.0, 2.0), (200, 0.5, 2, 0.0, 1.0), (300, 6.5, 2, 0.0, 1.0)):
        step = 8.0 / 8 if columns == 8 else 0.5
        for j, y in enumerate((low, high)):
            for i in range(columns + 1):
                crown = 0.02 * (i != 1) * (j == 1) * (columns == 2)
                cards.append(f"GRID,{first + 10 * j + i},,{unit * (left + step * i)},{unit * (y - crown)},0.0")
        for i in range(columns):
            elements += 1
            cards.append(f"CQUAD4,{elements},1,{first + i},{first + i + 1},{first + 11 + i},{first + 10 + i}")
    cards += ["SPC1,1,12,200,201,202,300,301,302", "SPC1,1,1,100", "SUPORT,100,2,108,2", "FORCE,1,113,0,1000.0,0.0,-1.0,0.0"]
    for line, nodes in ((1, range(100, 109)), (2, range(210, 213)), (3, range(310, 313))):
        nodes = [str(node) for node in nodes]
        cards.append(f"BLSEG,{line}," + ",".join(nodes[:7]) + ("" if len(nodes) < 8 else "\n," + ",".join(nodes[7:])))
    return "\n".join(cards + ["BCONP,1,2,1", "BCONP,2,3,1", "ENDDATA", ""])


class Twins(unittest.TestCase):

    def near(self, one, other, of):
        self.assertEqual(len(one), len(other), of)
        for a, b in zip(one, other):
            if a != b:
                self.assertLessEqual(abs(float(a) - float(b)), NEAR * abs(float(a)) + 1e-12, f"{of}: {a}, {b}")

    def test_twins(self):
        for family, number, why in SCENES:
            scene, finer = Judge(None, "1", 0.0).scenes(family, number)
            twins = [twin for twin in twins_of(scene, random.Random(1))[0] if twin.name in ("mirrored", "moved")]
            twins += [Twin(f"renumbered {k}", mix=random.Random(k)) for k in range(4)]
            for fine, one in enumerate((scene, finer)):
                base, *others = solved([deck(one, twin)[0] for twin in [Twin("base")] + twins], figures)
                for twin, other in zip(twins, others):
                    for key in base:
                        with self.subTest(family=family, number=number, finer=bool(fine), twin=twin.name, once=why):
                            self.near(base[key], other[key], key)

    def test_order_of_elements(self):
        """Every other element has another section: the first one at a node is arbitrary."""
        cards = re.sub(r"(CQUAD4,\d*[13579]),1", r"\1,2", beam_on_posts(1.0)).replace("PSHELL", "MAT1,2,1.+11,,0.3\nPSHELL,2,2,1.0\nPSHELL")
        elements, other = ([card for card in cards.split("\n") if card.startswith("CQ") == these] for these in (True, False))
        self.near(*solved(["\n".join(other[:1] + some + other[1:]) for some in (elements, elements[::-1])],
                          lambda folder, name: figures(folder, name)["mesh_error_approach"]), "mesh_error_approach")

    def test_motion_that_nothing_drives(self):
        """A press fit that is unconstrained along its axis has the errors of a fixed one: they were 0.0."""
        free = (pathlib.Path(__file__).resolve().parents[1] / "found/free_along_its_axis.dat").read_text(encoding="ascii")
        found = solved([free, free.replace("SUPORT,191,2", "SPC1,1,2,207")],
                       lambda folder, name: float(summary(folder / f"{name}.summary.csv")["mesh_error_total_contact_force"]))
        self.assertLess(abs(found[0] - found[1]), 0.2 * found[1], found)

    def test_units_of_length(self):
        """A beam on two posts, pressed beside its middle: the errors of the posts' forces are the same in metres and in micrometres."""
        found = solved([beam_on_posts(1.0), beam_on_posts(1e6)],
                       lambda folder, name: [float(row["mesh_error_y"]) for row in rows(folder / f"{name}.bodies.csv")])
        self.assertGreater(found[0][1], 0.0)
        self.near(found[0], found[1], "mesh_error_y")


if __name__ == "__main__":
    unittest.main()
