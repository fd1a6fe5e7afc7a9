"""Words of messages and of --help, and the exit of a tool."""
import argparse
import signal
import sys


def parser_of(words, prog=None):
    """Parser of a tool's options; the words are printed unchanged."""
    return argparse.ArgumentParser(prog=prog, description=words, formatter_class=argparse.RawDescriptionHelpFormatter)


def run(main):
    """End with the exit status of a tool; by SIGPIPE if the reader of its output has ended, as other programs do."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    sys.exit(main())


def counted(number, word):
    """`1 deck`, `2 decks`."""
    return f"{number} {word}" + "s" * (number != 1)


def shown(text):
    """Put a text on one line: file names may contain control characters."""
    return "".join(c if c.isprintable() or "\udc80" <= c <= "\udcff" else c.encode("unicode_escape").decode() for c in text)
