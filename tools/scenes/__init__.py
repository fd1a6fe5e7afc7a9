"""Scenes from a few parameters, for tools/decks."""
