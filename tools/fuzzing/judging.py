"""Run decks, and find faults of the runs."""
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "independent"))
import deck as deck_reader  # noqa: E402
import tables  # noqa: E402
from verification.check import check, recompute  # noqa: E402
from verification.run import Tables  # noqa: E402
from verification.scene import Scene  # noqa: E402

WORDS = {"valid": 0, "no equilibrium": 1, "overlap": 1, "not converged": 1, "limit load": 1, "contact lost": 0, "not solved": 1, "rejected": 2, "out of memory": 3, "singular stiffness": 4,
         "contact not found": 4, "not certified": 4, "ill-conditioned": 4}
ANSWERS = {"valid", "not converged", "limit load", "not certified", "ill-conditioned"}
BAD_OUTPUT = re.compile(r"Sanitizer|runtime error|Backtrace|Error termination|Fortran runtime|SIG[A-Z]{3,4}\b|glibc|corrupt|IEEE_|internal error")
BAD_NUMBER = re.compile(rb"\bnan\b|\binf(?:inity)?\b|\*\*\*", re.IGNORECASE)
PLACE = re.compile(r":\d+:\d+(?:-\d+)?: ")
RELATIVE = ("equilibrium_residual", "energy_balance")
CERTIFIED = 1e-9
#: Above it rounding may exceed the certificate's tolerance.
BAD_CONDITION = CERTIFIED / sys.float_info.epsilon
#: Fraction of the terms of a gap up to which it counts as zero: `negligible` in src/contact.
NEGLIGIBLE = 1e-11
LEAK = re.compile(r"LeakSanitizer")
# Messages of tools/verify for decks that it does not support.
NOT_UNDERSTOOD = (deck_reader.DeckError, OverflowError, ZeroDivisionError)


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return math.nan


class Run:
    """One run of some decks, in a directory of its own."""

    def __init__(self, program, names, place, out, seconds, options=()):
        self.names, self.out = names, out
        environment = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", UBSAN_OPTIONS="print_stacktrace=1",
                           ASAN_OPTIONS="detect_leaks=1:quarantine_size_mb=16")
        command = [program, *(f"{name}.dat" for name in names), "-o", str(out), "--tables", "all", *options]
        try:
            done = subprocess.run(command, capture_output=True, timeout=seconds, cwd=place, env=environment, check=False,
                                  stdin=subprocess.DEVNULL)
            self.status, self.out_text, self.err_text = done.returncode, done.stdout, done.stderr
        except subprocess.TimeoutExpired:
            self.status, self.out_text, self.err_text = None, b"", b""
        self.said = self.out_text.decode("latin-1").split("\n")
        self.messages = self.err_text.decode("latin-1")

    def fault(self):
        """Fault of the run as a whole."""
        if self.status is None:
            return "no end within the time limit"
        if LEAK.search(self.messages):
            return "leak"
        if BAD_OUTPUT.search(self.messages):
            return "message of a sanitizer or of the runtime: " + BAD_OUTPUT.search(self.messages)[0]
        if self.status < 0:
            return f"ended by signal {-self.status}"
        if self.status not in range(5):
            return f"exit status {self.status}"
        words = [self.word(name) for name in self.names]
        known = [WORDS[word] for word in words if word in WORDS]
        if len(known) < len(words) and self.status < 3:
            return f"exit status {self.status} without a word about a deck"
        if known and len(known) == len(words) and max(known) != self.status:
            return f"exit status {self.status}, words say {max(known)}"
        if list(self.out.glob("*.part")):
            return "a temporary file is left"
        return None

    def word(self, name):
        """Line of standard output for a deck."""
        lines = [line[len(name) + 2:] for line in self.said if line.startswith(name + "  ")]
        cases = self.words_of_cases(name)
        if cases and not lines and set(cases) <= set(WORDS):
            return max(cases, key=WORDS.get)
        if len(lines) != 1:
            return None
        return re.sub(r" (?:at|after) load factor .*", "", lines[0].split("  ")[0])

    def words_of_cases(self, name):
        """Lines for each of several load cases."""
        found = [re.match(re.escape(name) + r" SUBCASE \d+  (.*?)(?:  |$)", line) for line in self.said]
        return [re.sub(r" (?:at|after) load factor .*", "", one[1]) for one in found if one]

    def told(self, name):
        """Lines of standard error for a deck: from the first line that names it to the next deck."""
        lines, ours = [], len(self.names) == 1
        for line in self.messages.split("\n"):
            found = re.match(r"(?:\./)*(\w+)\.(?:dat|inc)\b", line)
            if found:
                ours = found[1] == name
            if ours:
                lines.append(line)
        return lines


def fault_of_deck(run, name, tolerance):
    """Fault in the output and files of one deck; None if they are correct."""
    word, told = run.word(name), run.told(name)
    files = {path.name[len(name):]: path.read_bytes() for path in run.out.glob(f"{name}.*")}
    for suffix, text in files.items():
        if BAD_NUMBER.search(re.sub(rb"(?m)^(?:TITLE|SUBTITLE|LABEL|  ).*$", b"", text) if suffix == ".lst" else text):
            return f"{suffix} has {BAD_NUMBER.search(text)[0].decode()}"
        if not text.endswith(b"\n"):
            return f"{suffix} does not end with a line"
    if word is None:
        return None if run.status == 3 and told else "no word"
    if word not in WORDS:
        return f"says `{word}`"
    if word == "rejected":
        return "rejected, but there are results" if files else fault_of_messages(told)
    cases = run.words_of_cases(name)
    if cases:   # tools/verify checks the content of their tables
        said = re.findall(rb"^\d+,status,(.*?),", files.get(".summary.csv", b""), re.M)
        if sorted(text.decode() for text in said) != sorted(cases):
            return "the summary says other words of its cases"
        if sorted(rows[0]["status"] for rows in cases_of(run, name, "cases").values()) != sorted(cases):
            return "the table of cases says other words"
        return fault_of_sequence(run, name) or next(filter(None, (
            fault_of_certificate(run, name, tolerance, case) for case, values in cases_of(run, name, "summary").items()
            if {row["key"]: row["value"] for row in values}["status"] == "valid")), None)
    for suffix in (".lst", ".summary.csv") + (".contact.csv", ".nodes.csv", ".history.csv") * (word in ANSWERS):
        if suffix not in files:
            return f"{word} without {suffix}"
    if word not in ANSWERS and len(files) > 2:
        return f"{word}, but there are tables"
    if f"status,{word},".encode() not in files[".summary.csv"]:
        return "the summary says another word"
    if (b"*NOT VALID" in files[".lst"]) != (word != "valid"):
        return f"{word}, but the listing's mark says otherwise"
    if any(line for line in told if re.search(r"\d errors?\b", line)):
        return f"{word}, but there are errors"
    if (word == "valid") and any(not PLACE.search(line) and "warning" not in line and line[:1] not in " " for line in told if line):
        return "valid, but standard error says more: " + told[0]
    if word != "valid" and not told:
        return f"{word} without a message"
    return fault_of_certificate(run, name, tolerance) if word == "valid" else None


def fault_of_messages(told):
    """Check that every error has a position (or the deck) and a remedy, and that the last line counts them."""
    told = [line for line in told if line]
    if not told or not re.search(r": \d+ errors?\b", told[-1]):
        return "rejected without a count of errors"
    headings = [k for k, line in enumerate(told[:-1]) if line[:1] != " "]
    if not headings:
        return "rejected without a message"
    for first, last in zip(headings, headings[1:] + [len(told) - 1]):
        rest = told[first + 1:last]
        if not PLACE.search(told[first]) and not (rest and rest[-1].strip()):
            return "no remedy: " + told[first]
        if PLACE.search(told[first]) and not (rest and re.match(r" +\^+ \S", rest[-1])):
            return "no remedy: " + told[first]
    return None


def rows_of(run, name, table):
    return tables.rows(run.out / f"{name}.{table}.csv")


def cases_of(run, name, table):
    """Rows of each load case; none if there is no such table."""
    found = {}
    for row in rows_of(run, name, table) if (run.out / f"{name}.{table}.csv").exists() else []:
        found.setdefault(row["subcase"], []).append(row)
    return found


def summary_of(run, name, case=None):
    if case is None:
        return tables.summary(run.out / f"{name}.summary.csv")
    return {row["key"]: row["value"] for row in cases_of(run, name, "summary")[case]}


def fault_of_sequence(run, name):
    """The increments of each load case follow each other, up to 1 if it is valid, and no accumulated plastic strain becomes smaller."""
    for case, rows in cases_of(run, name, "increments").items():
        factors = [number(row["load_factor"]) for row in rows]
        if any(not a < b for a, b in zip([0.0] + factors, factors)):
            return f"SUBCASE {case}: load factors do not grow"
        if summary_of(run, name, case)["status"] == "valid" and factors[-1] != 1.0:
            return f"SUBCASE {case}: valid, with a load factor of {factors[-1]}"
    before = {}
    for case, rows in cases_of(run, name, "plastic").items():
        now = {row["element"]: number(row["accumulated"]) for row in rows}
        largest = max(now.values(), default=0.0)
        if any(now.get(element, 0.0) < value - 1e-12 * largest for element, value in before.items()):
            return f"SUBCASE {case}: accumulated plastic strain has become smaller"
        before = now
    return None


def fault_of_certificate(run, name, tolerance, case=None):
    """Compare the values of the certificate with its tolerance."""
    summary = summary_of(run, name, case)
    for key in RELATIVE:
        if not number(summary.get(key)) <= tolerance:
            return f"valid with {key} = {summary.get(key)}"
    if not number(summary.get("stress_off_curve")) <= max(tolerance, number(summary.get("stress_off_curve_limit"))):
        return f"valid with stress_off_curve = {summary.get('stress_off_curve')}"
    rows = tables.of_case(rows_of(run, name, "contact"), case)
    if rows:
        force = max(abs(number(row["force"])) for row in rows) or 1.0
        length = max([abs(number(row["initial_gap"])) for row in rows] + [abs(number(summary.get("max_displacement")))]) or 1.0
        if not number(summary.get("smallest_force")) >= -tolerance * force:
            return f"valid with smallest_force = {summary.get('smallest_force')}"
        if not number(summary.get("smallest_gap")) >= -tolerance * length:
            return f"valid with smallest_gap = {summary.get('smallest_gap')}"
    return None


def read_back(run, name, place):
    """The deck, and the tables of its run."""
    tables = Tables(run.out, name)
    normals = {pair: (float(row["nx"]), float(row["ny"])) for pair, row in tables.contact.items()}
    return Scene(deck_reader.read(place / f"{name}.dat"), normals), tables


def fault_of_answer(run, name, place, tolerance):
    """Recompute the certificate from deck and tables by tools/verify; None also if it does not support the deck, and for
    several load cases, which tools/verify recomputes one by one from the command line."""
    if run.words_of_cases(name):
        return None
    try:
        scene, tables = read_back(run, name, place)
        lines, faults = check(scene, tables, tolerance)
    except NOT_UNDERSTOOD:
        return None
    except (OSError, KeyError, ValueError, IndexError, TypeError) as error:
        if any(" is farther from the middle of its side" in line for line in run.told(name)):
            return None  # There the opposite points of an edge are found otherwise.
        return f"verify: {type(error).__name__} {error}"
    return "verify: " + next(line for line in lines if line.endswith("WRONG")) if faults else None


def just_beyond(run, name):
    """Is an answer rejected for a stress error slightly above its limit, of which half is rounding?"""
    summary = summary_of(run, name)
    off, limit, asked = [number(summary.get(key)) for key in ("stress_off_curve", "stress_off_curve_limit", "curve_tolerance")]
    return limit >= 2 * asked and off <= 1.5 * limit and all(number(summary.get(key)) <= CERTIFIED for key in RELATIVE)


def lost_on_a_travel(run, name):
    """Is an answer rejected for penetrations within the rounding of a prescribed rigid-body displacement?"""
    summary = summary_of(run, name)
    travel = max((abs(number(value)) for key, value in summary.items() if key.startswith("approach")), default=0.0)
    return NEGLIGIBLE * travel >= -number(summary["smallest_gap"]) > 0.0


def far_apart(deck):
    """Do the stiffnesses of sections (modulus times thickness) differ so much that rounding of one may hide another?"""
    try:
        cards = deck_reader.read(deck)
        modulus = {int(card[1]): deck_reader.real(card[2]) for card in cards.of("MAT1")}
        stiffness = [modulus[int(card[2])] * deck_reader.real(card[3]) for card in cards.of("PSHELL")]
    except (*NOT_UNDERSTOOD, KeyError, ValueError, IndexError):
        return False
    return max(stiffness, default=0.0) > BAD_CONDITION * min(stiffness, default=0.0)


def fault_of_twin(run, name, other, twin, place, tolerance):
    """Two equivalent decks must give the same results, within the digits that conditioning and prescribed displacements leave."""
    one, two = run.word(name), other.word(twin)
    # Rounding and the smallest pivot depend on the order: with a bad condition, only one deck may be just below a limit.
    # With a very bad condition, even a certain non-equilibrium may look like rigid bodies.
    if {one, two} in ({"valid", "ill-conditioned"}, {"valid", "not certified"}, {"not certified", "not converged"}, {"not certified", "overlap"}) \
            and number(summary_of(*((run, name) if one in ANSWERS else (other, twin)))["condition"]) > BAD_CONDITION:
        return None
    # Also if a prescribed displacement leaves few digits of stresses or gaps: rounding puts one deck above the limit, the other below.
    if {one, two} == {"valid", "not certified"}:
        refused = (run, name) if two == "valid" else (other, twin)
        if just_beyond(*refused) or lost_on_a_travel(*refused):
            return None
    if {one, two} == {"valid", "contact not found"} and far_apart(place / f"{name}.dat"):
        return None
    if {one, two} == {"ill-conditioned", "not converged"}:   # rounding affects both
        return None
    # Far from its answer a method may amplify rounding from step to step: one deck ends just within the limit, one just beyond.
    if {one, two} == {"valid", "not converged"}:
        steps, most = sorted(len(rows_of(*answer, "history")) for answer in ((run, name), (other, twin)))
        if steps >= 0.75 * most:
            return None
    # Above a limit load, rounding decides which of two rejections is reported.
    if {one, two} < {"limit load", "not converged", "singular stiffness", "not certified"} \
            and any("limit load" in "".join(told) for told in (run.told(name), other.told(twin))):
        return None
    if WORDS.get(one) != WORDS.get(two):
        return f"twin: {one}, {two}"
    if one != "valid":
        return None
    condition = summary_of(run, name)["condition"]
    bound = max(tolerance, 1e-13 * number(condition))
    # Iterations reach the same tolerance on different paths: TOL of the displacements is a tenth of that of the curve. Each
    # reports its iteration error as an estimate.
    left = number(summary_of(run, name)["curve_tolerance"])
    if left > CERTIFIED:
        told = sum(number(summary_of(*answer)["iteration_error_displacement"]) for answer in ((run, name), (other, twin)))
        bound = max(bound, left / 10, 3 * told)
    listings = [(a.out / f"{b}.lst").read_text(encoding="latin-1") for a, b in ((run, name), (other, twin))]
    if any("force not unique" in listing for listing in listings):
        return None
    compared = [("nodes", "node", ("ux", "uy")), ("elements", "element", ("sx", "sy", "sz", "txy"))]
    if any("its value is the smallest that the gaps allow" in listing for listing in listings):
        compared = compared[1:]   # end of the unconstrained distance at which a body stops
    for table, key, columns in compared:
        ours, theirs = ({row[key]: row for row in rows_of(a, b, table)} for a, b in ((run, name), (other, twin)))
        if ours.keys() != theirs.keys():
            return f"twin: other {table}"
        # The mean stress of a bent element may be zero.
        size = columns + ("equivalent_stress",) * (table == "elements")
        scale = max((abs(number(row[column])) for row in ours.values() for column in size), default=0.0)
        worst = max((abs(number(ours[k][column]) - number(theirs[k][column])) for k in ours for column in columns), default=0.0)
        if worst > bound * scale:
            try:
                bound += 10 * recompute(*read_back(run, name, place)).lost
            except NOT_UNDERSTOOD:   # the lost digits of a prescribed displacement are not reported
                bound = math.inf
        if math.isfinite(bound) and not worst <= bound * scale:
            return f"twin: {table} differ by {worst:.1E} of {scale:.1E} (condition {condition})"
    return None


def fresh(directory):
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    return directory
