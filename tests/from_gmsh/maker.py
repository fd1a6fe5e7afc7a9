"""Run tools/deck for tests in a copy of their process, which has loaded Gmsh once for all models."""
import pathlib
import sys

TESTS = pathlib.Path(__file__).resolve().parents[1]
TOOLS = TESTS.parent / "tools"
sys.path[:0] = [str(TOOLS), str(TESTS)]
import copies  # noqa: E402
import from_gmsh.mesh  # noqa: E402, F401
from from_gmsh.__main__ import main  # noqa: E402
from wording import run  # noqa: E402


def deck(*arguments, cwd="."):
    """Exit status of `tools/deck ARGUMENTS` and its output."""
    return copies.run(lambda: run(main), "tools/deck", *arguments, cwd=cwd)
