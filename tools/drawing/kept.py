"""The kept pictures, one beside each deck below input, and the closed forms drawn into them."""
from drawing import figure, style
from drawing.run import TOP, Refused, Run

INPUT = TOP / "input"

HERTZ = "266.266*sqrt(1-(s/0.0239091)**2)"
NAFEMS = "3585.36*sqrt(1-(s/6.21463)**2)"
#: Shear traction of two cylinders pushed by .6 mu P, then by -.2 mu P.
CATTANEO = "shear:-0.164832*(" + "-2*".join(f"(sqrt(1-s**2)-{c}*sqrt(maximum(0,1-(s/{c})**2)))" for c in (0.6324555, 0.7745967)) + ")"


def persson(pressure, half):
    """Pressure in a hole over the angle; the load is at -90 degrees; `pressure`: P/R; `half`: half-angle of contact."""
    b, y = f"tan(radians({half})/2)", "tan(radians(s+90)/2)"
    rest = f"sqrt({b}**2-{y}**2)"
    whole = f"sqrt(1+{b}**2)"
    return (f"{pressure}*(2*{rest}/(pi*{whole}*(1+{y}**2)) + log(({whole}+{rest})/({whole}-{rest}))/(2*pi*{b}**2*(1+{b}**2)))")


#: Formulas in s, the abscissa of the panel, by model or deck: the known results in the heads of the decks.
KNOWN = {
    "hertz/hertz44_elastic.dat": [HERTZ], "hertz/hertz330_elastic.dat": [HERTZ], "hertz/hertz900_elastic.dat": [HERTZ],
    "hertz/hertz_ctria6.dat": [HERTZ], "hertz/hertz_cquad4.dat": [HERTZ],
    "ball": ["1469.12*sqrt(1-(s/0.2)**2)"],
    "cylinder_on_block": [NAFEMS], "nafems": [NAFEMS],
    "flat_punch": ["200/(pi*sqrt(1-s**2))"],
    "off_centre": ["100/(pi*sqrt(1-s**2))*(1+2*0.309017*s)"],
    "shrink_fit": ["24.9288"], "spinning_disc": ["7.3515"],
    "pin_in_hole": [persson(81.7426, 45)],
    "pin_in_lug/pin_in_lug.dat": [persson(100, 45)], "pin_in_lug/pin_in_lug60.dat": [persson(100, 60)],
    "patch": ["10"], "include": ["10"],
    "gears": ["1554.41*sqrt(1-(s/0.24573)**2)"],
    "roller": ["3030.18*sqrt(1-(s/0.21009)**2)", "2474.13*sqrt(1-(s/0.25731)**2)"],
    "from_gmsh/two_cylinders.dat": ["1659.9*sqrt(1-(s/0.19177)**2)"], "from_gmsh/pin.dat": [persson(100, 45)],
    "from_gmsh/press_fit.dat": ["40.575"], "from_gmsh/blocks.dat": ["250"],
    "cattaneo": ["0.549439*sqrt(1-s**2)", CATTANEO], "pull_off": ["24.6094"],
    "ring_joint": ["332.10*sqrt(1-((s-53)/0.11513)**2)"],
}
#: Load cases of the pictures; the others show the one with the largest pressure.
CASES = {"cattaneo": 3, "pull_off": 3}


def picture(deck):
    """Path of the kept picture of a deck."""
    return deck.parent / "pictures" / f"{deck.stem}.png"


def draw_all():
    """Draw every deck below input; rejected ones have no picture."""
    for deck in sorted(INPUT.glob("*/*.dat")):
        name = deck.relative_to(INPUT).as_posix()
        try:
            style.save_small(figure.draw(Run(deck, CASES.get(deck.parent.name)), formulas=KNOWN.get(name, KNOWN.get(deck.parent.name, []))), picture(deck))
        except Refused as refused:
            if refused.status != 2:
                raise
            print(f"{name}: rejected, no picture")
        else:
            print(f"{picture(deck).relative_to(TOP)}: {picture(deck).stat().st_size // 1000} kB")
