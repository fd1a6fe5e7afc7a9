#!/usr/bin/env python3
"""Bodies that supports move as a whole, and bodies that do not touch: a right answer, without stress."""
import itertools
import unittest

from scenes import block, new_deck

import scene

KINDS = ("CTRIA3", "CTRIA6", "CQUAD4", "CTRAX3", "CTRAX6")


class Rest(scene.Extremes):

    def deck(self, kind, young=1000.0, yields=False, bodies=1):
        """Blocks of 1 by 1, 0.1 above each other, on x from 0.3 on; the rows of ids of each."""
        deck = new_deck(kind, young)
        if yields:
            deck.card("MATS1", 1, None, "PLASTIC", young / 10, 1, 1, young / 1000)
        return deck, [block(deck, 1 + 1000 * body, 0.3, 1.1 * body, 1.0, 1.0, 3, 3, kind)[2] for body in range(bodies)]

    def two(self, kind, motion):
        """Two of them, with lines between; the lower one's bottom moves, the upper one's top is held."""
        deck, (lower, upper) = self.deck(kind, yields=True, bodies=2)
        self.prescribe(deck, lower[0], lambda x, y: motion)
        self.prescribe(deck, upper[-1], lambda x, y: (0.0, 0.0))
        step = 2 if kind.endswith("6") else 1
        deck.lines(lower[-1][::step], upper[0][::step], 2)
        return deck, lower

    def prescribe(self, deck, nodes, motion):
        for n in nodes:
            for c, value in enumerate(motion(*deck.x[n]), 1):
                if value is not None:
                    deck.displace(n, c, value)

    def test_shifts(self):
        """No stress at all, whatever the size of the motion, the material and the precision of the factors."""
        choices = itertools.cycle(itertools.product((1e-9, 0.2, 1e6), (1e-3, 1e12), (False, True), ("DOUBLE", "MIXED", "SINGLE")))
        for kind, who, (size, young, yields, precision) in zip(KINDS * 12, "bottom all ends".split() * 20, choices):
            deck, (rows,) = self.deck(kind, young, yields)
            deck.parameter("PRECIS", precision)
            nodes = {"bottom": rows[0], "all": sum(rows, []), "ends": [rows[0][0], rows[0][-1]]}[who]
            shift = (None if kind.startswith("CTRAX") else 0.7 * size, -0.3 * size)
            self.prescribe(deck, nodes, lambda x, y: shift)
            with self.subTest(kind=kind, who=who, size=size, young=young, yields=yields, precision=precision):
                result = self.valid(deck)
                self.assertEqual(result.summary["max_equivalent_stress"], 0.0)
                self.assertEqual({row["uy"] for row in result.nodes.values()}, {shift[1]})

    def test_turns(self):
        """Small displacements: a turn t is u = t (-y, x). Written to six digits it strains by what these leave."""
        for kind in KINDS[:3]:
            for size in (1e-9, 0.2, 1e6):
                deck, (rows,) = self.deck(kind)
                self.prescribe(deck, rows[0], lambda x, y: (size * (0.1 - y), size * x))
                with self.subTest(kind=kind, size=size):
                    self.assertLess(self.valid(deck).summary["max_equivalent_stress"], 1e-12 * size * 1000.0)
                deck, (rows,) = self.deck(kind)
                self.prescribe(deck, rows[0], lambda x, y: (float(f"{size * (0.1 - y):.5e}"), float(f"{size * x:.5e}")))
                with self.subTest(kind=kind, size=size, digits=6):
                    self.assertLess(self.valid(deck).summary["max_equivalent_stress"], 1e-4 * size * 1000.0)

    def test_apart(self):
        """Two bodies with lines between them that a support has moved apart, or that were never loaded."""
        for kind in KINDS:
            for away in (0.0, 0.2, 1e5):
                deck, lower = self.two(kind, (0.0 if kind.startswith("CTRAX") else 0.01, -away))
                with self.subTest(kind=kind, away=away):
                    result = self.valid(deck)
                    self.assertEqual((result.summary["max_equivalent_stress"], result.summary["pairs_in_contact"]), (0.0, 0.0))
                    self.assertEqual(result.summary["max_pressure"], 0.0)
                    self.assertAlmostEqual(min(result.gap), away + 0.1, delta=1e-12 * (away + 1.0))
                    gap = {0.0: "0.1000", 0.2: "0.3000", 1e5: "1.000E+05"}[away]
                    self.assertEqual(result.message, "scene.dat: warning: nothing touches: no pair carries a force; nearest is GRID "
                                     f"{lower[-1][0]}, {gap} away\n")

    def test_moved_onto_another(self):
        """A support moves the lower body up by 0.1 more than the gap: as if it had stood there."""
        for kind in KINDS:
            answers = []
            for start in (0.0, 50.0):
                deck, lower = self.two(kind, (0.0, start + 0.101))
                for n in sum(lower, []):
                    deck.x[n] = (deck.x[n][0], deck.x[n][1] - start)
                deck.cards = [card if card[0] != "GRID" else ("GRID", card[1], None, *deck.x[card[1]], 0.0) for card in deck.cards]
                deck.parameter("SEARCH", 100.0)
                answers.append(self.valid(deck))
            with self.subTest(kind=kind):
                one, other = (answer.column("elements", "sy") for answer in answers)
                self.assertGreater(max(map(abs, one)), 0.1)
                self.near(other, one, 1e-7)


class LargestStress(scene.Extremes):
    """An element has yielded where it has at any integration point: so says the largest stress, with its place."""

    def test_bent_beam(self):
        """A cantilever of six-node and of four-node elements under a force at its end; yield stress 14."""
        for kind in ("CTRIA3", "CTRIA6", "CQUAD4"):
            deck = new_deck(kind)
            deck.card("MATS1", 1, None, "PLASTIC", 100.0, 1, 1, 14.0)
            place, elements, rows = block(deck, 1, 0.0, 0.0, 6.0, 1.0, 9, 2, kind)
            deck.hold(12, *(row[0] for row in rows))
            deck.force(rows[0][-1], 0.0, 1.0)
            with self.subTest(kind=kind):
                result = self.valid(deck)
                for row in result.elements.values():
                    self.assertEqual(row["state"] == "plastic", row["max_equivalent_stress"] > 14.0)
                    self.assertGreaterEqual(row["max_equivalent_stress"], row["equivalent_stress"] * (1 - 1e-12))
                worst = max(result.elements.values(), key=lambda row: row["max_equivalent_stress"])
                self.assertEqual(result.summary["max_equivalent_stress"], worst["max_equivalent_stress"])
                self.assertEqual(result.summary["max_equivalent_stress_element"], worst["element"])
                self.assertEqual([result.summary["max_equivalent_stress_" + c] for c in "xy"], [worst["max_x"], worst["max_y"]])
                corners = [place[n] for n in elements[int(worst["element"]) - 1][:4 if kind == "CQUAD4" else 3]]
                for k in (0, 1):
                    self.assertLess(min(c[k] for c in corners), worst["max_" + "xy"[k]])
                    self.assertLess(worst["max_" + "xy"[k]], max(c[k] for c in corners))
                self.assertIn(f"in element {int(worst['element'])} at {worst['max_x']:.4g}"[:24], result.listing)
                mean_below = [row for row in result.elements.values() if row["state"] == "plastic" and row["equivalent_stress"] < 14.0]
                self.assertEqual(bool(mean_below), kind != "CTRIA3")


if __name__ == "__main__":
    unittest.main()
