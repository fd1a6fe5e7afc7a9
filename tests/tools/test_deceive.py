"""Tests of tools/deceive: its models and twins are correct, and each type of false answer is found.

Usage: EPCONT_PROGRAM=... test_deceive.py
"""
import contextlib
import io
import os
import pathlib
import random
import re
import sys
import tempfile
import unittest

import common
from deceiving.families import FAMILIES
from deceiving.judging import Fault, Judge, same, solve, through, unlike
from deceiving.scenes import PLANE, RINGS, Scene, Twin, deck, lines_of
from deceiving.shapes import cells, disc

deceive = common.load("deceive")
PROGRAM = os.environ["EPCONT_PROGRAM"]
SOUND = ("stack", 2)   # there is no fault in this model

# Runs the program, then changes a column of a table of one deck.
FALSIFIER = """#!{python}
import csv, pathlib, subprocess, sys
run = subprocess.run(["{program}"] + sys.argv[1:])
path = pathlib.Path("out") / "{name}.{table}.csv"
rows = list(csv.DictReader(path.open()))
for row in rows:
    if {where}:
        row["{column}"] = repr(float(row["{column}"]) {change})
with path.open("w") as file:
    writer = csv.DictWriter(file, list(rows[0]))
    writer.writeheader()
    writer.writerows(rows)
sys.exit(run.returncode)
"""


def drawn(name, number, n=1):
    return FAMILIES[name](random.Random(f"{name} {number}"), n)


def area(scene, body):
    return sum(scene.cross(a, b) for a, _, b in body.sides().values()) / 2


def block(n=1, kind="CQUAD4", gap=0.0):
    """Two blocks of 2 x 1 on each other; the upper is moved down by .01 and the gap."""
    scene = Scene(n, 1.0)
    bodies = [scene.body(kind), scene.body(kind)]
    cells(bodies[0], [-1.0, 1.0], [-1.0, 0.0], 0.5)
    cells(bodies[1], [-1.0, 1.0], [gap, gap + 1.0], 0.5)
    scene.hold(bodies[0].line((-1.0, -1.0), (1.0, -1.0)))
    scene.hold(bodies[1].line((1.0, gap + 1.0), (-1.0, gap + 1.0)), "12", (0.0, -gap - 0.01))
    scene.contact(bodies[1].line((-1.0, gap), (1.0, gap)), bodies[0].line((1.0, 0.0), (-1.0, 0.0)))
    return scene


class Case(common.Case):
    def solve(self, scene, *twins):
        return list(solve(PROGRAM, self.place, [(twin.name, scene, twin) for twin in twins], 60).values())


class Scenes(Case):
    def test_friction_of_all_contacts(self):
        scene = block()
        self.assertNotIn("BFRIC", deck(scene, Twin("base"))[0])
        scene.friction = 0.3
        lines = deck(scene, Twin("base"))[0].splitlines()
        self.assertIn("BCONP,1,1,2,,,1", lines)
        self.assertIn("BFRIC,1,,,0.3", lines)

    def test_the_finer_model_is_the_same_model(self):
        """The same bodies, moduli, element types, loads, and lines between the same points; nine times the elements."""
        for name in FAMILIES:
            for number in range(2):
                one, three = drawn(name, number), drawn(name, number, 3)
                with self.subTest(family=name, number=number):
                    self.assertEqual([(b.kind, b.young, 9 * len(b.elements)) for b in one.bodies],
                                     [(b.kind, b.young, len(b.elements)) for b in three.bodies])
                    self.assertEqual(one.contacts, three.contacts)
                    self.assertEqual([force for _, force in one.forces], [force for _, force in three.forces])
                    for body, finer in zip(one.bodies, three.bodies):   # chords of arcs cut off less if finer
                        self.assertAlmostEqual(area(one, body) / area(three, finer), 1.0, delta=0.08)
                    for k, line in one.lines.items():
                        if name != "line_twice":   # parts of lines are numbers of edges there
                            for end in (0, -1):
                                for x, y in zip(one.nodes[line[end]], three.nodes[three.lines[k][end]]):
                                    self.assertAlmostEqual(x, y, places=9)

    def test_lines_follow_the_outline(self):
        for name in FAMILIES:
            scene = drawn(name, 0)
            sides = {(a, b) for body in scene.bodies for a, _, b in body.sides().values()}
            for line in scene.lines.values():
                corners = scene.corners(line)
                with self.subTest(family=name):
                    self.assertTrue(all((a, b) in sides or (b, a) in sides for a, b in zip(corners, corners[1:])))

    def test_the_same_seed_gives_the_same_deck(self):
        twin = [Twin("mixed", mix=random.Random(5)) for _ in range(2)]
        texts = [deck(drawn("steps", 3), each)[0] for each in twin]
        self.assertEqual(*texts)
        self.assertNotEqual(texts[0], deck(drawn("steps", 4), Twin("base"))[0])

    def test_kinds_are_meshed_right(self):
        """Uniform pressure between blocks: forces from E u/h, for each element type; CTRAX between axisymmetric blocks."""
        for kind in PLANE:
            scene = block(kind=kind)
            for body in scene.bodies:
                body.poisson = 0.0
            answer, = self.solve(scene, Twin("base"))
            self.assertEqual(answer.word, "valid", kind)
            self.assertAlmostEqual(answer.total, 1000.0 * 0.01 / 2.0 * 2.0, places=9)
            self.assertAlmostEqual(answer.resultant[1][1], answer.total, places=9)
        for kind in RINGS:
            scene = Scene(1, 1.0)
            body = scene.body(kind)
            cells(body, [1.0, 2.0], [0.0, 1.0], 0.5)
            self.assertAlmostEqual(area(scene, body), 1.0)

    def test_a_line_is_split_at_a_node(self):
        scene = block()
        lines, contacts = lines_of(scene, Twin("split", split=(1, 0.5)))
        self.assertEqual(contacts, [(1, 2), (1, 3)])
        self.assertEqual(lines[2] + lines[3][1:], scene.lines[2])
        self.assertEqual(lines_of(scene, Twin("exchanged", exchange=True))[1], [(2, 1)])

    def test_twins_are_turned_back(self):
        twin = Twin("turned", angle=0.7, mirror=True, shift=(3.0, 4.0))
        x = twin.point((0.3, 0.2))
        for a, b in zip(twin.back((x[0] - 3.0, x[1] - 4.0)), (0.3, 0.2)):
            self.assertAlmostEqual(a, b)
        base, *others = self.solve(block(), Twin("base"), Twin("rotated", angle=0.7), Twin("mirrored", mirror=True), Twin("moved", shift=(1e3, -1e3)),
                                   Twin("renumbered", mix=random.Random(1)), Twin("reversed", reverse=True))
        self.assertGreater(base.total, 1.0)
        for other in others:
            self.assertIsNone(same(base, other))


class Judging(Case):
    def falsified(self, name, table, column, change, where="True"):
        path = self.place / "falsifier"
        path.write_text(FALSIFIER.format(python=sys.executable, program=PROGRAM, name=name, table=table, column=column, change=change, where=where))
        path.chmod(0o755)
        return str(path)

    def faults(self, program):
        with tempfile.TemporaryDirectory() as folder:
            return [(fault.kind, fault.of) for fault in Judge(program, "1", 60)(*SOUND, pathlib.Path(folder)).faults]

    def test_a_valid_model_has_no_faults(self):
        self.assertEqual(self.faults(PROGRAM), [])

    def test_a_run_that_crashes_takes_no_other_with_it(self):
        path = self.place / "crasher"
        path.write_text(f"#!/bin/sh\ncase $* in *moved.dat*) kill -SEGV $$;; esac\nexec \"{PROGRAM}\" \"$@\"\n")
        path.chmod(0o755)
        self.assertEqual(self.faults(str(path)), [("broken", "moved"), ("twin", "moved")])

    def test_a_twin_that_differs_a_little(self):
        program = self.falsified("rotated", "summary", "value", "* 1.000001", "row['key'] == 'total_contact_force'")
        self.assertEqual(self.faults(program), [("twin", "rotated")])

    def test_a_twin_with_other_displacements(self):
        self.assertEqual(self.faults(self.falsified("moved", "nodes", "ux", "+ 1e-8")), [("twin", "moved")])

    def test_a_total_force_off_by_more_than_estimated(self):
        program = self.falsified("finer", "summary", "value", "* 3", "row['key'] == 'total_contact_force'")
        self.assertEqual(self.faults(program), [("figure", "finer")])

    def test_reactions_of_the_exchanged_model(self):
        self.assertEqual(self.faults(self.falsified("exchanged", "nodes", "ry", "* 3")), [("figure", "exchanged")])

    def test_a_body_within_another(self):
        answer, = self.solve(block(gap=0.1), Twin("base"))
        self.assertLess(through(block(gap=0.1), answer)[1], 1e-6)
        scene = block()
        upper = set(scene.bodies[1].at.values())
        answer.displacement = [(0.0, -0.25 * (k in upper)) for k in range(len(scene.nodes))]
        depth, part, place = through(scene, answer)
        self.assertAlmostEqual(depth, 0.25)
        self.assertAlmostEqual(part, 1.0)
        self.assertIn(round(place[1], 12), (0.0, -0.25))

    def test_chords_of_a_smooth_outline_are_allowed(self):
        """A disc's chords in another's, by the height of the arc over them."""
        for overlap, found in ((0.0, False), (0.3, True)):
            scene = Scene(1, 1.0)
            for y in (1.0, -1.0 + overlap):
                disc(scene.body("CTRIA3"), (0.0, y), 1.0, 0.4)
            answer = self.solve(block(), Twin("base"))[0]
            answer.displacement = [(0.0, 0.0)] * len(scene.nodes)
            self.assertEqual(through(scene, answer)[0] > 0.0, found)

    def test_an_estimate_covers(self):
        base, = self.solve(block(), Twin("base"))
        other, = self.solve(block(), Twin("base"))
        base.energy_error = other.energy_error = 0.0
        base.total_error = other.total_error = 0.0
        other.total *= 1.04
        self.assertIsNone(unlike(base, other))
        other.total *= 1.04
        self.assertEqual(unlike(base, other), "total force off by 7.5 %")
        other.energy_error = 0.2   # that of the total force is stated
        self.assertEqual(unlike(base, other), "total force off by 7.5 %")
        other.total_error = 0.08 * other.total
        self.assertIsNone(unlike(base, other))


class CommandLine(Case):
    def run_it(self, *arguments):
        out, before = io.StringIO(), sys.argv
        sys.argv = ["deceive", "--program", PROGRAM, "--keep", str(self.place / "kept"), *arguments]
        try:
            with contextlib.redirect_stdout(out):
                status = deceive.main()
        finally:
            sys.argv = before
        return status, re.sub(r", \d+ s\n", "\n", out.getvalue())

    def test_a_table_and_the_same_again(self):
        status, text = self.run_it("--family", SOUND[0], "--scenes", "2")
        self.assertEqual(status, 0, text)
        self.assertRegex(text, r"stack +2 +2 +0 +0 +0 +0 +0 +0 +0 ")
        self.assertEqual(self.run_it("--family", SOUND[0], "--scenes", "2"), (status, text))
        self.assertFalse((self.place / "kept").exists())

    def test_one_model_with_details(self):
        status, text = self.run_it("--family", SOUND[0], "--only", str(SOUND[1]))
        self.assertIn("exchanged", text)
        self.assertIn("half-width", text)

    def test_decks_of_findings_are_kept(self):
        before = deceive.Judge
        deceive.Judge = lambda *arguments: lambda *scene: self.found(before(*arguments)(*scene))
        self.addCleanup(setattr, deceive, "Judge", before)
        status, text = self.run_it("--family", SOUND[0], "--only", str(SOUND[1]))
        self.assertEqual(status, 1)
        self.assertIn("rotated: off", text)
        self.assertEqual({path.name for path in (self.place / "kept" / "{}_{}".format(*SOUND)).iterdir()}, {"base.dat", "finer.dat", "rotated.dat"})

    def found(self, verdict):
        verdict.faults.append(Fault("twin", "rotated", "off"))
        return verdict


if __name__ == "__main__":
    unittest.main()
