#!/usr/bin/env python3
"""Mesh the contact patch test by Gmsh, in each of its three field formats, and solve it.

    . tools/venv && python tests/independent/write_gmsh.py

A mesh file of Gmsh (GRID, CBAR, CTRIA3, ENDDATA; no BEGIN BULK) is included, as the last card before ENDDATA, in a
deck with everything else. Pressure 10 at every pair, whatever the mesh and the digits of its coordinates.

In large field Gmsh 4.13 writes coordinates by %.9G: an integer has no decimal point (`3`, `0`). epcont accepts that in
the coordinates of a large-field GRID, and nowhere else.
"""
import pathlib
import sys

import gmsh

from solve import solve

CASES = pathlib.Path(__file__).resolve().parent / "cases"
FORMATS = {0: "free", 1: "small", 2: "large"}
LOWER, UPPER = 1, 2
EXACT = -10.0 * (0.84 * 2.0 / 1000.0 + 0.91 * 2.0 / 3000.0)


def draw():
    """Two rectangles 3 x 2, one on the other, not joined; (bottom left corner, line) tags of each."""
    gmsh.model.add("patch")
    lines = {}
    for body, bottom in ((LOWER, 0.0), (UPPER, 2.0)):
        p = [gmsh.model.geo.addPoint(x, bottom + y, 0.0, 0.55) for x, y in ((0, 0), (3, 0), (3, 2), (0, 2))]
        lines[body] = [gmsh.model.geo.addLine(p[i], p[(i + 1) % 4]) for i in range(4)]
        surface = gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines[body])])
        for line in (lines[body][0], lines[body][2]):
            gmsh.model.geo.mesh.setTransfiniteCurve(line, 7)
        gmsh.model.geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [surface], body)
        gmsh.model.addPhysicalGroup(1, lines[body], 10 + body)
    gmsh.model.mesh.generate(2)
    return lines


def nodes_on(line):
    """Node tags on a line, by x and y."""
    tags, places, _ = gmsh.model.mesh.getNodes(1, line, includeBoundary=True)
    return [tag for _, tag in sorted(((round(places[3 * i], 9), round(places[3 * i + 1], 9)), int(tag)) for i, tag in enumerate(tags))]


def case(lines, mesh):
    bottom, face = nodes_on(lines[LOWER][0]), nodes_on(lines[LOWER][2])
    under, top = nodes_on(lines[UPPER][0]), nodes_on(lines[UPPER][2])
    left = nodes_on(lines[LOWER][3]) + nodes_on(lines[UPPER][3])
    deck = ["$ contact patch test on a mesh by Gmsh; pressure 10, approach -0.0228666667", "SOL 106", "CEND", "SPC = 1", "LOAD = 1",
            "BEGIN BULK", "PARAM,PLANE,STRAIN", "PSHELL,1,1,2.0", "PSHELL,2,2,2.0", "MAT1,1,1000.,,0.4", "MAT1,2,3000.,,0.3"]
    deck += [f"SPC1,1,1,{node}" for node in left] + [f"SPC1,1,2,{node}" for node in bottom]
    deck.append(f"SUPORT,{top[-1]},2")
    # Consistent forces of the pressure: the nodes are evenly spaced.
    for i, node in enumerate(top):
        share = 0.5 if i in (0, len(top) - 1) else 1.0
        deck.append(f"FORCE,1,{node},0,{10.0 * 2.0 * 0.5 * share},0.0,-1.0,0.0")
    deck += ["CORD2R,1,0,0.0,0.0,0.0,0.0,0.0,1.0", ",0.0,1.0,0.0"]
    deck += [f"CGAP,{90001 + i},21,{a},{b},,,,1" for i, (a, b) in enumerate(zip(face, under))]
    return "\n".join(deck + ["PGAP,21,0.0", f"INCLUDE '{mesh}'", "ENDDATA", ""])


def main():
    bad = 0
    CASES.mkdir(exist_ok=True)
    gmsh.initialize(["gmsh", "-v", "0"])
    gmsh.option.setNumber("Mesh.SaveElementTagType", 2)
    lines = draw()
    for number, name in FORMATS.items():
        gmsh.option.setNumber("Mesh.BdfFieldFormat", number)
        mesh = CASES / f"gmsh_{name}.bdf"
        gmsh.write(str(mesh))
        deck = CASES / f"gmsh_{name}.dat"
        deck.write_text(case(lines, mesh.name), encoding="ascii")
        found, _ = solve(deck)
        summary = {row[0]: row[1] for row in found["summary"][1]}
        approach = next(value for key, value in summary.items() if key.startswith("approach"))
        good = abs(summary["max_pressure"] - 10.0) < 1e-6 and abs(approach - EXACT) < 1e-8
        print(f"{deck.name}: pressure {summary['max_pressure']:.10g}, approach {approach:.10g}{'' if good else ' WRONG'}")
        bad += not good
    gmsh.finalize()
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
