"""Random small models, as a grammar of cards: most are valid, some have a fault or a choice too many."""
import math
import pathlib
import sys

from fuzzing.cards import Card, Deck

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "independent"))
from write_random import places  # noqa: E402


def number(value):
    """A real in the deck's form: with a decimal point, and all its digits."""
    text = f"{value:.12G}"
    if "." not in text and "E" not in text:
        return text + ".0"
    if "." not in text:
        return text.replace("E", ".0E")
    return text


class Scene:
    def __init__(self, pick):
        self.pick, self.deck = pick, Deck()
        self.rings = pick.random() < 0.25
        self.six = pick.random() < 0.3
        self.four = not self.rings and not self.six and pick.random() < 0.4
        self.plane = pick.choice(["STRAIN", "STRESS"])
        self.sequence = pick.random() < 0.3
        self.friction = pick.choice([0.0, 0.0, 0.0, 0.0, 0.1, 0.3, 0.3, 1.0, 2.5])
        self.nodes = self.elements = 0
        self.step = pick.choice([1, 1, 1, 7, 1000])
        self.first = pick.choice([0, 0, 0, 100, 90000000])

    def add(self, name, *data):
        self.deck.cards.append(Card(name, [number(d) if isinstance(d, float) else str(d) for d in data]))

    def node(self, x, y):
        self.nodes += 1
        name = self.first + self.step * self.nodes
        self.add("GRID", name, "", x, y, *self.pick.choice([[], [], [0.0]]))
        return name

    def block(self, xs, ys, section):
        """Nodes by (column, row) of a block; halves are mid-side nodes."""
        at = {}
        for j in range(len(ys)):
            for i in range(len(xs)):
                at[i, j] = self.node(xs[i], ys[j])

        def middle(p, q):
            key = ((p[0] + q[0]) / 2, (p[1] + q[1]) / 2)
            if key not in at:
                at[key] = self.node(*((v[p[c]] + v[q[c]]) / 2 for c, v in ((0, xs), (1, ys))))
            return at[key]

        for j in range(len(ys) - 1):
            for i in range(len(xs) - 1):
                a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
                for turn in [(a, b, c, d)] if self.four else [(a, b, c), (a, c, d)]:
                    turn = turn[::-1] if self.pick.random() < 0.3 else turn
                    self.elements += 1
                    ends = [at[p] for p in turn]
                    between = [middle(p, q) for p, q in zip(turn, turn[1:] + turn[:1])] if self.six else []
                    if self.rings and between:
                        ends, between = [n for two in zip(ends, between) for n in two], []
                    name = f"C{'TRAX' if self.rings else 'QUAD' if self.four else 'TRIA'}{len(ends + between)}"
                    self.add(name, self.elements, section, *ends, *between)
        return at

    def section(self, name):
        pick = self.pick
        young, nu = 10.0 ** pick.uniform(0, 6), pick.choice([0.0, 0.25, 0.3, 0.45, 0.4999])
        if self.rings:
            self.add("PSOLID", name, name)
        else:
            self.add("PSHELL", name, name, pick.choice([1.0, 0.1, 20.0]), *pick.choice([[], [], [-1] if self.plane == "STRAIN" or pick.random() < 0.1 else []]))
        self.add("MAT1", name, young, *pick.choice([("", nu), (young / 2 / (1 + nu), ""), ("", nu, 7.8e-9, 1.2e-5)]))
        if pick.random() < (0.7 if self.sequence else 0.4):
            hardening = pick.choice([1, 1, 2, 2, 3]) if self.sequence or pick.random() < 0.2 else 1
            stress = young * 10.0 ** pick.uniform(-4, -2)
            if pick.random() < 0.6:
                kind = "PLASTIC" if hardening > 1 and pick.random() < 0.95 else pick.choice(["PLASTIC", "NLELAST"])
                self.add("MATS1", name, "", kind, young * pick.choice([0.0, 0.001, 0.1, 1.0]), 1, hardening, stress)
            else:
                points = [0.0, 0.0, stress / young, stress]
                for _ in range(pick.randint(1, 4)):
                    points += [points[-2] + stress / young * pick.uniform(0.5, 5.0),
                               points[-1] + stress * pick.choice([0.0, 0.1, 0.4])]
                self.add("MATS1", name, name, "PLASTIC", "", 1, pick.choice([1] * 8 + [hardening]), stress)
                self.add("TABLES1", name, *[""] * 7, *points, "ENDT")
        return young


def small_scene(pick):
    """One to three stacked blocks, in contact by pairs, by lines, or not at all; pressed, pulled, pushed or moved."""
    scene = Scene(pick)
    if pick.random() < 0.3:
        scene.deck.head = ["SOL 101", "CEND", "TITLE = SMALL", "SPC = 1", "DISPLACEMENT = ALL", "STRESS = ALL", "BEGIN BULK"]
    if not scene.rings and pick.random() < 0.97:
        scene.add("PARAM", "PLANE", scene.plane)
    if pick.random() < 0.5:
        scene.add("PARAM", "GAPGEOM", "YES")
    for name, values in (("METHOD", ["AUTO", "SECANT", "MODSEC", "INISTR", "NEWTON"]), ("RULE", ["AUTO", "CONRY", "JOINED"]),
                         ("TOL", ["1.-3", "1.-6", "0.5"]), ("MAXIT", ["1", "5", "60"]), ("NLOAD", ["1", "2", "5"]),
                         ("MUP", ["EXACT", "PAPER"]), ("SOLVER", ["AUTO", "BAND", "FRONTAL"]), ("UNITS", ["N-MM"]),
                         ("ORIGINAL", ["NO", "YES"])):
        if pick.random() < (0.02 if scene.sequence and name in ("NLOAD", "MUP", "ORIGINAL", "METHOD") else 0.12):
            scene.add("PARAM", name, pick.choice(values))
    columns = pick.randint(1, 4)
    left = pick.choice([0.0, 1.0, 1.0, 1.0, 30.0]) if scene.rings else pick.choice([0.0, -1.0])
    size = 10.0 ** pick.choice([0, 0, 0, -3, 3])
    by_lines = pick.random() < 0.4
    young, y, below = 1.0, 0.0, None
    for body in range(1, pick.choice([1, 2, 2, 2, 3]) + 1):
        own = columns if not by_lines else pick.randint(1, 4)
        rows = pick.randint(1, 3)
        xs = places(pick, left * size, (left + 2.0) * size, own, 0.3)
        young = scene.section(body)
        at = scene.block(xs, places(pick, y, y + size, rows, 0.3), body)
        held = pick.choice(["12", "12", "12", "12", "123456", "2", "1"]) if body == 1 else "1"
        line = [at[i, 0] for i in range(own + 1)]
        loose = body > 1 and scene.friction and not scene.rings and pick.random() < 0.6   # sideways only friction holds it
        if body == 1 or not loose and pick.random() < 0.93:
            scene.add("SPC1", 1, held, *(line if body == 1 else [at[0, j] for j in range(rows + 1)]))
        if below:
            join(scene, below, line, body, by_lines)
            if pick.random() < 0.95:
                scene.add("SUPORT", at[0, rows], pick.choice(["12"] if loose else ["2"] * 12 + ["12", "1"]))
                if loose:
                    scene.add("SUPORT", at[own, 0], "2")
        below = [at[i, rows] for i in range(own + 1)]
        y += size * (1.0 + pick.choice([0.0, 0.0, 1e-4, -1e-4, 0.1]))
    load(scene, below, young * size * 10.0 ** pick.uniform(-5, -1))
    flow_theory(scene)
    return scene.deck


def join(scene, below, line, body, by_lines):
    pick = scene.pick
    if by_lines:
        scene.add("BLSEG", 2 * body, *(below if pick.random() < 0.5 else below[::-1]))
        scene.add("BLSEG", 2 * body + 1, *(line if pick.random() < 0.5 else line[::-1]))
        scene.add("BCONP", body, *pick.choice([(2 * body, 2 * body + 1), (2 * body + 1, 2 * body)]), *(["", "", 7] if scene.friction else []))
        if scene.friction and not scene.deck.of("BFRIC"):
            scene.add("BFRIC", 7, "", "", scene.friction)
        return
    scene.add("CORD2R", body, "", *[0.0] * 5, 1.0, 0.0, 1.0, 0.0)
    scene.add("PGAP", 900 + body, pick.choice([0.0, 0.0, 1e-4, -1e-4]), *(["", "", "", "", scene.friction] if scene.friction else []))
    for k, (a, b) in enumerate(zip(below, line)):
        if pick.random() < 0.95:
            scene.add("CGAP", 800000 + 100 * body + k, 900 + body, a, b, "", "", "", body)


def load(scene, top, total):
    pick = scene.pick
    kind = pick.choice(["force", "force", "pressure", "moved", "platen", "none"])
    if kind == "moved":
        scene.add("SPC", 1, top[0], "2", -total * 1e-5, *([top[-1], "2", -total * 1e-5] if len(top) > 1 else []))
    if kind == "platen" and len(top) > 1:
        scene.add("RBE2", 99999000, top[0], "2", *top[1:])
    if kind == "pressure":
        elements = [card for card in scene.deck.cards if card.name.startswith(("CT", "CQ"))]
        for a, b in zip(top, top[1:]):
            own = [card for card in elements if str(a) in card.data[2:] and str(b) in card.data[2:]]
            if own:
                scene.add("PLOADX1", 1, own[0].data[0], total, pick.choice(["", total / 2]), a, b,
                          pick.choice(["", 10.0, 90.0]))
    elif kind != "none":
        for node in top:
            angle = pick.choice([-90.0, -90.0, -80.0, 90.0, 0.0])
            scene.add("FORCE", 1, node, 0, total / len(top), *(round(turn(math.radians(angle)), 15) for turn in (math.cos, math.sin)))
    if pick.random() < 0.3:
        body_load(scene, total)
    if pick.random() < 0.3:
        ties(scene, top, total)


def flow_theory(scene):
    """PARAM HRFRAC and THEORY, NLPARM, and a sequence of load cases: parts of the loads, of both signs, and prescribed displacements."""
    pick, deck = scene.pick, scene.deck
    if any(card.data[5] == "3" for card in deck.of("MATS1")) != (pick.random() < 0.05):
        scene.add("PARAM", "HRFRAC", pick.choice([0.0, 0.3, 0.3, 0.5, 0.5, 1.0, 1.5]))
    if pick.random() < 0.05:
        scene.add("PARAM", "THEORY", pick.choice(["FLOW", "FLOW", "TOTAL"]))
    if not scene.sequence:
        return
    sets = [""] + [str(name) for name in range(11, 14)] * bool(deck.of("FORCE", "PLOADX1", "GRAV", "RFORCE", "MOMENT"))
    for name, part in zip(sets[1:], (1.0, pick.choice([0.001, 0.3, 0.5, 1.0]), pick.choice([-1.0, -0.1, 0.0, 2.0]))):
        scene.add("LOAD", name, 1.0, part, 1)
    moved = deck.of("SPC")
    if moved:
        sets.append("14")
        for card in moved:
            for k in range(1, len(card.data), 3):
                scene.add("SPCD", 14, *card.data[k:k + 2], pick.choice([-2.0, -0.5, 0.0, 1.0]) * float(card.data[k + 2] or 0.0))
    for name in 1, 2:
        scene.add("NLPARM", name, *pick.choice([(pick.randint(1, 6),), (pick.randint(1, 6), "", "", "", pick.choice([1, 3, 50]), "", "", pick.choice(["", 1e-3, 1e-6]))]))
    head = [*pick.choice([("SOL 106", "CEND"), ("SOL 106", "CEND"), ("SOL 101", "CEND", "CNTNLSUB = YES")]), "SPC = 1"]
    head += [line for line in deck.head if line.startswith("MPC")]
    for case in range(1, pick.randint(1, 4) + 1):
        chosen = pick.choice(sets if case > 1 else sets[1:] or sets)
        head += [f"SUBCASE {case}", *[f"LOAD = {chosen}"] * bool(chosen), f"NLPARM = {pick.choice('12')}", *["BCONTACT = NONE"] * (pick.random() < 0.05)]
    deck.head = [*head, "BEGIN BULK"]


def ties(scene, top, total):
    """Springs, equations, an RBE2 that may rotate: most are valid, some use DOFs that are fixed, dependent or of a SUPORT."""
    pick = scene.pick
    nodes = [card.data[0] for card in scene.deck.cards if card.name == "GRID"]
    named = {field for card in scene.deck.of("SPC1", "SPC", "SUPORT", "RBE2") for field in card.data[1:]}
    free = [node for node in nodes if node not in named] or nodes
    for k in range(pick.randint(0, 3)):
        ends = [pick.choice(nodes), pick.choice("1111112"), *pick.choice([(), ("", ""), (pick.choice(nodes), pick.choice("1111112"))])]
        if pick.random() < 0.5:
            scene.add("CELAS2", 99998000 + k, total * 10.0 ** pick.uniform(0, 4), *ends)
        else:
            scene.add("CELAS1", 99998000 + k, 99998100 + k, *ends)
            if pick.random() < 0.95:
                scene.add("PELAS", 99998100 + k, total * 10.0 ** pick.uniform(0, 4), *pick.choice([(), ("", "", 99998200 + k, 1.0)]))
    for k in range(pick.randint(0, 2)):
        digit, part = pick.choice("12"), pick.choice([0.0, 0.5, 1.5])
        a = pick.choice(free)
        b, c = pick.sample([node for node in nodes if node != a], 2)
        last = ("", "", c, digit, -part) if part or pick.random() < 0.5 else ()
        scene.add("MPC", pick.choice([5] * 9 + [6]), a, digit, 1.0, b, digit, part - 1.0 or 1.0, *last)
    if pick.random() < 0.2 and scene.deck.of("MPC"):
        scene.add("MPCADD", 7, *sorted({card.data[0] for card in scene.deck.of("MPC")}))
        scene.deck.head = [*(scene.deck.head or ["BEGIN BULK"])[:-1], "MPC = 7", "BEGIN BULK"]
    if len(top) > 1 and not scene.rings and not scene.deck.of("RBE2") and pick.random() < 0.5:
        scene.add("RBE2", 99999001, top[0], pick.choice(["12", "123456", "1"]), *top[1:])
        rotates = pick.choice(["MOMENT"] * 3 + ["SPC"] * 3 + ["SUPORT", "none"])
        if rotates == "MOMENT":
            scene.add("MOMENT", 1, top[0], 0, total, 0.0, 0.0, pick.choice([1.0, -1.0, 0.0]))
        elif rotates == "SPC":
            scene.add("SPC", 1, top[0], "6", pick.choice([0.0, total * 1e-6]))
        elif rotates == "SUPORT":
            scene.add("SUPORT", top[0], "6")


def body_load(scene, total):
    """Gravity or rotation, sometimes without mass."""
    pick = scene.pick
    for card in scene.deck.cards:
        if card.name == "MAT1" and pick.random() < 0.95:
            card.data += [""] * (4 - len(card.data)) + [pick.choice(["1.0", "1.0", "7.85-9", "0.0"])]
    if pick.random() < 0.2:
        scene.add("PARAM", "WTMASS", pick.choice(["1.0", "2.59-3", "0.0"]))
    nodes = [card.data[0] for card in scene.deck.cards if card.name == "GRID"]
    axis = (0.0, 1.0, 0.0) if scene.rings else (0.0, 0.0, 1.0)
    if pick.random() < 0.5:
        scene.add("GRAV", 1, "", total, *pick.choice([(0.0, -1.0), (0.0, -1.0), (0.6, -0.8), (0.0, 0.0)]), 0.0)
    else:
        scene.add("RFORCE", 1, pick.choice(["", pick.choice(nodes)]), "", math.sqrt(total), *pick.choice([axis, axis, (1.0, 0.0, 0.0)]),
                  pick.choice(["", 1, 2]), *pick.choice([(), (), (total,)]))
