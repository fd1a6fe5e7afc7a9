"""The outline of all bodies: the edges of one element only, each with its neighbours, their curves and normals, and
corners. An edge is a polynomial p(s), 0 <= s <= 1, listed with the body to the left, with a polynomial normal n(s); projections
of a point x are real roots of (x - p) x n. Above a straight edge lies a smooth curve through its ends, with the normals there:
if these are those of a circle, its arc. Standard library only.
"""
from dataclasses import dataclass
from math import atan2, copysign, degrees, hypot

from deck import DeckError
from kinds import GAUSS, solved

#: Degrees: angles below the first are smooth, above the second corners; PARAM CORNER has the third as tolerance.
SMOOTH, CORNER, AS_LARGE = 4.7, 35.3, 1e-6
#: Smallest ratio of neighbouring angles of one curve.
ALIKE = 0.39
#: A point may be beyond the end of an edge by this fraction of it, shorter pieces are ignored; nearer to a node it is at the node.
BEYOND = 1e-5
#: Roots are searched between these coordinates.
FROM, TO = -0.1, 1.1


def value(p, s):
    """A polynomial, with its coefficients from the constant on."""
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
    """Roots between FROM and TO: between neighbouring extremes there is at most one."""
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


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def mirrored(a, b):
    """Mirror image with respect to a unit vector b."""
    return [2 * dot(a, b) * b[c] - a[c] for c in (0, 1)]


def angle(a, b):
    """Counter-clockwise from a to b, in degrees."""
    return degrees(atan2(cross(a, b), dot(a, b)))


@dataclass
class Place:
    """Projection of a point onto an edge; `at_corner`: it is a corner of the outline."""
    segment: object
    values: list
    normal: list
    gap: float
    at_corner: bool

    def weights(self):
        return {node: v for node, v in zip(self.segment.nodes, self.values) if v}


class Segment:
    """An edge of the outline; of its two ends 0 is the start."""

    def __init__(self, nodes, x):
        self.nodes, self.x, n = nodes, x, len(nodes)
        self.places = [k / (n - 1) for k in range(n)]
        matrix = [[s ** p for p in range(n)] for s in self.places]
        self.shape = list(zip(*solved(matrix, [[float(i == j) for j in range(n)] for i in range(n)])))
        self.local = [[p[c] - x[0][c] for c in (0, 1)] for p in x]
        self.path = [list(column) for column in zip(*solved(matrix, self.local))]
        self.tangent = [derived(p) for p in self.path]
        self.chord = hypot(*self.local[-1])
        self.way = unit(self.local[-1])
        self.across = [self.way[1], -self.way[0]]
        self.centre = [(x[0][c] + x[-1][c]) / 2 for c in (0, 1)]
        self.beside = [None, None]        # the edges before and after
        self.turn = [0.0, 0.0]            # angle of the outline at the ends, in degrees, positive if convex
        self.corner, self.tip = [True, True], [False, False]
        self.mirrored = [False, False]    # the end is on a symmetry line,
        self.upright = [None, None]       # with this normal within that line
        self.arc = self.arcs()            # normals of the circle through its nodes, there
        self.normal = [None, None]

    def towards(self, s):
        return [value(t, s) for t in self.tangent]

    def own(self, s):
        """Unit normal of the edge's own curve."""
        along = self.towards(s)
        return unit([along[1], -along[0]])

    def arcs(self):
        if len(self.nodes) == 2:
            return [self.own(0.0)] * 2
        a, b = ([q[c] - p[c] for c in (0, 1)] for p, q in zip(self.local, self.local[1:]))
        along = [a[c] / dot(a, a) + b[c] / dot(b, b) for c in (0, 1)]
        middle = unit([along[1], -along[0]])
        return [mirrored(middle, unit([a[1], -a[0]])), middle, mirrored(middle, unit([b[1], -b[0]]))]

    def outward(self, k):
        """Normal at its node k."""
        return self.normals[k]

    def finish(self):
        """The polynomials of the normal, and of its component along a straight edge."""
        off = [[n[c] - arc[c] for c in (0, 1)] for n, arc in zip(self.normal, self.arc[::len(self.arc) - 1])]
        between = [unit([arc[c] + (off[0][c] + off[1][c]) / 2 for c in (0, 1)]) for arc in self.arc[1:-1]]
        self.normals = [self.normal[0], *between, self.normal[1]]
        self.seen = [[sum(n[c] * column[p] for n, column in zip(self.normals, self.shape)) for p in range(len(self.nodes))] for c in (0, 1)]
        self.bend = self.chord * hypot(*(b - a for a, b in zip(*self.normal)))
        lean = [dot(n, self.way) for n in self.normal]
        self.lean = [-lean[0], lean[0] + lean[1]] if len(self.nodes) == 2 else [0.0]

    def rise(self, s):
        """Height of the curve along the normal above a straight edge: a circle with this angle has the radius chord / (2 lean)."""
        lean = value(self.lean, s)
        if abs(lean) < 1e-7:
            return self.chord * s * (1 - s) * lean
        radius = self.chord / (2 * lean)
        deep = self.chord ** 2 * s * (1 - s)
        return deep / (radius + copysign(max(0.0, radius ** 2 - deep) ** 0.5, radius))

    def root(self, x):
        """The point whose normal leads to x, on the edge or slightly beyond; of several the nearest to the projection of x on the chord."""
        off = [minus([x[c] - self.x[0][c]], self.path[c]) for c in (0, 1)]
        found = roots(minus(times(off[0], self.seen[1]), times(off[1], self.seen[0])))
        there = dot([x[c] - self.x[0][c] for c in (0, 1)], self.way) / self.chord
        return min(found, key=lambda s: abs(s - there), default=None)

    def face(self, x):
        """The projection of x, or None."""
        s = self.root(x)
        if s is None or not -BEYOND <= s <= 1 + BEYOND:
            return None
        end = 0 if s <= BEYOND else 1 if s >= 1 - BEYOND else None
        if end is not None:
            k = end * (len(self.nodes) - 1)
            normal = self.upright[end] or self.normal[end]
            values = [float(j == k) for j in range(len(self.nodes))]
            return Place(self, values, normal, dot(normal, [x[c] - self.x[k][c] for c in (0, 1)]), self.corner[end] and not self.mirrored[end])
        normal = unit([value(n, s) for n in self.seen])
        off = [x[c] - self.x[0][c] - value(self.path[c], s) for c in (0, 1)]
        return Place(self, self.values(s), normal, dot(normal, off) - self.rise(s), False)

    def cut_by(self, x, reach):
        """The projection of x within reach, from 0 to 1, or None."""
        if any(abs(x[c] - self.centre[c]) > reach + self.chord for c in (0, 1)):
            return None
        s = self.root(x)
        return s if s is not None and 0 <= s <= 1 and hypot(*(a - b for a, b in zip(self.at(s), x))) <= reach else None

    def at(self, s):
        """On the smooth curve."""
        rise, normal = self.rise(s), unit([value(n, s) for n in self.seen])
        return [self.x[0][c] + value(self.path[c], s) + rise * normal[c] for c in (0, 1)]

    def values(self, s):
        return [value(n, s) for n in self.shape]

    @staticmethod
    def spans(cuts):
        """The pieces between neighbouring cuts."""
        cuts = sorted([0.0, 1.0, *cuts])
        return [(low, high) for low, high in zip(cuts, cuts[1:]) if high - low > BEYOND]

    def pieces(self, spans, ring):
        """(coordinate, shape function values, weight) of three Gauss points in each piece."""
        for low, high in spans:
            piece = []
            for t, part in zip(*GAUSS):
                s = low + t * (high - low)
                values = self.values(s)
                radius = sum(v * p[0] for v, p in zip(values, self.x)) if ring else 1.0
                piece.append((s, values, hypot(*self.towards(s)) * part * (high - low) * radius))
            yield low, high, piece


def outline(sides, x, held, most):
    """All edges by their ends, as Segments. `sides`: of boundary(); `held`: the fixed (node, direction), ties followed; `most`: the
    angle in degrees above which there is a corner, None: decided by the angles of the outline."""
    found, starting = {}, {}
    for ends, side in sides.items():
        nodes = [side.nodes[0], *side.nodes[2:], side.nodes[1]]
        a, b = (x[node] for node in (nodes[0], nodes[-1]))
        if cross([b[c] - a[c] for c in (0, 1)], [side.inner[c] - a[c] for c in (0, 1)]) < 0:
            nodes.reverse()
        found[ends] = Segment(nodes, [[float(x[node][c]) for c in (0, 1)] for node in nodes])
        starting.setdefault(nodes[0], []).append(found[ends])
    segments = list(found.values())
    for one in segments:
        if one.nodes[-1] not in starting:
            raise DeckError("elements fold over each other: the outline does not close")
        back = [-v for v in one.towards(1.0)]
        # Through the body: clockwise from the way back.
        after = min(starting[one.nodes[-1]], key=lambda other: -angle(back, other.towards(0.0)) % 360.0 or 360.0)
        one.beside[1], after.beside[0] = after, one
    for one in segments:
        after = one.beside[1]
        one.turn[1] = after.turn[0] = angle(one.own(1.0), after.own(0.0))
    for one in segments:
        for end in (0, 1):
            mirror(one, end, held)
    find_corners(segments, most)
    find_normals(segments)
    for one in segments:
        one.finish()
    return found


def mirror(one, end, held):
    """If the body is cut by a symmetry line, at which it would have a corner, its outline continues mirrored."""
    only = [[c for c in (0, 1) if (one.nodes[k], c) in held] for k in (-end, end - 1)]
    if len(only[0]) != 1 or only[1] == only[0]:
        return
    d, own = only[0][0], one.own(float(end))
    beyond = one.beside[end].own(1.0 - end)
    if abs(own[1 - d]) < abs(own[d]) or abs(beyond[1 - d]) >= abs(beyond[d]) or abs(angle(own, beyond)) < CORNER:
        return
    other = [-own[c] if c == d else own[c] for c in (0, 1)]
    one.mirrored[end], one.turn[end] = True, angle(own, other) if end else angle(other, own)
    one.upright[end] = [copysign(1.0, own[c]) if c != d else 0.0 for c in (0, 1)]


def turns_beside(one, end):
    """(edge, end, angle) of the two nodes beside the one at an end; beyond a symmetry line their mirror images."""
    near = one, 1 - end, one.turn[1 - end]
    other = one.beside[end]
    return near, near if one.mirrored[end] else (other, end, other.turn[end])


def find_corners(segments, most):
    inner = {}
    for one in segments:
        for end in (0, 1):
            turn = one.turn[end]
            inner[one, end] = abs(turn) < CORNER and all(ALIKE * abs(turn) < other * copysign(1.0, turn) < CORNER
                                                         for *_, other in turns_beside(one, end))
    for one in segments:
        for end in (0, 1):
            turn = one.turn[end]
            if most:
                one.corner[end] = abs(turn) > most + AS_LARGE
            else:
                two = turns_beside(one, end)[:1] if one.mirrored[end] else turns_beside(one, end)
                last = abs(turn) < CORNER and any(inner[side, at] and other * copysign(1.0, turn) > ALIKE * abs(turn) for side, at, other in two)
                one.corner[end] = not (abs(turn) < SMOOTH or inner[one, end] or last)
            one.tip[end] = one.corner[end] and turn > 0 and not one.mirrored[end]


def find_normals(segments):
    """Normals at the ends; those of corners last, because the end normal of a circle's chord is the mirror image of the other."""
    for one in segments:
        after = one.beside[1]
        if not one.corner[1] and not one.mirrored[1]:
            own, other = one.arc[-1], after.arc[0]
            one.normal[1] = after.normal[0] = unit([own[c] * after.chord + other[c] * one.chord for c in (0, 1)])
    for one in segments:
        for end in (0, 1):
            if one.mirrored[end] and not one.corner[end]:
                one.normal[end] = one.upright[end]
    for one in segments:
        known = list(one.normal)
        for end in (0, 1):
            if one.corner[end]:
                other = known[1 - end] if len(one.nodes) == 2 and not one.corner[1 - end] else None
                one.normal[end] = mirrored(other, one.across) if other else one.arc[-end]
