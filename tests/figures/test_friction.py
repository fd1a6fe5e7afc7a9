#!/usr/bin/env python3
"""Friction: two cylinders pressed and pushed (Cattaneo, Mindlin), and a block that only friction holds. Both contact solvers."""
import csv
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from scenes import friction, many  # noqa: E402

PROGRAM = os.environ["EPCONT_PROGRAM"]
RULES = ("CONRY", "JOINED")


def run(text, rule, status=0, increments=False, listing=False):
    """Rows of friction, the summary of each load case and, on request, the increments; or what was said and the listing."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "deck.dat"
        path.write_text(text.replace("BEGIN BULK", f"BEGIN BULK\nPARAM,RULE,{rule}"), encoding="ascii")
        done = subprocess.run([PROGRAM, "--quiet", path.name], cwd=folder, capture_output=True, text=True, timeout=60, check=False)
        if done.returncode != status:
            raise AssertionError(done.stdout + done.stderr)
        if status or listing:
            return done.stderr, path.with_suffix(".lst").read_text()
        return [list(csv.DictReader(path.with_suffix(f".{table}.csv").read_text().splitlines()))
                for table in ["friction", "summary"] + ["increments"] * increments]


def values(summary, key):
    return [float(row["value"] or "nan") for row in summary if row["key"] == key]


class Cylinders(unittest.TestCase):
    """Traction within 1 % of its largest value, but for the nodes beside its kinks, and stick width within 1 %."""

    PUSHES = 0.6, -0.2

    def check(self, lines):
        answers = []
        for rule in RULES:
            rows, summary = run(friction.cattaneo(lines=lines).text(), rule)
            answers.append(rows)
            for case in (1, 2):
                pushes = self.PUSHES[:case]
                sticks = math.sqrt(1 - (pushes[0] if case == 1 else (pushes[0] - pushes[1]) / 2))
                self.assertAlmostEqual(values(summary, "stick_half_width")[case] / sticks, 1, delta=0.01)
                true = friction.largest_traction(pushes)
                off = [abs(values(summary, "max_shear")[case] - true), values(summary, "mesh_error_shear_zone_1")[case]]
                self.assertLess(off[0], off[1])
                self.assertLess(off[1], 3 * off[0])
                kinks = [1.0] + [math.sqrt(1 - self.PUSHES[0]), sticks][:case]
                largest = max(abs(friction.traction(pushes, 0.01 * k)) for k in range(101))
                for row in rows:
                    x = float(row["x"])
                    if int(row["subcase"]) == case + 1 and all(abs(abs(x) - kink) > 0.1 for kink in kinks):
                        self.assertAlmostEqual(-float(row["shear"]), friction.traction(pushes, x), delta=0.01 * largest, msg=f"{case} {x}")
        for one, other in zip(*answers):
            self.assertEqual(one["state"], other["state"])
            self.assertAlmostEqual(float(one["friction_force"]), float(other["friction_force"]), delta=1e-9)

    def test_pairs(self):
        self.check(lines=False)

    def test_lines(self):
        self.check(lines=True)

    def test_cycle(self):
        """A closed cycle of the push dissipates the work of the loads, both by trapezoids. With constant contact forces, the energy dissipated needs no small
        increments. Friction forces and counts of the increments are those of the summary."""
        lost = []
        for rule, steps, lines in (("CONRY", 1, False), ("JOINED", 1, False), ("CONRY", 5, False), ("JOINED", 1, True)):
            pushes = [0.6 * (1 - abs(k % (4 * steps) - 2 * steps) / steps) for k in range(2 * steps, 6 * steps + 1)]
            _, summary, increments = run(friction.cattaneo(n=4, pushes=[0.6, *pushes[1:]], lines=lines).text(), rule, increments=True)
            for column, key in (("friction_force", "total_friction_force"), ("pairs_sticking", "pairs_sticking"), ("pairs_slipping", "pairs_slipping")):
                self.assertEqual([float(row[column]) for row in increments], values(summary, key))
            approach = next(row["key"] for row in summary if row["key"].startswith("approach") and row["key"].endswith("_1"))
            moved = values(summary, approach)[1:]
            work = sum(friction.MU * friction.NORMAL * (p + q) / 2 * (v - u) for p, q, u, v in zip(pushes, pushes[1:], moved, moved[1:]))
            found = [[float(row[key]) for row in increments[2:]] for key in ("friction_work", "dissipated")]
            self.assertAlmostEqual(sum(found[0]) / work, 1.0, delta=1e-10)
            self.assertGreaterEqual(min(found[1]), 0.0)
            lost.append(sum(found[1]))
        self.assertAlmostEqual(lost[1] / lost[0], 1.0, delta=1e-9)
        self.assertAlmostEqual(lost[2] / lost[0], 1.0, delta=1e-9)

    def test_full_sliding(self):
        """Beyond mu P nothing carries the push; just below, nearly all pairs slip."""
        rows, _ = run(friction.cattaneo(n=4, pushes=(0.999,)).text(), "AUTO")
        self.assertLessEqual(sum(row["state"] == "sticks" for row in rows if row["subcase"] == "2"), 1)
        for rule in RULES:
            said, _ = run(friction.cattaneo(n=4, pushes=(1.001,)).text(), rule, status=1)
            self.assertRegex(said, r": the load moves the body of GRID \d+ along \+x \(SUPORT at GRID \d+\), and neither contact nor friction resists it")

    def test_load_that_slips(self):
        """A push of 1.25 mu P slips at .8 of it: results are those of the last increment before, halved to 1/64 of 1/4 of the load."""
        deck = friction.cattaneo(n=4, pushes=(1.25,)).text().replace("NLPARM  2       1", "NLPARM  2       4")
        for rule in RULES:
            said, listing = run(deck, rule, status=1)
            self.assertIn("SUBCASE 2: limit load exceeded after load factor 0.7969 of the load case: the load moves the body", said)
            self.assertIn("neither contact nor friction resists it. Results are those at this load factor", said)
            at_once, _ = run(friction.cattaneo(n=4, pushes=(90.0,)).text(), rule, status=1)   # 1/64 is too much
            self.assertIn("exceeded after load factor 0.0 of", at_once)
            forces = [line.split()[-1] for line in listing.splitlines() if "total friction force" in line]
            self.assertAlmostEqual(float(forces[-1]) / (1.25 * 204 / 256 * 0.25892247145), 1.0, delta=1e-5)


class Slipping(unittest.TestCase):
    """Forces by statics while all pairs slip."""

    def test_dovetail(self):
        """The flanks carry more after the load has fallen than at the same load before."""
        for rule in RULES:
            _, summary = run(many.dovetail(fine=0.6, growth=0.5, friction=0.1).text(), rule)
            angle = math.radians(60)
            for found, part, way in zip(values(summary, "total_contact_force"), many.SPIN, (1, 1, -1, 1)):
                self.assertAlmostEqual(found / 2, part * 500 / (math.cos(angle) + way * 0.1 * math.sin(angle)), delta=0.1)

    def test_ring_pulled_off(self):
        """Axisymmetric: the ring slips off under mu p times the area of Lame's pressure."""
        for rule in RULES:
            _, summary = run(friction.pull_off(around=4).text(), rule)
            forces = values(summary, "total_friction_force")
            self.assertAlmostEqual(forces[-1], 37135.1, delta=0.4)
            self.assertAlmostEqual(forces[-2], forces[-1], delta=1e-6)
            self.assertLess(forces[1], 0.6 * forces[-1])


class Incline(unittest.TestCase):
    """A block on an inclined plane, pulled down by its weight: it stands up to tan(angle) = mu, although SUPORT leaves it free."""

    def text(self, slope, mu):
        angle = math.atan(slope)
        c, s = math.cos(angle), math.sin(angle)

        def at(x, y):
            return f"{c * x + s * y:.15f},{-s * x + c * y:.15f}"

        places = {1: (0, 0), 2: (1, 0), 3: (1, 1), 4: (0, 1), 5: (0, 1), 6: (1, 1), 7: (1, 2), 8: (0, 2)}
        return ("BEGIN BULK\nPARAM,PLANE,STRAIN\n" + "".join(f"GRID,{node},,{at(*place)}\n" for node, place in places.items())
                + "CQUAD4,1,1,1,2,3,4\nCQUAD4,2,1,5,6,7,8\nPSHELL,1,1,1.\nMAT1,1,1000.,,.3\nSPC1,1,12,1,2\nFORCE,1,7,,1.,0.,-1.\nFORCE,1,8,,1.,0.,-1.\n"
                f"FORCE,1,5,,1.,0.,-1.\nFORCE,1,6,,1.,0.,-1.\nCORD2R,3,,0.,0.,0.,0.,0.,1.\n,{s:.15f},{c:.15f},0.\n"
                f"CGAP,11,9,4,5,,,,3\nCGAP,12,9,3,6,,,,3\nPGAP,9,0.,,,,,{mu}\nSUPORT,5,1,5,2,6,2\nENDDATA\n")

    def test_stands(self):
        for rule in RULES:
            for slope in (0.05, 0.299):
                rows, _ = run(self.text(slope, 0.3), rule)
                self.assertAlmostEqual(sum(float(row["friction_force"]) for row in rows), -4 * math.sin(math.atan(slope)), delta=1e-9)

    def test_slides(self):
        for rule in RULES:
            said, _ = run(self.text(0.301, 0.3), rule, status=1)
            self.assertIn("neither contact nor friction resists it", said)

    def test_lifted(self):
        """Nothing touches: the friction limits are zero, with either contact solver."""
        lifted = self.text(0, 0.3).replace("SUPORT,5,1,5,2,6,2", "SPC1,1,12,7,8").replace("-1.\n", "1.\n")
        for rule in RULES:
            with tempfile.TemporaryDirectory() as folder:
                path = pathlib.Path(folder) / "deck.dat"
                path.write_text(lifted.replace("ENDDATA", f"PARAM,RULE,{rule}\nENDDATA"), encoding="ascii")
                subprocess.run([PROGRAM, "--quiet", path.name], cwd=folder, stderr=subprocess.DEVNULL, timeout=60, check=True)
                listing = path.with_suffix(".lst").read_text()
            self.assertNotIn("attempts:", listing)

    def test_contact_off(self):
        """The block, held at its top, is pushed without contact; then friction resists its way back."""
        cases = "".join(f"SUBCASE {case}\nLOAD = {load}\n{contact}" for case, load, contact in ((1, 1, ""), (2, 11, "BCONTACT = NONE\n"), (3, 1, "")))
        deck = ("SOL 106\nCEND\nSPC = 1\n" + cases + self.text(0, 0.3).replace("SUPORT,5,1,5,2,6,2", "SPC1,1,12,7,8\nLOAD,11,1.,1.,1,1.,2")
                .replace("ENDDATA", "FORCE,2,5,,1.,1.\nFORCE,2,6,,1.,1.\nENDDATA"))
        for rule in RULES:
            rows, _ = run(deck, rule)
            for row in (row for row in rows if row["subcase"] == "3"):
                self.assertLess(float(row["slip"]), -1e-4)
                self.assertAlmostEqual(float(row["friction_force"]), 0.3 * float(row["force"]), delta=1e-12)
            self.assertEqual(rows[-1]["subcase"], "3")

    def test_without_friction(self):
        said, _ = run(self.text(0.05, 0.3).replace("ENDDATA", "PARAM,FRICTION,NO\nENDDATA"), "AUTO", status=1)
        self.assertIn("and no contact resists it", said)


if __name__ == "__main__":
    unittest.main()
