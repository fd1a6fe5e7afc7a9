"""Runs of decks, several at once, each a process of its own: what one does is no other's concern.

One thread waits for signals: a child that has ended, or that the batch is to stop. `posix_spawn` and `wait4` cost little and tell
processor time and memory of each child; its messages go to a file in memory.
"""
import os
import resource
import signal
import time
from dataclasses import dataclass

from .book import size_of
from .decks import fingerprint
from .outcome import forget, row_of

GRACE = 5.0             # s between asking a run to end and ending it
MOST_SAID = 1 << 16     # of messages read
IGNORED = (signal.SIGPIPE, signal.SIGXFSZ)   # by Python; not for its children
STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass
class Ended:
    code: int          # exit status, or minus the signal
    said: str          # on standard error
    seconds: float     # by the clock
    memory: float      # largest resident set [kB]; 0 where it is not known
    limit: float = 0   # time limit that was exceeded


@dataclass
class Run:
    deck: object
    inputs: str
    said: int
    begun: float
    over: float = 0.0     # when it was asked to end


class Stopped(Exception):
    """Somebody wants the batch to end; the signal is the argument."""


class Runner:
    """`settings`: program, version, seconds and memory [GB] (or none) for each deck; `tell` is called now and then."""

    def __init__(self, book, journal, settings, tell=lambda: None):
        self.book, self.journal, self.settings, self.tell = book, journal, settings, tell
        self.running = {}
        self.environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.watched = {signal.SIGCHLD} | {each for each in STOPPING if signal.getsignal(each) != signal.SIG_IGN}

    def run(self, decks, processes):
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, self.watched)
        waiting = iter(decks)
        try:
            more = True
            while more or self.running:
                while more and len(self.running) < processes:
                    deck = next(waiting, None)
                    more = deck is not None
                    if more:
                        self.start(deck)
                if self.running:
                    self.wait()
                self.tell()
        finally:
            self.end_all()
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def start(self, deck):
        stem, settings = self.book.stem(deck), self.settings
        inputs = fingerprint(deck.path)[0]
        self.journal.add({"place": deck.place})
        forget(stem)
        folder, said, begun = os.path.dirname(stem) or ".", os.memfd_create("said"), time.monotonic()
        command = [settings["program"], deck.path, "-o", folder, "--quiet"]
        if settings["memory"]:
            command += ["--memory", f"{settings['memory']:g}"]
        try:
            os.makedirs(folder, exist_ok=True)
            child = os.posix_spawn(settings["program"], command, self.environment, setpgroup=0, setsigmask=[], setsigdef=IGNORED,
                                   file_actions=[(os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
                                                 (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
                                                 (os.POSIX_SPAWN_DUP2, said, 2)])
        except OSError as error:
            os.close(said)
            what = f"{error.filename or settings['program']}: cannot be started: {error.strerror}"
            self.enter(deck, inputs, Ended(3, what, 0, 0))
            return
        self.running[child] = Run(deck, inputs, said, begun)

    def wait(self):
        """Wait for the next event; end what has run for too long."""
        now, limit = time.monotonic(), self.settings["seconds"]
        due = min(run.over + GRACE if run.over else run.begun + limit for run in self.running.values()) - now
        event = signal.sigtimedwait(self.watched, max(0.0, min(due, 1.0)))
        if event and event.si_signo in STOPPING:
            raise Stopped(event.si_signo)
        self.reap()
        now = time.monotonic()
        for child, run in self.running.items():
            if run.over and now >= run.over + GRACE:
                kill(child, signal.SIGKILL)
            elif not run.over and now >= run.begun + limit:
                run.over = now
                kill(child, signal.SIGTERM)

    def reap(self):
        while self.running:
            child, status, usage = os.wait4(-1, os.WNOHANG)
            if not child:
                return
            run = self.running.pop(child, None)
            if run is None:
                continue
            seconds = time.monotonic() - run.begun
            if run.over:
                kill(child, signal.SIGKILL)   # what it may have begun itself
            said = os.pread(run.said, MOST_SAID, 0).decode("latin-1")
            os.close(run.said)
            code = os.waitstatus_to_exitcode(status)
            limit = self.settings["seconds"] if run.over and code < 0 else 0   # it may have ended by itself just then
            # A child begins as its parent was: the system tells no peak below the parent's own.
            memory = usage.ru_maxrss if usage.ru_maxrss > resource.getrusage(resource.RUSAGE_SELF).ru_maxrss else 0
            self.enter(run.deck, run.inputs, Ended(code, said, seconds, memory, limit))

    def enter(self, deck, inputs, ended):
        stem = self.book.stem(deck)
        self.journal.add({"place": deck.place, "row": row_of(deck, stem, ended), "inputs": inputs, "at": time.time(),
                          "version": self.settings["version"], "listing": size_of(stem + ".lst")})

    def end_all(self):
        """Nothing of what was begun runs on; it is not entered, so that it counts as not run."""
        for child in self.running:
            kill(child, signal.SIGTERM)
        until = time.monotonic() + GRACE
        while self.running:
            child = os.wait4(-1, os.WNOHANG)[0]
            run = self.running.pop(child, None)
            if run:
                os.close(run.said)
            elif not child:
                time.sleep(0.01)
                if time.monotonic() > until:
                    for each in self.running:
                        kill(each, signal.SIGKILL)


def kill(group, number):
    try:
        os.killpg(group, number)
    except (ProcessLookupError, PermissionError):
        pass
