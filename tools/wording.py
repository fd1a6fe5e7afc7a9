"""Words of messages, and of what a tool says to --help; how a tool ends."""
import argparse
import signal
import sys


def parser_of(words, prog=None):
    """Of the options of a tool, of which these words stand as they are."""
    return argparse.ArgumentParser(prog=prog, description=words, formatter_class=argparse.RawDescriptionHelpFormatter)


def run(main):
    """Ends with the exit status of a tool; if nobody reads its output any more, as other programs do, by SIGPIPE."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())


def counted(number, word):
    """`1 deck`, `2 decks`."""
    return f"{number} {word}" + "s" * (number != 1)


def shown(text):
    """On one line, whatever is in it: names of files may have control characters."""
    return "".join(c if c.isprintable() or "\udc80" <= c <= "\udcff" else c.encode("unicode_escape").decode() for c in text)
