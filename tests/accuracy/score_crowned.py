#!/usr/bin/env python3
"""Is the true error within the stated one if the slave line is finer than the master line?

    tests/accuracy/score_crowned.py PROGRAM FIRST COUNT [--known FILE] [--figures FILE]

Crowned punches on plates (chance.draw_crowned) of the seeds FIRST, FIRST + 1, ...; the slave line is 1.2 to 3 times finer than the master line.
Every element type of the punch is combined with every element type of the plate; every fifth model is axisymmetric. The true figures are those of
six-node elements, 34 across half of the contact on both sides (score_by_chance.find_truth). A table gives, for each figure, the errors that
the stated ones cover and those within a factor of 3; exit status 1 if less than 98 % of the largest pressures are covered. Run by hand.
"""
import argparse
import json
import pathlib
import subprocess
import sys

import chance
from score import Failed
from score_by_chance import FIGURES, NEAR, figures_of, find_truth, solve

COVERED = 0.98
PLANE, RINGS = ("ctria3", "ctria6", "cquad4", "cquad8"), ("ctrax3", "ctrax6")


def judge(program, seed, known):
    """Rows of the figures of one model with an estimate and a truth, for each pair of element types."""
    rings = seed % 5 == 4
    scene, mesh = chance.draw_crowned(seed, rings)
    if str(seed) not in known:
        known[str(seed)] = find_truth(program, scene)
    for key in ("width", "lasts", "stress"):
        setattr(scene, key, known[str(seed)][key])
    for elements in ((a, b) for a in (RINGS if rings else PLANE) for b in (RINGS if rings else PLANE)):
        try:
            figures = figures_of(*solve(program, chance.make(scene, elements, mesh)))
        except (Failed, subprocess.TimeoutExpired) as fault:
            print(f"{seed} {elements}: {fault}", file=sys.stderr)
            continue
        for key, (true, doubt) in known[str(seed)]["truth"].items():
            if key in figures:
                value, estimate, said = figures[key]
                yield {"seed": seed, "elements": elements, "figure": key, "value": value, "estimate": estimate, "said": said, "true": true, "doubt": doubt}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--known", type=pathlib.Path, help="file that keeps the true figures")
    parser.add_argument("--figures", type=pathlib.Path, help="file for each figure")
    options = parser.parse_args()
    known = json.loads(options.known.read_text(encoding="ascii")) if options.known and options.known.exists() else {}
    rows = []
    for seed in range(options.first, options.first + options.count):
        try:
            rows += judge(options.program, seed, known)
        except (Failed, subprocess.TimeoutExpired) as fault:
            print(f"{seed}: no truth: {fault}", file=sys.stderr)
        if options.known:
            options.known.write_text(json.dumps(known), encoding="ascii")
        if options.figures:
            options.figures.write_text(json.dumps(rows), encoding="ascii")
    covered = {}
    for figure, word in FIGURES.items():
        mine = [r for r in rows if r["figure"][0] == figure]
        given = [r for r in mine if r["estimate"] is not None]
        off = [max(abs(r["value"] - r["true"]) - r["doubt"], 1e-30) for r in given]
        if not given:
            continue
        covered[figure] = sum(e <= r["estimate"] for e, r in zip(off, given)) / len(given)
        near = sum(1 / NEAR <= r["estimate"] / e <= NEAR for e, r in zip(off, given)) / len(given)
        print(f"{word:17}{len(given):4} of {len(mine):4}  covered {covered[figure]:6.1%}  within a factor of 3 {near:6.1%}")
        for e, r in zip(off, given):
            if figure == "p" and e > r["estimate"]:
                print(f"  {r['seed']} {' on '.join(r['elements'])}: {r['value']:.5g} +- {r['estimate'] / r['value']:.1%}, true {r['true']:.5g}")
    return 0 if covered.get("p", 0.0) >= COVERED else 1


if __name__ == "__main__":
    sys.exit(main())
