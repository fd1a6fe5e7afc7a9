"""Run decks, several at once, in separate processes, so that a crash does not affect other decks.

Starting a process takes longer than solving a small deck. So small decks share a process, and only valid results of a process that
ended normally are used: all its other decks are run again alone.

One thread waits for signals: a child has ended, or the batch is to stop. `posix_spawn` and `wait4` are cheap and report
processor time and memory of each child; its messages go to a file in memory.
"""
import collections
import os
import resource
import signal
import time
from dataclasses import dataclass

from .book import size_of
from .decks import inputs_of
from .outcome import ANSWERED, forget, row_of

GRACE = 5.0             # time between SIGTERM and SIGKILL [s]
SMALL = 100000          # largest deck that may share a process [bytes]: about 700 nodes
TOGETHER = 48           # largest number of decks in a process
MOST_SAID = 1 << 16     # bytes of messages that are read
IN_ORDER = (0, 1, 2, 4)   # exit statuses of solved and rejected decks; with any other, files may be missing
IGNORED = (signal.SIGPIPE, signal.SIGXFSZ)   # ignored by Python; children get the default
STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass
class Ended:
    code: int          # exit status, or minus the signal
    said: str          # text on standard error
    seconds: float     # wall-clock time
    memory: float      # largest resident set [kB]; 0 if unknown
    limit: float = 0   # time limit that was exceeded


@dataclass
class Run:
    decks: list
    inputs: list
    said: int
    begun: float
    over: float = 0.0     # time when it was asked to end


class Stopped(Exception):
    """The batch is to end; the signal is the argument."""


class Runner:
    """`settings`: program, version, seconds and memory [GB] (or None) for each deck; `tell` is called regularly."""

    def __init__(self, book, journal, settings, tell=lambda: None):
        self.book, self.journal, self.settings, self.tell = book, journal, settings, tell
        self.running, self.again = {}, collections.deque()
        self.environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        self.watched = {signal.SIGCHLD} | {each for each in STOPPING if signal.getsignal(each) != signal.SIG_IGN}

    def run(self, decks, processes, together=TOGETHER):
        """Run all decks; `together`: number of small decks that may share a process."""
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, self.watched)
        waiting = collections.deque(groups(decks, min(together, len(decks) // (4 * processes))))
        try:
            while waiting or self.again or self.running:
                while (waiting or self.again) and len(self.running) < processes:
                    self.start((self.again or waiting).popleft())
                if self.running:
                    self.wait()
                self.tell()
        finally:
            self.end_all()
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)

    def start(self, decks):
        settings, folder = self.settings, os.path.dirname(self.book.stem(decks[0])) or "."
        inputs = [inputs_of(deck) for deck in decks]
        for deck in decks:
            self.journal.add({"place": deck.place, "alone": len(decks) == 1})
            forget(self.book.stem(deck))
        command = [settings["program"], *(deck.path for deck in decks), "-o", folder, "--quiet"]
        if settings.get("one_table"):
            command.append("--brief")
        if settings["memory"]:
            command += ["--memory", f"{settings['memory']:g}"]
        said, begun = os.memfd_create("said"), time.monotonic()
        run = Run(decks, inputs, said, begun)
        try:
            os.makedirs(folder, exist_ok=True)
            child = os.posix_spawn(settings["program"], command, self.environment, setpgroup=0, setsigmask=[], setsigdef=IGNORED,
                                   file_actions=[(os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0),
                                                 (os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0),
                                                 (os.POSIX_SPAWN_DUP2, said, 2)])
        except OSError as error:
            os.close(said)
            self.settle(run, Ended(3, f"{error.filename or settings['program']}: cannot be started: {error.strerror}", 0, 0))
            return
        self.running[child] = run

    def wait(self):
        """Wait for the next event; stop runs that exceed the time limit."""
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
                kill(child, signal.SIGKILL)   # its own children, if it has any
            said = os.pread(run.said, MOST_SAID, 0).decode("latin-1")
            os.close(run.said)
            code = os.waitstatus_to_exitcode(status)
            limit = self.settings["seconds"] if run.over and code < 0 else 0   # it may just have ended by itself
            # A child begins with its parent's memory: the system reports no peak below that.
            memory = usage.ru_maxrss if usage.ru_maxrss > resource.getrusage(resource.RUSAGE_SELF).ru_maxrss else 0
            self.settle(run, Ended(code, said, seconds, memory, limit))

    def settle(self, run, ended):
        """Record the results of an ended process; decks of a shared process that are not valid are run again alone."""
        shared, one_table = len(run.decks) > 1, self.settings.get("one_table", False)
        if shared and ended.code not in IN_ORDER:
            self.again.extend([deck] for deck in run.decks)
            return
        if shared:
            ended = Ended(0, "", ended.seconds / len(run.decks), ended.memory)
        for deck, inputs in zip(run.decks, run.inputs):
            stem = self.book.stem(deck)
            row = row_of(deck, stem, ended, one_table)
            if shared and row["status"] != "valid":
                self.again.append([deck])
            else:
                if one_table and row["status"] in ANSWERED:
                    os.unlink(stem + ".summary.csv")
                self.journal.add({"place": deck.place, "row": row, "inputs": inputs, "at": time.time(),
                                  "version": self.settings["version"], "listing": size_of(stem + ".lst")})

    def end_all(self):
        """Stop all runs. They are not recorded, so they count as not run."""
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


def groups(decks, most):
    """Group small decks whose results go to one folder, `most` at once; each other deck is alone."""
    small, folders = [], {}
    for deck in decks:
        if most < 2 or not 0 < deck.size <= SMALL:
            yield [deck]
        else:
            small.append(deck)
    for deck in small:
        folders.setdefault(os.path.dirname(deck.place), []).append(deck)
    for together in folders.values():
        for first in range(0, len(together), most):
            yield together[first:first + most]


def kill(group, number):
    try:
        os.killpg(group, number)
    except (ProcessLookupError, PermissionError):
        pass
