"""Make a deck from a Gmsh file with named groups, and a model in TOML that gives them properties."""
