"""Decks through pyNastran: read, written in each form, run; and the differences between the tables of two runs."""
import csv
import os
import pathlib
import subprocess
import sys

from pyNastran.bdf.bdf import BDF

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "independent"), str(TOP / "tools")]
from cards import written  # noqa: E402
from deck import KINDS, ids, real  # noqa: E402
from deck import read as read_cards  # noqa: E402

PROGRAM = os.environ["EPCONT_PROGRAM"]
#: Forms of pyNastran: small fields, large fields, large fields with D exponents.
FORMS = {"small": {"size": 8}, "large": {"size": 16}, "double": {"size": 16, "is_double": True}}


def read_bdf(path, punch=False, xref=True):
    model = BDF(debug=False, log=None)
    model.read_bdf(str(path), xref=xref, punch=punch)
    return model


def write_bdf(model, path, form):
    model.write_bdf(str(path), write_header=False, interspersed=False, **FORMS[form])


def lines_of(path):
    """Nodes of each BLSEG of a deck, in its order."""
    return {int(card[1]): ids(card[2:]) for card in read_cards(path).of("BLSEG")}


def kinds_of(path):
    """Cards in a deck: their names, with the nonblank fields of the first line; for PARAM the name of the parameter."""
    return {(card[0], card[1] if card[0] == "PARAM" else tuple(map(bool, card[:9]))) for card in read_cards(path).cards}


def restore_lines(model, lines):
    """pyNastran 1.4.1 sorts the nodes of a BLSEG and drops the one that closes it; the ids of the cards that this has changed."""
    changed = [number for number, nodes in lines.items() if model.blseg[number].node_ids != nodes]
    for number in changed:
        model.blseg[number].nodes, model.blseg[number].nodes_ref = lines[number], None
    return changed


def rewritten(path, form=None):
    """Write the cards of a deck with commas, without pyNastran; reals are unchanged, or rounded to the digits of a form. The lines above
    them are unchanged."""
    lines = path.read_text().partition("BEGIN BULK")[0].splitlines() + ["BEGIN BULK"]
    for card in read_cards(path).cards:
        fields = [cut(field, form) for field in card[1:]]
        while fields and not fields[-1]:
            fields.pop()
        lines += [",".join([card[0] if i == 0 else ""] + fields[i:i + 8]) for i in range(0, len(fields), 8)]
    return "\n".join(lines + ["ENDDATA", ""])


def cut(field, form):
    """A field rounded as in a form of pyNastran: eight columns; ten digits, with a D exponent."""
    if form is None or len(field) <= 8:
        return field
    return written(real(field), 8) if form == "small" else written(float(f"{real(field):.9e}"), 16)


def run(paths, out):
    """Exit status and tables by stem; one run for all."""
    out.mkdir(exist_ok=True)
    subprocess.run([PROGRAM, *paths, "-o", out, "--tables", "all", "--quiet"], capture_output=True, text=True, timeout=600)
    return {path.stem: Tables(out, path.stem) for path in paths}


class Tables:
    def __init__(self, out, stem):
        self.stem = stem
        self.table = {name: self.read(out / f"{stem}.{name}.csv") for name in KINDS}
        #: Status by load case.
        self.statuses = {row.get("subcase"): row["value"] for row in self.rows(out / f"{stem}.summary.csv")
                         if row["key"] == "status"}

    @staticmethod
    def rows(path):
        return list(csv.DictReader(path.read_text(encoding="ascii").splitlines())) if path.is_file() else []

    def read(self, path):
        """Rows by load case, if there are several, and by name."""
        rows = self.rows(path)
        keys = list(rows[0])[:2 if "subcase" in rows[0] else 1] if rows else []
        return {tuple(row[key] for key in keys): row for row in rows}

    @property
    def status(self):
        """The status of all load cases, if it is equal."""
        statuses = set(self.statuses.values()) or {"rejected"}
        return statuses.pop() if len(statuses) == 1 else "mixed"

    def apart(self, other, discrete=True, tables=tuple(KINDS)):
        """The largest difference from another run's tables, relative to the largest value of the quantity; its position."""
        worst, pieces = (0.0, ""), {}
        if self.statuses != other.statuses:
            return float("inf"), f"status {self.statuses}, {other.statuses}"
        for name in tables:
            kinds, ours, theirs = KINDS[name], self.table[name], other.table[name]
            if set(ours) != set(theirs):
                return float("inf"), f"{name} has other rows"
            for kind, columns in kinds.items():
                pieces.setdefault(kind, []).extend(
                    (float(row[c]), float(theirs[key][c]), f"{name} {key} {c}") for key, row in ours.items() for c in columns if row[c])
            for key, row in ours.items() if discrete else ():
                for column in ("status", "state"):
                    if row.get(column) != theirs[key].get(column):
                        return float("inf"), f"{name} {key} {column}: {row[column]}, {theirs[key][column]}"
        for values in pieces.values():
            scale = max((abs(a) for a, _, _ in values), default=0.0) or 1.0
            worst = max([worst] + [(abs(a - b) / scale, where) for a, b, where in values])
        return worst
