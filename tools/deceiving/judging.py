"""Run random models and their twins, and compare their results."""
import math
import pathlib
import random
import subprocess
import sys
from dataclasses import dataclass, field

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from deceiving.families import FAMILIES  # noqa: E402
from deceiving.scenes import Twin, deck  # noqa: E402
from tables import rows, summary  # noqa: E402

SAME = 1e-7      # rounding differences between twins, relative to the largest value
CLOSE = 0.05     # allowed difference of a value without an estimate
DEEP = 0.105     # relative to the largest displacement: the program warns at a tenth, at other points of the edges
TOLD = "bodies penetrate each other by"    # unless the program warns of it, with the position: the forces have errors of about this size
NOTHING = "nothing touches"             # a mesh without contact is not compared with one in contact: its warning says so
FACETS = "pressures and approaches will be those of facets"   # then approaches are not compared
LARGE = "displacements too large for small-displacement theory"   # then master and slave exchanged may give different results
SMOOTH = math.radians(35.0)   # smaller rotations of an outline may belong to a curve made of chords
CHORDS = 8       # for an edge with a mid-side node
LARGEST = 350    # largest number of nodes; larger models are drawn again


def number(text):
    return float(text) if text else None


@dataclass
class Answer:
    """Results of one run, in the axes of the original model."""
    word: str = "rejected"
    message: str = ""
    total: float = 0.0
    total_error: float | None = None
    energy_error: float = 0.0
    resultant: list = field(default_factory=list)       # contact force on each body
    resultant_error: list = field(default_factory=list)
    displacement: list = field(default_factory=list)
    reaction: list = field(default_factory=list)
    approach: dict = field(default_factory=dict)        # point in `scene.free` -> value, estimate
    p_max: tuple = (None, None)
    half_width: tuple = (None, None)
    pairs: int = 0

    @property
    def valid(self):
        return self.word == "valid"


def read(scene, twin, numbers, folder, name, said):
    """Results of deck `name`; `said` are the lines on standard error."""
    answer = Answer()
    own = [line for line in said if f"{name}.dat" in line]
    answer.message = " / ".join(line.split(".dat", 1)[1].lstrip(":0123456789 ") for line in own)
    try:
        values = summary(folder / f"{name}.summary.csv")
        nodes = {int(row["node"]): row for row in rows(folder / f"{name}.nodes.csv")}
    except (OSError, KeyError):
        return answer
    answer.word = values.get("status", "none")
    if len(nodes) < len(numbers):
        return answer
    answer.total = number(values.get("total_contact_force")) or 0.0
    answer.total_error = number(values.get("mesh_error_total_contact_force"))
    answer.energy_error = number(values.get("mesh_error_energy_norm")) or 0.0
    answer.pairs = int(values.get("pairs_in_contact") or 0)
    for k in numbers:
        row = nodes[k]
        answer.displacement.append(twin.back((float(row["ux"]), float(row["uy"]))))
        answer.reaction.append(twin.back((float(row["rx"] or 0), float(row["ry"] or 0))))
    forces = dict(scene.forces)
    for body in scene.bodies:
        sums = [0.0, 0.0]
        for k in body.at.values():
            for c in range(1 if scene.rings else 0, 2):   # a radial sum is not a force: hoop stresses contribute, and the contact part is in the total
                sums[c] -= answer.reaction[k][c] + forces.get(k, (0.0, 0.0))[c]
        answer.resultant.append(sums)
    answer.resultant_error = errors_of_bodies(scene, numbers, folder / f"{name}.bodies.csv")
    for place, (node, directions) in enumerate(scene.free):
        answer.approach[place] = (answer.displacement[node][int(directions) - 1], estimate_of_approach(values, numbers[node]))
    read_zones(answer, values, folder / f"{name}.zones.csv")
    return answer


def errors_of_bodies(scene, numbers, path):
    """Uncertainty of the resultant on each body, according to the answer itself; 0 if it reports none."""
    said = {}
    try:
        for row in rows(path):
            said[int(row["first_node"])] = math.hypot(number(row["mesh_error_x"]) or 0.0, number(row["mesh_error_y"]) or 0.0)
    except OSError:
        pass
    return [max((said.get(numbers[k], 0.0) for k in body.at.values()), default=0.0) for body in scene.bodies]


def estimate_of_approach(values, node):
    found = [number(value) for key, value in values.items() if key.startswith(f"mesh_error_approach_{node}_")]
    return found[0] if found else None


def read_zones(answer, values, path):
    """Largest pressure of all zones, and the half-width of its zone, with their estimates."""
    try:
        zones = [row for row in rows(path) if number(row["max_pressure"])]
    except OSError:
        return
    if zones:
        first = max(zones, key=lambda row: float(row["max_pressure"]))
        k = first["zone"]
        answer.p_max = (float(first["max_pressure"]), number(values.get(f"mesh_error_pressure_zone_{k}")))
        answer.half_width = (number(first["half_width"]), number(values.get(f"mesh_error_half_width_zone_{k}")))


def solve(program, folder, jobs, seconds):
    """Results by name, for `(name, scene, twin)` run as one process, or one by one if that fails; the decks stay in the folder."""
    numbers = {}
    for name, scene, twin in jobs:
        text, numbers[name] = deck(scene, twin)
        (folder / f"{name}.dat").write_text(text)
    out = folder / "out"
    out.mkdir(exist_ok=True)
    broken, said = run(program, folder, [name for name, _, _ in jobs], seconds)
    answers = {}
    for name, scene, twin in jobs:
        if broken:
            end, said = run(program, folder, [name], seconds)
        answers[name] = read(scene, twin, numbers[name], out, name, said)
        if broken and end:
            answers[name] = Answer("broken", end)
    return answers


def run(program, folder, names, seconds):
    """Reason why the process failed (None if it did not), and its lines on standard error."""
    try:
        ended = subprocess.run([program, *(f"{name}.dat" for name in names), "-o", "out", "--tables", "all", "--quiet"], cwd=folder,
                               capture_output=True, text=True, timeout=seconds)
    except subprocess.TimeoutExpired:
        return f"no end within {seconds:.0f} s", []
    return (None if 0 <= ended.returncode < 5 else f"exit status {ended.returncode}"), ended.stderr.splitlines()


def off(one, other):
    """Largest difference of vectors, relative to the largest of them."""
    scale = max((abs(c) for v in one + other for c in v), default=0.0)
    return max((abs(a - b) for v, w in zip(one, other) for a, b in zip(v, w)), default=0.0) / scale if scale else 0.0


def same(one, other):
    """Fault of a rotated, mirrored, moved or renumbered twin; None if it agrees."""
    if one.word != other.word:
        return f"{one.word}, twin {other.word}"
    if not one.valid:
        return None
    u, r = off(one.displacement, other.displacement), off(one.reaction, other.reaction)
    total = abs(one.total - other.total) / max(one.total, other.total, 1e-300)
    if max(u, r, total) > SAME:
        return f"displacements off by {u:.1e}, reactions {r:.1e}, total force {total:.1e}"
    return None


def differences(one, other):
    """Values that differ, as (name, difference over scale, difference over tolerance)."""
    scale = max(one.total, other.total)
    found = []
    if not scale:
        return found
    for k, (a, b) in enumerate(zip(one.resultant, other.resultant)):
        part = math.hypot(a[0] - b[0], a[1] - b[1]) / scale
        found.append(("resultant", part, part / max(CLOSE, (one.resultant_error[k] + other.resultant_error[k]) / scale)))
    total = 0.0 if None in (one.total_error, other.total_error) else (one.total_error + other.total_error) / scale
    part = abs(one.total - other.total) / scale
    found.append(("total force", part, part / max(CLOSE, total)))
    for place in {} if FACETS in one.message + other.message else one.approach:
        (a, e), (b, f) = one.approach[place], other.approach[place]
        part = abs(a - b) / max(abs(a), abs(b), 1e-300)
        covered = 0.0 if e is None or f is None else (e + f) / max(abs(a), abs(b), 1e-300)
        found.append(("approach", part, part / max(CLOSE, covered)))
    return found


def estimates(one, other):
    """For p_max and half-width, if both give them with an estimate: does it cover their difference?"""
    for (a, e), (b, f) in ((one.p_max, other.p_max), (one.half_width, other.half_width)):
        if None not in (a, b, e, f):
            yield abs(a - b) <= max(e + f, CLOSE * abs(b))


def unlike(one, other):
    """Worst value that differs by more than allowed, as text; None if all agree."""
    name, part, beyond = max(differences(one, other), key=lambda each: each[2], default=("", 0.0, 0.0))
    return f"{name} off by {100 * part:.1f} %" if beyond > 1.0 else None


def warned(of, one, other):
    """Does one of two answers itself warn of their difference?"""
    said = one.message + other.message
    return NOTHING in said or TOLD in said or of == "exchanged" and LARGE in said


def outlines(scene, answer):
    """Points undeformed and displaced, and each body's outline as chords (a, b) between them: eight for an edge with a mid-side node, which bends."""
    drawn = [tuple(x) for x in scene.nodes]
    now = [(x[0] + u[0], x[1] + u[1]) for x, u in zip(scene.nodes, answer.displacement)]
    found = []
    for body in scene.bodies:
        found.append([])
        for a, middle, c in body.sides().values():
            run = [a, c]
            if middle is not None:
                run = [a, *range(len(drawn), len(drawn) + CHORDS - 1), c]
                for x in (drawn, now):
                    x += [on_parabola(x[a], x[middle], x[c], k / CHORDS) for k in range(1, CHORDS)]
            found[-1] += list(zip(run, run[1:]))
    return drawn, now, found


def on_parabola(a, middle, c, s):
    """Point of the parabola through three nodes at a fraction of its length."""
    return tuple((1 - s) * (1 - 2 * s) * p + 4 * s * (1 - s) * q - s * (1 - 2 * s) * r for p, q, r in zip(a, middle, c))


def sagitta(x, sides):
    """Largest height of a smooth curve over its chord, from the rotation at nodes if it is less than 35 degrees."""
    after, most = {a: b for a, b in sides}, 0.0
    for a, b in sides:
        c = after[b]
        p, q = (x[b][0] - x[a][0], x[b][1] - x[a][1]), (x[c][0] - x[b][0], x[c][1] - x[b][1])
        turn = abs(math.atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]))
        if turn < SMOOTH:
            most = max(most, turn * max(math.hypot(*p), math.hypot(*q)) / 8)
    return most


def depth(point, place, sides):
    """Depth of a point within an outline; 0 if outside."""
    turns, least = 0, math.inf
    for a, b in sides:
        (ax, ay), (bx, by) = place[a], place[b]
        if (ay > point[1]) != (by > point[1]) and point[0] < ax + (point[1] - ay) * (bx - ax) / (by - ay):
            turns += 1
        dx, dy = bx - ax, by - ay
        t = min(1.0, max(0.0, ((point[0] - ax) * dx + (point[1] - ay) * dy) / (dx * dx + dy * dy)))
        least = min(least, math.hypot(point[0] - ax - t * dx, point[1] - ay - t * dy))
    return least if turns % 2 else 0.0


def through(scene, answer):
    """Deepest penetration of two displaced bodies, beyond the effect of chords: (depth, depth over displacement, point)."""
    drawn, place, sides = outlines(scene, answer)
    moved = max((math.hypot(*u) for u in answer.displacement), default=0.0)
    worst = (0.0, 0.0, None)
    for k, own in enumerate(sides):
        for m, other in enumerate(sides):
            if k == m:
                continue
            allowed = 3 * max(sagitta(drawn, own), sagitta(drawn, other))
            xs, ys = [place[a][0] for a, _ in other], [place[a][1] for a, _ in other]
            box = (min(xs), max(xs), min(ys), max(ys))
            for a, b in own:
                for t in (0.0, 0.5):
                    p = tuple((1 - t) * place[a][c] + t * place[b][c] for c in range(2))
                    if box[0] < p[0] < box[1] and box[2] < p[1] < box[3]:
                        d = depth(p, place, other) - allowed
                        if d > worst[0]:
                            worst = (d, d / moved if moved else 0.0, p)
    return worst


def twins_of(scene, pick):
    """Equivalent forms of the same model that must give the same results, and forms that are another discretization."""
    angle = math.radians(pick.uniform(0.0, 360.0) if scene.turns() else 90.0 * pick.choice([1, 2, 3]))
    far = [scene.size * pick.choice([-1e3, 1e3]) for _ in range(2)]
    equal = [Twin("renumbered", mix=random.Random(pick.random())), Twin("reversed", reverse=True)]
    if scene.rings:
        equal += [Twin("moved", shift=(0.0, far[1]))]
    else:
        equal += [Twin("rotated", angle=angle), Twin("mirrored", mirror=True), Twin("moved", shift=far)]
    other = [Twin("exchanged", exchange=True), Twin("split", split=(pick.choice([0, 1]), pick.uniform(0.2, 0.8)))]
    return equal, other + [Twin("once", once=True)] * (scene.needed is not None)


@dataclass
class Fault:
    kind: str    # broken, twin, figure, through
    of: str      # name of the deck
    words: str


@dataclass
class Verdict:
    nodes: int
    answers: dict
    faults: list
    covered: list    # of p_max and half-width
    told: int        # answers whose own warnings cover a finding

    @property
    def base(self):
        return self.answers["base"]

    def counts(self):
        """Counts for the table."""
        kinds = {fault.kind: 1 for fault in self.faults}
        return {"scenes": 1, "valid": self.base.valid, "refused": not self.base.valid, "wrong": bool(kinds), **kinds,
                "told": self.told, "finer": not self.base.valid and self.answers["finer"].valid, "estimates": len(self.covered),
                "low": self.covered.count(False)}

    def said(self):
        words = "; ".join(f"{fault.of}: {fault.words}" for fault in self.faults)
        if not self.base.valid:
            words += f"{'; ' if words else ''}refused, {self.base.word}: {self.base.message[:200]}; finer {self.answers['finer'].word}"
        return f"{self.nodes} nodes; {words or 'nothing'}"


class Judge:
    def __init__(self, program, seed, seconds, friction=None):
        self.program, self.seed, self.seconds, self.friction = program, seed, seconds, friction

    def scenes(self, name, number):
        """The original model, and three times finer."""
        for again in range(1000):
            def drawn(n):
                return FAMILIES[name](random.Random(f"{self.seed} {name} {number} {again}"), n)

            if len(drawn(1).nodes) <= LARGEST:
                return drawn(1), drawn(3)
        raise ValueError(f"{name}: no model with at most {LARGEST} nodes")

    def __call__(self, name, number, folder):
        """Judge one model; its decks stay in the folder."""
        scene, finer = self.scenes(name, number)
        scene.friction = finer.friction = self.friction
        equal, other = twins_of(scene, random.Random(f"{self.seed} {name} {number} twins"))
        jobs = [("base", scene, Twin("base")), ("finer", finer, Twin("finer"))] + [(twin.name, scene, twin) for twin in equal + other]
        answers = solve(self.program, folder, jobs, self.seconds)
        base, fine = answers["base"], answers["finer"]
        faults = [Fault("broken", name, answer.message) for name, answer in answers.items() if answer.word == "broken"]
        faults += [Fault("twin", twin.name, words) for twin in equal for words in [same(base, answers[twin.name])] if words]
        told = 0
        for of in ["finer"] + [twin.name for twin in other]:
            words = base.valid and answers[of].valid and (unlike(base, answers[of]) or of == "once" and unlike_pressure(base, answers[of]))
            if words and warned(of, base, answers[of]):
                told += 1
            elif words:
                faults.append(Fault("figure", of, words))
        for of, one in (("base", scene), ("finer", finer)):
            if answers[of].valid:
                _, part, place = through(one, answers[of])
                if part > DEEP and TOLD in answers[of].message:
                    told += 1
                elif part > DEEP:
                    faults.append(Fault("through", of, f"penetration of {100 * part:.0f} % of the largest displacement at {place[0]:.3f} {place[1]:.3f}"))
        covered = list(estimates(base, fine)) if base.valid and fine.valid else []
        return Verdict(len(scene.nodes), answers, faults, covered, told)


def unlike_pressure(one, other):
    """p_max of the same model with its lines named once, and more than once."""
    (p, _), (q, _) = one.p_max, other.p_max
    return f"p_max {p:.4g}, once {q:.4g}" if p and q and abs(p - q) > CLOSE * max(p, q) else None
