#!/usr/bin/env python3
"""Check that error estimates have not changed.

    tests/accuracy/test_estimates.py PROGRAM [--accept]

A coarse model of each element type, elastic and yielded, and a bent column of tall elements, whose pressure is largest at its edge:
largest pressure, half-width and approach with their estimates, within 0.1 % of estimates.csv. score.py and score_by_chance.py judge the estimates for many models; a weight that
matters for a single element type, or beside others, hardly shows there. --accept writes the present values.
For crowned punches on plates with lines of different mesh size, the estimate for the largest pressure covers the true error and is at most three
times as large.
"""
import argparse
import csv
import pathlib
import sys

import chance
from score import solve

REFERENCE = pathlib.Path(__file__).with_name("estimates.csv")
COLUMNS = ["scene", "element", "beyond yield", "figure", "value", "estimate"]
TOLERANCE = 1e-3


def scene(rings, yields):
    """A cylinder or ball on a flat body, three times as stiff."""
    drawn = chance.Scene("round", rings, (1000.0, 3000.0), wide=(6.0, 6.0), deep=(8.0, 8.0))
    drawn.load = chance.nominal_load(drawn) * (2.0 if yields else 1.0)
    if yields:
        drawn.stress, drawn.hardening, drawn.width = 0.25 / chance.compliance(drawn) / drawn.radius, 0.05, 1.4
    return drawn


def column():
    """A block on another, with more pressure at one corner."""
    drawn = chance.Scene("stack", False, (1000.0, 3000.0), whole=True, wide=(1.0, 1.0), deep=(6.0, 6.0))
    drawn.load = chance.nominal_load(drawn)
    return drawn


def crowned():
    """(name, deck, largest pressure) of crowned punches on plates. The pressures are those of six-node elements, 34 across half of the contact."""
    drawn, mesh = chance.draw_crowned(5, False)
    yield "slave line 2.7 times finer, peak 9 % too high", chance.make(drawn, ("ctria3", "cquad4"), mesh), 5.5696
    drawn, mesh = chance.draw_crowned(16, False)
    yield "six-node slave line on a coarse master line, pressures oscillate", chance.make(drawn, ("ctria3", "ctria6"), mesh), 33.055
    drawn = chance.Scene("round", False, (210000.0, 70000.0), lines=True, radius=10.3, wide=(6.0, 12.0), deep=(8.0, 8.0), lasts=6.1)
    drawn.load = chance.nominal_load(drawn)
    mesh = chance.Fineness(pairs=1.5, growth=1.0, finer=2 / 3, shift=0.0, stretch=1.0, jitter=0.0, seed=0)
    yield "three pairs in contact, slave line 1.5 times finer", chance.make(drawn, ("ctria3", "cquad4"), mesh), 2810.8


def said(program):
    mesh = chance.Fineness(pairs=6.0, growth=1.4, finer=1.0, shift=0.0, stretch=1.0, jitter=0.0, seed=0)
    for element in chance.PLANE:
        for name, (value, estimate) in sorted(solve(program, chance.make(column(), element, mesh)).items()):
            if estimate is not None:
                yield ["column", element, "no", name, value, estimate]
    for element in (*chance.PLANE, *chance.RINGS):
        for yields in (False, True):
            figures = solve(program, chance.make(scene(element in chance.RINGS, yields), element, mesh))
            for name, (value, estimate) in sorted(figures.items()):
                yield ["round", element, "yes" if yields else "no", name, value, estimate]


def differs(one, other):
    return abs(one - other) > TOLERANCE * max(abs(one), abs(other))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--accept", action="store_true", help="these are right")
    options = parser.parse_args()
    rows = list(said(options.program))
    if options.accept:
        with REFERENCE.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([COLUMNS, *([*row[:4], *(f"{x:.6g}" for x in row[4:])] for row in rows)])
        return 0
    with REFERENCE.open(newline="") as file:
        known = list(csv.reader(file))[1:]
    faults = []
    for name, deck, true in crowned():
        value, estimate = solve(options.program, deck)["p1"]
        if not abs(value - true) <= estimate <= 3 * abs(value - true):
            faults.append(f"crowned punch, {name}: {value:.5g} +- {estimate:.3g}, true {true}")
    faults += [f"{' '.join(now[:4])}: {now[4]:.6g} and estimate {now[5]:.6g}, where there were {was[4]} and {was[5]}"
              for now, was in zip(rows, known) if now[:4] != was[:4] or any(differs(a, float(b)) for a, b in zip(now[4:], was[4:]))]
    if len(rows) != len(known):
        faults.append(f"{len(rows)} figures, where there were {len(known)}")
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
