"""Decks as cards, and cards as text; the columns, from the program's own catalogue."""
import re
import subprocess
from dataclasses import dataclass, field


@dataclass
class Card:
    name: str
    data: list   # fields 2 to 9, 12 to 19, ...: as many as needed

    def copy(self):
        return Card(self.name, list(self.data))


@dataclass
class Deck:
    """`head`: the lines up to BEGIN BULK."""
    head: list = field(default_factory=list)
    cards: list = field(default_factory=list)

    def of(self, *names):
        return [card for card in self.cards if card.name in names]


def parse(text):
    """The cards of a deck without INCLUDE; what cannot be told apart goes with the card before it."""
    deck, lines = Deck(), [line.split("$")[0].rstrip() for line in text.splitlines()]
    begin = next((k for k, line in enumerate(lines) if line.upper().split() == ["BEGIN", "BULK"]), None)
    if begin is not None:
        deck.head, lines = lines[:begin + 1], lines[begin + 1:]
    for line in lines:
        if line.strip().upper() == "ENDDATA":
            break
        if not line.strip():
            continue
        name, data = fields(line.upper())
        if (name == "" or name[0] in "+*") and deck.cards:
            deck.cards[-1].data += data
        else:
            deck.cards.append(Card(name.rstrip("*").strip(), data))
    return deck


def fields(line):
    """Name and data fields of one line."""
    if "," in line:
        parts = [part.strip() for part in line.split(",")]
        most = 4 if "*" in parts[0] else 8
        return parts[0], (parts[1:most + 1] + [""] * most)[:most]
    line = line.ljust(80)
    name = line[:8].strip()
    wide = 16 if "*" in name else 8
    return name, [line[at:at + wide].strip() for at in range(8, 72, wide)]


def write(card, form):
    """The lines of a card in a form: small, large or free. What does not fit makes the card a free one."""
    data = list(card.data)
    while len(data) > 1 and data[-1] == "":
        data.pop()
    widest = max(map(len, data), default=0)
    if widest > 16 or (form == "small" and widest > 8) or (form == "large" and len(card.name) > 7):
        form = "free"
    if form == "free":
        rows = [data[k:k + 8] for k in range(0, len(data), 8)]
        return [",".join([card.name if k == 0 else ""] + row) for k, row in enumerate(rows)]
    if form == "small":
        rows = [data[k:k + 8] for k in range(0, len(data), 8)]
        return [((card.name if k == 0 else "").ljust(8) + "".join(text.ljust(8) for text in row)).rstrip()
                for k, row in enumerate(rows)]
    rows = [data[k:k + 4] for k in range(0, (len(data) + 7) // 8 * 8, 4)]
    return [((card.name + "*" if k == 0 else "*").ljust(8) + "".join(text.ljust(16) for text in row)).rstrip()
            for k, row in enumerate(rows)]


def text_of(deck, forms, pick, end=True):
    """A deck whose cards are written in these forms, in turn or mixed."""
    lines = list(deck.head)
    for card in deck.cards:
        lines += write(card, pick.choice(forms))
    return "\n".join(lines + ["ENDDATA"] * end) + "\n"


@dataclass
class Column:
    name: str
    kind: str      # integer, real, word, digits, any; empty where the field must be blank
    choices: list


class Catalogue:
    """What `epcont --cards` prints of every card."""

    def __init__(self, program):
        def ask(*name):
            return subprocess.run([program, "--cards", *name], capture_output=True, text=True, check=True).stdout.splitlines()

        self.names = [line.split()[0] for line in ask()]
        self.columns, self.lists = {}, {}
        for name in self.names:
            self.columns[name] = []
            for line in ask(name):
                match = re.match(r"(\d+)(\.\.)?\s+\d+-\d+\s", line)
                if not match:
                    continue
                kind = line[23:30].strip()
                words = re.findall(r"\b[A-Z]{4,}\b", line[47:].split(";")[-1]) if kind == "word" else []
                if match[2]:
                    self.lists[name] = len(self.columns[name])
                self.columns[name].append(Column(line[16:22].strip(), kind, words))
        self.parameters = {}
        lines = ask("PARAM")
        for line in lines[lines.index("NAME      VALUE") + 1:]:
            name, said = line.split(None, 1)
            words = re.findall(r"\b[A-Z]{2,}\b", said.split(":")[0])
            kind = "word" if words else "integer" if "whole" in said else "real" if "a real" in said else "word"
            self.parameters[name] = Column(name, kind, words)

    def column(self, name, slot):
        """What stands in a slot of a card."""
        columns = self.columns.get(name)
        if not columns:
            return Column("", "any", [])
        if slot < len(columns):
            return columns[slot]
        if name in self.lists:
            return columns[self.lists[name]]
        return Column("", "", [])
