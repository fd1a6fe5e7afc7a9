"""Draw any deck with ParaView, from the files of `epcont --vtk`: equivalent stress on the displaced bodies, and the
contact pressure along their boundary.

    tools/paraview DECK.dat [-o NAME.png] [--scale 10] [--near X,Y,HALF_HEIGHT] [--case N]

One panel shows the whole model, displacements times --scale; the other a detail with its mesh, displacements unscaled.
With several load cases one is drawn: --case, or the one with the largest pressure.
The default NAME is DECK.paraview, in the current folder. The exit status is that of epcont: a rejected deck has no picture.
"""
import argparse
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import tables
from wording import parser_of, run

TOP = pathlib.Path(__file__).resolve().parent.parent


def numbers(text, count, right):
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != count or not all(map(math.isfinite, found)) or found[-1] <= 0.0:
        raise argparse.ArgumentTypeError(f"'{text}': {right}")
    return found


def scale(text):
    return numbers(text, 1, "a number above zero")[0]


def near(text):
    return numbers(text, 3, "three numbers and commas, a place and half the height above zero, such as 2.0,-0.5,1.5")


def read_arguments():
    parser = parser_of(__doc__, "tools/paraview")
    parser.add_argument("deck", metavar="DECK", type=pathlib.Path)
    parser.add_argument("-o", "--output", metavar="NAME.png", type=pathlib.Path, help="name of the picture")
    parser.add_argument("--scale", type=scale, default=1.0, help="factor of the displacements in the whole model (1)")
    parser.add_argument("--near", metavar="X,Y,HALF_HEIGHT", type=near,
                        help="a second panel of this region; use = if X is negative: --near=-1,0,2")
    parser.add_argument("--case", metavar="N", type=int, help="SUBCASE to draw; default: the one with the largest pressure")
    options = parser.parse_args()
    options.output = options.output or pathlib.Path(f"{options.deck.stem}.paraview.png")
    if options.output.suffix.lower() != ".png":
        parser.error(f"-o {options.output}: not a PNG file: give a name that ends in .png")
    return options


def main():
    options = read_arguments()
    with tempfile.TemporaryDirectory() as directory:
        place, stem = pathlib.Path(directory), options.deck.stem
        run = subprocess.run([TOP / "build/release/epcont", options.deck, "-o", directory, "--vtk"], check=False)
        try:
            case = tables.case_of(place, stem, options.case)
        except ValueError as error:
            print(f"tools/paraview: {options.deck}: {error}", file=sys.stderr)
            return 3
        stem += f".case{case}" if case is not None else ""
        if not (place / f"{stem}.vtu").exists():
            return run.returncode
        from drawing import by_paraview  # imported here: any Python can read the arguments

        by_paraview.draw(place, stem, options.scale, options.near, place / "picture.png")
        if not (place / "picture.png").exists():
            print("tools/paraview: ParaView has drawn nothing (see above)", file=sys.stderr)
            return 3
        try:
            options.output.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(place / "picture.png", options.output)
        except OSError as error:
            print(f"tools/paraview: {error.filename2 or error.filename}: cannot be written: {error.strerror}", file=sys.stderr)
            return 3
    return run.returncode


if __name__ == "__main__":
    run(main)
