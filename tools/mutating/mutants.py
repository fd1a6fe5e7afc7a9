"""Mutants: changes of one operator or one constant of a Fortran source."""
import collections
import dataclasses
import hashlib
import itertools
import re

#: Comments and strings; then tokens that may be changed, longest first; then names and all others.
TOKEN = re.compile(r"""(?P<quiet>!.*|'[^']*'?|"[^"]*"?)
                     |(?P<real>(?<!\w)(?:\d+\.\d*|\.\d+|\d+(?=[ed]))(?:[ed][+-]?\d+)?(?=_\w|(?!\w)))(?:_\w+)?
                     |(?P<integer>(?<![\w.%])\d+(?![\w.]))
                     |(?P<word>\.(?:and|or|not|true|false)\.|\b(?:min|max)(?:val|loc)?(?=\()|\b(?:any|all)(?=\())
                     |(?P<sign>\*\*|==|/=|<=|>=|=>|//|::|\(/|/\)|[<>+*/-])
                     |(?P<other>[\w%]+|.)""", re.VERBOSE | re.IGNORECASE)
SWAPS = {"==": ["/="], "/=": ["=="], "<": [">", "<="], "<=": [">", "<"], ">": ["<", ">="], ">=": ["<", ">"],
         "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"],
         ".and.": [".or."], ".or.": [".and."], ".not.": [""], ".true.": [".false."], ".false.": [".true."],
         "min": ["max"], "max": ["min"], "minval": ["maxval"], "maxval": ["minval"], "minloc": ["maxloc"], "maxloc": ["minloc"],
         "any": ["all"], "all": ["any"]}
#: Statements without computation.
BARREN = re.compile(r"\s*(?:end\b|use\b|import\b|implicit\b|private\b|public\b|module\b|contains\b|procedure\b|class\b|type\b(?!.*=)|"
                    r"(?:(?:pure|elemental|impure|recursive|integer|logical|real(?:\(\w+\))?|character(?:\([^)]*\))?)\s+)*(?:subroutine|function)\b|"
                    r"(?:associate|select)\b(?!.*\d))", re.IGNORECASE)
#: `<=` for `<` matters if integers are compared; reals are hardly ever equal, so the program would be the same.
BY_A_HAIR = {"<=", ">=", "<", ">"}
WHOLE = re.compile(r"\s*\d+(?![\w.])")


@dataclasses.dataclass(frozen=True)
class Mutant:
    path: str
    line: int       # from 1
    column: int     # from 0
    old: str
    new: str
    text: str       # the unchanged line
    twin: int = 0   # number of equal lines above

    @property
    def key(self):
        """Identity of a mutant, independent of its line number."""
        indent = len(self.text) - len(self.text.lstrip())
        return f"{self.path}|{self.text.strip()}|{self.column - indent}|{self.new}" + (f"|{self.twin}" if self.twin else "")

    def rank(self, seed):
        """Position in a random order that changes of other lines do not affect."""
        return hashlib.sha256(f"{seed} {self.key}".encode()).hexdigest()

    def applied(self, source):
        lines = source.split("\n")
        text = lines[self.line - 1]
        assert text == self.text
        lines[self.line - 1] = text[:self.column] + self.new + text[self.column + len(self.old):]
        return "\n".join(lines)


def real_text(text, factor):
    """A real literal times a factor, in Fortran's form; 0.0 becomes 1.0."""
    value = float(text.lower().replace("d", "e"))
    new = f"{value * factor if value else 1.0:.12g}"
    mantissa, _, exponent = new.partition("e")
    mantissa += "" if "." in mantissa else ".0"
    return mantissa + (f"e{int(exponent)}" if exponent else "")


def replacements(kind, old, before, after):
    """Replacements of a token."""
    if kind == "real":
        small = 0.0 < float(old.lower().replace("d", "e")) < 1e-5
        return [real_text(old, factor) for factor in ((1e-3, 1e3, 1e6) if small else (1e-3, 1e3))]
    if kind == "integer":
        return [str(int(old) + 1)] + ([str(int(old) - 1)] if int(old) > 0 else [])
    swaps = SWAPS.get(old.lower(), [])
    if kind == "word":
        return swaps
    ahead = before.rstrip()[-1:]
    if old in "*/" and (ahead in "(,=" or after.lstrip()[:1] in ",)"):     # of a character(len=*), a print
        return []
    if old in "+-" and (ahead == "" or ahead in "(,=[*/<>&"):              # a leading plus sign has no effect
        return swaps if old == "-" else []
    if old in BY_A_HAIR and not WHOLE.match(after):
        return swaps[:1]
    return swaps


def mutants_of(path, source):
    """All mutants of a source, in the order of its text."""
    found, barren, going_on = [], False, False
    seen = collections.Counter()
    for number, text in enumerate(source.split("\n"), 1):
        if not going_on:
            barren = bool(BARREN.match(text))
        code = "".join(m.group() for m in TOKEN.finditer(text) if m.lastgroup != "quiet").rstrip()
        start = 0
        if not going_on and "::" in code:
            # In a declaration only values may change, after the first = to the right of ::, not shapes.
            head = text.index("::") + 2
            value = re.search(r"(?<![=<>/])=(?![=>])", text[head:])
            barren = value is None and not code.endswith(":: &")   # the values may be on the next line
            start = head + value.end() if value else len(text)
        if not barren:
            for match in TOKEN.finditer(text):
                kind = match.lastgroup
                if kind in ("quiet", "other") or match.start() < start:
                    continue
                old, column = match.group(kind), match.start(kind)
                for new in replacements(kind, old, text[:column], text[column + len(old):]):
                    found.append(Mutant(path, number, column, old, new, text, seen[text.strip()]))
        seen[text.strip()] += 1
        going_on = code.endswith("&") or (going_on and not code.strip())
    return found


#: Drawn in turn, so that the many subscripts do not outnumber the others.
CLASSES = [{"real"}, {"integer"}, {"==", "/=", "<", "<=", ">", ">="}, {"+", "-", "*", "/"},
           {".and.", ".or.", ".not.", ".true.", ".false.", "any", "all"}, {"min", "max", "minval", "maxval", "minloc", "maxloc"}]


def class_of(mutant):
    name = mutant.old.lower()
    if name[0].isdigit() or name[0] == "." and name[-1] != ".":
        name = "integer" if name.isdigit() else "real"
    return next(k for k, names in enumerate(CLASSES) if name in names)


def choose(mutants, seed, count):
    """Choose some mutants, from each class in turn and from each folder, at random: the same ones for the same seed."""
    rows, places = [[] for _ in CLASSES], set()
    for mutant in sorted(mutants, key=lambda m: m.rank(seed)):
        place = mutant.path, mutant.line, mutant.column
        if place not in places:
            places.add(place)
            rows[class_of(mutant)].append(mutant)
    turns = itertools.zip_longest(*rows)
    return [mutant for turn in turns for mutant in turn if mutant][:count]
