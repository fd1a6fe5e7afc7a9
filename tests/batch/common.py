"""Shared by the tests of tools/batch and tools/sweep: folders, and programs that misbehave."""
import csv
import os
import pathlib
import runpy
import stat
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests")]
import copies  # noqa: E402
from batching import running, slurm  # noqa: E402

PROGRAM = str(pathlib.Path(os.environ["EPCONT_PROGRAM"]).resolve())
SMALL = ROOT / "input" / "hertz" / "hertz44_elastic.dat"
REJECTED = ROOT / "input" / "faults" / "no_suport.dat"

# Misbehaves as the names of the decks tell it; otherwise it runs the program.
FAKE = """#!/bin/sh
[ "$1" = --version ] && exec "{program}" --version
out=; before=; for word; do [ "$before" = -o ] && out=$word; before=$word; done
for deck; do
  [ "$deck" = -o ] && break
  echo "$deck" >> {folder}/calls
  case "$deck" in
    *segfault*) kill -SEGV $$ ;;
    *killed*) kill -KILL $$ ;;
    *ended*) kill -TERM $$ ;;
    *hangs*) [ -e {folder}/calm ] || {{ echo $$ >> {folder}/pids; sleep 60 & wait; }} ;;
    *deaf*) trap '' TERM; echo $$ >> {folder}/pids; while :; do sleep 1; done ;;
    *half*) printf 'epcont 0.0.0\\n\\nDECK\\n  GRI' > "$out/$(basename "$deck" .dat).lst"; exit 0 ;;
    *silent*) exit 0 ;;
    *strange*) exit 77 ;;
    *chatter*) i=0; while [ $i -lt 20000 ]; do echo "a line of chatter $i"; i=$((i+1)); done >&2; exit 2 ;;
    *cut*) "{program}" "$@"; sed -i '/^ACCURACY/,$d' "$out/$(basename "$deck" .dat).lst"; exit 0 ;;
    *full*) "{program}" "$@"; rm "$out/$(basename "$deck" .dat).contact.csv"; echo "contact.csv: cannot be written" >&2; exit 3 ;;
    *lies*) "{program}" "$@"; exit 1 ;;
  esac
done
exec "{program}" "$@"
"""


class Case(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.place = pathlib.Path(directory.name)
        self.fake = self.place / "fake"
        self.fake.write_text(FAKE.format(program=PROGRAM, folder=self.place))
        self.fake.chmod(stat.S_IRWXU)

    def deck(self, name, source=SMALL):
        path = self.place / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(source.read_bytes())
        return path

    def decks(self, *names):
        return [self.deck(name, REJECTED if "rejected" in name else SMALL) for name in names]

    def command(self, tool, *arguments):
        program = () if "--collect" in arguments or "--program" in arguments else ("--program", PROGRAM)
        return [sys.executable, "-B", str(ROOT / "tools" / tool), *map(str, arguments), *program]

    def run_it(self, status, *arguments, tool="batch", env=None):
        """Run the tool in a copy of this process, with ten times shorter waits for Slurm and for runs that hang."""
        def start():
            slurm.SHORTEST, running.GRACE = slurm.SHORTEST / 10, running.GRACE / 10
            runpy.run_path(words[2], run_name="__main__")

        words = self.command(tool, *arguments)
        run = copies.run(start, *words[2:], cwd=self.place, env=env)
        self.assertEqual(status, run.returncode, run.stdout + run.stderr)
        return run

    def table(self, directory="out"):
        with open(self.place / directory / "batch.csv", newline="") as file:
            return list(csv.DictReader(file))

    def words(self, directory="out"):
        return {row["deck"]: row["status"] for row in self.table(directory)}

    def calls(self):
        """Number of calls of the fake program, by deck; it is reset."""
        path = self.place / "calls"
        found = path.read_text().split("\n")[:-1] if path.exists() else []
        path.write_text("")
        return sorted(pathlib.Path(name).name for name in found)

    def nothing_runs(self):
        """Check that the processes noted by the fake program have ended, with their children. A killed process may need a moment on a busy machine."""
        limit = time.monotonic() + 5
        while (left := self.running()) and time.monotonic() < limit:
            time.sleep(0.05)
        self.assertEqual([], left)

    def running(self):
        """Process ids of the noted groups, without zombies, which only wait for their parent."""
        groups, left = (self.place / "pids").read_text().split(), []
        for path in pathlib.Path("/proc").glob("[0-9]*/stat"):
            try:
                state, _, group = path.read_text().rpartition(")")[2].split()[:3]
            except OSError:
                continue
            if group in groups and state != "Z":
                left.append(path.parent.name)
        return left
