"""The content of a deck as dictionaries by id, without using the program."""
import math

from body import body_forces
from boundary import boundary, edge_forces
from deck import DeckError, at, real
from kinds import KINDS
from lines import pairs_of_lines
from ties import resolved, rigid_ties, sums


#: Error of stresses after all increments of flow theory, over the tolerance of the iteration.
DRIFT = 10.0


class Section:
    """thickness: None if axisymmetric. points: of the uniaxial curve, or None. expansion: A and TREF."""

    def __init__(self, thickness, material, plane_stress, points, expansion, density):
        self.thickness, (self.young, self.nu), self.plane_stress, self.points = thickness, material, plane_stress, points
        self.expansion, self.density = expansion, density


class Pair:
    """Gap = initial + sum of weight * displacement . normal over its nodes. `node`: a node of its boundary edge; `ends`: the nodes
    in its name; `stands_on`: for a node of the master, the nodes of the opposite slave edge."""

    def __init__(self, initial, normal, weights, node, ends, stands_on=()):
        self.initial, self.normal, self.weights, self.node, self.ends, self.stands_on = initial, normal, weights, node, ends, stands_on
        self.tangent = normal[1], -normal[0]


class Scene:
    """`told`: normals of the program's pairs, by name: they identify the pairs of a node that has several, and pairs found late."""

    def __init__(self, deck, told=None):
        self.deck = deck
        self.x = {int(c[1]): (real(at(c, 3)), real(at(c, 4))) for c in deck.of("GRID")}
        self.parameter = parameter = {c[1]: c[2] for c in deck.of("PARAM")}
        self.paper = parameter.get("MUP") == "PAPER" or parameter.get("ORIGINAL") == "YES"
        newton = parameter.get("METHOD", "AUTO") in ("NEWTON", "AUTO") and not self.paper or deck.is_flow
        wanted = real(parameter.get("ACCURACY", ""), 0.0) * (0.1 if newton else 0.002)
        asked = deck.increments()[1] or real(parameter.get("TOL", ""))
        self.off_curve = (asked or wanted or (1e-8 if newton else 0.01)) * (1 if newton else 10)
        self.off_curve *= bool(deck.of("MATS1"))
        # Flow theory: the last increment (history.py), and the relative difference of stresses by iteration errors of all.
        self.end, self.drift = None, DRIFT * self.off_curve if deck.is_flow else 0.0
        self.sections()
        self.element = {}
        for name, kind in KINDS.items():
            for c in deck.of(name):
                self.element[int(c[1])] = (name, [int(g) for g in c[3:3 + len(kind.nodes)]], self.section[int(c[2] or c[1])])
        self.side = boundary([(KINDS[name], nodes, section.thickness) for name, nodes, section in self.element.values()], self.x)
        self.supports()
        self.pairs(told)
        self.loads()
        self.has_rings = any(section.thickness is None for section in self.section.values())

    def sections(self):
        material = self.deck.moduli()
        curve, expansion, density = self.deck.curves(material), self.deck.expansions(), self.deck.densities()
        self.temperature = self.deck.temperatures()
        self.section = {}
        for c in self.deck.of("PSHELL"):
            strain = at(c, 4) == "-1" or self.parameter.get("PLANE") == "STRAIN"
            self.section[int(c[1])] = Section(real(c[3]), material[int(c[2])], not strain, curve.get(int(c[2])), expansion[int(c[2])],
                                               density[int(c[1])])
        for c in self.deck.of("PSOLID"):
            self.section[int(c[1])] = Section(None, material[int(c[2])], False, curve.get(int(c[2])), expansion[int(c[2])], density[int(c[1])])

    def deviations(self):
        """Temperature changes from TREF, in elements that expand."""
        if self.temperature is None:
            return []
        expanding = [(nodes, section.expansion[1]) for _, nodes, section in self.element.values() if section.expansion[0]]
        return [self.temperature(node) - none_at for nodes, none_at in expanding for node in nodes]

    def supports(self):
        """Fixed DOFs with their displacements, and the dependent DOFs: master DOFs (`leader`, not those of rotating RBE2), sums, springs."""
        self.rotating = self.deck.rotating()
        named = [(node, {"1": 0, "2": 1, "6": 2}[digit], value) for node, digits, value in self.deck.held() for digit in set(digits) & set("126")]
        self.given = {(node, c): value for node, c, value in named if c < 2 or node in self.rotating}
        self.held = set(self.given)
        self.leader = rigid_ties(self.deck, self.rotating)
        self.sums = sums(self.deck, self.x.get, self.rotating)
        self.terms = resolved(self.leader, self.sums)
        self.springs, self.moment = list(self.deck.springs()), self.deck.moments()

    def pairs(self, told):
        frame = self.deck.frames()
        given = {int(c[1]): real(at(c, 2)) for c in self.deck.of("PGAP")}
        within = {node for _, nodes, _ in self.element.values() for node in nodes}
        self.pair, self.contacts = {}, []
        for c in self.deck.of("CGAP"):
            a, b = int(c[3]), int(c[4])
            along = (self.x[b][0] - self.x[a][0], self.x[b][1] - self.x[a][1])
            n = frame[int(c[8])] if at(c, 8) else tuple(v / math.hypot(*along) for v in along)
            gap = given[int(c[2] or c[1])]
            if self.parameter.get("GAPGEOM") == "YES":
                gap += along[0] * n[0] + along[1] * n[1]
            self.pair[int(c[1])] = Pair(gap, n, {a: -1.0, b: 1.0}, b if b in within else a, (a, b))
        self.contacts.append(list(self.pair))
        everywhere = {(node, c) for node in self.x for c in (0, 1) if self.leads(node, c) in self.held}
        names = None if told is None else [node_of(pair) for pair in told if pair not in self.pair]
        for contact in pairs_of_lines(self.deck, self.parameter, self.side, self.x, everywhere, self.motion, told=names):
            named = [(self.name(pair, told or {}), pair) for pair in contact]
            self.contacts.append([name for name, _ in named])
        rank = {name: k for k, name in enumerate(told or {})}
        self.pair = {name: self.pair[name] for name in sorted(self.pair, key=lambda name: rank.get(name, len(rank)))}
        for contact in self.contacts:
            contact.sort(key=lambda name: rank.get(name, len(rank)))

    def bodies(self):
        """The body of each node, named by one of its nodes: elements and ties join nodes to bodies."""
        above = {node: node for node in self.x}

        def top(node):
            while above[node] != node:
                above[node] = above[above[node]]
                node = above[node]
            return node

        joined = [nodes for _, nodes, _ in self.element.values()]
        joined += [(node, *(master for master, _ in terms)) for (node, _), terms in self.terms.items()]
        joined += [[end[0] for end in ends if end] for *_, ends in self.springs]
        for nodes in joined:
            for node in nodes[1:]:
                above[top(node)] = top(nodes[0])
        return {node: top(node) for node in self.x}

    def leads(self, *freedom):
        """The master DOF of a DOF; itself if it is not dependent."""
        while self.leader.get(freedom, freedom) != freedom:
            freedom = self.leader[freedom]
        return freedom

    def motion(self, node, c):
        """The DOF that moves a node along a direction, or its fixed displacement."""
        lead = self.leads(node, c)
        return self.given.get(lead, lead)

    def name(self, pair, told):
        """The node; if it has several pairs (node, number), chosen by their given normals."""
        free = [name for name in told if node_of(name) == pair.node and name not in self.pair]
        name = max(free, key=lambda name: sum(a * b for a, b in zip(told[name], pair.normal)), default=pair.node)
        while name in self.pair:
            name = (pair.node, 2 if name == pair.node else name[1] + 1)
        self.pair[name] = Pair(pair.gap, pair.normal, pair.weights(), pair.node, (pair.other(), pair.node), pair.stands_on)
        return name

    def loads(self):
        self.load = {}
        factors = self.deck.loads()
        for chosen, factor in factors.items():
            loads = self.deck.body_loads(chosen, self.x.get)
            for name, nodes, section in self.element.values() if loads else ():
                forces = body_forces(KINDS[name], [self.x[node] for node in nodes], section.thickness, section.density, loads)
                for node, force in zip(nodes, forces):
                    for i in (0, 1):
                        self.add(node, i, factor * force[i])
        for c in self.deck.of("FORCE") + self.deck.of("PLOADX1"):
            factor = factors.get(int(c[1]), 0.0)
            if not factor:
                continue
            if c[0] == "FORCE":
                for i in (0, 1):
                    self.add(int(c[2]), i, factor * real(c[4]) * real(at(c, 5 + i)))
            else:
                first, pa = int(c[5]), real(c[3])
                side = self.side.get(frozenset((first, int(c[6]))))
                if side is None:
                    raise DeckError(f"PLOADX1 between {first} and {c[6]}: not on the boundary")
                for node, i, value in edge_forces(side, self.x, first, (pa, real(c[4], pa)), real(at(c, 7))):
                    self.add(node, i, factor * value)

    def add(self, node, i, value):
        self.load.setdefault((node, i), []).append(value)


def node_of(name):
    """Nodes in the name of a pair of lines."""
    return name[0] if isinstance(name, tuple) else name
