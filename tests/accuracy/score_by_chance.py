#!/usr/bin/env python3
"""Compare true errors with the estimates of the listing, for random models (chance.py).

    tests/accuracy/score_by_chance.py PROGRAM FIRST COUNT [--meshes N] [--known FILE] [--figures FILE]

Draws COUNT models from each of four groups (plane or axisymmetric, elastic or yielded), with the seeds FIRST, FIRST + 1, ... The true
values are those of two fine meshes of six-node elements, within their difference; a value with an uncertainty of more than
3 %, or a third of its error, is omitted. Each model is solved on coarse meshes of each element type. The program must call the largest pressures
under wedges and at sharp edges singular. A table gives for each element type, elastic and yielded, the number of
errors that the estimates cover, of those within a factor of 3, and the median of estimate over true error;
exit status 1 below 90 %. --known keeps the true values in a file for later runs; --figures writes each figure.
"""
import argparse
import dataclasses
import json
import pathlib
import random
import statistics
import subprocess
import sys

import chance
from score import Failed, run, tables

#: Smallest fraction of the figures of a group that estimates must cover.
COVERED = 0.90
#: Estimates within this factor of the true error count as near.
NEAR = 3.0
#: Largest error of a true value, relative to the error that it judges.
DOUBT = 0.3
#: A value with a larger relative difference between two fine meshes has no true value.
VAGUE = 0.03
#: Smaller relative errors do not count in the median of estimates over true errors.
TINY = 1.0e-4
FIGURES = {"p": "largest pressure", "b": "half-width", "q": "approach"}


def solve(program, deck):
    """The tables of the summary and of the zones, and the listing."""
    with run(program, deck) as path:
        return *tables(path), path.with_suffix(".lst").read_text(encoding="ascii")


def figures_of(summary, zones, listing):
    """(value, estimate, further remarks) of the figures of the zone with the largest force, and of the approaches."""
    zone = max(zones, key=lambda z: float(z["force"]))
    k = zone["zone"]
    said = next(line.split(f"zone {k}")[1].strip() for line in listing.splitlines() if f"mesh: largest pressure of zone {k}" in line)
    figures = {"p": (zone["max_pressure"], summary["mesh_error_pressure_zone_" + k], said),
               "b": (zone["half_width"], summary["mesh_error_half_width_zone_" + k], "")}
    for n, key in enumerate((key for key in summary if key.startswith("approach_")), 1):
        figures[f"q{n}"] = summary[key], summary["mesh_error_" + key], ""
    return {key: (float(value), float(estimate) if estimate else None, words) for key, (value, estimate, words) in figures.items() if value}


def scale_of(program, scene):
    """Find width and yield stress of a model, from coarse meshes."""
    element = "ctrax6" if scene.rings else "ctria6"
    pilot = chance.known(1)
    pilot.pairs = 10.0
    scene.width, scene.lasts = (1.0, 4.0 if scene.family == "layer" else 1.6)
    for _ in range(2 if scene.yielding else 1):
        summary, zones, _ = solve(program, chance.make(scene, element, pilot))
        zone = max(zones, key=lambda z: float(z["force"]))
        if scene.family not in ("sharp punch", "hole", "stack"):
            scene.width, scene.lasts = float(zone["half_width"] or zone["half_width_last_pair"]), 1.6
        if scene.yielding and not scene.stress:
            scene.stress = float(f"{float(summary['max_equivalent_stress']) / scene.yielding ** (1 / 3 if scene.rings else 1 / 2):.6g}")


def find_truth(program, scene):
    """Width and yield stress of a model; its true values, each with its uncertainty."""
    scale_of(program, scene)
    element = "ctrax6" if scene.rings else "ctria6"
    fine, less = (figures_of(*solve(program, chance.make(scene, element, chance.known(level)))) for level in (0, 1))
    truth = {key: (fine[key][0], abs(fine[key][0] - less[key][0]) / 2) for key in fine if key in less}
    truth = {key: (value, doubt) for key, (value, doubt) in truth.items() if doubt <= VAGUE * abs(value)}
    if scene.family in chance.SHARP:
        truth["p"] = None
    elif fine["p"][1] is None:   # too coarse, even the finest mesh
        truth.pop("p", None)
    if scene.family in ("sharp punch", "stack"):   # no half-width to find
        truth.pop("b", None)
    return {"width": scene.width, "lasts": scene.lasts, "stress": scene.stress, "truth": truth}


def scenes(program, first, count, known):
    """Models with their true values, each with its number in the group."""
    for seed in range(first, first + count):
        for rings in (False, True):
            for yielding in (False, True):
                scene, name = chance.draw(seed, rings, yielding), f"{seed} {rings} {yielding}"
                try:
                    if name not in known:
                        known[name] = find_truth(program, scene)
                except (Failed, subprocess.TimeoutExpired) as fault:
                    known[name] = {"fault": str(fault)}
                if "fault" in known[name]:
                    print(f"{name} {scene.family}: no truth: {known[name]['fault'][:200]}", file=sys.stderr)
                    continue
                for key in ("width", "lasts", "stress"):
                    setattr(scene, key, known[name][key])
                yield name, scene, known[name]["truth"]


def judge(program, name, scene, truth, meshes):
    """Each figure of a model on its coarse meshes."""
    for element in chance.RINGS if scene.rings else chance.PLANE:
        for turn in range(meshes):
            mesh = chance.fineness(random.Random(f"{name} {element} {turn}"))
            try:
                summary, zones, listing = solve(program, chance.make(scene, element, mesh))
            except (Failed, subprocess.TimeoutExpired) as fault:
                print(f"{name} {scene.family} {element} {mesh}: {fault}", file=sys.stderr)
                continue
            figures = figures_of(summary, zones, listing)
            state = "yielded" if int(summary["plastic_elements"]) else "elastic"
            for key, true in truth.items():
                if key not in figures:
                    continue
                value, estimate, said = figures[key]
                yield {"scene": name, "title": f"{name} {element} {turn}", "family": scene.family, "element": element, "state": state,
                       "figure": key, "value": value, "estimate": estimate, "said": said, "true": true and true[0], "doubt": true and true[1],
                       "mesh": dataclasses.asdict(mesh), "drawn": dataclasses.asdict(scene)}


def table(rows):
    """Coverage and median ratio for each element type, state and figure; faults."""
    faults = []
    for figure, word in FIGURES.items():
        for element in chance.PLANE + chance.RINGS:
            for state in ("elastic", "yielded"):
                mine = [r for r in rows if r["figure"][0] == figure and r["element"] == element and r["state"] == state]
                sharp = [r for r in mine if r["true"] is None]
                given = [r for r in mine if r["true"] is not None and r["estimate"] is not None]
                error = {id(r): abs(r["value"] - r["true"]) for r in given}
                judged = [r for r in given if r["doubt"] <= DOUBT * max(error[id(r)], r["estimate"])]
                if not judged:
                    continue
                covered = sum(error[id(r)] - r["doubt"] <= r["estimate"] for r in judged) / len(judged)
                over = [r["estimate"] / error[id(r)] for r in judged if error[id(r)] > TINY * abs(r["value"])]
                ten = sorted(error[id(r)] / max(r["estimate"], 1e-30) for r in judged)[int(0.9 * len(judged))]
                near = sum(1 / NEAR <= r["estimate"] / max(error[id(r)], 1e-30) <= NEAR for r in judged) / len(judged)
                size = statistics.median(r["estimate"] / abs(r["value"]) for r in judged)
                line = (f"{word:17}{element} {state}  {len(judged):4} of {len(mine) - len(sharp):4}  covered {covered:6.1%}  within a factor of 3 {near:6.1%}  "
                        f"median estimate/error {statistics.median(over) if over else 0.0:5.1f}  median estimate {size:6.2%}  needs {ten:5.2f}")
                if sharp:
                    line += f"   without limit {len(sharp)}, said so {sum(r['said'].startswith('singular') for r in sharp)}"
                print(line)
                if covered < COVERED:
                    faults.append(f"{word} {element} {state}: {covered:.1%}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("first", type=int)
    parser.add_argument("count", type=int)
    parser.add_argument("--meshes", type=int, default=2, help="meshes of each element type for each model (%(default)s)")
    parser.add_argument("--known", type=pathlib.Path)
    parser.add_argument("--figures", type=pathlib.Path)
    options = parser.parse_args()
    known = json.loads(options.known.read_text(encoding="ascii")) if options.known and options.known.exists() else {}
    rows = []
    for name, scene, truth in scenes(options.program, options.first, options.count, known):
        rows += judge(options.program, name, scene, truth, options.meshes)
        if options.known:
            options.known.write_text(json.dumps(known), encoding="ascii")
    if options.figures:
        options.figures.write_text(json.dumps(rows), encoding="ascii")
    faults = table(rows)
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
