"""Extremes of elasticity, of stress-strain curves, and of stiffness contrast."""
import math
import unittest

from scene import PLANE_STRESS, Deck, Extremes
from test_scales import column, column_answer


def tower(stiff, soft, stiff_above, bonded=False):
    """Two blocks of different moduli, one upon the other, with pairs between them or (bonded) one mesh; the lower one is
    fixed below, the upper one is unconstrained vertically. Without Poisson's ratio all is uniaxial."""
    deck = Deck()
    upper, lower = (stiff, soft) if stiff_above else (soft, stiff)
    deck.material(1, lower, 0.0)
    deck.material(2, upper, 0.0)
    xs = [0.0, 1.0, 2.0]
    nodes = deck.block(1, xs, [0.0, 1.0])
    if bonded:
        above = [[deck.grid(101 + k, x, 2.0) for k, x in enumerate(xs)]]
        for k in range(2):
            deck.element(2, nodes[1][k], nodes[1][k + 1], above[0][k + 1], above[0][k])
    else:
        above = deck.block(2, xs, [1.0, 2.0], first=101)
        for k in range(3):
            deck.pair(501 + k, nodes[1][k], above[0][k])
        deck.hold(1, above[0][0])
        deck.support(2, above[1][0], above[1][2])
    deck.hold(2, *nodes[0])
    deck.hold(1, nodes[0][0])
    deck.press(above[-1], 10.0)
    return deck


def inclusion(ratio, cells=6):
    """A quarter of a square that is pulled at both sides, with a stiffer centre."""
    deck = Deck(1.0, 0.3)
    deck.material(2, ratio, 0.3)
    ticks = [k/cells for k in range(cells + 1)]
    nodes = deck.block(lambda i, j: 2 if max(i, j) < cells//2 else 1, ticks, ticks)
    deck.hold(2, *nodes[0])
    deck.hold(1, *[row[0] for row in nodes])
    deck.press([row[-1] for row in nodes], 1.0, (1.0, 0.0))
    return deck


def floating(ratio, loads, cells=12):
    """A layer of two cells on a softer base of four that is fixed below; loads on the upper side, by position."""
    deck = Deck(1.0, 0.3)
    deck.material(2, ratio, 0.3)
    nodes = deck.block(lambda i, j: 2 if j >= 4 else 1, [float(i) for i in range(cells + 1)], [float(j) for j in range(7)])
    deck.hold(12, *nodes[0])
    for place, load in loads:
        deck.force(nodes[6][place], 0.0, load)
    return deck


LOST = "elements differ too much in size or stiffness"


class Elasticity(Extremes):
    def test_poisson(self):
        """The nearer to 0.5, the fewer digits are left: the loss is that of 1/(1 - 2 nu)."""
        for poisson in (0.0, 1e-300, 0.25, 0.49, 0.4999, 0.499999):
            for triangles in (False, True):
                with self.subTest(poisson=poisson, triangles=triangles):
                    result = self.valid(column(poisson=poisson, triangles=triangles))
                    forces, approach = column_answer(poisson=poisson)
                    left = 1e-10 + 1e-15/(1.0 - 2.0*poisson)
                    self.near(result.force, forces, left)
                    self.near(result.approach, [approach]*2, left)

    def test_poisson_without_volume(self):
        for poisson in (0.5, 0.6, -0.1):
            self.refused(column(poisson=poisson), 2, "MAT1 1: .*NU")

    def test_poisson_near_the_end(self):
        """0.5 minus one rounding: the remaining digits are correct, or it is rejected."""
        for left in range(7, 17):
            poisson = 0.5 - 10.0**-left
            with self.subTest(poisson=poisson):
                result = self.right_or_refused(column(poisson=poisson), "Poisson's ratio is too near 0.5")
                if result:
                    self.near(result.approach, [column_answer(poisson=poisson)[1]]*2, 1e-6)


class Contrast(Extremes):
    exponents = [k for k in range(-12, 13, 2)]

    def test_bodies_one_upon_the_other(self):
        for exponent in self.exponents:
            for stiff_above in (True, False):
                with self.subTest(contrast=f"1e{exponent}", stiff_above=stiff_above):
                    result = self.valid(tower(10.0**exponent, 1.0, stiff_above))
                    self.near(result.force, [2.5, 5.0, 2.5])
                    give = -5.0*(1.0 + 10.0**-exponent)
                    self.near(result.approach, [give]*2)
                    self.near(result.column("elements", "sy"), [-5.0]*4)

    def test_layers_in_one_body(self):
        for exponent in self.exponents:
            for stiff_above in (True, False):
                with self.subTest(contrast=f"1e{exponent}", stiff_above=stiff_above):
                    result = self.right_or_refused(tower(10.0**exponent, 1.0, stiff_above, bonded=True), LOST)
                    self.assertTrue(result or stiff_above == (exponent > 0) and abs(exponent) > 6)
                    if result:
                        lift = [result.nodes[k]["uy"] for k in (101, 102, 103)]
                        self.near(lift, [-5.0*(1.0 + 10.0**-exponent)]*3, 1e-6)
                        self.near(result.column("elements", "sy"), [-5.0]*4, 1e-6)

    def test_inclusion(self):
        """Correct: equal to a contrast ten times less (it no longer matters), which keeps its digits."""
        stiff, hollow = self.valid(inclusion(1e7)), self.valid(inclusion(1e-7))
        for exponent in (8, 10, 12, 14):
            for sign, reference in ((1, stiff), (-1, hollow)):
                with self.subTest(contrast=f"1e{sign*exponent}"):
                    result = self.right_or_refused(inclusion(10.0**(sign*exponent)), LOST)
                    self.assertTrue(result or sign > 0)
                    if result:
                        self.near(result.column("nodes", "ux"), reference.column("nodes", "ux"), 1e-6)
                        self.near(result.column("elements", "sx"), reference.column("elements", "sx"), 1e-5)

    def test_stiff_layer_on_a_soft_base(self):
        """Loads of the layer that balance each other bend it and hardly press the base: the certificate does not see errors of
        its rigid-body displacement, which are some 10 times the rounding of the weakest pivot. Displacements times the contrast
        no longer change with it, so that a wrong one shows."""
        balanced = ((0, -1.0), (4, 1.0), (8, 1.0), (12, -1.0))
        for loads, worth in ((balanced, 1.0), (((4, -1.0),), 0.0)):
            reference = None
            for exponent in (7, 8, 9, 10, 12, 14, 16):
                with self.subTest(contrast=f"1e{exponent}", loads=len(loads)):
                    result = self.right_or_refused(floating(10.0**exponent, loads), LOST)
                    self.assertFalse(result and exponent >= 10)
                    if result:
                        values = [value*10.0**(exponent*worth) for value in result.column("nodes", "uy")]
                        reference = reference or values
                        self.near(values, reference, 1e-5)


def yielding(points, pressure, method=None):
    """A column in plane stress under a pressure: uniaxial, so that its stress is on the given curve."""
    deck = Deck(1000.0, 0.3, plane=PLANE_STRESS)
    deck.curve(1, points)
    if method:
        deck.parameter("METHOD", method)
    deck.stand(deck.block(1, [0.0, 1.0, 2.0], [0.0, 1.0]), 2.0*pressure)
    return deck


class Curves(Extremes):
    def test_no_yield_within_reach(self):
        """A yield stress 1e12 times the pressure is elastic."""
        result = self.valid(yielding([(1e9, 1e12), (2e9, 1.1e12)], 1.0))
        self.near(result.approach, [-1e-3]*2)
        self.assertEqual(result.summary["plastic_elements"], 0)

    def test_yield_at_once(self):
        """1e-6 of the pressure: as soft as the second slope from the beginning."""
        for method in ("NEWTON", "AUTO"):
            result = self.valid(yielding([(1e-9, 1e-6), (1.0, 1e-6 + 100.0*(1.0 - 1e-9))], 1.0, method=method))
            self.near(result.approach, [-(1e-9 + (1.0 - 1e-6)/100.0)]*2, 1e-8)
            self.assertEqual(result.summary["plastic_elements"], 2)

    def test_yield_point_far_below_the_next(self):
        """A load near a yield stress that is 1e-12 to 1e-32 of the next stress: the result has no digits of the next point."""
        for stress in (1e-10, 1e-20, 1e-30):
            for method in ("NEWTON", "INISTR"):
                with self.subTest(stress=stress, method=method):
                    pressure = 2.0*stress
                    result = self.valid(yielding([(stress/1000.0, stress), (1.0, 100.0)], pressure, method=method))
                    self.near(result.approach, [-(stress/1000.0 + (pressure - stress)/100.0)]*2, 1e-6 if method == "NEWTON" else 0.02)

    def test_curve_of_a_thousand_points(self):
        points = [(0.001*k**0.5 if k == 1 else 0.001 + 1e-5*(k - 1), 1.0 + 0.002*math.sqrt(k - 1)) for k in range(1, 1001)]
        for k in (2, 500, 999):
            pressure = 0.5*(points[k - 1][1] + points[k][1])
            with self.subTest(point=k):
                result = self.valid(yielding(points, pressure, method="NEWTON"))
                self.near(result.approach, [-0.5*(points[k - 1][0] + points[k][0])]*2, 1e-8)

    def test_last_point(self):
        """At the last point the table has not ended; a thousandth above it has."""
        points = [(0.001, 1.0), (0.01, 1.4), (0.02, 1.5)]
        for method in ("NEWTON", "MODSEC"):
            at, beyond = (self.valid(yielding(points, pressure, method=method)) for pressure in (1.5, 1.501))
            self.near(at.approach, [-0.02]*2, 1e-8)
            self.assertEqual("", at.message)
            self.assertEqual("scene.dat: warning: strained beyond the last point of the table; its last slope is used: element 1 and 1 more\n",
                             beyond.message)

    def test_perfectly_plastic(self):
        """Below the yield stress it carries the load; at it and above, the strain is undetermined."""
        flat = [(0.001, 1.0), (1.0, 1.0)]
        self.near(self.valid(yielding(flat, 0.999999)).approach, [-0.000999999]*2)
        self.refused(yielding(flat, 1.000001), 1, "limit load")
        self.refused(yielding(flat, 1e6), 1, "limit load")

    def test_flat_to_the_last_digit(self):
        """A second slope of 1e-9 of the first is valid: the strain is large, and correct."""
        result = self.valid(yielding([(0.001, 1.0), (1e6 + 0.001, 2.0)], 1.001, method="NEWTON"))
        self.near(result.approach, [-(0.001 + 1e3)]*2, 1e-6)

    def test_steps_and_teeth(self):
        """Curves that fall, have equal strains, or do not begin on the elastic line are rejected with the point."""
        for points in ([(0.001, 1.0), (0.002, 0.9)], [(0.001, 1.0), (0.001, 1.1)], [(0.001, 1.0), (0.002, 1.1), (0.0015, 1.2)]):
            self.refused(yielding(points, 1.0), 2, "TABLES1 1.*(?:strain|stress)")
        self.refused(yielding([(0.002, 1.0), (0.003, 1.1)], 1.0), 2, "(?:TABLES1|MATS1) 1")


if __name__ == "__main__":
    unittest.main()
