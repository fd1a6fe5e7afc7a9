"""200 random models: written by our own writer and by pyNastran, in each of its forms, must give the same values."""
import pathlib
import random
import re
import tempfile
import unittest

from forms import FORMS, lines_of, read_bdf, restore_lines, run, write_bdf, written
from write_random import nested, pressed, stack, tongue

MODELS, SEED = 200, 1
#: Digits of a real that each form holds, whatever its exponent and sign.
DIGITS = {"small": 4, "large": 9, "double": 9}
SAME = 1e-10


def rounded(text, digits):
    """The same model with reals of so few digits that no form rounds them."""
    return re.sub(r"(?<=,)-?\d+\.\d*(E[+-]?\d+)?", lambda real: written(float(f"{float(real[0]):.{digits - 1}e}"), 16), text)


class Random(unittest.TestCase):
    def test_models(self):
        with tempfile.TemporaryDirectory() as directory:
            place = pathlib.Path(directory)
            pairs = [self.write(k, place) for k in range(MODELS)]
            found = run([path for pair in pairs for path in pair], place / "out")
        answers = 0
        for mine, theirs in pairs:
            with self.subTest(mine.stem):
                apart, where = found[mine.stem].apart(found[theirs.stem])
                self.assertLessEqual(apart, SAME, where)
            answers += found[mine.stem].status == "valid"
        self.assertGreater(answers, 0.7 * MODELS)

    def write(self, k, place):
        """Model k unchanged, and as pyNastran writes it."""
        form = list(FORMS)[k % 3]
        rng = random.Random(f"{SEED} {k}")
        scene = (pressed if k % 2 else [stack, nested, tongue][k // 2 % 3])(rng)
        mine, theirs = place / f"m{k:03}.dat", place / f"m{k:03}_{form}.dat"
        mine.write_text("SOL 101\nCEND\n" + rounded(scene.text(), DIGITS[form]))
        model = read_bdf(mine)
        restore_lines(model, lines_of(mine))
        write_bdf(model, theirs, form)
        return mine, theirs


if __name__ == "__main__":
    unittest.main()
