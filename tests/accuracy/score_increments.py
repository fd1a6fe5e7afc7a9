#!/usr/bin/env python3
"""Compare true errors of flow theory in increments with the errors that the listing states, on fixed meshes.

    tests/accuracy/score_increments.py PROGRAM FIRST COUNT [--decks] [-v]

The models are random indenters (chance.py) with the seeds FIRST, FIRST + 1, ...: COUNT in plane strain or plane stress, COUNT axisymmetric. --decks
adds decks of `input` that yield. Hardening is isotropic or kinematic. Each is loaded and then unloaded to a thousandth, both in N increments. True values
are those of 320 increments. The figures are largest pressure, half-width, approach, and the largest stress component of an element that differs
most; p_max and half-width under full load only. Figures with a true error below 1e-4 do not count. A table gives for each figure the fraction that
the stated error covers, and the median of stated over true errors; exit status 1 below 90 %.
"""
import argparse
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

import chance
from score import Failed
from score_by_chance import scale_of

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import tables  # noqa: E402

INPUT = pathlib.Path(__file__).resolve().parents[2] / "input"
DECKS = ("hertz/hertz330", "hertz/hertz44", "insert_joint/insert_joint", "tube/tube16", "tube/tube_hardening", "cook/cook", "joint_lines/joint_lines",
         "punch_limit/punch_limit_ctria6")
COVERED, MANY, TINY = 0.90, 320, 1.0e-4
#: Numbers of increments of each leg; each model takes some of them.
NUMBERS, EACH = (1, 2, 3, 4, 5, 6, 8, 10, 14, 20), 4
#: Error of the increments by figure.
FIGURES = {"p_max": "largest pressure", "half_width": "half-width", "approach": "approach", "stress": "stresses"}


def history_of(text, many, kinematic):
    """The deck, loaded and unloaded in so many increments each."""
    head, _, bulk = text.partition("BEGIN BULK\n")
    lines = [line for line in bulk.splitlines() if not line.startswith(("PARAM   METHOD", "PARAM   TOL", "PARAM,METHOD", "PARAM,TOL"))]
    if kinematic:   # HR, the second field of the second line of a MATS1 in large field
        lines = [line[:24] + "2".ljust(16) + line[40:] if before.startswith("MATS1*") else line for before, line in zip(["", *lines], lines)]
    head = "\n".join(line for line in head.splitlines() if not line.startswith(("LOAD", "SUBCASE", "NLPARM")))
    cases = "".join(f"\nSUBCASE {case}\nLOAD = {case + 900}\nNLPARM = 900" for case in (1, 2))
    return f"{head}{cases}\nBEGIN BULK\nNLPARM,900,{many}\nLOAD,901,1.,1.,1\nLOAD,902,1.,.001,1\n" + "\n".join(lines) + "\n"


def solve(program, text):
    """Of each figure (leg, name): value or values, scale and stated error (None: not stated)."""
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / "deck.dat"
        path.write_text(text, encoding="ascii")
        ended = subprocess.run([program, "--tables", "all", path.name], cwd=place, capture_output=True, text=True, timeout=900)
        if ended.returncode or not path.with_suffix(".increments.csv").exists():   # or nothing can yield
            raise Failed(f"exit status {ended.returncode}: {ended.stdout[-300:]}{ended.stderr[:300]}")
        summary, increments, elements = (tables.rows(path.with_suffix(f".{name}.csv")) for name in ("summary", "increments", "elements"))
    figures = {}
    for leg in "12":
        said = {row["key"]: row["value"] for row in summary if row["subcase"] == leg}
        last = [row for row in increments if row["subcase"] == leg][-1]
        stated = {key.removeprefix("increment_error_"): float(value) for key, value in said.items() if key.startswith("increment_error_") and value}
        values = {"p_max": last["max_pressure"], "half_width": last["half_width"]} if leg == "1" else {}
        for key, value in values.items():
            if value:
                figures[leg, key] = [float(value)], float(value), stated.get({"p_max": "max_pressure"}.get(key, key))
        for key in (key for key in said if key.startswith("approach_")):
            full = figures.get(("1", key), (0, abs(float(said[key])), 0))[1]
            figures[leg, key] = [float(said[key])], full, stated.get(key)
        stress = [float(row[s]) for row in elements if row["subcase"] == leg for s in ("sx", "sy", "sz", "txy")]
        figures[leg, "stress"] = stress, max(map(abs, stress)), stated.get("stress")
    return figures


def models(program, first, count, decks):
    """Name, text of the deck, kinematic hardening."""
    for deck in DECKS if decks else ():
        yield deck, (INPUT / f"{deck}.dat").read_text(encoding="ascii"), False
    for seed in range(first, first + count):
        for rings in (False, True):
            scene, chosen = chance.draw(seed, rings, True), random.Random(f"increments {seed} {rings}")
            element = chosen.choice(chance.RINGS if rings else chance.PLANE)
            try:
                scale_of(program, scene)
            except (Failed, subprocess.TimeoutExpired) as fault:
                print(f"{seed} {rings} {scene.family}: {str(fault)[:200]}", file=sys.stderr)
                continue
            mesh = chance.fineness(chosen)
            mesh.pairs = min(mesh.pairs, 12.0)
            kinematic = scene.hardening > 0.0 and chosen.random() < 0.5
            yield (f"{seed} {scene.family} {element}, H {scene.hardening:.3f}{', kinematic' if kinematic else ''}",
                   chance.make(scene, element, mesh).text(), kinematic)


def judge(program, name, text, kinematic, aloud):
    """Figure, true and stated error of each figure, relative."""
    numbers = sorted(random.Random(name).sample(NUMBERS, EACH))
    truth = solve(program, history_of(text, MANY, kinematic))
    for many in numbers:
        for (leg, key), (values, scale, stated) in solve(program, history_of(text, many, kinematic)).items():
            if (leg, key) not in truth or scale == 0.0:
                continue
            error = max(abs(a - b) for a, b in zip(values, truth[leg, key][0])) / scale
            if aloud:
                print(f"{name:60} N {many:2} leg {leg} {key:12} off {error:.1e}  " + ("not stated" if stated is None else f"stated {stated / scale:.1e}  "
                                                                                      f"ratio {stated / scale / max(error, 1e-12):.2f}"), flush=True)
            if error > TINY:
                yield many, leg, key.partition("_")[0] if key.startswith("approach") else key, error, None if stated is None else stated / scale


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda path: pathlib.Path(path).resolve())
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--decks", action="store_true", help="decks of `input`, too")
    parser.add_argument("-v", action="store_true", dest="aloud")
    options = parser.parse_args()
    rows, faults, seen = [], [], 0
    for model in models(options.program, options.first, options.count, options.decks):
        try:
            rows += judge(options.program, *model, options.aloud)
            seen += 1
        except (Failed, subprocess.TimeoutExpired) as fault:
            print(f"{model[0]}: {str(fault)[:300]}", file=sys.stderr)
    print(f"{seen} models")
    for leg, which in ("1", "loaded"), ("2", "unloaded"):
        for key, word in FIGURES.items():
            mine = [row for row in rows if row[1:3] == (leg, key)]
            given = [(stated / error) for _, _, _, error, stated in mine if stated is not None]
            if not given:
                continue
            covered = sum(ratio >= 1.0 for ratio in given) / len(given)
            print(f"{which:9}{word:17} {len(given):4} of {len(mine):4}  covered {covered:6.1%}  median stated/true {statistics.median(given):5.1f}  "
                  f"needs {1.0 / max(sorted(given)[int(0.1 * len(given))], 1e-9):5.2f}  median stated {statistics.median(row[4] for row in mine if row[4] is not None):.2%}")
            if covered < COVERED:
                faults.append(f"{which} {word}: {covered:.1%}")
    for many in NUMBERS:
        given = [stated / error for number, _, _, error, stated in rows if number == many and stated is not None]
        if given:
            print(f"{many:3} increments: {len(given):4} figures  covered {sum(r >= 1.0 for r in given) / len(given):6.1%}  median {statistics.median(given):5.1f}")
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
