#!/usr/bin/env python3
"""Check the words of documents, comments and messages: standard terms, and sentences that are read once.

Prints `file:line: fault` for each fault; exit status 1 if there is any. Code, file names and text between backquotes are not checked.
"""
import pathlib
import re
import sys

#: Retired words and what to write instead.
RETIRED = {
    r"scenes?": "model", r"(?<!degree of )(?<!degrees of )freedoms?": "DOF", r"free motions?": "rigid-body mode", r"reference freedoms?": "SUPORT DOF",
    r"leaders?": "master node, master DOF", r"followers?": "dependent node, dependent DOF", r"unlike meshes": "non-matching meshes",
    r"anew": "again", r"would be right": "an imperative", r"mend(s|ed|ing)?": "correct", r"read over": "ignored", r"nobody": "no one, or the name of the actor",
    r"beyond the yield point": "yielded", r"gives? way": "deform", r"told of": "reported", r"figures? (are|is) worth": "error estimate",
    r"in each other": "penetrate", r"bears?": "carry", r"moves? off": "is unconstrained", r"sharpen(s|ed|ing)?": "refine iteratively",
    r"(is|are) noted": "is ignored", r"flat curves?": "perfectly plastic", r"middle nodes?": "mid-side node",
    r"side by side": "in parallel", r"turn(s|ed)? round": "inverse, opposite", r"(is|are) none": "is zero, or does not exist", r"whoever": "the actor", r"of which of":
    "one genitive", r"dials?": "parameter", r"as drawn": "undeformed"}
PATTERN = re.compile(r"(?<![\w%/-])(?:" + "|".join(f"(?P<w{k}>{word})" for k, word in enumerate(RETIRED)) + r")(?![\w%(/-])", re.IGNORECASE)
INSTEAD = list(RETIRED.values())
#: Words of a sentence in a document.
MOST_WORDS = 40
#: Documents that are generated, or quote old texts.
GENERATED = {"tools/benchmark/results.md", "tools/tradeoff.md"}
#: Formulas, lists of names and quotations for which the rule makes no sense: (file, part of the line).
EXCEPTIONS = set()
SENTENCE_END = re.compile(r"(?<=[.!?:;])\s+(?=[A-Z`*(\[0-9])")


def paragraphs(text):
    """(line number, text) of each paragraph, list item and table cell, without code."""
    fenced, first, part = False, 1, []
    for number, line in enumerate([*text.splitlines(), ""], 1):
        if line.startswith("```"):
            fenced, line = not fenced, ""
        if fenced or line.startswith("    "):
            line = ""
        if not line.strip() or re.match(r"\s*([-|#]|\d+\. )", line):
            if part:
                yield first, " ".join(part)
            part = []
        if line.startswith("|"):
            yield from ((number, cell) for cell in re.sub(r"`[^`]*`", "X", line).split("|"))
        elif line.strip():
            if not part:
                first = number
            part.append(line.strip())


def plain(text):
    """Without what stands between backquotes, and addresses of links."""
    return re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "X", text))


def retired(text):
    for found in PATTERN.finditer(plain(text)):
        yield f"`{found[0]}`: write {INSTEAD[int(found.lastgroup[1:])]}"


def check_document(name, text):
    for number, part in paragraphs(text):
        for fault in retired(part):
            if not any(name == file and excused in part for file, excused in EXCEPTIONS):
                yield number, fault
        for sentence in SENTENCE_END.split(plain(part)):
            if len(sentence.split()) > MOST_WORDS:
                yield number, f"a sentence of {len(sentence.split())} words: `{sentence[:60]}...`"


def check_comments(text):
    """Comments of Fortran sources, without code between backquotes."""
    for number, line in enumerate(text.splitlines(), 1):
        for fault in retired(re.sub(r"'[^']*'|\"[^\"]*\"", "", line).partition("!")[2]):
            yield number, fault


def check_messages(text):
    """Strings of Fortran sources that have a blank: sentences."""
    for number, line in enumerate(text.splitlines(), 1):
        if not line.lstrip().startswith("!"):
            for string in re.findall(r"'([^']*)'", line):
                if " " in string.strip():
                    yield from ((number, fault) for fault in retired(string))


def main(top):
    faults = []
    for page in sorted(top.rglob("*.md")):
        name = page.relative_to(top).as_posix()
        if name not in GENERATED and not name.startswith(("build/", ".")):
            faults += [(name, *fault) for fault in check_document(name, page.read_text(encoding="utf-8"))]
    for source in sorted((top / "src").rglob("*.f90")):
        text = source.read_text(encoding="utf-8")
        faults += [(source.relative_to(top).as_posix(), *fault) for check in (check_comments, check_messages) for fault in check(text)]
    for name, number, fault in faults:
        print(f"{name}:{number}: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(__file__).resolve().parents[2]))
