"""Read the tables of a run completely, compare them with the deck, and list what is not read."""
import math
import pathlib
import re

import tables

#: For each table the key of a row, the columns with numbers, those that may be empty, and those with words.
COLUMNS = {
    "nodes": ("node", ["x", "y", "ux", "uy", "rx", "ry"], [], []),
    "elements": ("element", ["x", "y", "sx", "sy", "sz", "txy", "equivalent_stress", "equivalent_strain", "secant_modulus"], [], ["state"]),
    "contact": ("pair", ["ga", "gb", "x", "y", "nx", "ny", "initial_gap", "force", "gap"], ["pressure"], ["status"]),
    "zones": ("zone", ["first_pair", "last_pair", "force", "half_width_last_pair"], ["max_pressure", "half_width"], []),
    "bodies": ("body", ["first_node", "force_y"], ["force_x"], []),
    "friction": ("pair", ["friction", "force", "friction_force", "limit", "slid"], ["shear"], ["state"]),
    "history": ("iteration", ["pairs_in_contact", "plastic_elements", "pivots", "load_factor"], [], []),
}
#: Columns of some versions only.
#: If the pairs in contact belong to no boundary.
NO_PRESSURE = "max_pressure", ""
SAME_NORMAL = 1e-3   # if a node has two pairs, one node is counted twice
SOME = {"elements": ["max_equivalent_stress", "max_x", "max_y"]}
#: Keys of the summary that must be numbers.
FIGURES = {"max_pressure", "total_contact_force", "max_equivalent_stress", "max_displacement", "equilibrium_residual", "smallest_force",
           "smallest_gap", "largest_force_gap_product", "stress_off_curve", "curve_tolerance", "stress_off_curve_limit", "energy_balance", "load_factor",
           "total_friction_force", "friction_above_limit"}


class TableFault(ValueError):
    """A table that epcont cannot have written for the deck: table, position, reason."""


class Tables:
    """Rows of each table by number; `summary`: values by key, `units` likewise; `unread`: unknown columns, by table.
    `case`: number of the load case; None if the deck has only one."""

    def __init__(self, directory, stem, case=None):
        self.directory, self.stem, self.case, self.unread = pathlib.Path(directory), stem, case, {}
        self.summary, self.units = self.read_summary()
        for name in COLUMNS:
            setattr(self, name, self.read(name) if name in ("nodes", "elements") or self.path(name).exists() else {})

    def path(self, name):
        return self.directory / f"{self.stem}.{name}.csv"

    def rows(self, path):
        """Lines and rows of the load case."""
        for line, row in enumerate(tables.rows(path), 2):
            if ("subcase" in row) != (self.case is not None):
                raise TableFault(f"{path}: {'a' if self.case is None else 'no'} column subcase: this table is of another deck")
            if row.pop("subcase", None) == (None if self.case is None else str(self.case)):
                yield line, row

    def friction_before(self):
        """Friction force and tangential displacement of each pair at the start of the load case, if its table has them; None if unknown."""
        cases = list(dict.fromkeys(row.get("subcase") for row in tables.rows(self.path("summary"))))
        own = cases.index(None if self.case is None else str(self.case))
        if not own:
            return {}
        rows = [row for row in tables.rows(self.path("friction")) if row["subcase"] == cases[own - 1]]
        return {int(row["pair"]): (float(row["friction_force"]), float(row["slid"])) for row in rows} or None

    def read_summary(self):
        path, values, units = self.path("summary"), {}, {}
        for line, row in self.rows(path):
            if None in row or not all(row.get(column) is not None for column in ("key", "value", "unit")):
                raise TableFault(f"{path}:{line}: the line is incomplete, or longer than the first")
            if row["key"] in values:
                raise TableFault(f"{path}:{line}: {row['key']} occurs twice")
            if row["key"] in FIGURES and (row["key"], row["value"]) != NO_PRESSURE or row["key"].startswith("approach_"):
                number(row["value"], path, row["key"])
            values[row["key"]], units[row["key"]] = row["value"], row["unit"]
        return values, units

    def read(self, name):
        """Rows by number; each number has one row, and numeric columns hold numbers."""
        key, needed, may_be_empty, words = COLUMNS[name]
        path, found = self.path(name), {}
        for line, row in self.rows(path):
            if None in row or None in row.values():
                raise TableFault(f"{path}:{line}: the line is incomplete, or longer than the first")
            some = [column for column in SOME.get(name, []) if column in row]
            for column in (key, *needed, *may_be_empty, *words, *some):
                if column not in row:
                    raise TableFault(f"{path}:{line}: {column}: no such column")
                if column not in words and not (column in may_be_empty and row[column] == ""):
                    number(row[column], f"{path}:{line}", column)
            try:
                own = int(row[key])
            except ValueError:
                raise TableFault(f"{path}:{line}: {key}: {row[key]!r} is not a whole number") from None
            others = [name for name in found if name == own or isinstance(name, tuple) and name[0] == own]
            if others and (name != "contact" or any(same_normal(found[other], row) for other in others)):
                raise TableFault(f"{path}:{line}: {key} {own} occurs twice")
            found[(own, len(others) + 1) if others else own] = row
            self.unread[name] = [column for column in row if column not in (key, *needed, *may_be_empty, *words, *some)]
        return found

    def hold(self, scene):
        """Check that the tables contain exactly the nodes, elements and pairs of the deck."""
        for name, what, wanted, found in (("nodes", "node", scene.x, self.nodes), ("elements", "element", scene.element, self.elements),
                                          ("contact", "pair", scene.pair, self.contact)):
            lacking, strange = sorted(set(wanted) - set(found)), sorted(set(found) - set(wanted))
            if lacking:
                raise TableFault(f"{self.path(name)}: no {what} {lacking[0]}: the table is incomplete or of another deck")
            if strange:
                raise TableFault(f"{self.path(name)}: {what} {strange[0]} is not in the deck: the table is of another deck")
        for name in ("zones", "bodies", "history"):
            if not self.path(name).exists() and (scene.pair or name == "history"):
                raise TableFault(f"{self.path(name)}: no such file")


def same_normal(one, other):
    return math.hypot(float(one["nx"]) - float(other["nx"]), float(one["ny"]) - float(other["ny"])) < SAME_NORMAL


def number(text, place, name):
    try:
        value = float(text)
    except (TypeError, ValueError):
        raise TableFault(f"{place}: {name}: {'no such column' if text is None else f'{text!r} is not a number'}") from None
    if not math.isfinite(value):
        raise TableFault(f"{place}: {name}: {text!r} is not a finite number")
    return value
