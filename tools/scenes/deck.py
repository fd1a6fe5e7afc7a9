"""Cards of a deck: numbers in fields, and the order of cards."""
import textwrap

from cards import written

from .mesh import corners_of, first_free

#: Young's modulus, N/mm2.
STEEL = 210000.0


def long(value):
    """A real in at most 16 characters, with nine digits or more."""
    if abs(value) < 1e-15:
        return "0.0"
    text = f"{value:.11f}" if 1e-3 <= abs(value) < 1e3 else f"{value:.9E}"
    return text if len(text) <= 16 else f"{value:.9E}"


class Deck:
    """Cards of a deck in the order of the calls; `write` adds head and tail. `words`: paragraphs."""

    def __init__(self, title, words, units="N-MM", strain=True, from_geometry=True, rings=False, load_steps=None):
        self.title, self.words, self.lines, self.rings, self.load_steps = title, words, [], rings, load_steps
        self.cases = []
        if load_steps:
            self.card("NLPARM", "1", str(load_steps))
        self.card("PARAM", "UNITS", units)
        if not rings:
            self.card("PARAM", "PLANE", "STRAIN" if strain else "STRESS")
        if from_geometry:
            self.card("PARAM", "GAPGEOM", "YES")

    def card(self, name, *fields):
        fields = [written(f, 8) if isinstance(f, float) else str(f) for f in fields]
        for i in range(0, max(len(fields), 1), 8):
            line = (name if i == 0 else "").ljust(8) + "".join(f.ljust(8) for f in fields[i:i + 8])
            self.lines.append(line.rstrip())

    def wide(self, name, *fields):
        """A card in large field, for reals with more than eight characters."""
        cells = [str(f) if not isinstance(f, float) else written(f, 8) if f == int(f) else long(f) for f in fields]
        for i in range(0, len(cells), 4):
            line = (name + "*" if i == 0 else "*").ljust(8) + "".join(cell.ljust(16) for cell in cells[i:i + 4])
            self.lines.append(line.rstrip())

    def remark(self, text):
        self.lines.append(f"$ {text}")

    def grid(self, node, x, y):
        self.lines.append("GRID*".ljust(8) + str(node).ljust(32) + long(x).ljust(16) + long(y))
        self.lines.append("*".ljust(8) + "0.0")

    def bodies(self, *named):
        """Add bodies (name, mesh); return the number of the first node of each."""
        free = first_free(*(mesh for _, mesh in named))
        for k, (name, mesh) in enumerate(named):
            self.remark(name)
            self.body(mesh, k + 1, k * free + 1)
        return [k * free + 1 for k in range(len(named))]

    def body(self, mesh, prop, first=1):
        """Nodes and elements, numbered from the first ones."""
        for i, (x, y) in enumerate(mesh.point):
            self.grid(first + i, x, y)
        for k, nodes in enumerate(mesh.element):
            nodes = [first + n for n in nodes]
            if self.rings and len(nodes) == 6:  # CTRAX6 lists its nodes in order around the element
                nodes = [nodes[i] for i in (0, 3, 1, 4, 2, 5)]
            name = {3: "CTRAX3", 6: "CTRAX6"} if self.rings else {3: "CTRIA3", 4: "CQUAD4", 6: "CTRIA6", 8: "CQUAD8"}
            self.card(name[len(nodes)], first + k, prop, *nodes)

    def material(self, number, young, nu, thickness=1.0, density=None):
        if self.rings:
            self.card("PSOLID", number, number)
        else:
            self.card("PSHELL", number, number, thickness)
        self.card("MAT1", number, young, "", nu, *([] if density is None else [density]))

    def steel(self, count):
        """Add a number of such bodies."""
        for number in range(1, count + 1):
            self.material(number, STEEL, 0.3)

    def contacts(self, *lines):
        """Boundary lines, each (nodes, number of the first): a slave, its master, the next slave, ..."""
        for number, line in enumerate(lines, 1):
            self.segments(number, *line)
        for k in range(len(lines) // 2):
            self.touches(k + 1, 2 * k + 1, 2 * k + 2)

    def segments(self, number, nodes, first=1):
        """A boundary line, from end to end."""
        self.card("BLSEG", number, *(first + n for n in nodes))

    def touches(self, number, slave, master):
        """Let the nodes of one boundary line touch the edges of another."""
        self.card("BCONP", number, slave, master)

    def rubs(self, number, coefficient):
        """Give a contact of lines friction."""
        place = next(k for k, line in enumerate(self.lines) if line.startswith(f"BCONP   {number} "))
        self.lines[place] = self.lines[place].ljust(48) + str(number)
        self.card("BFRIC", number, "", "", coefficient)

    def yields(self, number, stress, hardening):
        """Bilinear: stress over plastic strain above the yield stress."""
        self.wide("MATS1", number, "", "PLASTIC", hardening, 1, 1, stress)

    def follows(self, number, curve):
        """A curve of points of strain and stress, beginning with the origin and the yield point."""
        self.card("MATS1", number, number, "PLASTIC", "", 1, 1, curve[1][1])
        numbers = [written(value, 8) for point in curve for value in point] + ["ENDT"]
        self.card("TABLES1", number, *[""] * 7, *numbers)

    def push(self, node, load, way=-1.0):
        """A force along y, and the approach in its direction."""
        self.card("SUPORT", node, 2)
        self.card("FORCE", 1, node, 0, load, 0.0, way, 0.0)

    def press(self, mesh, line, value, first=1, theta=0.0, case=1):
        """Pressure on the edges between the corners of a line."""
        corners = {n for nodes in mesh.element for n in nodes[:corners_of(nodes)]}
        line = [n for n in line if n in corners]
        for a, b in zip(line, line[1:]):
            element = mesh.side(a, b)
            self.card("PLOADX1", case, first + element, value, value, first + a, first + b, *([theta] if theta else []))

    def sequence(self, *parts):
        """Load cases in sequence, each (title, factor of the loads, number of increments)."""
        for case, (title, part, increments) in enumerate(parts, 1):
            self.load_case(title, case + 10, case)
            self.card("LOAD", case + 10, 1.0, part, 1)
            self.card("NLPARM", case, increments)

    def load_case(self, title, loads, increments=None):
        """A further load case: the numbers of its loads and of its NLPARM."""
        self.cases += [f"SUBCASE {1 + sum(line.startswith('SUBCASE') for line in self.cases)}", f"  SUBTITLE = {title}", f"  LOAD = {loads}"]
        self.cases += [f"  NLPARM = {increments}"] if increments else []

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

    def pairs(self, first, ends, gap_property, frame=1, gap=0.0, friction=None):
        for i, (a, b) in enumerate(ends):
            self.card("CGAP", first + i, gap_property, a, b, "", "", "", frame)
        self.card("PGAP", gap_property, gap, *(["", "", "", "", friction] if friction else []))

    def text(self):
        head = [f"$ {line}".rstrip() for words in self.words for line in textwrap.wrap(words, 76) or [""]]
        head += ["SOL 106", "CEND", f"TITLE = {self.title}", "SPC = 1"]
        head += self.cases or ["LOAD = 1"] * any(line.startswith(("FORCE", "PLOADX1", "GRAV", "RFORCE")) for line in self.lines)
        head += ["NLPARM = 1"] if self.load_steps else []
        head.append("BEGIN BULK")
        return "\n".join(head + self.lines + ["ENDDATA", ""])

    def measured(self, text):
        """epcont's results for this mesh; no line without a text."""
        if text:
            self.words.append("epcont on this mesh: " + text)
        return self

    def write(self, path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(self.text(), encoding="ascii")
        print(f"{path}: {sum(line.startswith('GRID') for line in self.lines)} nodes, "
              f"{sum(line.startswith(('CTRIA', 'CQUAD', 'CTRAX')) for line in self.lines)} elements")
