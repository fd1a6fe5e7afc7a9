"""The program that runs the decks."""
import mmap
import os
import pathlib
import shutil
import subprocess
import zlib

from .decks import Refused

USUAL = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "release" / "epcont")


def found(program):
    """Check that an epcont works; return its path and identity: version and checksum of its bytes."""
    path = shutil.which(program)
    if not path:
        raise Refused(f"{program}: no such program: run tools/build, or give --program PATH")
    try:
        said = subprocess.run([path, "--version"], capture_output=True, text=True, errors="replace", timeout=60, check=False)
        with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            build = f"{zlib.crc32(content):08x}{len(content):x}"   # three times as fast as a digest, of 34 MB
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        raise Refused(f"{program}: cannot be started: {error}") from None
    if said.returncode or not said.stdout.startswith("epcont "):
        raise Refused(f"{program} --version: exit status {said.returncode}: give a working epcont with --program")
    return os.path.abspath(path), f"{said.stdout.strip()}, {build}"
