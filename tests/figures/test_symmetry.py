#!/usr/bin/env python3
"""The same model as a half and as a whole, mirrored, rotated, its lines in the opposite direction, with other ids: the same results."""
import random
import unittest

from scenes import Punch, block, new_deck

import scene

ROUND, FLAT = (lambda x: x * x / 40.0), (lambda x: 0.0)
PLANE, RINGS = ("CTRIA3", "CTRIA6", "CQUAD4"), ("CTRAX3", "CTRAX6")
#: Images of a vector: mirrored at each axis, rotated by 90 degrees, mirrored at the diagonal. Axisymmetric bodies stay about their axis.
UPSIDE_DOWN = ("upside down", lambda v: (v[0], -v[1]))
IMAGES = [UPSIDE_DOWN, ("mirrored", lambda v: (-v[0], v[1])), ("turned", lambda v: (-v[1], v[0])), ("diagonal", lambda v: (v[1], v[0]))]


class Symmetry(scene.Extremes):

    def figures(self, deck):
        """Values of the one zone, and of the whole: value by name."""
        result = self.valid(deck)
        zone, = result.table("zones")
        found = {key: zone[key] for key in ("force", "max_pressure", "half_width_last_pair", "half_width")}
        found["error_half_width"] = result.summary["mesh_error_half_width_zone_1"]
        found["error_pressure"] = result.summary["mesh_error_pressure_zone_1"]
        found["error_energy"] = result.summary["mesh_error_energy_norm"]
        found["largest"] = result.summary["max_equivalent_stress"]
        found["approach"] = abs(result.approach[0]) if result.approach else 0.0
        return {key: scene.number(value) for key, value in found.items()}

    def same(self, one, other, factor=None, but=()):
        for key, value in one.items():
            if key in but:
                continue
            there = other[key]
            if isinstance(value, str) or isinstance(there, str):
                self.assertEqual(value, there, key)
            else:
                self.assertLessEqual(abs(value * (factor or {}).get(key, 1.0) - there), 1e-7 * abs(there), f"{key}: {value!r} and {there!r}")

    def close(self, one, other, key, part):
        if not isinstance(one[key], str):
            self.near(one[key], other[key], part)

    def half_and_whole(self, *how):
        """Half of the force, the rest equal. Recovered strains at a boundary differ from those inside."""
        half, whole = (self.figures(Punch(how[0], is_half, *how[1:]).deck()) for is_half in (True, False))
        self.same(half, whole, {"force": 2.0}, but=("error_pressure", "error_energy", "error_half_width"))
        self.close(half, whole, "error_half_width", 0.01)   # a small part of it comes from the energy

    def test_half_and_whole(self):
        for kind in PLANE:
            for how in ("elastic", "rigid"):
                for slave, pairs, shape in (("punch", False, ROUND), ("block", False, ROUND), ("punch", True, ROUND), ("punch", False, FLAT)):
                    with self.subTest(kind=kind, how=how, slave=slave, pairs=pairs, flat=shape is FLAT):
                        self.half_and_whole(kind, shape, how, slave, pairs)

    def test_fixed_round_punch(self):
        """A rigid punch whose nodes are all fixed is also treated as half a punch by the block."""
        for kind in PLANE:
            with self.subTest(kind=kind):
                self.half_and_whole(kind, ROUND, "held", "punch", True)

    def test_rigid_by_ties_and_by_supports(self):
        """A punch that an RBE2 makes rigid, and the same punch with all nodes fixed at its final position: neither carries stresses."""
        for kind in PLANE + RINGS:
            tied = self.figures(Punch(kind, True, ROUND, "rigid").deck())
            held = self.figures(Punch(kind, True, ROUND, "held", travel=tied["approach"]).deck())
            with self.subTest(kind=kind):
                # If loads determine the force, it has no error; if supports do, its error is a part of the pressure's.
                self.same(tied, held, but=("approach", "error_pressure"))
                self.close(tied, held, "error_pressure", 0.05)

    def test_images(self):
        for kind in PLANE + RINGS:
            for how, slave, pairs in (("elastic", "punch", False), ("rigid", "punch", False), ("elastic", "block", True)):
                punch = Punch(kind, True, ROUND, how, slave, pairs, finer=1.5 if how == "elastic" and not pairs else 1.0)
                one = self.figures(punch.deck())
                for name, image in IMAGES if kind in PLANE else [UPSIDE_DOWN]:
                    with self.subTest(kind=kind, how=how, slave=slave, pairs=pairs, image=name):
                        self.same(one, self.figures(punch.deck(image)))

    def test_lines_backwards_and_other_ids(self):
        for kind in PLANE + RINGS:
            for pairs in (False, True):
                punch = Punch(kind, True, ROUND, "rigid", "punch", pairs)
                one, names = self.figures(punch.deck()), list(punch.place)
                random.Random(7).shuffle(names)
                other = dict(zip(punch.place, names))
                with self.subTest(kind=kind, pairs=pairs):
                    self.same(one, self.figures(punch.deck(backwards=True)))
                    self.same(one, self.figures(punch.deck(rename=other.get)))

    def test_guide_is_no_line_of_symmetry(self):
        """A block whose left side slides in a guide, on a base that continues beyond it: the zone ends there, at a sharp edge."""
        for kind in PLANE:
            for slave in (1, 2):
                deck = new_deck(kind)
                lower, *_, top = block(deck, 1, -1.0, -1.0, 3.0, 1.0, 12, 3, kind)[2]
                upper = block(deck, 1001, 0.0, 0.0, 1.0, 1.0, 4, 3, kind)[2]
                deck.hold(12, *lower)
                deck.hold(1, *(row[0] for row in upper))
                for n in upper[-1]:
                    deck.displace(n, 2, -0.01)
                step = 2 if kind.endswith("6") else 1
                deck.lines(upper[0][::step], top[::step][::-1], slave)
                with self.subTest(kind=kind, slave=slave):
                    zone, = self.valid(deck).table("zones")
                    self.assertAlmostEqual(zone["half_width_last_pair"], 0.5, delta=1e-9)
                    self.assertEqual(zone["max_pressure_is"], "singular")


class Axis(scene.Extremes):
    """A six-node edge that begins on the axis has no area there, so that the force of that corner gives no pressure."""

    def test_pressures_that_rise_away_from_the_axis(self):
        """The corner on the axis opens slightly: the contact zone is whole all the same, and ends at the punch's edge."""
        for slave, pairs in (("punch", False), ("block", False), ("punch", True)):
            with self.subTest(slave=slave, pairs=pairs):
                result = self.valid(Punch("CTRAX6", True, FLAT, "elastic", slave, pairs, platen=1.5, reach=2.0).deck())
                corner = min(result.pairs.values(), key=lambda pair: pair["x"])
                self.assertEqual((corner["x"], corner["status"], corner["pressure"]), (0.0, "open", ""))
                self.assertEqual([round(zone["half_width_last_pair"], 12) for zone in result.table("zones")], [2.0])

    def test_largest_pressure_on_few_sides(self):
        """Hertz, a ball on a block: the pressure on the axis needs three corners, and is the largest."""
        result = scene.solve(Punch("CTRAX6", True, ROUND, "rigid", "punch", load=40.0).deck())
        corner, *others = sorted(result.pairs.values(), key=lambda pair: pair["x"])
        self.assertEqual(result.summary["pairs_in_contact"], 5)
        self.assertEqual(corner["pressure"], result.summary["max_pressure"])
        self.assertGreater(corner["pressure"], max(pair["pressure"] for pair in others))

    def test_a_point_has_no_pressure(self):
        """Contact of that corner alone: a force without an area, and no pressure."""
        result = self.valid(Punch("CTRAX6", True, lambda x: x * x / 20.0, "elastic", "punch", load=1e-2).deck())
        self.assertEqual(result.summary["pairs_in_contact"], 1)
        self.assertEqual(result.summary["max_pressure"], "")
        self.assertEqual([zone["max_pressure"] for zone in result.table("zones")], [""])
        self.assertIn("  largest pressure                                        -\n", result.listing)

    def test_both_lines_tell_of_a_pressure(self):
        """The master's corner on the axis also has the pressure of its neighbour, not a force over rounding."""
        result = scene.solve(Punch("CTRAX6", True, ROUND, "elastic", "punch", across=20, load=60.0).deck())
        line = result.listing.split("CONTACT LINES", 1)[1].split("\n")[2].split()
        on_slave, on_master, difference = map(float, line[-3:])
        self.assertLess(abs(on_master - on_slave), 0.1 * on_slave)
        self.assertLess(difference, 0.1)


if __name__ == "__main__":
    unittest.main()
