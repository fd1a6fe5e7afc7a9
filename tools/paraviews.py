"""A picture of any deck by ParaView, from the files that `epcont --vtk` writes: equivalent stress on the displaced bodies, and the
contact pressure along their boundary.

    tools/paraview DECK.dat -o NAME.png [--scale 10] [--near X,Y,HALF_HEIGHT]

One panel shows the whole, displacements times --scale; the other what is near a place, meshes and all, displacements as they are.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

from paraview import simple

TOP = pathlib.Path(__file__).resolve().parent.parent
BLACK, WHITE = [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]


def show(view, path, scale, field, bars, **properties):
    """The displaced grid of a file, coloured by a field."""
    grid = simple.XMLUnstructuredGridReader(FileName=[str(path)])
    shown = simple.Show(simple.WarpByVector(Input=grid, Vectors=["POINTS", "displacement"], ScaleFactor=scale), view, **properties)
    simple.ColorBy(shown, field)
    colours = simple.GetColorTransferFunction(field[1])
    colours.ApplyPreset("Viridis (matplotlib)" if field[0] == "CELLS" else "Inferno (matplotlib)", True)
    shown.RescaleTransferFunctionToDataRange(False, True)
    bar = simple.GetScalarBar(colours, view)
    bar.Title, bar.ComponentTitle, bar.TitleColor, bar.LabelColor = field[1].replace("_", " "), "", BLACK, BLACK
    bar.TitleFontSize, bar.LabelFontSize, bar.RangeLabelFormat, bar.LabelFormat = 11, 10, "%.4g", "%.4g"
    bar.AutoOrient, bar.Orientation, bar.ScalarBarLength, bar.ScalarBarThickness = 0, "Horizontal", 0.4, 12
    bar.WindowLocation = "Lower Left Corner" if field[0] == "CELLS" else "Lower Right Corner"
    shown.SetScalarBarVisibility(view, bars)
    return shown


def panel(place, stem, scale, near):
    view = simple.CreateView("RenderView", OrientationAxesVisibility=0, UseColorPaletteForBackground=0, Background=WHITE,
                             InteractionMode="2D", CameraParallelProjection=1)
    show(view, place / f"{stem}.vtu", scale, ("CELLS", "equivalent_stress"), not near,
         Representation="Surface With Edges" if near else "Surface", EdgeColor=WHITE)
    contact = place / f"{stem}.contact.vtu"
    if contact.exists():
        show(view, contact, scale, ("POINTS", "pressure"), not near, LineWidth=6.0)
    simple.ResetCamera(view)
    if near:
        x, y, half = near
        view.CameraFocalPoint, view.CameraPosition, view.CameraParallelScale = [x, y, 0.0], [x, y, 10.0 * half], half
    else:
        view.CameraParallelScale *= 1.3   # room for the bars
    return view


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True)
    parser.add_argument("--scale", type=float, default=1.0, help="of the displacements, where the whole is drawn")
    parser.add_argument("--near", type=lambda text: [float(v) for v in text.split(",")])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        run = subprocess.run([TOP / "build/release/epcont", options.deck, "-o", directory, "--vtk"], check=False)
        place, stem = pathlib.Path(directory), options.deck.stem
        if not (place / f"{stem}.vtu").exists():
            return run.returncode
        layout = simple.CreateLayout("panels")
        if options.near:
            layout.SplitHorizontal(0, 0.5)
        simple.AssignViewToLayout(panel(place, stem, options.scale, None), layout, 1 if options.near else 0)
        if options.near:
            simple.AssignViewToLayout(panel(place, stem, 1.0, options.near), layout, 2)
        options.output.parent.mkdir(parents=True, exist_ok=True)
        simple.SaveScreenshot(str(options.output), layout, ImageResolution=[1000 if options.near else 550, 440],
                              CompressionLevel="9")
    simple.Disconnect()   # else it may crash as it ends
    return run.returncode


if __name__ == "__main__":
    sys.exit(main())
