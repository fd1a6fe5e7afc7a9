#!/usr/bin/env python3
"""Run the commands of the documents unchanged: run_commands.py plain|drawing [PART OF A COMMAND]

It takes lines of indented blocks that begin with a command, whole commands between backquotes in the text, and listings
with the remark `From X.lst`. The lines of a block, and the commands of a paragraph, run in sequence in one place: a copy of the project
whose build folder has the executable under test in every preset. Compared with the document are the exit status (0, or as
stated), the lines shown below a command, and from its remark the number that it prints and the files that it writes.

`plain` runs commands that need only epcont, a shell and Python, `drawing` those that need the Python of tools/venv, and their preparations.
EPCONT_SOURCE_DIR is the project, EPCONT_PROGRAM the executable.
"""
import dataclasses
import filecmp
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

TOP = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])
PROGRAM = pathlib.Path(os.environ["EPCONT_PROGRAM"]).resolve()

# Commands that tests cannot run or wait for: pattern of the command, replacement, reason.
INSTEAD = [
    (r"cmake --preset release && cmake --build --preset release( --target epcont)?",
     r"cmake --list-presets && cmake --build --preset release", "minutes; the build under test was made so"),
    (r"cmake --install build/release .*", None, "the ctest `package` installs"),
    (r"cmake (-S input/library|--build build/two_blocks) .*", None, "the ctest `package` builds it"),
    (r"sudo apt install .*", None, "changes the machine; the ctest `package` unpacks the package and runs it"),
    (r"tests/slurm/run", "tests/slurm/run --help", "installs and starts Slurm"),
    (r"tools/batch (.*--slurm.*|--collect .*)", "tools/batch --help", "wants Slurm; tests/slurm/run does it"),
    (r"tools/bench .*", "sh -n tools/bench && grep add_argument tools/benchmark/bench.py", "installs packages; minutes"),
    (r"tools/fuzz --decks \d+ (.*)", r"tools/fuzz --decks 40 \1", "minutes; the ctest `fuzzed_decks` runs more"),
    (r"tools/deceive --scenes .*", "tools/deceive --help", "an hour or more"),
    (r"tools/mutate --(mutants|only|again).*", "tools/mutate --help", "hours; builds"),
    (r"tools/fuzz --minutes .*", "tools/fuzz --decks 4 --program build/release/epcont", "minutes; builds the preset sanitize"),
    (r"tools/paraview .*", "sh -n tools/paraview && python3 tools/paraviews.py --help", "wants ParaView; the ctest `vtk_paraview` runs it"),
    (r"tools/make_venv \w+", "sh -n tools/make_venv", "fetches packages; the ctest `tools_make_venv` runs it"),
    (r"tests/in_venv", "sh -n tests/in_venv", "runs a test"),
    (r"tools/plot --all", "tools/plot --help", "minutes"),
    (r"tools/decks hertz (42|11)000(.*)", r"tools/decks hertz \g<1>0\2", "as much for a smaller one"),
    (r"tools/convergence", "tools/convergence --help", "the same without the picture"),
    (r"tools/tradeoff .*", "build/venv/bin/python tools/tradeoffs.py --help", "minutes; installs GNU time"),
    (r"(python tests/independent/compare.py \S+) input/.*", r"\1 input/hertz/hertz44.dat tests/independent/cases/*_size8.dat", "minutes"),
    (r"(python tests/independent/compare.py \S+) --random 300(.*)", r"\1 --random 6\2", "minutes"),
]
# Words of the text that stand for the reader's own files.
STAND_FOR = {
    "<deck>": "hertz44", "DECK...": "hertz44.dat", "DECK": "hertz44.dat", "SCENE.toml": "scene.toml", "SCENE": "hertz",
    "DIR": "out", "NAME.png": "name.png", "NAME": "GRID", "FILE": "file.dat", "OLD": "old", "NEW": "new",
    "DECK.in": "spring.in", "TABLE.csv": "values.csv", "F": "1", "n": "4", "M": "1",
}
COMMAND = re.compile(r"(?:tools|tests|build)/[\w/]+(?= |$)|(?:epcont|cmake|ctest|python|sed|awk|sudo apt) |\. tools/venv")
# A command ends at two blanks outside quotes; a remark follows.
LINE = re.compile(r"((?:'[^']*'|\"[^\"]*\"|[^\s'\"]| (?! ))+)(?:\s+(.*))?")
FOR_DRAWING = re.compile(r"\b(?:tools/(?:plot|deck|convergence|tradeoffs?|venv)\b(?!/)|python tests/independent/)")
FILE = re.compile(r"[\w*./]+\.(?:lst|csv|dat|bdf|png)\b")


@dataclasses.dataclass
class Command:
    place: str
    text: str
    remark: str = ""
    shown: list = dataclasses.field(default_factory=list)


def paragraphs(text):
    """(line number, lines) of each part between blank lines; a fenced part is one, whatever its content."""
    part, fenced = [], False
    for number, line in enumerate([*text.splitlines(), ""], 1):
        if line.startswith("```"):
            fenced = not fenced
        if line.strip() or fenced:
            part.append((number, line))
        elif part:
            yield part[0][0], [each for _, each in part]
            part = []


def of_block(name, number, lines):
    """Commands of an indented block; lines between them are the output of the command above."""
    commands = []
    for n, line in enumerate(lines, number):
        text, remark = LINE.fullmatch(line[4:].rstrip()).groups() if LINE.fullmatch(line[4:].rstrip()) else (line[4:], "")
        if COMMAND.match(text):
            commands.append(Command(f"{name}:{n}", text, (remark or "").lstrip("# ")))
        elif commands:
            commands[-1].shown.append(line[4:])
    return commands


def of_listing(name, number, lines, before):
    """Lines of a fenced part from the listing that the paragraph before names."""
    named = re.search(r"^From `(\w+)\.lst`", before)
    shown = [line for line in lines[1:-1] if line.strip() != "..."]
    return [Command(f"{name}:{number}", f"epcont input/*/{named[1]}.dat && cat {named[1]}.lst", shown=shown)] if named else []


def of_text(name, number, lines):
    """Commands between backquotes: complete ones unchanged; for those with choices the options, which --help must have."""
    commands = []
    for span in re.findall(r"`([^`]+)`", "\n".join(lines)):
        text = " ".join(span.split())
        if not COMMAND.match(text) or " " not in text and not (text.startswith("tests/") and (TOP / text).is_file()):
            continue
        if re.search(r"[\[|]", text):
            options = re.findall(r"(?<![\w-])--?[a-z][a-z-]*", text)
            tool = text.split()[0]
            if options and tool.startswith("tools/"):
                commands.append(Command(f"{name}:{number}", f"{tool} --help", shown=options))
                continue
            if not text.startswith(("cmake", "ctest")):
                continue
        words = "|".join(re.escape(word) for word in sorted(STAND_FOR, key=len, reverse=True))
        text = re.sub(rf"(?<![\w./-])(?:{words})(?![\w./])|<deck>", lambda word: STAND_FOR[word[0]], text)
        commands.append(Command(f"{name}:{number}", text))
    return commands


def blocks(name, text):
    """Lists of commands that run one after the other in one place."""
    before = ""
    for number, lines in paragraphs(text):
        if lines[0].startswith("    "):
            yield of_block(name, number, lines)
        elif lines[0].startswith("```"):
            yield of_listing(name, number, lines, before)
        else:
            yield of_text(name, number, lines)
        before = " ".join(lines)


def as_run(command):
    """(command to run, reason for a replacement)."""
    for pattern, other, why in INSTEAD:
        match = re.fullmatch(pattern, command.text)
        if match:
            return other and match.expand(other), why
    return command.text, ""


def chosen(block, group):
    """Commands of a block that a group runs: `plain` those that need no venv, nor a file from one that does; `drawing` the others, and before
    them those that write a file for them."""
    plain, made = [], []
    for command in block:
        if FOR_DRAWING.search(as_run(command)[0] or "") or any(name in command.text for name in made):
            made += re.findall(r"-o (\S+\.dat)", command.text)
        else:
            plain.append(command)
    if group == "plain":
        return plain
    drawing = []
    for command in reversed(block):
        written = re.findall(r"(?:-o|>) (\S+)", command.text)
        if command not in plain or any(name in later.text for name in written for later in drawing):
            drawing.insert(0, command)
    return drawing


def stand_in(folder):
    """A build of the executable under test: cmake finds nothing to do in it, ctest finds a test for each label."""
    folder.mkdir(parents=True)
    (folder / "epcont").symlink_to(PROGRAM)
    (folder / "CMakeCache.txt").write_text(f"CMAKE_PROJECT_NAME:STATIC=epcont\nCMAKE_GENERATOR:INTERNAL=Unix Makefiles\n"
                                             f"CMAKE_MAKE_PROGRAM:FILEPATH={shutil.which('make')}\n")
    (folder / "Makefile").write_text("all epcont:\n\t@:\n")
    labels = [path.name for path in (TOP / "tests").iterdir() if path.is_dir()]
    (folder / "CTestTestfile.cmake").write_text("".join(
        f'add_test({label} true)\nset_tests_properties({label} PROPERTIES LABELS {label})\n' for label in labels))


def of_the_reader(place):
    """The reader's own files."""
    (place / "decks").mkdir()
    for name in ("hertz44", "hertz44_elastic"):
        shutil.copy(place / f"input/hertz/{name}.dat", place / "decks")
    (place / "decks.txt").write_text("decks/hertz44.dat\ninput/bar/bar.dat\n")
    material = re.compile(r"^MAT1    1       20400\.          \.29", re.MULTILINE)
    (place / "spring.in").write_text(material.sub("MAT1    1       %E%             %nu%", (place / "decks/hertz44.dat").read_text()))
    (place / "values.csv").write_text("E,nu\n20400.,0.29\n20400.,0.3\n")
    scene = (place / "input/from_gmsh/two_cylinders.toml").read_text()
    (place / "scene.toml").write_text(scene.replace("two_cylinders.geo", "input/from_gmsh/two_cylinders.geo"))
    shutil.copy(place / "input/hertz/hertz44.dat", place)
    subprocess.run([PROGRAM, place / "hertz44.dat", "-o", place / "out", "--tables", "all", "--quiet"], check=True)
    for folder in ("old", "new"):
        (place / folder).mkdir()
        shutil.copy(place / "out/hertz44.lst", place / folder / "deck.lst")


def workplace(folder):
    place = folder / "epcont"
    shutil.copytree(TOP, place, symlinks=True, ignore=lambda at, names: {"build", ".git"} if pathlib.Path(at) == TOP else {"__pycache__"})
    for preset in ("release", "debug", "sanitize"):
        stand_in(place / "build" / preset)
    if (TOP / "build/venv/installed").exists():
        (place / "build/venv").symlink_to(TOP / "build/venv")
    of_the_reader(place)
    return place


def run(text, place):
    if text.startswith("python "):   # the line that enters it is above, for all blocks of a page
        text = ". tools/venv && " + text
    environment = {**os.environ, "PATH": f"{place / 'build/release'}:{os.environ['PATH']}", "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(["bash", "-c", text], cwd=place, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace")


def status_of_fault(text, place):
    """The exit status of a deck according to the table of all decks, for a command that ends with `echo $?`."""
    row = re.search(rf"\({re.search(r'input/(.*?).dat', text)[1]}\.dat\) .*exit status (\d)", (place / "input/verification.md").read_text())
    return row[1]


def faults(command, text, done, place):
    """Differences from the document."""
    wanted = int((re.search(r"exit status (\d+)", command.remark) or [0, 0])[1])
    if done.returncode != wanted:
        yield f"exit status {done.returncode}, not {wanted}"
    if text.endswith("echo $?") and done.stdout.split()[-1:] != [status_of_fault(text, place)]:
        yield f"prints another status than {status_of_fault(text, place)}"
    if text.startswith("awk") and not re.search(r"\d", done.stdout):
        yield "prints no number"
    if "No tests were found" in done.stdout:
        yield "names no test"
    for line in command.shown:
        if line.rstrip() not in done.stdout:
            yield f"does not print: {line}"
    if text != command.text:
        return
    number = re.match(r"[-\d][-+.\dE]*$", command.remark)
    if number and number[0] not in done.stdout.split():
        yield f"does not print {number[0]}"
    for name in FILE.findall(command.remark):
        if not list(place.glob(name)):
            yield f"writes no {name}"


def spoilt(place):
    """Kept decks of input that a command has changed; they are restored."""
    for kept in sorted((place / "input").rglob("*.dat")):
        if not filecmp.cmp(kept, TOP / kept.relative_to(place)):
            shutil.copy2(TOP / kept.relative_to(place), kept)
            yield f"writes over {kept.relative_to(place)}"


def try_block(block, place, told):
    """Run the commands of a block, then remove their files; return the number of faults."""
    before, wrong = set(place.rglob("*")), 0
    for command in block:
        text, why = as_run(command)
        begun = time.monotonic()
        found = []
        if text:
            done = run(text, place)
            found = [*faults(command, text, done, place), *spoilt(place)]
        instead = f"  [{why}; instead: {text or 'nothing'}]" if why else ""
        told(f"{command.place}: {command.text}{instead}  {time.monotonic() - begun:.1f} s")
        for fault in found:
            told(f"    {fault}")
        if found:
            told("        " + "\n        ".join(done.stdout.splitlines()[-25:]))
        wrong += bool(found)
    for path in sorted(set(place.rglob("*")) - before, reverse=True):
        path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()
    return wrong


def documents():
    """All pages of the repository, except built or fetched ones."""
    parts = [part for part in sorted(TOP.iterdir()) if part.is_dir() and part.name not in ("build", ".git")]
    return sorted(TOP.glob("*.md")) + [path for part in parts for path in sorted(part.rglob("*.md"))]


def shown_commands():
    """The blocks of each page except those about changes, which describe the past."""
    names = [path.relative_to(TOP).as_posix() for path in documents() if path.name != "CHANGELOG.md"]
    return [list(blocks(name, (TOP / name).read_text(encoding="utf-8"))) for name in names]


def main():
    group, part = sys.argv[1], " ".join(sys.argv[2:])
    pages = shown_commands()
    texts = [command.text for page in pages for block in page for command in block]
    idle = [pattern for pattern, _, _ in INSTEAD if not any(re.fullmatch(pattern, text) for text in texts)]
    print("".join(f"no document has this any more: {pattern}\n" for pattern in idle), end="")
    wrong, tried = len(idle), 0
    for page in pages:
        taken = [block for block in (chosen(block, group) for block in page) if any(part in command.text for command in block)]
        if not taken:
            continue
        with tempfile.TemporaryDirectory() as folder:
            place = workplace(pathlib.Path(folder))
            for block in taken:
                wrong += try_block(block, place, lambda line: print(line, flush=True))
                tried += len(block)
    print(f"{tried} commands, {wrong} faults")
    return 1 if wrong or not tried else 0


if __name__ == "__main__":
    sys.exit(main())
