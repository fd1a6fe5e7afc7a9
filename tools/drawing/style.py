"""Common style of all pictures, and their storage: the same bytes on every run."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

BLUE, RED, GREEN, PURPLE, DARK, GREY = "#4477aa", "#cc3311", "#228833", "#aa3377", "#222222", "#999999"
COLOURS = [BLUE, RED, GREEN, PURPLE]
#: Element types that are compared.
ELEMENTS = {"ctria3": (BLUE, "o"), "cquad4": (GREEN, "s"), "ctria6": (RED, "^")}

plt.rcParams.update({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False, "axes.linewidth": 0.8,
                     "legend.frameon": False, "svg.hashsalt": "epcont", "svg.fonttype": "path", "figure.dpi": 110})
#: Colours of the panels of one deck.
SMALL = {"font.size": 8, "axes.titlesize": 9, "axes.labelsize": 8, "legend.frameon": True, "legend.edgecolor": "none", "legend.framealpha": 0.8,
         "legend.borderpad": 0.2}


def save(figure, name):
    """NAME.png and NAME.svg."""
    name.parent.mkdir(parents=True, exist_ok=True)
    for kind, metadata in (("png", {"Software": None}), ("svg", {"Date": None, "Creator": None})):
        figure.savefig(name.with_name(f"{name.name}.{kind}"), metadata=metadata, dpi=120)
    plt.close(figure)


def save_small(figure, path, colours=255):
    """A PNG with few colours: a third of the bytes, and no visible difference."""
    from PIL import Image  # comes with matplotlib

    drawn = io.BytesIO()
    figure.savefig(drawn, format="png", metadata={"Software": None}, dpi=100)
    plt.close(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    image = Image.open(drawn).convert("RGB").quantize(colours, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    image.save(path, format="PNG", optimize=True)
