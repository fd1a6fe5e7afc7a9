#!/usr/bin/env python3
"""check_same.py PROGRAM DECK OUTPUT [PARAM ONE OTHER]...: a deck must have the same answer by two values of each PARAM: SOLVER BAND and
FRONTAL, FLEXIB AUTO and INVERT, RULE CONRY and JOINED; or by two kernels of OpenBLAS, as OPENBLAS_CORETYPE names them.

Exit status, words and whole numbers are to be the same; reals to 1e-9 of the largest of their kind in their table, for two
factors of one matrix leave different rounding. What measures rounding, and states that are no answers, are not compared.
"""
import csv
import os
import pathlib
import re
import subprocess
import sys

TOLERANCE = 1e-9
#: An estimate, which depends on the order of the equations: seldom off by more than a third, and then low.
ESTIMATES = {"condition": 0.1, "rounding_error_force": 0.1}
#: By RULE JOINED estimates come of few solves, of all unit loads (else of some, which make up for others but for 1E-2), and what tells
#: of the matrix, or of a body alone, is of another one.
MESH_ERROR, FEW_SOLVES, OF_THE_MATRIX = re.compile("mesh_error_.*"), 1e-3, {"condition", "rounding_error_force", "contact_amplification", "factorizations",
                                        "weak_pairs"}
#: Columns of one kind: a stress that should be zero is compared with the others, not with itself.
KINDS = [{"ux", "uy"}, {"rx", "ry"}, {"sx", "sy", "sz", "txy", "equivalent_stress"}, {"force_x", "force_y"}, {"mesh_error_x", "mesh_error_y"}]
#: Tables and rows of the summary that tell of rounding, or of the way.
WAY = {"equilibrium_residual", "smallest_force", "smallest_gap", "largest_force_gap_product", "stress_off_curve", "energy_balance",
       "iteration_error_displacement", "iteration_error_force", "pivots"}


def run(program, deck, parameter, word, output):
    """Exit status and tables, {name: rows}."""
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("*"):
        old.unlink()
    copy = output / deck.name
    text = re.sub(r"(?im)^PARAM,ORIGINAL,YES$", "PARAM,METHOD,SECANT", deck.read_text())   # which chooses the rest by itself
    kernel = parameter == "OPENBLAS_CORETYPE"
    copy.write_text(text if kernel else re.sub(r"(?im)^(BEGIN BULK.*)$", rf"\1\nPARAM,{parameter},{word}", text, count=1))
    status = subprocess.run([program, copy, "-o", output, "--tables", "all", "--quiet"], stderr=subprocess.DEVNULL,
                            env=os.environ | ({parameter: word} if kernel else {})).returncode
    tables = {path.suffixes[-2][1:]: list(csv.reader(path.open())) for path in sorted(output.glob("*.csv"))}
    for name in ("history", "pivots"):
        tables.pop(name, None)
    return status, tables


def real(word):
    """A real number, or None: whole numbers are compared as words."""
    return float(word) if re.fullmatch(r"[-+]?\d+\.\d*E[-+]\d+", word) else None


def scale(name, column, row, rows):
    """The largest magnitude that a number is compared with; a row of the summary has one of its own, approaches that of all."""
    if name == "summary":   # one that is far below the others has their rounding
        alike = [other for other in rows[1:] if other[0].startswith("approach_")] if row[0].startswith("approach_") else [row]
        return max(abs(real(other[column]) or 0.0) for other in alike)
    kind = next((kind for kind in KINDS if rows[0][column] in kind), {rows[0][column]})
    members = [k for k, title in enumerate(rows[0]) if title in kind]
    return max(abs(real(other[k]) or 0.0) for other in rows[1:] for k in members)


def faults(name, one, other, words):
    if [len(row) for row in one] != [len(row) for row in other]:
        yield f"{name}: rows differ"
        return
    scales, joined = {}, words[1] == "JOINED"
    key_column = one[0].index("key") if name == "summary" else 0   # load cases stand before it
    for mine, its in zip(one[1:], other[1:]):
        for column, (a, b) in enumerate(zip(mine, its)):
            figure = mine[key_column] if name == "summary" else one[0][column]
            if figure in WAY or joined and figure in OF_THE_MATRIX:
                continue
            if real(a) is None or real(b) is None:
                if a != b:
                    yield f"{name}: {a} by {words[0]}, {b} by {words[1]} in {','.join(mine)}"
                continue
            key = column if name != "summary" else (*mine[:key_column + 1], column)
            if key not in scales:
                scales[key] = scale(name, column, mine, one)
            allowed = FEW_SOLVES if joined and MESH_ERROR.fullmatch(figure) else ESTIMATES.get(figure, TOLERANCE)
            if not abs(real(a) - real(b)) <= allowed * scales[key]:
                yield f"{name}: {one[0][column]}: {a} by {words[0]}, {b} by {words[1]} in {','.join(mine)}"


def compared(program, deck, output, parameter, *words):
    """What differs by two values of one PARAM."""
    (one, tables), (other, others) = (run(program, deck, parameter, word, output / f"{parameter}_{word}") for word in words)
    if one != other:
        yield f"exit status {one} by {words[0]}, {other} by {words[1]}"
    elif tables.keys() != others.keys():
        yield f"tables {sorted(tables)} by {words[0]}, {sorted(others)} by {words[1]}"
    elif one in (2, 3):
        yield f"exit status {one}: nothing was solved"
    elif one == 0:
        if not tables:
            yield "no tables to compare"
        for name in tables:
            yield from faults(name, tables[name], others[name], words)


def main():
    program, deck, output, *words = sys.argv[1:]
    found = []
    for parameter, one, other in zip(words[::3], words[1::3], words[2::3]):
        found += [f"{parameter}: {fault}" for fault in compared(program, pathlib.Path(deck), pathlib.Path(output), parameter, one, other)][:20]
    sys.exit("\n".join(found) if found else 0)


if __name__ == "__main__":
    main()
