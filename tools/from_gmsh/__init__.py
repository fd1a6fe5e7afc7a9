"""A deck from a Gmsh file whose groups have names, and a scene in TOML that says what they are."""
