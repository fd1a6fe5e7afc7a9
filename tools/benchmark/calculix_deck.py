"""Translate a deck of three-node elements with contact between lines to an input of CalculiX, and read its results.

The same nodes, elements, supports, platens, loads and bilinear steel; penalty contact between the same lines, with stiffness 50 E per unit of length,
and with friction another stiffness while it sticks. A sequence of load cases becomes one *STEP each.
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


def surfaces(cards, side, contact, normal, tangential):
    """Lines and the contacts between them, with these stiffnesses over Young's modulus."""
    slaves = {slave for _, slave, _ in cards.whole("BCONP", 0, 3)}
    for number, *nodes in cards.whole("BLSEG", 0):
        if number in slaves and contact == "NODE TO SURFACE":
            yield f"*NSET, NSET=N{number}\n{listed(nodes)}*SURFACE, NAME=S{number}, TYPE=NODE\nN{number}\n"
        else:
            yield f"*SURFACE, NAME=S{number}\n"
            yield from (f"{e},S{k}\n" for e, k in (side[frozenset(pair)] for pair in zip(nodes, nodes[1:])))
    young = real(cards.of["MAT1"][0][1])
    yield f"*SURFACE INTERACTION, NAME=HARD\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{normal * young:.6g},1e-6\n"
    yield from (f"*FRICTION\n{real(card[3])},{tangential * young:.6g}\n" for card in cards.of.get("BFRIC", []))
    yield from (f"*CONTACT PAIR, INTERACTION=HARD, TYPE={contact}\nS{slave},S{master}\n" for _, slave, master in cards.whole("BCONP", 0, 3))


def loads(cards, side, factors=None):
    """All loads, or the forces of some sets with factors."""
    force = ["*CLOAD\n"] + [f"{card[1]},{c + 1},{real(card[3]) * real(card[4 + c]) * (factors[card[0]] if factors else 1.0)}\n"
                            for card in cards.of.get("FORCE", []) for c in (0, 1) if real(card[4 + c])]
    pressure = ["*DLOAD\n"] + [f"{card[1]},P{side[frozenset((int(card[4]), int(card[5])))][1]},{real(card[2])}\n"
                               for card in cards.of.get("PLOADX1", [])]
    return [line for lines in (force, pressure) if len(lines) > 1 for line in lines]


def model(cards, point, element, side, surfaces):
    """All but the steps."""
    lines = ["*NODE\n", *(f"{number},{x:.12g},{y:.12g},0\n" for number, (x, y) in point.items())]
    for section in sorted({section for section, _ in element.values()}):
        lines.append(f"*ELEMENT, TYPE=CPE3, ELSET=E{section}\n")
        lines += [f"{number}," + ",".join(map(str, nodes)) + "\n" for number, (of, nodes) in element.items() if of == section]
    lines += materials(cards)
    lines += [f"*EQUATION\n2\n{node},{c},1.,{leader},{c},-1.\n" for _, leader, digits, *nodes in cards.whole("RBE2", 0) for node in nodes for c in str(digits)]
    lines += surfaces
    lines.append("*BOUNDARY\n")
    lines += [f"{node},{digit},{digit}\n" for card in cards.of["SPC1"] for node in card[2:] if node for digit in card[1]]
    return [*lines, f"*NSET, NSET=TOLD\n{cards.whole('SUPORT', 0, 1)[0][0]}\n"]


def write(path, text, contact, solver, increment):
    """Translate a deck's text with one load case."""
    cards = Cards(text)
    point, element = corners(cards)
    side = sides(element)
    lines = model(cards, point, element, side, surfaces(cards, side, contact, STIFFNESS_OF_YOUNG, 0.0))
    lines += [f"*STEP, INC=1000\n*STATIC, SOLVER={solver}\n{increment},1.\n", *loads(cards, side), "*NODE PRINT, NSET=TOLD, FREQUENCY=1000\nU\n*END STEP\n"]
    path.write_text("".join(lines), encoding="ascii")


def write_sequence(path, text, contact, increments, normal, tangential):
    """Translate a deck whose load cases are LOAD cards, in sequence; CalculiX may only reduce the increments."""
    cards = Cards(text)
    point, element = corners(cards)
    side = sides(element)
    slave = set(cards.whole("BLSEG", 1)[0])
    lines = model(cards, point, element, side, surfaces(cards, side, contact, normal, tangential))
    lines.append("*ELSET, ELSET=BESIDE\n" + listed([number for number, (_, nodes) in element.items() if slave & set(nodes)]))
    for card in cards.of["LOAD"]:
        factors = {set_: real(card[1]) * real(factor) for factor, set_ in zip(card[2::2], card[3::2]) if set_}
        lines += [f"*STEP, INC=1000\n*STATIC, SOLVER=SPOOLES\n{1.0 / increments},1.,1e-5,{1.0 / increments}\n", *loads(cards, side, factors),
                  "*NODE PRINT, NSET=TOLD, FREQUENCY=1000\nU\n*EL PRINT, ELSET=BESIDE, FREQUENCY=1000\nS\n*END STEP\n"]
    path.write_text("".join(lines), encoding="ascii")


def answer(path):
    """Displacement along y at full load; None if it was not reached."""
    return displacements(path).get(1.0, (None, None))[1]


def displacements(path):
    """Displacements of the SUPORT node by the time."""
    found = re.findall(r"displacements .* time +(\S+)\s+\d+ +(\S+) +(\S+)", path.read_text(encoding="ascii")) if path.exists() else []
    return {float(time): (float(x), float(y)) for time, x, y in found}


def contact_forces(path, text):
    """Forces on the slave nodes by the time: those that balance the stresses of the elements beside them."""
    cards = Cards(text)
    point, element = corners(cards)
    slave, found = cards.whole("BLSEG", 1)[0], {}
    for block in re.split(r"\n(?= stresses | displacements )", path.read_text(encoding="ascii")):
        if not block.startswith(" stresses"):
            continue
        head, *rows = block.strip().splitlines()
        of = found.setdefault(float(head.split()[-1]), {node: (0.0, 0.0) for node in slave})
        for words in (row.split() for row in rows if row.strip()):
            nodes = element[int(words[0])][1]
            xx, yy, xy = (float(words[k]) / 2 for k in (2, 3, 5))   # two equal points
            for k, node in enumerate(nodes):
                if node in of:
                    (ax, ay), (bx, by) = point[nodes[k - 2]], point[nodes[k - 1]]
                    gx, gy = (ay - by) / 2, (bx - ax) / 2
                    of[node] = of[node][0] + gx * xx + gy * xy, of[node][1] + gy * yy + gx * xy
    return found
