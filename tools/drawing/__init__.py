"""Pictures of runs. The options of tools/plot need this module only, so that --help needs no package."""
#: Kinds of panels.
KINDS = ("contact", "friction", "shape", "yielded", "history")


class Refused(Exception):
    """There is no picture: the message says why, `status` is the exit status."""

    def __init__(self, message, status=3):
        super().__init__(message)
        self.status = status
