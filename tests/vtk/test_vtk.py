#!/usr/bin/env python3
"""test_vtk.py PROGRAM [meshio|pyvista]: the files of --vtk have the values of the tables.

They are read by the strict reader of read_vtu.py, or by that package (tests/in_venv vtk).
"""
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests" / "independent"))
from deck import ids, read  # noqa: E402

PROGRAM, READER = None, "plain"
INPUT = ROOT / "input"
VERTEX, LINE = 1, 3
#: VTK's type, and the positions of corners and of mid-side nodes on the card.
KINDS = {"CTRIA3": (5, [0, 1, 2], []), "CTRAX3": (5, [0, 1, 2], []), "CQUAD4": (9, [0, 1, 2, 3], []),
         "CTRIA6": (22, [0, 1, 2], [3, 4, 5]), "CTRAX6": (22, [0, 2, 4], [1, 3, 5])}
#: A square in a corner, pressed into it from both free sides.
CORNER = """BEGIN BULK
PARAM,PLANE,STRAIN
PSHELL,1,1,1.
MAT1,1,1000.,,.3
GRID,1,,0.,0.
GRID,2,,1.,0.
GRID,3,,1.,1.
GRID,4,,0.,1.
GRID,31,,-1.,-1.,,,12
GRID,32,,0.,-1.,,,12
GRID,33,,1.5,-1.,,,12
GRID,34,,1.5,0.,,,12
GRID,35,,0.,0.,,,12
GRID,36,,0.,1.5,,,12
GRID,37,,-1.,1.5,,,12
GRID,38,,-1.,0.,,,12
CQUAD4,1,1,1,2,3,4
CQUAD4,2,1,31,32,35,38
CQUAD4,3,1,32,33,34,35
CQUAD4,4,1,38,35,36,37
SUPORT,1,1,1,2,2,2
PLOADX1,1,1,10.,,3,4
PLOADX1,1,1,10.,,2,3
BLSEG,1,4,1,2
BLSEG,2,36,35,34
BCONP,1,1,2
ENDDATA
"""


def sides(corners, middles):
    """Edges of an element, for either direction: their ends and the mid-side nodes."""
    return {(frozenset(ends), middle) for *ends, middle in zip(corners, corners[1:] + corners[:1], middles or [0] * len(corners))}


def area(x):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(x, x[1:] + x[:1])) / 2


class Case(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)

    def run_it(self, deck, *options, status=0):
        run = subprocess.run([PROGRAM, deck, "-o", self.directory, *options], capture_output=True, text=True)
        self.assertEqual(status, run.returncode, run.stderr)

    def table(self, stem, name):
        return list(csv.DictReader((self.directory / f"{stem}.{name}.csv").read_text().splitlines()))


class Values(Case):
    """One deck of each element type, axisymmetric, with contact by CGAP and by lines, with RBE2, and without contact."""

    @classmethod
    def setUpClass(cls):
        """One process reads all files: loading a package takes longer than reading them."""
        cls.errors = tempfile.TemporaryFile("w+")
        cls.addClassCleanup(cls.errors.close)
        cls.reader = subprocess.Popen([sys.executable, "-W", "error", HERE / "read_vtu.py", READER], stdin=subprocess.PIPE,
                                      stdout=subprocess.PIPE, stderr=cls.errors, text=True)
        cls.addClassCleanup(cls.reader.communicate)

    def grids(self, *names):
        """Content found by the reader, which must not complain."""
        found = []
        for name in names:
            self.reader.stdin.write(f"{self.directory / name}\n")
            self.reader.stdin.flush()
            found.append(self.reader.stdout.readline())
        self.errors.seek(0)
        self.assertEqual("", self.errors.read())
        return [json.loads(line) for line in found]

    def check(self, path, status=0):
        self.run_it(path, "--vtk", "--tables", "all", status=status)
        stem, self.deck = path.stem, read(path)
        self.nodes = {int(row["node"]): row for row in self.table(stem, "nodes")}
        self.pairs = self.table(stem, "contact")
        grids = self.grids(*[f"{stem}.vtu", f"{stem}.contact.vtu"][:2 if self.pairs else 1])
        self.assertEqual(bool(self.pairs), (self.directory / f"{stem}.contact.vtu").exists())
        for grid in grids:
            self.assertEqual({"exit_status": [status]}, grid["field_data"])
        self.check_cells(grids[0], self.table(stem, "elements"))
        self.check_points(grids[0])
        if self.pairs:
            self.check_pairs(grids[1], self.table(stem, "zones"))
            self.check_lines(grids[1], grids[0])
        return grids

    def pair_of(self, node, *columns):
        return [float(self.nodes[node][column]) for column in columns]

    def check_cells(self, grid, rows):
        """Elements in the order of their table, their nodes in the order of the cards, counter-clockwise."""
        cards = {int(card[1]): card for name in KINDS for card in self.deck.of(name)}
        material = {int(card[1]): int(card[2]) for name in ("PSHELL", "PSOLID") for card in self.deck.of(name)}
        data = grid["cell_data"]
        self.assertEqual([int(row["element"]) for row in rows], data["element_id"])
        self.assertEqual(len(rows), len(grid["cells"]))
        for (kind, points), element in zip(grid["cells"], data["element_id"]):
            card = cards[element]
            expected, corner, middle = KINDS[card[0]]
            self.assertEqual(expected, kind)
            nodes = [grid["point_data"]["node_id"][point] for point in points]
            given = [int(field) for field in card[3:9] if field]
            self.assertEqual(sides([given[i] for i in corner], [given[i] for i in middle]),
                             sides(nodes[:len(corner)], nodes[len(corner):]))
            self.assertGreater(area([grid["points"][point] for point in points[:len(corner)]]), 0.0)
        self.assertEqual([int(cards[element][2]) for element in data["element_id"]], data["property_id"])
        self.assertEqual([material[number] for number in data["property_id"]], data["material_id"])
        for name in ("equivalent_stress", "max_equivalent_stress", "equivalent_strain", "secant_modulus"):
            self.assertEqual([float(row[name]) for row in rows], data[name])
        self.assertEqual([[float(row[name]) for name in ("sx", "sy", "sz", "txy")] + [0.0, 0.0] for row in rows], data["stress"])
        self.assertEqual([int(row["state"] == "plastic") for row in rows], data["yielded"])

    def check_points(self, grid):
        """Nodes of elements in the order of their table; every contact force has a reaction."""
        data = grid["point_data"]
        used = {data["node_id"][point] for _, points in grid["cells"] for point in points}
        self.assertEqual([node for node in self.nodes if node in used], data["node_id"])
        for name, columns in (("displacement", ("ux", "uy")), ("reaction", ("rx", "ry"))):
            self.assertEqual([self.pair_of(node, *columns) + [0.0] for node in data["node_id"]], data[name])
        self.assertEqual([self.pair_of(node, "x", "y") + [0.0] for node in data["node_id"]], grid["points"])
        body = {}
        for (_, points), number in zip(grid["cells"], grid["cell_data"]["body"]):
            for point in points:
                self.assertEqual(number, body.setdefault(point, number))
        force = dict(zip(data["node_id"], data["contact_force"]))
        expected = {node: [0.0, 0.0, 0.0] for node in self.nodes}
        for row in self.pairs:
            for node, sign in ((int(row["gb"]), 1), (int(row["ga"]), -1)):
                for c, n in enumerate((row["nx"], row["ny"])):
                    expected[node][c] += sign * float(row["force"]) * float(n)
        masters = {node for card in self.deck.of("BCONP") for line in self.deck.of("BLSEG") if line[1] == card[3]
                   for node in ids(line[2:])}
        scale = max([math.hypot(*value) for value in expected.values()] or [0.0])
        for node, value in force.items():
            if not self.deck.of("BCONP") or node not in masters:
                for a, b in zip(expected[node], value):
                    self.assertAlmostEqual(a, b, delta=1e-14 * scale)
        if self.deck.of("BCONP"):
            for c in range(2):
                self.assertAlmostEqual(0.0, sum(value[c] for value in force.values()), delta=1e-11 * scale)
            self.assertGreater(sum(math.hypot(*force[node]) for node in masters), 0.1 * scale)

    def check_pairs(self, grid, zones):
        """Pairs in the order of their table, at B, or at A if B has no elements."""
        data, elements = grid["point_data"], {int(n) for name in KINDS for card in self.deck.of(name) for n in card[3:9] if n}
        self.assertEqual(len(self.pairs), len(grid["points"]))
        for name, column in (("pair_id", "pair"), ("node_a", "ga"), ("node_b", "gb")):
            self.assertEqual([int(row[column]) for row in self.pairs], data[name])
        self.at = []
        for k, row in enumerate(self.pairs):
            a, b = data["node_a"][k], data["node_b"][k]
            sign, node = (1.0, b) if b in elements else (-1.0, a)
            self.at.append(node)
            self.assertEqual(self.pair_of(node, "x", "y") + [0.0], grid["points"][k])
            self.assertEqual(self.pair_of(node, "ux", "uy") + [0.0], data["displacement"][k])
            self.assertEqual([sign * float(row["force"]) * float(row[n]) for n in ("nx", "ny")] + [0.0], data["contact_force"][k])
        self.assertEqual([float(row["gap"]) for row in self.pairs], data["gap"])
        self.assertEqual([float(row["pressure"] or 0) for row in self.pairs], data["pressure"])
        self.assertEqual([int(row["pressure"] != "") for row in self.pairs], data["has_pressure"])
        self.assertEqual([int(row["status"] == "touching") for row in self.pairs], data["touching"])
        for row in zones:
            inside = [k for k, zone in enumerate(data["zone"]) if zone == int(row["zone"])]
            self.assertLessEqual({int(row["first_pair"]), int(row["last_pair"])}, {data["pair_id"][k] for k in inside})
            self.assertAlmostEqual(1.0, sum(float(self.pairs[k]["force"]) for k in inside) / float(row["force"]), delta=1e-12)
        self.assertLessEqual(set(data["zone"]), set(range(len(zones) + 1)))

    def check_lines(self, grid, whole):
        """Lines follow edges of elements, each once, or lead to a node of another body on one; every pair is on a line,
        or a vertex."""
        along, body = set(), {}
        for _, points in whole["cells"]:
            nodes = [whole["point_data"]["node_id"][point] for point in points]
            corners = nodes[:3] if len(nodes) == 6 else nodes
            joined = set(nodes).union(*(body.get(node, ()) for node in nodes))
            body.update(dict.fromkeys(joined, joined))
            for ends, middle in sides(corners, nodes[3:] if len(nodes) == 6 else []):
                along |= {frozenset((end, middle)) for end in ends} if middle else {ends}
        drawn = [frozenset(points) for kind, points in grid["cells"] if kind == LINE]
        self.assertEqual(len(drawn), len(set(drawn)))
        between = {frozenset(self.at[point] for point in ends) for ends in drawn} - along
        for one, other in between:
            self.assertNotIn(other, body[one])
        alone = [points[0] for kind, points in grid["cells"] if kind == VERTEX]
        self.assertEqual(len(grid["cells"]), len(drawn) + len(alone))
        self.assertEqual(set(range(len(self.at))), {point for ends in drawn for point in ends} | set(alone))
        self.assertFalse({point for ends in drawn for point in ends} & set(alone))
        contact = {}
        for card in self.deck.of("BCONP"):
            slave = {node for line in self.deck.of("BLSEG") if line[1] == card[2] for node in ids(line[2:])}
            contact.update({node: int(card[1]) for node in slave})
        self.assertEqual([contact.get(self.at[points[0]], 0) for _, points in grid["cells"]], grid["cell_data"]["bconp"])

    def test_triangles_and_a_platen(self):
        self.check(INPUT / "hertz/hertz44.dat")

    def test_six_node_triangles(self):
        self.check(INPUT / "hertz/hertz_ctria6.dat")

    def test_quadrilaterals(self):
        self.check(INPUT / "hertz/hertz_cquad4.dat")

    def test_rings(self):
        for element in ("ctrax3", "ctrax6"):
            deck = self.directory / f"{element}.dat"
            subprocess.run([ROOT / "tools/decks", "ball", "--element", element, "-n", "2", "-o", deck], check=True,
                           stdout=subprocess.DEVNULL)
            self.check(deck)

    def test_lines_in_contact(self):
        for name in ("nafems/nafems_quad4", "gears/gears", "roller/roller", "ring_joint/ring_joint"):
            self.check(INPUT / f"{name}.dat")

    def test_no_contact(self):
        self.check(INPUT / "one_element/one_element.dat")

    def test_a_limit_load(self):
        """The last valid load step is shown, and marked as no answer."""
        self.check(INPUT / "faults/punch_beyond.dat", status=1)

    def test_nodes_that_nothing_uses(self):
        deck = self.directory / "more.dat"
        deck.write_text((INPUT / "hertz/hertz44.dat").read_text().replace("BEGIN BULK\n", "BEGIN BULK\nGRID,999,,1.,1.,0.,,123\n"))
        bodies, _ = self.check(deck)
        self.assertNotIn(999, bodies["point_data"]["node_id"])
        self.assertIn("999", (self.directory / "more.nodes.csv").read_text())

    def test_a_pair_of_fixed_nodes(self):
        """No boundary belongs to it: no pressure, no line."""
        deck = self.directory / "held.dat"
        deck.write_text((INPUT / "hertz/hertz44.dat").read_text().replace(
            "BEGIN BULK\n", "BEGIN BULK\nGRID,998,,3.,0.,0.,,123\nGRID,999,,3.,1.,0.,,123\nCGAP,997,996,998,999\nPGAP,996,1.\n"))
        _, contact = self.check(deck)
        self.assertEqual(1, contact["point_data"]["has_pressure"].count(0))
        self.assertEqual(1, sum(kind == VERTEX for kind, _ in contact["cells"]))

    def test_increments(self):
        """Force, pressure and approach of each increment are those of its table; the last state of a load case is that of --vtk."""
        deck = INPUT / "hertz/hertz330_unloaded.dat"
        self.run_it(deck, "--vtk")
        ends = {path.name: path.read_bytes() for path in self.directory.glob("*.vtu")}
        self.run_it(deck, "--vtk-all", "--tables", "all")
        for name, data in ends.items():
            self.assertEqual(data, (self.directory / name).read_bytes())
        index = re.findall('timestep="(.*?)" file="(.*?)"', (self.directory / "hertz330_unloaded.pvd").read_text())
        rows = self.table("hertz330_unloaded", "increments")
        self.assertEqual([int(row["subcase"]) - 1 + float(row["load_factor"]) for row in rows], [float(time) for time, _ in index])
        ends = {row["subcase"]: f".case{row['subcase']}" for row in rows}
        last = {row["subcase"]: row["increment"] for row in rows}
        self.assertEqual([f"hertz330_unloaded{ends[row['subcase']]}{'' if row['increment'] == last[row['subcase']] else '.inc' + row['increment']}.vtu"
                          for row in rows], [name for _, name in index])
        for row, (_, name) in zip(rows, index):
            body, contact = self.grids(name, name.replace(".vtu", ".contact.vtu"))
            self.assertEqual({"exit_status": [0]}, body["field_data"])
            self.assertAlmostEqual(float(row["max_pressure"]), max(contact["point_data"]["pressure"]), places=9)
            total = sum(math.hypot(*force) for force in contact["point_data"]["contact_force"])
            self.assertAlmostEqual(float(row["total_contact_force"]), total, places=9)
            self.assertEqual(int(row["plastic_elements"]), sum(body["cell_data"]["yielded"]))
            moved = dict(zip(body["point_data"]["node_id"], body["point_data"]["displacement"]))
            self.assertIn(float(row["approach"]), [y for _, y, _ in moved.values()])

    def test_a_line_round_a_corner(self):
        """The node at the corner has a pair on either face: each line has its own pairs."""
        deck = self.directory / "corner.dat"
        deck.write_text(CORNER)
        _, contact = self.check(deck)
        data = contact["point_data"]
        self.assertEqual([4, 1, 1, 2], data["pair_id"])
        self.assertEqual([LINE, LINE], [kind for kind, _ in contact["cells"]])
        for _, (one, other) in contact["cells"]:
            for a, b in zip(data["contact_force"][one], data["contact_force"][other]):
                self.assertAlmostEqual(a, b, delta=1e-8)


class Files(Case):
    def written(self):
        return {path.name for path in self.directory.glob("*.vtu*")}

    def test_only_on_request(self):
        self.run_it(INPUT / "hertz/hertz44.dat")
        self.assertEqual(set(), self.written())

    def test_none_without_an_answer(self):
        for name, status in (("no_suport", 2), ("pulled_apart", 1)):
            self.run_it(INPUT / f"faults/{name}.dat", "--vtk", status=status)
            self.assertEqual(set(), self.written())

    def test_those_of_an_earlier_run_go(self):
        for options in ([], ["--vtk"]):
            self.run_it(INPUT / "hertz/hertz44.dat", "--vtk")
            self.assertEqual({"hertz44.vtu", "hertz44.contact.vtu"}, self.written())
            deck = self.directory / "hertz44.dat"
            deck.write_bytes((INPUT / "faults/pulled_apart.dat").read_bytes())
            self.run_it(deck, *options, status=1)
            self.assertEqual(set(), self.written())

    def test_those_of_increments_go(self):
        """Files of increments of an earlier run, of one load case or several. Files of other names stay."""
        for deck in "hertz/hertz330_unloaded", "one_element/one_element_flow":
            path = INPUT / f"{deck}.dat"
            self.run_it(path, "--vtk-all")
            self.assertTrue(any(".inc2." in name for name in self.written()))
            (self.directory / f"{path.stem}.case1.increments.vtu").touch()
            self.run_it(path, "--vtk")
            self.assertFalse(any(re.search(r"\.inc\d", name) for name in self.written()))
            self.assertTrue((self.directory / f"{path.stem}.case1.increments.vtu").exists())
        self.assertFalse((self.directory / "one_element_flow.pvd").exists())
        self.run_it(INPUT / "hertz/hertz44.dat", "--vtk-all")   # total theory has no increments
        self.assertTrue((self.directory / "hertz44.vtu").exists())
        self.assertFalse((self.directory / "hertz44.pvd").exists())

    def test_the_same_bytes(self):
        found = []
        for _ in range(2):
            self.run_it(INPUT / "roller/roller.dat", "--vtk")
            found.append({name: (self.directory / name).read_bytes() for name in self.written()})
        self.assertEqual(2, len(found[0]))
        self.assertEqual(found[0], found[1])

    def test_a_deck_of_that_name(self):
        deck = self.directory / "deck.vtu"
        deck.write_bytes((INPUT / "hertz/hertz44.dat").read_bytes())
        self.run_it(deck, "--vtk", status=3)
        self.assertEqual((INPUT / "hertz/hertz44.dat").read_bytes(), deck.read_bytes())


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    if len(sys.argv) > 1 and re.fullmatch("meshio|pyvista", sys.argv[1]):
        READER = sys.argv.pop(1)
        sys.argv.append("Values")
    unittest.main()
