#!/usr/bin/env python3
"""How often is the true error of the largest shear traction within its estimate? Two cylinders pressed and pushed (Cattaneo, Mindlin), by hand: a minute."""
import argparse
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
from scenes import friction  # noqa: E402

PROGRAM = os.environ.get("EPCONT_PROGRAM", str(pathlib.Path(__file__).resolve().parents[2] / "build/release/epcont"))
#: Edges on a half-width, and pushes over mu P. The first ones fitted the part of the limit that is unknown; the others are a test.
FITTED = (4, 5, 6, 7, 8, 9, 11, 13, 16, 20, 24, 32), ((0.05,), (0.1,), (0.2,), (0.3,), (0.4,), (0.5,), (0.6,), (0.7,), (0.8,), (0.9,), (0.95,),
                                                      (0.6, -0.2), (0.6, -0.55), (0.9, 0.3), (0.9, 0.0), (0.8, 0.6))
TESTED = (10, 14, 17, 22, 28), ((0.15,), (0.25,), (0.35,), (0.45,), (0.55,), (0.65,), (0.75,), (0.85,), (0.98,), (0.7, 0.1), (0.5, -0.5), (0.3, -0.1), (0.95, -0.95))


def errors(n, pushes, lines):
    """True error and estimate (None: unknown), over the true value."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "deck.dat"
        path.write_text(friction.cattaneo(n=n, pushes=pushes, lines=lines).text(), encoding="ascii")
        subprocess.run([PROGRAM, "--quiet", path.name], cwd=folder, check=True)
        rows = csv.DictReader(path.with_suffix(".summary.csv").read_text().splitlines())
        found = {row["key"]: row["value"] for row in rows if row["subcase"] == str(len(pushes) + 1)}
    true = friction.largest_traction(pushes)
    estimate = found["mesh_error_shear_zone_1"]
    return abs(float(found["max_shear"]) - true) / true, float(estimate) / true if estimate else None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-v", action="store_true", help="print each figure")
    options = parser.parse_args()
    for name, (meshes, loads) in (("fitted", FITTED), ("tested", TESTED)):
        for kind, chosen in (("once", [p for p in loads if len(p) == 1]), ("back", [p for p in loads if len(p) > 1])):
            found = [(lines, n, pushes, *errors(n, pushes, lines)) for lines in (False, True) for n in meshes for pushes in chosen]
            if options.v:
                print(*found, sep="\n")
            known = [(true, estimate) for *_, true, estimate in found if estimate is not None]
            ratios = sorted(estimate / true for true, estimate in known)
            print(f"{name}, pushed {kind}: {len(found)} figures, {len(found) - len(known)} unknown, {sum(r >= 1 for r in ratios) / len(ratios):.1%} within the estimate; "
                  f"estimate over true error: median {statistics.median(ratios):.2f}, least {ratios[0]:.2f}, 90 % below {ratios[int(0.9 * len(ratios))]:.2f}", flush=True)


if __name__ == "__main__":
    main()
