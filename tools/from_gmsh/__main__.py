"""Write a deck from a Gmsh file with named groups and a model in TOML.

    tools/deck SCENE.toml [-o NAME.dat]

NAME.dat (by default SCENE.dat beside SCENE.toml) has materials, supports, loads and contacts, and includes NAME.mesh.bdf with
nodes and elements. If epcont has been built, it checks the deck afterwards. input/README.md ("From Gmsh") describes the
model file; input/from_gmsh has examples.

Exit status: 0 if written; 2 if the model or (by epcont) the deck is rejected; 3 for errors of usage or files.
"""
import pathlib
import re
import subprocess
import sys

from wording import parser_of, run

from .faults import Faults, Rejected
from .scene import read_scene

TOP = pathlib.Path(__file__).resolve().parents[2]
REJECTED, UNUSABLE = 2, 3


class Unusable(Exception):
    """An error of files or of the machine, not of the model."""


def make(scene_path, path, faults):
    """Write deck and mesh; return their maker."""
    scene = read_scene(scene_path, faults)
    try:
        from .mesh import read_mesh
    except ImportError as error:
        raise Unusable(f"this Python has no Gmsh ({error}): use tools/deck, or pip install --no-deps -r tools/requirements.txt") from error
    except OSError as error:
        raise Unusable(f"Gmsh does not load ({error}): remove build/venv/installed and try again") from error
    from .deck import Maker
    mesh_path = path.with_suffix(".mesh.bdf")
    source = scene_path.parent / scene.mesh
    taken = [p.resolve() for p in (scene_path, source)]
    if path.resolve() in taken or mesh_path.resolve() in taken:
        raise Unusable(f"{path} or {mesh_path.name} is an input of the model: give another name after -o")
    maker = Maker(scene, read_mesh(source, faults), faults)
    made = f"made by tools/deck from {scene_path.name} and {source.name}"
    write(mesh_path, maker.mesh_lines())
    write(path, maker.deck_lines(made, mesh_path.name))
    return maker


def write(path, lines):
    try:
        path.write_text("\n".join(lines + [""]), encoding="utf-8")
    except OSError as error:
        raise Unusable(f"{path} cannot be written: {error.strerror}") from error


def check(path, maker):
    """epcont's check, if there is an epcont; its nodes are translated to names of the model."""
    program = next((p for p in (TOP / "build" / preset / "epcont" for preset in ("release", "debug", "sanitize")) if p.is_file()), None)
    if program is None:
        print("epcont is not built: tools/run DECK builds and runs it")
        return 0
    run = subprocess.run([program, "--check", path], capture_output=True, text=True, check=False)
    print(run.stdout + run.stderr, end="")
    for number in sorted({int(n) for n in re.findall(r"\bGRID (\d+)", run.stderr)}):
        print(maker.described(number))
    for number, motions in re.findall(r"the body of GRID (\d+) has \d+ unconstrained rigid-body modes?: it can (.*)", run.stderr):
        print(maker.freed(int(number), motions))
    if not run.returncode:
        return 0
    print("correct the model file, not the deck; in the model file SPC1 and SPC are [support], SUPORT [free], RBE2 [platen], BLSEG and BCONP [[contact]]")
    return REJECTED


def main(arguments=None):
    parser = parser_of(__doc__, "tools/deck")
    parser.add_argument("scene", type=pathlib.Path, metavar="SCENE.toml")
    parser.add_argument("-o", dest="deck", type=pathlib.Path, metavar="NAME.dat")
    try:
        options = parser.parse_args(arguments)
    except SystemExit as ended:
        return UNUSABLE if ended.code else 0
    faults = Faults(options.scene.name)
    path = options.deck or options.scene.with_suffix(".dat")
    try:
        if options.scene.suffix.lower() in (".geo", ".msh", ".dat", ".bdf"):
            raise Unusable(f'{options.scene} is not a model file: give a .toml with mesh = "NAME.geo" (input/README.md, "From Gmsh")')
        if not path.suffix or not path.name.isascii() or set("'\"") & set(path.name):
            raise Unusable(f"{path}: not a name for a deck: give an ASCII name with a suffix such as .dat, without quotes")
        maker = make(options.scene, path, faults)
    except Rejected:
        print("\n".join(faults.notes + faults.errors), file=sys.stderr)
        print(f"{faults.file}: {len(faults.errors)} error{'s' * (len(faults.errors) != 1)}, no deck written", file=sys.stderr)
        return REJECTED
    except Unusable as error:
        print(f"tools/deck: {error}", file=sys.stderr)
        return UNUSABLE
    except Exception as error:   # the user sees no traceback of this program
        print(f"tools/deck: internal error, {type(error).__name__}: {error}; please report it with the model", file=sys.stderr)
        return UNUSABLE
    print("\n".join(faults.notes + [f"{path}: {maker.told()}"]), flush=True)
    return check(path, maker)


if __name__ == "__main__":
    run(main)
