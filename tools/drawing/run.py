"""A deck and its results, as arrays."""
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
import tables

TOP = pathlib.Path(__file__).resolve().parent.parent.parent
PROGRAM = TOP / "build/release/epcont"
sys.path.insert(0, str(TOP / "tests" / "independent"))
from drawing import Refused, loading  # noqa: E402
from deck import DeckError, at, ids, read, real  # noqa: E402

#: Nodes of each element type in order around it, as positions among the nodes of its card.
ROUND = {"CTRIA3": [0, 1, 2], "CTRAX3": [0, 1, 2], "CQUAD4": [0, 1, 2, 3], "CTRIA6": [0, 3, 1, 4, 2, 5], "CQUAD8": [0, 4, 1, 5, 2, 6, 3, 7], "CTRAX6": [0, 1, 2, 3, 4, 5]}
#: If contact forces of all increments differ by less than this part, a history of them shows nothing.
SAME_FORCE = 1e-3


class Run:
    """Coordinates and displacements of the nodes, elements counter-clockwise, stresses, contact lines, history.

    If a run failed, displacements and stresses are 0, lines and history empty.
    """

    def __init__(self, path, case=None):
        self.path = pathlib.Path(path)
        with tempfile.TemporaryDirectory() as place:
            run = subprocess.run([PROGRAM, self.path, "-o", place, "--tables", "all"], capture_output=True, text=True, check=False)
            if run.returncode not in (0, 1, 4):
                raise Refused(run.stderr.strip() or run.stdout.strip(), run.returncode)
            self.message = run.stderr.strip()
            try:
                case = tables.case_of(pathlib.Path(place), self.path.stem, case)
            except ValueError as error:
                raise Refused(f"{self.path}: {error}") from None
            every = {name: table(pathlib.Path(place) / f"{self.path.stem}.{name}.csv")
                     for name in ("nodes", "elements", "contact", "zones", "history", "summary", "increments", "plastic", "friction")}
            found = {name: tables.of_case(rows, case) for name, rows in every.items()}
            summary = found["summary"]
            self.status = next(row["value"] for row in summary if row["key"] == "status")
            self.title = title(pathlib.Path(place) / f"{self.path.stem}.lst") + (f"  SUBCASE {case}" if case is not None else "")
        try:
            deck = read(self.path)
        except DeckError as error:
            raise Refused(f"{self.path}: this deck cannot be drawn, although epcont reads it: {error}") from error
        self.exit_status = run.returncode
        self.take_mesh(deck, found["nodes"], found["elements"])
        rubbed = {}
        for row in found["friction"]:
            rubbed.setdefault(row["pair"], []).append(row)
        for row in found["contact"]:   # a node with two pairs has two rows in both tables, in the same order
            if rubbed.get(row["pair"]):
                row["rubbed"] = rubbed[row["pair"]].pop(0)
        self.take_contact(deck, found["contact"], found["zones"])
        self.take_history(every)
        self.history = {key: np.array([float(row[key]) for row in found["history"]]) for key in (found["history"] or [{}])[0]}
        self.young, self.nu = next((real(at(card, 2)), real(at(card, 4))) for card in deck.of("MAT1"))
        self.unit = {at(card, 1): at(card, 2) for card in deck.of("PARAM")}.get("UNITS", "")
        self.rings = bool(deck.of("PSOLID"))

    def take_mesh(self, deck, nodes, elements):
        # The axis of a rotation is far from the bodies and shows nothing.
        of_elements = {int(card[3 + i]) for kind, order in ROUND.items() for card in deck.of(kind) for i in order}
        axes = {int(card[2]) for card in deck.of("RFORCE") if at(card, 2)} - of_elements
        grids = [card for card in deck.of("GRID") if int(card[1]) not in axes]
        self.row = {int(card[1]): i for i, card in enumerate(grids)}
        self.x = np.array([[real(at(card, 3)), real(at(card, 4))] for card in grids])
        self.u = np.zeros_like(self.x)
        for node in nodes:
            if int(node["node"]) not in axes:
                self.u[self.row[int(node["node"])]] = float(node["ux"]), float(node["uy"])
        self.around, self.number = [], {}
        for kind, order in ROUND.items():
            for card in deck.of(kind):
                self.number[int(card[1])] = len(self.around)
                self.around.append([self.row[int(card[3 + i])] for i in order])
        keys = ("sx", "sy", "sz", "equivalent_stress")
        self.stress = {key: self.by_element(elements, key) for key in keys}
        self.plastic = np.zeros(len(self.around), bool)
        for element in elements:
            self.plastic[self.number[int(element["element"])]] = element["state"] == "plastic"
        self.solved = bool(elements)
        self.bare = sorted(set(range(len(self.x))) - {node for nodes in self.around for node in nodes})

    def take_history(self, every):
        """Flow theory, or friction, with contact: increments, pairs of all load cases, and the state after unloading."""
        self.increments = every["increments"]
        forces = [float(row["total_contact_force"]) for row in self.increments]
        varies = max(forces, default=0.0) - min(forces, default=0.0) > SAME_FORCE * max(forces, default=0.0)
        self.pressed = [row for row in every["contact"] if varies and float(row["pressure"] or 0.0) > 0.0]
        found = loading.unloaded_case(self.increments) if self.pressed and self.solved and every["plastic"] else None
        self.unloaded = f"SUBCASE {found[0]} ({100 * found[1]:.2g} % of the force)" if found else None
        if found:
            rows = tables.of_case(every["elements"], found[0])
            self.residual = {key: self.by_element(rows, key) for key in ("sx", "sy")}
            self.accumulated = self.by_element(tables.of_case(every["plastic"], found[0]), "accumulated")

    def by_element(self, rows, key):
        """A column of a table of elements, in their order; 0 for elements without a row."""
        value = np.zeros(len(self.around))
        for row in rows:
            value[self.number[int(row["element"])]] = float(row[key])
        return value

    def take_contact(self, deck, pairs, zones):
        """Contact lines: the pairs of each BCONP, and CGAPs whose nodes are neighbours on a boundary."""
        nodes = {int(card[1]): {int(node) for node in ids(card[2:])} for card in deck.of("BLSEG")}
        contacts = [(card[1], int(card[2]), int(card[3])) for card in deck.of("BCONP")]
        left, self.lines = list(pairs), []
        for name, slave, master in contacts:
            alone = sum(other == slave for _, other, _ in contacts) == 1   # else its pairs are those of the master's nodes
            own = [p for p in left if p["pair"] == p["gb"] and int(p["gb"]) in nodes[slave] and (alone or int(p["ga"]) in nodes[master])]
            left = [p for p in left if p not in own]
            self.lines += [Line(f"BCONP {name}", own)] if own else []
        for chain in chains(left, self.neighbours()):
            first, last = chain[0]["pair"], chain[-1]["pair"]
            self.lines.append(Line(f"CGAP {first} to {last}" if first != last else f"CGAP {first}", chain))
        node = {p["pair"]: self.row[int(p["gb"])] for p in pairs}
        self.zones = [(float(z["force"]), node[z["first_pair"]], node[z["last_pair"]]) for z in zones]

    def neighbours(self):
        """Ids of the nodes that an edge connects with each id."""
        number = {i: node for node, i in self.row.items()}
        beside = {}
        for a, b in self.sides():
            beside.setdefault(number[a], set()).add(number[b])
            beside.setdefault(number[b], set()).add(number[a])
        return beside

    def sides(self, chosen=None):
        """Edges that belong to only one of the chosen elements (all, if none are given)."""
        count = {}
        for nodes, wanted in zip(self.around, np.ones(len(self.around), bool) if chosen is None else chosen):
            if wanted:
                for ends in zip(nodes, nodes[1:] + nodes[:1]):
                    key = tuple(sorted(ends))
                    count[key] = count.get(key, 0) + 1
        return [ends for ends, times in count.items() if times == 1]

    def size(self):
        """Larger extent of the model."""
        return np.ptp(self.x, axis=0).max()

    def stress_unit(self):
        """KGF-MM is shown as kgf/mm2; other names are shown unchanged."""
        force, _, length = self.unit.partition("-")
        names = {"KGF": "kgf", "N": "N", "MM": "mm", "M": "m"}
        return f"{names.get(force, force)}/{names.get(length, length)}$^2$" if length else "force/length$^2$"

    def length_unit(self):
        """`, mm` for KGF-MM; nothing for other names."""
        length = self.unit.partition("-")[2]
        return f", {length.lower()}" if length in ("MM", "M") else ""


class Line:
    """The pairs of one contact line: coordinates, forces, pressures, initial gaps."""

    def __init__(self, name, pairs):
        self.name = name
        self.x = np.array([[float(p["x"]), float(p["y"])] for p in pairs])
        self.force, self.pressure, self.gap = (np.array([float(p[key] or 0) for p in pairs]) for key in ("force", "pressure", "initial_gap"))
        self.touching = self.force > 0
        rubbed = [p.get("rubbed", {}) for p in pairs]
        self.rubs = np.array([bool(row) for row in rubbed])
        self.friction, self.shear, self.slid = (np.array([float(row.get(key) or 0.0) for row in rubbed]) for key in ("friction", "shear", "slid"))


def table(path):
    """Rows of a table; empty if the run wrote no such table."""
    return tables.rows(path) if path.exists() else []


def title(listing):
    """The TITLE of the deck, from the third line of its listing."""
    lines = listing.read_text(encoding="latin-1").splitlines() if listing.exists() else []
    return lines[2].strip() if len(lines) > 2 and lines[2].startswith("  ") and not lines[2].startswith("  units:") else ""


def chains(pairs, beside):
    """Sets of pairs connected by edges between their A nodes or between their B nodes."""
    left = list(pairs)
    while left:
        chain, front = [], [left.pop(0)]
        while front:
            pair = front.pop()
            chain.append(pair)
            near = [p for p in left if any(int(p[end]) in beside.get(int(pair[end]), ()) for end in ("ga", "gb"))]
            left = [p for p in left if p not in near]
            front += near
        yield [p for p in pairs if p in chain]
