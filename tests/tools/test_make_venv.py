"""tools/make_venv and tests/in_venv with a python3, an apt-get and an id that stand in for those of other machines."""
import shutil
import subprocess
import unittest

import common
from common import ROOT

# A python3 of version $MINOR; the file `bare` removes its venv; it makes a Python whose pip behaves as the file `pip` states.
PYTHON = """#!/bin/sh
echo "python3 $*" >> {place}/calls
case "$*" in
  --version) echo "Python 3.$MINOR.1" ;;
  *version_info*) echo "$MINOR" ;;
  *ensurepip*) [ ! -e {place}/bare ] ;;
  "-m venv --clear "*) mkdir -p "$4/bin" && cp {place}/made "$4/bin/python" ;;
  *) exit 9 ;;
esac
"""
MADE = """#!/bin/sh
echo "venv $*" >> {place}/calls
case "$*" in
  *version_info*) echo "$MINOR" ;;
  "-m pip "*) [ ! -e {place}/slow ] || sleep 1; [ ! -e {place}/offline ] || {{ echo "pip: no route to host" >&2; exit 1; }} ;;
  "-c import gmsh"*) [ ! -e {place}/headless ] || {{ echo "OSError: libGLU.so.1" >&2; exit 1; }} ;;
  *) exit 9 ;;
esac
"""
APT = """#!/bin/sh
echo "apt-get $*" >> {place}/calls
rm -f {place}/bare {place}/headless
"""
ID = """#!/bin/sh
cat {place}/user
"""


class Case(common.Case):
    def setUp(self):
        super().setUp()
        self.top, self.minor = self.place / "epcont", 11
        for name in ("tools/make_venv", "tools/requirements", "tools/requirements.txt", "tests/in_venv"):
            (self.top / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.top / name)
        self.note("user", "0\n")
        for name, text in (("python3", PYTHON), ("apt-get", APT), ("id", ID)):
            self.script(self.place / "bin" / name, text)
        self.script(self.place / "made", MADE)
        # None of this machine's Pythons is used.
        for name in ("sh", "cat", "cmp", "cp", "rm", "basename", "mkdir", "touch", "sed", "seq", "tail", "dirname", "sleep", "flock", "timeout"):
            if shutil.which(name):
                (self.place / "bin" / name).symlink_to(shutil.which(name))

    def script(self, path, text):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text.format(place=self.place))
        path.chmod(0o755)

    def note(self, name, text=""):
        (self.place / name).write_text(text)

    def environment(self, **further):
        return {"PATH": str(self.place / "bin"), "MINOR": str(self.minor), **further}

    def run_it(self, status, *arguments, tool="tools/make_venv", **further):
        self.note("calls")
        run = subprocess.run([self.top / tool, *arguments], cwd=self.place, env=self.environment(**further), capture_output=True, text=True,
                             timeout=60)
        self.assertEqual(status, run.returncode, run.stdout + run.stderr)
        return run

    def calls(self, word):
        return [line for line in (self.place / "calls").read_text().splitlines() if word in line]


class Making(Case):
    def test_made_once_and_its_path_printed(self):
        run = self.run_it(0)
        self.assertEqual(f"{self.top}/build/venv/bin/python\n", run.stdout)
        pip, = self.calls("pip install")
        self.assertIn("--no-deps --requirement tools/requirements.txt", pip)
        self.assertRegex(pip, r"--timeout \d+ --retries \d ")   # it gives up if nothing answers
        self.assertEqual((run.stdout, ""), (self.run_it(0).stdout, self.run_it(0).stderr))
        self.assertEqual([], self.calls("pip"))

    def test_each_python_that_they_are_made_for(self):
        for self.minor in range(9, 14):
            self.run_it(0)
            self.assertEqual(1, len(self.calls("pip install")))

    def test_other_packages_or_another_python_make_it_again(self):
        self.run_it(0)
        with open(self.top / "tools" / "requirements.txt", "a") as file:
            file.write("another==1.0\n")
        self.run_it(0)
        self.assertEqual(1, len(self.calls("pip install")))
        self.minor = 12   # a system that was upgraded
        self.run_it(0)
        self.assertEqual(1, len(self.calls("pip install")))

    def test_calls_at_once_wait_for_one(self):
        if not shutil.which("flock"):
            self.skipTest("no flock")
        self.note("slow")
        self.note("calls")
        runs = [subprocess.Popen([self.top / "tools" / "make_venv"], env=self.environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
                for _ in range(3)]
        said = {run.communicate(timeout=60)[0] for run in runs}
        self.assertEqual({f"{self.top}/build/venv/bin/python\n"}, said)
        self.assertEqual(1, len(self.calls("pip install")))

    def test_packages_of_the_system(self):
        self.note("bare")
        self.note("headless")
        self.run_it(0)
        self.assertRegex(self.calls("apt-get")[0], r"^apt-get install -y --no-install-recommends .* python3-venv libglu1-mesa ")
        self.note("headless")
        shutil.rmtree(self.top / "build")
        self.run_it(0)
        self.assertIn("libglu1-mesa", self.calls("apt-get")[0])


class Refusals(Case):
    def refused(self, *words, **further):
        run = self.run_it(3, **further)
        self.assertEqual("", run.stdout)
        for word in words:
            self.assertIn(word, run.stderr)

    def test_a_python_without_packages(self):
        for self.minor in (8, 14):
            self.refused("tools/requirements.txt are for Python 3.9 to 3.13", f"this python3 is Python 3.{self.minor}.1")

    def test_another_python_beside_it_serves(self):
        self.minor = 14
        self.script(self.place / "bin" / "python3.10", PYTHON.replace("$MINOR", "10"))
        self.run_it(0)

    def test_no_right_to_install(self):
        self.note("user", "1000\n")
        self.note("bare")
        self.refused("please run: sudo apt-get update && sudo apt-get install -y --no-install-recommends python3-venv libglu1-mesa ")

    def test_no_pypi(self):
        self.note("offline")
        self.refused("pip: no route to host", "pip did not install tools/requirements.txt", "check the access to PyPI")
        (self.place / "offline").unlink()
        self.run_it(0)

    def test_packages_that_do_not_load(self):
        self.note("headless")
        self.script(self.place / "bin" / "apt-get", "#!/bin/sh\n")
        self.refused("the packages cannot be imported: OSError: libGLU.so.1")

    def test_a_place_that_cannot_be_written(self):
        (self.top / "build").write_text("")
        self.refused(f"{self.top}/build cannot be written")

    def test_usage(self):
        self.assertIn("nonsense: no such set of packages: give tools, vtk or benchmark", self.run_it(3, "nonsense").stderr)
        self.assertIn("tools/make_venv [tools|vtk|benchmark]: make", self.run_it(0, "--help").stdout)


class Skipping(Case):
    def test_a_test_is_skipped_or_fails(self):
        self.note("offline")
        run = self.run_it(77, "tools", "any.py", tool="tests/in_venv")
        self.assertEqual("skipped: pip did not install tools/requirements.txt (above; limit 1200 s): check the access to PyPI",
                         run.stdout.splitlines()[-1])
        self.run_it(77, "tools", "any.py", tool="tests/in_venv", EPCONT_NEED_VENV="0")
        self.run_it(1, "tools", "any.py", tool="tests/in_venv", EPCONT_NEED_VENV="1")

    def test_usage(self):
        self.assertIn("SCRIPT", self.run_it(3, tool="tests/in_venv").stderr)

    def test_a_test_runs(self):
        self.run_it(9, "tools", "any.py", "more", tool="tests/in_venv")   # the stand-in has no such script
        self.assertEqual(["venv -B any.py more"], self.calls("any.py"))


class Lists(unittest.TestCase):
    def test_each_list_names_its_pythons(self):
        for path in ("tools/requirements.txt", "tests/vtk/requirements.txt", "tools/benchmark/requirements.txt"):
            self.assertRegex((ROOT / path).read_text(), r"\A# Python 3\.\d+ to 3\.\d+: ")


if __name__ == "__main__":
    unittest.main(verbosity=2)   # shows why a test is skipped
