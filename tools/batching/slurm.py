"""A batch as an array job of Slurm: each task runs a share of the decks and reports through files only.

Only `sbatch`, `squeue` and `scontrol` are needed, no accounting database. A task that has left the queue and
whose journal is incomplete was killed; it is submitted again with the same options, and continues.
"""
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

from wording import counted

from .decks import Refused
from .outcome import KILLED

CHUNK = 50             # default number of decks per task
MOST_TASKS = 1000      # Slurm's default MaxArraySize is 1001
TRIES = 3              # largest number of submissions of a task, unless some decks have not been tried alone
SHORTEST, LONGEST = 2.0, 30.0   # time between queries of the queue [s]


def shares(decks, chunk):
    """Divide the decks into tasks of about `chunk` decks. They are dealt in turn, so that the long ones at the beginning go to different tasks."""
    chunk = chunk or max(CHUNK, -(-len(decks) // MOST_TASKS))
    tasks = -(-len(decks) // chunk)
    return [[deck.place for deck in decks[k::tasks]] for k in range(tasks)]


def ask(*command, **more):
    return subprocess.run(command, capture_output=True, text=True, check=False, **more)


def submit(book, plan, tasks, script):
    """Submit one array job with these tasks."""
    for task in tasks:   # create them now, so that no node caches that they are missing
        open(book.journal(f"task{task}"), "ab").close()
    folder = os.path.abspath(book.folder)
    command = ["sbatch", "--parsable", "--job-name=epcont", f"--array={','.join(map(str, tasks))}", f"--chdir={plan['cwd']}",
               f"--output={os.path.join(folder.replace('%', '%%'), 'task%a.out')}", "--open-mode=append", "--ntasks=1",
               f"--cpus-per-task={plan['processes']}", *plan["sbatch"]]
    text = f"#!/bin/sh\nexec {shlex.quote(script)} --task {shlex.quote(os.path.abspath(book.directory))} " \
           f"\"$SLURM_ARRAY_TASK_ID\" {plan['id']}\n"
    try:
        with tempfile.TemporaryFile("w+") as job:   # not a pipe: if sbatch ended without reading it, SIGPIPE would end the batch
            job.write(text)
            job.seek(0)
            done = ask(*command, stdin=job)
    except OSError as error:
        raise Refused(f"sbatch cannot be started: {error.strerror}: leave --slurm out if there is no Slurm") from None
    if done.returncode:
        raise Refused(f"sbatch: {done.stderr.strip() or done.stdout.strip()}")
    job = done.stdout.strip().split(";")[0]
    plan["jobs"].append({"id": job, "tasks": tasks})
    book.save(plan)
    return job


def queued():
    """(job, task) of all waiting or running tasks; None if Slurm does not answer."""
    try:
        done = ask("squeue", "--noheader", "--array", f"--user={os.getuid()}", "--format=%F %K")
    except OSError:
        return None
    if done.returncode:
        return None
    return {tuple(line.split()) for line in done.stdout.splitlines()}


def reason(job, task):
    """Reason why a task has ended, while Slurm remembers it."""
    try:
        done = ask("scontrol", "--oneliner", "show", "job", f"{job}_{task}")
    except OSError:
        return "unknown to Slurm"
    state = re.search(r"\bJobState=(\S+)", done.stdout)
    return state[1] if state else "unknown to Slurm"


class Watch:
    """Watches the tasks of a plan until each deck has ended or is lost."""

    def __init__(self, book, plan, script):
        self.book, self.plan, self.script = book, plan, script
        self.missing = set()    # tasks missing from the queue at the last query
        self.untried = {}       # for each task: attempts alone still missing for its decks, at the last look

    def unfinished(self, ends):
        """Places without an end that are not lost, by task."""
        found = {}
        for task, places in enumerate(self.plan["tasks"]):
            left = [place for place in places if place not in self.plan["lost"]
                    and (place not in ends or ends[place]["row"]["status"] == KILLED)]
            if left:
                found[task] = left
        return found

    def jobs_of(self, task):
        return [job["id"] for job in self.plan["jobs"] if task in job["tasks"]]

    def wait(self, show):
        """`show(ends)` is called regularly with the current state."""
        pause, answered = SHORTEST, True
        while True:
            queue = queued()            # before the journals: a task that has left the queue has written its journal
            if queue is None and answered:
                print("squeue does not answer: waiting for it, and for running tasks", file=sys.stderr)
            answered = queue is not None
            ends, begun = self.book.entries()
            show(ends)
            left = self.unfinished(ends)
            if not left:
                return
            if queue is not None:
                self.look_after(left, queue, begun)
            pause = SHORTEST if self.missing else min(1.3 * pause, LONGEST)
            time.sleep(pause)

    def given_up(self, task, places, begun, why):
        """Give a task up after some attempts, unless the last one ran decks alone: no deck is lost because of another."""
        untried, before = sum(2 - (place in begun) - (begun[place] > 0) for place in places), self.untried.get(task)
        self.untried[task] = untried
        hopeful = 0 < untried and (before is None or untried < before) and not why.startswith("CANCELLED")
        return len(self.jobs_of(task)) >= TRIES and not hopeful

    def look_after(self, left, queue, begun):
        """Submit killed tasks again; give up those killed too often. A task counts as killed if it is missing twice: files may be late."""
        gone = {task for task in left if not any((job, str(task)) in queue for job in self.jobs_of(task))}
        killed, self.missing = sorted(gone & self.missing), gone - self.missing
        again = []
        for task in killed:
            jobs = self.jobs_of(task)
            why = reason(jobs[-1], task) if jobs else "never submitted"
            lost = self.given_up(task, left[task], begun, why)
            print(f"task {task}: {why}, {counted(len(left[task]), 'deck')} left" +
                  (f"; given up after {len(jobs)} times" if lost else "; submitted again"), file=sys.stderr)
            if not lost:
                again.append(task)
            else:
                said = f"killed {len(jobs)} times, last: {why}; see {self.book.folder}/task{task}.out"
                self.plan["lost"].update(dict.fromkeys(left[task], said))
        if again:
            submit(self.book, self.plan, again, self.script)
        elif killed:
            self.book.save(self.plan)
