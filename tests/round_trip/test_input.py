"""Every deck below input: read by pyNastran, written by it in each of its forms, solved again, to the same values."""
import pathlib
import tempfile
import unittest

from forms import FORMS, TOP, lines_of, read_bdf, restore_lines, rewritten, run, write_bdf

DECKS = sorted(TOP.glob("input/**/*.dat"))
INCLUDED = sorted(TOP.glob("input/**/*.inc")) + sorted(TOP.glob("input/**/*.bdf"))
#: Of the largest of its kind. Sixteen columns leave eleven digits or more; what is left is how a scene magnifies them.
SAME, LARGE_FIELD = 1e-10, 1e-8


class Input(unittest.TestCase):
    def test_included_files(self):
        for path in INCLUDED:
            with self.subTest(path.name):
                self.assertTrue(read_bdf(path, punch=True, xref=False).card_count)

    def test_decks(self):
        with tempfile.TemporaryDirectory() as directory:
            place = pathlib.Path(directory)
            runs = list(DECKS)
            for path in DECKS:
                with self.subTest(path.name):
                    runs += self.through(path, place)
            found = run(runs, place / "out")
            for path in DECKS:
                with self.subTest(path.name):
                    self.judge(path.stem, found)

    def through(self, path, place):
        """The deck by pyNastran in its forms, each by our own writer too, and its cards in small fields."""
        model = read_bdf(path)
        self.assertFalse(model.reject_lines + model.reject_cards)
        restore_lines(model, lines_of(path))
        made = []
        for form in FORMS:
            made.append(place / f"{path.stem}_{form}.dat")
            write_bdf(model, made[-1], form)
            made.append(place / f"{path.stem}_{form}_twin.dat")
            made[-1].write_text(rewritten(made[-2], "free"))
        made.append(place / f"{path.stem}_cut.dat")
        made[-1].write_text(rewritten(path, "small"))
        return made

    def judge(self, stem, found):
        original = found[stem]
        cut, _ = original.apart(found[f"{stem}_cut"], discrete=False)
        for form in FORMS:
            there = found[f"{stem}_{form}"]
            apart, where = there.apart(found[f"{stem}_{form}_twin"])
            self.assertLessEqual(apart, SAME, f"{form} and its twin: {where}")
            apart, where = original.apart(there, discrete=form != "small")
            self.assertLessEqual(apart, 3 * cut + SAME if form == "small" else LARGE_FIELD, f"{form}: {where}")


if __name__ == "__main__":
    unittest.main()
