"""Build the Debian package, unpack it into an empty root, and run it there with only its stated dependencies.

The root has the package, the files of its dependencies (copied from this machine's packages, which must be installed) and no
folder of this project; the environment is empty. Not separate: the kernel and its devices, the user, the network; and the
dependencies are those of this machine, not ones that apt has just fetched.
Exit status 77: a required tool is missing here.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT, BUILD = pathlib.Path(os.environ["EPCONT_SOURCE_DIR"]), pathlib.Path(os.environ["EPCONT_BUILD_DIR"])
PROGRAM, CMAKE = os.environ["EPCONT_PROGRAM"], os.environ["EPCONT_CMAKE"]
CPACK = shutil.which("cpack", path=str(pathlib.Path(CMAKE).parent)) or "cpack"
TOOLS = [CPACK, "dpkg-deb", "dpkg-query", "dpkg-shlibdeps", "file", "gzip", "unshare", "chroot"]
DECK = "share/doc/epcont/examples/hertz44.dat"
MANUAL = {f"share/doc/epcont/input/{name}.md"
          for name in ("README", "coming_from", "glossary", "reading_a_listing", "troubleshooting", "verification")}
INSTALLED = {"bin/epcont", "share/man/man1/epcont.1", "share/doc/epcont/README.md", "share/doc/epcont/CHANGELOG.md",
             "share/doc/epcont/copyright", DECK} | MANUAL
EXAMPLE = "share/doc/epcont/examples/library"
LIBRARY = {"lib/libepcont.a", "lib/fortran/epcont/epcont.mod", "lib/cmake/epcont/epcontConfig.cmake",
           "lib/cmake/epcont/epcontConfigVersion.cmake", "lib/cmake/epcont/epcontTargets.cmake",
           "lib/cmake/epcont/epcontTargets-release.cmake"} | {f"{EXAMPLE}/{name}" for name in ("CMakeLists.txt", "README.md", "two_blocks.f90")}
PACKED = {"bin/epcont", "share/man/man1/epcont.1.gz", "share/doc/epcont/README.md", "share/doc/epcont/changelog.gz",
          "share/doc/epcont/copyright", DECK} | MANUAL


def run(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)


def files(folder):
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir() or path.is_symlink()}


def results(folder):
    return {path.name: path.read_bytes() for path in folder.glob("hertz44.*") if path.suffix != ".dat"}


class Closure:
    """Installed packages that satisfy a list of dependencies, with their own dependencies."""

    def __init__(self, depends):
        self.depends, self.providers = {}, {}
        shown = run("dpkg-query", "-W", "-f", "${Package}\t${Architecture}\t${db:Status-Status}\t${Provides}\t${Depends}, ${Pre-Depends}\n").stdout
        for line in shown.splitlines():
            name, architecture, status, provides, wanted = line.split("\t")
            if status != "installed":
                continue
            self.depends[name] = wanted
            for one in [name] + self.names(provides):
                self.providers.setdefault(one, []).append((name, architecture))
        self.packages = {}
        self.add(depends)

    @staticmethod
    def names(text):
        return [re.match(r"[\w.+-]+", word.strip())[0] for word in re.split(r"[,|]", text) if word.strip()]

    def add(self, depends):
        for group in filter(str.strip, depends.split(",")):
            found = [provider for name in self.names(group) for provider in self.providers.get(name, [])]
            if not found:
                self.stand_in(group)
                continue
            name, architecture = found[0]
            if name not in self.packages:
                self.packages[name] = architecture
                self.add(self.depends[name])

    def stand_in(self, group):
        """A package that is not installed here adds only its own dependencies to the root, as apt knows them."""
        shown = run("apt-cache", "show", "--no-all-versions", self.names(group)[0]).stdout
        depends = re.search(r"^Depends: (.*)", shown, re.MULTILINE)
        if not depends:
            raise AssertionError(f"not installed here, and unknown to apt: {group.strip()}")
        print(f"not installed here; what it depends on stands for it: {group.strip()}")
        self.add(depends[1])

    def copy_to(self, root):
        """Their libraries, and their links by alternatives."""
        for folder in ("lib", "lib64"):
            (root / "usr" / folder).mkdir(parents=True, exist_ok=True)
            if pathlib.Path("/" + folder).is_symlink() and not (root / folder).is_symlink():
                (root / folder).symlink_to(f"usr/{folder}")
        for name in self.packages:
            for path in map(pathlib.Path, run("dpkg-query", "-L", name).stdout.splitlines()):
                if not re.match(r"(/usr)?/lib", str(path)) or path.is_dir() and not path.is_symlink():
                    continue
                self.copy(path, root)
        for link in pathlib.Path("/usr/lib").glob("*/lib*.so*"):
            if link.is_symlink() and os.readlink(link).startswith("/etc/alternatives/"):
                chosen = pathlib.Path(os.readlink(link))
                if (root / os.readlink(chosen).lstrip("/")).exists():
                    self.copy(link, root)
                    self.copy(chosen, root)

    @staticmethod
    def copy(path, root):
        there = root / str(path).lstrip("/")
        there.parent.mkdir(parents=True, exist_ok=True)
        if path.exists() and not there.is_symlink() and not there.exists():
            shutil.copy2(path, there, follow_symlinks=False)


class Installed(unittest.TestCase):
    def test_install(self):
        """`cmake --install` copies the same files to any folder, and the program runs from there."""
        with tempfile.TemporaryDirectory() as name:
            place = pathlib.Path(name)
            done = run(CMAKE, "--install", BUILD, "--prefix", place)
            self.assertEqual(0, done.returncode, done.stderr)
            self.assertEqual(INSTALLED | LIBRARY, files(place))
            self.assertEqual(run(PROGRAM, "--man").stdout, (place / "share/man/man1/epcont.1").read_text())
            done = run(place / "bin/epcont", place / DECK, cwd=place, env={})
            self.assertEqual((0, ""), (done.returncode, done.stderr))

    def test_library(self):
        """The example, outside of the project: built with installed files only, and its forces."""
        with tempfile.TemporaryDirectory() as name:
            place = pathlib.Path(name)
            self.assertEqual(0, run(CMAKE, "--install", BUILD, "--prefix", place / "epcont").returncode)
            done = run(CMAKE, "-S", place / "epcont" / EXAMPLE, "-B", place / "build", f"-DCMAKE_PREFIX_PATH={place / 'epcont'}", cwd=place)
            self.assertEqual(0, done.returncode, done.stdout + done.stderr)
            done = run(CMAKE, "--build", place / "build", cwd=place)
            self.assertEqual(0, done.returncode, done.stdout + done.stderr)
            done = run(place / "build/two_blocks", cwd=place)
            self.assertEqual(done.stdout, self.linked_by_hand(place))
            self.assertEqual((0, ""), (done.returncode, done.stderr))
            forces = [float(force) for force in re.findall(r"force +([\d.]+), gap +0.00E\+00", done.stdout)]
            self.assertRegex(done.stdout, r"^answer: valid\n")
            self.assertEqual(5, len(forces))
            for force, mirrored in zip(forces, reversed(forces)):
                self.assertAlmostEqual(mirrored, force, delta=1e-3)
            # A strip of E' = E/(1 - nu^2) in each block, 4 long and 1 high, gives 4 times 0.001/(1/E1' + 1/E2') without transverse strain.
            self.assertAlmostEqual(4e-3/(0.91/2.1e5 + 0.8911/7e4), sum(forces), delta=0.25*sum(forces))

    def test_sources_in_another_project(self):
        """add_subdirectory gives the target of find_package, and no tests, benchmarks or packages. (Only configured, for `make`, which lists its targets: building takes minutes.)"""
        with tempfile.TemporaryDirectory() as name:
            place = pathlib.Path(name)
            (place / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.21)\nproject(other LANGUAGES Fortran)\n"
                                                  f'add_subdirectory("{ROOT}" epcont EXCLUDE_FROM_ALL)\n'
                                                  f'add_executable(two_blocks "{ROOT}/input/library/two_blocks.f90")\n'
                                                  "target_link_libraries(two_blocks PRIVATE epcont::library)\n")
            done = run(CMAKE, "-G", "Unix Makefiles", "-S", place, "-B", place / "build", cwd=place)
            self.assertEqual(0, done.returncode, done.stdout + done.stderr)
            told = run(CMAKE, "--build", place / "build", "--target", "help").stdout
            self.assertIn("two_blocks", told)
            self.assertNotRegex(told, "bench_|test_")

    def linked_by_hand(self, place):
        """Libraries of the example, linked as the page describes."""
        page = (place / "epcont" / EXAMPLE / "README.md").read_text()
        compiler, = re.findall("CMAKE_Fortran_COMPILER:[A-Z]+=(.*)", (BUILD / "CMakeCache.txt").read_text())
        words = re.search("^    gfortran (.*)", page, re.MULTILINE)[1].replace("~/epcont", str(place / "epcont")).split()
        done = run(compiler, *words, "-o", place / "by_hand", cwd=place / "epcont" / EXAMPLE)
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        return run(place / "by_hand", cwd=place).stdout


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        directory = tempfile.TemporaryDirectory()
        cls.addClassCleanup(directory.cleanup)
        cls.place = pathlib.Path(directory.name)
        done = run(CPACK, "--config", BUILD / "CPackConfig.cmake", "-G", "DEB", "-B", cls.place / "pack")
        assert done.returncode == 0, done.stdout + done.stderr
        cls.package, = (cls.place / "pack").glob("*.deb")
        cls.root = cls.place / "root"
        done = run("dpkg-deb", "-x", cls.package, cls.root)
        assert done.returncode == 0, done.stderr
        cls.unpacked = files(cls.root)

    def field(self, name):
        return run("dpkg-deb", "-f", self.package, name).stdout.strip()

    def test_name(self):
        version = run(PROGRAM, "--version").stdout.split()[1]
        self.assertEqual(f"epcont_{version}_{run('dpkg', '--print-architecture').stdout.strip()}.deb", self.package.name)
        self.assertEqual(("epcont", version), (self.field("Package"), self.field("Version")))

    def test_contents(self):
        """Exactly these files, owned by root, readable for all."""
        self.assertEqual({f"usr/{name}" for name in PACKED}, self.unpacked)
        for line in run("dpkg-deb", "-c", self.package).stdout.splitlines():
            mode, owner = line.split()[:2]
            self.assertEqual("root/root", owner)
            self.assertIn(mode, ("drwxr-xr-x", "-rwxr-xr-x" if "/bin/" in line else "-rw-r--r--"), line)
        notices = (self.root / "usr/share/doc/epcont/copyright").read_text()
        self.assertIn("Permission is hereby granted", notices)
        is_static = "openblas" not in run("objdump", "-p", self.root / "usr/bin/epcont").stdout
        self.assertEqual(is_static, "The OpenBLAS Project" in notices)

    def test_depends(self):
        """Every library of the program is in a package that is named."""
        depends = Closure.names(self.field("Depends"))
        self.assertIn("libc6", depends)
        program = self.root / "usr/bin/epcont"
        needed = re.findall(r"NEEDED\s+(\S+)", run("objdump", "-p", program).stdout)
        for library, package in (("openblas", r"\blibopenblas"), ("gfortran", r"\blibgfortran5\b"), ("quadmath", r"\blibquadmath0\b")):
            if any(library in name for name in needed):
                self.assertRegex(" ".join(depends), package)
        self.assertEqual("", self.field("Recommends"))

    def test_run(self):
        """In a separate root; without its dependencies it does not run there, so they are needed."""
        deck, out = "/usr/" + DECK, self.root / "out"
        out.mkdir()
        enter = [shutil.which("chroot"), self.root]   # whole, as the empty environment below has no PATH
        if os.geteuid() != 0:
            enter[:0] = ["unshare", "--map-root-user"]
        command = [*enter, "/usr/bin/epcont", deck, "-o", "/out", "--tables", "all"]
        self.assertNotEqual(0, run(*command, env={"PATH": os.environ["PATH"]}).returncode)
        Closure(self.field("Depends")).copy_to(self.root)
        self.assertFalse((self.root / str(ROOT).lstrip("/")).exists())
        done = run(shutil.which(command[0]), *command[1:], env={}, cwd="/")
        if "Operation not permitted" in done.stderr:
            self.skipTest("no right to change the root: the package was not run")
        self.assertEqual((0, ""), (done.returncode, done.stderr))
        self.assertRegex(done.stdout, r"^hertz44  valid  p_max ")
        self.same_as_here(deck, out)

    def same_as_here(self, deck, out):
        """The same bytes as in this root. Also without environment: a variable may choose OpenBLAS' kernels, and these the last digits."""
        here = self.place / "here"
        done = run(PROGRAM, self.root / deck.lstrip("/"), "-o", here, "--tables", "all", cwd=self.place, env={})
        self.assertEqual(0, done.returncode, done.stderr)
        self.assertEqual(8, len(results(here)))
        self.assertEqual(results(here), results(out))


if __name__ == "__main__":
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if missing:
        print("skipped: no " + ", ".join(missing))
        sys.exit(77)
    print(__doc__)
    unittest.main(verbosity=2)   # shows why a test is skipped
