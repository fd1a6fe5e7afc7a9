"""Make deck number k of a seed: always the same."""
import pathlib
import random
import sys
from dataclasses import dataclass

from fuzzing.cards import Deck, parse, text_of
from fuzzing.changes import Changes, spoil_bytes
from fuzzing.scenes import small_scene

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "independent"))
import write_random  # noqa: E402


@dataclass
class Made:
    name: str
    files: dict           # name: bytes; the first is the deck
    twin: bytes = None    # the same cards in another order and form, if the deck consists of cards only
    how: str = ""


class Maker:
    def __init__(self, seed, catalogue, originals):
        self.seed, self.catalogue = seed, catalogue
        self.originals = [(path.stem, path.read_bytes()) for path in sorted(originals)]
        # Small ones are fast, so that more can be tried.
        self.weights = [1.0 / (2000 + len(text)) for _, text in self.originals]

    def make(self, k):
        pick = random.Random(f"{self.seed} {k}")
        name = f"f{self.seed}_{k}"
        source = pick.random()
        if source < 0.03:
            return Made(name, {f"{name}.dat": noise(pick)}, how="noise")
        if source < 0.30:
            stem, text = pick.choices(self.originals, self.weights)[0]
            if b"INCLUDE" in text or pick.random() < 0.4:
                return Made(name, {f"{name}.dat": self.spoilt(text, pick)}, how=f"{stem} bytes")
            deck = parse(text.decode("latin-1"))
        elif source < 0.80:
            stem, deck = "small", small_scene(pick)
        else:
            make = pick.choice([write_random.stack, write_random.tongue, write_random.pressed, write_random.nested])
            stem, deck = make.__name__, parse(make(pick).text())
        changes = Changes(pick, self.catalogue)
        done = [changes.change(deck) for _ in range(pick.choice([0, 0, 0, 1, 1, 1, 1, 2, 3, 6]))]
        return self.written(name, deck, pick, " ".join([stem] + done))

    def written(self, name, deck, pick, how):
        whole = pick.random() < 0.99
        text = text_of(deck, pick.choice([["small"], ["large"], ["free"], ["free", "small", "large"]]), pick, whole)
        if pick.random() < 0.12:
            return Made(name, {f"{name}.dat": self.spoilt(text.encode(), pick)}, how=how + " bytes")
        if pick.random() < 0.05:
            return self.in_two_files(name, text, pick, how + " include")
        twin = None
        if whole and pick.random() < 0.1 and not any(means_other_things(card) for card in deck.cards):
            cards = list(deck.cards)
            pick.shuffle(cards)
            twin = text_of(Deck(deck.head, cards), ["free", "large"], pick).encode()
        return Made(name, {f"{name}.dat": text.encode()}, twin, how)

    def in_two_files(self, name, text, pick, how):
        """Move a part of the deck to an included file; sometimes files include each other, or are included twice."""
        lines = text.splitlines()
        first = next((k + 1 for k, line in enumerate(lines) if line == "BEGIN BULK"), 0)
        at = pick.randint(first, max(first, len(lines) - 1))
        part = lines[at:-1] + pick.choice([[], [], ["ENDDATA"], [f"INCLUDE '{name}.inc'"], [f"INCLUDE '{name}.dat'"],
                                           [f"INCLUDE './{name}.inc'"]])
        whole = lines[:at] + [f"INCLUDE '{name}.inc'"] * pick.choice([1, 1, 1, 2]) + ["ENDDATA"]
        return Made(name, {f"{name}.dat": "\n".join(whole).encode() + b"\n", f"{name}.inc": "\n".join(part).encode() + b"\n"}, how=how)

    def spoilt(self, text, pick):
        lines = text.split(b"\n")
        for _ in range(pick.choice([1, 1, 1, 2, 4])):
            if lines:
                spoil_bytes(lines, pick)
        return b"\n".join(lines)


def means_other_things(card):
    """In another form, or with a detail changed: the deck's end; a name of large fields; a comment at the end of a line; a coordinate without decimal point, which only large fields may have."""
    if card.name == "ENDDATA" or card.name[:1] in ("", "*", "+") or card.name.endswith("*") or any("$" in text for text in card.data):
        return True
    return card.name == "GRID" and any(text and "." not in text for text in card.data[2:5])


def noise(pick):
    """Bytes that are not a deck, or hardly one."""
    pool = pick.choice([bytes(range(256)), b"GRIDCQUA4T123 ,*+.-\n$", b"\n", b"INCLUDE 'x'\n", b"\x00\xff", b"1234567890.E+-,\n        "])
    body = bytes(pick.choice(pool) for _ in range(pick.choice([0, 1, 10, 300, 5000])))
    return pick.choice([b"", b"BEGIN BULK\n", b"SOL 101\nCEND\n"]) + body + pick.choice([b"", b"\nENDDATA\n", b"ENDDATA"])
