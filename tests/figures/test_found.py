#!/usr/bin/env python3
"""Decks of users (tests/found/*.bdf) for which the program was wrong, or gave a needless warning."""
import math
import pathlib
import re
import unittest

import scenes  # noqa: F401  (adds the folder of scene.py to the path)

import scene

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "found"


def deck(name):
    return (FOLDER / f"{name}.bdf").read_text()


def shifted(text, nodes, by):
    """The deck with the x of these GRIDs increased."""
    lines = [line.split(",") for line in text.splitlines()]
    return "\n".join(",".join([*fields[:3], repr(float(fields[3]) + by), *fields[4:]]) if fields[0] == "GRID" and int(fields[1]) in nodes
                     else ",".join(fields) for fields in lines) + "\n"


def turned(text, degrees):
    """The deck with nodes and forces rotated; supports are unchanged."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    at = {"GRID": 3, "FORCE": 5}
    lines = [line.split(",") for line in text.splitlines()]
    for fields in lines:
        if fields[0] in at:
            x, y = (float(fields[at[fields[0]] + k]) for k in (0, 1))
            fields[at[fields[0]]:at[fields[0]] + 2] = repr(c * x - s * y), repr(s * x + c * y)
    return "\n".join(map(",".join, lines)) + "\n"


def graded(digits, way):
    """Ten stacked blocks whose moduli span some decades, falling or rising."""
    young = {str(k + 1): 2.1e5 * 10.0 ** (way * digits * (k / 9 - 0.5)) for k in range(10)}
    return re.sub(r"MAT1,(\d+),[^,]*", lambda card: f"MAT1,{card[1]},{scene.written(young[card[1]])}", deck("g10_6"))


def strips(sides, foundation):
    """Square elements in a row on others of another modulus, fixed below, with a uniform pressure of 1."""
    text = scene.Deck(2.1e5, 0.3)
    text.material(2, foundation, 0.3)
    ticks = [float(k) for k in range(sides + 1)]
    lower, upper = text.block(2, ticks, [-1.0, 0.0]), text.block(1, ticks, [0.0, 1.0], 5001)
    text.hold(12, *lower[0])
    text.card("BLSEG", 1, *upper[0])
    text.card("BLSEG", 2, *reversed(lower[1]))
    text.card("BCONP", 1, 1, 2)
    text.press(upper[1], float(sides))
    text.support(12, upper[1][0])
    text.support(2, upper[1][-1])
    return text


class Found(scene.Extremes):

    def test_joint_without_gap(self):
        """A block on two adjacent flush ones is supported as on two with a joint between: on the corners of the joint and of the blocks."""
        flush = self.valid(deck("joint_gap0"))
        apart = self.valid(shifted(deck("joint_gap0"), range(26, 35), 1e-3))
        self.near(flush.summary["max_pressure"], apart.summary["max_pressure"], 1e-3)
        pressed = {(pair["pair"], pair["ga"]): pair["force"] for pair in flush.table("contact")}
        for top, edge in ((35, 25), (36, 32)):
            on_edge, = (force for (name, a), force in pressed.items() if name == edge and a == 35)
            on_top, = (force for (name, _), force in pressed.items() if name == top)
            self.near(on_edge + on_top, 50.0, 1e-9)
            self.near(on_edge, 17.278, 1e-4)

    def test_errors_whatever_the_last_step_was(self):
        """The error estimate uses the tangent at the answer, whichever method and step found it."""
        text = (FOLDER.parent.parent / "input/hertz/hertz44.dat").read_text()
        errors = [self.valid(re.sub("METHOD  SECANT", f"METHOD  {method}", text)).summary["mesh_error_approach_41_2"]
                  for method in ("NEWTON", "SECANT", "MODSEC", "INISTR")]
        self.assertLess(max(errors), 1.2 * min(errors))   # by the secants 1.6

    def test_fronts_on_few_pairs(self):
        """The errors of largest pressure and half-width are within their estimates: with a peak between two pairs, with a master mesh coarser
        than the six-node edges on it, and for elements without mid-side nodes."""
        for name, pressure, half_width in (("coarse_front", 2933.19, 0.3637), ("unlike_front", 1366.80, 0.40573)):
            run = self.valid(deck(name))
            zone, = run.table("zones")
            self.assertLess(abs(zone["max_pressure"] - pressure), run.summary["mesh_error_pressure_zone_1"])
            self.assertLess(abs(zone["half_width"] - half_width), run.summary["mesh_error_half_width_zone_1"])

    def test_slides_that_nothing_drives(self):
        """Blocks pressed straight on each other stay above each other, in any orientation of the model."""
        text = turned(deck("slide_rot0p001"), -1e-3)
        upright = self.valid(text)
        self.assertLess(max(abs(row["ux"]) for row in upright.nodes.values()), 1e-3)
        for degrees in (5.9e-9, -1e-8, -3e-7, 1e-6, -1e-5, 1e-4, 1e-3, 1.0, 30.0, -60.0):
            c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            with self.subTest(degrees=degrees):
                for name, node in self.valid(turned(text, degrees)).nodes.items():
                    ux, uy = (upright.nodes[name][key] for key in ("ux", "uy"))
                    self.near(node["ux"], c * ux - s * uy, 1e-9, 1e-3)
                    self.near(node["uy"], s * ux + c * uy, 1e-9, 1e-3)

    def test_stiff_on_soft(self):
        """Ten blocks of falling or rising stiffness under one load: each carries the same pressure, or the answer is rejected."""
        for digits in (8, 12, 16):
            for way in (1, -1):
                text = graded(digits, way)
                for rule in ("CONRY", "JOINED"):
                    with self.subTest(digits=digits, way=way, rule=rule):
                        result = scene.solve(text.replace("BEGIN BULK", f"BEGIN BULK\nPARAM,RULE,{rule}"))
                        self.assertIn(result.status, (0,) if digits <= 12 or way < 0 else (0, 4), result.message)
                        if result.status == 0:
                            self.near([pair["pressure"] for pair in result.table("contact")], [1e-5] * 45, 1e-4)
                            self.assertEqual(result.message, "")

    def test_rounding_of_joined_bodies(self):
        """The same blocks as one system: the rounding estimate of the forces covers their error, which is below the range of moduli."""
        for digits, way, most in ((0, 1, 1e-9), (8, 1, 1e-7), (10, 1, 1e-5), (10, -1, 1e-10)):
            with self.subTest(digits=digits, way=way):
                result = self.valid(graded(digits, way).replace("BEGIN BULK", "BEGIN BULK\nPARAM,RULE,JOINED"))
                stated = result.summary["rounding_error_force"]
                self.assertLess(max(abs(pair["pressure"] / 1e-5 - 1.0) for pair in result.table("contact")), stated)
                self.assertLess(stated, most)

    def test_slender_strips(self):
        """A strip 150 and 500 times as long as high lies on another: the last digit of its forces bends it by more than the tolerance of gaps."""
        wave = self.valid(deck("oblique150x1"))
        self.near(wave.summary["max_pressure"], 129.991, 1e-5)
        for sides, degrees, foundation in ((500, 0.0, 2.1e5), (500, 17.0, 2.1e11), (1000, 45.0, 2.1e5)):
            for solver in ("BAND", "FRONTAL"):
                with self.subTest(sides=sides, degrees=degrees, foundation=foundation, solver=solver):
                    text = strips(sides, foundation)
                    text.parameter("SOLVER", solver)
                    result = self.valid(turned(text.text(), degrees))
                    self.near([pair["pressure"] for pair in result.table("contact")[20:-20]], [1.0] * (sides - 39), 1e-9)

    def test_strip_on_one_node(self):
        """A strip a thousand times as long as high is pressed on one node and rotates freely about it: in any direction that gap is closed."""
        text = deck("strip_on_one_node")
        for degrees in (0.0, 1e-9, 1e-3, 11.0, 30.0, 37.0, 60.0, 123.0):
            for rule in ("CONRY", "JOINED"):
                with self.subTest(degrees=degrees, rule=rule):
                    result = self.valid(turned(text.replace("BEGIN BULK", f"BEGIN BULK\nPARAM,RULE,{rule}"), degrees))
                    self.near(max(pair["force"] for pair in result.table("contact")), 100.0, 1e-9)

    def test_gap_that_closes(self):
        """A block comes straight down on a stack: this is not sliding, whichever side of the corner is the nearer one by rounding."""
        for blocks in (30, 50):
            text = scene.Deck(2.1e5, 0.3)
            tops = []
            for k in range(blocks):
                low = 5.0 * k + (k == blocks - 1)
                rows = text.block(1, [0.0, 2.5, 5.0, 7.5, 10.0], [low, low + 2.5, low + 5.0], 100 * k + 1)
                if tops:
                    text.card("BLSEG", 2 * k, *rows[0])
                    text.card("BLSEG", 2 * k + 1, *reversed(tops))
                    text.card("BCONP", k, 2 * k, 2 * k + 1)
                    text.hold(1, rows[-1][2])
                    text.support(2, rows[-1][0], rows[-1][-1])
                else:
                    text.hold(12, *rows[0])
                tops = rows[-1]
            text.press(tops, 100.0)
            with self.subTest(blocks=blocks):
                self.assertEqual(self.valid(text).message, "")

    def test_estimates_of_a_mirrored_model(self):
        """If two largest pressures are equal the larger error is reported, in either order."""
        one, other = (self.valid(deck(name)).summary["mesh_error_pressure_zone_2"] for name in ("perr26", "perr26_mirror"))
        self.near(one, other, 1e-6)

    def test_equal_zones(self):
        """If two zones have one largest pressure the one with the larger uncertainty is reported, by every solver."""
        for rule in ("CONRY", "JOINED"):
            with self.subTest(rule=rule):
                result = self.valid(deck("equal_zones").replace("BEGIN BULK", f"BEGIN BULK\nPARAM,RULE,{rule}"))
                self.assertEqual(result.summary["max_pressure_is"], "singular")

    def test_pairs_without_force(self):
        """The state of a pair without force does not depend on the solver: neither if its body rotates about it, nor if its gap is small beside the deformation of softer bodies."""
        for name, touching in (("turns_about_a_corner", 4), ("stiff_among_soft", 23)):
            text = re.sub("PARAM,RULE,.*\n", "", deck(name))
            for rule in ("CONRY", "JOINED"):
                with self.subTest(name=name, rule=rule):
                    result = self.valid(text.replace("BEGIN BULK", f"BEGIN BULK\nPARAM,RULE,{rule}"))
                    self.assertEqual(result.summary["pairs_in_contact"], touching)

    def test_rounding_stalls_the_simplex(self):
        """The BLAS decides whether rounding stalls CONRY. If so, joined bodies find the active set; otherwise the forces have few digits, with a message."""
        joined, simplex = (self.valid(deck("pile_on_a_corner").replace("BEGIN BULK", f"BEGIN BULK\nPARAM,RULE,{rule}")) for rule in ("JOINED", "CONRY"))
        for wanted, got in zip(joined.table("contact"), simplex.table("contact"), strict=True):
            self.assertEqual(wanted["status"], got["status"])
            self.near(float(got["force"]), float(wanted["force"]), 1e-7, scale=joined.summary["total_contact_force"])

    def test_bodies_behind_the_next_body(self):
        """For any search distance, two strips of a spiral meet along the same stretches: the next winding behind them does not matter."""
        spiral = deck("spiral_search")
        scaled = re.sub(r"(?m)^(GRID,\d+,,)([^,]*)", lambda grid: f"{grid[1]}{1.2 * float(grid[2])!r}", spiral)
        for name, text in (("spiral", spiral), ("turned", turned(spiral, 37.0)), ("oval", scaled)):
            for lines in ("1,2", "2,1"):
                with self.subTest(name=name, lines=lines):
                    text = text.replace("BCONP,1,1,2", f"BCONP,1,{lines}")
                    near, *far = (self.valid(text.replace("BEGIN BULK", f"BEGIN BULK\nPARAM,SEARCH,{search}")).table("contact")
                                  for search in (0.3, 0.8, 20.0))
                    self.assertTrue(all(table == near for table in far))

    def test_estimates_of_another_numbering(self):
        """Nothing resists most modes: the effect of a force along them says nothing about errors of forces."""
        one, other = (self.valid(deck(name)) for name in ("toterr_a", "toterr_b"))
        self.near(one.summary["mesh_error_total_contact_force"], other.summary["mesh_error_total_contact_force"], 1e-6)
        self.near(sorted(node["uy"] for node in one.nodes.values()), sorted(node["uy"] for node in other.nodes.values()), 1e-9)


if __name__ == "__main__":
    unittest.main()
