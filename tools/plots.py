"""Draw runs.

    tools/plot DECK [-o NAME.png] [--only contact|friction|shape|yielded|history] [--known FORMULA]... [--case N]

One figure of any deck, with all its panels: the deformed shape, enlarged to be visible, with equivalent stress, and
details of small contacts; the yielded zone; the pressure along each contact line, with friction also the shear traction between its limits and the slip;
the iteration. The default NAME is DECK's, in the current folder.
With flow theory and contact, history panels show the increments of all load cases instead of the iteration: contact force against approach, largest
pressure and half-width against force. If a load case ends with less than half of an earlier force, further panels show the plastic strain and,
along the normal below the largest pressure, the element stresses sx and sy at its end.
A formula in the abscissa `s` of a pressure panel is drawn into the panels in which it has real values, for example
"3585.36*sqrt(1-(s/6.21463)**2)"; one that begins with "shear:" is drawn with the shear traction. With several load cases one is drawn: --case, or the one with the largest pressure. The exit status is that of epcont: a rejected deck has no picture.

    tools/plot --all                                   pictures/DECK.png beside every deck of input
    tools/plot contact ELASTIC PLASTIC -o NAME         the paper's Fig. 6: pressure along the contact, stresses down the axis
    tools/plot section ELASTIC PLASTIC -o NAME         the paper's Fig. 7: equivalent stress and yielded zone in the section

The last two need a quarter of two equal cylinders, solved elastic and plastic on one mesh; they write NAME.png and NAME.svg.
The same deck gives the same bytes on every run.
"""
import argparse
import pathlib
import sys

from drawing import KINDS, Refused
from wording import parser_of, run


def paper_figure(arguments):
    parser = argparse.ArgumentParser(prog="tools/plot")
    parser.add_argument("picture", choices=["contact", "section"])
    parser.add_argument("elastic", type=pathlib.Path)
    parser.add_argument("plastic", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path, required=True, help="name of the picture, without .png and .svg")
    options = parser.parse_args(arguments)
    from drawing import paper, style   # after the options: --help needs no package
    from drawing.run import Run
    runs = Run(options.elastic), Run(options.plastic)
    for run in runs:
        paper.check(run)
    style.save({"contact": paper.contact, "section": paper.section}[options.picture](*runs), options.output)
    return 0


def one_figure(arguments):
    parser = parser_of(__doc__, "tools/plot")
    parser.add_argument("deck", type=pathlib.Path, nargs="?")
    parser.add_argument("-o", "--output", type=pathlib.Path, help="name of the picture, with .png")
    parser.add_argument("--only", choices=KINDS, help="panels of this kind only")
    parser.add_argument("--known", metavar="FORMULA", action="append", default=[], help="formula to draw with the pressures")
    parser.add_argument("--case", metavar="N", type=int, help="SUBCASE to draw; default: the one with the largest pressure. History panels show all")
    parser.add_argument("--all", action="store_true", help="draw the pictures kept beside the decks of input")
    options = parser.parse_args(arguments)
    from drawing import figure, kept, style
    from drawing.run import Run
    if options.all:
        if options.deck or options.output or options.only or options.known or options.case is not None:
            parser.error("--all with other arguments: use it alone")
        kept.draw_all()
        return 0
    if not options.deck:
        parser.error("no deck: give one, or --all")
    output = options.output or pathlib.Path(f"{options.deck.stem}.png")
    if output.suffix.lower() != ".png":
        parser.error(f"-o {output}: not a PNG file: give a name that ends in .png")
    run = Run(options.deck, options.case)
    style.save_small(figure.draw(run, options.only, options.known), output)
    if run.message:
        print(run.message, file=sys.stderr)
    return run.exit_status


def main():
    arguments = sys.argv[1:]
    try:
        return paper_figure(arguments) if arguments[:1] in (["contact"], ["section"]) else one_figure(arguments)
    except Refused as refused:
        print(refused, file=sys.stderr)
        return refused.status
    except OSError as error:
        print(f"{error.filename}: {error.strerror}", file=sys.stderr)
        return 3
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    run(main)
