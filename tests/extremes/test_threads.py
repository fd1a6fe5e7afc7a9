"""Threads must not matter: the same bytes with any number of them, and as many as are allowed and useful."""
import functools
import os
import pathlib
import resource
import subprocess
import tempfile
import time
import unittest

from scene import PROGRAM, STEEL, Deck, Extremes, solve
from test_contacts import row
from test_scales import punch

#: The last one: the first number of a list counts, the second is for nested regions.
COUNTS = (1, 2, 3, 8, "1,2")
FEW = (1, 3)   # for large bodies, and for models that differ little from one that runs with all of them


def stack(bodies=4, across=28, young=STEEL[0], parameters=(), stress=None):
    """Stacked blocks, each higher than the one below, the load on the left half; `stress`: yield stress."""
    deck = Deck(young, STEEL[1])
    for name, value in parameters:
        deck.parameter(name, value)
    if stress:
        deck.curve(1, [(stress/young, stress), (0.2, 3.0*stress)])
    xs, blocks, begin = [i/across for i in range(across + 1)], [], 0.0
    for k in range(bodies):
        blocks.append((xs, [begin + j/across for j in range(across + 6*k + 1)]))
        begin = blocks[-1][1][-1]
    deck.press(deck.stack(blocks, 100000)[-1][:across//2 + 1], 100.0)
    return deck


def brittle(deck, *bodies):
    """A soft layer below blocks of a stack: rounding destroys their stiffness as a whole."""
    deck.material(2, 1e-14*STEEL[0], STEEL[1])
    for k, (name, *fields) in enumerate(deck.cards):
        if name == "CQUAD4" and fields[2] // 100000 in bodies and fields[2] % 100000 < 29*4:
            deck.cards[k] = (name, fields[0], 2, *fields[2:])
    return deck


class Bytes(Extremes):
    """The same for models with matrices large enough for several threads."""

    def same(self, deck, status=0, counts=COUNTS):
        one, *others = [solve(deck, threads=count) for count in counts]
        self.assertEqual(status, one.status, one.message)
        self.assertIn("scene.lst", one.files)
        for other in others:
            self.assertEqual((one.status, one.message), (other.status, other.message))
            self.assertEqual(one.files, other.files)
        return one

    def test_of_the_blas(self):
        for deck in (punch(), row(150, lambda k: 1e-6*((k - 75)/75.0)**2, rule="CONRY"), row(300, lambda k: 1e-6*(k - 150.0)**2)):
            self.same(deck)

    def test_elastic(self):
        for solver in ("BAND", "FRONTAL"):
            with self.subTest(solver=solver):
                self.same(stack(parameters=[("SOLVER", solver)]))

    def test_yielding(self):
        for solver in ("BAND", "FRONTAL"):
            for parameters in ([], [("NLOAD", 2)]):
                with self.subTest(solver=solver, parameters=parameters):
                    result = self.same(stack(3, parameters=[("SOLVER", solver), *parameters], stress=120.0),
                                       counts=FEW if parameters else COUNTS)
                    self.assertGreater(result.summary["plastic_elements"], 100)

    def test_large_body(self):
        """Large enough that threads share its dissection, its solves and the loops over its points, too."""
        self.same(stack(1, 150, stress=120.0), counts=FEW)

    def test_joined_bodies_with_a_platen(self):
        """Nodes of a platen share an equation: one thread adds the forces on them."""
        deck = Deck(*STEEL)
        deck.parameter("RULE", "JOINED")
        nodes = deck.block(1, [i/300 for i in range(301)], [j/300 for j in range(81)])
        deck.stand(nodes, 100.0, gaps=[1e-6*((k - 150)/150.0)**2 for k in range(301)])
        deck.cards.remove(("SUPORT", nodes[-1][-1], 2))
        deck.card("RBE2", 900001, nodes[-1][0], 2, *nodes[-1][1:])
        self.same(deck, counts=(1, 2, 3, 8))

    def test_large_body_of_triangles(self):
        """Elements in several parts, half of them clockwise: threads read, check, compare and certify them."""
        deck = Deck(*STEEL)
        deck.stand(deck.block(1, [i/150 for i in range(151)], [j/150 for j in range(151)], triangles=True), 100.0)
        for k, (name, *fields) in enumerate(deck.cards):
            if name == "CTRIA3" and fields[0] % 2:
                deck.cards[k] = (name, *fields[:2], *fields[:1:-1])
        self.same(deck, counts=FEW)

    def test_faults_of_a_long_deck(self):
        """Whichever thread reads a card, errors come in the order of the lines."""
        deck = stack(1, 150)
        for k in range(3000, len(deck.cards), 4001):
            name, *fields = deck.cards[k]
            deck.cards[k] = (name, *fields[:2], "1x", "no" if name == "GRID" else fields[3], *fields[4:])
        one, *others = [solve(deck, threads=count) for count in COUNTS]
        self.assertEqual(2, one.status)
        self.assertGreater(one.message.count("'1x'") + one.message.count("1x"), 5)
        self.assertEqual([one.message]*len(others), [other.message for other in others])

    def test_many_bodies(self):
        self.same(stack(12, 24, parameters=[("SOLVER", "BAND")]), counts=FEW)

    def test_singular_bodies(self):
        """Rounding decides whether such a body can be factored, not the order of the threads."""
        result = self.same(brittle(stack(), 2, 4), status=4)
        self.assertRegex(result.message, "the stiffness of the body of GRID [24]00000")

    def test_little_memory(self):
        """If there is no memory for more threads, one does everything."""
        if b"__asan_init" in pathlib.Path(PROGRAM).read_bytes():
            self.skipTest("the address sanitizer maps more than any limit")
        free = solve(stack(), threads=1)
        for megabytes in range(720, 2000, 160):
            with self.subTest(megabytes=megabytes):
                limit = functools.partial(resource.setrlimit, resource.RLIMIT_AS, (megabytes*1000000,)*2)
                limited = solve(stack(), threads=4, preexec_fn=limit)
                self.assertEqual((0, free.files), (limited.status, limited.files), limited.message)


class Counts(Extremes):
    """Largest number of threads in a run."""

    def most(self, deck, **environment):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory)/"scene.dat"
            path.write_text(deck.text())
            kept = {name: value for name, value in os.environ.items() if not name.startswith(("OMP_", "GOMP_", "OPENBLAS_"))}
            with subprocess.Popen([PROGRAM, path, "-o", directory, "--quiet"], env={**kept, **environment}) as run:
                most = 0
                while run.poll() is None:
                    try:
                        most = max(most, len(os.listdir(f"/proc/{run.pid}/task")))
                    except FileNotFoundError:
                        break
                    time.sleep(0.001)
            self.assertEqual(0, run.returncode)
            return most

    def setUp(self):
        """With a BLAS that allows threads, if OpenMP is built in: otherwise always one."""
        if self.most(stack(), OMP_NUM_THREADS="2") == 1:
            self.skipTest("one thread: built without OpenMP, or a BLAS that does not allow more")

    def test_as_many_as_are_granted(self):
        for count in (1, 2, 3):
            self.assertEqual(count, self.most(stack(), OMP_NUM_THREADS=str(count)))
        self.assertEqual(2, self.most(stack(), OMP_NUM_THREADS="2,4"))

    def test_one_by_default(self):
        self.assertEqual(1, self.most(stack()))
        for words in ("", "0", "many", "-2"):
            self.assertEqual(1, self.most(stack(), OMP_NUM_THREADS=words))

    def test_no_more_than_pay(self):
        self.assertLessEqual(self.most(stack(), OMP_NUM_THREADS="8"), 4)
        self.assertEqual(1, self.most(stack(12, 8), OMP_NUM_THREADS="8"))


if __name__ == "__main__":
    unittest.main(verbosity=2)   # shows why a test is skipped
