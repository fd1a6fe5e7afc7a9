"""Panels of a load history: force against approach, pressure and half-width against force, residual stresses below the contact."""
import numpy as np

from drawing.style import BLUE, GREEN, GREY, PURPLE, RED

#: Residual stresses are shown to this multiple of the largest half-width, or of the depth of the yielded zone.
DEEP, BEYOND = 5.0, 1.5
#: The line goes through an element along more than this part of the element's size; otherwise it only touches the element.
THROUGH = 0.2
#: A load case is unloaded if less than this part of the largest force remains.
UNLOADED = 0.5
#: Lines of loading, unloading, loading again, ...: they remain visible if they coincide.
LINES = [{"color": BLUE, "marker": "o", "ms": 2.5}, {"color": RED, "marker": "s", "ms": 5, "mfc": "none"},
         {"color": GREEN, "marker": "x", "ms": 4, "ls": ":"}, {"color": PURPLE, "marker": "^", "ms": 5, "mfc": "none"}]


def cases(run):
    """Of each load case that has increments: its number, whether the force grows, and its columns. Each begins where the one before ends."""
    found, before = [], None
    for case in dict.fromkeys(row.get("subcase", "1") for row in run.increments):
        rows = [row for row in run.increments if row.get("subcase", "1") == case]
        force = [float(row["total_contact_force"]) for row in rows]
        name = f"SUBCASE {case}, " if "subcase" in rows[0] else ""
        word = "loaded" if force[-1] >= (float(before["total_contact_force"]) if before else 0.0) else "unloaded"
        rows, before = ([before] if before else []) + rows, rows[-1]
        found.append((name + word, {key: np.array([float(row[key] or "nan") for row in rows]) for key in
                                    ("total_contact_force", "approach", "max_pressure", "half_width")}))
    return found


def unloaded_case(increments):
    """The load case at the end of which the smallest part of an earlier contact force remains, and this part; or None."""
    ends = {row.get("subcase"): float(row["total_contact_force"]) for row in increments}
    largest, found = 0.0, []
    for case, force in ends.items():
        if largest > 0.0 and force < UNLOADED * largest:
            found.append((force / largest, case))
        largest = max([largest] + [float(row["total_contact_force"]) for row in increments if row.get("subcase") == case])
    return min(found)[::-1] if found else None


def draw(figure, run):
    """Force against approach: the loop of loading and unloading."""
    axes = figure.subplots()
    found = cases(run)
    known = any(np.isfinite(values["approach"]).any() for _, values in found)
    count = 1
    for (name, values), line in zip(found, LINES * len(found)):
        force = values["total_contact_force"]
        steps = np.arange(count, count + len(force))
        count = steps[-1]
        axes.plot(values["approach"] if known else steps, force, lw=1.0, label=name, **line)
    axes.set(xlabel="approach" + run.length_unit() if known else "increment", ylabel="total contact force", ylim=(0, None))
    if known and np.nansum(found[0][1]["approach"]) < 0.0:
        axes.invert_xaxis()
    axes.locator_params(axis="x", nbins=5)
    axes.legend()
    axes.set_title("loading and unloading" if len(found) > 1 else "loading")


def draw_pressures(figure, run):
    """Largest pressure and half-width against force."""
    found = cases(run)
    keys = ["max_pressure"] + ["half_width"] * any(np.isfinite(values["half_width"]).any() for _, values in found)
    plots = figure.subplots(len(keys), 1, sharex=True, squeeze=False)[:, 0]
    for (name, values), line in zip(found, LINES * len(found)):
        for axes, key in zip(plots, keys):
            known = np.isfinite(values[key])
            axes.plot(values["total_contact_force"][known], values[key][known], lw=1.0, label=name, **line)
    for axes, name in zip(plots, (f"p_max, {run.stress_unit()}", "half-width" + run.length_unit())):
        axes.set(ylabel=name, ylim=(0, None))
    plots[-1].set_xlabel("total contact force")
    plots[0].legend()
    plots[0].set_title("largest pressure and half-width" if len(plots) > 1 else "largest pressure")


def below_contact(run):
    """Elements on the line along the normal through the point of the largest pressure, and the middle of each on this line."""
    row = max(run.pressed, key=lambda row: float(row["pressure"] or 0.0))
    point, normal = (np.array([float(row[a]), float(row[b])]) for a, b in (("x", "y"), ("nx", "ny")))
    found = []
    for e, nodes in enumerate(run.around):
        s, t = ((run.x[nodes] - point) @ np.array([normal, [-normal[1], normal[0]]]).T).T
        size = max(np.ptp(s), np.ptp(t))
        t = np.where(abs(t) < 1e-6 * size, 0.0, t)
        at = list(s[t == 0.0])
        for i, j in zip(range(len(nodes)), [*range(1, len(nodes)), 0]):
            if t[i] * t[j] < 0.0:
                at.append(s[i] + (s[j] - s[i]) * t[i] / (t[i] - t[j]))
        if at and max(at) - min(at) > THROUGH * size:
            found.append(((max(at) + min(at)) / 2, e))
    found.sort()
    return np.array([e for _, e in found], int), np.array([s for s, _ in found])


def draw_residual(figure, run):
    """Stresses sx and sy at the end of the unloaded load case, and the yielded part of the line."""
    axes = figure.subplots()
    chosen, s = below_contact(run)
    yielded = run.accumulated[chosen] > 0.0
    deep = max([DEEP * float(row["half_width"] or 0.0) for row in run.increments] + list(BEYOND * abs(s[yielded]))) or np.inf
    near = abs(s) <= deep
    chosen, s, yielded = chosen[near], s[near], yielded[near]
    apart = np.searchsorted(s, 0.0)   # the lines stop between two bodies
    for key, colour, name in (("sx", BLUE, r"$\sigma_x$"), ("sy", RED, r"$\sigma_y$")):
        axes.plot(np.insert(s, apart, 0.0), np.insert(run.residual[key][chosen], apart, np.nan), "o-", ms=2.5, lw=1.0, color=colour, label=name)
    axes.plot(s[yielded], np.full(yielded.sum(), 0.01), "|", ms=5, color=GREY, transform=axes.get_xaxis_transform(), label="elements yielded")
    axes.axhline(0.0, color=GREY, lw=0.5)
    axes.set(xlabel="distance from the contact, along its normal" + run.length_unit(), ylabel=f"stress of elements, {run.stress_unit()}")
    axes.locator_params(axis="x", nbins=6)
    axes.legend()
    axes.set_title(f"below p_max, {run.unloaded}")
