#!/usr/bin/env python3
"""Compare true errors with the estimates of the listing, for curved contact on uneven meshes (curved.py).

    tests/accuracy/score_curved.py PROGRAM FIRST COUNT [-v]

Press fits of whole circles, elastic (Lame) and yielded, and cylinders and balls on blocks, with the seeds FIRST, FIRST + 1, ...
The weights in src/accuracy were chosen on the seeds 0 to 13. A table gives for each element type, elastic and yielded, the number of
errors that the estimates cover; exit status 1 below 90 %, reduced by twice the standard deviation of so few
figures. Two minutes for ten seeds; run by hand. -v prints each figure.
"""
import argparse
import math
import statistics
import sys

import curved
from score_by_chance import COVERED, Failed, figures_of, solve


def judge(program, first, count, aloud):
    """(model, element, state, figure) -> list of relative true error and estimate; number without an estimate."""
    found = {}
    for name, truth, make, element in curved.draw(first, count):
        try:
            summary, zones, listing = solve(program, make())
        except Failed as fault:
            print(f"{name}: {str(fault)[:200]}", file=sys.stderr)
            continue
        figures = figures_of(summary, zones, listing)
        state = "yielded" if int(summary["plastic_elements"]) else "elastic"
        for key, true in truth.items():
            value, estimate, said = figures.get({"q": "q1"}.get(key, key), (None, None, ""))
            rows = found.setdefault(("press fit" if name.startswith("press fit") else "on a block", element, state, key), [])
            if estimate is None:
                rows.append(None)
                continue
            error = max(0.0, abs(value - true) - curved.DOUBT[key] * abs(true)) / abs(value)
            rows.append((error, estimate / abs(value)))
            if aloud:
                print(f"{name} {key} off {value / true - 1:+.2%} estimate {estimate / abs(value):.2%} {said}")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("-v", action="store_true", dest="aloud")
    options = parser.parse_args()
    faults = []
    for which, rows in sorted(judge(options.program, options.first, options.count, options.aloud).items()):
        given = [row for row in rows if row]
        if not given:
            print(*which, f"0 of {len(rows)}")
            continue
        covered = sum(error <= estimate for error, estimate in given) / len(given)
        near = sum(max(error, 1e-12) / 3 <= estimate <= 3 * error for error, estimate in given) / len(given)
        print(f"{which[0]:11}{which[1]} {which[2]} {which[3]}  {len(given):3} of {len(rows):3}  covered {covered:6.1%}  within a factor of 3 "
              f"{near:6.1%}  median error {statistics.median(e for e, _ in given):7.3%}  median estimate {statistics.median(s for _, s in given):7.3%}")
        if covered < COVERED - 2 * math.sqrt(COVERED * (1 - COVERED) / len(given)):
            faults.append(f"{' '.join(which)}: {covered:.1%}")
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
