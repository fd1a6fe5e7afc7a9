"""Page section of part 5."""
from growth import MEMORY_POWER, TIME_POWER
from report_words import exponent, short, table


def result(side, what):
    """Measured value of a program; the exit status if it gave no answer."""
    if side is None:
        return ""
    return short(side[what]) if side["status"] == 0 else f"status {side['status']}"


def own(side, what, wanted):
    """Measured value of epcont, with the required one if it is not met."""
    return verdict(side[what], wanted) if side["status"] == 0 else result(side, what)


def verdict(found, wanted, least=False):
    """Measured value, with the required one if it is not met."""
    if found is None or wanted is None:
        return short(found) if found is not None else ""
    met = found >= wanted if least else found <= wanted
    return short(found) + ("" if met else f" (wanted {wanted:g})")


def scenes(rows, version):
    lines = []
    for row in rows:
        ours, wanted, several, cases = row["ours"], row["wanted"], row["threads"] > 1, row.get("cases", 1) > 1
        lines.append([row["scene"], row["nodes"], row["pairs"], row["bodies"], row["runs"], own(ours, "cpu", wanted["cpu"]), result(ours, "wall"),
                      own(ours, "memory", wanted["memory"]), result(row["beside"], "cpu"), result(row["beside"], "memory"),
                      "" if several or cases else verdict(row["part"], wanted["part"]), "" if several else verdict(row["lean"], wanted["lean"]),
                      verdict(row["part"], wanted["part"], least=True) if several else "",
                      verdict(row["part"], wanted["part"]) if cases else ""])
    other = f"version {version}" if version else "none"
    return ["### Models", "Whole runs: seconds of processor and of wall, peak memory in MB; medians, and ratios of the medians of each turn, "
            f"over another epcont beside it ({other}). What was wanted and is not met stands in brackets; runs of a minute or more are made once. Status 124: not ended in 20 minutes (with `--quick` in one).",
            table(["scene", "nodes", "pairs", "bodies", "runs", "CPU, s", "wall, s", "MB", "beside, CPU s", "MB", "ratio of CPU", "of memory",
                   "times as fast on two threads, by the clock", "CPU of all load cases over one"], lines)]


def growth(found):
    lines = [[kind, row["unknowns"], row["pairs"], short(row["cpu"]), short(row["memory"]), f"{row['operations']:.1e}", short(row["forecast_memory"])]
             for kind, rows in found.items() for row in rows]
    powers = [[kind, *(verdict(exponent([(row["unknowns"], row[what]) for row in rows]), wanted)
                       for what, wanted in (("cpu", TIME_POWER), ("memory", MEMORY_POWER)))] for kind, rows in found.items() if len(rows) > 1]
    return ["### Growth with the pairs", "Blocks, elastic: whole processes, and what `--plan` states. A row ends before a size of which that is more "
            "than 3E12 operations or 16 GB (with `--quick` 1.6E11 or 4 GB).",
            table(["", "unknowns", "pairs", "CPU, s", "MB", "operations", "forecast, MB"], lines), "Powers of the unknowns, least squares:",
            table(["", "CPU", "memory"], powers)]


def peers(rows):
    names = list(dict.fromkeys(name for row in rows for name in row["theirs"]))
    lines = [[row["equations"], short(row["ours"]), *(cell for name in names for cell in (
        (short(row["theirs"][name]["seconds"]), verdict(row["theirs"][name]["ratio"], row["wanted"])) if name in row["theirs"] else ("", "")))]
        for row in rows]
    return ["### Order, factor and two solves", "Two cylinders, elastic: seconds of processor on the same system, of epcont and of CHOLMOD (OpenBLAS) and PARDISO (MKL), which "
            "get the matrix ready made; ratio: epcont's over theirs.",
            table(["equations", "epcont, s", *(cell for name in names for cell in (f"{name.replace(', forward', '')}, s", "ratio"))], lines)]


def calculix(rows):
    lines = [[row["scene"], "yielding" if row["yielding"] else "elastic", short(row["ours"]), short(row["ccx"]) if row["best"] else "",
              verdict(row["ratio"], row["wanted"], least=True) if row["best"] else "", short(row["lean"]) if row["best"] else "", row["best"] or "",
              "; ".join(f"{setting['setting']}: {setting['note']}" for setting in row["tried"] if setting["note"])] for row in rows]
    return ["### Many pairs beside CalculiX", "One mesh, whole runs, seconds of processor; the fastest of four settings whose approach is within 1 % of epcont's (yielding: 6 %). "
            "Penalty contact, 50 E a mm stiff; plasticity is flow theory there. Ratios: CalculiX's over epcont's.",
            table(["scene", "", "epcont, s", "CalculiX, s", "ratio", "of memory", "setting", "without an answer"], lines)]


def large(rows):
    """All available tables of part 5."""
    text = ["## Many pairs, many bodies, many unknowns"]
    text += scenes(rows["scenes"], rows.get("beside")) if "scenes" in rows else []
    text += growth(rows["growth"]) if "growth" in rows else []
    text += peers(rows["peers"]) if "peers" in rows else []
    text += calculix(rows["calculix"]) if "calculix" in rows else []
    return "\n\n".join(text)
