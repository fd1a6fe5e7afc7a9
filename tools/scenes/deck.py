"""Cards of a deck: numbers in fields, and the cards in the order they are asked for."""
import textwrap


def short(value):
    """A real in at most 8 characters."""
    if value == int(value) and abs(value) < 1e6:
        return f"{int(value)}."
    for digits in range(8, 0, -1):
        text = f"{value:.{digits}g}"
        if "e" in text:
            mantissa, exponent = text.split("e")
            text = (mantissa if "." in mantissa else mantissa + ".") + f"{int(exponent):+d}"
        elif text.startswith("0."):
            text = text[1:]
        elif text.startswith("-0."):
            text = "-" + text[2:]
        elif "." not in text:
            text += "."
        if len(text) <= 8:
            return text
    raise ValueError(value)


def long(value):
    """A real in at most 16 characters, with nine digits or more."""
    if abs(value) < 1e-15:
        return "0.0"
    text = f"{value:.11f}" if 1e-3 <= abs(value) < 1e3 else f"{value:.9E}"
    return text if len(text) <= 16 else f"{value:.9E}"


class Deck:
    """Cards of a deck in the order they are asked for; `write` puts head and tail round them. `words`: paragraphs."""

    def __init__(self, title, words, units="N-MM", strain=True, from_geometry=True):
        self.title, self.words, self.lines = title, words, []
        self.card("PARAM", "UNITS", units)
        self.card("PARAM", "PLANE", "STRAIN" if strain else "STRESS")
        if from_geometry:
            self.card("PARAM", "GAPGEOM", "YES")

    def card(self, name, *fields):
        fields = [short(f) if isinstance(f, float) else str(f) for f in fields]
        for i in range(0, max(len(fields), 1), 8):
            line = (name if i == 0 else "").ljust(8) + "".join(f.ljust(8) for f in fields[i:i + 8])
            self.lines.append(line.rstrip())

    def wide(self, name, *fields):
        """A card in large field, for reals that eight characters would cut."""
        cells = [str(f) if not isinstance(f, float) else short(f) if f == int(f) else long(f) for f in fields]
        for i in range(0, len(cells), 4):
            line = (name + "*" if i == 0 else "*").ljust(8) + "".join(cell.ljust(16) for cell in cells[i:i + 4])
            self.lines.append(line.rstrip())

    def remark(self, text):
        self.lines.append(f"$ {text}")

    def grid(self, node, x, y):
        self.lines.append("GRID*".ljust(8) + str(node).ljust(32) + long(x).ljust(16) + long(y))
        self.lines.append("*".ljust(8) + "0.0")

    def nodes(self, mesh, first=1):
        for i, (x, y) in enumerate(mesh.point):
            self.grid(first + i, x, y)

    def triangles(self, mesh, prop, first=1, first_node=1):
        for k, corners in enumerate(mesh.triangle):
            self.card("CTRIA3", first + k, prop, *(first_node + c for c in corners))

    def material(self, number, young, nu, thickness=1.0):
        self.card("PSHELL", number, number, thickness)
        self.card("MAT1", number, young, "", nu)

    def yields(self, number, stress, hardening):
        """Bilinear: stress over plastic strain beyond the yield stress."""
        self.wide("MATS1", number, "", "PLASTIC", hardening, 1, 1, stress)

    def follows(self, number, curve):
        """A curve from points of strain and stress, the origin and the yield point first."""
        self.card("MATS1", number, number, "PLASTIC", "", 1, 1, curve[1][1])
        numbers = [short(value) for point in curve for value in point] + ["ENDT"]
        self.card("TABLES1", number, *[""] * 7, *numbers)

    def press(self, mesh, line, value, first=1, first_node=1, theta=0.0):
        """Pressure on the edges of a line of nodes."""
        for a, b in zip(line, line[1:]):
            element = next(k for k, c in enumerate(mesh.triangle) if a in c and b in c)
            self.card("PLOADX1", 1, first + element, value, value, first_node + a, first_node + b, *([theta] if theta else []))

    def hold(self, digits, nodes, first=1):
        nodes = sorted(first + n for n in nodes)
        for i in range(0, len(nodes), 6):
            self.card("SPC1", 1, digits, *nodes[i:i + 6])

    def ground(self, places, first):
        for i, (x, y) in enumerate(places):
            self.grid(first + i, x, y)
        if len(places) > 1:
            self.card("SPC1", 1, 12, first, "THRU", first + len(places) - 1)
        else:
            self.card("SPC1", 1, 12, first)

    def platen(self, number, digits, nodes, first=1):
        nodes = [first + n for n in nodes]
        self.card("RBE2", number, nodes[0], digits, *nodes[1:])

    def upward(self, number=1):
        """A frame whose x-axis is the deck's y."""
        self.card("CORD2R", number, 0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0)

    def pairs(self, first, ends, gap_property, frame=1, gap=0.0):
        for i, (a, b) in enumerate(ends):
            self.card("CGAP", first + i, gap_property, a, b, "", "", "", frame)
        self.card("PGAP", gap_property, gap)

    def text(self):
        head = [f"$ {line}".rstrip() for words in self.words for line in textwrap.wrap(words, 76) or [""]]
        head += ["SOL 106", "CEND", f"TITLE = {self.title}", "SPC = 1"]
        head += ["LOAD = 1"] if any(line.startswith(("FORCE", "PLOADX1")) for line in self.lines) else []
        head.append("BEGIN BULK")
        return "\n".join(head + self.lines + ["ENDDATA", ""])

    def measured(self, text):
        """What epcont gives for this very mesh; nothing is said without a text."""
        if text:
            self.words.append("epcont on this mesh: " + text)
        return self

    def write(self, path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(self.text(), encoding="ascii")
        print(f"{path}: {sum(line.startswith('GRID') for line in self.lines)} nodes, "
              f"{sum(line.startswith('CTRIA3') for line in self.lines)} triangles")
