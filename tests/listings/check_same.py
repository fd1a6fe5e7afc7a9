#!/usr/bin/env python3
"""check_same.py PROGRAM DECK OUTPUT [PARAM ONE OTHER]...: a deck must have the same answer with two values of each PARAM: SOLVER BAND and
FRONTAL, RULE CONRY and JOINED; or with two kernels of OpenBLAS, named as in OPENBLAS_CORETYPE.

Exit status, words and integers must be equal; reals agree to 1e-9 of the largest value of the quantity in their table, because two
factors of one matrix have different rounding. Rounding measures, and states without an answer, are not compared.
"""
import csv
import os
import pathlib
import re
import subprocess
import sys

TOLERANCE = 1e-9
#: An estimate that depends on the order of the equations: seldom wrong by more than a third, and then too low.
ESTIMATES = {"condition": 0.1, "rounding_error_force": 0.1}
#: With RULE JOINED estimates use few solves, of all adjoint loads (otherwise of some, which represent others to 1E-2), and values
#: of the matrix, or of a single body, belong to another matrix.
MESH_ERROR, FEW_SOLVES, OF_THE_MATRIX = re.compile("mesh_error_.*"), 1e-3, {"condition", "rounding_error_force", "contact_amplification", "factorizations",
                                        "weak_pairs"}
#: Columns of one quantity: a stress that should be zero is compared with the others, not with itself.
KINDS = [{"ux", "uy"}, {"rx", "ry"}, {"sx", "sy", "sz", "txy", "equivalent_stress"}, {"force_x", "force_y"}, {"mesh_error_x", "mesh_error_y"}]
#: Tables and rows of the summary about rounding, or about the path.
WAY = {"equilibrium_residual", "smallest_force", "smallest_gap", "largest_force_gap_product", "stress_off_curve", "energy_balance",
       "friction_above_limit", "largest_force_slip_product", "iteration_error_displacement", "iteration_error_force", "pivots"}
#: Figures that set the scale of others: without a push, the friction force is the rounding of the contact force.
QUANTITY = {"friction_force": "total_contact_force", "max_shear": "max_pressure", "total_friction_force": "total_contact_force", "stress": "max_equivalent_stress", "half_width": "stick_half_width",
            "largest_penetration": "max_displacement", "worst_penetration": "max_displacement",
            "allowed_worst_penetration": "max_displacement", "largest_pressed_gap": "max_displacement",
            "worst_pressed_gap": "max_displacement", "allowed_worst_pressed_gap": "max_displacement"}


def run(program, deck, parameter, word, output):
    """Exit status and tables, {name: rows}."""
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("*"):
        old.unlink()
    copy = output / deck.name
    text = re.sub(r"(?im)^PARAM,ORIGINAL,YES$", "PARAM,METHOD,SECANT", deck.read_text())   # which chooses the rest itself
    kernel = parameter == "OPENBLAS_CORETYPE"
    copy.write_text(text if kernel else re.sub(r"(?im)^(BEGIN BULK.*)$", rf"\1\nPARAM,{parameter},{word}", text, count=1))
    status = subprocess.run([program, copy, "-o", output, "--tables", "all", "--quiet"], stderr=subprocess.DEVNULL,
                            env=os.environ | ({parameter: word} if kernel else {})).returncode
    tables = {path.suffixes[-2][1:]: list(csv.reader(path.open())) for path in sorted(output.glob("*.csv"))}
    tables.pop("history", None)
    return status, tables


def real(word):
    """A real number, or None: integers are compared as words."""
    return float(word) if re.fullmatch(r"[-+]?\d+\.\d*E[-+]\d+", word) else None


def scale(name, column, row, rows):
    """Scale of a number: the largest magnitude of its column; a row of the summary has its own, approaches a common one, and an error
    of increments also that of its quantity, because it is a difference of two values."""
    if name == "summary":   # one that is far below the others has their rounding
        key = rows[0].index("key")   # load cases precede it
        figure = row[key].removeprefix("increment_error_")
        figure = QUANTITY.get(figure, figure)
        alike = [row] + [other for other in rows[1:] if other[:key] == row[:key] and
                         (other[key] == figure or figure.startswith("approach_") and other[key].startswith("approach_"))]
        return max(abs(real(other[column]) or 0.0) for other in alike)
    kind = next((kind for kind in KINDS if rows[0][column] in kind), {rows[0][column]})
    members = [k for k, title in enumerate(rows[0]) if title in kind]
    return max(abs(real(other[k]) or 0.0) for other in rows[1:] for k in members)


def faults(name, one, other, words):
    if [len(row) for row in one] != [len(row) for row in other]:
        yield f"{name}: rows differ"
        return
    scales, joined = {}, words[1] == "JOINED"
    key_column = one[0].index("key") if name == "summary" else 0   # load cases precede it
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
    """Differences between two values of one PARAM."""
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
