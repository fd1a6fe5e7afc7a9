"""Compare epcont's time, memory and errors with those of other programs, on this machine.

    tools/bench --quick     3 turns, plastic models up to 11 000 nodes: about half an hour
    tools/bench             up to 42 000 nodes, 5 turns: about an hour, mostly for CalculiX
    tools/bench --part 2    one part only; --quick --part 4: half a minute
    tools/bench --part 5 --beside OLD/epcont    large models, alternating with another epcont, for example the previous release

Part 1: two cylinders (`tools/decks hertz N`, CTRIA3), whole programs, compared with CalculiX and scikit-fem. Part 2: the dense
contact problem alone, compared with packages for quadratic programs. Part 3: rate of the factorization relative to dgemm, growth of
time and memory up to 170 000 unknowns, and the deck of 44 nodes compared with an empty program. Part 4: the solver from
numbering to displacements, stage by stage, compared with the best libraries alone. Part 5: many pairs, bodies and unknowns, growth to
2 000 000 unknowns; order, factor and solves compared with PARDISO and CHOLMOD, many pairs with CalculiX. Part 6: two cylinders loaded and
unloaded by flow theory, compared with CalculiX. Part 7: the dense contact problem with friction, compared with an augmented Lagrangian,
Siconos and Lemke's algorithm. Part 8: two cylinders pressed and pushed with friction, compared with CalculiX.
Everything uses one thread, except one model of part 5. The programs run in turns; times are medians, ratios are medians over the turns.
The results of each part are kept in build/benchmark/part*.json. If all parts exist, their tables go to
tools/benchmark/results.md and a picture to results.png, each with its own command and load; they are always printed.
"""
import json
import os
import pathlib
import platform
import re
import shlex
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parent.parent
sys.path.insert(0, str(HERE.parent))

import beside_calculix  # noqa: E402
import cylinders  # noqa: E402
import growth  # noqa: E402
import history  # noqa: E402
import large  # noqa: E402
import peers  # noqa: E402
import pushed  # noqa: E402
import report  # noqa: E402
import solve_part  # noqa: E402
from process import ONE_THREAD  # noqa: E402
from wording import parser_of, run  # noqa: E402

NODES, UNKNOWNS = (330, 1000, 3000, 11000, 42000), (50, 100, 200, 500, 1000, 2000)
#: For part 4 and growth: nodes of meshes, each with twice as many unknowns as the one before.
SOLVED, GROWING = (330, 930, 3080, 11100, 42500), (3080, 7600, 20200, 42500, 85000)
RELEASE = TOP / "build/release"
PARTS = (1, 2, 3, 4, 5, 6, 7, 8)
#: Pairs of part 7.
RUBBING = (50, 200, 500, 1000)


def say(text):
    print(text, file=sys.stderr, flush=True)


def output(*command, **more):
    return subprocess.run([str(word) for word in command], env=ONE_THREAD, capture_output=True, text=True, check=True, **more).stdout


def part1(place, sizes, turns, largest_plastic):
    kinds = [(n, plastic) for n in sizes for plastic in (False, True) if not plastic or n <= largest_plastic]
    return [row for n, plastic in kinds for row in cylinders.one(TOP, place / f"{n}{plastic}", n, plastic, turns, say)]


def dense(script, place, sizes, turns, limit):
    """Parts 2 and 7."""
    rows = []
    with subprocess.Popen([sys.executable, HERE / script, RELEASE / "bench_contact", place, str(turns), str(limit), *map(str, sizes)],
                          env=ONE_THREAD, stdout=subprocess.PIPE, text=True) as child:
        for line in child.stdout:
            rows.append(json.loads(line))
            say(line.strip())
    if child.returncode:
        sys.exit(f"{script}: exit status {child.returncode}")
    return rows


def part3(place, sizes, growing, turns):
    smallest = [solve_part.smallest(RELEASE, TOP / "input/hertz" / deck, place, 50) for deck in ("hertz44_elastic.dat", "hertz44.dat")]
    growth = [solve_part.growth(RELEASE, place, n, turns, say) for n in growing]
    return {"factor": factors(place, sizes, turns), "growth": growth, "smallest": smallest}


def factors(place, sizes, turns):
    """For the first body of each mesh: nodes, equations, half-bandwidth, seconds, operations, rate, fraction of dgemm's rate."""
    matrices, nodes = [], []
    for n in sizes:
        mesh = cylinders.mesh_of(n)
        deck = cylinders.cylinders.hertz(mesh).text().replace("BEGIN BULK\n", "BEGIN BULK\nPARAM,SOLVER,BAND\n")
        (place / "plan.dat").write_text(deck, encoding="ascii")
        body = re.search(r"^ +1 +\d+ +(\d+) +(\d+) ", output(RELEASE / "epcont", "--plan", place / "plan.dat"), re.MULTILINE)
        matrices += body.groups()
        nodes.append(len(mesh.point))
    lines = output(RELEASE / "bench_factor", turns, *matrices).splitlines()
    return [dict(zip(("equations", "width", "seconds", "operations", "rate", "part"), map(float, line.split())), nodes=n)
            for n, line in zip([None, *nodes], lines)]


def part4(place, sizes, turns):
    return [solve_part.one(RELEASE, place, n, turns, say) for n in sizes]


def part5(place, turns, options):
    """Parts named by `--only`; without it all."""
    program = RELEASE / "epcont"
    does = {"scenes": lambda: large.scenes(place, program, options.beside, turns, options.quick, say),
            "growth": lambda: growth.growth(place, program, turns, options.quick, say),
            "peers": lambda: peers.peers(RELEASE, place, turns, options.quick, say),
            "calculix": lambda: beside_calculix.beside_calculix(place, program, turns, options.quick, say)}
    before = json.loads(kept(5).read_text())["rows"] if options.only and kept(5).exists() else {}
    rows = {**before, **{what: does[what]() for what in options.only or does}}
    version = options.beside and output(options.beside, "--version").split()[-1]
    return {**rows, "beside": version or before.get("beside")}


def kept(part):
    """File with the results of a part."""
    return TOP / f"build/benchmark/part{part}.json"


def machine():
    try:
        model = re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.MULTILINE)[1]
    except (OSError, TypeError):
        model = platform.machine()
    version = re.search(r"Version (\S+)", subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout)[1]
    names = [line.split("==") for line in (HERE / "requirements.txt").read_text().split() if "==" in line]
    packages = ", ".join(f"{name} {number}" for name, number in names if name not in ("matplotlib",))
    return (f"{model}, {os.cpu_count()} processors. "
            f"CalculiX {version}, Python {platform.python_version()}, {packages}.")


def main():
    parser = parser_of(__doc__, "tools/bench")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--part", type=int, choices=PARTS)
    parser.add_argument("--turns", type=int)
    parser.add_argument("--nodes", type=int, nargs="+", help="mesh sizes of parts 1, 3, 4 and 6; part 8: 3000 or 11000")
    parser.add_argument("--beside", type=pathlib.Path, metavar="PROGRAM", help="for part 5: another epcont to compare with")
    parser.add_argument("--only", nargs="+", choices=("scenes", "growth", "peers", "calculix"), help="for part 5: only these tables; the others stay unchanged")
    options = parser.parse_args()
    if options.beside:
        options.beside = options.beside.resolve()
    turns = options.turns or (3 if options.quick else 5)
    sizes = options.nodes or NODES
    command = shlex.join(["tools/bench", *sys.argv[1:]])
    with tempfile.TemporaryDirectory() as directory:
        place = pathlib.Path(directory)
        solved, growing = (options.nodes or (all_sizes[:-1] if options.quick else all_sizes) for all_sizes in (SOLVED, GROWING))
        does = {1: lambda: part1(place, sizes, turns, NODES[-2] if options.quick else sizes[-1]),
                2: lambda: dense("contact.py", place, UNKNOWNS[:-1] if options.quick else UNKNOWNS, turns, 5 if options.quick else 20),
                3: lambda: part3(place, sizes, growing, turns),
                4: lambda: part4(place, solved, turns),
                5: lambda: part5(place, turns, options),
                6: lambda: history.history(place, RELEASE / "epcont", options.nodes or NODES[2:4], turns, say),
                7: lambda: dense("friction.py", place, RUBBING, turns, 3 if options.quick else 20),
                8: lambda: pushed.pushed(place, RELEASE / "epcont", options.nodes or list(pushed.ACROSS), turns, say)}
        for part in (options.part,) if options.part else (4, 3, 5, 1, 6, 8, 2, 7):
            load = f"load {os.getloadavg()[0]:.1f} at the start"
            about = {"command": command, "load": load, "version": output(RELEASE / "epcont", "--version").split()[-1]}
            kept(part).write_text(json.dumps({**about, "rows": does[part]()}), encoding="ascii")
    parts = {part: json.loads(kept(part).read_text()) for part in PARTS if kept(part).exists()}
    text = report.page(parts if len(parts) == len(PARTS) else {options.part: parts[options.part]}, machine())
    print(text)
    if len(parts) == len(PARTS):
        (HERE / "results.md").write_text(text + "\n", encoding="utf-8")
        report.draw({part: found["rows"] for part, found in parts.items()}, HERE / "results.png")


run(main)
