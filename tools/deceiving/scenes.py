"""Models of bodies in contact along lines: meshed from patches, n times finer if asked, and written as decks.

All random values are drawn before the fineness n is used, so that the same draws give the same model on a finer mesh.
"""
import math

PLANE, RINGS = ("CTRIA3", "CQUAD4", "CTRIA6"), ("CTRAX3", "CTRAX6")
SIX = ("CTRIA6", "CTRAX6")


def written(value):
    """A field: a word, an integer, or a real with a decimal point and all its digits."""
    if isinstance(value, (int, str)):
        return str(value)
    text = repr(float(value))
    return text if "." in text else text.replace("e", ".e")


def card(*fields):
    """Lines of a free-field card."""
    name, *data = map(written, fields)
    return "\n".join([",".join([name] + data[:8])] + ["," + ",".join(data[k:k + 8]) for k in range(8, len(data), 8)])


class Body:
    """Nodes (numbers in the model) and elements of one type; patches share the nodes of their common sides."""

    def __init__(self, scene, kind, young, poisson):
        self.scene, self.kind, self.young, self.poisson = scene, kind, young, poisson
        self.at, self.elements = {}, []

    def node(self, x, y):
        key = (round(x / self.scene.size, 9), round(y / self.scene.size, 9))
        if key not in self.at:
            self.scene.nodes.append((x, y))
            self.at[key] = len(self.scene.nodes) - 1
        return self.at[key]

    def patch(self, place, across, up):
        """A mesh of the unit square, mapped by place(s, t)."""
        n = self.scene.n
        m, k = across * n, up * n
        six = self.kind in SIX

        def node(i, j):
            return self.node(*place(i / m, j / k))

        for i in range(m):
            for j in range(k):
                a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
                if self.kind == "CQUAD4":
                    parts = [(a, b, c, d)]
                elif (i + j) % 2 if self.scene.alternate else self.scene.falling:
                    parts = [(a, b, d), (b, c, d)]
                else:
                    parts = [(a, b, c), (a, c, d)]
                for part in parts:
                    between = [((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) for p, q in zip(part, part[1:] + part[:1])] if six else []
                    self.elements.append([node(*p) for p in part] + [node(*p) for p in between])
        return self

    def sides(self):
        """Edges of the boundary, body to the left: (start, mid-side node or None, end) by start."""
        found = {}
        for nodes in self.elements:
            corners, middles = (nodes[:3], nodes[3:]) if self.kind in SIX else (nodes, [None] * 4)
            area = sum(self.scene.cross(a, b) for a, b in zip(corners, corners[1:] + corners[:1]))
            for a, b, middle in zip(corners, corners[1:] + corners[:1], middles):
                a, b = (a, b) if area > 0 else (b, a)
                if (b, a) in found:
                    del found[b, a]
                else:
                    found[a, b] = middle
        return {a: (a, middle, b) for (a, b), middle in found.items()}

    def near(self, point, nodes=None):
        x = self.scene.nodes
        return min(nodes or self.at.values(), key=lambda k: (x[k][0] - point[0]) ** 2 + (x[k][1] - point[1]) ** 2)

    def line(self, start, end=None):
        """Nodes of the outline counter-clockwise from near one point to near another; the whole outline without a second point."""
        sides = self.sides()
        here = self.near(start, list(sides))
        last = here if end is None else self.near(end, list(sides))
        nodes = [here]
        while True:
            _, middle, here = sides[here]
            nodes += [here] if middle is None else [middle, here]
            if here == last:
                return nodes


class Scene:
    """Bodies, supports, loads and lines; fineness n."""

    def __init__(self, n, size, plane="STRAIN", alternate=False, falling=False):
        self.n, self.size, self.plane = n, size, plane
        self.alternate, self.falling = alternate, falling
        self.nodes, self.bodies = [], []
        self.supports, self.forces, self.platens, self.free = {}, [], [], []
        self.rotating = []            # (master node, dependent nodes, moment) of platens that rotate
        self.springs = []             # (node, direction, stiffness) to the ground
        self.equations = []           # terms (node, direction, coefficient) of one direction; the first is dependent
        self.gravity, self.spins = [], []   # accelerations; (node of the axis, rotations per unit of time)
        self.lines, self.contacts, self.parameters = {}, [], {}
        self.friction = None          # coefficient of all contacts
        self.needed = None            # contacts; later ones repeat these
        self.note = ""

    def cross(self, a, b):
        (ax, ay), (bx, by) = self.nodes[a], self.nodes[b]
        return ax * by - ay * bx

    def body(self, kind, young=1000.0, poisson=0.3):
        self.bodies.append(Body(self, kind, young, poisson))
        return self.bodies[-1]

    def corners(self, nodes):
        """Nodes of a line at corners of elements."""
        body = next(body for body in self.bodies if nodes[0] in body.at.values())
        return nodes[::2] if body.kind in SIX else nodes

    @property
    def rings(self):
        return self.bodies[0].kind in RINGS

    def hold(self, nodes, directions="12", value=(0.0, 0.0)):
        for node in nodes:
            for d in directions:
                self.supports.setdefault(node, {})[int(d)] = value[int(d) - 1]

    def platen(self, nodes, force, sideways=True):
        """Nodes with a common vertical displacement, unconstrained, under a force; fixed sideways."""
        leader = nodes[0]
        self.platens.append((leader, "2", nodes[1:]))
        self.free.append((leader, "2"))
        self.forces.append((leader, (0.0, -force)))
        if sideways:
            self.hold(nodes, "1")

    def contact(self, slave, master):
        """Add contact between two lines of nodes; equal ones are one line."""
        numbers = []
        for nodes in (slave, master):
            known = [k for k, line in self.lines.items() if line == nodes]
            numbers.append(known[0] if known else len(self.lines) + 1)
            self.lines[numbers[-1]] = nodes
        self.contacts.append(tuple(numbers))

    def turns(self):
        """May it be rotated by any angle? Only if supports fix both directions and there are no ties or platens."""
        return not (self.rings or self.platens or self.springs or self.equations) and all(len(held) == 2 for held in self.supports.values())


class Twin:
    """Another form of the same model."""

    def __init__(self, name, angle=0.0, mirror=False, shift=(0.0, 0.0), mix=None, exchange=False, split=None, reverse=False,
                 once=False):
        self.name, self.mirror, self.shift, self.mix = name, mirror, shift, mix
        self.exchange, self.split, self.reverse, self.once = exchange, split, reverse, once
        c, s = (round(math.cos(angle)), round(math.sin(angle))) if angle % (math.pi / 2) == 0 else (math.cos(angle), math.sin(angle))
        f = -1.0 if mirror else 1.0
        self.matrix = ((f * c, -s), (f * s, c))   # mirror x first, then rotate

    def vector(self, v):
        (a, b), (c, d) = self.matrix
        return (a * v[0] + b * v[1], c * v[0] + d * v[1])

    def back(self, v):
        (a, b), (c, d) = self.matrix
        return (a * v[0] + c * v[1], b * v[0] + d * v[1])

    def point(self, x):
        x = self.vector(x)
        return (x[0] + self.shift[0], x[1] + self.shift[1])

    def swaps(self):
        return abs(self.matrix[0][0]) < 0.5


def lines_of(scene, twin):
    """Lines and contacts of the twin: split at a node, exchanged, in the opposite direction."""
    contacts = scene.contacts[:scene.needed] if twin.once else list(scene.contacts)
    lines = {k: nodes for k, nodes in scene.lines.items() if any(k in each for each in contacts)}
    if twin.split is not None:
        which, part = twin.split
        number = contacts[0][which]
        nodes = lines[number]
        corners = scene.corners(nodes)
        if len(corners) > 2:
            k = nodes.index(corners[min(len(corners) - 2, max(1, round(part * (len(corners) - 1))))])
            new = max(lines) + 1
            lines[number], lines[new] = nodes[:k + 1], nodes[k:]
            contacts += [tuple(new if side == number else side for side in each) for each in contacts if number in each]
    if twin.exchange:
        contacts = [(master, slave) for slave, master in contacts]
    if twin.reverse:
        lines = {k: nodes[::-1] for k, nodes in lines.items()}
    return lines, contacts


def deck(scene, twin):
    """Text of the deck, and the number of each node."""
    numbers = list(range(1, len(scene.nodes) + 1))
    if twin.mix:
        numbers = [7 * k for k in twin.mix.sample(range(1, 3 * len(numbers)), len(numbers))]
    cards = [card("GRID", numbers[k], "", *twin.point(x), 0.0) for k, x in enumerate(scene.nodes)]
    if not scene.rings:
        cards.append(card("PARAM", "PLANE", scene.plane))
    for name, value in scene.parameters.items():
        cards.append(card("PARAM", name, value))
    element = 0
    for number, body in enumerate(scene.bodies, 1):
        cards.append(card("PSOLID", number, number) if scene.rings else card("PSHELL", number, number, 1.0))
        cards.append(card("MAT1", number, body.young, "", body.poisson, *[1.0] * bool(scene.gravity + scene.spins)))
        for nodes in body.elements:
            element += 1
            named = [numbers[k] for k in nodes]
            if twin.mix:
                corners = 4 if body.kind == "CQUAD4" else 3
                turn = twin.mix.randrange(corners)
                named = [part[(k + turn) % corners] for part in (named[:corners], named[corners:]) for k in range(len(part))]
            if body.kind == "CTRAX6":
                named = [k for two in zip(named[:3], named[3:]) for k in two]
            cards.append(card(body.kind, element, number, *named))
    cards += supports_of(scene, twin, numbers)
    lines, contacts = lines_of(scene, twin)
    ids = {k: k for k in lines}
    if twin.mix:
        ids = dict(zip(lines, twin.mix.sample(range(1, 99), len(lines))))
    cards += [card("BLSEG", ids[k], *(numbers[node] for node in nodes)) for k, nodes in lines.items()]
    order = list(range(1, len(contacts) + 1))
    if twin.mix:
        twin.mix.shuffle(order)
    rubs = ["", "", 1] if scene.friction else []
    cards += [card("BCONP", k, ids[slave], ids[master], *rubs) for k, (slave, master) in zip(order, contacts)]
    cards += [card("BFRIC", 1, "", "", scene.friction)] if rubs else []
    if twin.mix:
        twin.mix.shuffle(cards)
    head = [f"TITLE = {scene.note}"[:70].replace(",", " "), "SPC = 1"] + ["LOAD = 1"] * bool(scene.forces + scene.gravity + scene.spins)
    return "\n".join(head + ["BEGIN BULK"] + cards + ["ENDDATA", ""]), numbers


def supports_of(scene, twin, numbers):
    cards = []
    for node, held in scene.supports.items():
        if len(held) == 2:
            held = dict(zip((1, 2), twin.vector((held[1], held[2]))))
        else:
            (d, value), = held.items()
            value = twin.vector((value, 0.0) if d == 1 else (0.0, value))
            d = 3 - d if twin.swaps() else d
            held = {d: value[d - 1]}
        for d, value in held.items():
            cards.append(card("SPC", 1, numbers[node], d, value) if value else card("SPC1", 1, d, numbers[node]))
    turned = {"1": "2", "2": "1"} if twin.swaps() else {"1": "1", "2": "2"}
    for k, (leader, directions, nodes) in enumerate(scene.platens):
        cards.append(card("RBE2", 9000001 + k, numbers[leader], "".join(turned[d] for d in directions), *(numbers[m] for m in nodes)))
    flip = -1.0 if twin.mirror else 1.0
    for k, (master, nodes, moment) in enumerate(scene.rotating):
        cards.append(card("RBE2", 9100001 + k, numbers[master], "12", *(numbers[m] for m in nodes)))
        cards.append(card("MOMENT", 1, numbers[master], 0, flip * moment, 0.0, 0.0, 1.0))
    for k, (node, direction, stiffness) in enumerate(scene.springs):
        cards.append(card("CELAS2", 9200001 + k, stiffness, numbers[node], turned[direction]))
    for terms in scene.equations:
        fields = [field for k, (node, direction, a) in enumerate(terms) for field in ([""] * 2 if k and k % 2 == 0 else []) + [numbers[node], turned[direction], a]]
        cards.append(card("MPC", 1, *fields))
    cards += [card("SUPORT", numbers[node], "".join(sorted(turned[d] for d in directions))) for node, directions in scene.free]
    cards += [card("FORCE", 1, numbers[node], 0, 1.0, *twin.vector(force), 0.0) for node, force in scene.forces]
    cards += [card("GRAV", 1, "", 1.0, *twin.vector(pull), 0.0) for pull in scene.gravity]
    cards += [card("RFORCE", 1, numbers[node], "", turns, 0.0, 0.0, 1.0) for node, turns in scene.spins]
    return cards
