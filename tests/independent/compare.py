#!/usr/bin/env python3
"""Run epcont and the independent program on decks and compare their tables.

    . tools/venv && python tests/independent/compare.py build/release/epcont input/*/*.dat
    python tests/independent/compare.py build/release/epcont --random 300 --seed 1 --tolerance 1e-7
    python tests/independent/compare.py build/release/epcont --random 100 --friction

Differences are relative to the largest value of the quantity: forces and reactions to the largest of them, gaps, displacements
and approaches to the largest displacement or initial gap, stresses to the largest stress, pressures and shear tractions to the largest pressure, friction
forces and their limits to the largest limit, slips to the largest slip, or a thousandth of the largest displacement.

Decks with yielding run with TOL 1E-12.

Exit status: 0 if all agree, 1 if some do not, 2 for a usage error.
"""
import argparse
import collections
import csv
import functools
import multiprocessing
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from deck import KINDS, DeckError
from deck import read as deck_of
from solve import NoEquilibrium, solve
from write_random import write

AGREE, REFUSED, COARSE, DIFFER = "agree", "refused by both", "too coarse for epcont", "differ"
#: Slips and the approach are relative to their largest value, but at least to this fraction of the largest displacement: both may be rounding.
LEAST_SCALE = 1e-3
KEPT = pathlib.Path(__file__).resolve().parents[2] / "build" / "random"


def read(path, case):
    """Rows of a load case; all rows if there is only one."""
    if not path.exists():
        return []
    with open(path, newline="", encoding="ascii") as file:
        return [row for row in csv.DictReader(file) if case is None or row["subcase"] == str(case)]


def compare(found, directory, stem, case, tolerance=1e-8):
    """(quantity, relative difference, position) of every number, and the faults of structure."""
    worst, faults, pieces = {}, [], {}
    summary = {row["key"]: row["value"] for row in read(directory / f"{stem}.summary.csv", case)}
    for name, kinds in [(name, kinds) for name, kinds in KINDS.items() if name in found]:
        header, rows = found[name]
        theirs = {row[header[0]]: row for row in read(directory / f"{stem}.{name}.csv", case)}
        if {str(row[0]) for row in rows} != set(theirs):
            faults.append(f"{name}: not the same {header[0]}s")
            continue
        for kind, columns in kinds.items():
            for column in [column for column in columns if column in header]:
                at = header.index(column)
                for row in rows:
                    told = theirs[str(row[0])][column]
                    if told and row[at] is not None:
                        pieces.setdefault(kind, []).append((row[at], float(told), f"{name} {row[0]} {column}"))
        if name == "contact":
            for row in rows:
                if theirs[str(row[0])]["status"] != row[11] and max(abs(row[8]), abs(row[10])) > 0:
                    faults.append(f"pair {row[0]}: {row[11]} here, {theirs[str(row[0])]['status']} there")
        if name == "friction":
            near = [tolerance * max(abs(row[k]) for row in rows) for k in (3, 5)]   # of limits and slips
            faults += [f"pair {row[0]}: {row[7]} here, {theirs[str(row[0])]['state']} there" for row in rows if theirs[str(row[0])]["state"] != row[7] and
                       (row[3] - abs(row[2]) > near[0] if row[7] == "sticks" else abs(row[5]) > near[1] if row[7] == "slips" else row[3])]
        if name == "increments":
            first = next((key for key in summary if key.startswith("approach")), None)   # that of the column
            if first:
                pieces["approach"] = [(row[header.index(first)], float(theirs[str(row[0])]["approach"]), f"increments {row[0]} approach") for row in rows]
            faults += [f"increment {row[0]}: {column} {row[header.index(column)]} here, {theirs[str(row[0])][column]} there"
                       for row in rows for column in header if column.startswith(("pairs_", "plastic_")) if str(row[header.index(column)]) != theirs[str(row[0])][column]]
        if name == "elements":
            off = [row[0] for row in rows if theirs[str(row[0])]["state"] != row[10]]
            faults += [f"element {element}: elastic in one, plastic in the other" for element in off]
    for key, value, _ in found["summary"][1]:
        kind = {"max_pressure": "pressure", "total_contact_force": "force", "total_friction_force": "friction", "max_equivalent_stress": "stress", "max_displacement": "length",
                "angle": "angle", "moment": "moment", "spring": "force", "approach": "angle" if key.endswith("_6") else "length"}
        kind = kind.get(key) or kind.get(key.partition("_")[0])
        if kind and key not in summary:
            faults.append(f"summary: no {key}")
        elif kind and summary[key]:   # empty: no boundary belongs to the pairs in contact
            pieces.setdefault(kind, []).append((value, float(summary[key]), f"summary {key}"))
    least = LEAST_SCALE * max(abs(v[0]) for v in pieces["length"])
    for kind, values in pieces.items():
        ours, told = np.array([v[0] for v in values]), np.array([v[1] for v in values])
        scale = max(abs(ours).max(), least * (kind in ("slip", "approach"))) or 1.0
        difference = abs(ours - told) / scale
        difference[~np.isfinite(difference)] = np.inf
        k = int(difference.argmax())
        worst[kind] = (difference[k], values[k][2])
    return worst, faults


def tightened(path, place):
    """The deck; if it can yield, a copy that iterates to rounding, with copies of its INCLUDE files."""
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


def verdict(path, place, said, case, found, tolerance):
    """Verdict of a load case: AGREE, REFUSED by both, COARSE (epcont finds penetration, which this program does not check), or DIFFER; and the
    difference, in words."""
    status = next((row["value"] for row in read(place / f"{path.stem}.summary.csv", case) if row["key"] == "status"), "no answer")
    if found is None or status != "valid":
        own = [line for line in said.splitlines() if case is None or f"SUBCASE {case}: " in line]
        if found and status == "not certified":
            for reason in ("bodies pass through each other", "carries a force beside the other body"):
                if any(reason in line for line in own):
                    return COARSE, f"not certified: {reason}"
        return (REFUSED, "both refuse") if (found is None) == (status != "valid") else (DIFFER, f"{status}, {'solved' if found else 'refused'} here\n{said}")
    worst, faults = compare(found, place, path.stem, case, tolerance)
    wrong = [f"{kind} {value:.1e} at {where}" for kind, (value, where) in worst.items() if not value <= tolerance]
    if faults or wrong:
        return DIFFER, "; ".join(faults[:3] + wrong)
    return AGREE, ", ".join(f"{kind} {value:.0e}" for kind, (value, _) in worst.items())


def pairs_of_lines(path, place):
    """Nodes of the program's pairs of lines, by load case."""
    deck, found = deck_of(path), {}
    own = {int(card[1]) for card in deck.of("CGAP")}
    for case in deck.by_case():
        found[case.number] = [int(row["pair"]) for row in read(place / f"{path.stem}.contact.csv", case.number) if int(row["pair"]) not in own] or None
    return found


def increments(path, place, case):
    """The parts of the loads at the ends of a load case's increments; those that did not converge are halved. None without an answer."""
    found = [float(row["load_factor"]) for row in read(place / f"{path.stem}.increments.csv", case)]
    return found if found and found[-1] == 1.0 else None


def run(program, path, tolerance):
    """Exit status of the program, that expected by the independent program, the program's messages, and (load case, verdict, words) of each."""
    with tempfile.TemporaryDirectory() as place:
        done = subprocess.run([program.resolve(), tightened(path, place), "-o", place, "--tables", "all"], capture_output=True, text=True)
        try:
            numbers = [case.number for case in deck_of(path).by_case()]
            cases = list(solve(path, pairs_of_lines(path, pathlib.Path(place)), {number: increments(path, pathlib.Path(place), number) for number in numbers}))
        except DeckError as error:
            cases = [(None, None, error)]
        rejected = any(isinstance(problem, DeckError) for _, _, problem in cases)
        if (done.returncode in (2, 3)) != rejected or done.returncode not in range(5):
            return [(None, DIFFER, f"exit status {done.returncode}\n{done.stdout}{done.stderr}")]
        verdicts = []
        for case, found, _ in cases:
            if f"SUBCASE {case}: it starts from the end" in done.stderr:
                verdicts.append((case, verdicts[-1][1], "not solved, like the load case before"))
            else:
                verdicts.append((case, *verdict(path, pathlib.Path(place), done.stderr, case, found, tolerance)))
        return verdicts


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("decks", nargs="*", type=pathlib.Path)
    parser.add_argument("--random", type=int, default=0, metavar="N", help="random models instead of decks; those that differ are kept in build/random")
    parser.add_argument("--histories", action="store_true", help="random sequences of load cases with flow theory")
    parser.add_argument("--friction", action="store_true", help="the same with friction, half of them elastic")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--tolerance", type=float, default=1e-8)
    parser.add_argument("-j", "--processes", type=int, default=1)
    options = parser.parse_args()
    if bool(options.decks) == bool(options.random):
        parser.error("either decks or --random")
    decks, counts = options.decks or write(KEPT, options.random, options.seed, options.histories, options.friction), collections.Counter()
    with multiprocessing.Pool(options.processes) as pool:
        for path, found in zip(decks, pool.imap(functools.partial(run, options.program, tolerance=options.tolerance), decks)):
            for case, word, words in found:
                print(f"{path}" + (f" SUBCASE {case}" if case is not None else "") + f": {words}", flush=True)
                counts[word] += 1
            if options.random and all(word != DIFFER for _, word, _ in found):
                path.unlink()
    print(f"{len(decks)} decks, {sum(counts.values())} load cases: " + ", ".join(f"{counts[word]} {word}" for word in (AGREE, REFUSED, COARSE, DIFFER)))
    return 1 if counts[DIFFER] else 0


if __name__ == "__main__":
    sys.exit(main())
