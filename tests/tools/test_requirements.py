"""tools/run and tools/test with a compiler, a CMake, an apt-get and an id that stand in for those of other machines; tests/skipped."""
import shutil
import subprocess
import unittest

import common
from common import ROOT

PRINTED = "packages are missing; please run: sudo apt-get update && sudo apt-get install -y --no-install-recommends"

# Steps named in the file `slow` take three seconds. CMake finds a LAPACK if there is the file `liblapack.so`, and prints CMake's messages.
CMAKE = """#!/bin/sh
echo "cmake $*" >> "{place}/calls"
case "$*" in
  --preset*)
    echo "generator $CMAKE_GENERATOR" >> "{place}/calls"
    [ -e "{place}/liblapack.so" ] || {{ echo "Could NOT find LAPACK (missing: LAPACK_LIBRARIES)" >&2; exit 1; }}
    mkdir -p "build/$2" && touch "build/$2/Makefile"
    [ -e "{place}/bin/python3" ] && found=/usr/bin/python3 || found=_Python3_EXECUTABLE-NOTFOUND
    echo "_Python3_EXECUTABLE:INTERNAL=$found" > "build/$2/CMakeCache.txt" ;;
  --build*)
    [ ! -e "{place}/broken" ] || {{ echo "Error: syntax" >&2; exit 2; }}
    grep -q build "{place}/slow" 2>/dev/null && sleep 3
    printf '#!/bin/sh\\necho "epcont $*"\\nexit 4\\n' > "build/$3/epcont" && chmod +x "build/$3/epcont" ;;
esac
"""
# Installed packages exist afterwards; lists of packages have to be fetched first.
APT = """#!/bin/sh
echo "apt-get $*" >> "{place}/calls"
case "$*" in
  update) touch "{place}/lists" ;;
  *)
    [ -e "{place}/lists" ] || exit 100
    for package; do
      case $package in
        gfortran | cmake | make | python3) ln -s "{place}/kept/$package" "{place}/bin/$package" ;;
        libopenblas-openmp-dev) touch "{place}/liblapack.so" ;;
      esac
    done ;;
esac
"""
CTEST = """#!/bin/sh
echo "ctest $*" >> "{place}/calls"
echo "ctest's summary"
while [ "$1" != --output-junit ]; do shift; done
cp "{place}/results.xml" "$2"
exit 8
"""
RESULTS = """<?xml version="1.0" encoding="UTF-8"?>
<testsuite tests="5">
  <testcase name="good" status="run"><system-out>all well</system-out></testcase>
  <testcase name="drawing" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/><system-out>making
skipped: pip did not install it
</system-out></testcase>
  <testcase name="meshing" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/><system-out>skipped: pip did not install it</system-out></testcase>
  <testcase name="faults" status="run"><system-out>test_a (__main__.Case.test_a)
What it does. ... skipped 'no right to mount'
test_b (__main__.Case.test_b) ... skipped "root's"
OK (skipped=2)
</system-out></testcase>
  <testcase name="silent" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/><system-out></system-out></testcase>
</testsuite>
"""
TOLD = """
Skipped, and why:
  drawing, meshing: pip did not install it
  faults in part: no right to mount
  faults in part: root's
  silent: it does not say why
"""
HOST = ("sh", "bash", "basename", "cat", "chmod", "cp", "dirname", "env", "grep", "ln", "mkdir", "mv", "rm", "sed", "sleep", "touch")


class Case(common.Case):
    def setUp(self):
        super().setUp()
        self.place /= "with blanks"
        self.top = self.place / "a clone"
        for name in ("tools/requirements", "tools/run", "tools/build", "tools/test", "tests/skipped"):
            (self.top / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, self.top / name)
        (self.place / "results.xml").write_text(RESULTS)
        for folder in ("bin", "kept"):
            (self.place / folder).mkdir()
        for name, text in (("apt-get", APT), ("ctest", CTEST), ("id", '#!/bin/sh\ncat "{place}/user"\n'),
                           ("ls", '#!/bin/sh\n[ -e "{place}/${{1##*/}}" ] && echo "$1"\n')):
            self.script("bin", name, text)
        for name, text in (("cmake", CMAKE), ("gfortran", "#!/bin/sh\n"), ("make", "#!/bin/sh\n")):
            self.script("kept", name, text)
        (self.place / "kept" / "python3").symlink_to(shutil.which("python3"))
        for name in HOST:   # nothing else of this machine
            if shutil.which(name):
                (self.place / "bin" / name).symlink_to(shutil.which(name))
        self.machine()

    def script(self, folder, name, text):
        path = self.place / folder / name
        path.write_text(text.format(place=self.place))
        path.chmod(0o755)

    def machine(self, user=1000, lacking=(), lapack=True, apt=True):
        (self.place / "user").write_text(f"{user}\n")
        for name in ("gfortran", "cmake", "make", "python3"):
            (self.place / "bin" / name).unlink(missing_ok=True)
            if name not in lacking:
                (self.place / "bin" / name).symlink_to(self.place / "kept" / name)
        (self.place / "liblapack.so").unlink(missing_ok=True)
        if lapack:
            (self.place / "liblapack.so").touch()
        if not apt:
            (self.place / "bin" / "apt-get").unlink()

    def run_it(self, status, *words, shell=()):
        (self.place / "calls").write_text("")
        run = subprocess.run([*shell, *words], cwd=self.top, env={"PATH": str(self.place / "bin")}, capture_output=True, text=True,
                             timeout=60)
        self.assertEqual(status, run.returncode, run.stdout + run.stderr)
        return run

    def calls(self, word):
        return [line for line in (self.place / "calls").read_text().splitlines() if line.startswith(word)]


class Complete(Case):
    """If everything is there nothing is installed, for any user, and only the answer is printed."""

    def check(self):
        run = self.run_it(4, "tools/run", "a deck.dat", "--quiet")
        self.assertEqual(("epcont a deck.dat --quiet\n", ""), (run.stdout, run.stderr))
        self.assertEqual([], self.calls("apt-get"))
        self.assertEqual(["cmake --preset release", "cmake --build --preset release --parallel 2 --target epcont"], self.calls("cmake"))

    def test_plain_user(self):
        self.check()
        self.assertEqual(["generator "], self.calls("generator"))

    def test_ninja(self):
        (self.place / "bin" / "ninja").symlink_to(self.place / "kept" / "make")
        self.check()
        self.assertEqual(["generator Ninja"], self.calls("generator"))

    def test_without_apt(self):
        self.machine(apt=False)
        self.check()

    def test_root(self):
        self.machine(user=0)
        self.check()

    def test_without_python(self):
        self.machine(lacking=["python3"])
        self.check()

    def test_configured_once(self):
        self.run_it(4, "tools/run")
        self.run_it(4, "tools/run")
        self.assertEqual([], self.calls("cmake --preset"))

    def test_bash_says_no_more(self):
        self.assertEqual("", self.run_it(0, "tools/build", shell=["bash"]).stderr)


class Missing(Case):
    def refused(self, line, *words):
        run = self.run_it(3, *words)
        self.assertEqual(("", f"{words[0]}: {line}\n"), (run.stdout, run.stderr))
        self.assertEqual([], self.calls("apt-get") + self.calls("cmake --build"))

    def test_command_for_a_plain_user(self):
        self.machine(lacking=["gfortran", "cmake", "make", "python3"], lapack=False)
        self.refused(f"{PRINTED} gfortran cmake make libopenblas-openmp-dev", "tools/run", "deck.dat")
        self.refused(f"{PRINTED} gfortran cmake make python3 libopenblas-openmp-dev", "tools/test")

    def test_no_second_lapack(self):
        self.machine(lacking=["cmake"])
        self.refused(f"{PRINTED} cmake", "tools/run", "deck.dat")

    def test_lapack_alone(self):
        self.machine(lapack=False)
        self.refused(f"{PRINTED} libopenblas-openmp-dev", "tools/run", "deck.dat")

    def test_without_apt(self):
        self.machine(lacking=["make"], apt=False)
        self.refused("missing packages: install make (names of Debian packages)", "tools/build")
        self.machine(lapack=False, apt=True)
        (self.place / "bin" / "apt-get").unlink(missing_ok=True)
        self.refused("missing packages: install libopenblas-openmp-dev (names of Debian packages)", "tools/build")

    def test_root_installs_missing_packages(self):
        self.machine(user=0, lacking=["gfortran", "make"])
        self.assertEqual("epcont deck.dat\n", self.run_it(4, "tools/run", "deck.dat").stdout)
        get = "apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=120 gfortran make"
        self.assertEqual([get, "apt-get update", get], self.calls("apt-get"))

    def test_root_installs_a_lapack(self):
        self.machine(user=0, lapack=False)
        self.run_it(4, "tools/run", "deck.dat")
        self.assertRegex(self.calls("apt-get")[-1], " libopenblas-openmp-dev$")
        self.assertEqual(2, len(self.calls("cmake --preset release")))

    def test_messages_of_apt(self):
        self.machine(user=0, lacking=["make"])
        self.script("bin", "apt-get", "#!/bin/sh\necho 'E: no such host' >&2\nexit 100\n")
        self.assertEqual("E: no such host\n", self.run_it(3, "tools/build").stderr)


class Telling(Case):
    def test_long_steps(self):
        (self.place / "slow").write_text("build")
        self.assertEqual("tools/build: building build/debug/epcont (a minute or two where all is new)\n", self.run_it(0, "tools/build", "debug").stderr)

    def test_a_build_that_fails(self):
        (self.place / "broken").touch()
        self.assertEqual("Error: syntax\n", self.run_it(3, "tools/build").stderr)

    def test_tests(self):
        run = self.run_it(8, "tools/test", "-R", "name")
        self.assertEqual("ctest's summary\n" + TOLD, run.stdout)
        self.assertEqual("tools/test: testing build/release (all tests take some five minutes on two cores)\n", run.stderr)
        call, = self.calls("ctest")
        self.assertTrue(call.startswith("ctest --preset release --parallel 2 ") and call.endswith(" -R name"), call)

    def test_tests_find_a_python_that_has_come_since_the_program_was_built(self):
        self.machine(lacking=["python3"])
        self.run_it(4, "tools/run")
        self.machine()
        for times in (1, 0):
            self.run_it(8, "tools/test")
            self.assertEqual(times, len(self.calls("cmake --preset")))

    def test_none_run(self):
        (self.place / "results.xml").unlink()
        self.assertEqual("ctest's summary\n", self.run_it(8, "tools/test", "-N").stdout)

    def test_nothing_skipped(self):
        (self.place / "results.xml").write_text("<testsuite><testcase name='good'><system-out>well</system-out></testcase></testsuite>")
        self.assertEqual("ctest's summary\n", self.run_it(8, "tools/test").stdout)


if __name__ == "__main__":
    unittest.main()
