"""The scene as its TOML file has it, checked as far as that goes without the mesh."""
import re
from dataclasses import dataclass, field

from .faults import Faults, Rejected, likely, listed

try:
    import tomllib
except ImportError:   # Python before 3.11; tools/requirements.txt
    import tomli as tomllib

KINDS = {"plane strain": "STRAIN", "plane stress": "STRESS", "ring": None}
TABLES = ["material", "body", "support", "load", "platen", "free", "contact", "case", "PARAM"]
DIRECTIONS = {"x": "1", "y": "2", "xy": "12"}
#: What `epcont --cards PARAM` lists, but for what the scene says otherwise (PLANE, UNITS) or has no use for (GAPGEOM).
PARAMETERS = {"RULE": str, "METHOD": str, "MUP": str, "SOLVER": str, "TOL": float, "SEARCH": float, "CORNER": float, "ACCURACY": float,
              "MAXIT": int, "NLOAD": int, "THEORY": str, "FLEXIB": str, "ORIGINAL": str, "WTMASS": float}
#: N/mm2 of one unit of stress, for those whose moduli can be told to be wrong.
STRESS_UNITS = {"N-MM": 1.0, "MPA": 1.0, "N-M": 1e-6, "SI": 1e-6, "KN-M": 1e-3, "KN-MM": 1e3, "KGF-MM": 9.80665}
SOFTEST, STIFFEST = 1e-3, 2e6   # N/mm2: softer than gels, stiffer than diamond


@dataclass
class Material:
    young: float
    poisson: float
    stress: float = None   # of first yield; None: elastic
    hardening: float = 0.0
    curve: list = None
    density: float = None
    expansion: float = None   # strain by one degree
    reference: float = None   # temperature without thermal strain


@dataclass
class Case:
    """What acts in a load case."""
    where: str = ""                                 # its table; of the scene's own none
    inside: str = ""                                # what stands before the names of tables in it
    title: str = ""
    gravity: tuple = None                           # acceleration of all mass
    spin: float = None                              # turns in a unit of time
    temperature: object = None                      # of all, or {surface: temperature}
    loads: dict = field(default_factory=dict)       # line or point: {"pressure": p, "force": (x, y)}
    factor: float = 1.0                             # of these loads
    moved: dict = field(default_factory=dict)       # line or point: {"1": value}, of what the scene holds there
    contact: bool = True

    @property
    def has_loads(self):
        return bool(self.gravity or self.spin or self.moved or self.loads and self.factor)


@dataclass
class Scene:
    title: str = ""
    mesh: str = ""
    kind: str = ""
    units: str = ""
    materials: dict = field(default_factory=dict)
    bodies: dict = field(default_factory=dict)      # surface: (material, thickness)
    supports: dict = field(default_factory=dict)    # line or point: {"1": value}
    axis: list = None                               # where spins have theirs; None: the origin
    cases: list = field(default_factory=list)       # the scene's own one, or those of its [[case]] tables
    platens: dict = field(default_factory=dict)     # line: directions
    free: dict = field(default_factory=dict)        # platen or point: directions
    contacts: list = field(default_factory=list)    # (slave, master)
    parameters: dict = field(default_factory=dict)

    @property
    def rings(self):
        return self.kind == "ring"

    @property
    def spins(self):
        return any(case.spin for case in self.cases)

    @property
    def has_weight(self):
        return self.spins or any(case.gravity for case in self.cases)


class Table:
    """A table of the file, whose keys are taken one by one; what is left over at the end is not known."""

    def __init__(self, table, name, faults):
        self.name, self.faults = name, faults
        self.left = table if isinstance(table, dict) else {}
        self.known = []
        if not isinstance(table, dict):
            faults.add(name, f"is {said(table)}", f"a table: {name}, and its keys below it")

    def where(self, key):
        return f"{self.name} {key}".strip()

    def take(self, key, right="", required=False):
        self.known.append(key)
        if key not in self.left and required:
            self.faults.add(self.where(key), "is missing", right)
        value = self.left.get(key)
        self.left = {k: v for k, v in self.left.items() if k != key}
        return value

    def number(self, key, example, meaning, fits=lambda value: True, required=False):
        right = f"{meaning}, such as {key} = {example}"
        value = self.take(key, right, required)
        if value is None:
            return None
        number = real(value)
        if number is None or not fits(number):
            self.faults.add(self.where(key), f"is {said(value)}", right)
            return None
        return number

    def word(self, key, example, meaning, fits=lambda word: True, required=False):
        right = f'{meaning}, such as {key} = "{example}"'
        value = self.take(key, right, required)
        if value is None:
            return None
        if not isinstance(value, str) or not value.strip() or not fits(value):
            self.faults.add(self.where(key), f"is {said(value)}", right)
            return None
        return value

    def end(self):
        for key in self.left:
            self.faults.add(self.where(key), "is no key here", f"one of: {listed(self.known)}{likely(key, self.known)}")


def said(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'the text "{value}"'
    return {dict: "a table", list: "a list"}.get(type(value), str(value))


def real(value):
    """A number that is one; None where it is not."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return float(value) if value == 0.0 or 1e-30 <= abs(value) <= 1e30 else None


def positive(value):
    return value > 0.0


def text_of(path):
    return path.read_text(encoding="utf-8-sig")


def bare_point(text):
    """Line and number of the first that begins or ends with its point, as decks have them and TOML does not; None."""
    found = re.search(r"^[^#\"'\n]*?[=,\[][ \t]*([-+]?(?:\d+\.(?!\d)|\.\d+)(?:[eE][-+]?\d+)?)", text, re.MULTILINE)
    return found and (text.count("\n", 0, found.start(1)) + 1, found[1])


def load(path, faults):
    """The tables of the file."""
    try:
        return tomllib.loads(text_of(path))
    except FileNotFoundError:
        faults.add("scene", "there is no such file", f"TOML files beside it: {listed(sorted(p.name for p in path.parent.glob('*.toml')))}")
    except (OSError, UnicodeDecodeError) as error:
        faults.add("scene", f"cannot be read: {error}", "a file of text in UTF-8")
    except (ValueError, RecursionError) as error:   # TOMLDecodeError, or a number or a nesting beyond all measure
        bare = bare_point(text_of(path))
        if bare:
            whole = re.sub(r"\.(?!\d)", ".0", re.sub(r"(?<!\d)\.", "0.", bare[1]))
            faults.add(f"line {bare[0]}", f"is no TOML: {bare[1]}", f"digits on both sides of the point: {whole}")
            raise Rejected from error
        match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", str(error), re.DOTALL)
        place = f"line {match[2]}, column {match[3]}" if match and match[2] else "end of the file"
        faults.add(place, f"is no TOML: {match[1] if match else error}",
                   'key = 1.5, key = "text" or [table]; a name with blanks or dots in quotes; a key once only')
    raise Rejected


def read_scene(path, faults: Faults):
    whole = load(path, faults)
    scene = Scene()
    top = Table(whole, "", faults)
    tables = {name: top.take(name) for name in TABLES}
    scene.mesh = top.word("mesh", path.stem + ".geo", "a file of Gmsh, .geo or .msh", str.isprintable, required=True)
    scene.kind = top.word("kind", "plane strain", f"one of: {listed(KINDS)}", KINDS.__contains__, required=True)
    scene.title = top.word("title", "Two cylinders", "a line of text", str.isprintable) or path.stem
    scene.units = top.word("units", "N-MM", "a word of at most 8 characters, first a letter; nothing is converted",
                           lambda word: re.fullmatch(r"[A-Za-z][!-+\--~]{0,7}", word))
    own = Case(title=scene.title)
    read_actions(top, own, faults)
    scene.axis = read_pair(top, "axis", "x and y of the axis of the spin", "[0.0, -250.0]", faults)
    top.end()
    scene.cases = read_cases(tables["case"], own, faults)
    check_body_loads(scene, faults)
    read_materials(Table(tables["material"] or {}, "[material]", faults), scene, faults)
    read_bodies(Table(tables["body"] or {}, "[body]", faults), scene, faults)
    read_supports(Table(tables["support"] or {}, "[support]", faults), scene, faults)
    own.loads.update(read_loads(Table(tables["load"] or {}, "[load]", faults), faults))
    for name, into, what in (("platen", scene.platens, "directions in which the line moves as one"),
                             ("free", scene.free, "directions of free motion")):
        table = Table(tables[name] or {}, f"[{name}]", faults)
        for key in list(table.left):
            into[key] = DIRECTIONS.get(table.word(key, "y", f"{what}: x, y or xy", DIRECTIONS.__contains__), "")
    read_contacts(tables["contact"] or [], scene, faults)
    read_parameters(Table(tables["PARAM"] or {}, "[PARAM]", faults), scene, faults)
    if not (scene.mesh and scene.kind):
        raise Rejected
    faults.go_on()
    return scene


def each(table, faults):
    """The tables in a table."""
    return [(key, Table(value, f"{table.name[:-1]}.{key}]", faults)) for key, value in table.left.items()]


def read_materials(table, scene, faults):
    for name, own in each(table, faults):
        young = own.number("E", "210000.0", "Young's modulus, above zero", positive, required=True)
        poisson = own.number("NU", "0.3", "Poisson's ratio, from 0 to below 0.5", lambda value: 0.0 <= value < 0.5, required=True)
        stress = own.number("yield", "240.0", "the stress of first yield, above zero", positive)
        hardening = own.number("H", "4000.0", "stress over plastic strain, from 0 on", lambda value: value >= 0.0)
        curve = own.take("curve")
        density = own.number("density", "7.85e-9", "mass of a unit of volume, above zero", positive)
        expansion = own.number("expansion", "1.2e-5", "strain by one degree")
        reference = own.number("reference", "20.0", "the temperature without thermal strain")
        own.end()
        if density is None and scene.has_weight:
            faults.add(own.where("density"), "is missing", "mass of a unit of volume, since gravity and spin act on it, such as density = 7.85e-9")
        if expansion is None and any(case.temperature is not None for case in scene.cases):
            faults.add(own.where("expansion"), "is missing", "strain by one degree, since there are temperatures, such as expansion = 1.2e-5; 0.0: none")
        if hardening is not None and stress is None:
            faults.add(own.where("H"), "is hardening without a yield stress", "yield = 240.0 beside it")
        if curve is not None:
            curve = read_curve(curve, own, young, faults)
            if stress is not None or hardening is not None:
                faults.add(own.where("curve"), "stands beside yield or H", "either yield and H, or a curve, whose first point is the yield point")
            stress = curve[0][1] if curve else None
        check_units(own, young, stress, scene, faults)
        scene.materials[name] = Material(young, poisson, stress, hardening or 0.0, curve, density, expansion, reference)


def read_curve(curve, own, young, faults):
    """Points of strain and stress, the first of them at the end of the elastic line."""
    right = "points of total strain and stress, the yield point first: curve = [[0.00114286, 240.0], [0.01, 260.0]]"
    points = [[real(value) for value in point] if isinstance(point, list) else [] for point in curve] if isinstance(curve, list) else []
    points = points[1:] if points[:1] == [[0.0, 0.0]] else points
    if not points or any(len(point) != 2 or None in point for point in points):
        faults.add(own.where("curve"), "is no list of points", right)
        return None
    for (strain, stress), (further, more) in zip([[0.0, 0.0]] + points, points):
        if further <= strain or more < stress or more <= 0.0:
            faults.add(own.where("curve"), f"does not rise at the point [{further:g}, {more:g}]", right)
            return None
    if young and abs(points[0][0] - points[0][1] / young) > 0.01 * points[0][0]:
        faults.add(own.where("curve"), f"its first point, [{points[0][0]:g}, {points[0][1]:g}], is not on the elastic line",
                   f"strain {points[0][1] / young:.6g}, which is {points[0][1]:g} over E")
        return None
    return points


def check_units(own, young, stress, scene, faults):
    """Numbers that were meant in other units."""
    if young and stress and stress > 0.1 * young:
        faults.note(own.where("yield"), f"{stress:g} is more than a tenth of E = {young:g}; are both in the same unit?")
    unit = STRESS_UNITS.get((scene.units or "").upper())
    if unit and young and not SOFTEST <= young * unit <= STIFFEST:
        faults.note(own.where("E"), f"{young:g} is no modulus of a solid in units {scene.units}: steel is {2.1e5 / unit:g} there")


def read_bodies(table, scene, faults):
    if not table.left:
        faults.add("[body]", "is missing", 'a table for each surface: [body.NAME], and below it material = "..."')
    for name, own in each(table, faults):
        material = own.word("material", next(iter(scene.materials), "steel"), "the name of a material", required=True)
        thickness = own.number("thickness", "1.0", "a length above zero", positive)
        own.end()
        if scene.rings and thickness is not None:
            faults.add(own.where("thickness"), "has no meaning in a ring", "no thickness: loads and forces are those of the whole ring")
        if material is not None and material not in scene.materials:
            faults.add(own.where("material"), f"there is no material '{material}'",
                       f"one of: {listed(scene.materials)}{likely(material, scene.materials)}; or a table [material.{material}]")
        scene.bodies[name] = (material, thickness or 1.0)
    for name in scene.materials:
        if name not in [material for material, _ in scene.bodies.values()]:
            faults.note(f"[material.{name}]", "no body is made of it")


def read_supports(table, scene, faults):
    scene.supports.update(read_displacements(table, "0 holds", faults))


def read_displacements(table, meaning, faults):
    found = {}
    for name, own in each(table, faults):
        empty = table.left[name] == {}
        values = {digit: own.number(key, "0.0", f"a displacement; {meaning}") for key, digit in (("x", "1"), ("y", "2"))}
        own.end()
        found[name] = {digit: value for digit, value in values.items() if value is not None}
        if empty:
            faults.add(own.name, "holds nothing", "x = 0 or y = 0, or both")
    return found


def read_loads(table, faults):
    loads = {}
    for name, own in each(table, faults):
        found = {"pressure": own.number("pressure", "10.0", "force on an area, positive into the body")}
        named = "force" in own.left
        found["force"] = read_pair(own, "force", "the total in x and y", "[0.0, -100.0]", faults)
        own.end()
        loads[name] = {key: value for key, value in found.items() if value is not None}
        if not loads[name] and not own.left and not named:
            faults.add(own.name, "loads nothing", "pressure = 10.0 or force = [0.0, -100.0]")
    return loads


def read_actions(table, case, faults):
    """What acts on all bodies; a case has what it does not say from the scene."""
    given = table.left.keys()
    if "gravity" in given:
        case.gravity = read_pair(table, "gravity", "an acceleration in x and y", "[0.0, -9810.0]", faults)
    if "spin" in given:
        case.spin = table.number("spin", "120.0", "turns in a unit of time")
    if isinstance(table.left.get("temperature"), dict):
        bodies = Table(table.take("temperature"), f"[{case.inside}temperature]", faults)
        case.temperature = {name: bodies.number(name, "80.0", "the temperature of a body") for name in list(bodies.left)}
    elif "temperature" in given:
        case.temperature = table.number("temperature", "80.0", "the temperature of all bodies, or a table: temperature.BODY = 80.0")
    table.known += [key for key in ("gravity", "spin", "temperature") if key not in table.known]


def read_cases(tables, own, faults):
    """The load cases; without [[case]] the scene's own."""
    if tables is None:
        return [own]
    cases = []
    for k, given in enumerate(tables if isinstance(tables, list) else [tables], 1):
        where = f"[[case]] {k}"
        table = Table(given, where, faults)
        case = Case(where, f"case.{k}.", f"case {k}", own.gravity, own.spin, own.temperature, own.loads)
        case.title = table.word("title", f"case {k}", "a line of text", str.isprintable) or case.title
        read_actions(table, case, faults)
        case.factor = table.number("factor", "0.5", "a factor of the loads")
        case.factor = 1.0 if case.factor is None else case.factor
        contact = table.take("contact")
        if contact is not None and not isinstance(contact, bool):
            faults.add(table.where("contact"), f"is {said(contact)}", "contact = false, where nothing touches anything")
        case.contact = contact is not False
        loads, moved = table.take("load"), table.take("support")
        if loads is not None:
            case.loads = read_loads(Table(loads, f"[{case.inside}load]", faults), faults)
        if moved is not None:
            case.moved = read_displacements(Table(moved, f"[{case.inside}support]", faults), "of what [support] holds", faults)
        table.end()
        cases.append(case)
    return cases


def check_body_loads(scene, faults):
    """Rings bear nothing across their axis, and spin about it."""
    for case in scene.cases:
        if scene.rings and case.gravity and case.gravity[0] != 0.0:
            faults.add(f"{case.where} gravity".strip(), f"acts across the axis of rings: {case.gravity[0]:g} in x", "0.0 in x")
    if scene.axis and (scene.rings or all(case.spin is None for case in scene.cases)):
        faults.add("axis", "has no meaning here", "no axis: rings spin about their own" if scene.rings else "spin = 120.0 beside it, or no axis")


def read_pair(table, key, meaning, example, faults):
    """Two numbers."""
    given = table.take(key)
    values = [real(value) for value in given] if isinstance(given, list) else []
    if given is not None and (len(values) != 2 or None in values):
        faults.add(table.where(key), f"is {said(given)}", f"{meaning}, such as {key} = {example}")
        return None
    return values or None


def read_contacts(tables, scene, faults):
    tables = tables if isinstance(tables, list) else [tables]
    for k, table in enumerate(tables, 1):
        own = Table(table, f"[[contact]] {k}" if len(tables) > 1 else "[[contact]]", faults)
        slave = own.word("slave", "pin", "the name of a line, the one of the coarser mesh", required=True)
        master = own.word("master", "hole", "the name of a line", required=True)
        own.end()
        if slave is not None and slave == master:
            faults.add(own.where("master"), f"'{master}' is the slave, too", "the line on the other side of the contact")
        scene.contacts.append((slave, master))


def read_parameters(table, scene, faults):
    for name in list(table.left):
        kind = PARAMETERS.get(name)
        if kind is None:
            continue
        value = table.left[name]
        fits = {str: isinstance(value, str) and value.isalnum() and len(value) <= 8, float: real(value) is not None,
                int: isinstance(value, int) and not isinstance(value, bool) and value > 0}[kind]
        if not fits:
            right = {str: "a word in quotes", float: "a real number", int: "a whole number above zero"}[kind]
            faults.add(table.where(name), f"is {said(value)}", f"{right}; epcont --cards PARAM says which")
        scene.parameters[name] = float(value) if fits and kind is float else value
    table.left = {name: value for name, value in table.left.items() if name not in PARAMETERS}
    table.known = list(PARAMETERS)
    for name, instead in (("PLANE", "kind"), ("UNITS", "units")):
        if table.left.pop(name, None) is not None:
            faults.add(table.where(name), "is said by the scene itself", f"{instead} = ... before the first table")
    table.end()
