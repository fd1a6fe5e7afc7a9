#!/usr/bin/env python3
"""Check rules that no compiler checks: layers, names, sizes and habits of the sources (src/README.md), version and date.

Prints `file:line: fault` for each fault; exit status 1 if there is any.
"""
import datetime
import pathlib
import re
import subprocess
import sys

LAYERS = ["base", "system", "deck", "element", "geometry", "model", "contact_geometry", "build", "material", "linalg", "plan",
          "assembly", "flexibility", "contact", "linear", "plasticity", "result", "certificate", "accuracy", "verdict", "attempts", "evaluation", "load_history", "solution",
          "messages", "report", "epcont", "app"]   # from verdict to solution, and epcont: files of src itself
# A certificate computed by the code it certifies is worth nothing.
SHUNNED = {"certificate": {"linalg", "assembly", "flexibility", "contact", "linear", "plasticity"}}
VERSION = "src/base/version.f90"
PAGE = [VERSION, "src/app/help.f90", "src/app/options.f90"]   # sources of the manual page
FILE_LINES, PROCEDURE_LINES, ARGUMENTS = 400, 120, 7
#: Columns of a line: of the sources, and of tests, whose assertions are long.
COLUMNS, TEST_COLUMNS = 110, 132
#: Lines of the procedures of the sources, with their internal procedures: the median, and what 90 % do not exceed.
MEDIAN, MOST = 15, 40
LAPACK = "src/linalg/lapack.f90"   # arguments fixed by the callers

USE = re.compile(r"\s*use\s+epcont_(\w+)\b(\s*,\s*only\s*:)?", re.IGNORECASE)
OLD = re.compile(r"\s*(?:common\b|equivalence\b|entry\s+\w+\s*(?:\(|$)|save\b)|.*(?:\bgo\s*to\s+\d|,\s*save\b)", re.IGNORECASE)
BEGIN = re.compile(r"\s*(?!end\b)(?:[\w*]+(?:\([^!]*?\))?\s+)*(?:subroutine|function)\s+(\w+)\s*(?:\(|$)", re.IGNORECASE)
END = re.compile(r"\s*end\s*(?:subroutine|function)\b", re.IGNORECASE)
STRING = re.compile(r"'[^']*'|\"[^\"]*\"")


def code_of(line):
    """A line without strings and comment."""
    return STRING.sub("''", line).partition("!")[0].rstrip()


def procedures(lines):
    """(name, first line, one past the last line) of each procedure."""
    begun = []
    for n, line in enumerate(lines):
        code = code_of(line)
        if END.match(code) and begun:
            name, first = begun.pop()
            yield name, first, n + 1
        elif BEGIN.match(code):
            begun.append((BEGIN.match(code)[1].lower(), n))


def check_size(lines, most=FILE_LINES, columns=TEST_COLUMNS):
    if len(lines) > most:
        yield len(lines), f"more than {most} lines in a file"
    for n, line in enumerate(lines, 1):
        if len(line) > columns:
            yield n, f"longer than {columns} columns"


def check_lengths(lines):
    """Check that procedures, with their internal procedures, are short."""
    for name, first, last in procedures(lines):
        if last - first > PROCEDURE_LINES:
            yield first + 1, f"{name} has {last - first} lines: shorten it to {PROCEDURE_LINES}"


def check_arguments(lines):
    for name, first, _ in procedures(lines):
        if head_of(lines, first).count(",") >= ARGUMENTS:
            yield first + 1, f"{name} has more than {ARGUMENTS} arguments"


def head_of(lines, first):
    """Text between the brackets after a procedure's name."""
    head = ""
    for line in lines[first:]:
        code = code_of(line)
        head += code.strip().rstrip("&")
        if not code.endswith("&"):
            break
    return re.sub(r"^.*?(?:subroutine|function)\s+\w+\s*\(([^)]*)\).*$|^.*$", r"\1", head, flags=re.IGNORECASE)


def check_shape(sources):
    """Check the lengths of all procedures, with their internal procedures: a few may be long, most are short."""
    lengths = sorted(last - first for lines in sources for _, first, last in procedures(lines))
    middle, most = lengths[len(lengths) // 2], lengths[int(0.9 * len(lengths))]
    if middle > MEDIAN or most > MOST:
        yield f"half of the procedures have up to {middle} lines, 90 % up to {most}: shorten them to {MEDIAN} and {MOST}"


def check_habits(lines):
    code = [code_of(line).strip().lower() for line in lines]
    if "implicit none" not in code:
        yield 1, "no `implicit none`"
    if any(line.startswith("module ") for line in code) and "private" not in code:
        yield 1, "no bare `private`"
    for n, line in enumerate(code, 1):
        if OLD.match(line):
            yield n, "an old habit: goto, common, equivalence, entry or save"


def check_module(path, source, lines):
    """Check the name, and the uses of other layers."""
    parts = path.relative_to(source).with_suffix("").parts
    name, layer = "_".join(("epcont",) + parts) if parts != ("epcont",) else "epcont", parts[0]
    if layer not in LAYERS:
        yield 1, f"{layer} is not a layer"
        return
    if parts != ("app", "main") and not re.search(rf"^module {name}$", "\n".join(lines), re.MULTILINE | re.IGNORECASE):
        yield 1, f"the module is not named {name}"
    for n, line in enumerate(lines, 1):
        match = USE.match(line)
        if not match:
            continue
        used = layer_of(match[1].lower())
        if used not in LAYERS or LAYERS.index(used) > LAYERS.index(layer) or used in SHUNNED.get(layer, ()):
            yield n, f"{layer} may not use epcont_{match[1]}"
        if not match[2]:
            yield n, f"`use epcont_{match[1]}` without `only`"


def layer_of(name):
    """Longest layer name that a module's name begins with."""
    return max((layer for layer in LAYERS if (name + "_").startswith(layer + "_")), key=len, default=None)


def check_names(paths):
    """Check that no two modules have the same name in different folders: messages, searches and editor tabs would not distinguish them."""
    first = {}
    for path in paths:
        if first.setdefault(path.stem, path) != path:
            yield path, f"a module of the name {path.stem} is in {first[path.stem].parent.name} too"


def check_public(sources):
    """Check that no two folders have a public procedure of the same name, and that at most one type has `scene` in its name."""
    first, scenes = {}, []
    for path, lines in sources:
        text = re.sub(r"&\s*", " ", "\n".join(map(code_of, lines)))
        public = set(re.findall(r"\w+", " ".join(re.findall(r"^\s*public\s*::(.*)$", text, re.MULTILINE))))
        for name, n, _ in procedures(lines):
            if name in public and first.setdefault(name, path).parent != path.parent:
                yield path, n + 1, f"a public procedure {name} is in {first[name].parent.name} too"
        scenes += [(path, n, line) for n, line in enumerate(lines, 1) if re.match(r"\s*type\s*(,.*)?::\s*\w*scene", line)]
    for path, n, line in scenes[1:]:
        yield path, n, f"another type named after `scene`, rename it: {line.split('::')[1].strip()}"


def check_asserts(lines):
    """Check that each test asserts, itself or through a procedure of its file, or one named assert_... or check_..."""
    bodies = {name: "\n".join(lines[first:last]).lower() for name, first, last in procedures(lines)}
    asserting = set()
    while True:
        calls = "|".join(["assert_", "check_"] + [rf"{name}\b" for name in asserting])
        found = {name for name, body in bodies.items() if re.search(rf"^\s*@assert|\bcall\s+(?:{calls})", body, re.MULTILINE)}
        if found == asserting:
            break
        asserting = found
    for name, first, _ in procedures(lines):
        if any(line.strip().lower() == "@test" for line in lines[max(first - 1, 0):first]) and name not in asserting:
            yield first + 1, f"{name} asserts nothing"


def check_version(root):
    built = re.search(r"project\(epcont VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())
    told = re.search(r"program_version = '([^']*)'", (root / "src/base/version.f90").read_text())
    if not built or not told or built[1] != told[1]:
        yield 1, "the version is not that of src/base/version.f90"


def check_date(root):
    """Check that the date of the manual page is not before its last change, as far as git knows."""
    told = re.search(r"program_date = '([^']*)'", (root / VERSION).read_text())
    try:
        date = datetime.date.fromisoformat(told[1])
    except (TypeError, ValueError):
        yield 1, "program_date is no day such as 2026-11-21"
        return
    changed = last_change(root)
    if changed and date < changed:
        yield 1, f"program_date {date}: set it to {changed}, the last change of the manual page"


def last_change(root):
    """Day of the last commit that changed the sources of the manual page; None without (complete) history."""
    try:
        shallow, day = (subprocess.run(["git", "-C", root, *words], capture_output=True, text=True, check=True).stdout.strip()
                        for words in (["rev-parse", "--is-shallow-repository"], ["log", "-1", "--format=%as", "--", *PAGE]))
    except (OSError, subprocess.CalledProcessError):
        return None
    return datetime.date.fromisoformat(day) if shallow == "false" and day else None


def check(root):
    """All faults, as (path, line, text)."""
    sources = sorted((root / "src").rglob("*.f90"))
    for path in sources:
        lines = path.read_text().splitlines()
        for checks in (check_size(lines, columns=COLUMNS), check_habits(lines), check_module(path, root / "src", lines),
                       check_lengths(lines),
                       () if path == root / LAPACK else check_arguments(lines)):
            yield from ((path, n, text) for n, text in checks)
    yield from ((root / "src", 1, text) for text in check_shape(path.read_text().splitlines() for path in sources))
    yield from ((path, 1, text) for path, text in check_names(sources))
    yield from check_public([(path, path.read_text().splitlines()) for path in sources])
    for path in sorted((root / "tests").rglob("*.f90")):
        lines = path.read_text().splitlines()
        yield from ((path, n, text) for checks in (check_size(lines), check_lengths(lines), check_habits(lines))
                    for n, text in checks)
    for path in sorted((root / "tests").rglob("test_*.pf")):
        lines = path.read_text().splitlines()
        # A list of cases may be long.
        yield from ((path, n, text) for checks in (check_size(lines, 2 * FILE_LINES), check_lengths(lines), check_asserts(lines))
                    for n, text in checks)
    yield from ((root / "CMakeLists.txt", n, text) for n, text in check_version(root))
    yield from ((root / VERSION, n, text) for n, text in check_date(root))


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2]).resolve()
    faults = [f"{path.relative_to(root)}:{n}: {text}" for path, n, text in check(root)]
    print("\n".join(faults) or "no faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
