"""Run tools in copies of the process that tests them: it has loaded their modules once, which takes longer than most tools run."""
import multiprocessing
import os
import subprocess
import sys
import tempfile


def run(start, *arguments, cwd=".", env=None, timeout=120):
    """The equivalent of subprocess.run for a Python program that `start` runs: exit status and output."""
    with tempfile.TemporaryFile("w+", errors="replace") as output, tempfile.TemporaryFile("w+", errors="replace") as errors:
        copy = multiprocessing.get_context("fork").Process(target=begin, args=(start, arguments, cwd, env, output.fileno(), errors.fileno()))
        copy.start()
        copy.join(timeout)
        if copy.exitcode is None:
            copy.kill()
            raise subprocess.TimeoutExpired(arguments, timeout)
        printed = []
        for file in (output, errors):
            file.seek(0)
            printed.append(file.read())
    return subprocess.CompletedProcess(arguments, copy.exitcode, *printed)


def begin(start, arguments, cwd, env, output, errors):
    os.chdir(cwd)
    os.dup2(output, 1)
    os.dup2(errors, 2)
    if env is not None:
        os.environ.clear()
        os.environ.update(env)
    sys.argv = [str(argument) for argument in arguments]
    start()
