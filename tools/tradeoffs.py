"""Time, memory and accuracy of each choice: mesh x element x method x tolerance x rule, on scenes with known answers.

    tools/tradeoff                  tools/tradeoff.md and tools/tradeoff.png
    tools/tradeoff --quick          coarse meshes and few choices: the same tables in a minute
    tools/tradeoff -o build/mine    build/mine.md, build/mine.png

Time: processor, user and system, of a whole process on one thread, reading and writing included; the least of three runs (one, where
it takes a second). Memory: its peak. True error: against the closed form, or what meshes many times as fine converge
to (tests/accuracy/cases.py); the worse of the largest pressures and of the approaches. Errors are the same on every run; times
are not, and runs whose times are within a few per cent of each other may change places.
"""
import collections
import itertools
import pathlib
import platform
import statistics
import sys
import tempfile
import time

TOP = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TOP / "tools/benchmark"), str(TOP / "tests/accuracy")]
import cases  # noqa: E402
from convergence import B, ELEMENTS, EPCONT, U_A, check_folder, inner_displacement, needed  # noqa: E402
from process import peak, timed  # noqa: E402
from report import short, table  # noqa: E402
from scenes import lines, plastic, quads  # noqa: E402
from score import figures_of  # noqa: E402
from wording import parser_of, run  # noqa: E402

METHODS, TOLERANCES = ("NEWTON", "SECANT", "MODSEC", "INISTR"), ("1.E-2", "1.E-4", "1.E-8")
RULES = "CONRY", "JOINED"
#: What everything is compared with. Scenes leave out what they have no use for.
BASE = {"METHOD": "NEWTON", "TOL": "1.E-8", "RULE": "CONRY"}
#: The way of the program of about 1980, whole.
ORIGINAL = {"ORIGINAL": "YES"}
#: A scene: its truth, what makes its deck, its meshes (element, parameter; the finest of each element last), whether it yields, touches.
Scene = collections.namedtuple("Scene", "name truth make meshes yields touches")
#: A run that ended well: errors and estimates are parts of the figure, the worst of their kind; None: no such figure, no estimate.
Run = collections.namedtuple("Run", "scene element size choice cpu memory values error_p error_q estimate_p estimate_q")


def cylinders_pressed(element, across, yields):
    return cases.cylinders_pressed(B / across, element=element, plastic=yields)


def scenes():
    meshes, discs = cases.meshes, cases.meshes(ctria3=(5, 10, 20, 32), cquad4=(4, 8, 16, 32), ctria6=(2, 4, 8, 12))
    return [
        Scene("two cylinders, elastic", {**cases.hertz(), "q1": cases.HERTZ}, lambda e, n: cylinders_pressed(e, n, False), discs, False, True),
        Scene("two cylinders, yielding", cases.PLASTIC, lambda e, n: cylinders_pressed(e, n, True),
              meshes(ctria3=(5, 10, 20), cquad4=(4, 8, 16), ctria6=(2, 4, 8)), True, True),
        Scene("pin in a lug", {"p1": cases.PERSSON[45.0]}, lambda e, n: quads.pin_in_lug(45.0, n, element=e),
              meshes(ctria3=(32, 64, 128), cquad4=(32, 64, 128), ctria6=(16, 32, 64)), False, True),
        Scene("tube beyond yield", {"u": U_A}, lambda e, n: plastic.tube_flat(0.16, "", n, e),
              meshes(ctria3=(5, 10, 20, 40), cquad4=(5, 10, 20, 40), ctria6=(3, 5, 10, 20)), True, False),
        Scene("insert joint", cases.JOINT, lambda _, fine: lines.joint_lines(fine=fine), meshes(ctria6=(0.5, 0.26, 0.15)), True, True)]


def choices(scene):
    """All that a scene has a use for, the base first; of methods other than NEWTON those by CONRY; and ORIGINAL."""
    of = {"METHOD": METHODS if scene.yields else (), "TOL": TOLERANCES[::-1] if scene.yields else (), "RULE": RULES if scene.touches else ()}
    names = [name for name in of if of[name]]
    every = [dict(zip(names, values)) for values in itertools.product(*(of[name] for name in names))]
    return [choice for choice in every if choice.get("METHOD", "NEWTON") == "NEWTON" or "RULE" not in apart(choice)] + [ORIGINAL]


def apart(choice):
    """The names in which a choice differs from the base."""
    return [name for name in choice if choice[name] != BASE.get(name)]


def solve(scene, element, size, deck, choice, place):
    """A Run, or the exit status of one that gave no answer."""
    path = place / "scene.dat"
    cards = [f"PARAM   {name:8}{value}" for name, value in choice.items()]
    path.write_text(deck.replace("ENDDATA", "\n".join([*cards, "ENDDATA"])), encoding="ascii")
    command = [str(EPCONT), str(path), "-o", str(place)] + ([] if scene.touches else ["--tables", "all"])
    status, memory, cpu, out = peak(command, place)
    if status in (1, 4):
        return status
    if status:
        sys.exit(f"{scene.name}, {words(choice)}: exit status {status}\n{out}")
    if cpu < 1.0:
        cpu = min(timed(command, place)[1] for _ in range(3))
    found = figures_of(path) if scene.touches else {"u": (inner_displacement(path), None)}
    error, estimate = {}, {}
    figures = [key for key in scene.truth if key[0] != "b"]
    for key in figures:
        value, said = found[key]
        kind = "p" if key[0] == "p" else "q"
        error[kind] = max(error.get(kind, 0.0), abs(value / scene.truth[key] - 1))
        if said is not None:
            estimate[kind] = max(estimate.get(kind, 0.0), said / abs(value))
    return Run(scene.name, element, size, choice, cpu, memory, {key: found[key][0] for key in figures}, error.get("p"), error.get("q"),
               estimate.get("p"), estimate.get("q"))


def worst(run):
    return max(run.error_p or 0.0, run.error_q or 0.0)


def runs_of(scene, quick):
    """All runs of a scene, and (element, size, choice, exit status) of those that gave no answer."""
    runs, failed = [], []
    sizes = [mesh for _, of in itertools.groupby(scene.meshes, lambda mesh: mesh[0]) for mesh in list(of)[:2 if quick else None]]
    with tempfile.TemporaryDirectory() as place:
        for element, size in sizes:
            deck = scene.make(element, size).text()
            for choice in choices(scene):
                if quick and len(apart(choice)) > 1:
                    continue
                run = solve(scene, element, size, deck, choice, pathlib.Path(place))
                if isinstance(run, Run):
                    runs.append(run)
                else:
                    failed.append((element, size, choice, run))
    return runs, failed


def front(runs, cost):
    """Runs that err by a tenth less, at least, than all that cost less; cheapest first. Of choices on one mesh that are within a tenth
    of each other in both, the one nearest to the base: noise does not choose."""
    chosen = []
    for run in sorted(runs, key=lambda run: (getattr(run, cost), worst(run))):
        if not chosen or worst(run) < 0.9 * worst(chosen[-1]):
            alike = [other for other in runs if (other.element, other.size) == (run.element, run.size)
                     and getattr(other, cost) < 1.1 * getattr(run, cost) and worst(other) < 1.1 * worst(run)]
            best = min(alike, key=lambda other: len(apart(other.choice)))
            chosen += [best] if best not in chosen else []
    return chosen


def words(choice):
    return "ORIGINAL" if choice == ORIGINAL else " ".join(choice.values())


def per_cent(part):
    return "" if part is None else short(100 * part, 2)


def fronts(runs):
    by_time, by_memory = front(runs, "cpu"), front(runs, "memory")
    rows = sorted(by_time + [run for run in by_memory if run not in by_time], key=lambda run: -worst(run))
    return table(["element", "mesh", "choice", "CPU, ms", "MB", "p_max off, %", "estimate", "approach off, %", "estimate", "front of"],
                 [[run.element.upper(), run.size, words(run.choice), short(1e3 * run.cpu), f"{run.memory:.1f}", per_cent(run.error_p),
                   per_cent(run.estimate_p), per_cent(run.error_q), per_cent(run.estimate_q),
                   " and ".join([word for word, of in (("time", by_time), ("memory", by_memory)) if run in of])] for run in rows])


def elements(runs, scene):
    """Time that each element needs, on the line of the logarithms between two meshes, for an error; base choice."""
    rows = []
    for element in ELEMENTS:
        of = [run for run in runs if run.element == element and not apart(run.choice)]
        if of:
            ladder = [(1e6 * run.cpu, worst(run)) for run in of]
            times = [needed(ladder, error) for error in (0.03, 0.01, 0.003)]
            reached = [worst(of[0]) <= error for error in (0.03, 0.01, 0.003)]
            rows.append([scene.name, element.upper(), *(f"< {short(ladder[0][0] / 1e3)}" if all_of else short(t / 1e3) if t else "" for t, all_of
                        in zip(times, reached)), f"{per_cent(worst(of[-1]))} in {short(ladder[-1][0] / 1e3)}"])
    return rows


def one_at_a_time(runs, failed, scene):
    """What one choice changes, from the base, on the meshes of a scene; of methods at every tolerance."""
    key = lambda run: (run.element, run.size)  # noqa: E731
    base = {key(run): run for run in runs if not apart(run.choice)}
    rows = []
    for choice in choices(scene):
        if not apart(choice) or (len(apart(choice)) > 1 and set(apart(choice)) != {"METHOD", "TOL"}):
            continue
        of = [run for run in runs if run.choice == choice and key(run) in base]
        lost = sum(c == choice for _, _, c, _ in failed)
        if not of and not lost:
            continue
        cells = [scene.name, words({name: choice[name] for name in apart(choice)})]
        if of:
            against = [(run, base[key(run)]) for run in of]
            moved = max(abs(run.values[k] / whole.values[k] - 1) for run, whole in against for k in run.values)
            large = max(against, key=lambda pair: pair[1].cpu)
            cells += [f"{statistics.median(run.cpu / whole.cpu for run, whole in against):.2f}", f"{large[0].cpu / large[1].cpu:.2f}",
                      f"{large[0].memory / large[1].memory:.2f}", f"{moved:.0e}",
                      f"{statistics.median(worst(run) / worst(whole) for run, whole in against):.2f}"]
        else:
            cells += [""] * 5
        rows.append([*cells, f"{lost} of {lost + len(of)}" if lost else ""])
    return rows


def draw(found, path):
    from drawing import style  # here: what drives the runs stays small
    from drawing.style import plt

    figure, panels = plt.subplots(2, 3, figsize=(12.5, 7.4), layout="constrained")
    for axes, (scene, runs, _) in zip(panels.flat, found):
        for element, (colour, mark) in style.ELEMENTS.items():
            of = [run for run in runs if run.element == element]
            axes.loglog([1e3 * run.cpu for run in of], [100 * worst(run) for run in of], mark, ms=3.5, mew=0, alpha=0.35, color=colour)
        best = front(runs, "cpu")
        axes.step([1e3 * run.cpu for run in best], [100 * worst(run) for run in best], "k-", lw=1.1, where="post")
        base = [run for run in runs if not apart(run.choice)]
        axes.loglog([1e3 * run.cpu for run in base], [100 * worst(run) for run in base], "k+", ms=7, mew=0.9)
        axes.set(title=scene.name, xlabel="processor time, ms", ylabel="true error, %")
        axes.grid(alpha=0.25, lw=0.6)
    legend = panels.flat[-1]
    legend.axis("off")
    for element, (colour, mark) in style.ELEMENTS.items():
        legend.plot([], [], mark, color=colour, label=element.upper())
    legend.plot([], [], "k+", ms=7, label=words(BASE))
    legend.plot([], [], "k-", lw=1.1, label="Pareto front")
    legend.legend(loc="center")
    figure.savefig(path, dpi=110, metadata={"Software": None})


#: Mechanisms that are no longer there: old and new program in turns, medians of five, one thread.
REMOVED = [
    ["PARAM RULE BLOCK: block pivoting of the contacts with F of each body, from 100 pairs on; an interior path",
     "blocks of `tools/decks` with 600 pairs and 24 000 nodes 0.27 s, now 0.26 (CONRY); 1000 pairs and 40 000 nodes 0.56, 0.70 (JOINED); strip of 600 pairs 0.15, 0.15",
     "a second way to the same bits, 300 lines; its exchanges remain as the rescue of the simplex, its interior path in joined bodies. Rows of BLOCK in the "
     "other tables of this page are of the program before"],
    ["flexibility in levels: F and its factor as block tridiagonal matrices, unit loads passed from level to level",
     "stack of `tools/decks` (30 bodies, 42 000 nodes) 0.43 s and 158 MB, now 0.65 s and 208 MB (JOINED; with CONRY 1.04 s and 173 MB); 1 000 small bodies 0.66, 0.74 s; walls the other way: "
     "16 x 16 bricks 0.57 s and 66 MB, now 0.16 s and 26 MB",
     "900 lines; many bodies are joined, which takes springs, MPC and undetermined modes now"],
    ["PARAM PRECIS: factors in single precision, refined (MIXED) or not (SINGLE)",
     "hertz 42000 of `tools/decks` with PRECIS DOUBLE, MIXED, SINGLE: elastic 0.33, 0.39, 0.32 s and 141, 114, 112 MB; yielding (`--plastic`) 0.82, "
     "1.39, 0.65 s and 214, 166, 165 MB",
     "1 000 lines of templates included twice, a second solve where single precision fails, every test in three precisions: for 3 to 20 % of "
     "the time of large models and a fifth of their memory. Rows of MIXED and SINGLE in the other tables of this page are of the program before"],
    ["forecast of the run time in seconds: `--plan`, progress",
     "the time of 151 of 152 decks within a factor of 2 (as the documents said), of which `--plan` took 3 ms; other runs take the same time without it",
     "360 lines of src and 700 of tests that follow the machine; `--plan` states operations and memory, progress what is done"],
    ["large pages under the factors and, touched ahead, under the heap; small ones where large ones come slowly",
     "0 to 4 % of processor time (medians of seven, with the row below): `tools/decks` hertz 11000 0.078 s with, 0.081 without; `--plastic` 0.183, 0.183; "
     "hertz 42000 0.314, 0.328; blocks of 43 000 nodes and 1500 pairs 0.616, 0.621. Large pages under the first step of the heap stay: without them "
     "0.093, 0.208, 0.367, 0.666 s",
     "90 lines; one call of madvise (`system/memory.f90`) has most of the gain"],
    ["probes of the condition taken through the factorization and the solves of the error estimates",
     "at most 3 % of processor time: hertz 42000 0.362 s with, 0.368 with two solves more; `--plastic` 0.818, 0.820; blocks of 43 000 nodes 0.659, 0.680; "
     "stack 0.442, 0.440; dovetail 0.407, 0.407; hertz 150000 1.473, 1.498. Memory 0 to 1 % less without",
     "110 lines in five files; now one procedure of 20 lines (`assembly/stiffness.f90`)"],
    ["unit loads along every rigid-body mode, passed on from level to level: an error of every approach",
     "an error of the approach of more than the 12 largest motions; others are blank now. With and without, stack of `tools/decks` of 30 bodies 0.42 and 0.39 s, "
     "of 1 000 1.24 and 1.17 s, a wall of 16 x 16 bricks 0.49 and 0.33 s and 66 and 36 MB; two cylinders, blocks, dovetail, strip the same. Share of the "
     "accuracy in an elastic run: 14 to 23 %, wall 6 %, 1 000 bodies 8 %; in 100 load cases 27 to 30 %",
     "350 lines of src and 180 of tests; both contact rules now have one set of unit loads"],
    ["load cases of a deck in parallel, in streams that each start from a copy of the first case",
     "one thread: the same processor time. 100 cases of hertz 3000, hertz 11000, hertz 900 `--plastic` and 600 pairs of blocks take 0.99, 0.97, 1.02 and 1.03 "
     "of it without (medians of two to five in turns). Forecast of their memory: 45 MB, 89 with. On more threads the cases of one deck no longer gain; decks "
     "in parallel (`tools/batch`) do",
     "200 lines of src: streams, copies, a second start if a case changed the plan, texts held until the last case, memory of threads"],
    ["cards read by several threads, then faulty cards once more in the order of lines",
     "hertz 42000 of `tools/decks`: one thread, 0.359 s with and without. Reading takes 0.026 s of it, so two threads can save 0.013 s of the wall clock",
     "60 lines of src; now each card is read once, in the order of lines"]]


def page(found, quick, spent, picture):
    count = sum(len(runs) + len(failed) for _, runs, failed in found)
    text = ["# Time, memory and accuracy of each choice",
            f"`tools/tradeoff{' --quick' if quick else ''}`, {platform.machine()}: {count} choices of mesh, element, method, tolerance and rule in "
            f"{spent / 60:.0f} minutes. Time: processor, whole process, one thread, the least of three runs. Memory: its peak. Errors: true ones, the worst "
            "largest pressure and the worst approach (tube: mean u(a)) in per cent; beside them what the program itself says. mesh: elements across the contact (cylinders), round "
            "the pin, through the wall (tube), size at the contact (joint). The pin has no approach: its load is a point load."]
    text += [f"![Error against time]({picture})", "## Elements: milliseconds for an error",
             f"Choices: {words(BASE)}, as far as a scene has a use for them. Error: the worse of largest pressure and approach, and on all finer meshes too.",
             table(["scene", "element", "3 %", "1 %", "0.3 %", "finest, % in ms"], [row for scene, runs, _ in found for row in elements(runs, scene)]),
             "## One choice at a time",
             f"Against {words(BASE)} on the same mesh: time (median over the meshes, and on the one that takes longest), memory there, how far p_max or "
             "approach moves at most, true error (median); runs that gave no answer (not converged in 100 iterations, or none that the certificate takes).",
             table(["scene", "choice", "time", "largest", "memory", "moves by", "error", "no answer"],
                   [row for scene, runs, failed in found for row in one_at_a_time(runs, failed, scene)])]
    text += ["## Removed", "Mechanisms that are no longer there, and what they gained: old and new program in turns, processor time and peak memory, medians of five.",
             table(["mechanism", "what it gained", "why it went"], REMOVED)]
    text += ["## Pareto fronts", "Runs that err less, by a tenth at least, than all that cost less; of choices within a tenth of each other on one mesh the one nearest to "
             f"{words(BASE)}."]
    for scene, runs, _ in found:
        text += [f"### {scene.name[0].upper()}{scene.name[1:]}", fronts(runs)]
    return "\n\n".join(text) + "\n"


def main():
    parser = parser_of(__doc__, "tools/tradeoff")
    parser.add_argument("--quick", action="store_true", help="two meshes of each element, one choice at a time: a minute")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="name of page and picture, without .md and .png; tools/tradeoff if not given")
    options = parser.parse_args()
    name = options.output or TOP / ("build/tradeoff_quick" if options.quick else "tools/tradeoff")
    check_folder(parser, name)
    start, found = time.perf_counter(), []
    for scene in scenes():
        begin = time.perf_counter()
        found.append((scene, *runs_of(scene, options.quick)))
        print(f"{scene.name}: {len(found[-1][1])} runs, {len(found[-1][2])} without an answer, {time.perf_counter() - begin:.0f} s", flush=True)
    draw(found, name.with_name(name.name + ".png"))
    name.with_name(name.name + ".md").write_text(page(found, options.quick, time.perf_counter() - start, name.name + ".png"), encoding="utf-8")
    print(name.with_name(name.name + ".md"))
    return 0


if __name__ == "__main__":
    run(main)
