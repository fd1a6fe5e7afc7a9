"""Many bodies in contact in many ways, with both contact solvers: the same answers, and joined bodies find theirs without the flexibility matrix."""
import math
import os
import pathlib
import re
import unittest

from scene import Deck, Extremes

INPUT = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])/"input"
WIDTH, COLUMNS, ROWS = 2.0, 4, 2


class Pile(Deck):
    """Unconstrained bodies, whose pairs are numbered in the order of the calls."""

    def __init__(self, moduli=(1.0e5,)):
        super().__init__()
        for number, modulus in enumerate(moduli, 1):
            self.material(number, modulus, 0.3)
        self.nodes, self.pairs = 1, 0

    def brick(self, x, y, material=1):
        nodes = self.block(material, [x + WIDTH*i/COLUMNS for i in range(COLUMNS + 1)], [y + i/ROWS for i in range(ROWS + 1)], self.nodes)
        self.nodes += (COLUMNS + 1)*(ROWS + 1)
        self.support(2, nodes[-1][0], nodes[-1][-1])
        self.support(1, nodes[-1][0])
        return nodes

    def meet(self, a, b, gap=0.0, normal=(0.0, 1.0)):
        self.pairs += 1
        self.pair(9_000_000 + self.pairs, a, b, gap, normal)

    def ground(self, node, normal=(0.0, 1.0)):
        self.nodes += 1
        held = self.grid(5_000_000 + self.nodes, *self.x[node])
        self.hold(12, held)
        self.meet(held, node, 0.0, normal)


def wall(size, gap=0.0, at_top=None, side=0.1, moduli=(1.0e5,)):
    """Bricks in running bond between the floor, a wall on the left and a push on the right, with gaps in the upright joints."""
    deck = Pile(moduli)
    bricks = {(r, c): deck.brick(c*WIDTH + r % 2*WIDTH/2.0, float(r), 1 + (7*r + 3*c) % len(moduli)) for r in range(size) for c in range(size)}
    for (r, c), nodes in bricks.items():
        if c + 1 < size:
            for left, right in zip(nodes, bricks[r, c + 1]):
                deck.meet(left[-1], right[0], gap, (1.0, 0.0))
        else:
            deck.press([row[-1] for row in nodes], side, (-1.0, 0.0))
        if c == 0:
            for row in nodes:
                deck.ground(row[0], (1.0, 0.0))
        for node in nodes[0]:
            if r == 0:
                deck.ground(node)
            for below in [other for k in range(size) for other in bricks.get((r - 1, k), [[]])[-1]]:
                if abs(deck.x[below][0] - deck.x[node][0]) < 1e-9:
                    deck.meet(below, node)
    for c in range(size):
        deck.press(bricks[size - 1, c][-1], (10.0 if c == at_top else 0.0) if at_top is not None else 2.0)
    return deck


def disc(deck, x, y, parts=12, rings=2):
    """Its centre and its rim."""
    middle = deck.grid(deck.nodes, x, y)
    rim = [[deck.grid(deck.nodes + 1 + parts*k + i, x + (k + 1)/rings*math.cos(2*math.pi*i/parts), y + (k + 1)/rings*math.sin(2*math.pi*i/parts))
            for i in range(parts)] for k in range(rings)]
    deck.nodes += 1 + parts*rings
    for i in range(parts):
        k = (i + 1) % parts
        deck.element(1, middle, rim[0][i], rim[0][k])
        for inner, outer in zip(rim, rim[1:]):
            deck.element(1, inner[i], outer[i], outer[k], inner[k])
    return middle, rim[-1]


def rollers(count):
    """Between the floor and a plate, free to roll and to rotate: nothing resists either."""
    deck = Pile()
    plate = deck.block(1, [1.25*k for k in range(2*count - 1)], [2.0, 2.5], 4_000_001)
    deck.support(2, plate[-1][0], plate[-1][-1])
    deck.hold(1, plate[-1][0])
    deck.press(plate[-1], 10.0*count)
    for k in range(count):
        middle, rim = disc(deck, 2.5*k, 1.0)
        deck.ground(rim[9])
        deck.meet(rim[3], plate[0][2*k])
        deck.support(2, middle)
        deck.support(1, middle, rim[3])
    return deck


def heap(layers):
    """A triangle of discs under their weight, between two walls."""
    deck = Pile()
    discs = {(r, k): disc(deck, 2.0*k + r, 1.0 + r*math.sqrt(3.0)) for r in range(layers) for k in range(layers - r)}
    for (r, k), (middle, rim) in discs.items():
        deck.support(1, middle, rim[3])
        deck.support(2, middle)
        deck.force(middle, 0.0, -1.0)
        if r == 0:
            deck.ground(rim[9])
            for end, node, way in ((0, rim[6], 1.0), (layers - 1, rim[0], -1.0)):
                if k == end:
                    deck.ground(node, (way, 0.0))
        for other, own, its, angle in (((r, k + 1), 0, 6, 0.0), ((r + 1, k), 2, 8, 60.0), ((r + 1, k - 1), 4, 10, 120.0)):
            if other in discs:
                deck.meet(rim[own], discs[other][1][its], 0.0, (math.cos(math.radians(angle)), math.sin(math.radians(angle))))
    return deck


def stack(count, moduli):
    deck = Pile(moduli)
    below = None
    for k in range(count):
        nodes = deck.brick(0.0, float(k), 1 + k % len(moduli))
        for i, node in enumerate(nodes[0]):
            if below:
                deck.meet(below[i], node)
            else:
                deck.ground(node)
        deck.ground(nodes[0][0], (1.0, 0.0))
        deck.force(nodes[0][-1], -0.001, 0.0)
        below = nodes[-1]
    deck.press(below, 2.0)
    return deck


class Walls(Extremes):
    def by_rules(self, text, names=("force", "gap")):
        """The same answers with all solvers."""
        answers = {}
        for rule in ("CONRY", "JOINED"):
            result = answers[rule] = self.valid(re.sub("(?m)^BEGIN BULK.*$", f"BEGIN BULK\nPARAM,RULE,{rule}", text, count=1))
            self.assertEqual("contact solver JOINED:" in result.listing, rule == "JOINED")
        for name in names:
            self.near(getattr(answers["JOINED"], name), getattr(answers["CONRY"], name), 1e-9)
        return answers["JOINED"]

    def test_walls(self):
        """Closed; with joints that open; under a load on one brick; with bricks as stiff as steel, or as rubber."""
        six_decades = [10.0**(3 + k) for k in (3, 0, 6, 1, 5, 2, 4)]
        for name, deck in (("closed", wall(5)), ("gaps", wall(5, 2e-4)), ("nothing from the side", wall(5, 2e-4, side=0.0)),
                           ("one brick", wall(6, at_top=3)), ("unlike bricks", wall(5, moduli=six_decades))):
            with self.subTest(name):
                self.by_rules(deck.text())

    def test_rollers(self):
        """Sixteen undetermined modes stay at zero."""
        result = self.by_rules(rollers(8).text())
        self.assertEqual(16, result.listing.count("undetermined rigid-body mode: the smallest value"))

    def test_heap(self):
        self.by_rules(heap(5).text())

    def test_stack_of_unlike_bodies(self):
        self.by_rules(stack(30, [1.0e3, 1.0e9, 1.0e6, 1.0e4, 1.0e8]).text())

    def test_springs_and_sums(self):
        """Springs, MPC, an RBE2 that rotates."""
        for deck in ("bolt/bolt.dat", "tilting_platen/tilting_platen.dat"):
            with self.subTest(deck):
                self.by_rules((INPUT/deck).read_text(), ())


if __name__ == "__main__":
    unittest.main()
