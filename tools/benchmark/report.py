"""The page and the picture of tools/bench."""

import report_large
from report_words import best, exponent, milliseconds, per_cent, short, table

COLOURS = {"epcont": "#cc3311", "CalculiX": "#4477aa", "scikit-fem": "#228833", "scikit-fem's parts": "#88cc88", "quadprog": "#4477aa", "HiGHS": "#228833", "DAQP": "#ccbb44",
           "PIQP": "#aa3377", "OSQP": "#888888"}
KINDS = ("elastic", "elastoplastic")
SCIKIT_FEM = ("scikit-fem", "scikit-fem's parts")
PROGRAMS = ("epcont", "CalculiX", *SCIKIT_FEM)


def comparison(rows):
    """A row for each model: epcont, and the fastest sound setting of CalculiX."""
    lines = []
    for kind in KINDS:
        for ours in best(rows, kind, "epcont"):
            ccx = next(row for row in best(rows, kind, "CalculiX") if row["nodes"] == ours["nodes"])
            lines.append([kind, ours["nodes"], *(cell for row in (ours, ccx) for cell in (
                short(row["cpu"]), short(row["memory"]), per_cent(row["p_error"]), per_cent(row["d_error"]))), short(ccx["cpu_ratio"]), ccx["setting"]])
    figures = ["MB", "p_max, %", "approach, %"]
    return table(["", "nodes", "epcont, s", *figures, "CalculiX, s", *figures, "CPU ratio", "CalculiX setting"], lines)


def settings(rows):
    """A row for each program and setting, a column for each mesh: CPU seconds."""
    nodes = sorted({row["nodes"] for row in rows})
    lines = {}
    for row in rows:
        name = f"{row['program']} {row['setting']}".strip()
        lines.setdefault(name, {})[row["nodes"]] = row["cpu"]
        if row["rest"]:
            lines.setdefault(f"{name}, without imports", {})[row["nodes"]] = row["rest"]
    return table(["elastic, CPU s", *(f"{n} nodes" for n in nodes)], [[name, *(short(of.get(n)) for n in nodes)] for name, of in lines.items()])


def cylinders(rows):
    return "\n\n".join([
        "## Two cylinders: whole programs",
        "All programs solve the two cylinders of `tools/decks` (hertz, CTRIA3). Times are user and system seconds of the whole process, medians of all turns. A ratio is "
        "the median of the ratios of each turn: above 1, epcont is faster.",
        "- CalculiX: contact by GAPUNI, or NODE TO SURFACE with a stiffness of 1e5 E. SPOOLES is its default solver, ITERATIVE CHOLESKY its conjugate gradients.\n"
        "- A setting is sound if it carries the whole load, the approach is within 1 % of that of epcont, and p_max within 1 % (elastoplastic: 6 %).\n"
        "- Each setting runs once. The fastest sound settings then take turns with epcont.\n"
        "- Errors: elastic p_max against Hertz, approach against Johnson. Elastoplastic against the converged total theory of epcont (198.4, 0.001419).\n"
        "- Elastoplastic: epcont uses NEWTON to 1e-8. CalculiX uses flow theory, so its lower p_max is another theory, not an error.",
        comparison(rows),
        "scikit-fem computes displacements and contact forces only. `condense` condenses the system and solves it for each active set. "
        "`splu` and `cholmod` combine its parts in the way of epcont, the fastest that we found (`scikit_fem.py`).",
        settings([row for row in rows if row["kind"] == "elastic"])])


#: Numbers of pairs that the page shows.
SHOWN = (1000,)


def contact(rows):
    """A row for each problem and size: CPU milliseconds of each program; last, the largest violation of each program at all sizes."""
    names = list(dict.fromkeys(row["program"] for row in rows))
    lines = {}
    for row in rows:
        if row["n"] in SHOWN:
            lines.setdefault((row["problem"], row["n"], f"{row['condition']:.0e}"), {})[row["program"]] = row["note"] and "no answer" or milliseconds(row["cpu"])
    largest = {name: max((row["violation"] for row in rows if row["program"] == name and row["violation"]), default=None) for name in names}
    return "\n\n".join([
        "## Dense contact problem alone",
        "Strips of pressure on a half-plane, with one rigid-body mode. CPU milliseconds. epcont uses its simplex (CONRY); WARM starts from the right active set; dgemm is one "
        "product of matrices of that size. Violation: largest of |min(R/max R, w/(|F| max R))| and of the relative error of the load, for all sizes from 50 to 1000 "
        "pairs. |F| is the largest row sum of F. The packages are asked for 1e-9.",
        table(["problem", "pairs", "condition of F", *names],
              [*([*key, *(of.get(name, "") for name in names)] for key, of in lines.items()),
               ["largest violation", "", "", *("" if largest[name] is None else f"{largest[name]:.0e}" for name in names)]])])


def friction(rows):
    """A row for each problem and size: milliseconds of epcont, and the times of the others over that; the numbers of right answers of random problems."""
    half = [row for row in rows if row["problem"] != "random"]
    names = [name for name in dict.fromkeys(row["program"] for row in half) if name != "epcont"]
    lines = {}
    for row in half:
        shown = milliseconds(row["cpu"]) if row["program"] == "epcont" else row["note"] and "no answer" or short(row["ratio"])
        lines.setdefault((row["problem"], row["n"]), {})[row["program"]] = shown
    worst = {name: max((row["violation"] or 0.0 for row in half if row["program"] == name), default=0.0) for name in ("epcont", *names)}
    return "\n\n".join([
        "## Dense contact problem with friction",
        "Strips on a half-plane with Poisson's ratio 0.3 and mu 0.3, pressed by P and pushed by mu P/2 in one step. epcont: CPU milliseconds of its simplex (CONRY), with two rigid-body "
        "modes. Other columns: times over that. fixed: epcont with given rigid-body displacements, as the programs to the right have them. frictionless: epcont, the same pairs without "
        "friction. Violation: of the conditions of Coulomb's law, over the largest force.",
        table(["problem", "pairs", "epcont", *names], [[*key, *(of.get(name, "") for name in ("epcont", *names))] for key, of in lines.items()] +
              [["largest violation", "", *(worst[name] and f"{worst[name]:.0e}" or "" for name in ("epcont", *names))]]),
        "Random problems with 0, 1 and 3 rigid-body modes and mu 0.1 to 1: right answers (violation below 1e-7). Lemke's algorithm has weak springs on the modes.",
        table(["pairs", "modes", "problems", "epcont", "Lemke", "both", "both the same"],
              [[row[key] for key in ("n", "modes", "number", "epcont", "Lemke", "both", "same")] for row in rows if row["problem"] == "random"])])


def factor(rows, runs):
    lines = [["dgemm, n = 1000" if row["nodes"] is None else row["nodes"], int(row["equations"]), int(row["width"]), short(row["seconds"]),
              f"{row['rate'] / 1e9:.1f}", f"{100 * row['part']:.0f}"] for row in rows["factor"]]
    text = ["## Factorization", "Band of half-bandwidth w. Operations: n w^2 for the band, 2 n^3 for dgemm.",
            table(["nodes", "equations", "half-bandwidth", "seconds", "1e9 operations/s", "% of dgemm"], lines)]
    growth = [(f"epcont, {name}", [(row["equations"], row[what]) for row in rows["growth"]])
              for name, what in (("CPU", "cpu"), ("solve part", "solve"), ("memory", "memory"))]
    growth += [("factorization", [(row["equations"], row["seconds"]) for row in rows["factor"] if row["nodes"] and row["nodes"] > 900])]
    growth += [(f"{program}, {kind}", [(row["nodes"], row["cpu"]) for row in best(runs, kind, program) if row["nodes"] > 900])
               for program in PROGRAMS[:2] for kind in KINDS]
    growth = [(name, points) for name, points in growth if len(points) > 1]
    text += ["## Growth", "Two cylinders: powers of the number of unknowns, by least squares, for 1 000 nodes or more. The solve part begins with the numbering and ends with "
             "the displacements.", table([name for name, _ in growth], [[f"{exponent(points):.2f}" for _, points in growth]])]
    text += ["## Smallest deck", "CPU milliseconds of a whole process, and of an empty program with the same libraries.",
             table(["deck", "epcont, ms", "empty, ms", "difference, ms", "runs"],
                   [[row["deck"], *(f"{row[what]:.2f}" for what in ("cpu", "empty", "difference")), row["runs"]] for row in rows["smallest"]])]
    return "\n\n".join(text)


def solve_part(rows):
    ratios = []
    for row in rows:
        ours, once, more = row["ours"], row["all"], row["more"]
        ratios.append([row["equations"], milliseconds(ours["all"]), milliseconds(once["all"]), f"{once['ratio']:.2f}", once["name"],
                       milliseconds(ours["more"]), milliseconds(more["more"]), f"{more['ratio']:.2f}", more["name"]])
    return "\n\n".join([
        "## Solve part",
        "Two cylinders, elastic, CPU milliseconds. The solve part is numbering, factorization, F, contact and displacements, without assembly and condition number. The libraries are "
        "the band solver of LAPACK, CHOLMOD and MUMPS, all with OpenBLAS (`bare/`), with the fastest of 14 combinations for each size. They get the assembled matrix and the active "
        "set. Seven more: seven further solves, from factorization to displacements, with the same ordering. Ratio below 1: epcont is faster.",
        table(["equations", "epcont", "libraries", "ratio", "fastest library", "epcont, seven more", "libraries", "ratio", "fastest library"], ratios)])


def history(rows):
    lines = []
    for row in rows:
        for name, of, left in (("epcont", row["found"], [short(row["ours"]), short(row["memory"]), "", f"{row['increment']:.2f}"]),
                               ("CalculiX, " + row["solver"], row["theirs"], [short(row["ccx"]), short(row["ccx_memory"]), f"{row['ratio']:.0f}", ""])):
            lines.append([row["nodes"], name, *left, f"{of[0]:.3f}", f"{of[1]:.8f}", f"{of[2]:.8f}"])
        lines.append(["", "stated error of the increments", "", "", "", "", *(f"{error:.2g}" for error in row["errors"])])
    return "\n\n".join([
        "## Load history",
        "Two cylinders, loaded in 20 increments of flow theory and unloaded to a thousandth in 20. CalculiX has the same mesh and increments, GAPUNI with a stiffness of "
        "1e5 E, and the faster of two solvers; it reduces increments that do not converge. CPU seconds of the whole process. epcont follows the history twice, for the error of the increments. Elastic runs: time of an "
        "increment (of 40) over that of an elastic run of the same mesh.",
        table(["nodes", "", "CPU, s", "MB", "CPU ratio", "elastic runs", "p_max", "approach", "approach left"], lines)])


def pushed(rows):
    lines = []
    for row in rows:
        what = "elastoplastic" if row["yields"] else "elastic"
        worst = [f"{figure:.1e}" for figure in row["worst"][:4]] + [row["worst"][4]] if row["worst"] else [f"exit status {row['status']}", "", "", "", ""]
        lines.append([row["nodes"], what, f"{row['tangential']:.0f}", short(row["ours"]), short(row["memory"]), short(row["ccx"]), short(row["ccx_memory"]),
                      f"{row['ratio']:.0f}" if row["worst"] else "", *worst])
    return "\n\n".join([
        "## Cylinders with friction",
        "Two cylinders are pressed, then pushed along the contact by .6 mu P, .95 mu P and back to 0, each in 10 increments, elastic or yielding (flow theory). CalculiX has the "
        "same mesh and increments: SURFACE TO SURFACE, SMALL SLIDING, SPOOLES, and a normal stiffness of 1e3 E/a. The tangential stiffness while it sticks is given over E/a. "
        "Differences are the largest of the four load cases, over the largest value of their kind; friction forces over the largest limit. Sticks: pairs that stick in one of the "
        "programs only. epcont follows each history twice, for the error of the increments. CPU seconds of the whole process.",
        table(["nodes", "", "tangential stiffness", "epcont, s", "MB", "CalculiX, s", "MB", "CPU ratio", "approach", "tangential displacement", "contact force", "friction force",
               "sticks"], lines)])


def page(parts, about):
    """`parts`: for each number the rows, the command that measured them, and the load of the machine."""
    rows = {part: found["rows"] for part, found in parts.items()}
    text = ["# Benchmarks", f"{about} One thread, unless a table says otherwise. Ratios depend less on the machine than times.",
            table(["part", "command", "load", "epcont"], [[part, f"`{found['command']}`", found["load"], found.get("version")] for part, found in sorted(parts.items())])]
    text += [cylinders(rows[1])] if 1 in rows else []
    text += [contact(rows[2])] if 2 in rows else []
    text += [factor(rows[3], rows.get(1, []))] if 3 in rows else []
    text += [solve_part(rows[4])] if 4 in rows else []
    text += [report_large.large(rows[5])] if 5 in rows else []
    text += [history(rows[6])] if 6 in rows else []
    text += [friction(rows[7])] if 7 in rows else []
    text += [pushed(rows[8])] if 8 in rows else []
    return "\n\n".join(text)


def draw(rows, path):
    from drawing.style import plt  # imported here, so that the driving process stays small

    figure, panels = plt.subplots(2, 2, figsize=(10.0, 7.6), layout="constrained")
    for axes, kind, what, title in ((panels[0][0], "elastic", "cpu", "two cylinders, elastic"), (panels[0][1], "elastoplastic", "cpu", "two cylinders, elastoplastic"),
                                    (panels[1][0], "elastic", "memory", "two cylinders, elastic")):
        for program in PROGRAMS:
            found = best(rows[1], kind, program)
            if found:
                axes.loglog([r["nodes"] for r in found], [r[what] for r in found], "o-", ms=4, lw=1.3, color=COLOURS[program], label=program)
        axes.set(title=title, xlabel="nodes", ylabel="processor time, s" if what == "cpu" else "peak memory, MB")
    axes = panels[1][1]
    for program in ("quadprog", "HiGHS", "DAQP", "PIQP", "OSQP", "epcont"):
        found = [r for r in rows[2] if r["problem"] == "half-plane" and r["program"] == program]
        axes.loglog([r["n"] for r in found], [r["cpu"] for r in found], "o-", ms=4, lw=1.3, color=COLOURS[program], label=program)
    axes.set(title="dense contact problem alone, half-plane", xlabel="pairs", ylabel="processor time, s")
    for axes in panels.flat:
        axes.legend(fontsize=9)
        axes.grid(alpha=0.25, lw=0.6)
    figure.savefig(path, dpi=110, metadata={"Software": None})
