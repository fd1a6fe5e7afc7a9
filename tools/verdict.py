"""Compare the results of all decks in two folders, value by value, and give one verdict.

A result is the status and the displacements, forces, stresses, pressures, widths and error estimates in
the tables, or in the listing if there is no summary table. Run times, memory, the plan, messages, the iteration, and the values of the
certificate and of rounding are not results: the status says whether they hold.
"""
import pathlib
import re
from dataclasses import dataclass

import tables

#: For each table the key of a row, and its results by quantity. All values of a quantity have one scale, the largest of them.
TABLES = {
    "contact": ("pair", {"force": "force", "pressure": "pressure", "gap": "length", "initial_gap": "length"}),
    "zones": ("zone", {"force": "force", "max_pressure": "pressure", "half_width": "width", "half_width_last_pair": "width"}),
    "bodies": ("body", {"force_x": "force", "force_y": "force", "mesh_error_x": "force", "mesh_error_y": "force"}),
    "nodes": ("node", {"ux": "length", "uy": "length", "rx": "force", "ry": "force"}),
    "elements": ("element", {"sx": "stress", "sy": "stress", "sz": "stress", "txy": "stress", "equivalent_stress": "stress",
                             "max_equivalent_stress": "stress", "equivalent_strain": "strain", "secant_modulus": "modulus"}),
}
#: Keys of a summary or columns of a batch that are results, by quantity (None: text). The first match counts.
SUMMARY = [(re.compile(pattern), kind) for pattern, kind in (
    (r"status|max_pressure_is|p_max_is", None),
    (r"(mesh_error_)?approach_.*_6|angle_.*", "angle"), (r"(mesh_error_)?approach.*|max_displacement", "length"),
    (r"(mesh_error_)?total_contact_force|spring_.*", "force"), (r"moment_.*", "moment"),
    (r"p_max|max_pressure|mesh_error_max_pressure|mesh_error_pressure_.*", "pressure"), (r"max_equivalent_stress", "stress"),
    (r"half_width|mesh_error_half_width.*", "width"), (r"(p_max|half_width)_error|mesh_error_energy_norm", "part"),
    (r"(lowest|highest)_temperature", "temperature"), (r"load_factor", "part"))]
#: Their names in listings, including those of version 0.5.0.
LISTED = {"largest pressure": "p_max", "total contact force": "total_contact_force", "largest equivalent stress": "max_equivalent_stress",
          "largest displacement": "max_displacement", "approach: ": "approach of ", "rotation of GRID ": "angle_", "turn of GRID ": "angle_",
          "force of spring ": "spring_", "pull of spring ": "spring_", "moment of the support of GRID ": "moment_"}
TITLES = {"CONTACT": "contact", "CONTACT ZONES": "zones", "ZONES": "zones", "CONTACT FORCE ON BODIES": "bodies", "BODIES": "bodies",
          "DISPLACEMENTS": "nodes", "STRESSES": "elements"}
HEADS = {"to last closed": "half_width_last_pair", "to last pair": "half_width_last_pair", "p_max": "max_pressure", "max pressure": "max_pressure", "first pair": "-", "last pair": "-", "half-width": "half_width",
         "first GRID": "-", "at GRID": "-", "GRID": "node", "force x": "force_x", "force y": "force_y", "equivalent": "equivalent_stress",
         "largest": "max_equivalent_stress", "strain": "equivalent_strain", "secant": "secant_modulus"}
#: Two units in the last of six digits, as in listings; more than rounding in single precision. The scale of rotations [radian] is not smaller.
TOLERANCE, LEAST_ANGLE = 2e-5, 1e-6


@dataclass
class Figure:
    name: str        # name for messages
    kind: str        # quantity; None for text
    text: str
    case: str        # number of the load case, empty if there is only one

    def value(self):
        try:
            return None if self.kind is None else float(self.text)
        except ValueError:
            return None


def kind_of(key):
    return next(((True, kind) for pattern, kind in SUMMARY if pattern.fullmatch(key)), (False, None))


def decks_of(top):
    """Files of each deck, by type, and the rows of batch.csv that name it."""
    found = {}
    for path in sorted(top.rglob("*.lst")) + sorted(top.rglob("*.csv")):
        name, _, table = path.name[:-4].rpartition(".") if path.suffix == ".csv" else (path.name[:-4], "", "lst")
        if name and (table in TABLES or table in ("summary", "lst")):
            found.setdefault(str(path.relative_to(top).parent / name), {})[table] = path
    for path in sorted(top.rglob("batch.csv")):
        for row in tables.rows(path):
            own, base = pathlib.PurePath(row.get("deck") or "").with_suffix("").parts, path.parent.relative_to(top).parts
            ends = {name: pathlib.PurePath(name).parts[len(base):] for name in found if pathlib.PurePath(name).parts[:len(base)] == base}
            name = max((name for name, end in ends.items() if own[-len(end):] == end), key=len, default="/".join((*base, *own)))
            found.setdefault(name, {}).setdefault("batch", []).append(row)
    return found


def figures(files, sources):
    """Results of a deck by (source, load case, row, column)."""
    found = {}

    def put(key, name, kind, text):
        case = key[1]
        found[key] = Figure(name + (f" of SUBCASE {case}" if case else ""), kind, text, case)

    for source in sources:
        if source == "lst":
            for case, table, row, column, kind, text in listed_figures(files["lst"]):
                put((source, case, table, row, column), column + (f" of {TABLES[table][0]} {row}" if row else ""), kind, text)
            continue
        for row in files["batch"] if source == "batch" else tables.rows(files[source]):
            case = row.get("subcase") or ""
            if source == "batch":
                for column, text in row.items():
                    is_result, kind = kind_of((column or "").removeprefix("summary_"))
                    if is_result:
                        put((source, case, "", column), column.removeprefix("summary_"), kind, text)
            elif source == "summary":
                is_result, kind = kind_of(row["key"])
                if is_result:
                    put((source, case, "", row["key"]), "p_max" if row["key"] == "max_pressure" else row["key"], kind, row["value"])
            else:
                key, columns = TABLES[source]
                for column in [column for column in columns if column in row]:
                    put((source, case, row[key], column), f"{column} of {key} {row[key]}", columns[column], row[column])
    return found


def listed_figures(path):
    """(load case, table, row, column, quantity, text) of the results in a listing."""
    case, table, heads = "", None, None
    for line in path.read_text(encoding="latin-1").splitlines():
        title = line.split("  ")[0].split(" AND ")[0]
        if line.startswith("SUBCASE "):
            case = line[8:].strip()
        if line[:1].strip():
            table, heads = ("summary" if title == "SUMMARY" else TITLES.get(title)), None
        elif table == "summary":
            match = re.match(r"  (\S.*?)  +(\S.*)", line)
            label = replaced(match[1], LISTED).split(" [")[0] if match else ""
            is_result, kind = kind_of(label)
            if is_result:
                yield case, "", "", label, kind, match[2] if kind is None else match[2].split()[0]
        elif not line.strip():
            table = None
        elif table and heads is None:
            heads = replaced(line, HEADS).split()
        elif table:
            cells = line.split()
            key, columns = TABLES[table]
            if heads[0] == key and cells[0].isdigit():
                yield from ((case, table, cells[0], head, columns[head], cell) for head, cell in zip(heads, cells) if head in columns)


def replaced(text, words):
    for old, new in words.items():
        text = text.replace(old, new)
    return text


def differences(old, new, relative):
    """(size, name, words) of all differences; the size is infinite if a value is not a number. If an answer is not valid, only its status
    is compared."""
    unsolved = {figure.case for figure in old.values() if figure.name.startswith("status") and figure.text.strip() != "valid"}
    old, new = ({key: figure for key, figure in figures.items() if figure.case not in unsolved or figure.name.startswith("status")} for figures in (old, new))
    scale = {}
    for figure in old.values():
        value = figure.value()
        if value is not None:
            scale[figure.case, figure.kind] = max(scale.get((figure.case, figure.kind), 0.0), abs(value))
    rows = {key[:-1] for key in old}
    for key, figure in new.items():
        if key[:-1] not in rows and any(key[0] == other[0] for other in rows) and key not in old:
            yield float("inf"), figure.name, "only in the second folder"
    for key, figure in old.items():
        other = new.get(key)
        if other is None:
            yield float("inf"), figure.name, "missing in the second folder"
            continue
        a, b = figure.value(), other.value()
        if a is None or b is None:
            if figure.text.strip() != other.text.strip():
                yield float("inf"), figure.name, f"{figure.text or 'nothing'} -> {other.text or 'nothing'}"
            continue
        size = max(abs(a), scale[figure.case, figure.kind])
        if figure.kind == "moment":   # reaction of an unloaded support: rounding
            size = max(size, scale.get((figure.case, "force"), 0.0) * scale.get((figure.case, "length"), 0.0))
        size = max(size, LEAST_ANGLE if figure.kind == "angle" else 0.0)
        off = abs(b - a) / size if size else float("inf") if b else 0.0
        if not off <= (TOLERANCE if relative is None else relative):
            yield off, figure.name, f"{off:.1E}"


def worst_of(deck, old, new, relative):
    """Largest difference of a deck, values before estimates; None if all are equal."""
    if not (old and new):
        return (2, float("inf")), f"deck {deck}, only in the {'first' if old else 'second'} folder"
    exact = "summary" in old and "summary" in new
    sources = [source for source in ("batch", "summary", *TABLES) if source in old and (exact or source == "batch")]
    sources += ["lst"] * (not exact and "lst" in old)
    lost = [source for source in sources if source not in new]
    if lost:
        return (2, float("inf")), f"{lost[0]} of deck {deck}, missing in the second folder"
    found = list(differences(figures(old, sources), figures(new, sources), relative))
    if not found:
        return None
    size, name, words = max(found, key=lambda each: ("error" not in each[1], each[1].startswith("status"), float(f"{each[0]:.1E}"), each[1].startswith("p_max")))
    return ("error" not in name, size), f"{name} of deck {deck}, {words}"


def compare_folders(first, second, relative=None, shown=20):
    """Print the differences and the verdict; return True if all decks are the same."""
    old, new = decks_of(first), decks_of(second)
    names = sorted(old.keys() | new.keys())
    found = {name: worst_of(name, old.get(name), new.get(name), relative) for name in names}
    bad = [worst for worst in found.values() if worst]
    for _, words in bad[:shown] if len(bad) > 1 else []:   # a single one is in the verdict
        print(words)
    verdict = f"{len(names)} deck{'s' * (len(names) != 1)}: "
    if not bad:
        print(verdict + "the same")
    else:
        print(f"{verdict}{len(names) - len(bad)} the same, {len(bad)} differ{'s' * (len(bad) == 1)}; worst: {max(bad, key=lambda each: each[0])[1]}")
    return bool(names) and not bad
