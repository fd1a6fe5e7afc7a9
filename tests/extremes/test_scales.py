"""Extremes of loads, lengths, units, positions, and of the range of numbers."""
import itertools
import unittest

from scene import STEEL, Deck, Extremes, written


def column(load=10.0, size=1.0, young=STEEL[0], poisson=STEEL[1], place=(0.0, 0.0), cells=(2, 3), first=1,
           triangles=False, thickness=1.0):
    """A block of 2 x 3 sizes, pressed on a floor that lets it spread: uniform stress, known exactly. One rigid-body mode
    along x is fixed, the other two are the approach."""
    deck = Deck(young, poisson, thickness)
    xs = [place[0] + 2.0*size*k/cells[0] for k in range(cells[0] + 1)]
    ys = [place[1] + 3.0*size*k/cells[1] for k in range(cells[1] + 1)]
    deck.nodes = deck.block(1, xs, ys, first, triangles)
    deck.stand(deck.nodes, load)
    return deck


def column_answer(load=10.0, size=1.0, young=STEEL[0], poisson=STEEL[1], cells=2, thickness=1.0):
    """Forces of the pairs and the approach."""
    forces = [load/cells*(0.5 if k in (0, cells) else 1.0) for k in range(cells + 1)]
    return forces, -load/(2.0*size*thickness)*3.0*size*(1.0 - poisson**2)/young


def punch(force=1.0, length=1.0, load=40.0, place=(0.0, 0.0)):
    """A block with a rounded lower side, partly in contact, in smaller units."""
    deck = Deck(1000.0*force/length/length, 0.3, length)
    xs = [place[0] + length*k for k in range(-4, 5)]
    deck.nodes = deck.block(1, xs, [place[1] + length*k for k in range(5)])
    deck.floor(deck.nodes[0], [length*(k - 4)**2/256.0 for k in range(9)])
    deck.hold(1, deck.nodes[0][4])
    deck.press(deck.nodes[-1], load*force)
    deck.support(2, deck.nodes[-1][0], deck.nodes[-1][-1])
    return deck


class Scales(Extremes):
    def column_is_right(self, **scale):
        with self.subTest(**scale):
            result = self.valid(column(**scale))
            forces, approach = column_answer(**scale)
            self.near(result.force, forces)
            self.near(result.approach, [approach]*2)

    def test_loads(self):
        for load in (1e-59, 1e-29, 1e-12, 1e-6, 1.0, 1e6, 1e12, 1e29):
            self.column_is_right(load=load)

    def test_lengths(self):
        for size in (1e-29, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e29):
            self.column_is_right(size=size)

    def test_moduli(self):
        for young in (1e-30, 1e-12, 1.0, 1e12, 1e30):
            self.column_is_right(young=young)

    def test_any_unit(self):
        """Powers of two, of ten, and old units."""
        base = self.valid(punch())
        self.assertTrue(0 < sum(base.touching) < 9)
        for force, length in ((2.0**40, 1.0), (2.0**-40, 1.0), (1.0, 2.0**30), (1.0, 2.0**-30), (2.0**55, 2.0**-15), (2.0**-55, 2.0**15),
                              (1024.0, 0.125), (1e12, 1.0), (1e-12, 1.0), (1.0, 1e9), (1.0, 1e-9), (9.80665, 25.4)):
            with self.subTest(force=force, length=length):
                self.twins(base, self.valid(punch(force, length)), force, length)

    def test_far_from_the_origin(self):
        base = self.valid(punch())
        for far in (2.0**20, -2.0**30, 2.0**40):
            with self.subTest(place=far):
                self.twins(base, self.valid(punch(place=(far, -far))))

    def test_far_in_fields_that_round(self):
        """Coordinates a million times the size keep ten digits of the size; so do the results."""
        base = self.valid(punch(length=0.3))
        self.twins(base, self.valid(punch(length=0.3, place=(1e6/3.0, 1e6/7.0))), relative=1e-8)

    def test_so_far_that_nothing_is_left(self):
        self.refused(punch(place=(1e17, 0.0)), 2, "CQUAD4|GRID")

    def test_not_a_number(self):
        deck = column()
        for written, cause in (("1.0e-310", "too far"), ("4.9e-324", "too far"),
                               ("1.0e309", "too far"), ("nan", "not a real"), ("inf", "not a real")):
            with self.subTest(written=written):
                self.refused(deck.text().replace("MAT1,1,210000.0", "MAT1,1," + written), 2, f"MAT1 1.*(?:{cause})")

    def test_products_beyond_the_largest_number(self):
        """Each field is in the range of numbers, but stiffness, area or work is not."""
        for scale in ({"size": 1e200}, {"young": 1e308}, {"young": 1e-300, "load": 1e300}, {"load": 1e307, "size": 1e-6},
                      {"size": 1e31}, {"young": 0.9e-30}, {"load": -1e40}):
            with self.subTest(**scale):
                self.refused(column(**scale), 2, "is too far from 1.0")
        for scale in ({"size": 1e-31}, {"size": 1e-160}, {"size": 1e-200}):
            with self.subTest(**scale):
                self.refused(column(**scale), 2, "its edges are shorter than 1.000E-30")

    def test_all_ranges_at_their_ends(self):
        """No product of loads, lengths, moduli and thicknesses leaves the range of numbers if they are within theirs."""
        for load, size, young, thickness in itertools.product((1e-59, 1e29), (1e-29, 1e29), (1e-30, 1e30), (1e-30, 1e30)):
            self.column_is_right(load=load, size=size, young=young, thickness=thickness)

    def test_causes_too_small(self):
        """The squares of a load, over stiffness, would underflow: work would vanish, and equilibrium could not be judged."""
        deck = column()
        for card, field in (("FORCE,1,1,0,1.-61,1.0", "F"), ("FORCE,1,1,0,-1.-200,0.0,1.0", "F"), ("PLOADX1,1,1,1.-200,,1,2", "PA"),
                            ("PLOADX1,1,1,1.0,-9.-61,1,2", "PB"), ("SPC,1,1,1,1.-200", "D1"), ("SPC,1,1,1,,2,1,-1.-99", "D2")):
            with self.subTest(card=card):
                self.refused(deck.text().replace("ENDDATA", card + "\nENDDATA"), 2, f"{card.split(',')[0]}.*.{field}. is too far from 1.0")
        for factor, direction in ((1e-40, 1e-40), (-1e-60, 0.9), (1e-60, 1e-300), (1e20, -1e20)):
            with self.subTest(factor=factor, direction=direction):
                card = f"FORCE,1,1,0,{written(factor)},0.0,{written(direction)}\n"
                self.refused(deck.text().replace("ENDDATA", card + "ENDDATA"), 2, "FORCE 1: .* is too far from 1.0")
        for card in ("FORCE,1,1,0,1.-60,1.0", "FORCE,1,1,0,1.+30,1.-90", "FORCE,1,1,0,0.0,1.0", "FORCE,1,1,0,1.0,0.0", "SPC,1,2,1,1.-60"):
            with self.subTest(card=card):
                self.valid(deck.text().replace("ENDDATA", card + "\nENDDATA"))

    def test_huge_ids(self):
        base, huge = self.valid(column()), self.valid(column(first=99_999_900))
        self.near(huge.force, base.force, 0.0)
        self.near(huge.column("nodes", "uy")[-12:], base.column("nodes", "uy")[:12], 0.0)
        self.refused(column(first=99_999_990), 2, "GRID.*99999999|GRID.*100000000")


if __name__ == "__main__":
    unittest.main()
