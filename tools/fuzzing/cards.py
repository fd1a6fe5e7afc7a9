"""Decks as cards, and cards as text."""
from dataclasses import dataclass, field

from cards import fields


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
    """The cards of a deck without INCLUDE; unclear lines stay with the card before them."""
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


def write(card, form):
    """The lines of a card in a form: small, large or free. If a value does not fit, the card is free."""
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
