"""Part 6: two cylinders loaded and unloaded in increments of flow theory, beside CalculiX with the same mesh and increments."""
import math
import statistics

import calculix
import tables
from cylinders import B, cylinders, mesh_of, pressures
from process import peak, settled, timed

#: Increments of each leg, and the loads at the end of the legs over the full load.
INCREMENTS, LOADS = 20, (1.0, 0.001)
#: Allowed difference of p_max and approaches, relative to those under full load: errors of the increments and of the penalty.
WITHIN = 0.001
SOLVERS = ("SPOOLES", "ITERATIVE CHOLESKY")


def deck_of(mesh):
    deck = cylinders.hertz(mesh, plastic=True)
    deck.sequence(("LOADED", LOADS[0], INCREMENTS), ("UNLOADED", LOADS[1], INCREMENTS))
    return deck


def answer_of_epcont(path):
    """(p_max under full load, approach there, approach left), and the errors by the increments that epcont states of them."""
    one, two = ({row["key"]: row["value"] for row in tables.rows(path) if row["subcase"] == case} for case in "12")
    key, error = next(key for key in one if key.startswith("approach_")), "increment_error_"
    return ((float(one["max_pressure"]), -float(one[key]), -float(two[key])),
            tuple(float(of[error + what]) for of, what in ((one, "max_pressure"), (one, key), (two, key))))


def answer_of_calculix(path, mesh, touch):
    """The same figures; None if a leg did not reach its end."""
    loaded, unloaded = (calculix.answer(path, touch, "gap", time) for time in (1.0, 2.0))
    return loaded and unloaded and (max(pressures(mesh, touch, loaded[0])), -loaded[1], -unloaded[1])


def history(place, program, sizes, turns, say):
    """A row for each mesh: epcont and the fastest solver of CalculiX, in turns; and an elastic run of epcont."""
    rows = []
    for wanted in sizes:
        folder = place / f"history{wanted}"
        folder.mkdir()
        mesh = mesh_of(wanted)
        touch = cylinders.touching(mesh, 1.9 * B)
        (folder / "scene.dat").write_text(deck_of(mesh).text(), encoding="ascii")
        (folder / "elastic.dat").write_text(cylinders.hertz(mesh).text(), encoding="ascii")
        ours, elastic = ([str(program), f"{name}.dat"] for name in ("scene", "elastic"))
        _, memory, _, _ = peak(ours, folder)
        found, errors = answer_of_epcont(folder / "scene.summary.csv")
        tried = []
        for solver in SOLVERS:
            name = solver.lower().replace(" ", "_")
            calculix.write(folder / f"{name}.inp", mesh, touch, True, "gap", solver, 1.0 / INCREMENTS, LOADS)
            status, much, seconds, _ = peak(["ccx", name], folder)
            theirs = answer_of_calculix(folder / f"{name}.dat", mesh, touch)
            off = theirs and [abs(a - b) / c for a, b, c in zip(theirs, found, (found[0], found[1], found[1]))]
            say(f"{len(mesh.point)} nodes: CalculiX {solver}: exit status {status}, {seconds:.2f} s, {much:.0f} MB, {theirs}, epcont {found}, stated errors {errors}")
            if status == 0 and theirs and max(off) <= WITHIN:
                tried.append((seconds, much, solver, ["ccx", name], theirs))
        if not tried:
            raise SystemExit(f"part 6, {wanted} nodes: CalculiX has no answer within {WITHIN} of epcont's")
        _, much, solver, command, theirs = min(tried)
        turned = [(timed(command, folder)[1], settled(ours, folder)[1], settled(elastic, folder)[1]) for _ in range(turns)]
        median = [statistics.median(times) for times in zip(*turned)]
        rows.append({"nodes": len(mesh.point), "ours": median[1], "memory": memory, "ccx": median[0], "ccx_memory": much, "solver": solver,
                     "ratio": statistics.median(a / b for a, b, _ in turned), "elastic": median[2],
                     "increment": statistics.median(b / c for _, b, c in turned) / (INCREMENTS * len(LOADS)),
                     "found": found, "errors": errors, "theirs": theirs})
        say(f"{rows[-1]}")
    return rows
