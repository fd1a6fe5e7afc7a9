"""A copy of the project, its build without optimisation, and its tests in sequence."""
import hashlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import time

#: Tests of tools, documents and packages do not check results.
LABELS_LEFT_OUT = {"tools", "vtk", "package", "app", "from_gmsh", "round_trip"}
NAMES_LEFT_OUT = {"faults", "fuzzed_decks"}


def end(process):
    """Kill a test with all its child processes."""
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


class Trial:
    def __init__(self, root, place, longest):
        self.root, self.tree, self.folder, self.place = root, place / "tree", place / "build", place
        self.longest = longest                       # longest useful test [s]
        self.baseline, self.tests = {}, {}

    def copy(self):
        """Copy the tree, and restore files with a remaining mutant; unchanged files keep their time."""
        listed = subprocess.run(["git", "-C", self.root, "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
                                check=True, capture_output=True, text=True).stdout
        wanted = [pathlib.Path(name) for name in listed.split("\0") if name and (self.root / name).is_file()]
        for name in wanted:
            new, old = self.root / name, self.tree / name
            if not old.exists() or new.read_bytes() != old.read_bytes():
                old.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(new, old)
        for path in [path for path in self.tree.rglob("*") if path.is_file() and path.relative_to(self.tree) not in set(wanted)]:
            path.unlink()
        digest = hashlib.sha256()
        for name in sorted(wanted):
            digest.update(str(name).encode() + (self.tree / name).read_bytes())
        return digest.hexdigest()

    def configure(self):
        """One shared library, so that a mutant compiles one file and links once. Bounds are checked, as in
        `tools/test debug`: reading beyond an array may give any result."""
        generator = ["-G", "Ninja"] if shutil.which("ninja") and not (self.folder / "Makefile").exists() else []
        subprocess.run(["cmake", "-S", self.tree, "-B", self.folder, *generator, "-DCMAKE_BUILD_TYPE=Plain", "-DCMAKE_Fortran_FLAGS=-O0 -fcheck=bounds",
                        "-DBUILD_SHARED_LIBS=ON", "-DEPCONT_STATIC=OFF", "-DCMAKE_LINK_DEPENDS_NO_SHARED=ON"],
                       check=True, stdout=subprocess.DEVNULL)

    def build(self):
        return subprocess.run(["cmake", "--build", self.folder], capture_output=True).returncode == 0

    def find_tests(self):
        said = subprocess.run(["ctest", "--test-dir", self.folder, "--show-only=json-v1"], check=True, capture_output=True, text=True).stdout
        for test in json.loads(said)["tests"]:
            properties = {each["name"]: each["value"] for each in test["properties"]}
            labels = set(properties.get("LABELS", []))
            if shutil.which(test.get("command", [""])[0]) and not labels & LABELS_LEFT_OUT and test["name"] not in NAMES_LEFT_OUT:
                self.tests[test["name"]] = test["command"], properties, labels

    def run(self, name, seconds):
        """Does a test pass, and in how many seconds?"""
        command, properties, _ = self.tests[name]
        environment = dict(os.environ, **dict(each.split("=", 1) for each in properties.get("ENVIRONMENT", [])))
        begun = time.monotonic()
        process = subprocess.Popen(command, cwd=properties.get("WORKING_DIRECTORY"), env=environment, start_new_session=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            passed = process.wait(seconds) == 0
        except subprocess.TimeoutExpired:
            end(process)
            passed = False
        except BaseException:
            end(process)
            raise
        return passed, time.monotonic() - begun

    def take_baseline(self, digest, tell):
        """Tests that pass unchanged, and their times; from a file if the tree has not changed since."""
        file = self.place / "baseline.json"
        if file.exists():
            kept = json.loads(file.read_text())
            if kept["digest"] == digest and kept["longest"] == self.longest:
                self.baseline = kept["seconds"]
                return
        for name in self.tests:
            passed, seconds = self.run(name, self.longest)
            if passed:
                self.baseline[name] = seconds
            else:
                tell(f"left out: {name} " + ("takes too long" if seconds > self.longest else "fails without a mutant"))
        file.write_text(json.dumps({"digest": digest, "longest": self.longest, "seconds": self.baseline}))

    def order(self, layers, kills):
        """Sort the tests so that a failure is likely early: those of the layer, those that killed similar mutants, then by time."""
        def worth(name):
            likely = (1.0 if self.tests[name][2] & layers else 0.1) + kills.get(name, 0)
            return likely / (self.baseline[name] + 0.05)
        return sorted(self.baseline, key=worth, reverse=True)

    def judge(self, mutant, layers, kills, seconds):
        """Result of a mutant: (verdict, test that killed it, or number of tests passed)."""
        path = self.tree / mutant.path
        source = path.read_text()
        path.write_text(mutant.applied(source))
        try:
            if not self.build():
                return "does not compile", ""
            passed, begun = 0, time.monotonic()
            for name in self.order(layers, kills):
                if time.monotonic() - begun > seconds:
                    break
                if not self.run(name, 5.0 + 10.0 * self.baseline[name])[0]:
                    return "killed", name
                passed += 1
            return "survived", f"{passed} tests"
        finally:
            path.write_text(source)
