"""Part 5: many pairs, many bodies, many unknowns, solved by whole runs of epcont and of another program, in turns.

The required values of each model were set by the issue and the previous release: processor seconds and MB, and the ratios of both to
the other program (version 0.4.0).
"""
import pathlib
import re
import statistics
import sys
from dataclasses import dataclass

from cylinders import mesh_of
from process import peak, settled, timed
from scenes import cylinders, many

#: Seconds: shorter runs follow one that is not timed; longer ones have only one turn; a run that exceeds the wall-clock limit is stopped.
SHORT, LONG, MOST, MOST_QUICK = 5.0, 60.0, 1200, 60
#: Memory limit of a run [GB].
MEMORY = "20"


def cylinder(nodes, plastic=False, steps=1):
    deck = cylinders.hertz(mesh_of(nodes), plastic)
    if plastic:
        deck.card("PARAM", "METHOD", "NEWTON")
    if steps > 1:
        deck.card("PARAM", "NLOAD", steps)
    return deck


@dataclass
class Scene:
    """A deck, its required values, and whether `--quick` includes it."""
    name: str
    make: object
    seconds: float = None   # processor seconds
    memory: float = None    # MB
    part: float = None      # ratio of seconds to the previous release
    lean: float = None      # ratio of memory
    quick: bool = True
    threads: int = 1        # if above 1: the ratio is wall-clock time on one thread over that on this many, and `part` its lower limit
    cases: int = 1          # if above 1: load cases from 1/cases of the loads to all; the ratio is to a run with all loads only, and `part` its upper limit


SCENES = (
    Scene("1 500 pairs, 43 000 nodes, elastic", many.blocks, part=0.41),
    Scene("the same, yielding", lambda: many.blocks(yields=True), part=0.41),
    Scene("dovetail, 852 pairs, 23 500 nodes, elastic", many.dovetail, part=0.41),
    Scene("the same, yielding", lambda: many.dovetail(yields=True), part=0.41),
    Scene("10 000 pairs, 120 000 nodes", lambda: many.blocks(10000, 120000, load=19000.0), 60.0, 4000.0, 0.29, 0.31, quick=False),
    Scene("30 bodies, 42 000 nodes", many.stack, 0.35, part=0.32),
    Scene("1 000 bodies, 49 000 nodes", lambda: many.stack(1000, 6, 6), 5.0, 1500.0),
    Scene("968 000 unknowns, elastic", lambda: cylinder(484000), 6.5, 2000.0, 0.45, 0.4, quick=False),
    Scene("331 000 unknowns, yielding", lambda: cylinder(165000, True), 5.0, part=0.51, quick=False),
    Scene("strip 200:1, 2 800 pairs", many.strip, 3.0, part=0.34),
    Scene("200 load steps, 900 nodes", lambda: cylinder(900, True, 200), part=0.9),
    Scene("100 load cases of two cylinders, 11 000 nodes", lambda: cylinder(11000), part=4.0, cases=100),
    Scene("100 load cases of the dovetail", many.dovetail, part=8.0, cases=100),
    Scene("one body of 85 000 nodes on two threads", lambda: cylinder(85000), part=1.6, threads=2),
)


class Program:
    """A program with epcont's options; keeps the measured runs of a model."""

    def __init__(self, path, deck, threads=1):
        self.command, self.threads = [str(path), "--memory", MEMORY, deck.name], threads
        self.cpu, self.wall, self.memory, self.status, self.first = [], [], None, None, 0.0

    def scout(self, place, most):
        """Measure memory and run time; a run without an answer gets no turns."""
        self.status, self.memory, self.first, self.out = peak(["timeout", str(most), *self.command], place, self.threads)

    def run(self, place):
        status, cpu, wall, self.out = (settled if self.first < SHORT else timed)(self.command, place, self.threads)
        if status != self.status:
            sys.exit(f"{self.command[0]}: exit status {status}, before {self.status}\n{self.out}")
        self.cpu.append(cpu)
        self.wall.append(wall)

    def row(self):
        if not self.cpu:
            return {"status": self.status}
        return {"status": self.status, "cpu": statistics.median(self.cpu), "wall": statistics.median(self.wall), "memory": self.memory}


def of(one, other):
    """Median of the ratios over the turns."""
    return statistics.median(a / b for a, b in zip(one, other)) if one and other else None


def in_turns(programs, place, turns, most):
    """Run all once for their memory, then those with an answer in turns."""
    for program in programs:
        program.scout(place, most)
    able = [program for program in programs if program.status == 0]
    longest = max((program.first for program in able), default=0.0)
    for _ in range(turns if longest < LONG else 1):
        for program in able:
            program.run(place)


def size_of(program, place):
    """Nodes, pairs and bodies according to its plan."""
    _, _, _, plan = timed([*program.command, "--plan"], place)
    found = re.search(r"^  (\d+) nodes, \d+ elements, (\d+) pairs?; bodies: (\d+)", plan, re.MULTILINE)
    return dict(zip(("nodes", "pairs", "bodies"), map(int, found.groups())))


def in_cases(text, cases):
    """A deck with load cases from 1/cases of its loads to all of them."""
    head, bulk = text.split("BEGIN BULK\n")
    loads = re.search(r"^LOAD = (\d+)\n", head, re.MULTILINE)
    head = head.replace(loads.group(), "").replace("SOL 106", "SOL 101")
    numbers = range(1, cases + 1)
    return (head + "".join(f"SUBCASE {k}\n LOAD = {1000 + k}\n" for k in numbers) + "BEGIN BULK\n"
            + "".join(f"LOAD,{1000 + k},1.0,{k / cases!r},{loads.group(1)}\n" for k in numbers) + bulk)


def one(scene, place, program, other, turns, most, say):
    """Run a model with both programs: times, ratios, and required values."""
    place.mkdir()
    deck = place / "scene.dat"
    text = scene.make().text()
    deck.write_text(in_cases(text, scene.cases) if scene.cases > 1 else text, encoding="ascii")
    ours = Program(program, deck, scene.threads)
    beside = [Program(other, deck)] if other and scene.cases == 1 else []
    alone = [Program(program, deck)] if scene.threads > 1 else []
    if scene.cases > 1:
        case = place / "case.dat"
        case.write_text(text, encoding="ascii")
        alone = [Program(program, case)]
    in_turns([ours, *alone, *beside], place, turns, most)
    row = {"scene": scene.name, **size_of(ours, place), "runs": len(ours.cpu), "ours": ours.row(),
           "beside": beside[0].row() if beside else None, "threads": scene.threads, "cases": scene.cases,
           "part": of(alone[0].wall, ours.wall) if scene.threads > 1 else of(ours.cpu, (alone + beside)[0].cpu) if alone + beside else None,
           "lean": ours.memory / beside[0].memory if beside and beside[0].cpu and ours.cpu else None,
           "wanted": {"cpu": scene.seconds, "memory": scene.memory, "part": scene.part, "lean": scene.lean}}
    say(f"{scene.name}: {row['ours']}, beside {row['beside']}, ratio {row['part']}")
    for file in place.iterdir():
        file.unlink()
    return row


def scenes(place, program, other, turns, quick, say):
    chosen = [scene for scene in SCENES if scene.quick or not quick]
    return [one(scene, place / f"scene{k}", pathlib.Path(program), other, turns, MOST_QUICK if quick else MOST, say) for k, scene in enumerate(chosen)]
