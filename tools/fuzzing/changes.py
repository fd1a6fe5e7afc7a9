"""Change decks: cards (by the catalogue), and the bytes of the text."""
import math
import re

from fuzzing.cards import Card
from fuzzing.scenes import number

INTEGERS = ["0", "-1", "1", "2", "3", "12", "21", "11", "123456", "1123", "99999999", "100000000", "2147483647", "2147483648",
            "-2147483649", "+1", "01", "99999999999999999999", "1.0", "1E2", "0X1", "1_8", "THRU"]
REALS = ["0.0", "-0.0", "1.0", "-1.0", "0.5", ".4999999", ".49999999999999999", "1.+300", "1.-300", "1.E400", "1.-400", "1.+308",
         "4.9-324", "1E5", "7", "1.2.3", "NAN", "INF", "-INF", "1.D0", "1.5-3", "1.-12", "1.+12", "1.Q0", "1.E", "1.+", ".", "-.",
         "+.5", "1 . 0", "1.0E+-3", "1.E99999999999", "1.000000000000000000000001", "1/2", "$", "0X1.8P1"]
WORDS = ["", "THRU", "BY", "YES", "NO", "STRESS", "PLASTIC", "ENDT", "SKIP", "A B", "ABCDEFGHI", "*", "+", "1", "1.0", "-", "''"]
ANY = INTEGERS + REALS + WORDS
FACTORS = [-1.0, 0.0, 0.5, 2.0, 1.0 + 1e-6, 1e-3, 1e3, 1e-6, 1e6, 1e-9, 1e9, 1e-13, 1e13, 1e-80, 1e80, 1e-150, 1e150]
NAMES = ["GRID", "MAT2", "CQUAD8", "CTETRA", "PBAR", "SPCADD", "ENDDATA", "INCLUDE", "BEGIN BULK", "CEND", "", "*", "+", "GRID*"]


def value(text):
    try:
        return float(re.sub(r"(?<=[\d.])([-+])", r"e\1", text.upper().replace("D", "").replace("E", "")))
    except ValueError:
        return None


class Changes:
    def __init__(self, pick, catalogue):
        self.pick, self.catalogue = pick, catalogue

    def card(self, deck, *names):
        """A random card; each name is equally likely, however many cards it has."""
        kinds = sorted({card.name for card in deck.cards if not names or card.name in names})
        kind = self.pick.choice(kinds) if kinds else None
        found = [card for card in deck.cards if card.name == kind]
        return self.pick.choice(found) if found else None

    def change(self, deck):
        """One change of the cards."""
        pick = self.pick
        do = pick.choice([self.field] * 4 + [self.scale] * 12 + [self.exchange, self.drop, self.drop, self.duplicate, self.reorder,
                         self.same_id, self.missing_id, self.free, self.table, self.material, self.material, self.gaps, self.gaps, self.loads, self.loads, self.parameter,
                         self.parameter, self.ranges, self.rename, self.more, self.fewer, self.collapse, self.contact_twice])
        if deck.cards:
            do(deck)
        return do.__name__

    def field(self, deck):
        """A value of the right type or not, valid or not."""
        pick, card = self.pick, self.card(deck)
        slot = pick.randrange(len(card.data) + pick.choice([0, 0, 0, 1, 9]))
        card.data += [""] * (slot + 1 - len(card.data))
        column = self.catalogue.column(card.name, slot)
        pool = {"integer": INTEGERS, "digits": INTEGERS, "real": REALS, "word": WORDS + column.choices}.get(column.kind, ANY)
        card.data[slot] = pick.choice(ANY if pick.random() < 0.2 else pool)

    def scale(self, deck):
        """A real made larger or smaller: the deck stays readable."""
        for _ in range(5):
            card = self.card(deck)
            slots = [k for k, text in enumerate(card.data) if "." in text and value(text) is not None]
            if slots:
                break
        else:
            return
        slot = self.pick.choice(slots)
        new = (value(card.data[slot]) or self.pick.choice([0.0, 1.0, 1e-9])) * self.pick.choice(FACTORS)
        if math.isfinite(new):
            card.data[slot] = number(new)

    def exchange(self, deck):
        """Two fields of one or two cards are exchanged."""
        one, two = self.card(deck), self.card(deck)
        i, j = self.pick.randrange(len(one.data)), self.pick.randrange(len(two.data))
        one.data[i], two.data[j] = two.data[j], one.data[i]

    def drop(self, deck):
        deck.cards.remove(self.card(deck))

    def duplicate(self, deck):
        deck.cards.insert(self.pick.randrange(len(deck.cards) + 1), self.card(deck).copy())

    def reorder(self, deck):
        self.pick.shuffle(deck.cards)

    def ids(self, deck):
        """(card, slot) of a field that holds an id."""
        card = self.card(deck)
        slots = [k for k, text in enumerate(card.data) if text.isdigit()]
        return (card, self.pick.choice(slots)) if slots else (None, 0)

    def same_id(self, deck):
        (one, i), (two, j) = self.ids(deck), self.ids(deck)
        if one and two:
            one.data[i] = two.data[j]

    def missing_id(self, deck):
        card, slot = self.ids(deck)
        if card:
            card.data[slot] = self.pick.choice(["77777777", "0", "-5", "99999999", "100000000", str(int(card.data[slot]) + 1)])

    def free(self, deck):
        """Fewer supports or SUPORT DOFs: unconstrained rigid-body modes."""
        card = self.card(deck, "SPC", "SPC1", "SUPORT", "RBE2")
        if not card:
            return
        slots = [k for k, text in enumerate(card.data) if text]
        if self.pick.random() < 0.5 or not slots:
            deck.cards.remove(card)
        else:
            slot = self.pick.choice(slots)
            card.data[slot] = self.pick.choice(["1", "2", "12", "3", "6", "123", ""])

    def table(self, deck):
        """Points of a curve in another order, missing, equal or falling; a yield point far below the others."""
        card = self.card(deck, "TABLES1")
        if not card or len(card.data) < 11:
            return
        body = [text for text in card.data[8:] if text]
        i, j = self.pick.randrange(len(body)), self.pick.randrange(len(body))
        how = self.pick.randrange(5)
        if how == 0:
            body[i], body[j] = body[j], body[i]
        elif how == 1:
            body[i] = body[j]
        elif how == 2:
            del body[i]
        elif how == 3:
            body[i:i] = self.pick.choice([["SKIP"], ["SKIP", "SKIP"], ["ENDT"], [""], ["1.0", "1.0"]])
        else:
            self.lower_yield_point(deck, card.data[0], body)
        card.data[8:] = body

    def lower_yield_point(self, deck, table, body):
        """Along the elastic line, so that the curve stays a curve; LIMIT1 with it."""
        point = [value(text) for text in body[2:4]]
        if len(point) < 2 or None in point:
            return
        factor = self.pick.choice([0.3, 1e-6, 1e-12, 1e-30, 1e-150])
        body[2:4] = [number(factor * each) for each in point]
        for card in deck.cards:
            if card.name == "MATS1" and len(card.data) > 6 and card.data[1] == table and card.data[6]:
                card.data[6] = body[3]

    def material(self, deck):
        card = self.card(deck, "MAT1", "MATS1", "PSHELL")
        if not card:
            return
        slot = self.pick.choice({"MAT1": [1, 2, 3, 4], "MATS1": [3, 6], "PSHELL": [2]}[card.name])
        card.data += [""] * (slot + 1 - len(card.data))
        card.data[slot] = self.pick.choice(["0.0", "1.-30", "1.-10", "1.0", "1.+10", "1.+30", "1.+100", "1.-100", ".499", ".49999",
                                            ".4999999999", "0.5", "-1.0", "-0.1", ""])

    def gaps(self, deck):
        card = self.card(deck, "PGAP")
        if card and len(card.data) > 1:
            card.data[1] = self.pick.choice(["-1.-4", "-0.01", "-1.0", "1.0", "-1.+6", "1.+6", "1.-300", "-1.-60", "1.-12", "-1.-12"])

    def loads(self, deck):
        card = self.card(deck, "FORCE", "PLOADX1", "SPC", "GRAV", "RFORCE")
        if card:
            slot = {"FORCE": 3, "PLOADX1": 2, "SPC": 3, "GRAV": 2, "RFORCE": 3}[card.name]
            card.data += [""] * (slot + 1 - len(card.data))
            card.data[slot] = self.pick.choice(["0.0", "1.+3", "1.+6", "1.+12", "1.+30", "1.+100", "1.+200", "1.-200", "1.-60", "-1.+6", "-1.0"])

    def parameter(self, deck):
        """A PARAM with a known or unknown name, and a valid or invalid value."""
        name = self.pick.choice(sorted(self.catalogue.parameters))
        column = self.catalogue.parameters[name]
        pool = {"integer": ["1", "2", "3", "7", "0", "-1", "10001", "100001", "1.0"],
                "real": ["1.-12", "1.-6", "0.01", "0.9", "1.0", "0.0", "-1.0", "1.+6", "1.-300", "NAN"]}.get(column.kind, column.choices)
        text = self.pick.choice(pool if pool and self.pick.random() < 0.85 else ANY)
        place = self.pick.randrange(len(deck.cards) + 1)
        deck.cards.insert(place, Card("PARAM", [name if self.pick.random() < 0.95 else self.pick.choice(WORDS), text]))

    def ranges(self, deck):
        """THRU and BY in a list."""
        card = self.card(deck, "SPC1", "BLSEG", "RBE2")
        if not card:
            return
        first = {"SPC1": 2, "BLSEG": 1, "RBE2": 3}[card.name]
        ids = [text for text in card.data[first:] if text.isdigit()] or ["1"]
        card.data[first:] = self.pick.choice([
            [min(ids), "THRU", max(ids)], [ids[0], "THRU", ids[-1]], [ids[0], "THRU"], ["THRU", ids[0]],
            [ids[0], "THRU", "99999999"], ["1", "THRU", "99999999", "BY", "1"], [ids[0], "THRU", ids[-1], "BY", "2"],
            [ids[0], "THRU", ids[-1], "BY", "0"], [ids[0], "THRU", ids[-1], "BY", "-1"], [ids[0], "THRU", "THRU", ids[-1]],
            ids + ids, [""] + ids, ids[:1] * 3, ids + ["", ids[0]], ids[::-1]])

    def rename(self, deck):
        self.card(deck).name = self.pick.choice(NAMES + self.catalogue.names * 2)

    def more(self, deck):
        self.card(deck).data += [self.pick.choice(ANY) for _ in range(self.pick.choice([1, 2, 9, 200]))]

    def fewer(self, deck):
        card = self.card(deck)
        del card.data[self.pick.randrange(len(card.data)):]
        card.data = card.data or [""]

    def collapse(self, deck):
        """A node at or near another, or on a line with others."""
        one, two = self.card(deck, "GRID"), self.card(deck, "GRID")
        if one and len(one.data) > 3 and len(two.data) > 3:
            slot = self.pick.choice([2, 3])
            one.data[slot] = two.data[slot]
            if self.pick.random() < 0.5:
                one.data[5 - slot] = two.data[5 - slot]

    def contact_twice(self, deck):
        """A pair, or a contact of lines, repeated under another id: rejected."""
        card = self.card(deck, "CGAP", "BCONP")
        if card:
            again = card.copy()
            again.data[0] = "98765432"
            if self.pick.random() < 0.3 and len(again.data) > 3:
                again.data[2], again.data[3] = again.data[3], again.data[2]
            deck.cards.append(again)


def spoil_bytes(lines, pick):
    """One change of the text; lines are bytes."""
    k = pick.randrange(len(lines))
    line, at = lines[k], pick.randrange(len(lines[k]) + 1)
    how = pick.randrange(16)
    if how < 5:
        new = bytes([pick.choice([pick.randrange(256), pick.choice(b"0123456789.+-*,$ \t\r\0E'")])])
        lines[k] = pick.choice([line[:at] + new + line[at + 1:], line[:at] + new + line[at:], line[:at] + line[at + 1:]])
    elif how == 5:
        del lines[k]
    elif how == 6:
        lines.insert(pick.randrange(len(lines) + 1), line)
    elif how == 7:
        j = pick.randrange(len(lines))
        lines[k], lines[j] = lines[j], lines[k]
    elif how == 8:
        lines[k:] = [line[:at]]
    elif how == 9:
        del lines[k:k + pick.randrange(1, 30)]
    elif how == 10:
        lines[k] = pick.choice([line + b" " * pick.choice([1, 80, 300]), line.ljust(72) + b"+ABCDEF", line.ljust(73)[:73] + b"99",
                                b" " + line, line[:8] + b" " + line[8:], line.replace(b" ", b"\t", 1), line.lower(), line * 30])
    elif how == 11:
        lines[k] = pick.choice([b"+" + line[8:], b"*" + line[8:], b"        " + line[8:], b"+CONT   " + line[8:], b"+", b"*", b"," * 9])
    elif how == 12:
        lines[:] = [each + b"\r" for each in lines]
    elif how == 13:
        lines.insert(k, pick.choice([b"$" + line, b"BEGIN BULK", b"CEND", b"SUBCASE 2", b"ENDDATA", b"SPC = 1", b"SPC = 77", b"LOAD = 2",
                                     b"STRESS(SORT1) = ALL", b"INCLUDE ''", b"INCLUDE 'nosuch.inc'", b"INCLUDE '.'", b"INCLUDE '/dev/null'",
                                     b"INCLUDE", b"INCLUDE 'x", bytes(pick.randrange(256) for _ in range(pick.choice([3, 90, 400])))]))
    elif how == 14:
        number = list(re.finditer(rb"[-+]?\d*\.\d*(?:E?[-+]\d+)?|\d+", line))
        if number:
            found = pick.choice(number)
            lines[k] = line[:found.start()] + pick.choice(ANY).encode() + line[found.end():]
    else:
        lines[k] = line.ljust(72)
        at = 8 + 8 * pick.randrange(8)
        lines[k] = lines[k][:at] + pick.choice(ANY).encode().ljust(8)[:8] + lines[k][at + 8:]
