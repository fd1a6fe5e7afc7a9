"""Every deck below input: read by pyNastran, written by it, solved again, to the same values.

A deck with a card that no smaller deck has is written in each form of pyNastran, any other deck in one of them.
"""
import pathlib
import tempfile
import unittest

from forms import FORMS, TOP, kinds_of, lines_of, read_bdf, restore_lines, rewritten, run, write_bdf

DECKS = sorted(TOP.glob("input/**/*.dat"), key=lambda path: (path.stat().st_size, path))
INCLUDED = sorted(TOP.glob("input/**/*.inc")) + sorted(TOP.glob("input/**/*.bdf"))
SAME = 1e-10   # relative to the largest value of the quantity
LARGE_FIELD = 1e-8   # sixteen columns keep eleven digits or more; models magnify the rest
LOST = 3.0     # times the effect of our own rounding to the same number of digits: other digits may be lost


class Input(unittest.TestCase):
    def test_included_files(self):
        for path in INCLUDED:
            with self.subTest(path.name):
                self.assertTrue(read_bdf(path, punch=True, xref=False).card_count)

    def test_decks(self):
        with tempfile.TemporaryDirectory() as directory:
            place = pathlib.Path(directory)
            runs, forms, seen = list(DECKS), {}, set()
            for k, path in enumerate(DECKS):
                kinds = kinds_of(path)
                forms[path.stem] = [list(FORMS)[k % 3]] if kinds <= seen else list(FORMS)
                seen |= kinds
                with self.subTest(path.name):
                    runs += self.through(path, forms[path.stem], place)
            found = run(runs, place / "out")
            for path in DECKS:
                with self.subTest(path.name):
                    self.assertTrue(found[path.stem].status == "valid" or path.parent.name == "faults", found[path.stem].status)
                    self.judge(path.stem, forms[path.stem], found)

    def through(self, path, forms, place):
        """The deck by pyNastran in these forms, each by our own writer too; and the deck's own cards, rounded to a form."""
        model = read_bdf(path)
        self.assertFalse(model.reject_lines + model.reject_cards)
        changed = restore_lines(model, lines_of(path))
        if path.parent.name == "from_gmsh":
            self.assertFalse(changed)   # tools/deck numbers nodes along its lines
        made = []
        for form in forms:
            made.append(place / f"{path.stem}_{form}.dat")
            write_bdf(model, made[-1], form)
            made.append(place / f"{path.stem}_{form}_twin.dat")
            made[-1].write_text(rewritten(made[-2]))
            if form != "large":
                made.append(place / f"{path.stem}_{form}_cut.dat")
                made[-1].write_text(rewritten(path, form))
        return made

    def judge(self, stem, forms, found):
        """epcont must read it as the deck of our own writer; its differences from the deck are at most those of the lost digits."""
        original = found[stem]
        for form in forms:
            there = found[f"{stem}_{form}"]
            apart, where = there.apart(found[f"{stem}_{form}_twin"])
            self.assertLessEqual(apart, SAME, f"{form} and its twin: {where}")
            apart, where = original.apart(there, discrete=form == "large")
            allowed = LARGE_FIELD if form == "large" else LOST * original.apart(found[f"{stem}_{form}_cut"], discrete=False)[0] + SAME
            self.assertLessEqual(apart, allowed, f"{form}: {where}")


if __name__ == "__main__":
    unittest.main()
