"""Cards as text: fields of a line, and reals in fields."""
import pathlib
import random
import sys
import unittest
from decimal import Decimal

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests" / "independent")]
import cards  # noqa: E402
import deck  # noqa: E402


def number(text):
    at = max(text.rfind("+"), text.rfind("-"))
    return Decimal(text) if at < 1 else Decimal(f"{text[:at]}E{text[at:]}")


class Fields(unittest.TestCase):
    def test_small_large_free(self):
        self.assertEqual(("GRID", ["1", "", "2.5", "", "", "", "", ""]), cards.fields("GRID    1               2.5"))
        self.assertEqual(("GRID*", ["1", "", "2.5", ""]), cards.fields("GRID*   1                               2.5"))
        self.assertEqual(("GRID", ["1", "", "2.5", "", "", "", "", ""]), cards.fields("GRID, 1,,2.5"))
        self.assertEqual(("*", ["1", "2", "3", "4"]), cards.fields("*,1,2,3,4,5"))
        self.assertEqual(("", ["1", "2", "3", "4", "5", "6", "7", "8"]), cards.fields(",1,2,3,4,5,6,7,8,+"))

    def test_as_the_independent_reader_has_it(self):
        lines = [line for path in sorted((ROOT / "input").rglob("*.dat")) + sorted((ROOT / "tests/independent/cases").glob("*.dat"))
                 if path.stat().st_size < 100000 and "faults" not in path.parts for line in deck.lines_of(path)]
        self.assertGreater(len(lines), 1000)
        for line in lines:
            self.assertEqual(deck.fields_of(line), cards.fields(line))


class Reals(unittest.TestCase):
    def test_spelling(self):
        for value, small, large in ((0.0, "0.", "0."), (-0.0, "0.", "0."), (20400.0, "20400.", "20400."), (-0.5, "-.5", "-.5"), (1e6, "1000000.", "1000000."),
                                    (1e7, "1.+7", "10000000."), (1e-4, ".0001", ".0001"), (1e-5, "1.-5", "1.-5"), (0.99999999, "1.", ".99999999"),
                                    (-4.8632e-4, "-4.863-4", "-.00048632"), (1 / 3, ".3333333", ".333333333333333"), (1e-300, "1.-300", "1.-300")):
            self.assertEqual((small, large), (cards.written(value, 8), cards.written(value, 16)))
        self.assertEqual(".3333333333333333", cards.written(Decimal(1) / 3)[:17])
        self.assertEqual("1.5+20", cards.written(Decimal("1.5e20")))
        self.assertRaises(ValueError, cards.written, -1e-100, 5)

    def test_as_near_as_the_field_allows(self):
        """Half a unit of the digits that the columns hold beside decimal point, sign and exponent."""
        pick = random.Random(1)
        for _ in range(3000):
            value = pick.choice([-1, 1]) * pick.uniform(1, 10) * 10.0 ** pick.randint(-20, 20)
            exponent = len(f"{int(f'{value:e}'.split('e')[1]):+d}")
            for width in (8, 16):
                text = cards.written(value, width)
                self.assertLessEqual(len(text), width)
                digits = width - 1 - (value < 0) - exponent
                self.assertLessEqual(abs(number(text) - Decimal(value)), abs(Decimal(value)) * Decimal(5) * Decimal(10) ** -digits, (value, text))


if __name__ == "__main__":
    unittest.main()
