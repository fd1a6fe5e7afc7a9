"""A deck with placeholders `%name%`: their positions, and the deck with values inserted."""
import os
import re
from dataclasses import dataclass

import cards
from wording import counted

from .fitting import Unfit, digits, fit, number

PLACE = re.compile(r"%([A-Za-z_]\w*)%")
INCLUDE = re.compile(r"""([ ]*include[ ]*)(['"])(.*?)\2(.*)""", re.IGNORECASE)
LONGEST = 256   # longest free-format line [characters]


@dataclass
class Place:
    name: str
    line: int            # from 0
    first: int           # characters of the line to replace
    last: int
    kind: str = "text"   # type of the field
    width: int = 0       # width of the field; 0 in free format
    what: str = ""       # `MAT1 field 3 (E)`


class Template:
    """`faults` collects the errors of the deck itself, with file, line and columns."""

    def __init__(self, path, text, catalogue):
        self.path, self.lines, self.catalogue = path, re.sub(r"\r?\n?\Z", "", text).replace("\r\n", "\n").split("\n"), catalogue
        self.places, self.faults = [], []
        self.includes = [k for k, line in enumerate(self.lines) if INCLUDE.match(line)]
        bulk = next((k + 1 for k, line in enumerate(self.lines) if line.upper().split("$")[0].split() == ["BEGIN", "BULK"]), 0)
        card, slot, ended = "", 0, False
        for k, line in enumerate(self.lines):
            code = line.split("$")[0].rstrip()
            self.plain(k, line, len(code))
            if k < bulk or ended or not code.strip() or INCLUDE.match(code):
                self.plain(k, code, 0)
                continue
            ended = code.strip().upper() == "ENDDATA"
            name = re.split(r"[,\s]", code[:cards.FIRST])[0].upper() if code[0] not in " +*," else ""
            wide = cards.is_wide(code)
            if name:
                card, slot = name.rstrip("*"), 0
            elif slot % 8 and not wide:
                slot += 4   # a large-field row that ends after its first half
            self.cut(k, code, card, slot)
            slot += 4 if wide else 8

    def fault(self, k, first, last, what):
        self.faults.append(f"{self.path}:{k + 1}:{first + 1}-{last}: {what}")

    def plain(self, k, text, start):
        """Find placeholders in comments, titles and file names: any text is allowed."""
        self.places += [Place(match[1], k, *match.span()) for match in PLACE.finditer(text, start)]

    def cut(self, k, code, card, slot):
        """Find placeholders in the fields of a card; each must fill its field."""
        fields = cards.places(code)
        for match in PLACE.finditer(code):
            index = next((i for i, each in enumerate(fields) if each.start <= match.start() < each.stop), -1)
            if index < 0 or code[fields[index]].strip() != match[0]:
                self.fault(k, *match.span(), f"{match[0]} does not fill a field: use a shorter name, a large field "
                           "(a * after the card's name) or free format (commas)")
                continue
            first, last = fields[index].start, fields[index].stop
            width = 0 if "," in code else last - first
            field = slot + index
            column = self.column(card, field, code)
            label = f"{card} field {field // 8 * 10 + field % 8 + 2}" + (f" ({column.name})" if column.name else "")
            self.places.append(Place(match[1], k, first, last, column.kind, width, label))

    def column(self, card, field, code):
        if card == "PARAM" and field == 1:
            words = re.split(r"[,\s*]+", code.upper())
            return self.catalogue.parameters.get(words[1] if len(words) > 1 else "", self.catalogue.column("", 0))
        return self.catalogue.column(card, field)

    def fill(self, values, folder, faults):
        """Make the deck with these values, for storage in `folder`; values that do not fit are added to `faults`."""
        lines = list(self.lines)
        for place in sorted(self.places, key=lambda place: (place.line, -place.first)):
            value = values[place.name]
            try:
                text = self.text_of(place, value)
            except Unfit as unfit:
                faults.append(f"column {place.name}, {value!r}: {self.path}:{place.line + 1}:{place.first + 1}-{place.last}: "
                              f"{place.what}: {unfit}")
                continue
            line = lines[place.line].ljust(place.last)
            lines[place.line] = (line[:place.first] + text + line[place.last:]).rstrip()
            if "," in lines[place.line] and place.what and len(lines[place.line].split("$")[0].rstrip()) > LONGEST:
                faults.append(f"column {place.name}, {value!r}: {self.path}:{place.line + 1}: "
                              f"the line has more than {LONGEST} characters")
        for k in self.includes:
            lines[k] = self.moved(k, lines[k], folder, faults)
        return "\n".join(lines) + "\n"

    def meaning(self, values):
        """Values as the program reads them: rows with equal values give equal decks, whatever their comments."""
        found = []
        for place in self.places:
            text = self.text_of(place, values[place.name]).strip()
            if place.kind != "text":
                value = number(text)
                found.append(text.upper() if value is None else float(value))
            elif place.line in self.includes:
                found.append(text)
        return tuple(found)

    def lost(self, values, others):
        """For two rows with equal values: the first placeholder whose texts differ, and the digits that it holds; None if all are equal."""
        for place in self.places:
            one, two = number(others[place.name]), number(values[place.name])
            if place.kind != "text" and None not in (one, two) and one != two:
                text = self.text_of(place, values[place.name]).strip()
                held = f"{place.width} columns hold {counted(digits(text), 'digit')}" if place.width else "a real holds 16 digits"
                wider = ": use a large field (a * after the card's name) or free format (commas)" if place.width else ""
                return (f"column {place.name}, {others[place.name].strip()!r} and {values[place.name].strip()!r}: {self.path}:{place.line + 1}:"
                        f"{place.first + 1}-{place.last}: {place.what}: both are {text}: {held}{wider}")
        return ""

    def text_of(self, place, value):
        if place.kind == "text":
            if not value.isascii() or not value.isprintable():
                raise Unfit("not printable ASCII: remove other characters")
            return value
        return fit(value, place.kind, place.width).ljust(place.width)

    def moved(self, k, line, folder, faults):
        """Path of an INCLUDE file relative to the folder of the deck."""
        match = INCLUDE.match(line)
        if not match or os.path.isabs(match[3]):
            return line
        path = os.path.join(os.path.dirname(self.path), match[3])
        if not os.path.isfile(path):
            faults.append(f"{self.path}:{k + 1}: INCLUDE: {path}: no such file")
        return f"{match[1]}{match[2]}{os.path.relpath(path, folder)}{match[2]}{match[4]}"
