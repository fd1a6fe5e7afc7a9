"""Extremes of slender bodies: displacements lose as many digits as the ratio of the stiffnesses along and across; iterative refinement
recovers them. Compared with beam theory, exact for six-node elements under pure bending, and with another solver for the others."""
import unittest

from scene import PLANE_STRESS, Deck, Extremes

YOUNG = 2.1e5


def strip(length, solver, order):
    """A bar of height 1 clamped at its left end, with elements of 3, 4 or 6 nodes; no contraction, so the clamp adds no stress."""
    deck = Deck(YOUNG, 0.0, plane=PLANE_STRESS)
    deck.parameter("SOLVER", solver)
    if order == 6:
        deck.columns = six_node_block(deck, length, 1, 0.0)
    else:
        xs = [0.5*k for k in range(2*length + 1)]
        rows = deck.block(1, xs, [0.0, 0.5, 1.0], triangles=order == 3)
        deck.columns = [list(column) for column in zip(*rows)]
    deck.hold(12, *deck.columns[0])
    return deck


def six_node_block(deck, length, first, bottom):
    """One row of squares, each of two triangles; the columns of nodes, those of the mid-side nodes between them."""
    columns = [[deck.grid(first + 3*i + j, 0.5*i, bottom + 0.5*j) for j in range(3)] for i in range(2*length + 1)]
    for left, middle, right in zip(columns[::2], columns[1::2], columns[2::2]):
        deck.element(1, left[0], right[0], right[2], middle[0], right[1], middle[1])
        deck.element(1, left[0], right[2], left[2], middle[1], middle[2], left[1])
    return columns


class Slender(Extremes):
    def test_couple_on_six_node_elements(self):
        """A moment at the end bends it to a parabola, which these elements represent exactly."""
        for length in (10, 40, 100, 400):
            for solver in ("BAND", "FRONTAL"):
                with self.subTest(length=length, solver=solver):
                    deck = strip(length, solver, 6)
                    bottom, _, top = deck.columns[-1]
                    deck.force(top, 1.0/6.0, 0.0)      # of stresses from -1 to 1
                    deck.force(bottom, -1.0/6.0, 0.0)
                    result = self.valid(deck)
                    for column, x in ((length, 0.5*length), (2*length, float(length))):
                        rise = [result.nodes[node]["uy"] for node in deck.columns[column]]
                        self.near(rise, [-x*x/YOUNG]*3, 1e-8)
                    self.near(result.column("elements", "txy"), [0.0]*len(result.elements), scale=1.0)

    def test_force_on_all_kinds(self):
        for order in (3, 4, 6):
            for length in (10, 40, 400):
                with self.subTest(order=order, length=length):
                    tips = []
                    for solver in ("BAND", "FRONTAL"):
                        deck = strip(length, solver, order)
                        deck.force(deck.columns[-1][1], 0.0, -1.0)
                        tips.append(self.valid(deck).nodes[deck.columns[-1][1]]["uy"])
                    self.near(tips[1], tips[0], 1e-8)
                    if order == 6:   # and shear: 12/5 (L/h)/E of it, with E = 2 G
                        self.near(tips[0], -(4.0*length**3 + 2.4*length)/YOUNG, 0.03)

    def test_two_bars_in_contact(self):
        """One bar on the end of another of the same length: each carries half of the force."""
        for length in (10, 40, 400):
            with self.subTest(length=length):
                deck = strip(length, "BAND", 6)
                lower = deck.columns
                upper = six_node_block(deck, length, 1 + 3*len(lower), 1.0)
                deck.hold(12, *upper[0])
                deck.pair(70001, lower[-1][2], upper[-1][0])
                deck.force(upper[-1][2], 0.0, -1.0)
                self.near(self.valid(deck).force, [0.5], 1e-3)


if __name__ == "__main__":
    unittest.main()
