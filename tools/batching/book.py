"""The state of a batch in DIR/.batch: its plan, and journals of finished decks, so that a stopped batch loses nothing.

The plan is written completely or not at all. A journal only grows: one line when a deck begins and one when it ends. An incomplete last
line is ignored. Each process that runs decks has its own journal; the table is made from all journals.
"""
import collections
import contextlib
import csv
import errno
import fcntl
import io
import json
import os

from .decks import Deck, Refused, fingerprint
from .outcome import ANSWERED, CASE_COLUMNS, COLUMNS, KILLED, NOT_RUN, SUMMARY, number

ENDED = {"place", "row", "inputs", "at", "version", "listing"}   # keys of a journal line that records an end
NO_LOCKS = (errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP)


class Book:
    def __init__(self, directory):
        self.directory = directory
        self.folder = os.path.join(directory, ".batch")
        self.plan_path = os.path.join(self.folder, "plan.json")
        self.table_path = os.path.join(directory, "batch.csv")

    def make(self):
        try:
            os.makedirs(self.folder, exist_ok=True)
        except OSError as error:
            raise Refused(f"{self.directory}: cannot be written: {error.strerror}") from None

    def load(self):
        """Read the plan of an earlier call."""
        try:
            with open(self.plan_path, encoding="utf-8") as file:
                plan = json.load(file)
            plan["decks"] = [Deck(*fields) for fields in plan["decks"]]
            if not all(isinstance(deck.rows, list) for deck in plan["decks"]):
                raise ValueError
        except OSError as error:
            raise Refused(f"{self.directory}: no batch was started here ({self.plan_path}: {error.strerror})") from None
        except (ValueError, KeyError, TypeError):
            raise Refused(f"{self.plan_path}: not written by this version of tools/batch: start the batch again without --resume") from None
        return plan

    def save(self, plan):
        decks = [[deck.path, deck.place, deck.rows, deck.size] for deck in plan["decks"]]
        write_whole(self.plan_path, json.dumps({**plan, "decks": decks}, indent=0))

    def journal(self, name):
        return os.path.join(self.folder, f"{name}.journal")

    def stem(self, deck):
        """Path of the results of a deck, without suffix."""
        return os.path.join(self.directory, deck.place)

    def entries(self):
        """Read the journals: the last end of each place, and for places without an end the number of attempts in a process of its own."""
        ends, begun = {}, collections.Counter()
        for name in sorted(os.listdir(self.folder)):
            if name.endswith(".journal"):
                for entry in read_journal(os.path.join(self.folder, name)):
                    begun[entry["place"]] += bool(entry.get("alone"))
                    if "row" in entry and ends.get(entry["place"], entry)["at"] <= entry["at"]:
                        ends[entry["place"]] = entry
        return ends, begun

    def begin(self, decks, resume, version):
        """Move earlier journals away, except the ends to keep; return the decks still to run."""
        for name in os.listdir(self.folder):
            if name.endswith(".journal"):
                with open(os.path.join(self.folder, name), "ab") as file:
                    lock(file.fileno(), self.directory, False)   # written by a task on another machine
        kept = self.kept(decks, version) if resume else []
        write_whole(self.journal("kept"), "".join(json.dumps(entry) + "\n" for entry in kept))
        for name in os.listdir(self.folder):
            if name.endswith((".journal", ".out")) and name != "kept.journal":
                os.unlink(os.path.join(self.folder, name))
        places = {entry["place"] for entry in kept}
        return [deck for deck in decks if deck.place not in places]

    def kept(self, decks, version):
        """Find the ends of decks whose input, listing and program are unchanged."""
        ends, kept = self.entries()[0], []
        for deck in decks:
            entry = ends.get(deck.place)
            if entry and entry["row"]["status"] in ANSWERED and entry["version"] == version \
                    and entry["listing"] == size_of(self.stem(deck) + ".lst") and entry["inputs"] == fingerprint(deck.path)[0]:
                entry["row"]["deck"] = deck.path
                kept.append(entry)
        return kept

    def rows(self, plan, ends):
        """Make the rows of the decks, in the order of the list."""
        found = []
        for deck in plan["decks"]:
            row = ends[deck.place]["row"] if deck.place in ends else \
                {**dict.fromkeys(COLUMNS, ""), "deck": deck.path, "status": NOT_RUN}
            lost = plan.get("lost", {}).get(deck.place)
            if lost and row["status"] in (NOT_RUN, KILLED):
                row = {**row, "status": "lost", "message": lost}
            cases = row.get("cases", [{}])   # load cases
            found += [(number, {**row, **case, **values}) for number, values in deck.rows or [(0, {})] for case in cases]
        return [row for _, row in sorted(found, key=lambda each: each[0])]

    def write_table(self, plan, ends):
        rows, first = self.rows(plan, ends), plan["decks"][0].rows
        cases = CASE_COLUMNS if any("subcase" in row for row in rows) else []
        columns = COLUMNS[:1] + cases + (list(first[0][1]) if first else []) + COLUMNS[1:]
        columns += dict.fromkeys(key for row in rows for key in row if key.startswith(SUMMARY) and key not in columns)
        text = io.StringIO()
        table = csv.writer(text, lineterminator="\n")
        table.writerow(map(no_formula, columns))
        table.writerows([no_formula(row.get(name, "")) for name in columns] for row in rows)
        write_whole(self.table_path, text.getvalue())
        return rows


class Journal:
    """Open and lock the journal. The runs inherit the lock, so that no other batch starts while one of them is alive."""

    def __init__(self, path, wait=False):
        self.path = path
        self.descriptor = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o666)
        lock(self.descriptor, path, wait)
        os.set_inheritable(self.descriptor, True)
        self.add({})   # end an incomplete line

    def add(self, entry):
        line = (json.dumps(entry) + "\n").encode() if entry else b"\n"
        try:
            whole = os.write(self.descriptor, line) == len(line)
        except OSError:
            whole = False
        if not whole:
            raise Refused(f"{self.path}: cannot be written: check that the disk is not full")


@contextlib.contextmanager
def alone(book):
    """Lock the batch against other processes."""
    path = os.path.join(book.folder, "lock")
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
    try:
        lock(descriptor, book.directory, False)
        yield
    finally:
        os.close(descriptor)


def lock(descriptor, what, wait):
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError:
        raise Refused(f"{what}: another tools/batch or one of its runs is still active there: wait for it") from None
    except OSError as error:
        if error.errno not in NO_LOCKS:   # some file systems have no locks
            raise


def read_journal(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            text = file.read()
    except OSError:
        return
    for line in text.split("\n")[:-1]:
        try:
            entry = json.loads(line)
        except ValueError:
            continue
        if isinstance(entry, dict) and isinstance(entry.get("place"), str) and ("row" not in entry or ENDED <= set(entry)):
            yield entry


def write_whole(path, text):
    """Write a file completely or not at all."""
    try:
        with open(path + ".part", "w", encoding="utf-8", errors="surrogateescape", newline="") as file:
            file.write(text)
        os.replace(path + ".part", path)
    except OSError as error:
        with contextlib.suppress(OSError):
            os.unlink(path + ".part")
        raise Refused(f"{path}: cannot be written: {error.strerror}") from None


def no_formula(value):
    """Put an apostrophe before texts that a spreadsheet would take for a formula; numbers are unchanged."""
    if not isinstance(value, str) or not value or value[0].isalnum() or not value.lstrip().startswith(("=", "+", "-", "@")) or number(value) is not None:
        return value
    return "'" + value


def size_of(path):
    try:
        return os.stat(path).st_size
    except OSError:
        return -1
