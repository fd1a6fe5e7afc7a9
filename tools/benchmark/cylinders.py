"""Part 1: two cylinders, elastic and elastoplastic, solved by whole programs."""
import importlib.util
import json
import math
import statistics
import sys

import calculix
import tables
from process import peak, settled, timed
from report import PROGRAMS, SCIKIT_FEM
from scenes import cylinders

B, P, E, NU, R = 0.0239, 10.0, 20400.0, 0.29, 1.0
HALF_WIDTH = math.sqrt(4 * P * (R / 2) * 2 * (1 - NU * NU) / (math.pi * E))
P_MAX = {False: 2 * P / (math.pi * HALF_WIDTH), True: 198.4}
APPROACH = {False: P * (1 - NU * NU) / (math.pi * E) * (2 * math.log(4 * R / HALF_WIDTH) - 1), True: 0.001419}
#: A run is valid if it reaches full load and these values agree with epcont's: flow theory has 4 % less pressure.
APPROACH_WITHIN, P_MAX_WITHIN = 0.01, {False: 0.01, True: 0.06}

#: Seconds. Short runs are repeated; if all are short there are three times as many turns; if one is long, one turn.
SHORT, LONG = 5.0, 60.0
#: Above these nodes elastoplastic runs of CalculiX take minutes: only its settings that are fastest on smaller meshes run.
LARGE = 20000

#: Variants with scikit-fem: the usual way to write contact with it, and the fastest that its parts allow, with other factorizations;
#: CHOLMOD if it is installed.
KINDS = ("condense", "splu", "cholmod") if importlib.util.find_spec("sksparse") else ("condense", "splu")


def mesh_of(wanted):
    """Deck of `tools/decks hertz N`, also for larger N."""
    if wanted <= 12000:
        return cylinders.disc_of(R, B, wanted)
    across = 30.0
    for _ in range(6):
        mesh = cylinders.quarter_disc(R, B, across)
        across = round(across * math.sqrt(wanted / len(mesh.point)), 1)
    return mesh


def pressures(mesh, touch, force):
    """Nodal forces over the half edges beside each node."""
    side = [math.dist(mesh.point[a], mesh.point[b]) for a, b in zip(touch, touch[1:])]
    return [f / ((side[i - 1] if i else 0.0) / 2 + side[i] / 2) for i, f in enumerate(force[:-1])]


class Program:
    """A program and a setting; `command` in a directory, `answer` as (p_max, approach), or None."""

    def __init__(self, name, setting, command, answer):
        self.name, self.setting, self.command, self.read = name, setting, command, answer
        self.cpu, self.wall, self.rest, self.memory, self.answer, self.note = [], [], [], math.nan, None, ""

    def scout(self, place):
        status, self.memory, self.first, self.out = peak(self.command, place)
        self.answer = self.read(place) if status == 0 else None
        if not self.answer:
            self.note = f"exit status {status}" if status else "no answer"

    def run(self, place):
        status, cpu, wall, self.out = (settled if self.first < SHORT else timed)(self.command, place)
        if status:
            sys.exit(f"{self.name}, {self.setting}: exit status {status}\n{self.out}")
        self.cpu.append(cpu)
        self.wall.append(wall)


def epcont(top, place, mesh, plastic):
    deck = cylinders.hertz(mesh, plastic)
    if plastic:
        deck.card("PARAM", "METHOD", "NEWTON")
    (place / "scene.dat").write_text(deck.text(), encoding="ascii")

    def answer(place):
        summary = tables.summary(place / "scene.summary.csv")
        return float(summary["max_pressure"]), -next(float(v) for key, v in summary.items() if key.startswith("approach"))

    return Program("epcont", "NEWTON, 1e-8" if plastic else "", [str(top / "build/release/epcont"), "scene.dat"], answer)


def ccx(place, mesh, touch, plastic, contact, solver, increment=1.0):
    setting = f"{'GAPUNI' if contact == 'gap' else 'NODE TO SURFACE'}, {solver}" + (f", first increment {increment:g}" if plastic else "")
    name = f"{contact}_{solver.replace(' ', '_').lower()}_{increment:g}".replace(".", "p")
    calculix.write(place / f"{name}.inp", mesh, touch, plastic, contact, solver, increment)

    def answer(place):
        found = calculix.answer(place / f"{name}.dat", touch, contact)
        return found and (max(pressures(mesh, touch, found[0])), -found[1])

    return Program("CalculiX", setting, ["ccx", name], answer)


def scikit_fem(top, mesh, touch, kind):
    def answer(place):
        found = json.loads((place / "stdout").read_text().splitlines()[-1])
        return max(pressures(mesh, touch, found["force"])), -found["approach"]

    return Program(SCIKIT_FEM[kind != "condense"], kind, [sys.executable, str(top / "tools/benchmark/scikit_fem.py"), "mesh.npz", kind], answer)


def sound(program, reference, plastic):
    if not program.answer:
        return False
    (p, d), (p0, d0) = program.answer, reference.answer
    if abs(p / p0 - 1) > P_MAX_WITHIN[plastic] or abs(d / d0 - 1) > APPROACH_WITHIN:
        program.note = "not sound"
        return False
    return True


def save_mesh(path, mesh, touch):
    import numpy as np  # imported here, so that the driving process stays small

    point = np.array(mesh.point)
    np.savez(path, point=point, element=np.array(list(calculix.counterclockwise(mesh))), axis=mesh.line["axis"],
             top=mesh.line["top"], touch=touch)


def one(top, place, wanted, plastic, repeats, say):
    """Run all programs on one mesh: all settings once, then epcont and the fastest valid setting of each program in turn."""
    place.mkdir()
    mesh = mesh_of(wanted)
    touch = cylinders.touching(mesh, (1.9 if plastic else 1.5) * B)
    ours = epcont(top, place, mesh, plastic)
    if plastic:  # of the first increments 1, 0.5, 0.25, 0.125, 0.1 and 0.05, 0.1 was fastest at 11 000 nodes
        settings = [("gap", s, i) for s in ("SPOOLES", "ITERATIVE CHOLESKY") for i in ((1.0, 0.1) if wanted < LARGE else (0.1,))]
        settings += [("pair", "SPOOLES", 1.0)] if wanted <= 3000 else []
    else:
        settings = [(c, s, 1.0) for c in ("gap", "pair") for s in ("SPOOLES", "ITERATIVE CHOLESKY")]
    others = [ccx(place, mesh, touch, plastic, *setting) for setting in settings]
    if not plastic:
        save_mesh(place / "mesh.npz", mesh, touch)
        others += [scikit_fem(top, mesh, touch, kind) for kind in KINDS]
    kind = "elastoplastic" if plastic else "elastic"
    for program in (ours, *others):
        program.scout(place)
        say(f"{len(mesh.point)} nodes, {kind}: {program.name} {program.setting}: {program.first:.3f} s, {program.memory:.0f} MB, "
            f"{program.answer} {program.note}")
    if not ours.answer:
        sys.exit(f"epcont: {ours.out}")
    # One run may mislead: settings near the fastest take turns too, and so does CalculiX's default, the direct solver.
    chosen = [ours]
    for name, among, near in (("CalculiX", "", 2.0), ("CalculiX", "SPOOLES", 1.0), *((name, "", 2.0) for name in SCIKIT_FEM)):
        found = [p for p in others if p.name == name and among in p.setting and sound(p, ours, plastic)]
        limit = near * min((p.first for p in found), default=0.0)
        chosen += [p for p in found if p.first <= limit and p not in chosen]
    longest = max(p.first for p in chosen)
    for _ in range(3 * repeats if longest < SHORT else repeats if longest < LONG else 1):
        for program in chosen:
            program.run(place)
            if program.name in SCIKIT_FEM:
                program.rest.append(json.loads(program.out.splitlines()[-1])["rest"])
    best = {name: min((p for p in chosen if p.name == name), key=lambda p: statistics.median(p.cpu))
            for name in PROGRAMS if any(p.name == name for p in chosen)}
    return [row(program, ours, mesh, plastic, program in best.values()) for program in (ours, *others)]


def row(program, ours, mesh, plastic, best):
    """Table rows of a program; ratios are medians over the turns."""
    repeated = bool(program.cpu)
    cpu, wall = (program.cpu, program.wall) if repeated else ([program.first], [])
    p, d = program.answer or (math.nan, math.nan)
    return {"nodes": len(mesh.point), "kind": "elastoplastic" if plastic else "elastic", "program": program.name, "setting": program.setting,
            "runs": len(cpu), "cpu": statistics.median(cpu), "wall": statistics.median(wall) if wall else None, "memory": program.memory,
            "p_max": p, "approach": d, "p_error": p / P_MAX[plastic] - 1, "d_error": d / APPROACH[plastic] - 1,
            "cpu_ratio": statistics.median(a / b for a, b in zip(cpu, ours.cpu)),
            "wall_ratio": statistics.median(a / b for a, b in zip(wall, ours.wall)) if wall else None,
            "memory_ratio": program.memory / ours.memory, "best": best, "note": program.note, "rest": statistics.median(program.rest) if program.rest else None}
