#!/usr/bin/env python3
"""Friction of bodies with known answers: a punch and a cylinder on an unlike half-plane, a belt on a drum, a wedge between walls, an arch of blocks. Both contact solvers."""
import math
import re
import unittest

from test_friction import RULES, run, values
from scenes import friction
from scenes.deck import Deck
from scenes.elastic import flat_punch
from scenes.mesh import Mesh, graded, squared


class HalfPlane(unittest.TestCase):
    """A rigid punch or cylinder is pressed on an elastic half-plane, whose shear acts on the pressures."""

    #: Stick half-widths over a for Poisson's ratio .3, by boundary elements graded to 1e-4 of the stick zone.
    KNOWN = {0.1: 0.0365, 0.2: friction.STICK, 0.3: 0.6891}

    def punch(self, mu, steps=1):
        stick = self.KNOWN[mu]
        inside = [stick / 18.5 * k for k in range(23)]
        half = (1.0 - inside[-1]) / 2
        beside = [inside[-1] + x for x in graded(1.15 * stick / 18.5, 1.15, half)[1:]] + [1.0 - x for x in reversed(graded(2e-3, 1.15, half)[:-1])]
        return friction.half_plane(inside + beside, mu, steps=steps).text()

    def stick(self, rows):
        """In the stick zone the square of the distance from the limit falls linearly to zero at its end."""
        count = next(k for k, row in enumerate(rows) if row["state"] == "slips")
        self.assertFalse({"sticks"} & {row["state"] for row in rows[count:]})
        (one, a), (other, b) = ((float(row["x"]), (1.0 - abs(float(row["friction_force"])) / float(row["limit"])) ** 2) for row in rows[count - 2:count])
        return other + (other - one) * b / (a - b)

    def test_punch(self):
        for mu, known in self.KNOWN.items():
            for rule in RULES:
                rows, summary = run(self.punch(mu), rule)
                for found in (self.stick(rows), values(summary, "stick_half_width")[0]):
                    self.assertAlmostEqual(found / known, 1.0, delta=0.01, msg=f"{mu} {rule}")

    def test_punch_in_increments(self):
        """The answer grows in proportion to the load, so that one step suffices."""
        for mu in self.KNOWN:
            one, ten = (run(self.punch(mu, steps), "AUTO")[0] for steps in (1, 10))
            largest = max(abs(float(row["friction_force"])) for row in one)
            for row, other in zip(one, ten):
                self.assertAlmostEqual(float(row["friction_force"]), float(other["friction_force"]), delta=1e-3 * largest)

    def test_cylinder(self):
        """A node that sticks keeps the slip that it had when it closed, so that increments are needed; then the stick ratio is that of the punch."""
        errors = []
        for steps in (1, 10, 40):
            rows, _ = run(friction.half_plane(friction.EVEN, 0.2, friction.RADIUS, steps).text(), "CONRY")
            closed = [row for row in rows if float(row["force"]) > 0.0]
            (one, a), (other, b) = ((float(row["x"]), float(row["force"]) ** 2) for row in closed[-3:-1])   # the last node has a part of its edges
            errors.append(abs(self.stick(rows) / (other + (other - one) * b / (a - b)) / self.KNOWN[0.2] - 1.0))
        self.assertGreater(errors[0], 0.5)
        self.assertLess(errors[1], 0.05)
        self.assertLess(errors[2], min(0.015, 0.5 * errors[1]))


class Many(unittest.TestCase):
    """A punch with so much friction that several answers are possible."""

    def test_other_answers_not_searched(self):
        for n, notes in ((101, 1), (99, 0)):
            deck = re.sub(r"(?m)^PGAP .*", "PGAP,21,0.,,,,,20.", flat_punch(n=n, size=4.0, element="cquad4", growth=(1.5, 1.5)).text())
            _, listing = run(deck, "CONRY", listing=True)
            said = "friction may allow other answers; they are not searched for, as there are more than 100 pairs"
            self.assertEqual(listing.count(said), notes)


class Belt(unittest.TestCase):
    """A belt is pulled over half of a fixed drum: the tensions of its ends differ by a factor exp(mu angle R/(R + t/2))."""

    RADIUS, THICK, PULL = 1.0, 0.01, 1.0

    def text(self, mu, pairs=64):
        flat = squared([self.RADIUS, self.RADIUS + self.THICK / 2, self.RADIUS + self.THICK], [math.pi * k / (pairs - 1) for k in range(pairs)])
        belt = Mesh([(r * math.cos(a), r * math.sin(a)) for r, a in flat.point], flat.element, flat.line)
        deck = Deck("BELT", [], from_geometry=False)
        deck.body(belt, 1)
        deck.material(1, 1000.0, 0.0)
        deck.hold(2, belt.line["top"][1:])   # not the node of the pair, which would have no friction
        deck.press(belt, belt.line["bottom"], -self.PULL / self.THICK)
        inner = [3 * k for k in range(pairs)]
        deck.ground([belt.point[node] for node in inner], 1001)
        for k, node in enumerate(inner):
            (x, y) = (value / self.RADIUS for value in belt.point[node])
            deck.wide("CORD2R", k + 1, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, x, y, 0.0)
            deck.card("CGAP", 2001 + k, 21, 1001 + k, node + 1, "", "", "", k + 1)
        deck.card("PGAP", 21, 0.0, "", "", "", "", mu)
        deck.card("SUPORT", inner[pairs // 2] + 1, 1)
        return deck.text()

    def test_tensions(self):
        mean = self.RADIUS + self.THICK / 2
        for mu in (0.1, 0.3):
            for rule in RULES:
                rows, _ = run(self.text(mu), rule)
                left = self.PULL - abs(sum(float(row["friction_force"]) for row in rows)) * self.RADIUS / mean
                self.assertAlmostEqual(math.log(self.PULL / left) / (mu * math.pi * self.RADIUS / mean), 1.0, delta=0.005, msg=f"{mu} {rule}")


class Wedge(unittest.TestCase):
    """A wedge is pressed between walls; without load it stays if mu is above the tangent of its half angle. Half of the model."""

    def text(self, slope, mu, n=8):
        flat = squared([k / n for k in range(n + 1)], [2.0 * k / n for k in range(n + 1)])
        wedge = Mesh([(s * (1.0 + slope * y), y) for s, y in flat.point], flat.element, flat.line)
        flank = [node for node, (s, _) in enumerate(flat.point) if s == 1.0]
        deck = Deck("WEDGE", [], from_geometry=False)
        deck.body(wedge, 1)
        deck.material(1, 1000.0, 0.3)
        deck.hold(1, wedge.on(0, 0.0))
        deck.press(wedge, wedge.line["top"], 1.0)
        deck.ground([wedge.point[node] for node in flank], 1001)
        deck.wide("CORD2R", 1, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, slope, 0.0)
        deck.pairs(2001, [(1001 + k, node + 1) for k, node in enumerate(flank)], 21, friction=mu)
        deck.card("SUPORT", wedge.line["top"][0] + 1, 2)
        deck.sequence(("PRESSED", 1.0, 4), ("FREE", 0.0, 8))
        return deck.text()

    def test_stays(self):
        for rule in RULES:
            for slope in (0.1, 0.29):
                _, summary = run(self.text(slope, 0.3), rule)
                pressed, left = values(summary, "total_contact_force")
                angle = math.atan(slope)
                self.assertAlmostEqual(pressed, (1.0 + 2.0 * slope) / (math.sin(angle) + 0.3 * math.cos(angle)), delta=1e-3)   # all slips
                self.assertGreater(left, 0.5 * pressed)

    def test_jumps_out(self):
        for rule in RULES:
            _, summary = run(self.text(0.31, 0.3), rule)
            self.assertEqual([0.0, 0.0], [values(summary, key)[1] for key in ("total_contact_force", "max_displacement")])


class Arch(unittest.TestCase):
    """Twelve stiff blocks carry their weight as a half circle; only friction and contact hold them. If the abutments spread, the thrust falls to its limit:
    hinges open at the crown and at the haunches."""

    INNER, OUTER, BLOCKS, PARTS = 0.9, 1.1, 12, 4

    def least(self):
        """The thrust that carries half of the arch, from the outer edge of the crown to the inner edge of a joint: the largest of all joints."""
        def thrust(angle):
            area = (self.OUTER ** 2 - self.INNER ** 2) / 2 * (math.pi / 2 - angle)
            moment = self.INNER * math.cos(angle) * area - (self.OUTER ** 3 - self.INNER ** 3) / 3 * (1 - math.sin(angle))
            return moment / (self.OUTER - self.INNER * math.sin(angle))

        return max(thrust(math.pi * k / self.BLOCKS) for k in range(self.BLOCKS // 2))

    def text(self, mu=0.8, spread=1e-3):
        deck, across = Deck("ARCH", [], from_geometry=False), range(self.PARTS + 1)
        radii = [self.INNER + (self.OUTER - self.INNER) * k / self.PARTS for k in across]
        deck.ground([(r, 0.0) for r in radii], 101)
        deck.ground([(-r, 0.0) for r in radii], 201)
        below = [101 + k for k in across]
        for joint in range(self.BLOCKS + 1):
            angle = math.pi * joint / self.BLOCKS
            first = 1000 * (joint + 1)
            above = [(first if joint < self.BLOCKS else 201) + k for k in across]
            deck.wide("CORD2R", joint + 1, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, -math.sin(angle), math.cos(angle), 0.0)
            for k, ends in enumerate(zip(below, above)):
                deck.card("CGAP", 20001 + 100 * joint + k, 21, *ends, "", "", "", joint + 1)
            if joint < self.BLOCKS:
                flat = squared(radii, [angle + math.pi * k / self.PARTS / self.BLOCKS for k in across])
                deck.body(Mesh([(r * math.cos(a), r * math.sin(a)) for r, a in flat.point], flat.element, flat.line), 1, first)
                deck.card("SUPORT", first, 1, first, 2, first + self.PARTS, 2 if abs(math.cos(angle)) > 0.5 else 1)
                below = [first + k for k in flat.line["top"]]
        deck.card("PGAP", 21, 0.0, "", "", "", "", mu)
        deck.material(1, 1e5, 0.2, 1.0, 1.0)
        deck.card("GRAV", 1, 0, 1.0, 0.0, -1.0, 0.0)
        for k in across:
            deck.wide("SPCD", 2, 101 + k, 1, spread)
            deck.wide("SPCD", 2, 201 + k, 1, -spread)
        for case, sets in enumerate(((1.0, 1), (1.0, 1, 1.0, 2)), 1):
            deck.card("LOAD", case + 10, 1.0, *sets)
            deck.card("NLPARM", case, 8 if case == 2 else 1)
            deck.load_case("SPREAD" if case == 2 else "WEIGHT", case + 10, case)
        return deck.text()

    def test_thrust(self):
        for rule in RULES:
            rows, _ = run(self.text(), rule)
            before, thrust = (abs(sum(float(row["friction_force"]) for row in rows if row["subcase"] == case and row["pair"].startswith("200"))) for case in "12")
            self.assertGreater(before, 1.2 * thrust)
            self.assertAlmostEqual(thrust / self.least(), 1.0, delta=1e-3, msg=rule)


if __name__ == "__main__":
    unittest.main()
