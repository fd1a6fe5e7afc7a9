"""Extremes of elements; and the order of a deck, which must not matter."""
import random
import unittest

from scene import STEEL, Deck, Extremes
from test_scales import punch


def flat(aspect, size=1.0, triangles=False):
    """A column of 2 x 3 cells, each `wide` times wider than high."""
    deck = Deck(*STEEL)
    deck.stand(deck.block(1, [size*k for k in range(3)], [size/aspect*k for k in range(4)], triangles=triangles), 10.0)
    return deck


class Shapes(Extremes):
    def test_aspect(self):
        for aspect in (1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6):
            for triangles in (False, True):
                with self.subTest(aspect=aspect, triangles=triangles):
                    result = self.right_or_refused(flat(aspect, triangles=triangles), "rounding|condition|hardly distinguish")
                    self.assertTrue(result or aspect < 1e-2 or aspect > 1e3)
                    if result:
                        self.near(result.force, [2.5, 5.0, 2.5], 1e-6)
                        give = -10.0/2.0*3.0/aspect*(1.0 - STEEL[1]**2)/STEEL[0]
                        self.near(result.approach, [give]*2, 1e-6)

    def test_thin_layer(self):
        """One row of flat elements in a body of normal ones: the foil has the strain of all."""
        for height in (1e-2, 1e-4, 1e-6, 1e-8):
            for triangles in (False, True):
                with self.subTest(height=height, triangles=triangles):
                    deck = Deck(*STEEL)
                    nodes = deck.block(1, [0.0, 1.0, 2.0], [0.0, 1.0, 1.0 + height, 2.0], triangles=triangles)
                    deck.floor(nodes[0])
                    deck.hold(1, nodes[0][0])
                    deck.press(nodes[-1], 10.0)
                    deck.support(2, nodes[1][0], nodes[1][-1])
                    result = self.right_or_refused(deck, "elements differ too much in size|too small or too stiff")
                    self.assertTrue(result or height < 1e-7)
                    if result:
                        self.near(result.force, [2.5, 5.0, 2.5], 1e-9)
                        self.near(result.column("elements", "sy"), [-5.0]*len(result.elements), 1e-8)

    def test_areas(self):
        """Areas of 1e-14 and 1e14 are valid."""
        for size in (1e-7, 1e7, 1e-14, 1e14):
            for triangles in (False, True):
                result = self.valid(flat(1.0, size, triangles))
                self.near(result.force, [2.5, 5.0, 2.5])

    def test_no_area(self):
        """Elements on one line, or 1e-18 from it."""
        for height in (0.0, 1e-18, 1e-13):
            deck = Deck(*STEEL)
            for node, (x, y) in enumerate(((0.0, 0.0), (1.0, 0.0), (0.5, height)), 1):
                deck.grid(node, x, y)
                deck.hold(12, node)
            deck.element(1, 1, 2, 3)
            self.refused(deck, 2, "CTRIA3 1: its corners 1 2 3 lie on one line|CTRIA3 1.*one line")

    def test_small_beside_large(self):
        """Sizes from 1 down to 1e-9 in one mesh, each half of the next: a uniform pressure stays uniform. Measured
        from the small end all digits are there; from the other one the small elements move too far for their digits."""
        for halvings in (10, 20, 30):
            for at in (0, 2):
                with self.subTest(halvings=halvings, at=at):
                    deck, sizes = self.nested(halvings, at)
                    result = self.right_or_refused(deck, "elements too small or too stiff for their displacements")
                    self.assertTrue(result or halvings > 10 and at == 2)
                    if result:
                        ends = [0.0] + [0.5*(x + y) for x, y in zip([0.0] + sizes, sizes)] + [1.0]
                        for k, (left, right) in enumerate(zip(ends, ends[1:])):
                            self.near(result.pairs[70001 + k]["force"], 10.0*(right - left), 1e-5)
                        top = [result.nodes[node]["uy"] for node in (2, 3)]
                        self.near(top, [-0.01*(1.0 - 0.3**2)]*2)

    def nested(self, halvings, at):
        """Squares about one corner, its loaded edges, and the approach at the corner (0) or at the top (2)."""
        deck = Deck(1000.0, 0.3)
        sizes = [2.0**-k for k in range(halvings + 1)]
        deck.grid(9000, 0.0, 0.0)
        rings = [[deck.grid(10*k + 1, s, 0.0), deck.grid(10*k + 2, s, s), deck.grid(10*k + 3, 0.0, s)]
                 for k, s in enumerate(sizes)]
        for (a, b, c), (d, e, f) in zip(rings, rings[1:]):
            deck.element(1, d, a, b, e)
            deck.element(1, e, b, c, f)
        deck.element(1, 9000, *rings[-1])
        deck.floor([9000] + [ring[0] for ring in reversed(rings)])
        deck.hold(1, 9000, *[ring[2] for ring in rings])
        deck.press(rings[0][1:], 10.0)
        deck.support(2, rings[0][2] if at == 2 else 9000)
        return deck, sizes[::-1]


class Repeated(Extremes):
    def test_any_order_of_the_cards(self):
        deck = punch()
        base = self.valid(deck)
        generator = random.Random(6)
        for _ in range(5):
            order = list(range(len(deck.cards)))
            generator.shuffle(order)
            self.twins(base, self.valid(deck, order=order))

    def test_any_numbers(self):
        """Other ids in another order: the same model."""
        deck = punch()
        base = self.valid(deck)
        generator = random.Random(6)
        ids = sorted(deck.x)
        for _ in range(5):
            new = generator.sample(range(1, 99_999_999), len(ids))
            other = punch()
            other.cards = [self.renumbered(card, dict(zip(ids, new))) for card in deck.cards]
            generator.shuffle(other.cards)
            result = self.valid(other)
            self.near([result.nodes[n]["uy"] for n in new], [base.nodes[i]["uy"] for i in ids])
            self.near(result.force, base.force)

    def renumbered(self, card, new):
        """A card with other ids of its nodes; pairs keep theirs."""
        name, *fields = card
        places = {"GRID": [0], "CQUAD4": [2, 3, 4, 5], "SPC1": [2], "SUPORT": [0], "FORCE": [1], "CGAP": [2, 3]}.get(name, [])
        return (name, *[new[field] if k in places else field for k, field in enumerate(fields)])


if __name__ == "__main__":
    unittest.main()
