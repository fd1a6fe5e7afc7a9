"""The manual page: no roff warnings, the files of a run, and working examples."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

PROGRAM, ROOT = os.environ["EPCONT_PROGRAM"], pathlib.Path(os.environ["EPCONT_SOURCE_DIR"])
DECK = ROOT / "input" / "hertz" / "hertz44.dat"
PAGE = subprocess.run([PROGRAM, "--man"], capture_output=True, check=True).stdout.decode("ascii")

#: A block pressed on another, and pushed.
FRICTION = """BEGIN BULK
PARAM,PLANE,STRAIN
GRID,1,,0.,0.
GRID,2,,1.,0.
GRID,3,,1.,1.
GRID,4,,0.,1.
GRID,5,,0.,1.
GRID,6,,1.,1.
GRID,7,,1.,2.
GRID,8,,0.,2.
CQUAD4,1,1,1,2,3,4
CQUAD4,2,1,5,6,7,8
PSHELL,1,1,1.
MAT1,1,1000.,,.3
SPC1,1,12,1,2
SPC,1,7,2,-.01,8,2,-.01
SPC,1,7,1,.001,8,1,.001
BLSEG,1,4,3
BLSEG,2,5,6
BCONP,1,2,1,,,4
BFRIC,4,,,.2
ENDDATA
"""


def section(name):
    """Lines of a section, as typed."""
    text = re.search(rf"^\.SH {name}\n(.*?)(?=^\.SH |\Z)", PAGE, re.MULTILINE | re.DOTALL)[1]
    return text.replace(r"\-", "-").replace(r"\&", "").splitlines()


class Page(unittest.TestCase):
    def quiet(self, *command):
        if not shutil.which(command[0]):
            self.skipTest(f"no {command[0]}")
        run = subprocess.run(command, input=PAGE.encode(), capture_output=True)
        return run.stdout.decode("utf-8"), run.stderr.decode("utf-8"), run.returncode

    def test_groff(self):
        shown, said, status = self.quiet("groff", "-man", "-ww", "-Tutf8")
        self.assertEqual(("", 0), (said, status))
        self.assertIn("\nEXIT STATUS\n", re.sub(".\b", "", shown))   # bold letters are printed twice

    def test_mandoc(self):
        self.assertEqual(("", "", 0), self.quiet("mandoc", "-T", "lint", "-W", "style"))

    def test_a_fault_is_found(self):
        """The checker detects a font that is never closed and an unknown request."""
        if not shutil.which("groff"):
            self.skipTest("no groff")
        run = subprocess.run(["groff", "-man", "-ww", "-Tutf8"], input=PAGE.encode() + b".XYZ\n", capture_output=True)
        self.assertIn(b"XYZ", run.stderr)

    def test_sections(self):
        self.assertEqual(["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "FILES", "EXAMPLES", "ENVIRONMENT", "COPYRIGHT"],
                         re.findall(r"^\.SH (.*)", PAGE, re.MULTILINE))

    def test_title(self):
        """Date and version are the program's."""
        source = (ROOT / "src" / "base" / "version.f90").read_text()
        date, version = (re.search(rf"{name} = '([^']+)'", source)[1] for name in ("program_date", "program_version"))
        self.assertEqual(f'.TH EPCONT 1 {date} "epcont {version}" "User Commands"', PAGE.splitlines()[0])
        said = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=True).stdout
        self.assertEqual(f"epcont {version}\n", said)

    def test_lines(self):
        """No blank line, which roff would take for a paragraph, and no blank at the end of a line."""
        for line in PAGE.splitlines():
            self.assertTrue(line and line == line.rstrip(), line)

    def test_files(self):
        """FILES lists the files of a run with all outputs, and the columns of its tables."""
        with tempfile.TemporaryDirectory() as place:
            subprocess.run([PROGRAM, DECK, "-o", place, "--tables", "all", "--vtk", "--quiet"], check=True)
            written = {path.name.replace("hertz44", "", 1): path.read_bytes() for path in pathlib.Path(place).iterdir()}
        with tempfile.TemporaryDirectory() as place:   # with those that only a sequence of load cases has
            deck = pathlib.Path(place, "hertz44.dat")
            text = pathlib.Path(DECK).read_text(encoding="ascii")
            bulk = text[text.index("BEGIN BULK"):].replace("SECANT", "NEWTON").replace("BEGIN BULK\n", "BEGIN BULK\nPARAM,SAVE,YES\n")
            deck.write_text("CNTNLSUB = YES\nSUBCASE 1\nLOAD = 1\nSUBCASE 2\nLOAD = 1\n" + bulk, encoding="ascii")
            subprocess.run([PROGRAM, deck, "-o", place, "--vtk", "--tables", "all", "--quiet"], check=True)
            written |= {f".{path.name.split('.', 1)[1]}": re.sub(rb"^subcase,(?=increment|element)", b"", path.read_bytes())
                        for path in pathlib.Path(place).iterdir()
                        if re.search(r"\.(cases\.csv|increments\.csv|plastic\.csv|pvd|restart)$", path.name)}
            self.assertTrue(pathlib.Path(place, "hertz44.case2.contact.vtu").exists())
            deck.write_text(FRICTION, encoding="ascii")
            subprocess.run([PROGRAM, deck, "-o", place, "--quiet"], check=True)
            written[".friction.csv"] = pathlib.Path(place, "hertz44.friction.csv").read_bytes()
        files = dict(text.split("\n", 1) for text in "\n".join(section("FILES")).split(".IB DECK ")[1:])
        self.assertEqual(set(written), set(files))
        for name, text in files.items():
            columns = re.search(r"^Columns: (.*?)\.$", text, re.DOTALL | re.MULTILINE)
            head = written[name].split(b"\n")[0].decode(errors="replace")
            self.assertEqual(bool(columns), name.endswith(".csv") and head != "key,value,unit", name)
            if columns:
                self.assertEqual(head, re.sub(r"\s+\([^)]*\)|\s", "", columns[1]))

    def test_examples(self):
        commands = [line.split()[1:] for line in section("EXAMPLES") if line.startswith(".B ")]
        self.assertGreaterEqual(len(commands), 3)
        for text in section("EXAMPLES")[2::3]:
            self.assertTrue(text.endswith("."), text)   # nothing is cut off
        with tempfile.TemporaryDirectory() as place:
            shutil.copy(DECK, place)
            for command in commands:
                self.assertEqual("epcont", command[0])
                run = subprocess.run(" ".join(['"$EPCONT_PROGRAM"'] + command[1:]), shell=True, cwd=place, capture_output=True)
                self.assertEqual((0, b""), (run.returncode, run.stderr), command)
            self.assertTrue((pathlib.Path(place) / "out" / "hertz44.nodes.csv").exists())


class Options(unittest.TestCase):
    def test_the_parser_knows_no_other_option(self):
        """A name that is not in the table of options cannot be given; one that is not used has no effect."""
        source = "".join(file.read_text() for file in (ROOT / "src" / "app").glob("*.f90"))
        asked = set(re.findall(r"(?:case \(|%asks\()'(-[^']+)'\)", source))
        listed = subprocess.run([PROGRAM, "--help"], capture_output=True, check=True).stdout.decode().split("exit status")[0]
        named = {re.findall(r"-[\w-]+", line[:17])[-1] for line in listed.splitlines() if line.startswith("  -")}
        self.assertEqual(named, asked)


if __name__ == "__main__":
    unittest.main(verbosity=2)   # shows why a test is skipped
