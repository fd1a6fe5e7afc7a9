#!/usr/bin/env python3
"""Check the manuals: every card and PARAM of the catalogue, every deck and its picture, every link.

EPCONT_SOURCE_DIR is the project, EPCONT_PROGRAM the executable.
"""
import functools
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import urllib.parse

import run_commands
from run_commands import documents

TOP = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])
INPUT = TOP / "input"
MANUAL = (INPUT / "README.md").read_text(encoding="utf-8")
VERIFICATION = (INPUT / "verification.md").read_text(encoding="utf-8")   # all decks, with their known answers and pictures

LINK = re.compile(r"(?<!`)!?\[[^\]]*\]\(([^)\s]+)\)")
FENCED = re.compile(r"^```.*?^```", re.MULTILINE | re.DOTALL)


@functools.cache
def catalogue(*arguments):
    return subprocess.run([os.environ["EPCONT_PROGRAM"], "--cards", *arguments], capture_output=True, text=True, check=True).stdout


def cards():
    return [line.split()[0] for line in catalogue().splitlines()]


def parameters(unheard=False):
    lines = catalogue("PARAM").partition("NAME      VALUE\n")[2].splitlines()
    return [line.split()[0] for line in lines if line.endswith(": no effect") == unheard]


def examples():
    """Lines of example decks: indented by four, in columns."""
    return [line[4:] for line in MANUAL.splitlines() if line.startswith("    ")]


def links(path):
    return LINK.findall(FENCED.sub("", path.read_text(encoding="utf-8")))


def anchors(path):
    """Anchors that GitHub makes from the headings of a page."""
    titles = re.findall(r"^#+ (.*)$", FENCED.sub("", path.read_text(encoding="utf-8")), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def cards_of(deck):
    """Names of the cards of a deck and of the files it includes."""
    text = deck.read_text(encoding="latin-1")
    for name in re.findall(r"^INCLUDE '(.*)'", text, re.MULTILINE):
        text += "\n" + (deck.parent / name).read_text(encoding="latin-1")
    return {re.split(r"[ *,]", line)[0] for line in text.splitlines()} | {"PARAM " + name for name in re.findall(r"^PARAM[ ,]+(\w+)", text, re.MULTILINE)}


class Manual(unittest.TestCase):
    def test_catalogue_is_read(self):
        self.assertIn("GRID", cards())
        self.assertIn("ACCURACY", parameters())

    def test_every_card_has_an_example(self):
        shown = {re.split(r"[ *]", line)[0] for line in examples()}
        self.assertEqual(set(cards()) - shown, set())

    def test_every_card_is_in_a_table(self):
        tables = re.findall(r"^\| card \| is \|.*\n(?:\|.*\n)+", MANUAL, re.MULTILINE)
        rows = re.findall(r"^\| (\w+) \| ", "".join(tables), re.MULTILINE)
        self.assertEqual(sorted(row for row in rows if row != "card"), sorted(set(cards()) - {"PARAM"}))

    def test_every_parameter_has_an_example(self):
        for name in parameters(unheard=True):
            self.assertIn(name, MANUAL)
        for name in parameters():
            self.assertRegex(MANUAL, rf"(?m)^\| {name} \| `PARAM(   |,){name}( +|,)\S+` \| ")

    def test_decks_named_with_a_card_have_it(self):
        seen = 0
        for row in re.findall(r"^\| .* \|$", MANUAL, re.MULTILINE):
            name, *_, place = [cell.strip() for cell in row.strip("|").split(" | ")]
            wanted = "PARAM " + name if name in parameters() else name
            if wanted in cards() or name in parameters():
                for deck in LINK.findall(place):
                    self.assertIn(wanted, cards_of(INPUT / deck), deck)
                    seen += 1
        self.assertGreater(seen, len(cards()))

    def test_every_deck_is_named(self):
        for deck in sorted(INPUT.glob("*/*.dat")):
            self.assertTrue(f"]({deck.relative_to(INPUT).as_posix()})" in VERIFICATION, deck)

    def test_every_deck_has_its_picture(self):
        for deck in sorted(INPUT.glob("*/*.dat")):
            if deck.name != "no_suport.dat":  # rejected: there is nothing to draw
                self.assertTrue(f"]({deck.parent.name}/pictures/{deck.stem}.png)" in VERIFICATION, deck)

    def test_every_picture_is_shown_somewhere(self):
        named = {(page.parent / link).resolve() for page in documents() for link in links(page)}
        for picture in sorted(INPUT.glob("*/pictures/*.png")):
            self.assertIn(picture.resolve(), named)


class Examples(unittest.TestCase):
    """The lines of the manual are cards: cards they refer to may be missing, but every field must be valid."""

    @staticmethod
    def faults(text):
        with tempfile.TemporaryDirectory() as place:
            deck = pathlib.Path(place) / "example.dat"
            deck.write_text(text, encoding="ascii")
            run = subprocess.run([os.environ["EPCONT_PROGRAM"], "--check", deck], capture_output=True, text=True, cwd=place)
        return run.returncode, [line for line in run.stderr.splitlines() if line.startswith(str(deck) + ":")]

    def test_cards(self):
        part = MANUAL[MANUAL.index("### Case control"):MANUAL.index("## Choices")]
        lines = [line[4:] for line in re.findall(r"^    (?!sed|tools).*", part, re.MULTILINE)]
        _, faults = self.faults("\n".join([*lines, "PARAM,PLANE,STRAIN", "ENDDATA", ""]))
        self.assertGreater(len(faults), 10)   # GRIDs that are missing: the cards were read
        self.assertEqual([fault for fault in faults[:-1] if not re.search("there is no|an axisymmetric element in a deck of plane elements|RFORCE 1: the axis is not y", fault)], [])

    def test_parameters(self):
        deck = (INPUT / "hertz" / "hertz900.dat").read_text(encoding="ascii")
        for example in re.findall(r"^\| \w+ \| `(PARAM +(\w+) .*?)` \|", MANUAL, re.MULTILINE):
            other = re.sub(rf"(?m)^PARAM +{example[1]} .*\n", "", deck)
            self.assertEqual(self.faults(other.replace("BEGIN BULK\n", f"BEGIN BULK\n{example[0]}\n"))[0], 0, example[0])


class Commands(unittest.TestCase):
    """Commands that run_commands.py finds in a page, and differences that it must find."""

    PAGE = """Text, `tools/decks hertz` and `tools/decks`, `tools/plot [--only KIND]`, `tools/plot.py`.

    tools/run a.dat --known "x  y"      # writes a.lst
    shown below
    tools/run b.dat; echo $?

    GRID    1

From `hertz44.lst`:

```
CONTACT
         ...
```
"""

    def test_commands(self):
        taken = [(each.place, each.text, each.remark, each.shown) for block in run_commands.blocks("p", self.PAGE) for each in block]
        self.assertEqual(taken, [
            ("p:1", "tools/decks hertz", "", []), ("p:1", "tools/plot --help", "", ["--only"]),
            ("p:3", 'tools/run a.dat --known "x  y"', "writes a.lst", ["shown below"]), ("p:5", "tools/run b.dat; echo $?", "", []),
            ("p:11", "epcont input/*/hertz44.dat && cat hertz44.lst", "", ["CONTACT"])])

    def test_pages_have_commands(self):
        taken = {command.place.partition(":")[0] for page in run_commands.shown_commands() for block in page for command in block}
        for name in ("README.md", "input/README.md", "input/verification.md", "input/hertz/README.md", "tests/README.md", "tools/README.md"):
            self.assertIn(name, taken)

    def test_without_packages_commands_that_need_their_files_are_omitted(self):
        block = [run_commands.Command("p:1", text) for text in ("tools/run a.dat", "tools/deck s.toml -o b.dat", "tools/run b.dat")]
        self.assertEqual(run_commands.chosen(block, "plain"), block[:1])
        self.assertEqual(run_commands.chosen(block, "drawing"), block[1:])
        self.assertEqual(run_commands.chosen(block[:1], "drawing"), [])
        block = [run_commands.Command("p:1", text) for text in ("sed 1d a.geo > c.geo", "sed s/a/c/ a.toml > c.toml", "tools/deck c.toml", "cat d.geo")]
        self.assertEqual(run_commands.chosen(block, "plain"), [*block[:2], block[3]])
        self.assertEqual(run_commands.chosen(block, "drawing"), [block[1], block[2]])
        block[1].text += " c.geo"
        self.assertEqual(run_commands.chosen(block, "drawing"), block[:3])

    def test_differences_are_reported(self):
        for text, remark, shown, wanted in (
                ("true", "", [], []), ("false", "not (exit status 1)", [], []), ("echo 1.5", "1.5", ["1.5"], []), ("echo > a.lst", "a.lst", [], []),
                ("false", "", [], ["exit status 1, not 0"]), ("true", "exit status 2", [], ["exit status 0, not 2"]),
                ("echo 1.55", "1.5", [], ["does not print 1.5"]), ("true", "writes b.lst", [], ["writes no b.lst"]),
                ("echo a", "", ["b"], ["does not print: b"])):
            with tempfile.TemporaryDirectory() as place:
                told = []
                wrong = run_commands.try_block([run_commands.Command("p:1", text, remark, shown)], pathlib.Path(place), told.append)
                self.assertEqual([line.strip() for line in told[1:1 + len(wanted)]], wanted)
                self.assertEqual(wrong, len(wanted))
                self.assertEqual(list(pathlib.Path(place).iterdir()), [])

    def test_an_overwritten_kept_deck_is_reported(self):
        with tempfile.TemporaryDirectory() as folder:
            place, told = pathlib.Path(folder), []
            deck = place / "input/hertz/hertz44.dat"
            deck.parent.mkdir(parents=True)
            deck.write_bytes((INPUT / "hertz/hertz44.dat").read_bytes())
            block = [run_commands.Command("p:1", f"echo ENDDATA {sign} input/hertz/hertz44.dat") for sign in (">", "<")]
            self.assertEqual(run_commands.try_block(block, place, told.append), 1)
            self.assertEqual(told[1].strip(), "writes over input/hertz/hertz44.dat")


class Links(unittest.TestCase):
    def test_no_place_is_left_to_fill(self):
        for page in documents():
            self.assertNotRegex(page.read_text(encoding="utf-8"), r"(?m)@[A-Z]+@|^(<<<<<<<|>>>>>>>)", page)

    def test_every_folder_of_tests_is_named(self):
        """Layers of src have one common row."""
        page = (TOP / "tests" / "README.md").read_text(encoding="utf-8")
        layers = {path.name for path in (TOP / "src").iterdir()}
        named = {path.name for path in (TOP / "tests").iterdir() if re.search(rf"^\| `{path.name}[`/]", page, re.MULTILINE)}
        self.assertEqual(set(), {path.name for path in (TOP / "tests").iterdir() if path.is_dir() and path.name != "__pycache__"} - named - layers)

    def test_sources_that_are_named_exist(self):
        for page in documents():
            if page.name == "CHANGELOG.md":   # describes old ones
                continue
            for name in re.findall(r"`((?:\w+/)+\w+\.(?:f90|inc|pf|py))[`,]", page.read_text(encoding="utf-8")):
                self.assertTrue(any((TOP / folder / name).exists() for folder in ("", "src", "tests", "tools")), f"{page.relative_to(TOP)}: {name}")

    def test_relative_links_resolve(self):
        seen = 0
        for page in documents():
            for link in links(page):
                address, _, anchor = urllib.parse.unquote(link).partition("#")
                if "://" in address or address.startswith("mailto:"):
                    continue
                target = (page.parent / address) if address else page
                self.assertTrue(target.exists(), f"{page.relative_to(TOP)}: {link}")
                if anchor and target.suffix == ".md":
                    self.assertIn(anchor, anchors(target), f"{page.relative_to(TOP)}: {link}")
                seen += 1
        self.assertGreater(seen, 100)


if __name__ == "__main__":
    unittest.main()
