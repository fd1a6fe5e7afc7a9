"""What is wrong with a scene: where, what, and what would be right; all of it at once."""
import difflib


class Rejected(Exception):
    """The scene cannot be made into a deck; the faults say why."""


class Faults:
    def __init__(self, file):
        self.file, self.errors, self.notes = file, [], []
        self.harmless = 0   # errors so far that leave what comes next to be checked

    def add(self, where, what, right):
        self.errors.append(f"{self.file}: {where}: {what}\n  {right}")

    def note(self, where, what):
        self.notes.append(f"{self.file}: note: {where}: {what}")

    def go_on(self):
        """The errors so far do not keep the mesh from being checked against the scene."""
        self.harmless = len(self.errors)

    def end_stage(self):
        """What comes next relies on what was checked since then."""
        if len(self.errors) > self.harmless:
            raise Rejected

    def end(self):
        if self.errors:
            raise Rejected


def listed(names):
    return ", ".join(names) or "none"


def likely(name, names):
    """A question behind a list of names, if one of them may have been meant."""
    near = difflib.get_close_matches(name.lower(), [n.lower() for n in names], n=1)
    return next((f"; did you mean '{n}'?" for n in names if near and n.lower() == near[0]), "")


def spot(place):
    return f"({place[0]:.6g}, {place[1]:.6g})"
