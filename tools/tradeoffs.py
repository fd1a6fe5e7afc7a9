"""Measure time, memory and accuracy of each choice: mesh x element x method x tolerance x rule, on models with known answers.

    tools/tradeoff                  tools/tradeoff.md and tools/tradeoff.png
    tools/tradeoff --quick          coarse meshes and few choices: the same tables in a minute
    tools/tradeoff -o build/mine    build/mine.md, build/mine.png
    tools/tradeoff --friction       the tables of friction only, on standard output

Time: processor time, user and system, of a whole process on one thread, including reading and writing; the shortest of three runs (one, if
it takes a second). Memory: its peak. True error: from the closed form, or from the limit of much finer meshes
(tests/accuracy/cases.py); the larger one of the largest pressures and of the approaches. Errors are the same on every run; times
are not, and runs whose times differ by a few per cent may change places.
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
import tradeoffs_friction  # noqa: E402
from wording import parser_of, run  # noqa: E402

METHODS, TOLERANCES = ("NEWTON", "SECANT", "MODSEC", "INISTR"), ("1.E-2", "1.E-4", "1.E-8")
RULES = "CONRY", "JOINED"
#: The base of all comparisons. Models omit options that they do not use.
BASE = {"METHOD": "NEWTON", "TOL": "1.E-8", "RULE": "CONRY"}
#: The complete method of the program of about 1980.
ORIGINAL = {"ORIGINAL": "YES"}
#: A model: its known answer, its deck, its meshes (element, parameter; the finest of each element last), whether it yields, and has contact.
Scene = collections.namedtuple("Scene", "name truth make meshes yields touches")
#: A successful run: errors are relative, the largest of their type; None if there is no such value.
Run = collections.namedtuple("Run", "scene element size choice cpu memory values error_p error_q")


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
    """All choices that apply to a model, the base first; methods other than NEWTON only with CONRY; and ORIGINAL."""
    of = {"METHOD": METHODS if scene.yields else (), "TOL": TOLERANCES[::-1] if scene.yields else (), "RULE": RULES if scene.touches else ()}
    names = [name for name in of if of[name]]
    every = [dict(zip(names, values)) for values in itertools.product(*(of[name] for name in names))]
    return [choice for choice in every if choice.get("METHOD", "NEWTON") == "NEWTON" or "RULE" not in apart(choice)] + [ORIGINAL]


def apart(choice):
    """Options in which a choice differs from the base."""
    return [name for name in choice if choice[name] != BASE.get(name)]


def solve(scene, element, size, deck, choice, place):
    """A Run, or the exit status if there is no answer."""
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
    error = {}
    figures = [key for key in scene.truth if key[0] != "b"]
    for key in figures:
        kind = "p" if key[0] == "p" else "q"
        error[kind] = max(error.get(kind, 0.0), abs(found[key][0] / scene.truth[key] - 1))
    return Run(scene.name, element, size, choice, cpu, memory, {key: found[key][0] for key in figures}, error.get("p"), error.get("q"))


def worst(run):
    return max(run.error_p or 0.0, run.error_q or 0.0)


def runs_of(scene, quick):
    """All runs of a model, and (element, size, choice, exit status) of those without an answer."""
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
    """Runs whose error is at least a tenth below that of all cheaper ones; cheapest first. If choices on one mesh are within a tenth
    of each other in both, the one nearest to the base is taken, so that noise does not choose."""
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


def elements(runs, scene):
    """Time that each element needs for an error with the base choice, interpolated between two meshes in logarithmic scales."""
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
    """Effect of each change from the base, on the meshes of a model; methods at every tolerance."""
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
            cells += [f"{statistics.median(run.cpu / whole.cpu for run, whole in against):.2f}", f"{large[0].memory / large[1].memory:.2f}", f"{moved:.0e}",
                      f"{statistics.median(worst(run) / worst(whole) for run, whole in against):.2f}"]
        else:
            cells += [""] * 4
        rows.append([*cells, f"{lost} of {lost + len(of)}" if lost else ""])
    return rows


def prices(rows):
    """Summarize the rows of `one_at_a_time` over all models: ranges of time and memory, largest change and error, runs without answer."""
    choices_of = collections.defaultdict(list)
    for _, choice, *cells in rows:
        choices_of[choice].append(cells)
    lines = []
    for choice, cells in choices_of.items():
        times, memory, changes, errors = ([float(row[k]) for row in cells if row[k]] for k in range(4))
        lost = sum(int(row[4].split()[0]) for row in cells if row[4])
        if times:
            lines.append([choice, f"{min(times):.2f} to {max(times):.2f}", f"{min(memory):.2f} to {max(memory):.2f}", f"{max(changes):.0e}", f"{max(errors):.2f}", lost or ""])
    return lines


def draw(found, path):
    from drawing import style  # inside the function, so that the driving process stays small
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


#: First of the sections that stay as they are.
KEPT = "\n## Friction\n"


def page(found, quick, spent, picture):
    count = sum(len(runs) + len(failed) for _, runs, failed in found)
    single = [row for scene, runs, failed in found for row in one_at_a_time(runs, failed, scene)]
    text = ["# Time, memory and accuracy of each choice",
            f"`tools/tradeoff{' --quick' if quick else ''}` solved {count} combinations of mesh, element, method, tolerance and contact solver in {spent / 60:.0f} minutes "
            f"({platform.machine()}). The mesh decides: other choices on one mesh mostly leave the same error.",
            "Time is the processor time of the whole process on one thread, the least of three runs. Error is the true error of largest pressure and approach, the worst of each model "
            "(tube: mean u(a); pin: pressure alone, because its load is a point load).",
            "## Price of a choice", f"All figures are relative to {words(BASE)} on the same mesh.",
            "- Time: range over the models, each the median over its meshes. Memory: the same of the peak, on the mesh that takes longest.\n"
            "- Change: largest change of p_max or approach. Error: factor of the true error, the largest median of a model.\n"
            "- No answer: runs without convergence in 100 iterations, or with an answer that the certificate rejects.",
            table(["choice", "time", "memory", "change", "error", "no answer"], prices(single)),
            f"![Error against time]({picture})",
            f"Crosses: {words(BASE)}. Black line: each run has an error at least a tenth below that of all faster ones.", "## Elements: milliseconds for an error",
            f"Choices: {words(BASE)}, if they apply to the model. The error is not exceeded on this mesh and all finer ones.",
            table(["model", "element", "3 %", "1 %", "0.3 %", "finest, % in ms"], [row for scene, runs, _ in found for row in elements(runs, scene)])]
    return "\n\n".join(text) + "\n"


def main():
    parser = parser_of(__doc__, "tools/tradeoff")
    parser.add_argument("--quick", action="store_true", help="two meshes of each element, one choice at a time: one minute")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="name of page and picture, without .md and .png; default tools/tradeoff")
    parser.add_argument("--friction", action="store_true", help="only the tables of friction, on standard output: some minutes")
    options = parser.parse_args()
    if options.friction:
        with tempfile.TemporaryDirectory() as place:
            print(tradeoffs_friction.page(EPCONT, pathlib.Path(place)))
        return 0
    name = options.output or TOP / ("build/tradeoff_quick" if options.quick else "tools/tradeoff")
    check_folder(parser, name)
    start, found = time.perf_counter(), []
    for scene in scenes():
        begin = time.perf_counter()
        found.append((scene, *runs_of(scene, options.quick)))
        print(f"{scene.name}: {len(found[-1][1])} runs, {len(found[-1][2])} without an answer, {time.perf_counter() - begin:.0f} s", flush=True)
    draw(found, name.with_name(name.name + ".png"))
    target = name.with_name(name.name + ".md")
    old = target.read_text(encoding="utf-8") if target.exists() else ""
    kept = old[old.find(KEPT):] if KEPT in old else ""   # not measured here
    target.write_text(page(found, options.quick, time.perf_counter() - start, name.name + ".png") + kept, encoding="utf-8")
    print(target)
    return 0


if __name__ == "__main__":
    run(main)
