"""Make models from a few parameters, for tools/decks."""
