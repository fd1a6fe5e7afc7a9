"""Panels drawn by ParaView; only its own Python (pvpython) has the imported modules."""
from paraview import simple

BLACK, WHITE = [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]
WIDTH, HEIGHT = 550, 440   # size of a panel [pixels]; two have a total width of 1000
LOW, HIGH = 0.24, 0.92     # fractions of the height that bound the drawing: colour scales below, a heading above


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
    """A view of a detail, or of the whole; `wide`: its width over its height."""
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
    """Centre and half height of a view that contains these bounds."""
    x = [(bounds[0] + bounds[1]) / 2, (bounds[2] + bounds[3]) / 2]
    half = 0.5 * max((bounds[3] - bounds[2]) / (HIGH - LOW), (bounds[1] - bounds[0]) / (0.94 * wide))
    return x[0], x[1] - half * (HIGH + LOW - 1.0), half


def draw(place, stem, scale, near, path):
    """The whole, and the detail near a point (x, y, half height), if given."""
    layout = simple.CreateLayout("panels")
    width = 1000 if near else WIDTH
    if near:
        layout.SplitHorizontal(0, 0.5)
    shape = width / HEIGHT / (2 if near else 1)
    simple.AssignViewToLayout(panel(place, stem, scale, None, shape), layout, 1 if near else 0)
    if near:
        simple.AssignViewToLayout(panel(place, stem, 1.0, near, shape), layout, 2)
    simple.SaveScreenshot(str(path), layout, ImageResolution=[width, HEIGHT], CompressionLevel="9")
    simple.Disconnect()   # otherwise it may crash at its end
