#!/usr/bin/env python3
"""Write models through pyNastran in each of its formats, and read them back by the independent reader.

    . tools/venv && python tests/independent/write_cases.py [DECK...]

Each deck (by default hertz44, the contact patch test and the shrink fit) is read by pyNastran and written in small field
(size 8), large field (size 16), large field of double precision (`D` exponents), and sorted by property
(interspersed); and once in free field from the same cards. `cases/` keeps the small files. The answers must be those of the
original deck: exactly if all digits are kept, and to the digits of the field at size 8.
"""
import argparse
import pathlib
import sys

from pyNastran.bdf.bdf import BDF

import deck as reader
from solve import solve

HERE = pathlib.Path(__file__).resolve().parent
INPUT = HERE.parent.parent / "input"
DEFAULT = ["hertz/hertz44_elastic.dat", "patch/contact_patch.dat", "shrink_fit/shrink_fit.dat"]
LARGEST_KEPT = 60000
# PLOADX1 is an axisymmetric card there; pyNastran requires axisymmetric elements only when it cross-references.
FORMS = {
    "size8": {"size": 8},
    "size16": {"size": 16},
    "double16": {"size": 16, "is_double": True},
    "interspersed": {"size": 8, "interspersed": True},
}


def read(path):
    model = BDF(debug=False, log=None)
    model.read_bdf(str(path), xref=False, punch=False)
    return model


def free_field(path):
    """The cards of a deck in free field, small or, if a field is long, large (`NAME*`)."""
    deck = reader.read(path)
    lines = ["$ the cards of " + path.name + " in free field"]
    lines += [f"{key} = {value}" for key, value in deck.case.items()] + ["BEGIN BULK"]
    for card in deck.cards:
        fields = list(card[1:])
        while fields and not fields[-1]:
            fields.pop()
        wide = any(len(field) > 8 for field in fields)
        step, name = (4, card[0] + "*") if wide else (8, card[0])
        for i in range(0, max(len(fields), 1), step):
            lines.append(",".join([name if i == 0 else ("*" if wide else "")] + fields[i:i + step]))
    return "\n".join(lines + ["ENDDATA", ""])


def figures(path):
    tables, _ = solve(path)
    return {row[0]: row[1] for row in tables["summary"][1] if isinstance(row[1], float)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("decks", nargs="*", type=pathlib.Path)
    options = parser.parse_args()
    bad = 0
    (HERE / "cases").mkdir(exist_ok=True)
    for path in options.decks or [INPUT / name for name in DEFAULT]:
        expected = figures(path)
        for form in [*FORMS, "free"]:
            written = HERE / "cases" / f"{path.stem}_{form}.dat"
            if form == "free":
                written.write_text(free_field(path), encoding="ascii")
            else:
                read(path).write_bdf(str(written), write_header=False, **{"interspersed": False, **FORMS[form]})
            found = figures(written)
            scale = 1e-5 if form in ("size8", "interspersed") else 1e-9
            wrong = [key for key, value in expected.items()
                     if abs(found.get(key, float("nan")) - value) > scale * abs(value) or key not in found]
            print(f"{written.name}: {'differs in ' + ', '.join(wrong) if wrong else 'the same answer'}")
            bad += bool(wrong)
            if written.stat().st_size > LARGEST_KEPT:
                written.unlink()
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
