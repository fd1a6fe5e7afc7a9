"""A picture of any deck by ParaView, from the files that `epcont --vtk` writes: equivalent stress on the displaced bodies, and the
contact pressure along their boundary.

    tools/paraview DECK.dat [-o NAME.png] [--scale 10] [--near X,Y,HALF_HEIGHT]

One panel shows the whole, displacements times --scale; the other what is near a place, meshes and all, displacements as they are.
NAME is DECK.paraview, here, if not given. The exit status is that of epcont: a deck that is rejected has no picture.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

from paraview import simple

TOP = pathlib.Path(__file__).resolve().parent.parent
BLACK, WHITE = [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]
WIDTH, HEIGHT = 550, 440   # of a panel, pixels; of two, together 1000
LOW, HIGH = 0.24, 0.92     # parts of the height between which the whole is drawn: scales of colours below it, a heading above


def show(view, path, scale, field, bars, **properties):
    """The displaced grid of a file, coloured by a field."""
    grid = simple.XMLUnstructuredGridReader(FileName=[str(path)])
    warped = simple.WarpByVector(Input=grid, Vectors=["POINTS", "displacement"], ScaleFactor=scale)
    shown = simple.Show(warped, view, **properties)
    simple.ColorBy(shown, field)
    colours = simple.GetColorTransferFunction(field[1])
    colours.ApplyPreset("Viridis (matplotlib)" if field[0] == "CELLS" else "Inferno (matplotlib)", True)
    shown.RescaleTransferFunctionToDataRange(False, True)
    colours.RescaleTransferFunction(0.0, max(colours.RGBPoints[-4], 0.0) or 1.0)
    bar = simple.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle, bar.TitleColor, bar.LabelColor = field[1].replace("_", " "), "", BLACK, BLACK
    bar.TitleFontSize, bar.LabelFontSize, bar.RangeLabelFormat, bar.LabelFormat = 11, 10, "%.4g", "%.4g"
    bar.AutoOrient, bar.Orientation, bar.ScalarBarLength, bar.ScalarBarThickness = 0, "Horizontal", 0.36, 12
    bar.WindowLocation = "Lower Left Corner" if field[0] == "CELLS" else "Lower Right Corner"
    shown.SetScalarBarVisibility(view, bars)
    return warped.GetDataInformation().GetBounds()


def panel(place, stem, scale, near, wide):
    """A view of what is near, or of the whole; `wide`: its width over its height."""
    view = simple.CreateView("RenderView", OrientationAxesVisibility=0, UseColorPaletteForBackground=0, Background=WHITE,
                             InteractionMode="2D", CameraParallelProjection=1)
    bounds = show(view, place / f"{stem}.vtu", scale, ("CELLS", "equivalent_stress"), not near,
                  Representation="Surface With Edges" if near else "Surface", EdgeColor=WHITE)
    contact = place / f"{stem}.contact.vtu"
    if contact.exists():
        show(view, contact, scale, ("POINTS", "pressure"), not near, LineWidth=6.0)
    if not near:
        simple.Show(simple.Text(Text=f"displacements x {scale:g}"), view, WindowLocation="Upper Center", FontSize=11, Color=BLACK)
    simple.ResetCamera(view)
    x, y, half = near or whole(bounds, wide)
    view.CameraFocalPoint, view.CameraPosition, view.CameraParallelScale = [x, y, 0.0], [x, y, 10.0 * half], half
    return view


def whole(bounds, wide):
    """Centre and half height of a view in which these bounds have their place."""
    x = [(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2]
    half = 0.5 * max((bounds[3] - bounds[2]) / (HIGH - LOW), (bounds[1] - bounds[0]) / (0.94 * wide))
    return x[0], x[1] - half * (HIGH + LOW - 1.0), half


def surroundings(text):
    """X,Y,HALF_HEIGHT."""
    try:
        x, y, half = (float(value) for value in text.split(","))
    except ValueError:
        half = 0.0
    if not 0.0 < half < float("inf"):
        raise argparse.ArgumentTypeError(f"'{text}': three numbers and commas, a place and half the height above zero, such as 2.0,-0.5,1.5")
    return x, y, half


def main():
    parser = argparse.ArgumentParser(prog="tools/paraview", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", metavar="DECK", type=pathlib.Path)
    parser.add_argument("-o", "--output", metavar="NAME.png", type=pathlib.Path, help="name of the picture")
    parser.add_argument("--scale", type=float, default=1.0, help="of the displacements, where the whole is drawn (1)")
    parser.add_argument("--near", metavar="X,Y,HALF_HEIGHT", type=surroundings,
                        help="a second panel of this place; behind = where X is negative: --near=-1,0,2")
    options = parser.parse_args()
    output = options.output or pathlib.Path(f"{options.deck.stem}.paraview.png")
    if output.suffix.lower() != ".png":
        parser.error(f"-o {output}: the picture is a PNG file: a name that ends in .png")
    with tempfile.TemporaryDirectory() as directory:
        run = subprocess.run([TOP / "build/release/epcont", options.deck, "-o", directory, "--vtk"], check=False)
        place, stem = pathlib.Path(directory), options.deck.stem
        if not (place / f"{stem}.vtu").exists():
            return run.returncode
        layout = simple.CreateLayout("panels")
        width = 1000 if options.near else WIDTH
        if options.near:
            layout.SplitHorizontal(0, 0.5)
        shape = width / HEIGHT / (2 if options.near else 1)
        simple.AssignViewToLayout(panel(place, stem, options.scale, None, shape), layout, 1 if options.near else 0)
        if options.near:
            simple.AssignViewToLayout(panel(place, stem, 1.0, options.near, shape), layout, 2)
        output.parent.mkdir(parents=True, exist_ok=True)
        simple.SaveScreenshot(str(output), layout, ImageResolution=[width, HEIGHT], CompressionLevel="9")
    simple.Disconnect()   # else it may crash as it ends
    return run.returncode


if __name__ == "__main__":
    sys.exit(main())
