"""Arrays of a plane model from a deck: its data, before the solution."""
import numpy as np
import scipy.sparse as sp

from body import body_forces
from boundary import boundary, edge_forces
from deck import DeckError, at, real
from kinds import KINDS
from lines import pairs_of_lines
from shapes import folded, strain_matrices
from ties import end_of_chains, resolved, rigid_ties, sums
from yielding import Law

#: Pairs have friction if this part of their weights can move along the tangent.
LEAST_SHARE = 0.01


class Model:
    """`told`: nodes of the other program's pairs of lines: they identify pairs that came near due to loads."""

    def __init__(self, deck, told=None):
        self.deck, self.told = deck, told
        self.nodes()
        self.materials()
        self.elements()
        self.heat()
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
        moduli = self.deck.moduli()
        curves = {name: np.array(points).T for name, points in self.deck.curves(moduli).items()}
        hardening = self.deck.hardening()
        paper = self.parameter.get("MUP") == "PAPER" or self.parameter.get("ORIGINAL") == "YES"
        self.section = {}
        for card in self.deck.of("PSHELL"):
            strain = at(card, 4) == "-1" or self.parameter.get("PLANE") == "STRAIN"
            if not strain and self.parameter.get("PLANE") != "STRESS":
                raise DeckError("neither plane strain nor plane stress")
            m = int(card[2])
            self.section[int(card[1])] = (real(card[3]), Law(*moduli[m], not strain, curves.get(m), paper, hardening.get(m, (0.0, False))))
        for card in self.deck.of("PSOLID"):
            m = int(card[2])
            self.section[int(card[1])] = (None, Law(*moduli[m], False, curves.get(m), paper, hardening.get(m, (0.0, False))))
        expansions = self.deck.expansions()
        self.expansion = {int(card[1]): expansions[int(card[2])] for card in self.deck.of("PSHELL") + self.deck.of("PSOLID")}

    def elements(self):
        """Elements card by card; `parts` has the integration points of each type: (which, DOFs, strain matrices), `boundary`
        the edges of one element by their ends: (element, edge)."""
        self.element, self.property, self.kind, self.members = [], [], [], []
        self.parts, volumes, owners, points = [], [], [], 0
        for name, kind in KINDS.items():
            cards = self.deck.of(name)
            if not cards:
                continue
            count, first = len(kind.nodes), len(self.element)
            members = np.array([[self.row[int(g)] for g in card[3:3 + count]] for card in cards])
            if folded(kind, self.x[members]).any():
                raise DeckError("an element folds over")
            self.element += [int(card[1]) for card in cards]
            self.property += [int(card[2] or card[1]) for card in cards]
            self.kind += [kind] * len(cards)
            self.members += list(members)
            sections = [self.section[p] for p in self.property[first:]]
            mean = np.array([name == "CQUAD4" and not law.plane_stress for _, law in sections])
            b, volume = strain_matrices(kind, self.x[members], np.array([depth or 0.0 for depth, _ in sections]), mean)
            freedom = np.stack([2 * members, 2 * members + 1], axis=2).reshape(len(cards), -1)
            each = len(kind.points)
            which = slice(points, points + volume.size)
            self.parts.append((which, np.repeat(freedom, each, axis=0), b.reshape(-1, *b.shape[2:])))
            points += volume.size
            volumes.append(volume.ravel())
            owners.append(np.repeat(np.arange(first, len(self.element)), each))
        self.boundary = boundary([(kind, [int(row) for row in members], self.section[p][0])
                                  for kind, members, p in zip(self.kind, self.members, self.property)], self.x)
        self.volume = np.concatenate(volumes) if volumes else np.zeros(0)
        self.owner = np.concatenate(owners) if owners else np.zeros(0, int)
        of_point = np.array(self.property, int)[self.owner]
        self.groups = [(law, np.flatnonzero(of_point == q)) for q, (_, law) in self.section.items()]

    def heat(self):
        """Thermal strains of all points if unrestrained; CQUAD4 has their mean, like its volume strain."""
        self.free = np.zeros((len(self.volume), 4))
        temperature, point = self.deck.temperatures(), 0
        for members, kind, p in zip(self.members, self.kind, self.property):
            here = slice(point, point + len(kind.points))
            point = here.stop
            if temperature is None:
                continue
            a, reference = self.expansion[p]
            strain = np.array(kind.shapes()) @ [a * (temperature(self.node[row]) - reference) for row in members]
            if kind is KINDS["CQUAD4"] and not self.section[p][1].plane_stress:
                strain[:] = strain @ self.volume[here] / self.volume[here].sum()
            self.free[here, :3] = strain[:, None]

    def of_points(self, name, strain, *shape):
        """Result of the material law of each point's section at its strain."""
        values = np.zeros((len(strain),) + shape)
        for law, members in self.groups:
            if len(members):
                values[members] = getattr(law, name)(strain[members])
        return values

    def respond(self, strain):
        """Stress [n, 4], equivalent strain, secant modulus and state of all points."""
        stress, total, secant = np.zeros((len(strain), 4)), np.zeros(len(strain)), np.zeros(len(strain))
        plastic = np.zeros(len(strain), bool)
        for law, members in self.groups:
            if len(members):
                stress[members], total[members], secant[members], plastic[members] = law.respond(strain[members])
        return stress, total, secant, plastic

    def strains(self, u):
        """Strains xx yy zz xy of all points that cause stresses."""
        strain = -self.free
        for which, freedom, b in self.parts:
            strain[which] += np.einsum("eij,ej->ei", b, u[freedom])
        return strain

    def unbalanced(self, u, stress, force):
        """Residual forces at all nodes: of stresses, springs, loads and contact forces."""
        return self.nodal(stress) + self.stretch.T @ (self.pull @ u) - self.force - self.contact_matrix.T @ force

    def mean(self, values):
        """Mean of each element, over the volumes of its points."""
        whole = np.bincount(self.owner, self.volume, len(self.element))
        return np.bincount(self.owner, self.volume * values, len(self.element)) / whole

    def nodal(self, stress, size=lambda force: force):
        """Nodal forces of stresses xx yy zz xy; or the sum of magnitudes of their terms."""
        force = np.zeros(2 * len(self.node))
        for which, freedom, b in self.parts:
            np.add.at(force, freedom, size(np.einsum("e,eij,ei->ej", self.volume[which], b, stress[which])))
        return force

    def stiffness(self, d):
        """Stiffness of material matrices [n, 4, 4], and of the springs."""
        n = 2 * len(self.node)
        total = self.stretch.T @ self.pull
        for which, freedom, b in self.parts:
            values = b.transpose(0, 2, 1) @ (self.volume[which, None, None] * (d[which] @ b))
            rows, columns = np.repeat(freedom, freedom.shape[1], axis=1), np.tile(freedom, (1, freedom.shape[1]))
            total = total + sp.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n))
        return total

    def freedoms(self):
        """u = tie @ v + held: v the independent DOFs. `lead` has those of all nodes, then the rotations of the master nodes of RBE2."""
        n, self.rotating = 2 * len(self.node), self.deck.rotating()
        rigid = rigid_ties(self.deck, self.rotating)
        terms = resolved(rigid, sums(self.deck, lambda node: self.x[self.row[node]], self.rotating))
        column = {(node, c): 2 * i + c for i, node in enumerate(self.node) for c in (0, 1)}
        column.update({(node, 2): n + k for k, node in enumerate(self.rotating)})
        entries = [(i, column[master], weight) for dof, i in column.items() for master, weight in terms.get(dof, {dof: 1.0}).items()]
        rows, columns, weights = zip(*entries)
        self.lead = sp.csr_matrix((weights, (rows, columns)), shape=(len(column), len(column)))[:n]
        given = np.full(len(column), np.nan)
        for node, digits, value in self.deck.held():
            for dof in [(node, int(digit) - 1 if digit in "12" else 2) for digit in set(digits) & set("126")]:
                if dof in column:
                    given[column[dof]] = value
        self.dof_held, self.given = ~np.isnan(given), np.nan_to_num(given)
        self.own = [i for dof, i in column.items() if dof not in terms and not self.dof_held[i]]
        self.tie, self.held, self.is_held = self.lead[:, self.own], self.lead @ self.given, self.dof_held[:n]
        self.leader = {(self.row[node], c): (self.row[end[0]], end[1]) for (node, c), end in end_of_chains(rigid).items()}
        support = [(int(card[i]), int(digit)) for card in self.deck.of("SUPORT") for i in range(1, len(card) - 1, 2) if card[i] for digit in card[i + 1]]
        at = [(node, digit, column.get((node, min(digit, 3) - 1))) for node, digit in support if digit in (1, 2, 6)]
        self.support = [(node, digit, i) for node, digit, i in at if i is not None and not self.dof_held[i]]
        self.twist = np.zeros(len(column))
        for node, moment in self.deck.moments().items():
            self.twist[column[node, 2]] = moment
        self.springs = list(self.deck.springs())
        self.stretch, self.pull = (sp.lil_matrix((len(self.springs), n)) for _ in range(2))
        for k, (_, stiffness, ends) in enumerate(self.springs):
            for end, sign in zip(ends, (-1.0, 1.0)):
                if end:
                    self.stretch[k, column[end]] = sign
                    self.pull[k, column[end]] = sign * stiffness
        self.stretch, self.pull = self.stretch.tocsr(), self.pull.tocsr()

    def loads(self):
        """All that grows with the loads."""
        return {name: getattr(self, name) for name in ("force", "given", "held", "free", "twist")}

    def take_loads(self, loads):
        for name, value in loads.items():
            setattr(self, name, value)

    def masters(self, v):
        """Displacements of all independent DOFs."""
        values = self.given.copy()
        values[self.own] = v
        return values

    def motion(self, row, c):
        """The DOF that moves a node along a direction, or its fixed displacement."""
        lead = self.leader.get((row, c), (row, c))
        return self.held[2 * lead[0] + lead[1]] if self.is_held[2 * lead[0] + lead[1]] else lead

    def pairs(self):
        """For each pair: id, the two nodes named in tables, normal, gap, its row of the gap matrix, and coefficient of friction. `sliding`: pairs with
        friction that can move along the tangent; their rows of the contact matrix follow those of the gaps."""
        frames = self.deck.frames()
        given = {int(card[1]): real(at(card, 2)) for card in self.deck.of("PGAP")}
        found = []
        for card in self.deck.of("CGAP"):
            a, b = self.row[int(card[3])], self.row[int(card[4])]
            along = self.x[b] - self.x[a]
            n = np.array(frames[int(card[8])]) if at(card, 8) else along / np.linalg.norm(along)
            gap = given[int(card[2] or card[1])] + (along @ n if self.parameter.get("GAPGEOM") == "YES" else 0.0)
            found.append((int(card[1]), (a, b), n, gap, {a: -1.0, b: 1.0}, self.deck.friction(card)))
        self.contacts = [range(len(found))]
        held = {(int(f) // 2, int(f) % 2) for f in np.flatnonzero(self.is_held)}
        everywhere = {(row, c) for row in range(len(self.node)) for c in (0, 1) if self.leader.get((row, c), (row, c)) in held}
        self.stands_on = [()] * len(found)
        for contact in pairs_of_lines(self.deck, self.parameter, self.boundary, self.x, everywhere, self.motion, self.row.get,
                                     None if self.told is None else [self.row[node] for node in self.told]):
            self.contacts.append(range(len(found), len(found) + len(contact)))
            for pair in contact:
                found.append((self.node[pair.node], (pair.other(), pair.node), pair.normal, pair.gap, pair.weights(), pair.friction))
                self.stands_on.append(pair.stands_on)
        self.held_directions = held
        self.pair_weights = [pair[4] for pair in found]
        self.pair = [pair[0] for pair in found]
        self.ends = [pair[1] for pair in found]
        self.normal = np.array([pair[2] for pair in found]).reshape(-1, 2)
        self.initial = np.array([pair[3] for pair in found])
        along = self.along(self.normal)
        across = self.along(self.normal[:, ::-1] * [1.0, -1.0])
        moves = abs(self.lead) @ (~self.dof_held | (self.given != 0.0)) > 0.0
        mu = np.array([pair[5] for pair in found])
        self.sliding = np.flatnonzero((mu > 0.0) & (abs(across) @ moves > LEAST_SHARE * abs(across).sum(axis=1).A1))
        self.friction = mu[self.sliding]
        self.contact_matrix = sp.vstack([along, across[self.sliding]], format="csr")

    def along(self, direction):
        """Matrix of the relative displacements of all pairs along these directions."""
        entries = [(k, 2 * row + c, weight * direction[k, c]) for k, weights in enumerate(self.pair_weights) for row, weight in weights.items() for c in (0, 1)]
        rows, columns, values = np.array(entries).reshape(-1, 3).T
        return sp.csr_matrix((values, (rows.astype(int), columns.astype(int))), shape=(len(self.pair), 2 * len(self.node)))

    def load(self):
        self.force = np.zeros(2 * len(self.node))
        factors, density = self.deck.loads(), self.deck.densities()
        for chosen, factor in factors.items():
            loads = self.deck.body_loads(chosen, lambda node: self.x[self.row[node]])
            for kind, members, section in zip(self.kind, self.members, self.property) if loads else ():
                forces = body_forces(kind, self.x[members].tolist(), self.section[section][0], density[section], loads)
                for row, force in zip(members, forces):
                    self.force[2 * row:2 * row + 2] += factor * np.array(force)
        for card in self.deck.of("FORCE") + self.deck.of("PLOADX1"):
            factor = factors.get(int(card[1]), 0.0)
            if card[0] == "FORCE":
                i = 2 * self.row[int(card[2])]
                self.force[i:i + 2] += factor * real(card[4]) * np.array([real(at(card, 5)), real(at(card, 6))])
            else:
                pa = real(card[3])
                ends = self.row[int(card[5])], self.row[int(card[6])]
                side = self.boundary[frozenset(ends)]
                for node, c, force in edge_forces(side, self.x, ends[0], (pa, real(card[4], pa)), real(at(card, 7))):
                    self.force[2 * node + c] += factor * force
