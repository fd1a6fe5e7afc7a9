#!/usr/bin/env python3
"""Write random models that yield: stacks of up to four blocks, tongues in sockets restrained by contact only, tubes and hollow balls
in one another, and blocks or axisymmetric bodies of any element in contact, node on node or line on line.

    . tools/venv && python tests/independent/write_random.py DIRECTORY [-n 40] [--seed 1]

`compare.py PROGRAM --random 300 --seed 1` writes them, runs both programs and compares.

Each block has its own material: elastic, bilinear, perfectly plastic, or a curve of five points; plane strain or plane stress; meshes with random
coordinates, gaps, loads, moments, prescribed displacements, temperatures, gravity and rotation; RBE2, MPC and springs (random_ties.py); one to
five load cases. They are not kept: the seed makes them again.
"""
import argparse
import math
import pathlib
import random

from random_ties import ties, turns

HEAT = 10.0   # temperatures, about zero: thermal strains up to the yield strain
HARDENING = "HR"   # replaced by the hardening of a MATS1


class Scene:
    def __init__(self, rng, strain, rings=False):
        self.rings, self.round, self.side = rings, False, {}
        self.chance = random.Random(repr(rng.getstate()[1][:4]))   # factor of temperatures alone
        self.heated = self.chance.random() < 0.5
        self.taken = set()                # DOFs that cannot be dependent (random_ties.py)
        self.pushed = False               # are there forces along the contact, set 4?
        self.rng, self.lines, self.nodes, self.elements, self.pairs, self.materials = rng, [], 0, 0, 0, 0
        self.spot, self.bodies = {}, []   # coordinates of the nodes, and the nodes of each body
        self.held, self.support = {}, []  # prescribed values by (node, digit), and SUPORT (node, digit)
        self.control = []                 # statements of case control
        self.lines += [] if rings else [f"PARAM,PLANE,{'STRAIN' if strain else 'STRESS'}"]
        self.lines += ["PARAM,GAPGEOM,YES", "CORD2R,1,,0.0,0.0,0.0,0.0,0.0,1.0,+", "+,0.0,1.0,0.0", "PGAP,900,0.0"]

    def add(self, *fields):
        self.lines.append(",".join(f"{f:.12G}" + ("" if "." in f"{f:.12G}" else ".0" if "E" not in f"{f:.12G}" else "")
                                   if isinstance(f, float) else str(f) for f in fields))

    def grid_point(self, x, y):
        """A node of the last body."""
        self.nodes += 1
        self.spot[self.nodes] = (x, y)
        self.bodies[-1].append(self.nodes)
        self.add("GRID", self.nodes, "", float(x), float(y))
        return self.nodes

    def hold(self, digits, *nodes, value=0.0):
        self.held.update({(node, digit): value for node in nodes for digit in digits})

    def suport(self, *pairs):
        self.support += pairs

    def material(self, scale=1.0):
        """A section of thickness 0.5 to 2 on a random material; returns its number."""
        self.materials += 1
        rng, number = self.rng, self.materials
        young, nu, stress = rng.uniform(0.5, 3.0) * 1e3, rng.uniform(0.0, 0.45), rng.uniform(0.7, 1.5) * scale
        if self.rings:
            self.add("PSOLID", number, number)
        else:
            self.add("PSHELL", number, number, rng.uniform(0.5, 2.0))
        self.add("MAT1", number, young, "", nu, rng.uniform(0.5, 2.0), *self.expansion())
        kind = rng.choice(3 * ["elastic", "bilinear", "curve", "curve"] + ["flat"])
        if kind in ("bilinear", "flat"):
            self.add("MATS1", number, "", "PLASTIC", young * rng.uniform(0.01, 0.3) if kind == "bilinear" else 0.0, 1, HARDENING, stress)
        elif kind == "curve":
            strain, points = stress / young, [(0.0, 0.0), (stress / young, stress)]
            for _ in range(3):
                step = strain * rng.uniform(0.5, 3.0)
                points.append((points[-1][0] + step, points[-1][1] + step * young * rng.uniform(0.0, 0.4)))
            self.add("MATS1", number, number, "PLASTIC", "", 1, 1, stress)
            numbers = [value for point in points for value in point]
            self.add("TABLES1", number, *[""] * 6)
            for i in range(0, 10, 8):
                self.add("", *numbers[i:i + 8], *(["ENDT"] if i == 8 else []))
        return number

    def expansion(self):
        """A and TREF, if the model has temperatures."""
        return (self.chance.uniform(0.0, 2e-5), self.chance.uniform(-HEAT, HEAT)) if self.heated else ()

    def warm(self):
        """Temperatures of all nodes, some by TEMPD."""
        for node in range(1, self.nodes + 1):
            if self.chance.random() < 0.8:
                self.add("TEMP", 7, node, self.chance.uniform(-HEAT, HEAT))
        self.add("TEMPD", 7, self.chance.uniform(-HEAT, HEAT))

    def grid(self, xs, ys, section, keep=lambda x, y: True):
        """Nodes by (column, row)."""
        self.bodies.append([])
        at = {}
        cells = [(i, j) for i in range(len(xs) - 1) for j in range(len(ys) - 1)
                 if keep((xs[i] + xs[i + 1]) / 2, (ys[j] + ys[j + 1]) / 2)]
        for i, j in sorted({(i + a, j + b) for i, j in cells for a in (0, 1) for b in (0, 1)}):
            at[i, j] = self.grid_point(xs[i], ys[j])
        for i, j in cells:
            a, b, c, d = at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]
            for corners in ((a, b, c), (a, c, d)) if self.rng.random() < 0.5 else ((a, b, d), (b, c, d)):
                self.elements += 1
                self.add("CTRIA3", self.elements, section, *corners)
        return at

    def mesh(self, xs, ys, section, corners, middles, place):
        """Elements of 3 or 4 corners, with or without mid-side nodes, in either direction, the inner nodes out of line. Nodes by
        (column, row), with mid-side nodes at halves; `place` moves the whole."""
        at, spot, rng = {}, {}, self.rng
        self.bodies.append([])

        def node(i, j, ends=()):
            if (i, j) not in at:
                inside = 0 < i < len(xs) - 1 and 0 < j < len(ys) - 1
                reach = (0.03 if ends else 0.15) * inside
                middle = [sum(spot[end][c] for end in ends) / 2 for c in (0, 1)] if ends else (xs[i], ys[j])
                spot[i, j] = tuple(middle[c] + rng.uniform(-reach, reach) * (v[1] - v[0]) for c, v in ((0, xs), (1, ys)))
                at[i, j] = self.grid_point(*place(*spot[i, j]))
            return at[i, j]

        for i in range(len(xs) - 1):
            for j in range(len(ys) - 1):
                a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
                halves = rng.choice([[(a, b, c), (a, c, d)], [(a, b, d), (b, c, d)]])
                for turn in [(a, b, c, d)] if corners == 4 else halves:
                    turn = turn[::-1] if rng.random() < 0.5 else turn
                    self.elements += 1
                    ends = [node(*p) for p in turn]
                    round_it = list(zip(turn, turn[1:] + turn[:1]))
                    between = [node((p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p, q)) for p, q in round_it] if middles else []
                    if self.rings and middles:
                        ends, between = [n for two in zip(ends, between) for n in two], []
                    name = f"C{'TRAX' if self.rings else 'QUAD' if corners == 4 else 'TRIA'}{len(ends + between)}"
                    self.add_long(name, self.elements, section, *ends, *between)
                    for p, q in round_it:
                        self.side[at[p], at[q]] = self.side[at[q], at[p]] = self.elements
        return at

    def segments(self, number, nodes):
        """A line, from either end."""
        self.add_long("BLSEG", number, *(nodes if self.rng.random() < 0.5 else nodes[::-1]))

    def add_long(self, name, *fields):
        for i in range(0, len(fields), 8):
            self.add(name if i == 0 else "", *fields[i:i + 8])

    def pair(self, a, b):
        self.pairs += 1
        self.add("CGAP", 100000 + self.pairs, 900, a, b, "", "", "", 1)

    def supports(self, number, held):
        """A set of SPC1, and of SPC for values other than zero."""
        for digit in "126":
            nodes = [node for (node, own), value in held.items() if own == digit and not value]
            if nodes:
                self.add_long("SPC1", number, digit, *nodes)
        for (node, digit), value in held.items():
            if value:
                self.add("SPC", number, node, digit, float(f"{value:.3e}"))   # pyNastran writes SPC in small fields only

    def cases(self, chance):
        """Several load cases in most models, in any order of their numbers: sets of loads times factors, one with prescribed
        displacements; other supports, which also fix the SUPORT DOFs, with contact or without. Returns the case control."""
        self.supports(1, self.held)
        for k in range(0, len(self.support), 4):
            self.add("SUPORT", *[field for pair in self.support[k:k + 4] for field in pair])
        if chance.random() < 0.3:
            return ["LOAD = 1"]
        self.supports(2, {**self.held, **dict.fromkeys(self.support, 0.0)})
        forces = [line.replace("FORCE,1,", "FORCE,2,") for line in self.lines if line.startswith("FORCE,1,")]
        self.lines += forces
        for digit in ("2", "6"):
            for node in [node for node, own in self.held if own == digit][:1]:
                self.add("SPCD", 3, node, digit, chance.uniform(-1e-4, 1e-4))
        statements = []
        for number in chance.sample(range(1, 100), chance.randint(2, 5)):
            self.add("LOAD", 1000 + number, chance.choice([1.0, 0.5]), chance.uniform(0.1, 1.2), 1,
                     *chance.choice([(), (chance.uniform(-0.5, 0.5), 2 if forces else 1), (chance.uniform(0.5, 1.0), 3)]))
            statements += [f"SUBCASE {number}", f"LOAD = {1000 + number}", f"SPC = {chance.choice([1, 1, 2]) if statements else 1}"]
            statements += ["BCONTACT = NONE"] * (statements[-1] == "SPC = 2" and chance.random() < 0.5)
        return statements

    def history(self, chance):
        """A sequence of two to four SUBCASEs in one to four increments: loads up, down, and in other directions; prescribed
        displacements and temperatures in some. Hardening is isotropic, kinematic or mixed. Returns the case control."""
        self.supports(1, self.held)
        for k in range(0, len(self.support), 4):
            self.add("SUPORT", *[field for pair in self.support[k:k + 4] for field in pair])
        for k, line in enumerate(self.lines):
            if line.startswith("MATS1"):   # NLELAST has no HR
                self.lines[k] = line.replace("PLASTIC", "NLELAST") if chance.random() < 0.1 else line.replace(f",{HARDENING},", f",{chance.randint(1, 3)},")
        forces = [line.replace("FORCE,1,", "FORCE,2,") for line in self.lines if line.startswith("FORCE,1,")]
        self.lines += forces
        for digit in ("2", "6"):
            for node in [node for node, own in self.held if own == digit][:1]:
                self.add("SPCD", 3, node, digit, chance.uniform(-1e-4, 1e-4))
        if any(line.startswith("MATS1") for line in self.lines):
            self.add("PARAM", "HRFRAC", chance.uniform(0.1, 1.0))
            self.add("PARAM", "THEORY", "FLOW")
        statements = [chance.choice(["SOL 106", "CNTNLSUB = YES"])]
        for k, number in enumerate(chance.sample(range(1, 100), chance.randint(2, 4))):
            factor = chance.uniform(*chance.choice([(0.05, 0.7), (0.3, 1.0), (0.9, 1.2)] if k % 2 else [(0.3, 1.0), (0.7, 1.2), (0.9, 1.2)]))
            self.add("LOAD", 1000 + number, 1.0, factor, 1, *chance.choice([(), (chance.uniform(-1.0, 1.0) * factor, 2 if forces else 1),
                                                                            (chance.uniform(-1.0, 1.0), 3)]),
                     *((chance.uniform(-1.0, 1.0), 4) if self.pushed else ()))
            self.add("NLPARM", number, chance.randint(1, 4))
            statements += [f"SUBCASE {number}", f"LOAD = {1000 + number}", f"NLPARM = {number}"]
            statements += ["TEMPERATURE(LOAD) = 7"] * (self.heated and chance.random() < 0.6)
        return statements

    def text(self, history=False):
        if self.heated:
            self.warm()
        chance = random.Random(self.chance.random())
        heat = ["TEMPERATURE(LOAD) = 7"] * (self.heated and not history)
        cases = self.history(chance) if history else self.cases(chance)
        lines = [line.replace(f",{HARDENING},", ",1,") for line in self.lines]
        return "\n".join(heat + self.control + cases + ["BEGIN BULK"] + lines + ["ENDDATA", ""])


def places(rng, low, high, parts, uneven=0.4):
    steps = [rng.uniform(1.0 - uneven, 1.0 + uneven) for _ in range(parts)]
    found = [low]
    for step in steps:
        found.append(found[-1] + (high - low) * step / sum(steps))
    found[-1] = high
    return found


def stack(rng):
    """Stacked blocks; the lowest stands on fixed nodes."""
    scene = Scene(rng, rng.random() < 0.6)
    columns = rng.randint(3, 7)
    xs = places(rng, 0.0, 3.0, columns)
    below, y = None, 0.0
    for k in range(rng.randint(1, 3) + 1):
        height = rng.uniform(0.5, 1.5)
        rows = rng.randint(2, 4)
        at = scene.grid(xs, places(rng, y, y + height, rows), scene.material())
        scene.hold("1", *[at[0, j] for j in range(rows + 1)])
        if below is None:
            scene.hold("2", *[at[i, 0] for i in range(columns + 1)])
        else:
            for i in range(columns + 1):
                scene.pair(below[i], at[i, 0])
            scene.suport((at[rng.randint(0, columns), rows], "2"))
        below = [at[i, rows] for i in range(columns + 1)]
        y += height + rng.choice([0.0, 0.0, 0.0002, 0.001])
    scene.top, total = below, rng.uniform(0.6, 2.2)
    for i in range(columns + 1):
        scene.add("FORCE", 1, below[i], 0, total * 3.0 / (columns + 1) * rng.uniform(0.2, 1.8), rng.uniform(-0.05, 0.2), -1.0)
    return scene


def tongue(rng):
    """A slender block in a slot with clearance, its rotation and vertical displacement restrained by the pairs only."""
    scene = Scene(rng, rng.random() < 0.6)
    clearance = rng.choice([0.0, 0.0005, 0.002])
    columns = rng.randint(5, 9)
    inside, outside = places(rng, 0.0, 3.0, columns), places(rng, 3.0, 6.0, 4)[1:]
    slot = rng.randint(2, 3)
    at = scene.grid(inside + outside, places(rng, -0.5, 0.5, slot), scene.material())
    half = 0.5 + clearance
    rows = places(rng, -half - 1.0, -half, 2) + places(rng, half, half + 1.0, 2)
    socket = scene.grid([-1.5, -0.7] + inside, rows, scene.material(), lambda x, y: x < -0.7 or abs(y) > half)
    scene.hold("12", *[socket[0, j] for j in range(6)])
    for i in range(columns + 1):
        scene.pair(socket[i + 2, 2], at[i, 0])
        scene.pair(at[i, slot], socket[i + 2, 3])
    last = columns + len(outside)
    scene.hold("1", at[columns, 1])
    scene.suport((at[0, 0], "2"), (at[last, 0], "2"))
    scene.top, scene.straight = [at[last, j] for j in range(slot + 1)], [at[i, 0] for i in range(columns + 1)]
    scene.add("FORCE", 1, at[last, 0], 0, rng.uniform(0.03, 0.12), rng.uniform(-0.3, 0.3), rng.choice([-1.0, 1.0]))
    return scene


def body_loads(rng, scene):
    """Gravity or rotation or both, so that each is a part of the loads; if axisymmetric along y, and about it."""
    kinds = rng.choice([(), (), ("GRAV",), ("RFORCE",), ("GRAV", "RFORCE"), ("RFORCE", "RFORCE")])
    if kinds and rng.random() < 0.3:
        scene.add("PARAM", "WTMASS", rng.uniform(0.5, 2.0))
    for kind in kinds:
        if kind == "GRAV":
            scene.add("GRAV", 1, "", rng.uniform(0.02, 0.1), 0.0 if scene.rings else rng.uniform(-0.3, 0.3), -1.0)
        elif scene.rings:
            scene.add("RFORCE", 1, "", "", rng.uniform(0.01, 0.03), 0.0, 1.0)
        else:
            growth = rng.choice([(), (1, rng.uniform(-0.003, 0.003))])
            scene.add_long("RFORCE", 1, rng.choice(["", rng.randint(1, scene.nodes)]), "", rng.uniform(0.01, 0.04), 0.0, 0.0,
                           rng.choice([1.0, -1.0]), *growth)


def row(at, j, middles):
    """Columns of the nodes of a row of a mesh."""
    return [at[i, k] for i, k in sorted(at) if k == j and (middles or i == int(i))]


def element(rng, rings):
    """Corners, and whether there are mid-side nodes."""
    return rng.choice([(3, False), (3, True)] if rings else [(3, False), (3, True), (4, False), (4, True)])


def pressed(rng):
    """One body on another, of random elements: node on node, or a bent line on a line of other columns."""
    rings, by_lines = rng.random() < 1 / 3, rng.random() < 0.5
    scene = Scene(rng, rng.random() < 0.5, rings)
    kinds = [element(rng, rings) for _ in range(2)]
    left = rng.choice([0.0, 1.0]) if rings else 0.0
    columns = rng.randint(4, 8)
    xs = places(rng, left, left + 3.0, columns)
    bend, dent = (rng.uniform(0.0, 0.02), rng.uniform(-0.005, 0.02)) if by_lines else (0.0, 0.0)
    gap = rng.choice([0.0, 0.0, 0.0005, -0.0005 if by_lines else 0.0])
    rows, upper_rows = rng.randint(2, 4), rng.randint(2, 4)
    low = scene.mesh(xs, places(rng, -1.2, 0.0, rows), scene.material(), *kinds[0],
                     lambda x, y: (x, y + (y + 1.2) / 1.2 * dent * (x - left) ** 2))
    if by_lines:
        columns = rng.randint(4, 8)
        xs = places(rng, left, left + rng.uniform(1.5, 2.9), columns)
    high = scene.mesh(xs, places(rng, 0.0, 1.0, upper_rows), scene.material(), *kinds[1],
                      lambda x, y: (x, y + gap + (1.0 - y) * (bend + dent) * (x - left) ** 2))
    scene.hold("2", *row(low, 0, True))
    if rng.random() < 0.3:
        scene.hold("2", row(low, 0, False)[-1], value=rng.uniform(-5e-4, 5e-4))
    if left == 0.0:
        scene.hold("1", *[n for at in (low, high) for (i, _), n in at.items() if i == 0])
    scene.suport((high[0, upper_rows], "2"))
    scene.top = row(high, upper_rows, True)
    face, under, full = row(low, rows, kinds[0][1]), row(high, 0, kinds[1][1]), rng.random() < 0.5
    if by_lines:
        scene.segments(1, face if full else row(low, rows, False))
        scene.segments(2, under if full else row(high, 0, False))
        scene.add("BCONP", 1, *rng.choice([(1, 2), (2, 1)]), "", 1.0, "", 1, 0)
    else:
        for a, b in zip(face, under) if len(face) == len(under) else zip(row(low, rows, False), row(high, 0, False)):
            scene.pair(a, b)
    total = rng.uniform(0.4, 1.6)
    for a, b in zip(row(high, upper_rows, False), row(high, upper_rows, False)[1:]):
        p, q, turn = total * rng.uniform(0.2, 1.8), total * rng.uniform(0.2, 1.8), rng.choice(["", rng.uniform(-5.0, 5.0)])
        scene.add("PLOADX1", 1, scene.side[a, b], p, q, *rng.choice([(a, b), (b, a)]), turn)
    scene.add("FORCE", 1, high[columns, upper_rows], 0, 0.05, rng.uniform(-1.0, 1.0), -1.0)
    return scene


def nested(rng):
    """A quarter of one tube in another, or of one hollow ball in another, of random elements and columns, line on line; the fit is
    tight or loose, and the pressure inside varies."""
    rings = rng.random() < 0.5
    scene = Scene(rng, rng.random() < 0.5, rings)
    fit = rng.choice([0.0, 0.0005, 0.001, -0.0003])

    def on_arc(angle, radius):
        return (radius * math.sin(angle), 0.0 if angle == math.pi / 2 else radius * math.cos(angle))

    scene.round = True
    bodies, faces = [], []
    for low, high in ((0.7, 1.0), (1.0 - fit, 1.4)):
        corners, middles = element(rng, rings)
        rows, columns = rng.randint(2, 3), rng.randint(4, 9)
        around, across = places(rng, 0.0, math.pi / 2, columns), places(rng, low, high, rows)
        at = scene.mesh(around, across, scene.material(2.0), corners, middles, on_arc)
        scene.hold("1", *[n for (i, _), n in at.items() if i == 0])
        scene.hold("2", *[n for (i, _), n in at.items() if i == columns])
        bodies.append(at)
        faces.append(row(at, 0 if bodies[1:] else rows, middles))
    for number, face in enumerate(faces, 1):
        part = face[:-2] if rng.random() < 0.2 else face
        scene.segments(number, part)
    scene.add("BCONP", 1, *rng.choice([(1, 2), (2, 1)]), "", 1.0, "", 1, 0)
    inside, total = row(bodies[0], 0, False), rng.uniform(0.1, 0.3)
    scene.top = row(bodies[1], max(int(j) for _, j in bodies[1]), True)[1:4]
    for a, b in zip(inside, inside[1:]):
        scene.add("PLOADX1", 1, scene.side[a, b], total * rng.uniform(0.5, 1.5), total * rng.uniform(0.5, 1.5), a, b)
    return scene


def rub(rng, scene):
    """Friction, forces along the contact (set 4), and in some models a body that only friction, or a spring, restrains along x. Half of the models are
    elastic."""
    mu = rng.uniform(0.05, 1.0)
    scene.lines = [line.replace("PGAP,900,0.0", f"PGAP,900,0.0,,,,,{mu:.6f}") for line in scene.lines]
    if any(line.startswith("BCONP") for line in scene.lines):
        scene.lines = [line.replace(",1.0,,1,0", ",1.0,7,1,0") if line.startswith("BCONP") else line for line in scene.lines]
        scene.add("BFRIC", 7, "", "", mu)
    if rng.random() < 0.3:   # others have another coefficient, or none
        scene.add("PGAP", 901, 0.0, *[""] * 4, rng.choice([0.0, rng.uniform(0.05, 1.0)]))
        scene.lines = [line.replace(",900,", ",901,") if line.startswith("CGAP") and rng.random() < 0.5 else line for line in scene.lines]
    if rng.random() < 0.5:
        table = [k for k, line in enumerate(scene.lines) if line.startswith("TABLES1")]
        scene.lines = [line for k, line in enumerate(scene.lines) if not line.startswith("MATS1") and not {k, k - 1, k - 2} & {*table}]
    pressed = 1.5 * any(line.startswith("PLOADX1") for line in scene.lines) + sum(float(line.split(",")[4]) for line in scene.lines if line.startswith("FORCE,1,"))
    for node in scene.top:
        scene.add("FORCE", 4, node, 0, mu * pressed / len(scene.top) * rng.uniform(0.3, 1.5), 1.0, 0.0)
    scene.pushed = True
    body = scene.bodies[0 if turns(scene) else -1]
    held = [node for node in body if (node, "1") in scene.held]
    free = [node for node in scene.top if (node, "2") not in scene.taken]
    tied = any(line.startswith(("RBE2", "MPC", "CELAS")) for line in scene.lines)
    if scene.rings or scene.round or tied or not held or not free or rng.random() < 0.3:
        return
    for node in held:
        del scene.held[node, "1"]
    if rng.random() < 0.5:
        scene.add("CELAS2", 7900, 10.0 ** rng.uniform(0.0, 3.0), "", "", held[-1], 1)
    else:
        scene.suport((held[-1], "1"))
    if not turns(scene):
        known = next(scene.spot[node][0] for node, digit in scene.support if digit == "2" and node in body)
        scene.suport((max(free, key=lambda node: abs(scene.spot[node][0] - known)), "2"))


def write(directory, number, seed, histories=False, friction=False):
    """Returns the paths. `histories`: sequences of SUBCASEs with flow theory; `friction`: the same with friction, half of them elastic."""
    directory.mkdir(parents=True, exist_ok=True)
    paths = [directory / f"model{k:03}.dat" for k in range(number)]
    for k, path in enumerate(paths):
        rng = random.Random(f"{seed} {k}")
        scene = (pressed if k % 2 else [stack, nested, tongue][k // 2 % 3])(rng)
        body_loads(rng, scene)
        if not friction or rng.random() < 0.5:
            ties(rng, scene)
        if friction:
            rub(rng, scene)
        path.write_text(scene.text(histories or friction), encoding="ascii")
    return paths


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("-n", "--number", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--histories", action="store_true", help="sequences of SUBCASEs with flow theory")
    parser.add_argument("--friction", action="store_true")
    options = parser.parse_args()
    write(options.directory, options.number, options.seed, options.histories, options.friction)


if __name__ == "__main__":
    main()
