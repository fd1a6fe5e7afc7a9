"""Models for the tests of extremes: decks written from a few parameters, run, and their tables read back.

Cards are written in free field with 17 digits, so that a deck holds the exact reals of the test.
"""
import csv
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["EPCONT_PROGRAM"]
PLANE_STRAIN, PLANE_STRESS, RINGS = -1, None, "rings"
STEEL = (2.1e5, 0.3)


def written(value):
    """A field: a blank, a word, an integer, or a real with its decimal point and all its digits."""
    if value is None:
        return ""
    if isinstance(value, (int, str)):
        return str(value)
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".e")


class Deck:
    """Cards in the order of the calls; with material 1, if its properties are given."""

    def __init__(self, *material, plane=PLANE_STRAIN):
        self.cards = []
        self.x = {}                     # of each GRID
        self.plane = plane
        self.elements = 0
        self.axes = {}                  # CORD2R of each normal
        if plane is PLANE_STRESS:
            self.card("PARAM", "PLANE", "STRESS")
        if material:
            self.material(1, *material)

    def card(self, *fields):
        self.cards.append(fields)

    def parameter(self, name, value):
        self.card("PARAM", name, value)

    def grid(self, number, x, y):
        self.x[number] = (x, y)
        self.card("GRID", number, None, x, y, 0.0)
        return number

    def material(self, number, young, poisson, thickness=1.0):
        """PSHELL or PSOLID and MAT1 of one number."""
        if self.plane is RINGS:
            self.card("PSOLID", number, number)
        else:
            self.card("PSHELL", number, number, thickness, *([self.plane] if self.plane else []))
        self.card("MAT1", number, young, None, poisson)

    def curve(self, number, points):
        """Yielding along (strain, stress) points; the first is the yield point."""
        self.card("MATS1", number, number, "NLELAST", None, 1, 1, points[0][1])
        flat = [0.0, 0.0] + [value for point in points for value in point] + ["ENDT"]
        self.card("TABLES1", number, *[None]*7, *flat)

    def element(self, material, *nodes, kind=None):
        self.elements += 1
        if kind == "CTRAX6":
            nodes = [nodes[k] for k in (0, 3, 1, 4, 2, 5)]
        triangle = "CTRAX3" if self.plane is RINGS else "CTRIA3"
        self.card(kind or {3: triangle, 4: "CQUAD4", 6: "CTRIA6"}[len(nodes)], self.elements, material, *nodes)
        return self.elements

    def block(self, material, xs, ys, first=1, triangles=False):
        """Nodes and elements of a grid of lines, of one material or of that of (column, row); returns its nodes, row by row upwards."""
        of = material if callable(material) else lambda i, j: material
        nodes = [[self.grid(first + j*len(xs) + i, x, y) for i, x in enumerate(xs)] for j, y in enumerate(ys)]
        for j, (lower, upper) in enumerate(zip(nodes, nodes[1:])):
            for i, (a, b, c, d) in enumerate(zip(lower, lower[1:], upper[1:], upper)):
                for corners in ((a, b, c), (a, c, d)) if triangles else ((a, b, c, d),):
                    self.element(of(i, j), *corners)
        return nodes

    def stand(self, nodes, load, gaps=None, first=70001):
        """Press a block by its upper row on a floor that lets it spread; its left end is fixed, the approach is that of the upper corners."""
        self.floor(nodes[0], gaps, first)
        self.hold(1, nodes[0][0])
        self.press(nodes[-1], load)
        self.support(2, nodes[-1][0], nodes[-1][-1])

    def stack(self, blocks, step):
        """Stacked blocks (xs, ys), their ids far apart, with pairs between them; the lowest is fixed, the others are
        unconstrained vertically and in rotation. Returns the upper row of each."""
        tops = []
        for k, (xs, ys) in enumerate(blocks):
            nodes = self.block(1, xs, ys, step*(k + 1))
            if tops:
                for i, (below, above) in enumerate(zip(tops[-1], nodes[0])):
                    self.pair(9_000_000 + 1000*k + i, below, above)
                self.hold(1, nodes[0][0])
                self.support(2, nodes[-1][0], nodes[-1][-1])
            else:
                self.hold(12, *nodes[0])
            tops.append(nodes[-1])
        return tops

    def hold(self, directions, *nodes):
        for node in nodes:
            self.card("SPC1", 1, directions, node)

    def displace(self, node, direction, value):
        self.card("SPC", 1, node, direction, value)

    def support(self, direction, *nodes):
        for node in nodes:
            self.card("SUPORT", node, direction)

    def force(self, node, x, y):
        """The vector is written unchanged, with length 1.0."""
        self.card("FORCE", 1, node, 0, 1.0, x, y, 0.0)

    def press(self, nodes, total, direction=(0.0, -1.0)):
        """A uniform pressure on a uniform row of nodes, as its nodal forces."""
        for k, node in enumerate(nodes):
            share = total/(len(nodes) - 1)*(0.5 if k in (0, len(nodes) - 1) else 1.0)
            self.force(node, share*direction[0], share*direction[1])

    def axis(self, normal):
        if normal not in self.axes:
            self.axes[normal] = 9000 + len(self.axes)
            self.card("CORD2R", self.axes[normal], 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, normal[0], normal[1], 0.0)
        return self.axes[normal]

    def pair(self, number, a, b, gap=0.0, normal=(0.0, 1.0)):
        """GA pushes GB along the normal; each pair has its own property."""
        self.card("CGAP", number, 90000000 + number, a, b, None, None, None, self.axis(normal))
        self.card("PGAP", 90000000 + number, gap)

    def lines(self, one, other, slave=1):
        """Lines 1 and 2 along these nodes, and contact between them."""
        self.card("BLSEG", 1, *one)
        self.card("BLSEG", 2, *other)
        self.card("BCONP", 1, slave, 3 - slave)

    def floor(self, nodes, gaps=None, first=70001, normal=(0.0, 1.0)):
        """A fixed node under each of these, which it pushes along the normal, and a pair with its number."""
        for k, node in enumerate(nodes):
            ground = self.grid(first + k, *self.x[node])
            self.hold(12, ground)
            self.pair(ground, ground, node, gaps[k] if gaps else 0.0, normal)

    def text(self, order=None):
        """The deck; `order` changes the order of its cards."""
        cards = self.cards if order is None else [self.cards[k] for k in order]
        lines = ["BEGIN BULK"]
        for name, *fields in cards:
            fields = [written(field) for field in fields]
            lines.append(",".join([name] + fields[:8]))
            lines += ["," + ",".join(fields[k:k + 8]) for k in range(8, len(fields), 8)]
        return "\n".join(lines + ["ENDDATA", ""])


class Result:
    """Exit status, message, and the content of the tables."""

    def __init__(self, status, message, directory):
        self.status, self.message = status, message
        self.files = {path.name: path.read_bytes() for path in sorted(pathlib.Path(directory).glob("scene.*"))
                      if path.suffix != ".dat"}
        self.summary = {row["key"]: row["value"] for row in self.table("summary")}
        self.pairs = {int(row["pair"]): row for row in self.table("contact")}
        self.nodes = {int(row["node"]): row for row in self.table("nodes")}
        self.elements = {int(row["element"]): row for row in self.table("elements")}
        self.listing = self.files.get("scene.lst", b"").decode()

    def table(self, name):
        text = self.files.get(f"scene.{name}.csv", b"").decode()
        return [{key: number(value) for key, value in row.items()} for row in csv.DictReader(text.splitlines())]

    def column(self, table, name):
        return [row[name] for _, row in sorted(getattr(self, table).items())]

    @property
    def force(self):
        return self.column("pairs", "force")

    @property
    def gap(self):
        return self.column("pairs", "gap")

    @property
    def touching(self):
        return [row["status"].startswith("touching") for _, row in sorted(self.pairs.items())]

    @property
    def approach(self):
        return [value for key, value in sorted(self.summary.items()) if key.startswith("approach")]


def number(text):
    try:
        return float(text)
    except ValueError:
        return text


def solve(deck, order=None, threads=None, preexec_fn=None):
    """Run the program on a deck, or on its text."""
    granted = {f"{name}_NUM_THREADS": str(threads) for name in ("OMP", "OPENBLAS")} if threads else {}
    with tempfile.TemporaryDirectory() as directory:
        path = pathlib.Path(directory)/"scene.dat"
        path.write_text(deck if isinstance(deck, str) else deck.text(order))
        run = subprocess.run([PROGRAM, str(path), "-o", directory, "--tables", "all"], capture_output=True, text=True,
                             timeout=120, env={**os.environ, **granted}, preexec_fn=preexec_fn)
        return Result(run.returncode, run.stderr.replace(directory + "/", ""), directory)


class Extremes(unittest.TestCase):
    """Allowed outcome of an extreme model: the correct results, or a rejection with its cause."""

    def valid(self, deck, **options):
        """Solved, and valid."""
        result = solve(deck, **options)
        self.assertEqual(result.status, 0, result.message)
        self.assertEqual(result.summary["status"], "valid")
        return result

    def refused(self, deck, status, cause):
        """Not solved: `cause` is a regular expression that the message must match."""
        result = solve(deck)
        self.assertEqual(result.status, status, result.message)
        self.assertRegex(result.message, cause)
        return result

    def right_or_refused(self, deck, cause, status=4):
        """Solved, so that the test checks the result; or not, with a message that matches `cause`: then None."""
        result = solve(deck)
        if result.status == 0:
            return result
        self.assertIn(result.status, (status, 2), result.message)
        self.assertRegex(result.message, cause)
        return None

    def near(self, actual, expected, relative=1e-10, scale=None):
        """Lists or reals agree, relative to the largest of the expected values."""
        actual, expected = [values if isinstance(values, list) else [values] for values in (actual, expected)]
        self.assertEqual(len(actual), len(expected))
        scale = scale or max(map(abs, expected), default=0.0)
        for k, (a, e) in enumerate(zip(actual, expected)):
            self.assertLessEqual(abs(a - e), relative*scale, f"value {k}: {a!r} where {e!r} was expected, of {scale!r}")

    def twins(self, one, other, force=1.0, length=1.0, relative=1e-10):
        """The second model is the first in other units; `force`, `length`: second units in one first unit."""
        stress = force/length/length
        self.assertEqual(one.touching, other.touching)
        for table, names, factor in (("pairs", ["force"], force), ("pairs", ["gap"], length), ("nodes", ["ux", "uy"], length),
                                     ("nodes", ["rx", "ry"], force), ("elements", ["sx", "sy", "sz", "txy"], stress)):
            for name in names:
                values = [value*factor for value in one.column(table, name)]
                scale = max((abs(value)*factor for beside in names for value in one.column(table, beside)), default=0.0)
                if name == "gap":   # for closed pairs it is a small difference of displacements
                    scale = max(scale, *(abs(value)*length for value in one.column("nodes", "uy")))
                with self.subTest(table=table, column=name):
                    self.near(other.column(table, name), values, relative, scale)
