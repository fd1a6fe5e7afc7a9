"""Read the model from its TOML file, and check it as far as possible without the mesh."""
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
#: The list of `epcont --cards PARAM`, without parameters that the model gives otherwise (PLANE, UNITS) or does not need (GAPGEOM).
PARAMETERS = {"RULE": str, "METHOD": str, "MUP": str, "SOLVER": str, "TOL": float, "SEARCH": float, "CORNER": float, "ACCURACY": float,
              "MAXIT": int, "NLOAD": int, "THEORY": str, "HRFRAC": float, "SAVE": str, "ORIGINAL": str, "WTMASS": float, "FRICTION": str}
#: N/mm2 of one unit of stress, for units whose moduli can be checked.
STRESS_UNITS = {"N-MM": 1.0, "MPA": 1.0, "N-M": 1e-6, "SI": 1e-6, "KN-M": 1e-3, "KN-MM": 1e3, "KGF-MM": 9.80665}
MOST_INCREMENTS = 10000   # of an NLPARM
SOFTEST, STIFFEST = 1e-3, 2e6   # N/mm2: softer than gels, stiffer than diamond


@dataclass
class Material:
    young: float
    poisson: float
    stress: float = None   # yield stress; None if elastic
    hardening: float = 0.0
    curve: list = None
    kinematic: float = 0.0    # kinematic part of the hardening; 0: isotropic
    density: float = None
    expansion: float = None   # thermal strain per degree
    reference: float = None   # temperature of zero thermal strain


@dataclass
class Case:
    """Loads of a load case."""
    where: str = ""                                 # its table; None for the model's own loads
    inside: str = ""                                # prefix of the names of its tables
    title: str = ""
    gravity: tuple = None                           # acceleration of all mass
    spin: float = None                              # rotations per unit of time
    temperature: object = None                      # of all, or {surface: temperature}
    loads: dict = field(default_factory=dict)       # line or point: {"pressure": p, "force": (x, y)}
    factor: float = 1.0                             # table of these loads
    moved: dict = field(default_factory=dict)       # line or point: {"1": value}, for displacements that the model fixes
    contact: bool = True
    increments: int = None                          # of its loads; None: as PARAM says

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
    axis: list = None                               # points of the axes of rotation; None: the origin
    cases: list = field(default_factory=list)       # the model's own one, or those of its [[case]] tables
    sequence: bool = False                          # each case starts from the end of the one before
    platens: dict = field(default_factory=dict)     # line: directions
    free: dict = field(default_factory=dict)        # platen or point: directions
    contacts: list = field(default_factory=list)    # (slave, master, coefficient of friction)
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
    """A table of the file, whose keys are taken one by one; the remaining ones are unknown."""

    def __init__(self, table, name, faults):
        self.name, self.faults = name, faults
        self.left = table if isinstance(table, dict) else {}
        self.known = []
        if not isinstance(table, dict):
            faults.add(name, f"is {said(table)}", f"make it a table: {name}, and its keys below it")

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
        right = f"give {meaning}, such as {key} = {example}"
        value = self.take(key, right, required)
        if value is None:
            return None
        number = real(value)
        if number is None or not fits(number):
            self.faults.add(self.where(key), f"is {said(value)}", right)
            return None
        return number

    def word(self, key, example, meaning, fits=lambda word: True, required=False):
        right = f'give {meaning}, such as {key} = "{example}"'
        value = self.take(key, right, required)
        if value is None:
            return None
        if not isinstance(value, str) or not value.strip() or not fits(value):
            self.faults.add(self.where(key), f"is {said(value)}", right)
            return None
        return value

    def end(self):
        for key in self.left:
            self.faults.add(self.where(key), "is not a key of this table", f"use one of: {listed(self.known)}{likely(key, self.known)}")


def said(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'the text "{value}"'
    return {dict: "a table", list: "a list"}.get(type(value), str(value))


def real(value):
    """A finite number, or None."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return float(value) if value == 0.0 or 1e-30 <= abs(value) <= 1e30 else None


def positive(value):
    return value > 0.0


def text_of(path):
    return path.read_text(encoding="utf-8-sig")


def bare_point(text):
    """Line and number of the first that begins or ends with its decimal point, as decks allow and TOML does not; None if all are valid."""
    found = re.search(r"^[^#\"'\n]*?[=,\[][ \t]*([-+]?(?:\d+\.(?!\d)|\.\d+)(?:[eE][-+]?\d+)?)", text, re.MULTILINE)
    return found and (text.count("\n", 0, found.start(1)) + 1, found[1])


def load(path, faults):
    """The tables of the file."""
    try:
        return tomllib.loads(text_of(path))
    except FileNotFoundError:
        faults.add("model file", "there is no such file", f"give one of the TOML files beside it: {listed(sorted(p.name for p in path.parent.glob('*.toml')))}")
    except (OSError, UnicodeDecodeError) as error:
        faults.add("model file", f"cannot be read: {error}", "save it as text in UTF-8")
    except (ValueError, RecursionError) as error:   # TOMLDecodeError, or an excessive number or nesting
        bare = bare_point(text_of(path))
        if bare:
            whole = re.sub(r"\.(?!\d)", ".0", re.sub(r"(?<!\d)\.", "0.", bare[1]))
            faults.add(f"line {bare[0]}", f"is not TOML: {bare[1]}", f"write digits on both sides of the point: {whole}")
            raise Rejected from error
        match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", str(error), re.DOTALL)
        place = f"line {match[2]}, column {match[3]}" if match and match[2] else "end of the file"
        faults.add(place, f"is not TOML: {match[1] if match else error}",
                   'write key = 1.5, key = "text" or [table]; quote names with blanks or dots; give each key only once')
    raise Rejected


def read_scene(path, faults: Faults):
    whole = load(path, faults)
    scene = Scene()
    top = Table(whole, "", faults)
    tables = {name: top.take(name) for name in TABLES}
    scene.mesh = top.word("mesh", path.stem + ".geo", "a file of Gmsh, .geo or .msh", str.isprintable, required=True)
    scene.kind = top.word("kind", "plane strain", f"one of: {listed(KINDS)}", KINDS.__contains__, required=True)
    scene.title = top.word("title", "Two cylinders", "a line of text", str.isprintable) or path.stem
    scene.units = top.word("units", "N-MM", "a word of at most 8 characters that begins with a letter; values are not converted",
                           lambda word: re.fullmatch(r"[A-Za-z][!-+\--~]{0,7}", word))
    scene.sequence = read_sequence(top, tables["case"], faults)
    own = Case(title=scene.title)
    read_actions(top, own, faults)
    scene.axis = read_pair(top, "axis", "x and y of the axis of rotation", "[0.0, -250.0]", faults)
    top.end()
    scene.cases = read_cases(tables["case"], own, faults)
    check_body_loads(scene, faults)
    read_materials(Table(tables["material"] or {}, "[material]", faults), scene, faults)
    read_bodies(Table(tables["body"] or {}, "[body]", faults), scene, faults)
    read_supports(Table(tables["support"] or {}, "[support]", faults), scene, faults)
    own.loads.update(read_loads(Table(tables["load"] or {}, "[load]", faults), faults))
    for name, into, what in (("platen", scene.platens, "directions in which the line moves as one"),
                             ("free", scene.free, "the unconstrained directions")):
        table = Table(tables[name] or {}, f"[{name}]", faults)
        for key in list(table.left):
            into[key] = DIRECTIONS.get(table.word(key, "y", f"{what}: x, y or xy", DIRECTIONS.__contains__), "")
    read_contacts(tables["contact"] or [], scene, faults)
    read_parameters(Table(tables["PARAM"] or {}, "[PARAM]", faults), scene, faults)
    if not (scene.mesh and scene.kind):
        raise Rejected
    faults.go_on()
    return scene


def read_sequence(top, cases, faults):
    value = top.take("sequence")
    if value is not None and not isinstance(value, bool):
        faults.add("sequence", f"is {said(value)}", "write sequence = true if each load case starts from the end of the one before, or remove it")
    elif value and cases is None:
        faults.add("sequence", "there are no load cases", "add a table [[case]] for each, or remove it")
    return value is True


def each(table, faults):
    """The tables in a table."""
    return [(key, Table(value, f"{table.name[:-1]}.{key}]", faults)) for key, value in table.left.items()]


def read_materials(table, scene, faults):
    for name, own in each(table, faults):
        young = own.number("E", "210000.0", "Young's modulus, above zero", positive, required=True)
        poisson = own.number("NU", "0.3", "Poisson's ratio, from 0 to below 0.5", lambda value: 0.0 <= value < 0.5, required=True)
        stress = own.number("yield", "240.0", "the yield stress, above zero", positive)
        hardening = own.number("H", "4000.0", "the stress over plastic strain, 0 or above", lambda value: value >= 0.0)
        curve = own.take("curve")
        kinematic = read_hardening(own, faults)
        density = own.number("density", "7.85e-9", "the mass per unit of volume, above zero", positive)
        expansion = own.number("expansion", "1.2e-5", "the thermal strain per degree")
        reference = own.number("reference", "20.0", "the temperature without thermal strain")
        own.end()
        if density is None and scene.has_weight:
            faults.add(own.where("density"), "is missing", "give the mass per unit of volume, because gravity or spin acts on it, such as density = 7.85e-9")
        if expansion is None and any(case.temperature is not None for case in scene.cases):
            faults.add(own.where("expansion"), "is missing", "give the thermal strain per degree, because there are temperatures, such as expansion = 1.2e-5, or 0.0")
        if hardening is not None and stress is None:
            faults.add(own.where("H"), "is hardening without a yield stress", "add a yield stress, such as yield = 240.0")
        if curve is not None:
            curve = read_curve(curve, own, young, faults)
            if stress is not None or hardening is not None:
                faults.add(own.where("curve"), "is given together with yield or H", "give either yield and H, or a curve that begins with the yield point")
            stress = curve[0][1] if curve else None
            if kinematic and curve and len(curve) > 2:
                faults.add(own.where("hardening"), "is kinematic, but the curve has more than two points",
                           "give yield and H instead of the curve")
        elif kinematic and stress is None:
            faults.add(own.where("hardening"), "is hardening without a yield stress", "add a yield stress and H, such as yield = 240.0 and H = 4000.0")
        check_units(own, young, stress, scene, faults)
        scene.materials[name] = Material(young, poisson, stress, hardening or 0.0, curve, kinematic, density, expansion, reference)
    mixed = {name: own.kinematic for name, own in scene.materials.items() if 0.0 < own.kinematic < 1.0}
    if len(set(mixed.values())) > 1:
        first, *_, last = mixed
        faults.add(f"[material.{last}] hardening", f"is {mixed[last]:g}, but that of [material.{first}] is {mixed[first]:g}",
                   "give the same part to all materials with mixed hardening: PARAM HRFRAC holds for all")


def read_hardening(own, faults):
    """Kinematic part of the hardening."""
    value = own.take("hardening")
    part = {"isotropic": 0.0, "kinematic": 1.0}.get(value) if isinstance(value, str) else real(value)
    if value is not None and (part is None or not 0.0 <= part <= 1.0):
        faults.add(own.where("hardening"), f"is {said(value)}", 'give "isotropic", "kinematic", or the kinematic part from 0 to 1, such as hardening = 0.5')
        return 0.0
    return part or 0.0


def read_curve(curve, own, young, faults):
    """Points of strain and stress; the first is the end of the elastic line."""
    right = "give points of total strain and stress, the yield point first: curve = [[0.00114286, 240.0], [0.01, 260.0]]"
    points = [[real(value) for value in point] if isinstance(point, list) else [] for point in curve] if isinstance(curve, list) else []
    points = points[1:] if points[:1] == [[0.0, 0.0]] else points
    if not points or any(len(point) != 2 or None in point for point in points):
        faults.add(own.where("curve"), "is not a list of points", right)
        return None
    for (strain, stress), (further, more) in zip([[0.0, 0.0]] + points, points):
        if further <= strain or more < stress or more <= 0.0:
            faults.add(own.where("curve"), f"does not rise at the point [{further:g}, {more:g}]", right)
            return None
    if young and abs(points[0][0] - points[0][1] / young) > 0.01 * points[0][0]:
        faults.add(own.where("curve"), f"its first point, [{points[0][0]:g}, {points[0][1]:g}], is not on the elastic line",
                   f"give strain {points[0][1] / young:.6g}, which is {points[0][1]:g} over E")
        return None
    return points


def check_units(own, young, stress, scene, faults):
    """Report numbers that probably have other units."""
    if young and stress and stress > 0.1 * young:
        faults.note(own.where("yield"), f"{stress:g} is more than a tenth of E = {young:g}; are both in the same unit?")
    unit = STRESS_UNITS.get((scene.units or "").upper())
    if unit and young and not SOFTEST <= young * unit <= STIFFEST:
        faults.note(own.where("E"), f"{young:g} is not the modulus of a solid in units {scene.units}: steel has {2.1e5 / unit:g}")


def read_bodies(table, scene, faults):
    if not table.left:
        faults.add("[body]", "is missing", 'add a table for each surface: [body.NAME], and below it material = "..."')
    for name, own in each(table, faults):
        material = own.word("material", next(iter(scene.materials), "steel"), "the name of a material", required=True)
        thickness = own.number("thickness", "1.0", "a length above zero", positive)
        own.end()
        if scene.rings and thickness is not None:
            faults.add(own.where("thickness"), "is not used if kind is ring", "remove it: loads and forces are those of the full circle")
        if material is not None and material not in scene.materials:
            faults.add(own.where("material"), f"there is no material '{material}'",
                       f"use one of: {listed(scene.materials)}{likely(material, scene.materials)}; or add a table [material.{material}]")
        scene.bodies[name] = (material, thickness or 1.0)
    for name in scene.materials:
        if name not in [material for material, _ in scene.bodies.values()]:
            faults.note(f"[material.{name}]", "no body uses this material")


def read_supports(table, scene, faults):
    scene.supports.update(read_displacements(table, "0 fixes the nodes", faults))


def read_displacements(table, meaning, faults):
    found = {}
    for name, own in each(table, faults):
        empty = table.left[name] == {}
        values = {digit: own.number(key, "0.0", f"a displacement; {meaning}") for key, digit in (("x", "1"), ("y", "2"))}
        own.end()
        found[name] = {digit: value for digit, value in values.items() if value is not None}
        if empty:
            faults.add(own.name, "fixes no direction", "add x = 0 or y = 0, or both")
    return found


def read_loads(table, faults):
    loads = {}
    for name, own in each(table, faults):
        found = {"pressure": own.number("pressure", "10.0", "the force per area, positive into the body")}
        named = "force" in own.left
        found["force"] = read_pair(own, "force", "the resultant in x and y", "[0.0, -100.0]", faults)
        own.end()
        loads[name] = {key: value for key, value in found.items() if value is not None}
        if not loads[name] and not own.left and not named:
            faults.add(own.name, "has no load", "add pressure = 10.0 or force = [0.0, -100.0]")
    return loads


def read_actions(table, case, faults):
    """Loads on all bodies; a case takes missing values from the model."""
    given = table.left.keys()
    if "gravity" in given:
        case.gravity = read_pair(table, "gravity", "an acceleration in x and y", "[0.0, -9810.0]", faults)
    if "spin" in given:
        case.spin = table.number("spin", "120.0", "rotations per unit of time")
    if isinstance(table.left.get("temperature"), dict):
        bodies = Table(table.take("temperature"), f"[{case.inside}temperature]", faults)
        case.temperature = {name: bodies.number(name, "80.0", "the temperature of a body") for name in list(bodies.left)}
    elif "temperature" in given:
        case.temperature = table.number("temperature", "80.0", "the temperature of all bodies, or a table: temperature.BODY = 80.0")
    if "increments" in given:
        case.increments = table.take("increments")
        if not isinstance(case.increments, int) or isinstance(case.increments, bool) or not 1 <= case.increments <= MOST_INCREMENTS:
            faults.add(table.where("increments"), f"is {said(case.increments)}", f"give a whole number from 1 to {MOST_INCREMENTS}, such as increments = 20")
    table.known += [key for key in ("gravity", "spin", "temperature", "increments") if key not in table.known]


def read_cases(tables, own, faults):
    """The load cases; without [[case]] the model's own."""
    if tables is None:
        return [own]
    cases = []
    for k, given in enumerate(tables if isinstance(tables, list) else [tables], 1):
        where = f"[[case]] {k}"
        table = Table(given, where, faults)
        case = Case(where, f"case.{k}.", f"case {k}", own.gravity, own.spin, own.temperature, own.loads, increments=own.increments)
        case.title = table.word("title", f"case {k}", "a line of text", str.isprintable) or case.title
        read_actions(table, case, faults)
        case.factor = table.number("factor", "0.5", "a factor of the loads")
        case.factor = 1.0 if case.factor is None else case.factor
        contact = table.take("contact")
        if contact is not None and not isinstance(contact, bool):
            faults.add(table.where("contact"), f"is {said(contact)}", "write contact = false to switch contact off, or remove it")
        case.contact = contact is not False
        loads, moved = table.take("load"), table.take("support")
        if loads is not None:
            case.loads = read_loads(Table(loads, f"[{case.inside}load]", faults), faults)
        if moved is not None:
            case.moved = read_displacements(Table(moved, f"[{case.inside}support]", faults), "for directions that [support] fixes", faults)
        table.end()
        cases.append(case)
    return cases


def check_body_loads(scene, faults):
    """Axisymmetric bodies carry no load across their axis, and rotate about it."""
    for case in scene.cases:
        if scene.rings and case.gravity and case.gravity[0] != 0.0:
            faults.add(f"{case.where} gravity".strip(), f"is not along the axis of an axisymmetric model: {case.gravity[0]:g} in x", "give 0.0 in x")
    if scene.axis and (scene.rings or all(case.spin is None for case in scene.cases)):
        faults.add("axis", "is not used", "remove it: axisymmetric models rotate about y" if scene.rings else "add a spin, such as spin = 120.0, or remove it")


def read_pair(table, key, meaning, example, faults):
    """Two numbers."""
    given = table.take(key)
    values = [real(value) for value in given] if isinstance(given, list) else []
    if given is not None and (len(values) != 2 or None in values):
        faults.add(table.where(key), f"is {said(given)}", f"give {meaning}, such as {key} = {example}")
        return None
    return values or None


def read_contacts(tables, scene, faults):
    tables = tables if isinstance(tables, list) else [tables]
    for k, table in enumerate(tables, 1):
        own = Table(table, f"[[contact]] {k}" if len(tables) > 1 else "[[contact]]", faults)
        slave = own.word("slave", "pin", "the name of the line with the coarser mesh", required=True)
        master = own.word("master", "hole", "the name of a line", required=True)
        friction = own.number("friction", "0.3", "the coefficient of friction, 0 or above", lambda value: value >= 0.0)
        own.end()
        if slave is not None and slave == master:
            faults.add(own.where("master"), f"'{master}' is also the slave", "give the line on the other side of the contact")
        scene.contacts.append((slave, master, friction or 0.0))


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
            faults.add(table.where(name), f"is {said(value)}", f"give {right}; epcont --cards PARAM describes it")
        scene.parameters[name] = float(value) if fits and kind is float else value
    table.left = {name: value for name, value in table.left.items() if name not in PARAMETERS}
    table.known = list(PARAMETERS)
    mixed = [own.kinematic for own in scene.materials.values() if 0.0 < own.kinematic < 1.0]
    if mixed and "HRFRAC" in scene.parameters:
        faults.add(table.where("HRFRAC"), "is given together with the hardening of a material", "remove it")
    elif mixed:
        scene.parameters["HRFRAC"] = mixed[0]
    for name, instead in (("PLANE", "kind"), ("UNITS", "units")):
        if table.left.pop(name, None) is not None:
            faults.add(table.where(name), "is a key of the model", f"write {instead} = ... before the first table")
    table.end()
