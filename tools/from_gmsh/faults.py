"""Collect all errors of a model: position, fault and remedy."""
import difflib


class Rejected(Exception):
    """The model cannot be made into a deck; the faults give the reasons."""


class Faults:
    def __init__(self, file):
        self.file, self.errors, self.notes = file, [], []
        self.harmless = 0   # number of errors after which the next checks are still possible

    def add(self, where, what, right):
        self.errors.append(f"{self.file}: {where}: {what}\n  {right}")

    def note(self, where, what):
        self.notes.append(f"{self.file}: note: {where}: {what}")

    def go_on(self):
        """The errors so far do not prevent the check of the mesh against the model."""
        self.harmless = len(self.errors)

    def end_stage(self):
        """The next checks rely on all checks since then."""
        if len(self.errors) > self.harmless:
            raise Rejected

    def end(self):
        if self.errors:
            raise Rejected


def listed(names):
    return ", ".join(names) or "none"


def likely(name, names):
    """A question after a list of names, if one of them may be meant."""
    near = difflib.get_close_matches(name.lower(), [n.lower() for n in names], n=1)
    return next((f"; did you mean '{n}'?" for n in names if near and n.lower() == near[0]), "")


def spot(place):
    return f"({place[0]:.6g}, {place[1]:.6g})"
