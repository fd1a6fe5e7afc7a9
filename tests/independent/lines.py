"""Contact between boundary lines: which place of the master line each slave node faces, from roots of polynomials.

A side is a polynomial p(s), 0 <= s <= 1, with a polynomial normal n(s) along which slave nodes are seen; feet of a node x are
the real roots of (x - p) x n. Above a straight side the smooth curve through its ends is a cubic that has their slopes.

The master line's displacement is fitted on each slave side by the slave's shape functions, least squares; a slave node's gap is
against the fits of its sides, averaged as their lengths (in rings areas) that belong to the node. Standard library only.
"""
from dataclasses import dataclass, field
from math import cos, hypot, radians, sin

from deck import DeckError, at, ids, real
from kinds import GAUSS, solved

BEND, HALF_BEND = cos(radians(35.0)), sin(radians(17.5))
OUTSIDE, AT_NODE, EQUAL, ROUNDING = 1e-6, 1e-9, 1e-9, 1e-12
#: Roots are looked for between these places.
FROM, TO = -0.1, 1.1


def value(p, s):
    """Of a polynomial, its coefficients from the constant on."""
    total = 0.0
    for c in reversed(p):
        total = total * s + c
    return total


def derived(p):
    return [k * c for k, c in enumerate(p)][1:] or [0.0]


def times(p, q):
    found = [0.0] * (len(p) + len(q) - 1)
    for i, a in enumerate(p):
        for j, b in enumerate(q):
            found[i + j] += a * b
    return found


def minus(p, q):
    n = max(len(p), len(q))
    return [a - b for a, b in zip(p + [0.0] * (n - len(p)), q + [0.0] * (n - len(q)))]


def roots(p):
    """Between FROM and TO: between neighbouring extremes there is one root or none."""
    if len(p) == 1:
        return []
    places = [FROM, *roots(derived(p)), TO]
    found = []
    for low, high in zip(places, places[1:]):
        at_low, at_high = value(p, low), value(p, high)
        if at_low * at_high > 0 or at_low == 0 or low == high:
            continue
        s, slope = (low + high) / 2, derived(p)
        for _ in range(100):
            here = value(p, s)
            if here == 0:
                break
            low, high = (s, high) if (here > 0) == (at_low > 0) else (low, s)
            steep = value(slope, s)
            step = s - here / steep if steep else low
            step = step if low < step < high else (low + high) / 2
            if abs(step - s) <= 3e-16:
                break
            s = step
        found.append(s)
    return found


def unit(v):
    length = hypot(*v)
    return [v[0] / length, v[1] / length]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


@dataclass
class Segment:
    """A side in the sense in which its element lies to the left: its nodes in order, their reference places."""
    nodes: list
    x: list
    normal: list = field(default_factory=lambda: [None, None])   # unit, at the ends
    upright: list = field(default_factory=lambda: [None, None])  # of an end on a line of symmetry: the normal within that line

    def __post_init__(self):
        n = len(self.nodes)
        self.places = [k / (n - 1) for k in range(n)]
        matrix = [[s ** p for p in range(n)] for s in self.places]
        self.shape = list(zip(*solved(matrix, [[float(i == j) for j in range(n)] for i in range(n)])))
        self.path = [list(column) for column in zip(*solved(matrix, self.x))]
        self.tangent = [derived(p) for p in self.path]
        along = [self.x[-1][c] - self.x[0][c] for c in (0, 1)]
        self.chord = hypot(*along)
        self.along = unit(along)
        self.across = [self.along[1], -self.along[0]]

    def own(self, s):
        """Unit normal of the side's own curve."""
        return unit([value(self.tangent[1], s), -value(self.tangent[0], s)])

    def finish(self):
        """The polynomials of the normal and of the rise above a straight side."""
        long = [hypot(value(self.tangent[0], s), value(self.tangent[1], s)) for s in (0.0, 1.0)]
        self.seen = [[long[0] * a, long[1] * b - long[0] * a] for a, b in zip(*self.normal)]
        self.rise = [0.0]
        if len(self.nodes) == 3:
            return
        slopes = [[-self.chord * dot(n, self.along) / dot(n, self.across)] for n in self.normal]
        hermite = solved([[1, 0, 0, 0], [1, 1, 1, 1], [0, 1, 0, 0], [0, 1, 2, 3]], [[0.0], [0.0], *slopes])
        self.rise = [row[0] for row in hermite]

    def roots(self, x):
        """The places s, on the side or a little beyond, whose normals lead to x."""
        off = [minus([x[c]], self.path[c]) for c in (0, 1)]
        return roots(minus(times(off[0], self.seen[1]), times(off[1], self.seen[0])))

    def feet(self, x):
        """(shape values, unit normal, gap) of each place that x faces."""
        for s in self.roots(x):
            if not -OUTSIDE <= s <= 1 + OUTSIDE:
                continue
            end = int(s > 0.5)
            s = min(max(s, 0.0), 1.0)
            node = min(self.places, key=lambda place: abs(place - s))
            s = node if abs(s - node) <= AT_NODE else s
            normal = unit((self.upright[end] or self.normal[end]) if s == end else [value(n, s) for n in self.seen])
            off = [x[c] - value(self.path[c], s) for c in (0, 1)]
            yield self.values(s), normal, dot(normal, off) - value(self.rise, s)

    def values(self, s):
        return [value(n, s) for n in self.shape]

    def near(self, x, reach):
        return all(abs(x[c] - (self.x[0][c] + self.x[-1][c]) / 2) <= reach + self.chord for c in (0, 1))

    def points(self, cuts, ring):
        """Of three Gauss points between neighbouring cuts: shape values, place on the smooth curve, outward normal, weight."""
        cuts = sorted({0.0, 1.0, *(s for s in cuts if 0 <= s <= 1)})
        for low, high in zip(cuts, cuts[1:]):
            if high - low <= ROUNDING:
                continue
            for t, part in zip(*GAUSS):
                s = low + t * (high - low)
                on_side = [value(p, s) for p in self.path]
                length = hypot(*(value(p, s) for p in self.tangent)) * part * (high - low)
                rise = value(self.rise, s)
                place = [on_side[c] + rise * self.across[c] for c in (0, 1)]
                yield self.values(s), place, self.own(s), length * (on_side[0] if ring else 1.0)


class Line:
    """Segments of a BLSEG in the sense that has the elements to the left, with their normals. `sides`: of the boundary, by their
    ends; `held`: (node, direction)."""

    def __init__(self, nodes, sides, x, held):
        found, i = [], 0
        while i < len(nodes) - 1:
            step = 1 if frozenset(nodes[i:i + 2]) in sides else 2
            if i + step >= len(nodes) or frozenset((nodes[i], nodes[i + step])) not in sides:
                raise DeckError("a line leaves the boundary")
            found.append((nodes[i], nodes[i + step]))
            i += step
        turned = {self.segment(sides, x, *ends)[1] for ends in found}
        if len(turned) > 1:
            raise DeckError("a line turns back")
        if turned == {True}:
            found = [ends[::-1] for ends in reversed(found)]
        self.segments = [self.segment(sides, x, *ends)[0] for ends in found]
        self.closed = nodes[0] == nodes[-1]
        self.meet(held)
        for segment in self.segments:
            segment.finish()

    @staticmethod
    def segment(sides, x, a, b):
        """The side from a to b, and whether its element lies to the right of it."""
        side = sides[frozenset((a, b))]
        nodes = [a, *side.nodes[2:], b]
        inner = [side.inner[c] - x[a][c] for c in (0, 1)]
        along = [x[b][c] - x[a][c] for c in (0, 1)]
        places = [[float(x[node][c]) for c in (0, 1)] for node in nodes]
        return Segment(nodes, places), bool(along[0] * inner[1] < along[1] * inner[0])

    def meet(self, held):
        """Normals at the ends of the segments; those of corners last, for they may follow the other end."""
        segments = self.segments
        joints = list(zip(segments, segments[1:])) + ([(segments[-1], segments[0])] if self.closed else [])
        for before, after in joints:
            one, two = before.own(1.0), after.own(0.0)
            if dot(one, two) >= BEND:
                before.normal[1] = after.normal[0] = unit([one[c] * after.chord + two[c] * before.chord for c in (0, 1)])
        if not self.closed:
            for segment, end in ((segments[0], 0), (segments[-1], 1)):
                n = segment.own(float(end))
                directions = [c for c in (0, 1) if (segment.nodes[-end], c) in held]
                if len(directions) != 1 or abs(n[1 - directions[0]]) < abs(n[directions[0]]):
                    continue
                across = n[directions[0]]
                n[directions[0]] = 0.0
                segment.upright[end] = unit(n)
                if abs(across) <= HALF_BEND:
                    segment.normal[end] = segment.upright[end]
        for segment in segments:
            known = list(segment.normal)
            for end in (0, 1):
                if known[end] is None:
                    other, across = known[1 - end], segment.across
                    mirror = len(segment.nodes) == 2 and other is not None
                    segment.normal[end] = ([2 * dot(other, across) * across[c] - other[c] for c in (0, 1)] if mirror
                                           else segment.own(float(end)))

    def nodes(self):
        """The nodes with their outward normals, at a corner between those of its sides."""
        found = {}
        for segment in self.segments:
            for node, s in zip(segment.nodes, segment.places):
                end = {0.0: 0, 1.0: 1}.get(s)
                n, so_far = segment.own(s) if end is None else segment.normal[end], found.get(node, (0.0, 0.0))
                found[node] = [so_far[0] + n[0], so_far[1] + n[1]]
        return found

    def face(self, x, outward, reach, but=None, like=None):
        """(nodes of a side, shape values, normal, gap) where a place faces this line, or None: the nearest; of equally near ones
        that which looks most against it; of those too, at a corner, that with a normal most like one given, or the first."""
        found = [(abs(gap), dot(normal, outward), segment.nodes, values, normal, gap) for segment in self.segments
                 if but not in segment.nodes and segment.near(x, reach)
                 for values, normal, gap in segment.feet(x) if abs(gap) <= reach and dot(normal, outward) < 0]
        if not found:
            return None
        least = min(f[0] for f in found)
        equal = [f for f in found if f[0] <= least + EQUAL * reach]
        against = min(f[1] for f in equal) + EQUAL
        corner = [f for f in equal if f[1] <= against and max(f[3]) == 1.0]
        if len(corner) == 2:  # none is the better one: between them
            both = [corner[0][4][c] + corner[1][4][c] for c in (0, 1)]
            return corner[0][2], corner[0][3], unit(both), (corner[0][5] + corner[1][5]) / hypot(*both)
        return max((f for f in equal if f[1] <= against), key=lambda f: dot(f[4], like) if like else 0.0)[2:]


def averages(ring, slave, master, faced, reach):
    """Of each slave node that faces the master line: by master nodes the weights whose sum is 1."""
    share = {node: [] for node in faced}
    ends = [segment.x[end] for segment in master.segments for end in (0, -1)]
    for segment in slave.segments:
        points = list(segment.points([s for x in ends if segment.near(x, reach) for s in segment.roots(x)], ring))
        seen = [master.face(place, outward, reach) for _, place, outward, _ in points]
        if None in seen or any(node not in faced for node in segment.nodes):
            fits = {node: dict(zip(*faced[node][:2])) for node in segment.nodes if node in faced}
        else:
            columns = sorted({node for side in seen for node in side[0]})
            other = [[dict(zip(side[0], side[1])).get(node, 0.0) for node in columns] for side in seen]
            # Least squares: its normal equations.
            count = range(len(segment.nodes))
            matrix = [[sum(w * n[i] * n[j] for n, _, _, w in points) for j in count] for i in count]
            right = [[sum(p[3] * p[0][i] * line[m] for p, line in zip(points, other)) for m in range(len(columns))] for i in count]
            fits = {node: dict(zip(columns, line)) for node, line in zip(segment.nodes, solved(matrix, right))}
        whole = sum(p[3] for p in points)
        for i, node in enumerate(segment.nodes):
            if node in faced:
                area = sum(p[3] * p[0][i] for p in points)
                share[node].append((area if area > ROUNDING * whole else 0.0, fits[node]))
    return {node: mean(found) for node, found in share.items()}


def mean(found):
    """Of [(area, values by name)]; where there is no area, at the axis of rings, of equals."""
    if not any(area for area, _ in found):
        found = [(1.0, values) for _, values in found]
    whole, total = sum(area for area, _ in found), {}
    for area, values in found:
        for name, part in values.items():
            total[name] = total.get(name, 0.0) + area * part / whole
    return total


def pairs_of_lines(deck, parameter, sides, x, held, name=lambda g: g, likely=None):
    """Of each BCONP the list of (slave node, {master node: weight}, normal, gap). `name`: of the node of an id; `likely`: normals
    by nodes, which decide between places that are equally good."""
    lines = {int(card[1]): Line([name(g) for g in ids(card[2:])], sides, x, held) for card in deck.of("BLSEG")}
    ring, found = any(side.thickness is None for side in sides.values()), []
    for card in deck.of("BCONP"):
        slave, master = lines[int(card[2])], lines[int(card[3])]
        reach = real(parameter.get("SEARCH", ""), 2 * max(s.chord for s in slave.segments + master.segments))
        faced = {node: master.face(x[node], outward, reach, node, (likely or {}).get(node))
                 for node, outward in slave.nodes().items()}
        faced = {node: face for node, face in faced.items() if face}
        if not faced:
            raise DeckError(f"BCONP {at(card, 1)} pairs nothing")
        weights = averages(ring, slave, master, faced, reach)
        found.append([(node, weights[node], face[2], face[3]) for node, face in faced.items()])
    return found
