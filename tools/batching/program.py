"""The program that decks are run by."""
import hashlib
import os
import pathlib
import shutil
import subprocess

from .decks import Refused

USUAL = str(pathlib.Path(__file__).resolve().parents[2] / "build" / "release" / "epcont")


def found(program):
    """Path of an epcont that works, and which one it is: its version, and a word for the bytes that it is made of."""
    path = shutil.which(program)
    if not path:
        raise Refused(f"{program}: no such program: tools/build makes it, or --program PATH")
    try:
        said = subprocess.run([path, "--version"], capture_output=True, text=True, errors="replace", timeout=60, check=False)
        with open(path, "rb") as file:
            build = hashlib.blake2b(file.read(), digest_size=8).hexdigest()
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Refused(f"{program}: cannot be started: {error}") from None
    if said.returncode or not said.stdout.startswith("epcont "):
        raise Refused(f"{program} --version: exit status {said.returncode}: a working epcont would be right")
    return os.path.abspath(path), f"{said.stdout.strip()}, {build}"
