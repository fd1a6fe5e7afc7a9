"""The program that decks are run by."""
import mmap
import os
import pathlib
import shutil
import subprocess
import zlib

from .decks import Refused

USUAL = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "release" / "epcont")


def found(program):
    """Path of an epcont that works, and which one it is: its version, and a word for the bytes that it is made of."""
    path = shutil.which(program)
    if not path:
        raise Refused(f"{program}: no such program: tools/build makes it, or --program PATH")
    try:
        said = subprocess.run([path, "--version"], capture_output=True, text=True, errors="replace", timeout=60, check=False)
        with open(path, "rb") as file, mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
            build = f"{zlib.crc32(content):08x}{len(content):x}"   # three times as fast as a digest, of 34 MB
    except (OSError, ValueError, subprocess.TimeoutExpired) as error:
        raise Refused(f"{program}: cannot be started: {error}") from None
    if said.returncode or not said.stdout.startswith("epcont "):
        raise Refused(f"{program} --version: exit status {said.returncode}: a working epcont would be right")
    return os.path.abspath(path), f"{said.stdout.strip()}, {build}"
