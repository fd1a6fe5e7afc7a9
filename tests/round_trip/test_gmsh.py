"""Meshes written by Gmsh itself (BdfFieldFormat 0, 1, 2: free, small, large; lines as CBAR), included in a deck."""
import pathlib
import tempfile
import unittest

import gmsh
from forms import TOP, run
from from_gmsh.deck import Maker
from from_gmsh.faults import Faults
from from_gmsh.mesh import read_mesh
from from_gmsh.scene import read_scene

FORMATS = ["free", "small", "large"]
SCENES = {"two_cylinders": {}, "pin": {}, "blocks": {"blocks.toml": ("top.pressure = 250.0 ", "top.force = [0.0, -3750.0] ")}}
#: Relative to the largest value of the quantity, the effect of Gmsh's coordinates on the results: nine digits; or eight characters including decimal
#: point, sign and exponent, for gaps of a ten-thousandth of the radius. For flat bodies there is hardly an effect.
APART = {"large": {"two_cylinders": 1e-6, "pin": 5e-5, "blocks": 1e-7},
         "small": {"two_cylinders": 0.02, "pin": 0.2, "blocks": 1e-6}}
APART["free"] = APART["small"]


class Gmsh(unittest.TestCase):
    def test_formats(self):
        for name in SCENES:
            with self.subTest(name), tempfile.TemporaryDirectory() as directory:
                place = pathlib.Path(directory)
                decks = self.write(name, place)
                found = run(decks, place / "out")
                self.assertEqual(found[name].status, "valid")
                for form in FORMATS:
                    with self.subTest(form):
                        apart, where = found[name].apart(found[f"{name}_{form}"], discrete=False, tables=("contact", "nodes"))
                        self.assertLessEqual(apart, APART[form][name], where)

    def write(self, name, place):
        """A deck by tools/deck, and three with its cards in Gmsh's numbers on Gmsh's own files."""
        geo = place / f"{name}.geo"
        geo.write_text((TOP / f"input/from_gmsh/{name}.geo").read_text())
        text = (TOP / f"input/from_gmsh/{name}.toml").read_text()
        for old, new in SCENES[name].values():
            self.assertIn(old, text)
            text = text.replace(old, new)
        (place / "scene.toml").write_text(text)
        faults = Faults("scene.toml")
        maker = Maker(read_scene(place / "scene.toml", faults), read_mesh(geo, faults), faults)
        maker.number = {node: node for node in maker.number}
        maker.elements = 90000000
        decks = [place / f"{name}.dat"]
        (place / "own.bdf").write_text("\n".join(maker.mesh_lines()))
        decks[0].write_text("\n".join(maker.deck_lines("a test", "own.bdf")))
        for number, form in enumerate(FORMATS):
            self.mesh(geo, place / f"{form}.bdf", number)
            decks.append(place / f"{name}_{form}.dat")
            decks[-1].write_text("\n".join(maker.deck_lines("a test", f"{form}.bdf")))
        return decks

    def mesh(self, geo, path, number):
        gmsh.initialize(["gmsh", "-v", "0"], readConfigFiles=False)
        gmsh.open(str(geo))
        gmsh.model.mesh.generate(2)
        gmsh.option.setNumber("Mesh.BdfFieldFormat", number)
        gmsh.option.setNumber("Mesh.SaveElementTagType", 2)
        gmsh.write(str(path))
        gmsh.finalize()


if __name__ == "__main__":
    unittest.main()
