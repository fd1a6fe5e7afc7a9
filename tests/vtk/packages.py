"""A Python with the readers of requirements.txt, in build/vtk_readers: made once, by whoever needs it first."""
import fcntl
import pathlib
import subprocess
import sys

REQUIREMENTS = pathlib.Path(__file__).with_name("requirements.txt")
BUILD = REQUIREMENTS.parents[2] / "build"


def python_with_readers():
    """Its path; raises subprocess.CalledProcessError, with what pip says, where the packages cannot be had."""
    place = BUILD / "vtk_readers"
    installed = place / "installed"
    BUILD.mkdir(exist_ok=True)
    with open(BUILD / "vtk_readers.lock", "w", encoding="ascii") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not installed.exists() or installed.read_text() != REQUIREMENTS.read_text():
            for command in ([sys.executable, "-m", "venv", place],
                            [place / "bin/pip", "install", "--quiet", "--disable-pip-version-check", "--requirement", REQUIREMENTS]):
                subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            installed.write_text(REQUIREMENTS.read_text())
    return place / "bin/python"


if __name__ == "__main__":
    print(python_with_readers())
