"""Meshes in each format of Gmsh give the same deck; lost or duplicate parts are reported."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

from maker import deck
from test_faults import GEO, TOML

#: One curve and one point in two groups each.
TWICE = GEO + 'Physical Curve("roof") = {7, -6};\nPhysical Point("peak") = {7};\n'
#: Write the meshes of a drawing: version, binary, order of the elements.
WRITER = """
import gmsh, sys
for order in (1, 2):
    gmsh.initialize(["gmsh"], readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open("two.geo")
    gmsh.option.setNumber("Mesh.ElementOrder", order)
    gmsh.model.mesh.generate(2)
    for version, binary in ((2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)):
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.write(f"{version}_{binary}_{order}.msh")
    gmsh.finalize()
"""
ORDERS = "give lines and surfaces the same order in two.msh (Mesh.ElementOrder)"
LINES = {"[[contact]] slave": ("under", "(0, 2), (1, 2)"), "[[contact]] master": ("face", "(2, 2), (1, 2)"),
         "[support.floor]": ("floor", "(0, 0), (1, 0)"), "[support.wall]": ("wall", "(0, 2), (0, 1)"),
         "[load.top] pressure": ("top", "(2, 4), (1, 4)")}
#: Two squares glued along an edge: six-node triangles below, three-node ones above.
GLUED = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
4
1 1 "floor"
1 2 "top"
2 1 "below"
2 2 "above"
$EndPhysicalNames
$Nodes
11
1 0 0 0\n2 2 0 0\n3 2 2 0\n4 0 2 0\n5 2 4 0\n6 0 4 0\n7 1 0 0\n8 2 1 0\n9 1 2 0\n10 0 1 0\n11 1 1 0
$EndNodes
$Elements
6
1 8 2 1 1 1 2 7\n2 1 2 2 3 5 6
3 9 2 1 1 1 2 3 7 8 11\n4 9 2 1 1 1 3 4 11 9 10\n5 2 2 2 2 4 3 5\n6 2 2 2 2 4 5 6
$EndElements
"""


def changed(text, change):
    """Change the fields of each element of an ASCII mesh in MSH 2: number, type, count of tags, group, curve, nodes."""
    head, begin, rest = text.partition("$Elements\n")
    body, end, tail = rest.partition("$EndElements")
    count, *lines = body.splitlines()
    lines = [" ".join(change(line.split())) for line in lines]
    return head + begin + "\n".join([count, *lines, ""]) + end + tail


class Meshes(unittest.TestCase):
    maxDiff = None

    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.meshes = pathlib.Path(directory.name)
        (cls.meshes / "two.geo").write_text(TWICE)
        subprocess.run([sys.executable, "-c", WRITER], cwd=cls.meshes, check=True)

    def setUp(self):
        directory = tempfile.TemporaryDirectory(prefix="with blanks ")
        self.addCleanup(directory.cleanup)
        self.place = pathlib.Path(directory.name)

    def made(self, mesh, name="two.msh", toml=TOML):
        """Exit status, messages except notes on unused groups, deck and mesh."""
        self.assertIn("two.geo", toml)
        (self.place / "scene.toml").write_text(toml.replace("two.geo", name), encoding="utf-8")
        if isinstance(mesh, str):
            (self.place / name).write_text(mesh, encoding="utf-8")
        else:
            (self.place / name).write_bytes(mesh)
        run = deck("scene.toml", cwd=self.place)
        lines = [line for line in (run.stdout + run.stderr).splitlines() if "is not used" not in line]
        files = [self.place / f"scene{suffix}" for suffix in (".dat", ".mesh.bdf")]
        return run.returncode, lines, [file.read_text() if file.exists() else None for file in files]

    def refused(self, expected, *arguments, **options):
        status, lines, files = self.made(*arguments, **options)
        count = len(expected) // 2
        self.assertEqual(lines, [("  " if i % 2 else "scene.toml: ") + line for i, line in enumerate(expected)] +
                         [f"scene.toml: {count} error{'s' * (count != 1)}, no deck written"])
        self.assertEqual((status, files), (2, [None, None]))

    def test_each_form_gives_the_same(self):
        for order in (1, 2):
            first = None
            for form in ("4.1_0", "4.1_1", "4.0_0", "2.2_0", "2.2_1"):
                with self.subTest(form=form, order=order):
                    status, lines, files = self.made((self.meshes / f"{form}_{order}.msh").read_bytes())
                    self.assertEqual(status, 0, lines)
                    self.assertEqual(sum(line.startswith("PLOADX1") for line in files[0].splitlines()), 2)
                    first = first or files
                    self.assertEqual(files, first)

    def test_lines_without_mid_side_nodes(self):
        text = (self.meshes / "2.2_0_2.msh").read_text()
        text = changed(text, lambda f: [f[0], "1", *f[2:7]] if f[1] == "8" else f)
        self.refused([part for where, (name, place) in LINES.items()
                      for part in (f"{where}: '{name}' has an edge of two nodes on six-node triangles, at {place}", ORDERS)], text)

    def test_lines_with_their_own_mid_side_nodes(self):
        text = (self.meshes / "2.2_0_2.msh").read_text()
        text = changed(text, lambda f: [f[0], "2", *f[2:8]] if f[1] == "9" else f)
        self.refused([part for where, (name, place) in LINES.items()
                      for part in (f"{where}: '{name}' has an edge of three nodes on elements without mid-side nodes, at {place}", ORDERS)], text)

    def test_a_line_across_elements(self):
        text = changed((self.meshes / "2.2_0_1.msh").read_text(), lambda f: [*f[:5], "1", "3"] if f[3:5] == ["3", "1"] else f)
        self.refused(["[support.floor]: 'floor' has an edge that no element has, at (0, 0), (2, 2)", "draw the line along element edges"], text)

    def test_orders_glued(self):
        toml = TOML.replace('contact = [{ slave = "under", master = "face" }]', "").replace("wall.x = 0", "floor.x = 0").replace('[free]\ncorner = "y"', "")
        self.refused(["[body]: elements with and without mid-side nodes have a common edge in two.msh, at (2, 2), (0, 2) (above, below)",
                      "use one element order for joined bodies (Mesh.ElementOrder)"], GLUED, toml=toml)

    def test_one_number_for_all_curves(self):
        """As other programs write MSH 2: the groups differ, the curve does not."""
        text = changed((self.meshes / "2.2_0_1.msh").read_text(), lambda f: [*f[:4], "1", *f[5:]] if f[1] == "1" else f)
        groups = "floor, face, under, top, wall, roof"
        right = "give each curve and surface its own number, the second tag of its elements in MSH 2, as Gmsh itself writes it; or use MSH 4.1"
        self.refused([f"mesh: curve 1 of two.msh is in the groups {groups}, but not all of its elements are in all of them", right], text)

    def test_a_drawing_that_ends_gmsh(self):
        for end in ("Exit;\n", "If (1 > 0)\n  Exit;\nEndIf\n"):
            self.refused(["mesh: two.geo ends Gmsh before the mesh is complete (exit status 0)", "correct the drawing until Gmsh itself meshes it, without Exit;"],
                         GEO + end, name="two.geo")

    def test_pressures_on_one_side(self):
        status, lines, files = self.made(TWICE, name="two.geo", toml=TOML.replace("top.pressure = 10.0", "top.pressure = 10.0\nroof.pressure = 5.0"))
        self.assertEqual(status, 0, lines)
        self.assertIn("scene.toml: note: [load.roof] pressure: acts on edges of [load.top] as well: the pressures are added", lines)
        self.assertEqual(sum(line.startswith("PLOADX1") for line in files[0].splitlines()), 6)

    def test_a_model_of_windows(self):
        """With a byte order mark, and lines that end in CR LF."""
        plain = self.made(GEO, name="two.geo")
        self.assertEqual(self.made(GEO.replace("\n", "\r\n"), name="two.geo", toml="\ufeff" + TOML.replace("\n", "\r\n"))[1:], plain[1:])


if __name__ == "__main__":
    unittest.main()
