"""The result of one deck: its row of the table, from the end of the run, its messages and its files."""
import csv
import os
import re
import signal

COLUMNS = ["deck", "status", "exit_status", "message", "seconds", "memory_MB", "nodes", "p_max", "p_max_is", "approach", "approach_dof", "p_max_error",
           "half_width", "half_width_error", "certificate", "certificate_part", "warnings", "first_warning"]
#: Further columns of tables with load cases.
CASE_COLUMNS = ["subcase", "subtitle", "label"]
#: With --one-table: prefixes of summary values, and values that already have a column.
SUMMARY = "summary_"
TAKEN = ("status", "warnings", "max_pressure", "max_pressure_is")
ANSWERED = {"valid", "no equilibrium", "overlap", "not converged", "limit load", "singular stiffness", "contact not found", "ill-conditioned",
            "not certified", "contact lost", "not solved"}   # last words of a complete listing
VALID = ("valid", "contact lost")   # exit status 0
NOT_RUN = "not run"
KILLED = "killed"              # sent from outside: the deck may be run again
NO_FAULT = re.compile(r": warning: |: \d+ warnings?(?: \(\d+ shown\))?$")
NODES = re.compile(r"^  (\d+) nodes?,", re.MULTILINE)
CERTIFICATE = re.compile(r"^CERTIFICATE .*tolerance (\S+?)\).*\n((?:  .*\n)+)", re.MULTILINE)
FIGURE = re.compile(r"^  (\S.*?)  +(< )?([+-]?\d[\d.E+-]*)$")


def row_of(deck, stem, ended, one_table=False):
    """Make the row of a deck whose run has ended (`ended`: see running.Ended); `one_table` adds all values of its summary."""
    row = dict.fromkeys(COLUMNS, "")
    row.update(deck=deck.path, exit_status=ended.code if ended.code >= 0 else "",
               seconds=f"{ended.seconds:.3f}", memory_MB=f"{ended.memory / 1024:.1f}" if ended.memory else "")
    listing, cases = read_text(stem + ".lst"), read_summary(stem + ".summary.csv")
    words = sorted([summary.get("status", "") for summary in cases.values()] or [""], key=lambda word: (word in VALID, word == "valid"))
    row["status"], row["message"] = judge(ended, listing, words[0])
    if row["status"] in ANSWERED:
        words = titles(deck.path) if len(cases) > 1 else {}
        found = [{**case_row(case, listing, summary, ended, one_table), **words.get(case, {})} for case, summary in cases.items()]
        row.update({"cases": found} if len(cases) > 1 else found[0])
    return row


def case_row(case, listing, summary, ended, one_table):
    """Make the columns of a load case; `case`: its number, empty if there is only one."""
    row = {}
    if case:
        row = {"subcase": case, "status": summary.get("status", ""),
               "message": first_fault("\n".join(line for line in ended.said.splitlines() if f" SUBCASE {case}: " in line))}
        listing = part_of(listing, case)
    row.update(figures(listing, summary))
    if one_table:
        row.update((f"{SUMMARY}{key}", value) for key, value in summary.items() if key not in TAKEN)
    return row


def titles(path):
    """Read SUBTITLE and LABEL of each SUBCASE, by number; those before the first SUBCASE apply to all."""
    found, now = {}, {"subtitle": "", "label": ""}
    of_all = now
    for line in re.split(r"(?im)^\s*BEGIN", read_text(path), maxsplit=1)[0].splitlines():
        match = re.match(r"\s*(SUBC|SUBT|LABE)[A-Z]*\s*[\s=]\s*(.*?)\s*$", line, re.IGNORECASE)
        word = match and match[1].upper()
        if word == "SUBC":
            found[match[2]] = now = dict(of_all)
        elif word:
            now["subtitle" if word == "SUBT" else "label"] = match[2]
    return found


def part_of(listing, case):
    """Read the results of a listing that belong to all load cases, and those of one."""
    parts = re.split(r"^(?=SUBCASE \d+$)", listing, flags=re.MULTILINE)
    return parts[0] + next((part for part in parts[1:] if part.startswith(f"SUBCASE {case}\n")), "")


def judge(ended, listing, word):
    """Status and message; `word`: the status in the summary. With several load cases it is that of the first that is not valid."""
    said = first_fault(ended.said)
    if ended.limit:
        return "timed out", f"no end within {ended.limit:g} s"
    if ended.code == -signal.SIGKILL:
        return KILLED, "by SIGKILL: out of memory, or somebody's doing"
    if ended.code == -signal.SIGTERM:   # at a time limit Slurm's first signal also goes to the program
        return KILLED, "by SIGTERM: out of time, or somebody's doing"
    if ended.code < 0:
        return "crashed", f"by {name_of(-ended.code)}" + (f": {said}" if said else "")
    if ended.code == 2:
        return "rejected", said
    if ended.code == 3:
        return "refused", said
    if ended.code not in (0, 1, 4):
        return "internal error", said or f"exit status {ended.code}"
    if not whole(listing, word) or (word in VALID) != (ended.code == 0):
        return "incomplete", f"exit status {ended.code} without a whole listing" + (f": {said}" if said else "")
    return word, said


def name_of(number):
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def whole(listing, word):
    """Is the listing complete? The program renames it when it is finished, so an incomplete one is from another writer."""
    if word not in ANSWERED or not listing.startswith("epcont ") or not listing.endswith("\n"):
        return False
    return "\nACCURACY" in listing if word in VALID else "\n  *NOT VALID*  " in listing


def first_fault(said):
    """First message that is not a warning, with its position."""
    for line in said.splitlines():
        if line.strip() and not line.startswith(" ") and not NO_FAULT.search(line):
            return line.strip()
    return ""


def figures(listing, summary):
    """Make the columns that need a listing."""
    found = {}
    nodes = NODES.search(listing, max(0, listing.find("\nPLAN")))
    if nodes:
        found["nodes"] = nodes[1]
    found["p_max"], found["p_max_is"] = summary.get("max_pressure", ""), summary.get("max_pressure_is", "")
    approach = next((key for key in summary if key.startswith("approach_")), "")
    found["approach"], found["approach_dof"] = summary.get(approach, ""), approach.removeprefix("approach_").replace("_", " ")
    found["half_width"], found["half_width_error"] = half_width(listing, summary)
    error, pressure = number(summary.get("mesh_error_max_pressure")), number(found["p_max"])
    if error is not None and pressure:
        found["p_max_error"] = f"{error / pressure:.3g}"
    found["certificate"], found["certificate_part"] = worst_of_certificate(listing, summary)
    found["warnings"], found["first_warning"] = summary.get("warnings", ""), ""
    if found["warnings"] != "0":
        found["first_warning"] = first_warning(listing)
    return found


def half_width(listing, summary):
    """Pressure of the zone with the largest pressure, and its relative error."""
    section = re.search(r"^CONTACT ZONES .*\n.*\n((?:  .*\n)+)", listing, re.MULTILINE)
    rows = [line.split() for line in section[1].splitlines()] if section else []
    zone = max(rows, key=lambda row: number(row[4]) or -1.0, default=[""])
    width, error = number(zone[-1]), number(summary.get(f"mesh_error_half_width_zone_{zone[0]}"))
    return zone[-1] if width is not None else "", f"{error / width:.3g}" if width and error is not None else ""


def first_warning(listing):
    """First warning, with its position, on one line; warnings of the load case come before those of the deck."""
    sections = re.findall(r"^WARNINGS AND NOTES .*\n((?:  .*\n)+)", listing, re.MULTILINE)
    lines = re.sub(r"\n {4}(?! )", " ", "".join(reversed(sections))).splitlines()
    return next((line.strip() for line in lines if re.match(r"  (?:.*?\d+:\d+(?:-\d+)?: )?warning: ", line)), "")


def worst_of_certificate(listing, summary):
    """Certificate value that is closest to its limit, and their ratio: above 1 the limit is exceeded."""
    block = CERTIFICATE.search(listing, max(0, listing.rfind("\nCERTIFICATE ")))
    if not block:
        return "", ""
    lines = [match.groups() for match in map(FIGURE.match, block[2].splitlines()) if match]
    allowed = {"stress error": number(summary.get("stress_off_curve_limit")),
               "penetration anywhere / tolerance": 1.0, "gap at a loaded pair / tolerance": 1.0}
    parts = [(float(value) / (allowed.get(name) or float(block[1])), name) for name, _, value in lines]
    part, name = max(parts, default=(None, ""), key=lambda each: abs(each[0]))
    return name, "" if part is None else f"{abs(part):.2g}"


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def read_summary(path):
    """Read values by key, for each load case; the number of a single one is empty. Only lines with a quotation mark need the
    csv reader, which is slow."""
    text, cases = read_text(path), {}
    try:
        rows = [line.split(",") for line in text.splitlines()] if '"' not in text else list(csv.reader(text.splitlines()))
    except csv.Error:
        return {}
    several = bool(rows) and rows[0][0] == "subcase"
    for row in rows[1:]:
        if len(row) > several + 1:
            cases.setdefault(row[0] if several else "", {})[row[several]] = row[several + 1]
    return cases


def read_text(path):
    try:
        with open(path, "rb") as file:
            return file.read().decode("latin-1")
    except OSError:
        return ""


def forget(stem):
    """Remove the results of an earlier run, so that they are not taken for this one's."""
    for suffix in (".lst", ".summary.csv"):
        try:
            os.unlink(stem + suffix)
        except OSError:
            pass
