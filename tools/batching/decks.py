"""The decks of a batch: their paths, the paths of their results, and their content."""
import argparse
import csv
import hashlib
import io
import os
import re
from dataclasses import dataclass, field

from wording import counted

INCLUDE = re.compile(rb"""[ ]*include[ ]*(['"])(.*?)\1[ ]*(?:\$.*)?\r?$""", re.IGNORECASE)
DEEPEST = 8      # as in the program
MOST_FILES = 10000
NO_NAME = ("-", "=", "+", "@")   # the program would take the name for an option, a spreadsheet for a formula


class Refused(Exception):
    """An error of the call or of a list: nothing is run."""


class Parser(argparse.ArgumentParser):
    def __init__(self, words=None, **more):
        super().__init__(description=words, formatter_class=argparse.RawDescriptionHelpFormatter, **more)

    def error(self, message):   # argparse's own exit status would be 2
        raise Refused(f"{message}; see --help")


@dataclass
class Deck:
    path: str                                    # as given to the program and shown in messages
    place: str = ""                              # path of its results below the folder of the batch, without suffix
    rows: list = field(default_factory=list)     # for a list that is a table: [number, further columns] of each row of the deck
    size: int = 0                                # bytes, including its INCLUDE files
    digest: str = ""                             # digest of its content, if it includes no files
    stamp: tuple = ()                            # file state when the digest was read


def read_list(path):
    """Read the decks of a list with one path per line, or of a table (.csv) with a column `deck`; paths are relative to the folder of the list."""
    folder = os.path.dirname(path) if os.path.isfile(path) else ""
    try:
        with open(path, encoding="utf-8-sig", errors="surrogateescape", newline="") as file:
            text = file.read()
    except (OSError, ValueError) as error:
        raise Refused(f"{path}: the list cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if "\0" in text:
        raise Refused(f"{path}:{text[:text.index(chr(0))].count(chr(10)) + 1}: not a text: write one path per line")
    decks = read_table(path, text) if path.endswith(".csv") else read_lines(text)
    if not decks:
        raise Refused(f"{path}: no deck in the list: write one path per line")
    for deck in decks:
        deck.path = os.path.normpath(os.path.join(folder, deck.path))
    return decks


def read_lines(text):
    lines = (line.strip() for line in text.split("\n"))
    return [Deck(line) for line in lines if line and not line.startswith(("#", "$"))]


def read_table(path, text):
    rows, columns = rows_of(path, text)
    if "deck" not in columns:
        raise Refused(f"{path}:1: no column `deck`: add it")
    for line, row in rows:
        if not row["deck"]:
            raise Refused(f"{path}:{line}: the deck has no name: give one")
    return [Deck(row.pop("deck"), rows=[[number, row]]) for number, (_, row) in enumerate(rows)]


def rows_of(path, text):
    """Read a table: (line, values by column) of each row, and its columns."""
    reader, rows = csv.DictReader(io.StringIO(text, newline=""), strict=True), []
    try:
        columns = reader.fieldnames = [(name or "").strip() for name in reader.fieldnames or []]
        if not columns or not all(columns) or len(set(columns)) < len(columns):
            raise Refused(f"{path}:1: not a header: give each column a name, and each name only once")
        for row in reader:
            if None in row or None in row.values():
                raise Refused(f"{path}:{reader.line_num}: wrong number of values: give {len(columns)}, one per column")
            rows.append((reader.line_num, row))
    except csv.Error as error:
        raise Refused(f"{path}:{reader.line_num}: {error}") from None
    return rows, columns


def arrange(decks):
    """List each deck once, with all its rows and the place of its results. The folders of the decks are mirrored, starting at
    the deepest folder that they have in common."""
    single = {}
    for deck in decks:
        if not deck.path.strip("/"):
            raise Refused("a deck has no name: give one")
        first = single.setdefault(os.path.abspath(deck.path), deck)
        if first is not deck:
            first.rows += deck.rows
    common = os.path.commonpath([os.path.dirname(path) for path in single])
    places = {}
    for path, deck in single.items():
        deck.place = os.path.relpath(os.path.splitext(path)[0], common)
        if deck.path.startswith(NO_NAME):
            deck.path = "./" + deck.path
        if deck.place in places:
            raise Refused(f"{places[deck.place].path} and {deck.path} would write the same files: rename one of them")
        places[deck.place] = deck
    return list(single.values())


def contents(path, depth=0, seen=None):
    """Read all bytes of a deck, then of its INCLUDE files; unreadable files count as empty."""
    seen = seen if seen is not None else []
    seen.append(path)
    try:
        with open(path, "rb") as file:
            text = file.read()
    except (OSError, ValueError):
        yield b"-"
        return
    yield b"%d " % len(text)
    yield text
    for name in included(text):
        if depth < DEEPEST and len(seen) <= MOST_FILES:
            yield from contents(os.path.join(os.path.dirname(path), os.fsdecode(name)), depth + 1, seen)


def included(text):
    """Names in INCLUDE lines. (A search for the word is 50 times as fast as the pattern on every line.)"""
    lower = text.lower()
    at = lower.find(b"include")
    while at >= 0:
        end = text.find(b"\n", at)
        match = INCLUDE.match(text[text.rfind(b"\n", 0, at) + 1:end if end >= 0 else len(text)])
        if match:
            yield match[2]
        at = lower.find(b"include", at + 1)


def stamp_of(path):
    try:
        found = os.stat(path)
    except (OSError, ValueError):
        return ()
    return found.st_mtime_ns, found.st_size, found.st_ino


def look_at(deck):
    """Read a deck for the first time: its size and its digest."""
    deck.stamp = stamp_of(deck.path)
    digest, deck.size = fingerprint(deck.path)
    alone = deck.stamp and deck.size == deck.stamp[1] + len(f"{deck.stamp[1]} ")   # no INCLUDE
    deck.digest = digest if alone else ""


def inputs_of(deck):
    """Current digest of a deck; it is computed again only if the file has changed."""
    return deck.digest if deck.digest and stamp_of(deck.path) == deck.stamp else fingerprint(deck.path)[0]


def fingerprint(path):
    """Digest of a deck with all its INCLUDE files, and their total size [bytes]."""
    digest, size = hashlib.blake2b(digest_size=16), 0
    if not os.path.isfile(path):   # reading a pipe would block
        return "", 0
    for part in contents(path):
        digest.update(part)
        size += len(part)
    return digest.hexdigest(), size
