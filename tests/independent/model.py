"""Arrays of a plane model from a deck: what is said there, nothing solved yet."""
import numpy as np
import scipy.sparse as sp

from deck import DeckError, at, ids, integer, real
from yielding import Law, bilinear


class Model:
    def __init__(self, deck):
        self.deck = deck
        self.nodes()
        self.materials()
        self.triangles()
        self.freedoms()
        self.pairs()
        self.load()

    def nodes(self):
        cards = self.deck.of("GRID")
        self.node = [int(card[1]) for card in cards]
        self.row = {node: i for i, node in enumerate(self.node)}
        self.x = np.array([[real(at(card, 3)), real(at(card, 4))] for card in cards])

    def materials(self):
        self.parameter = {card[1]: card[2] for card in self.deck.of("PARAM")}
        matrices = {}
        for card in self.deck.of("MAT1"):
            e, g, nu = (real(text, None) for text in card[2:5])
            e = 2 * g * (1 + nu) if e is None else e
            nu = e / (2 * g) - 1 if nu is None else nu
            matrices[int(card[1])] = (e, nu)
        curves = self.curves(matrices)
        paper = self.parameter.get("MUP") == "PAPER"
        self.section = {}
        for card in self.deck.of("PSHELL"):
            strain = at(card, 4) == "-1" or self.parameter.get("PLANE") == "STRAIN"
            if not strain and self.parameter.get("PLANE") != "STRESS":
                raise DeckError("neither plane strain nor plane stress")
            e, nu = matrices[int(card[2])]
            self.section[int(card[1])] = (real(card[3]), Law(e, nu, strain, curves.get(int(card[2])), paper))

    def curves(self, matrices):
        """Uniaxial curves by the ids of their MAT1; a table's yield strain is its yield stress over E."""
        tables = {}
        for card in self.deck.of("TABLES1"):
            numbers = [real(text) for text in card[9:card.index("ENDT")]]
            tables[int(card[1])] = np.array(numbers[0::2]), np.array(numbers[1::2])
        curves = {}
        for card in self.deck.of("MATS1"):
            young = matrices[int(card[1])][0]
            if at(card, 2):
                strain, stress = tables[int(card[2])]
                strain[1] = stress[1] / young
                curves[int(card[1])] = strain.copy(), stress
            else:
                curves[int(card[1])] = bilinear(young, real(card[7]), real(at(card, 4)))
        return curves

    def triangles(self):
        cards = self.deck.of("CTRIA3")
        self.element = [int(card[1]) for card in cards]
        self.property = [int(card[2] or card[1]) for card in cards]
        self.corner = np.array([[self.row[int(g)] for g in card[3:6]] for card in cards]).reshape(-1, 3)
        p = self.x[self.corner]
        twice = (p[:, 1, 0] - p[:, 0, 0]) * (p[:, 2, 1] - p[:, 0, 1]) - (p[:, 2, 0] - p[:, 0, 0]) * (p[:, 1, 1] - p[:, 0, 1])
        turned = twice < 0
        self.corner[turned] = self.corner[turned][:, ::-1]
        self.area = abs(twice) / 2

        self.strain_matrix = np.zeros((len(self.element), 3, 6))
        x, y = self.x[self.corner, 0], self.x[self.corner, 1]
        for i in range(3):
            j, m = (i + 1) % 3, (i + 2) % 3
            slope_x, slope_y = (y[:, j] - y[:, m]) / (2 * self.area), (x[:, m] - x[:, j]) / (2 * self.area)
            self.strain_matrix[:, 0, 2 * i] = self.strain_matrix[:, 2, 2 * i + 1] = slope_x
            self.strain_matrix[:, 1, 2 * i + 1] = self.strain_matrix[:, 2, 2 * i] = slope_y
        self.volume = self.area * np.array([self.section[p][0] for p in self.property])
        self.freedom = np.stack([2 * self.corner, 2 * self.corner + 1], axis=2).reshape(-1, 6)
        self.groups = [(law, np.flatnonzero([p == q for p in self.property])) for q, (_, law) in self.section.items()]

    def of_elements(self, name, strain, *shape):
        """What the law of each element's section says of its strain."""
        values = np.zeros((len(strain),) + shape)
        for law, members in self.groups:
            if len(members):
                values[members] = getattr(law, name)(strain[members])
        return values

    def respond(self, strain):
        """Stress [n, 4], equivalent strain, secant modulus and state of all elements."""
        stress, total, secant = np.zeros((len(strain), 4)), np.zeros(len(strain)), np.zeros(len(strain))
        plastic = np.zeros(len(strain), bool)
        for law, members in self.groups:
            if len(members):
                stress[members], total[members], secant[members], plastic[members] = law.respond(strain[members])
        return stress, total, secant, plastic

    def strains(self, u):
        return np.einsum("eij,ej->ei", self.strain_matrix, u[self.freedom])

    def nodal(self, stress):
        """Nodal forces that hold stresses xx yy xy."""
        force = np.zeros(2 * len(self.node))
        np.add.at(force, self.freedom, np.einsum("e,eij,ei->ej", self.volume, self.strain_matrix, stress))
        return force

    def stiffness(self, d):
        """Of material matrices [n, 3, 3]."""
        n = 2 * len(self.node)
        values = np.einsum("e,eki,ekl,elj->eij", self.volume, self.strain_matrix, d, self.strain_matrix)
        rows, columns = np.repeat(self.freedom, 6, axis=1), np.tile(self.freedom, (1, 6))
        return sp.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n))

    def chosen(self, kind, cards):
        sets = {int(card[1]) for card in cards}
        if kind in self.deck.case:
            return self.deck.case[kind]
        if len(sets) > 1:
            raise DeckError(f"several {kind} sets and no choice")
        return next(iter(sets), None)

    def freedoms(self):
        """u = tie @ v + held: v the freedoms left."""
        n = 2 * len(self.node)
        held = np.full(n, np.nan)
        master = np.arange(n)
        for card in self.deck.of("GRID"):
            for digit in at(card, 8):
                if digit in "12":
                    held[2 * self.row[int(card[1])] + int(digit) - 1] = 0.0
        cards = self.deck.of("SPC") + self.deck.of("SPC1")
        chosen = self.chosen("SPC", cards)
        for card in cards:
            if int(card[1]) != chosen:
                continue
            if card[0] == "SPC1":
                triples = [(g, card[2], 0.0) for g in ids(card[3:])]
            else:
                triples = [(int(card[i]), card[i + 1], real(card[i + 2])) for i in (2, 5) if at(card, i)]
            for g, digits, value in triples:
                for digit in digits:
                    if digit in "12":
                        held[2 * self.row[g] + int(digit) - 1] = value
        for card in self.deck.of("RBE2"):
            for g in ids(card[4:]):
                for digit in card[3]:
                    if digit in "12":
                        master[2 * self.row[g] + int(digit) - 1] = 2 * self.row[int(card[2])] + int(digit) - 1
        for _ in range(50):
            master = master[master]
        own = [i for i in range(n) if master[i] == i and np.isnan(held[i])]
        number = {f: j for j, f in enumerate(own)}
        rows = [i for i in range(n) if master[i] in number]
        self.tie = sp.csr_matrix((np.ones(len(rows)), (rows, [number[master[i]] for i in rows])), shape=(n, len(own)))
        self.held = np.where(np.isnan(held[master]), 0.0, held[master])
        self.is_held = ~np.isnan(held)
        self.support = []
        for card in self.deck.of("SUPORT"):
            for i in range(1, len(card) - 1, 2):
                if card[i]:
                    self.support += [(int(card[i]), int(digit)) for digit in card[i + 1] if digit in "12"]

    def pairs(self):
        frames = {int(card[1]): first_axis([real(at(card, i)) for i in range(3, 12)]) for card in self.deck.of("CORD2R")}
        given = {int(card[1]): real(at(card, 2)) for card in self.deck.of("PGAP")}
        cards = self.deck.of("CGAP")
        self.pair = [int(card[1]) for card in cards]
        self.ends = np.array([[self.row[int(card[3])], self.row[int(card[4])]] for card in cards]).reshape(-1, 2)
        self.normal = np.zeros((len(cards), 2))
        self.initial = np.zeros(len(cards))
        for k, card in enumerate(cards):
            a, b = self.ends[k]
            along = self.x[b] - self.x[a]
            self.normal[k] = frames[int(card[8])] if at(card, 8) else along / np.linalg.norm(along)
            self.initial[k] = given[int(card[2] or card[1])]
            if self.parameter.get("GAPGEOM") == "YES":
                self.initial[k] += along @ self.normal[k]
        rows = np.repeat(np.arange(len(cards)), 4)
        columns = np.array([[2 * a, 2 * a + 1, 2 * b, 2 * b + 1] for a, b in self.ends]).ravel()
        values = np.hstack([-self.normal, self.normal]).ravel()
        self.gap_matrix = sp.csr_matrix((values, (rows, columns.astype(int))), shape=(len(cards), 2 * len(self.node)))

    def load(self):
        self.force = np.zeros(2 * len(self.node))
        cards = self.deck.of("FORCE") + self.deck.of("PLOADX1")
        chosen = self.chosen("LOAD", cards)
        row = {element: k for k, element in enumerate(self.element)}
        for card in cards:
            if int(card[1]) != chosen:
                continue
            if card[0] == "FORCE":
                i = 2 * self.row[int(card[2])]
                self.force[i:i + 2] += real(card[4]) * np.array([real(at(card, 5)), real(at(card, 6))])
            else:
                self.edge_load(card, row[int(card[2])])

    def edge_load(self, card, k):
        a, b = self.row[int(card[5])], self.row[int(card[6])]
        pa, pb = real(card[3]), real(card[4], real(card[3]))
        along = self.x[b] - self.x[a]
        inward = np.array([-along[1], along[0]])
        third = next(c for c in self.corner[k] if c not in (a, b))
        if inward @ (self.x[third] - self.x[a]) < 0:
            inward = -inward
        angle = np.radians(real(at(card, 7)))
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        inward = turn @ inward * self.section[self.property[k]][0]
        self.force[2 * a:2 * a + 2] += inward * (2 * pa + pb) / 6
        self.force[2 * b:2 * b + 2] += inward * (pa + 2 * pb) / 6


def first_axis(numbers):
    """x-axis of the frame with origin A, z-axis towards B and C in the xz plane."""
    a, b, c = np.array(numbers).reshape(3, 3)
    z = (b - a) / np.linalg.norm(b - a)
    x = (c - a) - ((c - a) @ z) * z
    return (x / np.linalg.norm(x))[:2]
