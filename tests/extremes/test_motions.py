"""Extremes of supports and rigid-body modes."""
import math
import unittest

from scene import RINGS, STEEL, Deck, Extremes


def plate(load=(0.0, -1.0), at=None, feet=(0.0, 2.0), gaps=(0.0, 0.0), measured=(1, 9)):
    """A block of 2 x 1 on feet at these coordinates of its lower side (nodes 1 to 9), unconstrained; all of the load at one upper
    node (or a third at each end and the middle); the approach of these nodes."""
    deck = Deck(*STEEL)
    deck.nodes = deck.block(1, [k/4.0 for k in range(9)], [0.0, 0.5, 1.0])
    deck.floor([1 + round(4.0*foot) for foot in feet], gaps)
    deck.support(2, *measured)
    deck.hold(1, deck.nodes[0][4])
    top = deck.nodes[-1]
    for node in [top[at]] if at is not None else [top[0], top[4], top[8]]:
        share = 1.0 if at is not None else 1.0/3.0
        deck.force(node, load[0]*share, load[1]*share)
    return deck


class Supports(Extremes):
    def test_support_on_a_contact_node(self):
        """The node that measures the approach is in contact: its approach is zero."""
        result = self.valid(plate())
        self.near(result.force, [0.5, 0.5])
        self.near(result.approach, [0.0, 0.0], scale=1e-10)

    def test_support_anywhere(self):
        """The choice of SUPORT DOFs changes no force, gap or displacement."""
        reference = None
        for measured in ((1, 9), (1, 2), (5, 9), (19, 27), (10, 27), (4, 6)):
            result = self.valid(plate(at=3, gaps=(0.0, 0.01), measured=measured))
            reference = reference or result
            self.near(result.force, [0.625, 0.375])
            self.near(result.column("nodes", "uy"), reference.column("nodes", "uy"))

    def test_supports_next_to_each_other(self):
        """At a distance of 1e-6 of the size they still define the modes, with fewer digits; closer, they do not."""
        for apart in (1e-3, 1e-4, 1e-5, 1e-6, 1e-8):
            with self.subTest(apart=apart):
                result = self.right_or_refused(self.supported(apart, 1, 2), "rounding|condition|hardly distinguish its rigid-body modes")
                self.assertTrue(result if apart > 9e-4 else apart > 2e-6 or not result)
                if result:
                    far = self.valid(self.supported(apart, 0, 3))
                    self.near(result.force, far.force, 1e-6)
                    self.near(result.column("nodes", "uy"), far.column("nodes", "uy"), 1e-6)

    def supported(self, apart, *places):
        deck = Deck(*STEEL)
        nodes = deck.block(1, [0.0, 0.5, 0.5 + apart, 1.0], [0.0, 1.0])
        deck.floor(nodes[0])
        deck.hold(1, nodes[0][0])
        deck.support(2, *[nodes[1][place] for place in places])
        for end in (0, 3):
            deck.force(nodes[1][end], 0.0, -0.5)
        return deck

    def test_round_fits(self):
        """A disc, or a ring, free to rotate in the next ring, carries the same as a fixed one, whatever digits and chords; an oval rotates."""
        for kind, around in (("CTRIA3", (22, 31)), ("CQUAD4", (24, 48)), ("CTRIA6", (16, 32)), ("CQUAD8", (9, 18)), ("CQUAD4", (24, 37, 48))):
            for digits in (16, 6):
                with self.subTest(kind=kind, around=around, digits=digits):
                    self.assertFalse(self.turns(kind, around, digits))
        for aside in (5e-4, 3e-3):
            self.assertFalse(self.turns("CTRIA6", (16, 32), 16, 0.0, aside))
        for oval in (1e-6, 0.03):
            self.assertEqual(self.turns("CQUAD4", (24, 48), 16, oval), oval > 1e-3)

    def turns(self, *fit):
        held, free = (self.valid(self.fit(hold, *fit)) for hold in (True, False))
        return max(abs(one - other) for one, other in zip(held.force, free.force)) > 1e-6 * sum(held.force)

    def fit(self, hold, kind, around, digits, oval=0.0, aside=0.0):
        """Rings with some edges around, each .001 too large for the next; the first is loaded towards its centre, if that is exact or it
        is fixed."""
        deck, step = Deck(*STEEL), 2 if kind[-1] in "68" else 1
        for k, n in enumerate(around):
            n, first = n * step, 1000 * (k + 1)
            last = k == len(around) - 1
            for i in range(n):
                angle = 2.0 * math.pi * (i + 0.3) / n
                for j in range(0, 2 * step + 1, 1 + (kind == "CQUAD8") * (i % 2)):
                    radius = 0.5 + 0.5 * k + (0.501 - 0.001 * last) * j / (2 * step)
                    radius += oval * math.cos(2.0 * angle) * (abs(radius - 1.0) < 0.01)
                    x, y = (round(radius * f(angle), digits) for f in (math.cos, math.sin))
                    deck.grid(first + 10 * i + j, x + aside * (k == 0), y)
            for i in range(0, n, step):
                for j in range(0, 2 * step, step):
                    at = [[first + 10 * ((i + a) % n) + j + b for b in range(step + 1)] for a in range(step + 1)]
                    (a, b), (d, c) = (row[::step] for row in (at[0], at[-1]))
                    if kind == "CQUAD8":
                        deck.element(1, a, b, c, d, at[0][1], at[1][2], at[2][1], at[1][0], kind=kind)
                    elif kind == "CQUAD4":
                        deck.element(1, a, b, c, d)
                    else:
                        deck.element(1, a, b, c, *([at[0][1], at[1][2], at[1][1]] if step == 2 else []))
                        deck.element(1, a, c, d, *([at[1][1], at[2][1], at[1][0]] if step == 2 else []))
            ways = [first + 10 * (i % n) for i in range(0, n + step, step)]
            deck.card("BLSEG", first, *ways)
            deck.card("BLSEG", first + 1, *(node + 2 * step for node in ways))
            if k:
                deck.card("BCONP", k, first - 999, first)
            if last:
                deck.hold(12, *(node + 2 * step for node in ways[1:]))
            else:
                deck.support(1, first)
                deck.support(2, first)
                (deck.hold if hold or k == len(around) - 3 else deck.support)(2, ways[len(ways) // 2])
        if digits > 6 or len(around) > 2:
            x, y = deck.x[1000]
            deck.force(1000, 1000.0 * (aside - x), -1000.0 * y)
        return deck

    def test_feet_that_lean(self):
        """Below 1e-10 they push nothing."""
        for lean in (1e-12, 1e-9):
            deck = Deck(*STEEL)
            nodes = deck.block(1, [0.0, 1.0, 2.0], [0.0, 1.0])
            deck.floor(nodes[0], normal=(lean, 1.0))
            deck.support(1, nodes[0][0])
            deck.support(2, nodes[1][0], nodes[1][-1])
            deck.press(nodes[-1], 1.0)
            self.valid(deck) if lean < 1e-10 else self.refused(deck, 1, "and no contact resists it")

    def test_no_load(self):
        """An unconstrained body without load stays at rest; without SUPORT it is rejected with the card to add."""
        for at in (0, None):
            result = self.valid(plate(load=(0.0, 0.0), at=at))
            self.near(result.force + result.approach, [0.0]*4, scale=1e-300)
            self.assertRegex(result.listing, r"\(1 warning, 2 notes\)\n  \d+:18-20: warning: FORCE 1: N1 and N2 are 0.0: no force(; so with 2 more)?;")
            self.assertIn("".join(f"  approach of GRID {node} direction 2: undetermined rigid-body mode; its value is the smallest that the gaps allow\n"
                                  for node in (1, 9)) + "\n", result.listing)
            self.assertEqual((result.summary["warnings"], result.summary["notes"]), (1.0, 2.0))
            self.assertIn("N1 and N2 are 0.0: no force", result.message)
        self.refused(plate(measured=()), 2, "SUPORT")

    def test_no_card_of_load(self):
        deck = plate()
        deck.cards = [card for card in deck.cards if card[0] != "FORCE"]
        result = self.valid(deck)
        self.near(result.force + result.column("nodes", "uy"), [0.0]*(2 + len(result.nodes)), scale=1e-300)

    def test_touching_at_one_point(self):
        """In balance on one foot under the load; half a rounding beside it falls over."""
        result = self.valid(plate(at=4, feet=(1.0,)))
        self.near(result.force, [1.0])
        self.assertIn("undetermined rigid-body mode: the smallest value", result.listing)
        for at in (3, 5):
            self.refused(plate(at=at, feet=(1.0,)), 1, "and no contact resists it")

    def test_at_the_edge_of_equilibrium(self):
        """The load above the last foot: that foot has all of it; a little beyond it the body falls over."""
        for beyond, falls in ((-1e-3, False), (-1e-9, False), (0.0, False), (1e-9, True), (1e-3, True)):
            deck = plate(load=(0.0, 0.0), at=0, feet=(0.25, 1.75))
            deck.force(19 + 1, 0.0, -1.0 - beyond)     # above the first foot, and a lever arm that tips the body beyond it
            deck.force(19 + 0, 0.0, -beyond*5.0)
            deck.force(19 + 8, 0.0, beyond*5.0)
            with self.subTest(beyond=beyond):
                if falls:
                    self.refused(deck, 1, "and no contact resists it")
                else:
                    result = self.valid(deck)
                    turning = -5.0*beyond*2.0/1.5
                    self.near(result.force, [1.0 + beyond - turning, turning], scale=1.0)

    def test_pulled_off(self):
        self.refused(plate(load=(0.0, 1e-12)), 1, "and no contact resists it")

    def test_turning_nearly_free(self):
        """Feet at a distance of 1e-6 of the size: forces are 1e6 of the load, and exact."""
        for apart in (1e-2, 1e-4, 1e-6):
            deck = Deck(*STEEL)
            nodes = deck.block(1, [0.0, 1.0 - apart, 1.0, 2.0], [0.0, 1.0])
            deck.hold(1, nodes[0][0])
            deck.floor(nodes[0][1:3])
            deck.floor(nodes[0][1:3], first=80001, normal=(0.0, -1.0))
            deck.support(2, nodes[1][0], nodes[1][3])
            deck.force(nodes[1][3], 0.0, -1.0)
            with self.subTest(apart=apart):
                result = self.right_or_refused(deck, "rounding|condition")
                if result:
                    self.near(result.force, [0.0, 1.0 + 1.0/apart, 1.0/apart, 0.0], 1e-9)


class Ties(Extremes):
    def two_blocks(self, upper_load):
        """Two blocks that share one node, a hinge; the lower is fixed, the upper leans on a wall that faces -x."""
        deck = Deck(*STEEL)
        lower = deck.block(1, [0.0, 1.0], [0.0, 1.0])
        deck.hold(12, *lower[0])
        a, b, c = deck.grid(11, 2.0, 1.0), deck.grid(12, 2.0, 2.0), deck.grid(13, 1.0, 2.0)
        deck.element(1, 4, a, b, c)
        deck.floor([b], normal=(-1.0, 0.0))
        deck.force(b, 0.0, upper_load)
        return deck

    def test_hinge(self):
        """Node 4 of the block below carries the next one, which rotates about it against the wall."""
        deck = self.two_blocks(-1.0)
        self.refused(deck, 2, "SUPORT")
        deck.support(1, 12)
        result = self.valid(deck)
        self.near(result.force, [1.0])     # lever arms of load and wall about the hinge: both 1.0
        deck = self.two_blocks(1.0)
        deck.support(1, 12)
        self.refused(deck, 1, "and no contact resists it")

    def test_chain_of_hinges(self):
        """Forty bars in a hanging row, each on one node of the last: as many rigid-body modes. Pushed sideways at the lower end,
        each leans on a wall at its middle with twice the load if the walls are on alternate sides, otherwise one swings freely."""
        result = self.valid(self.chain(alternate=True))
        self.near(result.force, [2.0]*40)
        self.refused(self.chain(alternate=False), 1, "and no contact resists it")

    def chain(self, alternate):
        deck = Deck(*STEEL)
        deck.grid(1, 0.0, 0.0)
        deck.hold(12, 1)
        count = 40
        for k in range(count):
            low = 3*k + 1
            deck.grid(low + 1, -0.5, -(k + 0.5))
            deck.grid(low + 2, 0.5, -(k + 0.5))
            deck.grid(low + 3, 0.0, -(k + 1.0))
            deck.element(1, low, low + 1, low + 3)
            deck.element(1, low, low + 3, low + 2)
            left = not alternate or (count - k) % 2 == 1
            deck.floor([low + 1 if left else low + 2], first=1001 + k, normal=(1.0 if left else -1.0, 0.0))
            deck.support(1, low + 3)
            deck.force(low + 3, -1.0 if k == count - 1 else 0.0, 0.0)
        return deck

    def test_platen_that_slides(self):
        """The upper side follows one node vertically, as a rigid platen; it gives the approach."""
        for leader_at in (0, 2):
            deck = Deck(*STEEL)
            nodes = deck.block(1, [0.0, 1.0, 2.0], [0.0, 1.0])
            deck.floor(nodes[0])
            deck.hold(1, nodes[0][0])
            leader = nodes[1][leader_at]
            deck.card("RBE2", 801, leader, 2, *[node for node in nodes[1] if node != leader])
            deck.force(nodes[1][1], 0.0, -10.0)
            deck.support(2, leader)
            result = self.valid(deck)
            self.near(result.force, [2.5, 5.0, 2.5])
            self.near(result.approach, [-5.0*(1.0 - STEEL[1]**2)/STEEL[0]])


    def test_nearly_a_hinge(self):
        """Two parts joined by one short edge rotate about it the more, the shorter it is: as 1/edge, with the length of the
        rounded coordinates."""
        turned = {}
        for side in (1e-2, 1e-4, 1e-5, 1e-6, 1e-8, 1e-10, 1e-14):
            deck = Deck(1000.0, 0.3)
            places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0 - side), (1.0, 1.0), (0.0, 1.0), (2.0, 1.0), (2.0, 2.0)]
            for node, (x, y) in enumerate(places, 1):
                deck.grid(node, x, y)
            for nodes in ((1, 2, 3), (1, 3, 4), (1, 4, 5), (3, 6, 4), (4, 6, 7)):
                deck.element(1, *nodes)
            deck.hold(12, 1, 5)
            deck.force(6, 0.0, -1.0)
            with self.subTest(side=side):
                result = self.right_or_refused(deck, "hardly anything resists a rigid-body mode|lie on one line")
                self.assertTrue(result or side < 1e-5)
                if result:
                    turned[side] = result.nodes[6]["uy"]*(1.0 - (1.0 - side))
        self.near(turned[1e-4], turned[1e-5], 1e-3)
        self.near(turned[1e-5], turned[1e-6], 1e-4)
        for side in sorted(turned)[:-4]:
            self.near(turned[side], turned[1e-6], 1e-6)

    def test_travel_prescribed(self):
        """Supports may move much farther than the body deforms: their common displacement takes no digits of the strains."""
        for travel in (0.0, 1.0, 1e3, 1e6, 1e9, 1e12):
            deck = Deck(1000.0, 0.3)
            nodes = deck.block(1, [0.0, 1.0, 2.0], [0.0, 1.0, 2.0])
            for node in nodes[0]:
                deck.displace(node, 2, travel)
            deck.hold(1, nodes[0][0])
            deck.press(nodes[-1], 1.0)
            with self.subTest(travel=travel):
                result = self.valid(deck)
                self.near(result.column("elements", "sy"), [-0.5]*4, 1e-8)
                self.near(result.column("nodes", "uy")[:3], [travel]*3, 1e-15)

    def test_slender_ring(self):
        """So far from its axis that hardly anything resists its expansion; pressed uniformly on a floor."""
        for radius in (1e1, 1e2, 1e3, 1e4, 1e6, 1e9):
            deck = Deck(1000.0, 0.0, plane=RINGS)
            nodes = deck.block(1, [radius + i for i in range(4)], [0.0, 1.0, 2.0], triangles=True)
            deck.floor(nodes[0])
            deck.support(2, nodes[2][0])
            # A pressure of 1.0 as nodal forces of the full circle, exact for edges with linear displacement.
            forces = [ring_force(radius, i, sides) for i, sides in enumerate(((1,), (-1, 1), (-1, 1), (-1,)))]
            for node, force in zip(nodes[2], forces):
                deck.force(node, 0.0, -force)
            with self.subTest(radius=radius):
                result = self.right_or_refused(deck, "hardly anything resists a rigid-body mode")
                self.assertTrue(result if radius < 2e2 else radius < 2e4 or not result)
                if result:
                    self.near(result.force, forces, 1e-7)


def ring_force(radius, place, sides):
    """Nodal force of a unit pressure on the edges inward (-1) and outward (1) of a node: 2 pi times the integral of its shape function times r."""
    at = radius + place
    return 2.0*math.pi*sum(at/2.0 + side/6.0 for side in sides)


class Bodies(Extremes):
    def test_stack_of_two_hundred(self):
        """200 stacked blocks: each pair of neighbours carries the load from the top, and the deformations add up."""
        deck = Deck(1000.0, 0.0)
        count = 200
        tops = deck.stack([([0.0, 1.0], [float(k), k + 1.0]) for k in range(count)], 10)
        deck.press(tops[-1], 10.0)
        result = self.valid(deck)
        self.near(result.force, [5.0]*2*(count - 1))
        self.near([result.nodes[top[0]]["uy"] for top in tops], [-0.01*(k + 1) for k in range(count)])

    def test_two_hundred_that_do_not_touch_each_other(self):
        deck = Deck(1000.0, 0.0)
        for k in range(200):
            nodes = deck.block(1, [2.0*k, 2.0*k + 1.0], [0.0, 1.0], first=10*k + 1)
            deck.stand(nodes, 10.0**(k % 25 - 12), first=50001 + 10*k)
        result = self.valid(deck)
        for k in range(200):
            self.near([result.pairs[50001 + 10*k + i]["force"] for i in range(2)], [0.5*10.0**(k % 25 - 12)]*2, scale=1e12)


if __name__ == "__main__":
    unittest.main()
