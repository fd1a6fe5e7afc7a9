"""A reader of plane decks, independent of epcont's: small, large and free fields, INCLUDE, load cases.

It assumes a valid deck: anything unknown raises DeckError, without position or remedy.
"""
import math
import pathlib
import re
from dataclasses import dataclass, field

KNOWN = {"GRID", "CTRIA3", "CTRIA6", "CQUAD4", "CQUAD8", "CTRAX3", "CTRAX6", "PSHELL", "PSOLID", "MAT1", "SPC", "SPC1", "FORCE", "PLOADX1",
         "RBE2", "SUPORT", "CORD2R", "CGAP", "PGAP", "CBAR", "PARAM", "SPCADD", "LOAD", "MATS1", "TABLES1", "BLSEG", "BCONP", "SPCD", "TEMP",
         "TEMPD", "GRAV", "RFORCE", "MOMENT", "MPC", "MPCADD", "CELAS1", "CELAS2", "PELAS", "NLPARM", "BFRIC"}

#: Columns of the tables, by the quantity whose largest value is their scale.
KINDS = {"contact": {"force": ["force"], "length": ["initial_gap", "gap"], "pressure": ["pressure"], "normal": ["nx", "ny"],
                     "place": ["x", "y"]},
         "nodes": {"length": ["ux", "uy"], "force": ["rx", "ry"], "place": ["x", "y"]},
         "elements": {"stress": ["sx", "sy", "sz", "txy", "equivalent_stress"], "strain": ["equivalent_strain"],
                      "modulus": ["secant_modulus"], "place": ["x", "y"]},
         "plastic": {"plastic strain": ["plastic_x", "plastic_y", "plastic_z", "plastic_xy", "accumulated"]},
         "friction": {"friction": ["friction_force", "limit"], "pressure": ["shear"], "slip": ["slip", "slid"], "coefficient": ["friction"]},
         "increments": {"force": ["total_contact_force"], "friction": ["friction_force"], "pressure": ["max_pressure"], "part": ["load_factor"]}}

LONGEST = 1000000   # range of ids
SEQUENTIAL = "66", "106", "NLSTATIC"   # values of SOL whose SUBCASEs follow each other


class DeckError(Exception):
    pass


@dataclass
class Deck:
    """`case`: statements of case control of one load case; `cases`: of all, if there are several."""
    case: dict = field(default_factory=dict)
    cards: list = field(default_factory=list)
    cases: list = field(default_factory=list)

    def of(self, name):
        return [card for card in self.cards if card[0] == name]

    def by_case(self):
        """One deck for each load case, with its contacts."""
        for case in self.cases or [self.case]:
            contact = case.get("BCON", "ALL")
            keep = [card for card in self.cards
                    if contact == "ALL" or card[0] not in ("CGAP", "BCONP") or card[0] == "BCONP" and card[1] == str(contact)]
            yield Deck(case, keep, self.cases)

    @property
    def number(self):
        """Number of the load case; None if there is only one."""
        return self.case.get("SUBCASE") if self.case.get("several") else None

    def loads(self):
        """Factors of the sets of loads, by their ids."""
        sets = [int(card[1]) for name in ("FORCE", "PLOADX1", "SPCD", "GRAV", "RFORCE", "MOMENT", "LOAD") for card in self.of(name)]
        chosen = self.case.get("LOAD", 0 if "several" in self.case else next(iter(sets), 0))
        if not chosen and len(set(sets)) > 1 and "several" not in self.case:
            raise DeckError("several sets of loads and no choice")
        factors = {}
        for card in self.of("LOAD"):
            if int(card[1]) == chosen:
                for i in range(3, len(card) - 1, 2):
                    if card[i]:
                        factors[int(card[i + 1])] = factors.get(int(card[i + 1]), 0.0) + real(card[2]) * real(card[i])
        return factors or {chosen: 1.0}

    @property
    def is_sequence(self):
        """Does each load case start from the end of the one before?"""
        return bool(self.case.get("sequence"))

    @property
    def is_flow(self):
        """Is plasticity flow theory?"""
        parameter, cards = {card[1]: card[2] for card in self.of("PARAM")}, self.of("MATS1")
        if not cards or parameter.get("ORIGINAL") == "YES":
            return False
        remembers = self.is_sequence and any(at(card, 3) == "PLASTIC" for card in cards)
        theory = parameter.get("THEORY", "FLOW" if remembers or any(integer(at(card, 6), 1) > 1 for card in cards) else "TOTAL")
        return theory == "FLOW"

    def friction(self, card):
        """Coefficient of friction of a CGAP or BCONP."""
        name, column, chosen = ("PGAP", 7, at(card, 2) or card[1]) if card[0] == "CGAP" else ("BFRIC", 4, at(card, 6))
        if not chosen or any(other[1:3] == ["FRICTION", "NO"] for other in self.of("PARAM")):
            return 0.0
        return next(real(at(other, column)) for other in self.of(name) if other[1] == chosen)

    @property
    def by_increments(self):
        """Do increments follow each other: with flow theory, or with friction if nothing yields?"""
        return self.is_flow or not self.of("MATS1") and any(self.friction(card) for card in self.of("CGAP") + self.of("BCONP"))

    def increments(self):
        """Their number in this load case: NINC of its NLPARM, or PARAM NLOAD; and EPSU."""
        by_id = {int(card[1]): (integer(at(card, 2), 1), real(at(card, 9))) for card in self.of("NLPARM")}
        parameter = {card[1]: card[2] for card in self.of("PARAM")}
        return by_id.get(self.case.get("NLPARM"), (integer(parameter.get("NLOAD", ""), 1), 0.0))

    def hardening(self):
        """By MAT1: kinematic part of the hardening, and whether plastic strain remains after unloading."""
        fraction = next((real(card[2]) for card in self.of("PARAM") if card[1] == "HRFRAC"), 1.0)
        return {int(card[1]): ({1: 0.0, 2: 1.0, 3: fraction}[integer(at(card, 6), 1)], at(card, 3) != "NLELAST") for card in self.of("MATS1")}

    def supports(self):
        """The set of supports."""
        sets = {int(card[1]): None for card in self.of("SPC") + self.of("SPC1")}
        if not self.case.get("any SPC", "SPC" in self.case) and len(sets) > 1:
            raise DeckError("several sets of supports and no choice")
        return self.case.get("SPC", 0 if self.case.get("any SPC") else next(iter(sets), 0))

    def moduli(self):
        """(E, nu) by MAT1."""
        found = {}
        for card in self.of("MAT1"):
            e, g, nu = (real(text, None) for text in card[2:5])
            e = 2 * g * (1 + nu) if e is None else e
            found[int(card[1])] = (e, e / (2 * g) - 1 if nu is None else nu)
        return found

    def expansions(self):
        """(A, TREF) by MAT1."""
        return {int(card[1]): (real(at(card, 6)), real(at(card, 7))) for card in self.of("MAT1")}

    def temperatures(self):
        """Temperatures of the nodes, as a function; None if the deck chooses no set."""
        if "TEMP" not in self.case:
            return None
        chosen = self.case["TEMP"]
        others = {int(card[i]): real(card[i + 1]) for card in self.of("TEMPD") for i in (1, 3, 5, 7) if at(card, i)}.get(chosen, 0.0)
        known = {int(card[i]): real(card[i + 1]) for card in self.of("TEMP") if int(card[1]) == chosen for i in (2, 4, 6) if at(card, i)}
        return lambda node: known.get(node, others)

    def curves(self, moduli):
        """Points (strain, stress) of the uniaxial curves, by MAT1; the yield strain of a table is its yield stress over E."""
        tables = {int(card[1]): [real(text) for text in card[9:card.index("ENDT")]] for card in self.of("TABLES1")}
        found = {}
        for card in self.of("MATS1"):
            young = moduli[int(card[1])][0]
            if at(card, 2):
                numbers = tables[int(card[2])]
                points = list(zip(numbers[0::2], numbers[1::2]))
                points[1] = (points[1][1] / young, points[1][1])
            else:
                limit, slope = real(card[7]), real(at(card, 4))
                points = [(0.0, 0.0), (limit / young, limit), (2 * limit / young, limit + limit * slope / (young + slope))]
            found[int(card[1])] = points
        return found

    def densities(self):
        """By section: WTMASS times RHO and NSM over the thickness."""
        rho = {int(card[1]): real(at(card, 5)) for card in self.of("MAT1")}
        factor = next((real(card[2]) for card in self.of("PARAM") if card[1] == "WTMASS"), 1.0)
        found = {int(card[1]): factor * rho[int(card[2])] for card in self.of("PSOLID")}
        for card in self.of("PSHELL"):
            found[int(card[1])] = factor * (rho[int(card[2])] + real(at(card, 8)) / real(card[3]))
        return found

    def body_loads(self, chosen, x):
        """(acceleration, centre, revolutions, angular acceleration) of the GRAV and RFORCE of the set; `x`: coordinates by id."""
        found = [([real(card[3]) * real(at(card, i)) for i in (4, 5)], (0.0, 0.0), 0.0, 0.0)
                 for card in self.of("GRAV") if int(card[1]) == chosen]
        for card in self.of("RFORCE"):
            if int(card[1]) == chosen:
                axis = real(at(card, 6)) or real(at(card, 7))   # y if axisymmetric, else z
                found.append(((0.0, 0.0), x(integer(card[2])) if integer(card[2]) else (0.0, 0.0),
                              axis * real(at(card, 4)), axis * real(at(card, 9))))
        return found

    def rotating(self):
        """Master nodes of RBE2 that rotate: named by a SUPORT, a displacement or a MOMENT of a set that some load case uses."""
        cases = [Deck(case, self.cards) for case in self.cases or [self.case]]
        supports, loads = {case.supports() for case in cases}, {chosen for case in cases for chosen in case.loads()}
        named = {int(card[i]) for card in self.of("SUPORT") for i in range(1, len(card) - 1, 2) if "6" in card[i + 1]}
        for name, sets in (("SPC", supports), ("SPCD", loads)):
            named |= {int(card[i]) for card in self.of(name) for i in (2, 5) if int(card[1]) in sets and "6" in at(card, i + 1) and real(at(card, i + 2))}
        named |= {int(card[2]) for card in self.of("MOMENT") if int(card[1]) in loads}
        return [node for node in dict.fromkeys(int(card[2]) for card in self.of("RBE2")) if node in named]

    def moments(self):
        """Counter-clockwise, by master node."""
        found, factors = {}, self.loads()
        for card in [card for card in self.of("MOMENT") if int(card[1]) in factors]:
            moment = factors[int(card[1])] * real(card[4]) * real(at(card, 7))
            found[int(card[2])] = found.get(int(card[2]), 0.0) + moment
        return found

    def equations(self):
        """Terms ((node, component), coefficient) of each MPC of the case, the dependent one first."""
        sets = [int(card[1]) for name in ("MPC", "MPCADD") for card in self.of(name)]
        chosen = self.case.get("MPC", next(iter(sets), 0))
        used = {chosen} | {number for card in self.of("MPCADD") if int(card[1]) == chosen for number in ids(card[2:])}
        for card in self.of("MPC"):
            if int(card[1]) in used:   # two terms a line: fields 3 to 8, then 4 to 9 less the first
                items = [card[i:i + 3] for k in range(2, len(card), 8) for i in (k, k + 3) if at(card, i)]
                terms = [((int(node), int(digit) - 1), real(value)) for node, digit, value in items]
                yield terms[:1] + [term for term in terms[1:] if term[1]]

    def springs(self):
        """(id, stiffness, [its ends (node, component), None at the ground]) of each spring."""
        stiffness = {int(card[i]): real(card[i + 1]) for card in self.of("PELAS") for i in (1, 5) if at(card, i)}
        for card in self.of("CELAS1") + self.of("CELAS2"):
            ends = [(integer(at(card, i)), integer(at(card, i + 1)) - 1) for i in (3, 5)]
            value = stiffness[int(card[2])] if card[0] == "CELAS1" else real(card[2])
            yield int(card[1]), value, [end if end[0] else None for end in ends]

    def held(self):
        """(node, digits, value) of GRID, of the SPC1 and SPC of the case, and of its SPCDs, which replace these."""
        found, chosen, moved = [(int(card[1]), at(card, 8), 0.0) for card in self.of("GRID")], self.supports(), {}
        for card in self.of("SPC1") + self.of("SPC"):
            if int(card[1]) == chosen:
                found += ([(node, card[2], 0.0) for node in ids(card[3:])] if card[0] == "SPC1"
                          else [(int(card[i]), card[i + 1], real(at(card, i + 2))) for i in (2, 5) if at(card, i)])
        for card in self.of("SPCD"):
            factor = self.loads().get(int(card[1]))
            for node, digit, value in [(int(card[i]), digit, real(at(card, i + 2))) for i in (2, 5) if at(card, i) for digit in card[i + 1]]:
                if factor is not None:
                    moved[node, digit] = factor * value
        return found + [(node, digit, value) for (node, digit), value in moved.items()]

    def frames(self):
        """x-axes in the plane, by CORD2R; the basic system is 0."""
        return {0: (1.0, 0.0), **{int(card[1]): x_axis([real(at(card, i)) for i in range(3, 12)]) for card in self.of("CORD2R")}}


def lines_of(path, depth=0):
    """Lines without comments, INCLUDE files in place; ENDDATA of an included file ends that file only."""
    if depth > 8:
        raise DeckError(f"INCLUDE too deep at {path}")
    for line in pathlib.Path(path).read_bytes().decode("latin-1").split("\n"):
        line = line.split("$")[0].rstrip()
        if not line.strip():
            continue
        if line.strip().upper().startswith("INCLUDE"):
            name = line.strip()[7:].strip().strip("'\"")
            yield from lines_of(pathlib.Path(path).parent / name, depth + 1)
        elif line.strip().upper() == "ENDDATA":
            if depth == 0:
                yield "ENDDATA"
            return
        else:
            yield line.upper()


def fields_of(line):
    """(name field, data fields) of one line of bulk data."""
    if "," in line:
        parts = [part.strip() for part in line.split(",")]
        return parts[0], (parts[1:9] + [""] * 8)[:4 if parts[0].endswith("*") or parts[0].startswith("*") else 8]
    line = line.ljust(80)
    name = line[:8].strip()
    wide = 16 if "*" in name else 8
    return name, [line[i:i + wide].strip() for i in range(8, 72, wide)]


def read(path):
    deck = Deck()
    lines = list(lines_of(path))
    if "ENDDATA" not in lines:
        raise DeckError("no ENDDATA")
    lines = lines[:lines.index("ENDDATA")]
    begin = [i for i, line in enumerate(lines) if line.split()[:2] == ["BEGIN", "BULK"]]
    if begin:
        take_case_control(deck, lines[:begin[0]])
        lines = lines[begin[0] + 1:]
    for line in lines:
        name, data = fields_of(line)
        if name == "" or name[0] in "+*":
            deck.cards[-1].extend(data)
        else:
            deck.cards.append([name.rstrip("*").strip()] + data)
    for card in deck.cards:
        if card[0] not in KNOWN:
            raise DeckError(f"unknown card {card[0]}")
    return deck


def take_case_control(deck, lines):
    """Statements above the first SUBCASE apply to all."""
    now, follows = deck.case, {}
    for line in lines:
        order = re.match(r"\s*(SOL|CNTNLSUB)\b[\s=]*(\w*)", line)
        if order:
            follows[order[1]] = order[2]
        match = re.match(r"\s*(?:(SPC|LOAD|MPC|NLPARM)|(TEMP|BCON|SUBC)[A-Z]*)(?:\s*\(\s*(?:LOAD|BOTH)\s*\))?[\s=]\s*=?\s*(\d+)\s*$", line)
        off = re.match(r"\s*BCON[A-Z]*[\s=]\s*=?\s*(ALL|NONE)\s*$", line)
        if match and match[2] == "SUBC":
            now = dict(deck.case, SUBCASE=int(match[3]))
            deck.cases.append(now)
        elif match or off:
            now["BCON" if off else match[1] or match[2]] = off[1] if off else int(match[3])
    if len(deck.cases) > 1:
        for case in deck.cases:
            case["several"], case["any SPC"] = True, any("SPC" in other for other in deck.cases)
            case["sequence"] = follows["CNTNLSUB"] in ("", "YES") if "CNTNLSUB" in follows else follows.get("SOL") in SEQUENTIAL
    elif deck.cases:
        deck.case, deck.cases = deck.cases[0], []


def real(text, default=0.0):
    if text == "":
        return default
    match = re.fullmatch(r"([+-]?[\d.]+)(?:[ED]?([+-]?\d+))?", text)
    if not match:
        raise DeckError(f"not a real: {text}")
    return float(match[1] + "e" + (match[2] or "0"))


def x_axis(p):
    """x-axis of a frame with origin A, z-axis towards B and C in the xz plane, from their nine coordinates."""
    z = [p[3 + i] - p[i] for i in range(3)]
    length = math.hypot(*z)
    z = [v / length for v in z]
    c = [p[6 + i] - p[i] for i in range(3)]
    along = sum(c[i] * z[i] for i in range(3))
    x = [c[i] - along * z[i] for i in range(3)]
    length = math.hypot(*x)
    return x[0] / length, x[1] / length


def integer(text, default=0):
    return int(text) if text else default


def ids(items):
    """An open list of ids with THRU, which may fall, and BY."""
    items = [item for item in items if item]
    found, i = [], 0
    while i < len(items):
        if i + 2 < len(items) and items[i + 1] == "THRU":
            first, last, step = int(items[i]), int(items[i + 2]), 1
            i += 3
            if i + 1 < len(items) and items[i] == "BY":
                step = abs(int(items[i + 1]))
                i += 2
            if abs(last - first) > LONGEST:
                raise DeckError(f"{first} THRU {last} is too long")
            found += range(first, last + 1, step) if last >= first else range(first, last - 1, -step)
        else:
            found.append(int(items[i]))
            i += 1
    return found


def at(card, i):
    return card[i] if i < len(card) else ""
