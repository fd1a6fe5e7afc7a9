"""A picture of any deck by ParaView, from the files that `epcont --vtk` writes: equivalent stress on the displaced bodies, and the
contact pressure along their boundary.

    tools/paraview DECK.dat -o NAME.png [--scale 10] [--near X,Y,HALF_HEIGHT]

One panel shows the whole, displacements times --scale; the other what is near a place, meshes and all, displacements as they are.
The exit status is that of epcont: a deck that is rejected has no picture; 3: usage or files.
"""
import argparse
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parent.parent


class Parser(argparse.ArgumentParser):
    def error(self, message):   # argparse's own exit status is that of a deck that is rejected
        print(f"tools/paraview: {message}; --help says more", file=sys.stderr)
        sys.exit(3)


def numbers(text, count, right):
    try:
        found = [float(part) for part in text.split(",")]
    except ValueError:
        found = []
    if len(found) != count or not all(map(math.isfinite, found)) or found[-1] <= 0.0:
        raise argparse.ArgumentTypeError(f"{text}: {right}")
    return found


def scale(text):
    return numbers(text, 1, "a number above 0 would be right")[0]


def near(text):
    return numbers(text, 3, "X,Y,HALF_HEIGHT would be right: where to look, and how far up and down, above 0")


def picture(text):
    if not text.lower().endswith(".png"):
        raise argparse.ArgumentTypeError(f"{text}: the picture is a PNG file: a name that ends in .png would be right")
    return pathlib.Path(text)


def read_arguments():
    parser = Parser(prog="tools/paraview", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", type=pathlib.Path, metavar="DECK.dat")
    parser.add_argument("-o", "--output", type=picture, required=True, metavar="NAME.png")
    parser.add_argument("--scale", type=scale, default=1.0, help="of the displacements, where the whole is drawn")
    parser.add_argument("--near", type=near, metavar="X,Y,HALF_HEIGHT")
    return parser.parse_args()


def main():
    options = read_arguments()
    with tempfile.TemporaryDirectory() as directory:
        place, stem = pathlib.Path(directory), options.deck.stem
        run = subprocess.run([TOP / "build/release/epcont", options.deck, "-o", directory, "--vtk"], check=False)
        if not (place / f"{stem}.vtu").exists():
            return run.returncode
        from drawing import by_paraview  # here: arguments are read by any Python

        by_paraview.draw(place, stem, options.scale, options.near, place / "picture.png")
        if not (place / "picture.png").exists():
            print("tools/paraview: ParaView has drawn nothing (above)", file=sys.stderr)
            return 3
        try:
            options.output.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(place / "picture.png", options.output)
        except OSError as error:
            print(f"tools/paraview: {error.filename2 or error.filename}: cannot be written: {error.strerror}", file=sys.stderr)
            return 3
    return run.returncode


if __name__ == "__main__":
    sys.exit(main())
