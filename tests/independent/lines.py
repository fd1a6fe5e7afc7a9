"""Contact between boundary lines: projection of nodes onto the other line, and weights of its displacements.

The nearest of all edges whose normals lead to a point and are opposite to it, with no body between, counts; in a concave corner a second
one too. If normals nearly meet in one point they do so exactly. The master line's displacement is fitted on each slave edge that it covers by the slave's shape functions, least
squares; a slave node's gap is relative to the fits of its edges, averaged with their lengths (axisymmetric: areas) that belong to the node, moved
along the line until forces balance. Edges
that are not covered use the projections of their nodes, and there corners of the master have their own pairs. Where two ends of the
master are flush an edge is two, and each end has a pair. Every edge is tested; standard library only.
"""
from collections import Counter
from dataclasses import dataclass
from math import copysign, hypot

from deck import DeckError, at, ids, real
from kinds import solved
from outline import BEYOND, cross, dot, outline, unit

#: Cosines: of opposite normals; of one face; of one curve; of nearly parallel edges; of pieces without a
#: corner between.
AGAINST, SAME, ONE_CURVE, PARALLEL, NO_CORNER = -0.05, 0.985, 0.816, 0.94, 0.988
#: Fractions of an edge: jump of the gap at a step; distance from a node at which obstacles count; gaps that count as zero.
STEP, ASIDE, THIN = 0.01, 1e-3, 1e-3
#: Distance of a curve from its chord, over chord times angle; fraction of the way that does not count at its ends.
RISE, AT_END = 0.2, 0.01
#: Gaps are equal, relative to the search; weights and areas are zero; gaps are zero, relative to the coordinates; smallest area of a corner on the axis.
EQUAL, NOTHING, ROUNDING, AT_AXIS = 1e-9, 1e-12, 16 * 2.0 ** -52, 1e-3
#: Distance of lines from a centre, relative to its distance; smallest variance of their directions.
ON_LINE, LEAST_TURN = 1e-4, 0.01
#: Search distance, relative to the longest edge; factor of its increase if nothing is found.
SEARCH, FURTHER = 2.0, 4.0


@dataclass
class Eye:
    """A point that is projected: coordinates, normal, vector to the middle of its own edge, distance of its curve; `node`: its name, if it is one."""
    x: list
    outward: list
    along: list
    rise: float
    node: object = None
    at_tip: bool = False


@dataclass
class LinePair:
    """Gap = initial + normal . (of `node` less the sum of `shares`). `stands_on`: for a pair of the master the nodes of the slave's edge."""
    node: object
    shares: dict
    normal: list
    gap: float
    stands_on: tuple = ()
    friction: float = 0.0

    def weights(self):
        return {**{name: -share for name, share in self.shares.items()}, self.node: 1.0 - self.shares.get(self.node, 0.0)}

    def other(self):
        """The node with the largest weight."""
        return max((name for name in self.shares if name != self.node), key=self.shares.get)


def eye_of(segment, k):
    last = len(segment.nodes) - 1
    x = segment.x[k]
    to = segment.centre if k in (0, last) else [(segment.x[-1][c] + x[c]) / 2 for c in (0, 1)]
    tip = k in (0, last) and segment.tip[k > 0]
    return Eye(x, segment.outward(k), [to[c] - x[c] for c in (0, 1)], RISE * segment.bend, segment.nodes[k], tip)


class Line:
    """Some edges of the outline; `bodies`: the whole outline."""

    def __init__(self, segments, bodies):
        self.segments, self.bodies = segments, bodies
        self.own = set(map(id, segments))

    def beside(self, segment, end):
        """The edge before or after, or None beyond the line."""
        other = segment.beside[end]
        return other if id(other) in self.own else None

    def face(self, eye, reach):
        """The best projection within reach, or None, and a second one, or None."""
        more = min(reach, 2 * hypot(*eye.along))
        order = sorted((hypot(*(a - b for a, b in zip(eye.x, one.centre))) - one.chord * (1 + 1e-9), k) for k, one in enumerate(self.segments))
        found, nearest = [], reach
        for least, k in order:
            if least > min(reach * (1 + EQUAL), nearest + more):
                break
            place = self.candidate(self.segments[k], eye, reach)
            if place:
                found.append((k, place))
                nearest = min(nearest, abs(place.gap))
        if not found:
            return None, None
        found = [place for _, place in sorted(found, key=lambda f: f[0])]
        least = min(abs(place.gap) for place in found)
        tied = [place for place in found if abs(place.gap) <= least + EQUAL * reach]
        against = min(dot(place.normal, eye.outward) for place in tied)
        tied = [place for place in tied if dot(place.normal, eye.outward) <= against + EQUAL]
        best = min(tied, key=lambda place: hypot(*(x + y - z for x, y, z in zip(eye.x, eye.along, at_place(place)))))
        both = [place for place in tied if place.at_corner] if eye.at_tip and best.at_corner else []
        if len(both) == 2:
            found = [place for place in found if place not in both]
        others = [place for place in found if dot(place.normal, best.normal) <= SAME and abs(place.gap) <= abs(best.gap) + more]
        second = min(others, key=lambda place: abs(place.gap), default=None)
        if len(both) == 2:   # neither is the better one: between them
            mean = [both[0].normal[c] + both[1].normal[c] for c in (0, 1)]
            best.normal, best.gap = unit(mean), (both[0].gap + both[1].gap) / hypot(*mean)
        for place in (best, second):
            if place and abs(place.gap) <= ROUNDING * max(map(abs, eye.x)):
                place.gap = 0.0
        return best, second

    def candidate(self, segment, eye, reach):
        """The projection of an eye onto an edge, if nothing prevents it."""
        if eye.node in segment.nodes:
            return None
        place = segment.face(eye.x)
        if place is None or abs(place.gap) > reach * (1 + EQUAL) or dot(place.normal, eye.outward) >= AGAINST:
            return None
        if place.at_corner and not eye.at_tip:   # along the normal of the smooth boundary
            place.gap, place.normal = -place.gap * dot(place.normal, eye.outward), [-v for v in eye.outward]
        if place.gap < -max(EQUAL * reach, ROUNDING * max(map(abs, eye.x))) and not self.goes_on(segment, eye, reach):
            return None
        return None if self.blocked(eye, place) else place

    def goes_on(self, segment, eye, reach):
        """Is there also overlap along the eye's own edge?"""
        x = [eye.x[c] + ASIDE * eye.along[c] for c in (0, 1)]
        if segment.face(x):
            return True
        for end in (0, 1):
            other = self.beside(segment, end)
            place = other.face(x) if other else None
            if place and place.gap < reach and dot(place.normal, segment.own(0.5)) > SAME:
                return True
        return False

    def blocked(self, eye, place):
        """Is a body between?"""
        own = 2 * hypot(*eye.along)
        if abs(place.gap) <= THIN * min(place.segment.chord, own):
            return False
        start = max(eye.rise / abs(place.gap), AT_END)
        end = max((RISE * place.segment.bend + ASIDE * own / 2) / abs(place.gap), AT_END)
        if start + end >= 1:
            return False
        a = [eye.x[c] + ASIDE * eye.along[c] for c in (0, 1)]
        way = [-place.gap * n for n in place.normal]
        for one in self.bodies:
            side = one.local[-1]
            area = cross(way, side)
            if area == 0.0:
                continue
            off = [one.x[0][c] - a[c] for c in (0, 1)]
            if start < cross(off, side) / area < 1 - end and 0 <= cross(off, way) / area <= 1:
                return True
        return False


def at_place(place):
    return [sum(v * x[c] for v, x in zip(place.values, place.segment.x)) for c in (0, 1)]


def alike(one, other):
    return dot(one.normal, other.normal) > SAME


class Contact:
    """Projections of the slave's nodes onto the master, within `reach`; `near`: nodes of the master reported as near. `motion`:
    the DOF that moves (node, direction), or its displacement."""

    def __init__(self, slave, master, ring, motion, reach, near=()):
        self.slave, self.master, self.ring, self.motion, self.reach = slave, master, ring, motion, reach
        self.rows = []       # (node, projection)
        self.of = {}         # the row of a node of an edge
        self.look_from_slave()
        self.shares, self.covered = [[] for _ in self.rows], {}
        self.ends = {}       # the rows of ends of the master at joints
        for segment in slave.segments:
            self.average(segment)
        self.pairs = [LinePair(node, mean(share or [(1.0, place.weights())]), place.normal, place.gap)
                      for (node, place), share in zip(self.rows, self.shares)]
        self.look_from_master(near)

    def look_from_slave(self):
        seconds = []
        for segment in self.slave.segments:
            last = len(segment.nodes) - 1
            for k, node in enumerate(segment.nodes):
                other = self.slave.beside(segment, k > 0) if k in (0, last) else None
                row = self.of.get((id(other), node))
                if row is not None and other.normal[k == 0] == segment.normal[k > 0] and node not in [name for name, _ in seconds]:
                    self.of[id(segment), node] = row
                    continue
                best, second = self.master.face(eye_of(segment, k), self.reach)
                if best:   # around a corner each edge has a row of its own
                    like = [i for i, (name, place) in enumerate(self.rows) if name == node and alike(best, place)]
                    self.of[id(segment), node] = like[0] if like else len(self.rows)
                    self.rows += [] if like else [(node, best)]
                if second:
                    seconds.append((node, second))
        for node, place in seconds:
            if not any(name == node and alike(place, other) for name, other in self.rows):
                self.rows.append((node, place))

    def seen_from(self, segment, spans):
        """The points of the pieces of a slave edge, each with its projection and the outward direction."""
        pieces = []
        for low, high, piece in segment.pieces(spans, self.ring):
            seen = []
            for s, values, weight in piece:
                along = [v / 2 for v in segment.towards(s)]
                eye = Eye(segment.at(s), segment.own(s), along, RISE * segment.bend)
                seen.append((s, values, weight, self.master.face(eye, self.reach)[0], eye.outward))
            pieces.append((low, high, seen))
        return pieces

    def average(self, segment):
        """Weights of the master's nodes in the gaps of a slave edge's nodes."""
        rows = [self.of.get((id(segment), node)) for node in segment.nodes]
        faced = [self.rows[row][1] for row in rows if row is not None]
        within = self.reach
        if len(faced) == len(rows):
            within = min(within, max(2 * segment.chord, *(2 * abs(place.gap) for place in faced)))
        cuts = [segment.cut_by(one.x[k], within) for one in self.master.segments for k in (0, -1)]
        spans = segment.spans([s for s in cuts if s is not None])
        pieces = self.seen_from(segment, spans)
        faces = [{id(place.segment) if place else None for *_, place, _ in seen} for *_, seen in pieces]
        first = [k == 0 or len(faces[k - 1] | faces[k]) > 1 for k in range(len(spans))]   # otherwise edges behind it would cut
        if not all(first):
            starts = [low for (low, _), begins in zip(spans, first) if begins]
            ends = [high for (_, high), begins in zip(spans, [*first[1:], True]) if begins]
            pieces = self.seen_from(segment, list(zip(starts, ends)))
        points = [point for *_, seen in pieces for point in seen]
        joints = [k for k in range(1, len(pieces)) if None not in (pieces[k - 1][2][-1][3], pieces[k][2][0][3])
                  and not self.goes_on(pieces[k - 1][2][-1][3], pieces[k][2][0][3])]
        covered = self.covered[id(segment)] = (len(faced) == len(rows) and is_covered(segment, faced, pieces, points)
                                               and not (joints and len(rows) > 2))
        if not covered:
            for i, row in enumerate(rows):
                if row is not None:
                    self.shares[row].append((sum(point[2] * point[1][i] for point in points), self.rows[row][1].weights()))
            return
        for first, last in zip([0, *joints], [*joints, len(pieces)]):
            self.average_between(rows, pieces[first:last], first > 0, last < len(pieces), bool(joints))

    def average_between(self, rows, pieces, cut_before, cut_behind, cut):
        """The same for an edge, or its part between joints, that the other line covers."""
        points = [point for *_, seen in pieces for point in seen]
        begin, end = pieces[0][0], pieces[-1][1]
        if cut:
            points = [(s, [(end - s) / (end - begin), (s - begin) / (end - begin)], *rest) for s, _, *rest in points]
        rows = [self.row_of_end(rows[0], points[0][3], cut_before), *rows[1:-1], self.row_of_end(rows[-1], points[-1][3], cut_behind)]
        areas = [sum(point[2] * point[1][i] for point in points) for i in range(len(rows))]
        for row, area, fit in zip(rows, areas, fitted(points, len(rows))):
            self.shares[row].append((max(area, AT_AXIS * sum(areas)), fit))

    def row_of_end(self, row, place, cut):
        if not cut and self.goes_on(self.rows[row][1], place):
            return row
        self.ends[end_of(place)] = len(self.shares)
        self.shares.append([])
        return len(self.shares) - 1

    def goes_on(self, one, other):
        """Are two points of the master on one edge, on adjacent edges, or at ends that must move together?"""
        if one.segment is other.segment or any(self.master.beside(one.segment, end) is other.segment for end in (0, 1)):
            return True
        return all(self.motion(end_of(one), c) == self.motion(end_of(other), c) for c in (0, 1))

    def look_from_master(self, near):
        """Corners of the master on edges of the slave that are not covered, its ends at joints, and nodes that came near."""
        self.tips = []
        for segment in self.master.segments:
            last = len(segment.nodes) - 1
            for k, node in enumerate(segment.nodes):
                if node in near or k in (0, last) and segment.tip[k > 0]:
                    for place in self.slave.face(eye_of(segment, k), self.reach):
                        if place and (node in self.ends or node in near or not self.covered[id(place.segment)]) and not self.has(node, place):
                            self.tips.append((node, place))
        for node, place in self.tips:
            shares = place.weights()
            if node in self.ends:   # the master's displacement from its row, instead of the node
                own = mean(self.shares[self.ends[node]])
                shares.update({name: (name == node) - share for name, share in own.items() if own.keys() != {node}})
            self.pairs.append(LinePair(node, shares, place.normal, place.gap, tuple(place.segment.nodes)))

    def has(self, node, place):
        """Is it at a node with a pair there, or has it a pair?"""
        most = max(range(len(place.values)), key=lambda i: place.values[i])
        if place.values[most] >= 1 - BEYOND and node not in self.ends:
            row = self.of.get((id(place.segment), place.segment.nodes[most]))
            if row is not None and dot(self.rows[row][1].normal, place.normal) < -ONE_CURVE and not self.beside_joint(self.rows[row][1], node):
                return True
        return any(name == node and alike(place, other) for name, other in self.tips)

    def beside_joint(self, place, node):
        """Is the point an end of the master at the node, but not that end?"""
        if max(place.values) < 1.0 or end_of(place) == node:
            return False
        there = [one.x[k] for one in self.master.segments for k in (0, -1) if one.nodes[k] == node]
        return any(hypot(*(a - b for a, b in zip(x, at_place(place)))) <= BEYOND * place.segment.chord for x in there)


def end_of(place):
    """The end of its edge that is nearer to a point."""
    return place.segment.nodes[0] if place.values[0] >= place.values[-1] else place.segment.nodes[-1]


def is_covered(segment, faced, pieces, points):
    """Is an edge covered by the other line, by one face of it, without a step or a corner?"""
    if any(place is None or dot(place.normal, outward) >= -PARALLEL for *_, place, outward in points):
        return False
    if any(dot(point[3].normal, place.normal) <= ONE_CURVE for point in points for place in faced):
        return False
    ends = [(faced[0].gap, None)]
    for low, high, seen in pieces:
        gaps = [[point[3].gap] for point in seen]
        parabola = [row[0] for row in solved([[1.0, (s - low) / (high - low), ((s - low) / (high - low)) ** 2] for s, *_ in seen], gaps)]
        ends += [(parabola[0], seen[0][3].normal), (sum(parabola), seen[-1][3].normal)]
    ends.append((faced[-1].gap, None))
    for (one, before), (other, after) in zip(ends[::2], ends[1::2]):
        if abs(other - one) > STEP * segment.chord or before and after and dot(before, after) <= NO_CORNER:
            return False
    return True


def fitted(points, count):
    """For each node of an edge the weights of the other line's nodes, by the normal equations of least squares."""
    seen = [point[3].weights() for point in points]
    columns = sorted({node for weights in seen for node in weights})
    matrix = [[sum(w * n[i] * n[j] for _, n, w, *_ in points) for j in range(count)] for i in range(count)]
    right = [[sum(point[2] * point[1][i] * weights.get(node, 0.0) for point, weights in zip(points, seen)) for node in columns] for i in range(count)]
    return [dict(zip(columns, row)) for row in solved(matrix, right)]


def mean(found):
    """Mean of [(area, values by name)]; with equal weights if there is no area."""
    if not sum(area for area, _ in found) > 0:
        found = [(1.0, values) for _, values in found]
    whole, total = sum(area for area, _ in found), {}
    for area, values in found:
        for name, part in values.items():
            total[name] = total.get(name, 0.0) + area * part / whole
    return {name: part for name, part in total.items() if abs(part) > NOTHING}


def line_of(nodes, found):
    """The edges along a BLSEG, the body to the left."""
    walked, i = [], 0
    while i < len(nodes) - 1:
        step = 1 if frozenset(nodes[i:i + 2]) in found else 2
        ends = frozenset((nodes[i], nodes[min(i + step, len(nodes) - 1)]))
        if i + step >= len(nodes) or ends not in found:
            raise DeckError("a line leaves the boundary")
        walked.append(found[ends])
        i += step
    forwards = {segment.nodes[0] == node for segment, node in zip(walked, corners_of(nodes, walked))}
    if len(forwards) > 1:
        raise DeckError("a line turns back")
    return walked if forwards == {True} else walked[::-1]


def corners_of(nodes, walked):
    """Nodes of a line that are ends of edges."""
    ends = {node for segment in walked for node in (segment.nodes[0], segment.nodes[-1])}
    return [node for node in nodes if node in ends]


def joined(contacts):
    """Sets of contacts whose lines continue each other, as lists of their numbers. `contacts`: (slave, master), lists of edges."""
    def meet(one, other):
        return bool(ends_of(one) & ends_of(other))

    sets = []
    for k, (slave, master) in enumerate(contacts):
        with_it = [members for members in sets if any(
            meet(slave, contacts[i][0]) and (set(map(id, slave)) & set(map(id, contacts[i][0])) or meet(master, contacts[i][1])) for i in members)]
        sets = [members for members in sets if members not in with_it] + [sorted(sum(with_it, []) + [k])]
    return sorted(sets)


def ends_of(segments):
    return {node for segment in segments for node in (segment.nodes[0], segment.nodes[-1])}


def pairs_of_lines(deck, parameter, sides, x, held, motion, name=lambda g: g, told=None):
    """For each contact the list of its LinePairs. `held`: (node, direction), ties followed; `motion`: DOF that moves each; `name`: of the node of an id; `told`: names of
    nodes, as often as the program has pairs of them: they identify pairs that came near due to loads."""
    found = outline(sides, x, held, real(parameter.get("CORNER", ""), None)) if deck.of("BCONP") else {}
    lines = {int(card[1]): line_of([name(g) for g in ids(card[2:])], found) for card in deck.of("BLSEG")} if found else {}
    cards, contacts = deck.of("BCONP"), []
    named = [(lines[int(card[2])], lines[int(card[3])]) for card in cards]
    places = list(x.values()) if isinstance(x, dict) else list(x)
    size = sum(max(p[c] for p in places) - min(p[c] for p in places) for c in (0, 1))
    sets = joined(named)
    for members in sets:
        slave, master = (Line(list({id(one): one for k in members for one in named[k][which]}.values()), list(found.values())) for which in (0, 1))
        ring = sides[frozenset((slave.segments[0].nodes[0], slave.segments[0].nodes[-1]))].thickness is None
        reach = real(parameter.get("SEARCH", ""), SEARCH * max(one.chord for one in slave.segments + master.segments))
        contact = Contact(slave, master, ring, motion, reach)
        while not contact.pairs:
            if reach > size:
                raise DeckError(f"BCONP {at(cards[members[0]], 1)} pairs nothing")
            reach *= FURTHER
            contact = Contact(slave, master, ring, motion, reach)
        contacts.append(contact)
    if told is not None:
        came_near(contacts, Counter(told), size)
    for members, contact in zip(sets, contacts):
        for pair in contact.pairs:
            pair.friction = deck.friction(cards[members[0]])
    place = x if isinstance(x, dict) else dict(enumerate(x))
    cut = {one.nodes[-end] for one in found.values() for end in (0, 1)
           if (one.mirrored[end] or one.corner[end]) and {(one.nodes[-end], 0), (one.nodes[-end], 1)} & held}
    centres = []
    for contact in contacts:
        own = {node: one.outward(k) for one in contact.slave.segments for k, node in enumerate(one.nodes)}
        balance([pair for pair in contact.pairs if pair.node not in cut], place, centres, own)
    return [contact.pairs for contact in contacts]


def balance(pairs, x, centres, own):
    """Forces of round contact meet in one of the centres, or a new one, each with its reaction on its line; `own`: for a round slave."""
    turned = [pair for pair in pairs if not pair.stands_on]
    centre, radius = centre_of([(x[pair.node], pair.normal) for pair in turned])
    if radius:
        middle, is_round = centre_of([(x[pair.node], own[pair.node]) for pair in turned])
        if is_round and all(dot(pair.normal, [x[pair.node][c] - centre[c] for c in (0, 1)]) < 0 for pair in turned):
            centre, turned = middle, pairs
        centre = next((other for other in centres if hypot(*(a - b for a, b in zip(other, centre))) <= ON_LINE * radius), centre)
        centres.append(centre)
        for pair in turned:
            away = [x[pair.node][c] - centre[c] for c in (0, 1)]
            pair.normal = [copysign(1.0, dot(pair.normal, away)) * v for v in unit(away)]
    for pair in pairs:
        along = {node: cross(pair.normal, [x[node][c] - x[pair.node][c] for c in (0, 1)]) for node in pair.shares}
        much = {node: abs(share) for node, share in pair.shares.items()}
        middle = sum(much[node] * along[node] for node in much) / sum(much.values())
        lever = sum(share * along[node] for node, share in pair.shares.items())
        width = sum(much[node] * (along[node] - middle) ** 2 for node in much)
        if abs(lever) > NOTHING * width ** 0.5 > 0:
            pair.shares = {node: share - lever * much[node] * (along[node] - middle) / width for node, share in pair.shares.items()}


def centre_of(lines):
    """Point where lines (point, direction) nearly meet, and the smallest distance of the points from there; 0.0 if they do not, or turn by little."""
    across = [(-n[1], n[0]) for _, n in lines]
    matrix = [[sum(t[i] * t[j] for t in across) for j in (0, 1)] for i in (0, 1)]
    if not lines or matrix[0][0] * matrix[1][1] - matrix[0][1] ** 2 < LEAST_TURN * len(lines) ** 2:
        return None, 0.0
    from_first = [[p[c] - lines[0][0][c] for c in (0, 1)] for p, _ in lines]
    off = solved(matrix, [[sum(t[i] * dot(t, p) for t, p in zip(across, from_first))] for i in (0, 1)])
    away = [[p[c] - off[c][0] for c in (0, 1)] for p in from_first]
    radius = min(hypot(*p) for p in away)
    meet = all(abs(dot(t, p)) <= ON_LINE * radius for t, p in zip(across, away))
    return [lines[0][0][c] + off[c][0] for c in (0, 1)], radius if meet else 0.0


def came_near(contacts, told, size):
    """Search again for reported pairs that were not found; those at the limit of the search are optional."""
    found = Counter(pair.node for contact in contacts for pair in contact.pairs)
    lacking, strange = told - found, found - told
    for k, contact in enumerate(contacts):
        contact.pairs = [pair for pair in contact.pairs if pair.node not in strange or abs(pair.gap) < contact.reach * (1 - EQUAL)]
        slave, master = ({node for one in line.segments for node in one.nodes} for line in (contact.slave, contact.master))
        late = [(line, other, lacking.keys() & nodes) for line, other, nodes in
                ((contact.slave, contact.master, slave), (contact.master, contact.slave, master))]
        gaps = [abs(place.gap) for line, other, nodes in late for one in line.segments for i, node in enumerate(one.nodes) if node in nodes
                for place in other.face(eye_of(one, i), size)[:told[node]] if place]
        if gaps:
            reach = max(contact.reach, max(gaps) * (1 + EQUAL))
            contacts[k] = Contact(contact.slave, contact.master, contact.ring, contact.motion, reach, late[1][2])
