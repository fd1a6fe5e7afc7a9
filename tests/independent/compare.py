#!/usr/bin/env python3
"""Run epcont and the independent program on decks and compare their tables.

    . tools/venv && python tests/independent/compare.py build/release/epcont input/*/*.dat

Differences are relative to the largest of their kind: forces and reactions to the largest of them, gaps, displacements
and approaches to the largest displacement or initial gap, stresses to the largest stress, pressures to the largest.

Decks that can yield are run with TOL 1E-12.

Exit status: 0 all agree, 1 some do not, 2 usage.
"""
import argparse
import csv
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from deck import KINDS, DeckError
from solve import NoEquilibrium, solve


def read(path, case):
    """Rows of a load case, of all where there are not several."""
    if not path.exists():
        return []
    with open(path, newline="", encoding="ascii") as file:
        return [row for row in csv.DictReader(file) if case is None or row["subcase"] == str(case)]


def compare(found, directory, stem, case):
    """(kind, relative difference, where) of every kind of number, and the faults of structure."""
    worst, faults, pieces = {}, [], {}
    for name, kinds in KINDS.items():
        header, rows = found[name]
        theirs = {row[header[0]]: row for row in read(directory / f"{stem}.{name}.csv", case)}
        if {str(row[0]) for row in rows} != set(theirs):
            faults.append(f"{name}: not the same {header[0]}s")
            continue
        for kind, columns in kinds.items():
            for column in columns:
                at = header.index(column)
                for row in rows:
                    told = theirs[str(row[0])][column]
                    if told:
                        pieces.setdefault(kind, []).append((row[at], float(told), f"{name} {row[0]} {column}"))
        if name == "contact":
            for row in rows:
                if theirs[str(row[0])]["status"] != row[11] and max(abs(row[8]), abs(row[10])) > 0:
                    faults.append(f"pair {row[0]}: {row[11]} here, {theirs[str(row[0])]['status']} there")
        if name == "elements":
            off = [row[0] for row in rows if theirs[str(row[0])]["state"] != row[10]]
            faults += [f"element {element}: elastic in one, plastic in the other" for element in off]
    summary = {row["key"]: row["value"] for row in read(directory / f"{stem}.summary.csv", case)}
    for key, value, _ in found["summary"][1]:
        kind = {"max_pressure": "pressure", "total_contact_force": "force", "max_equivalent_stress": "stress",
                "max_displacement": "length"}.get(key, "length" if key.startswith("approach") else None)
        if kind and key not in summary:
            faults.append(f"summary: no {key}")
        elif kind:
            pieces.setdefault(kind, []).append((value, float(summary[key]), f"summary {key}"))
    for kind, values in pieces.items():
        ours, told = np.array([v[0] for v in values]), np.array([v[1] for v in values])
        scale = abs(ours).max() or 1.0
        difference = abs(ours - told) / scale
        difference[~np.isfinite(difference)] = np.inf
        k = int(difference.argmax())
        worst[kind] = (difference[k], values[k][2])
    return worst, faults


def tightened(path, place):
    """The deck, or where it can yield a copy that iterates to rounding, with copies of the files that it includes."""
    text = path.read_text(encoding="latin-1")
    if "MATS1" not in text:
        return path
    lines = [line for line in text.splitlines() if line.replace(",", " ").split()[:2] not in (["PARAM", "TOL"], ["PARAM", "MAXIT"])]
    begin = next((k for k, line in enumerate(lines) if line.startswith("BEGIN BULK")), -1)
    lines[begin + 1:begin + 1] = ["PARAM,TOL,1.E-12", "PARAM,MAXIT,2000"]
    for name in re.findall(r"(?im)^INCLUDE\s+['\"]([^'\"/]+)['\"]", text):
        shutil.copy(path.parent / name, place)
    copy = pathlib.Path(place) / path.name
    copy.write_text("\n".join(lines) + "\n", encoding="latin-1")
    return copy


def differs(path, place, case, found, tolerance):
    """Do the two differ in a load case? Says by how much."""
    name = f"{path}" + (f" SUBCASE {case}" if case is not None else "")
    if found is None:
        answered = case is not None and ["valid"] == [row["value"] for row in read(place / f"{path.stem}.summary.csv", case) if row["key"] == "status"]
        print(f"{name}: " + ("answered there, not here" if answered else "both refuse"))
        return answered
    worst, faults = compare(found, place, path.stem, case)
    wrong = [f"{kind} {value:.1e} at {where}" for kind, (value, where) in worst.items() if not value <= tolerance]
    print(f"{name}: " + ("; ".join(faults[:3] + wrong) if faults or wrong else
                         ", ".join(f"{kind} {value:.0e}" for kind, (value, _) in worst.items())))
    return bool(faults or wrong)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("decks", nargs="+", type=pathlib.Path)
    parser.add_argument("--tolerance", type=float, default=1e-8)
    options = parser.parse_args()
    bad = 0
    for path in options.decks:
        with tempfile.TemporaryDirectory() as place:
            run = subprocess.run([options.program.resolve(), tightened(path, place), "-o", place, "--tables", "all"], capture_output=True,
                                 text=True)
            try:
                cases = list(solve(path))
            except DeckError as error:
                cases = [(None, None, error)]
            expected = max(0 if found else 1 if isinstance(problem, NoEquilibrium) else 2 for _, found, problem in cases)
            if run.returncode != expected:
                print(f"{path}: exit status {run.returncode}, expected {expected}\n{run.stdout}{run.stderr}")
                bad += 1
                continue
            for case, found, _ in cases:
                bad += differs(path, pathlib.Path(place), case, found, options.tolerance)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
