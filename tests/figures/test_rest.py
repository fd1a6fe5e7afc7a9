#!/usr/bin/env python3
"""Bodies that supports move as a whole, and bodies without contact: a correct answer, without stress."""
import itertools
import unittest

from scenes import block, new_deck

import scene

KINDS = ("CTRIA3", "CTRIA6", "CQUAD4", "CTRAX3", "CTRAX6")


class Rest(scene.Extremes):
    MASTER, POINT = 9999, 99

    def deck(self, kind, young=1000.0, yields=False, bodies=1):
        """Blocks of 1 by 1, 0.1 above each other, on x from 0.3 on; the rows of ids of each."""
        deck = new_deck(kind, young)
        if yields:
            deck.card("MATS1", 1, None, "PLASTIC", young / 10, 1, 1, young / 1000)
        return deck, [block(deck, 1 + 1000 * body, 0.3, 1.1 * body, 1.0, 1.0, 3, 3, kind)[2] for body in range(bodies)]

    def two(self, kind, motion):
        """Two of them, with lines between; the lower one's bottom moves, the upper one's top is fixed."""
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
        """No stress at all, for any displacement and material."""
        choices = itertools.cycle(itertools.product((1e-9, 0.2, 1e6), (1e-3, 1e12), (False, True)))
        for kind, who, (size, young, yields) in zip(KINDS * 12, "bottom all ends".split() * 20, choices):
            deck, (rows,) = self.deck(kind, young, yields)
            nodes = {"bottom": rows[0], "all": sum(rows, []), "ends": [rows[0][0], rows[0][-1]]}[who]
            shift = (None if kind.startswith("CTRAX") else 0.7 * size, -0.3 * size)
            self.prescribe(deck, nodes, lambda x, y: shift)
            with self.subTest(kind=kind, who=who, size=size, young=young, yields=yields):
                result = self.valid(deck)
                self.assertEqual(result.summary["max_equivalent_stress"], 0.0)
                self.assertEqual({row["uy"] for row in result.nodes.values()}, {shift[1]})

    def test_turns(self):
        """Small displacements: a rotation t is u = t (-y, x). Six digits leave a strain of that order."""
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
        """Two bodies with lines between them that a support has moved apart, or without load."""
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
        """A support moves the lower body up by 0.1 more than the gap: as if it had been there initially."""
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

    def master(self, deck, rows, components):
        deck.grid(self.MASTER, 0.5, 1.5)
        deck.hold(1, self.MASTER)
        deck.card("RBE2", 9001, self.MASTER, components, rows[-1][0], rows[-1][-1])

    def solved(self, deck, rows, motion, above=""):
        result = self.valid(above + deck.text())
        for n in sum(rows, []):
            self.near([result.nodes[n]["ux"], result.nodes[n]["uy"]], list(motion(*deck.x[n])), 1e-9)
        return result

    def test_springs(self):
        """A body hangs on two springs in series; the force acts at the platen, or a support pulls at the far end."""
        for kind, young, yields, far in itertools.product(KINDS, (1000.0, 2.1e5), (False, True), (False, True)):
            deck, (rows,) = self.deck(kind, young, yields)
            self.master(deck, rows, 2 if kind.startswith("CTRAX") else 12)
            deck.grid(self.POINT, 0.0, 1e6)
            deck.hold(1, self.POINT)
            deck.card("CELAS2", 9002, 100.0, self.MASTER, 2, self.POINT, 2)
            if far:
                deck.displace(self.POINT, 2, -0.03)
            else:
                deck.card("CELAS2", 9003, 50.0, self.POINT, 2)
                deck.force(self.MASTER, 0.0, -1.0)
            with self.subTest(kind=kind, young=young, yields=yields, far=far):
                self.solved(deck, rows, lambda x, y: (0.0, -0.03), "" if far else "LOAD = 1\n")

    def test_equations(self):
        """All nodes of a body follow a platen, each by one MPC or in a chain; also if the body has expanded and if contact is off."""
        for kind, young, chain, warm, size in itertools.product(KINDS, (1.0, 2.1e11), (False, True), (False, True), (1e-3, 1.0, 30.0)):
            deck, (rows,) = self.deck(kind, young)
            self.master(deck, rows, 2 if kind.startswith("CTRAX") else 12)
            deck.cards = [card for card in deck.cards if card[0] not in ("RBE2", "MAT1")]
            deck.card("MAT1", 1, young, None, 0.3, None, 1e-5)
            deck.displace(self.MASTER, 2, -size)
            nodes = rows[0] if warm else sum(rows, [])
            for n, leader in zip(nodes, nodes[1:] + [self.MASTER] if chain else [self.MASTER] * len(nodes)):
                deck.card("MPC", 5, n, 2, 1.0, leader, 2, -1.0)
            if not kind.startswith("CTRAX"):
                deck.hold(1, rows[0][0])
            if warm:
                deck.card("TEMPD", 3, 100.0)
            with self.subTest(kind=kind, young=young, chain=chain, warm=warm, size=size):
                result = self.valid("MPC = 5\nBCONTACT = NONE\n" + "TEMPERATURE(LOAD) = 3\n" * warm + deck.text())
                for n in nodes:
                    self.near(result.nodes[n]["uy"], -size)

    def test_rotating_platen(self):
        """A platen rotates a body above another, without contact; beside them two bodies are in contact, or none."""
        for kind, young, pressed, yields in itertools.product(KINDS[:3], (1.0, 2.1e11), (False, True), (False, True)):
            deck, (lower, rows, floor, block) = self.deck(kind, young, yields, bodies=4)
            deck.x = {n: (x + (2.0 if n > 2000 else 0.0), y - (0.3 if n > 3000 else 0.0)) for n, (x, y) in deck.x.items()}
            deck.cards = [("GRID", card[1], None, *deck.x[card[1]], 0.0) if card[0] == "GRID" else card for card in deck.cards]
            deck.hold(12, *lower[0], *floor[0])
            self.master(deck, rows, 126)
            deck.displace(self.MASTER, 6, 0.01)
            deck.displace(self.MASTER, 2, 0.01)
            for k, (one, other) in enumerate(((lower, rows), (floor, block))):
                for a, b in zip(one[-1], other[0]):
                    deck.pair(8000 + 100 * k + a % 100, a, b, 0.1 if k == 0 else 0.0)
            deck.hold(12 if not pressed else 1, *block[-1])
            if pressed:
                deck.card("RBE2", 9004, block[-1][0], 2, *block[-1][1:])
                deck.support(2, block[-1][0])
                deck.force(block[-1][0], 0.0, -1e-5 * young)
            with self.subTest(kind=kind, young=young, pressed=pressed, yields=yields):
                self.solved(deck, rows, lambda x, y: (0.01 * (1.5 - y), 0.01 + 0.01 * (x - 0.5)), "LOAD = 1\n" * pressed)

    def test_point_far_away(self):
        """The answer does not depend on the position of a point without elements that an MPC joins to a rotating body."""
        answers = set()
        for x, y in ((0.0, 0.0), (0.0, 5000.0), (0.0, -1e6), (1e9, 1.0), (1e9, 1e9)):
            deck, (lower, rows) = self.deck("CQUAD4", bodies=2)
            deck.hold(12, *lower[0])
            self.master(deck, rows, 126)
            deck.grid(self.POINT, x, y)
            deck.hold(2, self.POINT)
            deck.support(6, self.MASTER)
            deck.force(self.MASTER, 0.0, -2.0)
            deck.card("CELAS2", 9002, 10.0, self.POINT, 1)
            deck.card("MPC", 5, self.POINT, 1, 1.0, self.MASTER, 2, -0.8)
            for a, b in zip(lower[-1], rows[0]):
                deck.pair(8000 + a, a, b, 0.0)
            with self.subTest(x=x, y=y):
                result = self.valid("MPC = 5\nLOAD = 1\n" + deck.text())
                answers.add(tuple(sorted((n, row["ux"], row["uy"]) for n, row in result.nodes.items())))
        self.assertEqual(len(answers), 1)


class LargestStress(scene.Extremes):
    """An element has yielded if any integration point has: this is the largest stress, with its position."""

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
