"""Contact between boundary lines: which place of the master line each slave node faces, from roots of polynomials.

A side is a polynomial p(s), 0 <= s <= 1, with a polynomial normal n(s) along which slave nodes are seen; feet of a node x are
the real roots of (x - p) x n. Above a straight side the smooth curve through its ends is a cubic that has their slopes.

The master line's displacement is fitted on each slave side by the slave's shape functions, least squares; a slave node's gap is
against the fits of its sides, averaged as their lengths (in rings areas) that belong to the node.
"""
from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial import Polynomial

from deck import DeckError, at, ids, real
from shapes import GAUSS

BEND, ALONG = np.cos(np.radians(30.0)), 0.5
OUTSIDE, AT_NODE, BESIDE, EQUAL, ROUNDING = 1e-6, 1e-9, 0.05, 1e-9, 1e-12


@dataclass
class Segment:
    """A side in the sense in which its element lies to the left: rows of its nodes in order, their reference places."""
    nodes: list
    x: np.ndarray
    normal: list = field(default_factory=lambda: [None, None])   # unit, at the ends
    smooth: list = field(default_factory=lambda: [None, None])   # the common one, where two quadratic sides meet smoothly

    def __post_init__(self):
        self.places = np.linspace(0.0, 1.0, len(self.nodes))
        inverse = np.linalg.inv(self.places[:, None] ** np.arange(len(self.nodes)))
        self.shape = [Polynomial(column) for column in inverse.T]
        self.path = [sum(n * value for n, value in zip(self.shape, self.x[:, c])) for c in range(2)]
        along = self.x[-1] - self.x[0]
        self.chord = float(np.hypot(*along))
        self.along = along / self.chord
        self.across = np.array([self.along[1], -self.along[0]])

    def own(self, s):
        """Unit normal of the side's own curve."""
        tangent = np.array([c.deriv()(s) for c in self.path])
        return np.array([tangent[1], -tangent[0]]) / np.hypot(*tangent)

    def finish(self):
        """The polynomials of the normal and of the rise above a straight side."""
        if len(self.nodes) == 3:
            self.seen = [self.path[1].deriv(), -self.path[0].deriv()]
            self.rise = Polynomial([0.0])
            return
        self.seen = [Polynomial([a, b - a]) for a, b in zip(*self.normal)]
        slopes = [-self.chord * (n @ self.along) / (n @ self.across) for n in self.normal]
        hermite = np.linalg.solve([[1, 0, 0, 0], [1, 1, 1, 1], [0, 1, 0, 0], [0, 1, 2, 3]], [0, 0, *slopes])
        self.rise = Polynomial(hermite)

    def roots(self, x):
        """The places s, on the side or beyond, whose normals lead to x."""
        off = [x[c] - self.path[c] for c in range(2)]
        found = (off[0] * self.seen[1] - off[1] * self.seen[0]).roots()
        return [float(root.real) for root in found if abs(root.imag) <= 1e-9]

    def feet(self, x):
        """(whether beyond the end, shape values, unit normal, gap) of each place that x faces."""
        for s in self.roots(x):
            end, beyond = int(s > 0.5), not -OUTSIDE <= s <= 1 + OUTSIDE
            if beyond and (len(self.nodes) < 3 or self.smooth[end] is None or not -BESIDE <= s <= 1 + BESIDE):
                continue
            s = min(max(s, 0.0), 1.0)
            node = self.places[np.argmin(abs(self.places - s))]
            s = node if abs(s - node) <= AT_NODE else s
            normal = self.smooth[end] if beyond else np.array([n(s) for n in self.seen])
            normal = normal / np.hypot(*normal)
            place = np.array([p(s) for p in self.path])
            yield beyond, self.values(s), normal, float(normal @ (x - place) - self.rise(s))

    def values(self, s):
        return np.array([n(s) for n in self.shape])

    def near(self, x, reach):
        return np.all(abs(x - (self.x[0] + self.x[-1]) / 2) <= reach + self.chord)

    def points(self, cuts, ring):
        """Of three Gauss points between neighbouring cuts: shape values, place on the smooth curve, outward normal, weight."""
        cuts = sorted({0.0, 1.0, *(s for s in cuts if 0 <= s <= 1)})
        for low, high in zip(cuts, cuts[1:]):
            if high - low <= ROUNDING:
                continue
            for t, part in zip(*GAUSS):
                s = low + t * (high - low)
                on_side = np.array([p(s) for p in self.path])
                length = np.hypot(*(p.deriv()(s) for p in self.path)) * part * (high - low)
                yield self.values(s), on_side + self.rise(s) * self.across, self.own(s), length * (on_side[0] if ring else 1.0)


class Line:
    """Segments of a BLSEG in the sense that has the elements to the left, with their normals."""

    def __init__(self, model, rows):
        found, i = [], 0
        while i < len(rows) - 1:
            step = 1 if frozenset(rows[i:i + 2]) in model.boundary else 2
            if i + step >= len(rows) or frozenset((rows[i], rows[i + step])) not in model.boundary:
                raise DeckError("a line leaves the boundary")
            found.append((rows[i], rows[i + step]))
            i += step
        turned = {self.segment(model, *ends)[1] for ends in found}
        if len(turned) > 1:
            raise DeckError("a line turns back")
        if turned == {True}:
            found = [ends[::-1] for ends in reversed(found)]
        self.segments = [self.segment(model, *ends)[0] for ends in found]
        self.closed = rows[0] == rows[-1]
        self.meet(model)
        for segment in self.segments:
            segment.finish()

    @staticmethod
    def segment(model, a, b):
        """The side from a to b, and whether its element lies to the right of it."""
        k, side = model.boundary[frozenset((a, b))]
        rows = [a, *side[2:], b]
        inner = model.x[model.members[k][model.kind[k].corners()]].mean(axis=0) - model.x[a]
        along = model.x[b] - model.x[a]
        return Segment(rows, model.x[rows]), bool(along[0] * inner[1] < along[1] * inner[0])

    def meet(self, model):
        """Normals at the ends of the segments; those of corners last, for they may follow the other end."""
        segments = self.segments
        joints = list(zip(segments, segments[1:])) + ([(segments[-1], segments[0])] if self.closed else [])
        for before, after in joints:
            one, two = before.own(1.0), after.own(0.0)
            if one @ two >= BEND:
                n = one * after.chord + two * before.chord
                before.normal[1] = after.normal[0] = n / np.hypot(*n)
                if len(before.nodes) == len(after.nodes) == 3:
                    before.smooth[1] = after.smooth[0] = before.normal[1]
        if not self.closed:
            for segment, end in ((segments[0], 0), (segments[-1], 1)):
                node, n = segment.nodes[-end], segment.own(float(end))
                held = np.flatnonzero(model.is_held[2 * node:2 * node + 2])
                if len(held) == 1 and abs(n[held[0]]) < ALONG:
                    n[held[0]] = 0.0
                    segment.normal[end] = n / np.hypot(*n)
        for segment in segments:
            known = list(segment.normal)
            for end in (0, 1):
                if known[end] is None:
                    other, across = known[1 - end], segment.across
                    mirror = len(segment.nodes) == 2 and other is not None
                    segment.normal[end] = 2 * (other @ across) * across - other if mirror else segment.own(float(end))

    def nodes(self):
        """Rows of the nodes with their outward normals, at a corner between those of its sides."""
        found = {}
        for segment in self.segments:
            for row, s in zip(segment.nodes, segment.places):
                end = {0.0: 0, 1.0: 1}.get(s)
                found[row] = found.get(row, 0.0) + (segment.own(s) if end is None else segment.normal[end])
        return found

    def face(self, x, outward, reach, but=None):
        """(rows of a side, shape values, normal, gap) where a place faces this line, or None: the nearest; of equally near ones
        that which looks most against it. Beyond the end of a side counts only where no side is faced: there the force would
        lie beside the node that it pushes."""
        found = [(beyond, abs(gap), normal @ outward, segment.nodes, values, normal, gap) for segment in self.segments
                 if but not in segment.nodes and segment.near(x, reach)
                 for beyond, values, normal, gap in segment.feet(x) if abs(gap) <= reach and normal @ outward < 0]
        if not found:
            return None
        least = min(found, key=lambda f: f[:2])
        equal = [f for f in found if f[0] == least[0] and f[1] <= least[1] + EQUAL * reach]
        return min(equal, key=lambda f: f[2])[3:]


def averages(model, slave, master, faced, reach):
    """Of each slave row that faces the master line: by master rows the weights whose sum is 1."""
    ring, share = model.kind[0].ring, {row: [] for row in faced}
    ends = [segment.x[end] for segment in master.segments for end in (0, -1)]
    for segment in slave.segments:
        points = list(segment.points([s for x in ends if segment.near(x, reach) for s in segment.roots(x)], ring))
        values, weight = np.array([p[0] for p in points]), np.array([p[3] for p in points])
        seen = [master.face(place, outward, reach) for _, place, outward, _ in points]
        if None in seen or any(row not in faced for row in segment.nodes):
            fits = {row: zip(*faced[row][:2]) for row in segment.nodes if row in faced}
        else:
            columns = sorted({row for side in seen for row in side[0]})
            other = np.array([[dict(zip(side[0], side[1])).get(row, 0.0) for row in columns] for side in seen])
            root = np.sqrt(weight)[:, None]
            fit = np.linalg.lstsq(root * values, root * other, rcond=None)[0]
            fits = {row: zip(columns, line) for row, line in zip(segment.nodes, fit)}
        for row, area in zip(segment.nodes, weight @ values):
            if row in faced:
                share[row].append((area if area > ROUNDING * weight.sum() else 0.0, dict(fits[row])))
    return {row: mean(found) for row, found in share.items()}


def mean(found):
    """Of [(area, values by name)]; where there is no area, at the axis of rings, of equals."""
    if not any(area for area, _ in found):
        found = [(1.0, values) for _, values in found]
    total = {}
    for area, values in found:
        for name, value in values.items():
            total[name] = total.get(name, 0.0) + area * value / sum(area for area, _ in found)
    return total


def pairs_of_lines(model):
    """(slave row, {master row: weight}, normal, gap) of all BCONP."""
    lines = {int(card[1]): Line(model, [model.row[g] for g in ids(card[2:])]) for card in model.deck.of("BLSEG")}
    found = []
    for card in model.deck.of("BCONP"):
        slave, master = lines[int(card[2])], lines[int(card[3])]
        reach = real(model.parameter.get("SEARCH", ""), 2 * max(s.chord for s in slave.segments + master.segments))
        faced = {row: master.face(model.x[row], outward, reach, row) for row, outward in slave.nodes().items()}
        faced = {row: face for row, face in faced.items() if face}
        if not faced:
            raise DeckError(f"BCONP {at(card, 1)} pairs nothing")
        weights = averages(model, slave, master, faced, reach)
        found += [(row, weights[row], face[2], face[3]) for row, face in faced.items()]
    return found
