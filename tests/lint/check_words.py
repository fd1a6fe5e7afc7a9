#!/usr/bin/env python3
"""Check the words of documents, comments and messages: standard terms, sentences that are read once, and imperative remedies.

Prints `file:line: fault` for each fault; exit status 1 if there is any. Code, file names and text between backquotes are not checked.
Comments and messages are those of Fortran (.f90, .pf), Python, shell and CMake in src, tests and tools. A message is a string that has a blank.
"""
import ast
import io
import pathlib
import re
import sys
import tokenize

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
#: (file, part of the line): names and quotations to which the list does not apply.
EXCEPTIONS = {
    ("tests/lint/check_words.py", ""),   # the list itself
    ("tools/decks", "tools/decks SCENE"), ("tools/tradeoffs.py", "scene element size")}   # identifiers
FILE_NAME = re.compile(r"\b\w+(?:\.\w+)*\.(?:py|toml|dat|geo|bdf)\b")
#: First words of remedies: imperatives, or a word of the deck.
IMPERATIVES = {"add", "begin", "continue", "copy", "end", "exchange", "fix", "free", "give", "increase", "keep", "leave", "let", "mesh", "move", "name", "pair", "put", "remove", "repeat",
               "run", "use", "write"}
REPORT = re.compile(r"call (?:\w+%)*(?:add_error|add_warning|refuse)\(")
STRING = re.compile(r"'[^']*'|\"[^\"]*\"")
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
    """Remove text between backquotes, addresses of links, and file names."""
    return FILE_NAME.sub("X", re.sub(r"\]\([^)]*\)", "]", re.sub(r"`[^`]*`", "X", text)))


def retired(text):
    for found in PATTERN.finditer(plain(text)):
        yield f"`{found[0]}`: write {INSTEAD[int(found.lastgroup[1:])]}"


def is_excused(name, part):
    return any(name == file and excused in part for file, excused in EXCEPTIONS)


def check_document(name, text):
    for number, part in paragraphs(text):
        for fault in retired(part):
            if not is_excused(name, part):
                yield number, fault
        for sentence in SENTENCE_END.split(plain(part)):
            if len(sentence.split()) > MOST_WORDS:
                yield number, f"a sentence of {len(sentence.split())} words: `{sentence[:60]}...`"


def fortran_texts(text):
    """(line number, text) of each comment and string."""
    for number, line in enumerate(text.splitlines(), 1):
        yield number, STRING.sub("", line).partition("!")[2]
        if not line.lstrip().startswith("!"):
            yield from ((number, found[0][1:-1]) for found in STRING.finditer(line) if " " in found[0].strip("' \""))


def arguments(text, start):
    """Arguments of a Fortran call, from the position behind its parenthesis."""
    found, depth, quoted, begin = [], 1, False, start
    for k in range(start, len(text)):
        if text[k] == "'":
            quoted = not quoted
        elif not quoted:
            depth += (text[k] in "([") - (text[k] in ")]")
            if depth == 0 or depth == 1 and text[k] == ",":
                found.append(text[begin:k].strip())
                begin = k + 1
            if depth == 0:
                break
    return found


def remedy_faults(text):
    """(line number, fault) of each remedy of an error or a warning that does not begin with an imperative."""
    joined = re.sub(r"&[ ]*\n", lambda line: " " * len(line[0]), text)   # the same positions
    for call in REPORT.finditer(joined):
        given = [argument for argument in arguments(joined, call.end()) if argument not in ("found", "faults")]
        word = re.match(r"'([^' ]+)", given[-1]) if len(given) > 2 else None
        if word and word[1] not in IMPERATIVES:
            yield text[:call.start()].count("\n") + 1, f"a remedy that begins with `{word[1]}`: begin with an imperative such as give, add or write"


def script_texts(text):
    """(line number, text) of each comment and string of shell or CMake."""
    for number, line in enumerate(text.splitlines(), 1):
        yield number, (re.search(r"(?:^|\s)#\s(.*)", line) or [""] * 2)[1]
        if not line.lstrip().startswith("#"):
            yield from ((number, found[0][1:-1]) for found in STRING.finditer(line) if " " in found[0].strip("' \""))


def python_texts(text):
    """(line number, text) of each comment, docstring and string."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            yield token.start[0], token.string
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value.strip():
            yield from enumerate(node.value.split("\n"), node.lineno)


def texts(path):
    """(line number, text) of each comment and message of a file; none if it is neither source nor script."""
    reader = READERS.get(path.suffix if path.name != "CMakeLists.txt" else ".cmake")
    if reader or not path.suffix:
        text = path.read_text(encoding="utf-8")
        reader = reader or (python_texts if "python" in text.partition("\n")[0] else script_texts)
        yield from reader(text)


READERS = {".f90": fortran_texts, ".pf": fortran_texts, ".py": python_texts, ".sh": script_texts, ".cmake": script_texts}


def main(top):
    faults = []
    for page in sorted(top.rglob("*.md")):
        name = page.relative_to(top).as_posix()
        if name not in GENERATED and not name.startswith(("build/", ".")):
            faults += [(name, *fault) for fault in check_document(name, page.read_text(encoding="utf-8"))]
    for source in sorted(path for folder in ("src", "tests", "tools") for path in (top / folder).rglob("*") if path.is_file()):
        name = source.relative_to(top).as_posix()
        faults += [(name, number, fault) for number, part in texts(source) for fault in retired(part) if not is_excused(name, part)]
        if name.startswith("src/") and source.suffix == ".f90":
            faults += [(name, *fault) for fault in remedy_faults(source.read_text(encoding="utf-8"))]
    for name, number, fault in faults:
        print(f"{name}:{number}: {fault}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(__file__).resolve().parents[2]))
