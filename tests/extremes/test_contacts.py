"""Extremes of pairs: number, distance, similarity."""
import unittest

from scene import Deck, Extremes, written
from test_scales import punch


def bar(gap=0.0, load=1.0, pairs=1):
    """One square of stiffness 1, fixed below, pushed up against a ceiling: it carries the load until the gap is closed. A number of
    equal pairs at each of its two upper nodes."""
    deck = Deck(1.0, 0.0)
    deck.nodes = bottom, top = deck.block(1, [0.0, 1.0], [0.0, 1.0])
    deck.hold(12, *bottom)
    deck.hold(1, *top)
    deck.press(top, load, (0.0, 1.0))
    deck.floor(top*pairs, [gap]*2*pairs, 1001, (0.0, -1.0))
    return deck


def held_pair(gap):
    """A bar, and a pair of two fixed nodes."""
    deck = bar(0.25)
    for node in (3001, 3002):
        deck.grid(node, 5.0, 5.0)
        deck.hold(12, node)
    deck.pair(3001, 3001, 3002, gap)
    return deck


def row(count, gap=lambda k: 0.0, load=1.0, rule=None):
    """A block of some cells, a third as high as it is long, pressed on a floor."""
    deck = Deck(1000.0, 0.0)
    nodes = deck.block(1, [float(k) for k in range(count + 1)], [0.0, count/3.0])
    deck.stand(nodes, load, [gap(k) for k in range(count + 1)], 5_000_001)
    if rule:
        deck.parameter("RULE", rule)
    return deck


class Gaps(Extremes):
    def test_one_pair(self):
        for gap, force in ((0.25, 0.75), (0.0, 1.0), (1.5, 0.0), (-0.5, 1.5)):
            with self.subTest(gap=gap):
                result = self.valid(bar(gap))
                self.near(result.force, [force/2.0]*2, scale=1.0)
                self.near(result.gap, [max(0.0, gap - 1.0)]*2, scale=1.0)

    def test_a_load_that_just_closes_a_pair(self):
        """Biactive: no force, no gap; rounding in either direction does not change the answer."""
        for gap in (1.0, 1.0 - 2.0**-53, 1.0 + 2.0**-52):
            result = self.valid(bar(gap))
            self.near(result.force, [0.0]*2, scale=1.0)
            self.near(result.gap, [0.0]*2, scale=1.0)
            self.near([result.nodes[k]["uy"] for k in (3, 4)], [1.0]*2)

    def test_all_gaps_zero(self):
        for rule in ("CONRY", "JOINED"):
            result = self.valid(row(40, rule=rule))
            self.near(result.force, [1.0/40*(0.5 if k in (0, 40) else 1.0) for k in range(41)])

    def test_gaps_beyond_sight(self):
        """A gap of 1e-60 is treated as any small gap. Below that, an overlap would do work out of the range of numbers."""
        exact = self.valid(row(20))
        for size in (1e-60, 1e-46, 1e-30):
            result = self.valid(row(20, lambda k: size*(k % 3)))
            self.near(result.force, exact.force)
            self.assertTrue(all(result.touching))
        for size in (0.9e-60, 1e-300, -1e-200):
            self.refused(row(20, lambda k: size), 2, "PGAP.*U0. is too far from 1.0")

    def test_gaps_of_places_beyond_sight(self):
        """Coordinates that are nearly zero after a mesher's iterations count as zero: no gap, no overlap."""
        for place in (1e-300, -1e-100, 0.9e-60):
            deck = bar(load=1.0)
            deck.parameter("GAPGEOM", "YES")
            text = deck.text().replace("GRID,1,,0.0,0.0", f"GRID,1,,{written(place)},{written(place)}")
            self.assertNotEqual(text, deck.text())
            deck.card("GRID", 2001, None, 2.0, place)
            deck.card("GRID", 2002, None, 2.0, 0.0)
            deck.hold(12, 2001, 2002)
            deck.pair(2001, 2001, 2002)
            result = self.valid(deck)
            self.assertEqual(result.gap[-1], 0.0)

    def test_gaps_within_one_rounding(self):
        """Ties within one unit of the last digit leave no pair out and none in twice."""
        exact = self.valid(row(20, lambda k: 1.0, load=10.0))
        for rule in ("CONRY", "JOINED"):
            result = self.valid(row(20, lambda k: 1.0 + 2.0**-52*(k % 2), load=10.0, rule=rule))
            self.near(result.force, exact.force)

    def test_gaps_so_wide_that_the_give_is_rounding(self):
        """A prescribed displacement of 1e12 times the deformation: forces would be noise if gaps differ by a rounding."""
        for gap in (1e-3, 1e6, 1e12, 1e15):
            deck = row(20, lambda k: gap, load=1e-3)
            with self.subTest(gap=gap):
                if gap < 1.0:
                    self.near(self.valid(deck).force, [1e-3/20*(0.5 if k in (0, 20) else 1.0) for k in range(21)], 1e-6)
                else:
                    self.refused(deck, 4, "rounding error of gaps")

    def test_pairs_never_reached(self):
        """Gaps of 1e30 beside one that closes; larger ones are out of the range of a field."""
        result = self.valid(row(20, lambda k: 0.0 if k in (0, 20) else 1e30))
        self.near(result.force, [0.5] + [0.0]*19 + [0.5])
        self.refused(row(20, lambda k: 0.0 if k in (0, 20) else 1e300), 2, "U0. is too far from 1.0")

    def test_equal_pairs_with_unequal_gaps(self):
        """Two pairs between the same nodes: the nearer one carries all."""
        deck = bar(0.25)
        deck.pair(2001, 3, 1001, 0.25 + 1e-9)
        deck.pair(2002, 4, 1002, 0.5)
        result = self.valid(deck)
        self.near(result.force, [0.375, 0.375, 0.0, 0.0])
        self.near(result.gap, [0.0, 0.0, 1e-9, 0.25], 1e-12)


class Many(Extremes):
    def test_three_thousand_pairs(self):
        """Uniform load, uniform forces: a strip lifted against a ceiling, and the unconstrained block, whose condition
        leaves fewer digits."""
        deck = Deck(1.0, 0.0)
        nodes = deck.block(1, [float(k) for k in range(3000)], [0.0, 1.0])
        deck.hold(12, *nodes[0])
        deck.hold(1, *nodes[1])
        deck.press(nodes[1], 2999.0, (0.0, 1.0))
        deck.floor(nodes[1], [0.25]*3000, first=5_000_001, normal=(0.0, -1.0))
        result = self.valid(deck)
        self.near(result.force, [0.75*(0.5 if k in (0, 2999) else 1.0) for k in range(3000)])
        result = self.right_or_refused(row(2999), "condition")
        if result:
            self.near(result.force, [1.0/2999*(0.5 if k in (0, 2999) else 1.0) for k in range(3000)], 1e-6)

    def test_long_fine_strip(self):
        """Rounding leaves a residual of 2.7e-9 in the forces, iterative refinement reduces it to 1e-13."""
        deck = Deck(1.0, 0.3)
        nodes = deck.block(1, [9.0*k/6000 for k in range(6001)], [0.0, 0.5, 1.0])
        deck.stand([nodes[0][::40], nodes[2]], 1.0, first=5_000_001)
        result = self.valid(deck)
        self.assertLess(result.summary["equilibrium_residual"], 1e-12)
        self.near([sum(result.force)], [1.0])

    def test_every_pair_twice(self):
        """F is singular: the forces of the twins are one choice of many, with a message, and their sums are correct."""
        for rule in ("CONRY", "JOINED"):
            for copies in (2, 5):
                once = self.valid(bar(0.25))
                deck = bar(0.25, pairs=copies)
                deck.parameter("RULE", rule)
                result = self.valid(deck)
                self.near(sum(result.force), sum(once.force))
                self.near(result.force, [0.375/copies]*2*copies)
                self.assertEqual(result.listing.count(", force not unique"), 2*copies)
                self.assertIn(f"scene.dat: warning: the forces and pressures of {2*copies} pairs are one choice of many: pairs at "
                                 "one point, or parts that cannot bend (`force not unique` in CONTACT)\n", result.message)

    def test_every_second_pair_twice(self):
        for rule in ("CONRY", "JOINED"):
            base = punch()
            base.parameter("RULE", rule)
            once = self.valid(base)
            deck = punch()
            deck.parameter("RULE", rule)
            for k in range(1, 9, 2):
                deck.floor([1 + k], [(k - 4)**2/256.0], first=80001 + k)
            result = self.valid(deck)
            for k in range(9):
                twin = result.pairs.get(80001 + k)
                self.near(result.pairs[70001 + k]["force"] + (twin["force"] if twin else 0.0), once.force[k], scale=40.0)
                unsure = twin is not None and once.touching[k]
                lines = [line for line in result.listing.splitlines() if line.split()[:1] == [str(70001 + k)]]
                self.assertEqual("force not unique" in lines[0], unsure, lines[0])

    def test_two_zones(self):
        """Feet at both ends: each carries half, the pairs between stay open."""
        result = self.valid(row(20, lambda k: 0.0 if k < 3 or k > 17 else 1.0))
        self.near(sum(result.force[:3]), 0.5)
        self.near(sum(result.force[18:]), 0.5)
        self.assertEqual(len(result.table("zones")), 2)


class Walls(Extremes):
    def test_pair_between_fixed_nodes(self):
        """It can neither open nor close, and carries nothing."""
        for gap in (0.0, 0.5, 1e-60):
            result = self.valid(held_pair(gap))
            self.near(result.force, [0.375, 0.375, 0.0], scale=1.0)

    def test_rigid_on_rigid_overlap(self):
        for gap in (-1e-3, -1e-9, -1e9):
            self.refused(held_pair(gap), 1, "pairs overlap and no body can deform: CGAP 3001")

    def test_tongue_between_two_walls(self):
        """A bar with walls above and below it, loaded in either direction, or with an overlap on both sides."""
        for load, above, below in ((1.0, 0.25, 0.1), (-1.0, 0.25, 0.1), (0.0, 0.25, 0.1), (0.0, -0.5, 0.6)):
            deck = bar(above, load)
            deck.floor(deck.nodes[1], [below]*2, 4001)
            result = self.valid(deck)
            give = min(max(load, -below), above)
            upper, lower = max(0.0, load - give), max(0.0, give - load)
            self.near(result.force, [upper/2]*2 + [lower/2]*2, scale=1.0)

    def test_tongue_too_thick(self):
        """If the distance of walls is below the thickness of the tongue, both cannot restrain the same nodes."""
        deck = bar(-0.5, 0.0)
        deck.floor(deck.nodes[1], [0.25]*2, 4001)
        self.refused(deck, 1, "pairs overlap and no body can deform: CGAP 100[12] 400[12]")


if __name__ == "__main__":
    unittest.main()
