#!/usr/bin/env python3
"""tools/mutate: its changes of a snippet, text that it does not change, the mutants of a seed, and the judgement of a mutant."""
import contextlib
import io
import pathlib
import sys
import tempfile
import unittest

from common import ROOT, load
from mutating.mutants import Mutant, choose, mutants_of, real_text
from mutating.trial import Trial

SNIPPET = """\
!> Twice 2.0 < 3.
module epcont_a_b2
  use epcont_base_kinds, only: wp
  real(wp), parameter :: tolerance = 1.0e-9_wp   ! of 2
  character(len=*), parameter :: text = 'a < 3 .and. b'
  real(wp), allocatable :: x(:, :)
contains
  pure real(wp) function twice(x) result(y)
    real(wp), intent(in) :: x(2, 3)
    if (x(1, i) > 0.5_wp .and. .not. far .or. n <= 1) then
      y = -x(2, k)*2 + min(a, b)**3/c
    end if
    print *, y // 'b'
    call of(a => b, kind=4) ; y = merge(1.5d0, a%b3, all(q /= r))
    real_part = long + &
      (y - 7)
  end function twice
"""


def changes(snippet):
    return [(m.line, m.old, m.new) for m in mutants_of("a.f90", snippet)]


class Generator(unittest.TestCase):

    def test_snippet(self):
        """All changes, in the order of the text; none in comments, strings, names, kinds, shapes and arguments."""
        self.assertEqual(changes(SNIPPET), [
            (4, "1.0e-9", "1.0e-12"), (4, "1.0e-9", "1.0e-6"), (4, "1.0e-9", "0.001"),
            (10, "1", "2"), (10, "1", "0"), (10, ">", "<"), (10, "0.5", "0.0005"), (10, "0.5", "500.0"), (10, ".and.", ".or."),
            (10, ".not.", ""), (10, ".or.", ".and."), (10, "<=", ">"), (10, "<=", "<"), (10, "1", "2"), (10, "1", "0"),
            (11, "-", "+"), (11, "2", "3"), (11, "2", "1"), (11, "*", "/"), (11, "2", "3"), (11, "2", "1"), (11, "+", "-"),
            (11, "min", "max"), (11, "3", "4"), (11, "3", "2"), (11, "/", "*"),
            (14, "4", "5"), (14, "4", "3"), (14, "1.5d0", "0.0015"), (14, "1.5d0", "1500.0"), (14, "all", "any"), (14, "/=", "=="),
            (15, "+", "-"), (16, "-", "+"), (16, "7", "8"), (16, "7", "6")])

    def test_applied(self):
        mutant = next(m for m in mutants_of("a.f90", SNIPPET) if m.new == "max")
        self.assertEqual(mutant.applied(SNIPPET), SNIPPET.replace("min(a, b)", "max(a, b)"))

    def test_reals(self):
        self.assertEqual([real_text(text, factor) for text, factor in (("0.0", 1e3), ("2.", 1e3), (".5", 1e-3), ("1.0e-9", 1e6), ("3d5", 1e-3))],
                         ["1.0", "2000.0", "0.0005", "0.001", "300.0"])

    def test_seed(self):
        """A seed's mutants stay the same if other lines change; one of each place, of each class in turn."""
        mutants = mutants_of("a.f90", SNIPPET)
        one = [m.key for m in choose(mutants, 1, 8)]
        longer = mutants_of("a.f90", "! a line more\n" + SNIPPET)
        self.assertEqual(one, [m.key for m in choose(longer, 1, 8)])
        self.assertNotEqual(one, [m.key for m in choose(mutants, 2, 8)])
        places = [(m.line, m.column) for m in choose(mutants, 1, 100)]
        self.assertEqual(len(places), len(set(places)))
        self.assertEqual(len(places), len({(m.line, m.column) for m in mutants}))
        kinds = {m.old for m in choose(mutants, 1, 6)}
        self.assertTrue(kinds & {"min"} and kinds & {"1.0e-9", "0.5", "1.5d0"}, kinds)

    def test_twins(self):
        """Equal lines are separate mutants."""
        mutants = mutants_of("a.f90", "x = 1\ny = 2\n  x = 1\n")
        self.assertEqual([m.key for m in mutants if m.new == "2"], ["a.f90|x = 1|4|2", "a.f90|x = 1|4|2|1"])

    def test_sources(self):
        """All layers that affect results."""
        mutate = load("mutate")
        self.assertEqual({path.split("/")[1] for path in mutate.sources()},
                         {"contact", "contact_geometry", "geometry", "certificate", "plasticity", "flexibility", "accuracy", "messages", "result", "verdict.f90"})


class Judged(Trial):
    """Tests are functions of the source; nothing is built."""

    def __init__(self, place, tests):
        super().__init__(ROOT, place, 1.0)
        self.given, self.built = tests, True
        self.baseline = {name: 0.0 for name in tests}
        self.tests = {name: ([name], {}, {"contact"}) for name in tests}
        (self.tree / "src").mkdir(parents=True)

    def build(self):
        return self.built

    def run(self, name, seconds):
        return self.given[name]((self.tree / "src/a.f90").read_text()), 0.0


class Judging(unittest.TestCase):

    def judge(self, source, mutant, tests, built=True):
        with tempfile.TemporaryDirectory() as folder:
            trial = Judged(pathlib.Path(folder), tests)
            trial.built = built
            (trial.tree / "src/a.f90").write_text(source)
            verdict = trial.judge(mutant, {"contact"}, {}, 10.0)
            self.assertEqual((trial.tree / "src/a.f90").read_text(), source)   # as it was
            return verdict

    def test_verdicts(self):
        source, mutant = "y = 1 + x\n", Mutant("src/a.f90", 1, 4, "1", "2", "y = 1 + x")
        tests = {"blind": lambda text: True, "sees": lambda text: "1 + x" in text}
        self.assertEqual(self.judge(source, mutant, tests), ("killed", "sees"))
        self.assertEqual(self.judge(source, mutant, {"blind": tests["blind"]}), ("survived", "1 tests"))
        self.assertEqual(self.judge(source, mutant, tests, built=False), ("does not compile", ""))

    def test_tests_that_kill_come_first(self):
        with tempfile.TemporaryDirectory() as folder:
            trial = Judged(pathlib.Path(folder), dict.fromkeys("abc"))
            trial.tests["c"] = (["c"], {}, {"linalg"})
            self.assertEqual(trial.order({"contact"}, {}), ["a", "b", "c"])
            self.assertEqual(trial.order({"contact"}, {"b": 1}), ["b", "a", "c"])
            trial.baseline["a"] = 10.0
            self.assertEqual(trial.order({"contact"}, {}), ["b", "c", "a"])

    def test_results_go_on(self):
        """A line of the table for each mutant, keeping notes written by hand."""
        mutate = load("mutate")
        mutant = Mutant("src/contact/a.f90", 1, 4, "1", "2", "y = 1 + x")
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "results.csv"
            mutate.Results(path).add(mutant, "survived", "3 tests")
            path.write_text(path.read_text().replace("3 tests,", "3 tests,\"y is not used, ever\""))
            results = mutate.Results(path)
            results.add(mutant, "killed", "test_a")
            self.assertEqual(path.read_text().splitlines(), [
                "mutant,line,old,new,verdict,by,why,key",
                'src/contact/a.f90:1,y = 1 + x,1,2,killed,test_a,"y is not used, ever",src/contact/a.f90|y = 1 + x|4|2'])
            self.assertEqual(mutate.Results(path).kills("src/contact/b.f90"), {"test_a": 1})
            self.assertEqual(mutate.Results(path).kills("src/model/b.f90"), {})

    def test_list(self):
        """--list lists mutants, and changes nothing."""
        mutate, said = load("mutate"), io.StringIO()
        with contextlib.redirect_stdout(said):
            sys.argv = ["mutate", "--list", "--mutants", "5", "--only", "certificate/", "--only", "parameter"]
            self.assertEqual(mutate.main(), 0)
        lines = said.getvalue().splitlines()
        self.assertEqual(len(lines), 5)
        for line in lines:
            self.assertRegex(line, r"^src/certificate/\w+\.f90:\d+: \S+ -> \S+: .*parameter")


if __name__ == "__main__":
    unittest.main()
