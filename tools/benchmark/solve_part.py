"""Part 4: numbering to displacements, by epcont's own stages and by the best libraries alone (bare/), on the same systems.

Part 3 takes the growth of time and memory, and the time of the smallest deck, from here.
"""
import pathlib
import statistics
import subprocess
import sys

from cylinders import mesh_of
from process import ONE_THREAD, peak, settled, timed
from scenes import cylinders

#: Seconds printed by bench_ours and bench_bare.
OURS = ("equations", "ordering", "factor", "flexibility", "load_gap", "contact", "displacements", "all", "more", "assembly",
        "condition")
BARE = ("ordering", "factor", "flexibility", "contact", "displacements", "all", "more")
#: Methods slower than the fastest by this factor get no further turns.
NEAR = 1.3
#: Shorter runs [s] get more turns: the processor's speed varies between them.
SHORT = 0.01
#: Larger relative differences of the libraries' displacements mean that the systems differ.
SAME = 1e-8


def output(*command):
    run = subprocess.run([str(word) for word in command], env=ONE_THREAD, capture_output=True, text=True, check=False)
    if run.returncode:
        sys.exit(f"{pathlib.Path(command[0]).name}: exit status {run.returncode}\n{run.stderr}")
    return run.stdout


def deck_of(place, nodes):
    mesh = mesh_of(nodes)
    path = place / f"solve{nodes}.dat"
    path.write_text(cylinders.hertz(mesh).text(), encoding="ascii")
    return path


def ours(release, deck, *system):
    return dict(zip(OURS, map(float, output(release / "bench_ours", deck, *system).split())))


def bare(release, system, methods=()):
    """Times of each method; all methods if none is named."""
    found = {}
    for line in output(release / "bench_bare", system, *methods).splitlines():
        name, *seconds, error = line.split("; ")
        if not float(error) < SAME:
            sys.exit(f"bench_bare: {name}: displacements off by {error}")
        found[name] = dict(zip(BARE, map(float, seconds)))
    return found


def near(found, what):
    return {name for name, seconds in found.items() if seconds[what] <= NEAR * min(other[what] for other in found.values())}


def middle(turns):
    return {key: statistics.median(turn[key] for turn in turns) for key in turns[0]}


def one(release, place, nodes, repeats, say):
    """Run both on one mesh: all methods once, then epcont and the fastest in turn."""
    deck, system = deck_of(place, nodes), place / "system"
    ours(release, deck, system)
    found = bare(release, system)
    chosen = [name for name in found if name in near(found, "all") | near(found, "more")]
    many = repeats if min(seconds["all"] for seconds in found.values()) > SHORT else 3 * repeats
    turns = [(ours(release, deck), bare(release, system, chosen)) for _ in range(many)]
    mine, theirs = middle([turn[0] for turn in turns]), {name: middle([turn[1][name] for turn in turns]) for name in chosen}
    row = {"equations": int(mine["equations"]), "ours": mine}
    for what in ("all", "more"):
        best = min(chosen, key=lambda name: theirs[name][what])
        row[what] = {"name": best, **theirs[best], "ratio": statistics.median(a[what] / b[best][what] for a, b in turns)}
        say(f"{row['equations']} equations, {what}: epcont {1e3 * mine[what]:.3g} ms, {best} {1e3 * theirs[best][what]:.3g} ms, "
            f"ratio {row[what]['ratio']:.2f}")
    system.unlink()
    return row


def growth(release, place, nodes, repeats, say):
    """Measure one mesh: equations, seconds of the whole process and of the solver, peak memory in MB."""
    deck, cpu, wall, part = deck_of(place, nodes), [], [], []
    command = [str(release / "epcont"), deck.name]
    _, memory, _, _ = peak(command, place)
    for _ in range(repeats):
        status, used, taken, out = settled(command, place)
        if status:
            sys.exit(f"epcont: exit status {status}\n{out}")
        cpu.append(used)
        wall.append(taken)
        part.append(ours(release, deck))
    row = {"equations": int(part[0]["equations"]), "cpu": statistics.median(cpu), "wall": statistics.median(wall),
           "solve": middle(part)["all"], "memory": memory}
    say(f"{row['equations']} equations: {row['cpu']:.3f} s, solve part {row['solve']:.3f} s, {row['memory']:.0f} MB")
    return row


def smallest(release, deck, place, repeats):
    """Medians in ms: an empty process, epcont on the deck, and the difference."""
    (place / deck.name).write_text(deck.read_text(encoding="ascii"), encoding="ascii")
    turns = [[1e3 * timed(command, place)[1] for command in ([str(release / "bench_empty")], [str(release / "epcont"), deck.name])]
             for _ in range(repeats)]
    empty, full = (statistics.median(turn[k] for turn in turns) for k in (0, 1))
    return {"deck": deck.name, "empty": empty, "cpu": full, "difference": statistics.median(b - a for a, b in turns), "runs": repeats}
