"""The page and the picture of tools/bench."""
import math

import report_large
from report_words import best, exponent, milliseconds, per_cent, short, table

COLOURS = {"epcont": "#cc3311", "CalculiX": "#4477aa", "scikit-fem": "#228833", "scikit-fem's parts": "#88cc88", "quadprog": "#4477aa", "HiGHS": "#228833", "DAQP": "#ccbb44",
           "PIQP": "#aa3377", "OSQP": "#888888"}
KINDS = ("elastic", "elastoplastic")
SCIKIT_FEM = ("scikit-fem", "scikit-fem's parts")
PROGRAMS = ("epcont", "CalculiX", *SCIKIT_FEM)


def ratios(rows):
    lines = []
    for kind in KINDS:
        for ours in best(rows, kind, "epcont"):
            of = {p: next((r for r in best(rows, kind, p) if r["nodes"] == ours["nodes"]), None) for p in PROGRAMS[1:]}
            direct = [r for r in rows if r["kind"] == kind and r["nodes"] == ours["nodes"] and "SPOOLES" in r["setting"] and r["wall"]]
            direct = min(direct, key=lambda r: r["cpu"], default=None)
            ccx = of["CalculiX"]
            lines.append([kind, ours["nodes"], short(ours["cpu"]), short(ccx["cpu"]), short(ccx["cpu_ratio"]), short(ccx["wall_ratio"]),
                          ccx["setting"], short(direct["cpu_ratio"]) if direct else "", direct["setting"].replace(", SPOOLES", "") if direct else "",
                          short(ours["memory"]), short(ccx["memory_ratio"]),
                          *(short(value) for p in SCIKIT_FEM
                            for value in ((of[p]["cpu_ratio"], of[p]["rest"] / ours["cpu"]) if of[p] else (None, None)))])
    return table(["", "nodes", "epcont, s", "CalculiX, s", "ratio", "of wall", "its fastest sound setting", "ratio, SPOOLES", "with",
                  "epcont, MB", "ratio, CalculiX", "ratio, scikit-fem", "without imports", "ratio, its parts, tuned", "without imports"], lines)


def cylinders(rows):
    lines = [[row["kind"], row["nodes"], row["program"], row["setting"], row["runs"], short(row["cpu"]), short(row["wall"]), short(row["memory"]),
              short(row["p_max"], 4), per_cent(row["p_error"]), f"{row['approach']:.6f}", per_cent(row["d_error"]), short(row["cpu_ratio"]),
              short(row["wall_ratio"]), short(row["memory_ratio"]), row["note"]] for row in rows]
    return "\n\n".join([
        "## Two cylinders: whole programs",
        "Seconds of processor (user and system) and of wall, peak memory of the process. Ratios: the program's over epcont's. CalculiX: GAPUNI with "
        "a *PLASTIC card that elastic runs never reach, or NODE TO SURFACE contact, closed gaps 1e5 E stiff; SPOOLES is its default and direct, "
        "ITERATIVE CHOLESKY its conjugate gradients. Each setting runs once (wall empty: only once); those near the fastest sound "
        "one, and the fastest with SPOOLES, take turns with epcont, each right after a run that is not timed where it is short (under 5 s). Sound: whole load, approach within 1 % of epcont's, p_max within 1 % "
        "(elastoplastic: 6 %). epcont elastoplastic: NEWTON to 1e-8.",
        ratios(rows),
        "Errors in per cent: elastic p_max against Hertz, approach against Johnson; elastoplastic against epcont's converged total theory (198.4, "
        "0.001419). CalculiX has flow theory: its lower p_max is no error but another theory. scikit-fem ends with "
        "displacements and contact forces (no stresses, tables, certificate): as contact is written with it, condensed and solved for each "
        "active set (condense), and the fastest that we could make of its parts, which is epcont's own way (splu, cholmod; `scikit_fem.py`).",
        table(["", "nodes", "program", "setting", "runs", "CPU, s", "wall, s", "MB", "p_max", "%", "approach", "%", "CPU ratio", "wall ratio",
               "memory ratio", ""], lines)])


def contact(rows):
    lines = [[row["problem"], row["n"], f"{row['condition']:.0e}", row["program"], short(row["cpu"]), short(row["ratio"]),
              "" if row["violation"] is None else f"{row['violation']:.0e}", row["note"]] for row in rows]
    return "\n\n".join([
        "## Dense contact problem alone",
        "Strips on a half-plane, one motion. epcont: its simplex (CONRY); WARM from the right active set; dgemm one "
        "product of matrices of that size. Seconds of processor; ratio over epcont's (below 1: faster than epcont). Violation: largest of |min(R/|R|, "
        "w/(|F||R|))| and of the load's relative error, |R| the largest force, |F| the largest sum of a row; the packages are asked for 1e-9. A program that "
        "took too long is left out at the next size.",
        table(["problem", "n", "condition of F", "program", "CPU, s", "ratio", "violation", ""], lines)])


def factor(rows, runs):
    lines = [["dgemm, n = 1000" if row["nodes"] is None else row["nodes"], int(row["equations"]), int(row["width"]), short(row["seconds"]),
              f"{row['rate'] / 1e9:.1f}", f"{100 * row['part']:.0f}"] for row in rows["factor"]]
    text = ["## Factorization", "Operations: n w^2 of the band, 2 n^3 of dgemm.",
            table(["nodes", "equations", "half-bandwidth", "seconds", "1e9 operations/s", "% of dgemm"], lines)]
    text += ["## Growth", "Two cylinders, elastic: the whole process, its solve part (numbering to displacements, as in the section on it), its peak memory.",
             table(["equations", "process, CPU s", "wall, s", "solve part, CPU s", "peak memory, MB"],
                   [[row["equations"], *(short(row[what]) for what in ("cpu", "wall", "solve", "memory"))] for row in rows["growth"]])]
    growth = [(f"epcont, {name}", [(row["equations"], row[what]) for row in rows["growth"]])
              for name, what in (("process, CPU", "cpu"), ("process, wall", "wall"), ("solve part, CPU", "solve"), ("peak memory", "memory"))]
    growth += [("factorization", [(row["equations"], row["seconds"]) for row in rows["factor"] if row["nodes"] and row["nodes"] > 900])]
    growth += [(f"{program}, {kind}, whole", [(row["nodes"], row["cpu"]) for row in best(runs, kind, program) if row["nodes"] > 900])
               for program in PROGRAMS for kind in KINDS]
    text += ["They grow with the unknowns to the power (1 000 nodes and more, least squares):",
             table(["", "power"], [[name, f"{exponent(points):.2f}"] for name, points in growth if len(points) > 1])]
    text += ["## The smallest deck", "Milliseconds of processor of a whole process, against those of an empty program with the same libraries.",
             table(["deck", "epcont, ms", "empty, ms", "difference, ms", "runs"],
                   [[row["deck"], *(f"{row[what]:.2f}" for what in ("cpu", "empty", "difference")), row["runs"]] for row in rows["smallest"]])]
    return "\n\n".join(text)


#: Stages of the solve part, and what the libraries bare do there.
STAGES = {"ordering": "numbering", "factor": "factor", "flexibility": "F", "load_gap": "load gaps", "contact": "contact", "displacements": "displacements"}


def solve_part(rows):
    ratios, stages = [], []
    for row in rows:
        ours, once, more = row["ours"], row["all"], row["more"]
        ratios.append([row["equations"], milliseconds(ours["all"]), milliseconds(once["all"]), f"{once['ratio']:.2f}", once["name"],
                       milliseconds(ours["more"]), milliseconds(more["more"]), f"{more['ratio']:.2f}", more["name"]])
        stages.append([row["equations"], "epcont", *(milliseconds(ours[stage]) for stage in STAGES), milliseconds(ours["assembly"]),
                       milliseconds(ours["condition"])])
        stages.append(["", once["name"], *(milliseconds(once[stage]) if stage in once else "" for stage in STAGES), "", ""])
    return "\n\n".join([
        "## Solve part",
        "Two cylinders, elastic, milliseconds of processor: numbering, factor, F, contact and displacements by epcont, and by the best libraries "
        "bare (`bare/`: LAPACK's band, CHOLMOD, MUMPS, all with OpenBLAS; the fastest of 14 ways at each size), that get the matrix ready made and are "
        "told which pairs touch. "
        "Seven more: factor to displacements with the same ordering. Ratio below 1: epcont is faster.",
        table(["equations", "epcont", "bare", "ratio", "by", "seven more", "bare", "ratio", "by"], ratios),
        "By stages. Load gaps: the loads here act on SUPORT freedoms and open none; the libraries are not asked for them. epcont's assembly, "
        "which clears the storage of the factor too, and its estimate of the condition are in no sum.",
        table(["equations", "", *STAGES.values(), "assembly", "condition"], stages)])


def page(parts, about):
    """`parts`: of each number the rows, and the command and the load that they were measured by and under."""
    rows = {part: found["rows"] for part, found in parts.items()}
    by = "; ".join(f"part {part} by `{found['command']}`, {found['load']}" for part, found in sorted(parts.items()))
    text = ["# Benchmarks", f"{about} One thread each, where nothing else is said. Measured once: {by}. Another machine, or a busy one, gives other times. Ratios are steadier."]
    text += [cylinders(rows[1])] if 1 in rows else []
    text += [contact(rows[2])] if 2 in rows else []
    text += [factor(rows[3], rows.get(1, []))] if 3 in rows else []
    text += [solve_part(rows[4])] if 4 in rows else []
    text += [report_large.large(rows[5])] if 5 in rows else []
    return "\n\n".join(text)


def draw(rows, path):
    from drawing.style import plt  # here: what drives the runs stays small

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
