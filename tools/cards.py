"""Cards as text: the fields of a line, a real in a field, and the fields according to the program's catalogue."""
import re
import subprocess
from dataclasses import dataclass
from decimal import Decimal

FIRST, LAST = 8, 72   # data columns in fixed format
MOST_DIGITS = 17


def is_wide(line):
    """Does a line have fields of 16 columns, or four between commas?"""
    return "*" in line[:FIRST].split(",")[0]


def places(line):
    """Positions of the data fields of a line, as slices; in free format only those that exist."""
    most = 4 if is_wide(line) else 8
    if "," in line:
        ends = [match.start() for match in re.finditer(",", line)] + [len(line)]
        return [slice(a + 1, b) for a, b in zip(ends, ends[1:most + 1])]
    step = (LAST - FIRST) // most
    return [slice(at, at + step) for at in range(FIRST, LAST, step)]


def fields(line):
    """Name and data fields (four or eight) of one line."""
    name = line.partition(",")[0] if "," in line else line[:FIRST]
    data = [line[place].strip() for place in places(line)]
    return name.strip(), data + [""] * ((4 if is_wide(line) else 8) - len(data))


def written(value, width=None):
    """A real with a decimal point and as many digits as `width` columns hold; it has an exponent (`1.5-7`) if space is short or it is far from 1.

    ValueError if no real of this width is near."""
    value = Decimal(value)
    for digits in range(MOST_DIGITS, 0, -1):
        for text in spellings(value, digits):
            if width is None or len(text) <= width:
                return text
    raise ValueError(f"{width} columns cannot hold {value}")


def spellings(value, digits):
    """A number rounded to some digits: without exponent if this is usual, and with exponent."""
    if not value:
        yield "0."
        return
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    if -5 < int(exponent) < max(digits, 8):
        text = f"{Decimal(f'{mantissa}E{exponent}'):f}"
        text = text.rstrip("0") if "." in text else text + "."
        yield re.sub(r"^(-?)0\.", r"\1.", text)
    mantissa = mantissa.rstrip("0") if "." in mantissa else mantissa + "."
    yield f"{mantissa}{int(exponent):+d}"


@dataclass
class Column:
    name: str
    kind: str      # integer, real, word, digits, any; empty if the field must be blank
    choices: list


class Catalogue:
    """Read the output of `epcont --cards` for every card."""

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
                kind = line[25:32].strip()
                words = re.findall(r"\b[A-Z]{4,}\b", line[49:].split(";")[-1]) if kind == "word" else []
                if match[2]:
                    self.lists[name] = len(self.columns[name])
                self.columns[name].append(Column(line[16:24].strip(), kind, words))
        self.parameters = {}
        lines = ask("PARAM")
        for line in lines[lines.index("NAME      VALUE") + 1:]:
            name, said = line.split(None, 1)
            words = re.findall(r"\b[A-Z]{2,}\b", said.split(":")[0])
            kind = "word" if words else "integer" if "whole" in said else "real" if "a real" in said else "word"
            self.parameters[name] = Column(name, kind, words)

    def column(self, name, slot):
        """Field of a card."""
        columns = self.columns.get(name)
        if not columns:
            return Column("", "any", [])
        if slot < len(columns):
            return columns[slot]
        if name in self.lists:
            return columns[self.lists[name]]
        return Column("", "", [])
