"""Translate a deck of three-node elements with contact between lines to an input of CalculiX, and read one displacement of its results.

The same nodes, elements, supports, platens, loads and bilinear steel; penalty contact between the same lines, with stiffness 50 E per mm.
"""
import re

from cards import fields

STIFFNESS_OF_YOUNG = 50.0
#: NODE TO SURFACE takes the slave's nodes, SURFACE TO SURFACE its edges.
CONTACTS = ("NODE TO SURFACE", "SURFACE TO SURFACE")



def real(field):
    """A real in the format of a deck, `1.5-7` too."""
    return float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"E\1", field)) if field else 0.0


class Cards:
    """Fields of all cards by name, with continuation lines joined."""

    def __init__(self, text):
        self.of = {}
        current = None
        for line in text.partition("BEGIN BULK\n")[2].splitlines():
            if line.startswith(("$", "ENDDATA")):
                continue
            name, data = fields(line)
            if name in ("", "*"):
                current += data
            else:
                current = data
                self.of.setdefault(name.rstrip("*"), []).append(current)

    def whole(self, name, begin, end=None):
        """Integers of each card of a name, starting at a field."""
        return [[int(field) for field in card[begin:end] if field] for card in self.of.get(name, [])]


def corners(cards):
    """Corners of each element, counter-clockwise, and its property."""
    point = {int(card[0]): (real(card[2]), real(card[3])) for card in cards.of["GRID"]}
    element = {}
    for number, section, *nodes in cards.whole("CTRIA3", 0, 5):
        (ax, ay), (bx, by), (cx, cy) = (point[n] for n in nodes)
        if (bx - ax) * (cy - ay) < (by - ay) * (cx - ax):
            nodes = [nodes[0], nodes[2], nodes[1]]
        element[number] = (section, nodes)
    return point, element


def sides(element):
    """Element and number of each edge, by its two nodes in either order; one element per edge."""
    return {frozenset((nodes[k], nodes[(k + 1) % 3])): (number, k + 1) for number, (_, nodes) in element.items() for k in range(3)}


def listed(numbers):
    return "".join(", ".join(map(str, numbers[i:i + 12])) + ",\n" for i in range(0, len(numbers), 12))


def materials(cards):
    """Value of each property."""
    curve = {int(card[0]): (real(card[6]), real(card[3])) for card in cards.of.get("MATS1", [])}
    for number, young, _, nu in (card[:4] for card in cards.of["MAT1"]):
        yield f"*MATERIAL, NAME=M{number}\n*ELASTIC\n{real(young)},{real(nu)}\n"
        if int(number) in curve:
            stress, slope = curve[int(number)]
            yield f"*PLASTIC\n{stress},0.\n{stress + slope},1.\n"
    for card in cards.of["PSHELL"]:
        yield f"*SOLID SECTION, ELSET=E{card[0]}, MATERIAL=M{card[1]}\n{real(card[2])}\n"


def surfaces(cards, side, contact):
    """Lines and the contacts between them."""
    slaves = {slave for _, slave, _ in cards.whole("BCONP", 0, 3)}
    for number, *nodes in cards.whole("BLSEG", 0):
        if number in slaves and contact == "NODE TO SURFACE":
            yield f"*NSET, NSET=N{number}\n{listed(nodes)}*SURFACE, NAME=S{number}, TYPE=NODE\nN{number}\n"
        else:
            yield f"*SURFACE, NAME=S{number}\n"
            yield from (f"{e},S{k}\n" for e, k in (side[frozenset(pair)] for pair in zip(nodes, nodes[1:])))
    stiffness = STIFFNESS_OF_YOUNG * real(cards.of["MAT1"][0][1])
    yield f"*SURFACE INTERACTION, NAME=HARD\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{stiffness:.6g},1e-6\n"
    yield from (f"*CONTACT PAIR, INTERACTION=HARD, TYPE={contact}\nS{slave},S{master}\n" for _, slave, master in cards.whole("BCONP", 0, 3))


def loads(cards, side):
    force = ["*CLOAD\n"] + [f"{card[1]},{c + 1},{real(card[3]) * real(card[4 + c])}\n" for card in cards.of.get("FORCE", []) for c in (0, 1)
                            if real(card[4 + c])]
    pressure = ["*DLOAD\n"] + [f"{card[1]},P{side[frozenset((int(card[4]), int(card[5])))][1]},{real(card[2])}\n"
                               for card in cards.of.get("PLOADX1", [])]
    return [line for lines in (force, pressure) if len(lines) > 1 for line in lines]


def write(path, text, contact, solver, increment):
    """Translate a deck's text; return the input and the node whose displacement is compared."""
    cards = Cards(text)
    point, element = corners(cards)
    side = sides(element)
    told = cards.whole("SUPORT", 0, 1)[0][0]
    lines = ["*NODE\n", *(f"{number},{x:.12g},{y:.12g},0\n" for number, (x, y) in point.items())]
    for section in sorted({section for section, _ in element.values()}):
        lines.append(f"*ELEMENT, TYPE=CPE3, ELSET=E{section}\n")
        lines += [f"{number}," + ",".join(map(str, nodes)) + "\n" for number, (of, nodes) in element.items() if of == section]
    lines += materials(cards)
    lines += [f"*EQUATION\n2\n{node},{c},1.,{leader},{c},-1.\n" for _, leader, c, *nodes in cards.whole("RBE2", 0) for node in nodes]
    lines += surfaces(cards, side, contact)
    lines.append("*BOUNDARY\n")
    lines += [f"{node},{digit},{digit}\n" for card in cards.of["SPC1"] for node in card[2:] if node for digit in card[1]]
    lines += [f"*NSET, NSET=TOLD\n{told}\n*STEP, INC=1000\n*STATIC, SOLVER={solver}\n{increment},1.\n", *loads(cards, side),
              "*NODE PRINT, NSET=TOLD, FREQUENCY=1000\nU\n*END STEP\n"]
    path.write_text("".join(lines), encoding="ascii")
    return told


def answer(path):
    """Displacement along y at full load; None if it was not reached."""
    found = re.findall(r"displacements .* time +(\S+)\s+\d+ +\S+ +(\S+)", path.read_text(encoding="ascii")) if path.exists() else []
    return next((float(value) for time, value in found if float(time) == 1.0), None)
