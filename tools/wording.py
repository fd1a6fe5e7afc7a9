"""Words of messages."""


def counted(number, word):
    """`1 deck`, `2 decks`."""
    return f"{number} {word}" + "s" * (number != 1)
