"""Panels drawn by ParaView; only its own Python (pvpython) has what is imported here."""
from paraview import simple

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


def draw(place, stem, scale, near, path):
    """The whole, and what is near a place (x, y, half height), if one is given."""
    layout = simple.CreateLayout("panels")
    if near:
        layout.SplitHorizontal(0, 0.5)
    simple.AssignViewToLayout(panel(place, stem, scale, None), layout, 1 if near else 0)
    if near:
        simple.AssignViewToLayout(panel(place, stem, 1.0, near), layout, 2)
    simple.SaveScreenshot(str(path), layout, ImageResolution=[1000 if near else 550, 440], CompressionLevel="9")
    simple.Disconnect()   # else it may crash as it ends
