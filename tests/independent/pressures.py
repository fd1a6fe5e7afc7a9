"""Pressures of pairs from their forces: force over area, and along six-node edges in contact the derivative of the cumulative force
at each corner by the cumulative area. Standard library only.

The sum is known at the corners of a run of edges in full contact; a polynomial in Newton's form passes through those around
a node. If the run ends on a symmetry line it continues mirrored; at the axis this is not needed, because a pressure
that is even in the radius is smooth in the area. A closed run continues with itself. At an end of contact, the outermost corner
and mid-side node keep force over area; the force of that corner belongs only to the run, unless the next mid-side node is in contact too.

Pairs of the master closer to another than CLOSE times the node distance are at one point with it, and have the pressure of both.

A corner on the axis has no area. It is in contact if the mid-side node beside it is, and has that node's pressure if
its run has less than three corners; it is reported only if it is in contact itself.
"""
from math import hypot, sqrt

from boundary import side_points

ALONG, NO_AREA, UPRIGHT = sqrt(0.5) * (1 + 1e-6), 1e-3, 0.9
AROUND_MIDDLE, AROUND_CORNER, LEAST, LEAST_AT_AXIS = 4, 5, 4, 3
BESIDE = 1e-3
CLOSE = 0.22


def share(side, x, n):
    """Nodal forces of a uniform pressure on an edge along n, over that pressure."""
    found = [0.0] * len(side.nodes)
    for values, place, tangent, _ in side_points([x[node] for node in side.nodes]):
        size = side.depth(place[0]) * abs(tangent[0] * n[1] - tangent[1] * n[0])
        found = [total + size * value for total, value in zip(found, values)]
    if side.thickness is None and len(side.nodes) == 3:   # the small area of a corner on the axis is that of the mid-side node
        small = [total if x[node][0] == 0.0 else 0.0 for node, total in zip(side.nodes[:2], found)] + [0.0]
        found = [total - part for total, part in zip(found, small)]
        found[2] += sum(small)
    return [total if abs(total) > NO_AREA * sum(found) else 0.0 for total in found]


def areas(sides, x, pairs):
    """For each pair (node, normal) its area by edges, if the chord is within 45 degrees of the tangent."""
    around = {}
    for ends, side in sides.items():
        for node in side.nodes:
            around.setdefault(node, []).append(ends)
    found = []
    for node, n in pairs:
        own = {}
        for ends in around.get(node, []):
            (xa, ya), (xb, yb) = (x[end] for end in sides[ends].nodes[:2])
            if abs((xb - xa) * n[0] + (yb - ya) * n[1]) <= ALONG * hypot(xb - xa, yb - ya):
                own[ends] = share(sides[ends], x, n)[sides[ends].nodes.index(node)]
        found.append(own)
    return found


def slope(places, values, at):
    """Derivative at a point of the polynomial through (coordinates, values), by divided differences."""
    table = list(values)
    for order in range(1, len(table)):
        for k in range(len(table) - 1, order - 1, -1):
            table[k] = (table[k] - table[k - 1]) / (places[k] - places[k - order])
    value, derivative = table[-1], 0.0
    for place, coefficient in zip(places[-2::-1], table[-2::-1]):
        derivative = derivative * (at - place) + value
        value = value * (at - place) + coefficient
    return derivative


def runs(sides, at, own):
    """Chains of six-node edges with all nodes in contact: [(corner, middle, corner, ...)] of pair numbers. `at`: those in contact,
    for one contact, by their nodes."""
    whole = [tuple(at[side.nodes[i]] for i in (0, 2, 1)) for ends, side in sides.items()
             if len(side.nodes) == 3 and all(node in at and ends in own[at[node]] for node in side.nodes)]
    whole.sort(key=lambda side: side[1])
    chains = []
    while whole:
        chain = list(whole.pop(0))
        for _ in range(2):
            while True:
                following = next((side for side in whole if chain[-1] in (side[0], side[2])), None)
                if following is None:
                    break
                whole.remove(following)
                chain += following[1:] if following[0] == chain[-1] else following[1::-1]
            chain.reverse()
        chains.append(chain)
    return chains


class Run:
    """Sums of area and force up to the corners of a chain, mirrored beyond its ends; the chain's own begin at `first`."""

    def __init__(self, chain, own, force, mirrored, axis, shared):
        """`shared`: edges with a mid-side node in contact, by pair number of the corner."""
        self.chain = chain
        closed = chain[0] == chain[-1]
        self.even = [mirrored[end] or closed for end in (chain[0], chain[-1])]
        self.area, self.force, self.first = [0.0], [0.0], 0
        for k in range(1, len(chain), 2):
            both = own[chain[k]].keys() & own[chain[k - 1]].keys() & own[chain[k + 1]].keys()
            parts = [(node, sum(own[node][ends] for ends in both)) for node in chain[k - 1:k + 2]]
            whole = [part + sum(area for ends, area in own[node].items() if ends not in both and ends in shared[node])
                     for node, part in parts]
            bear = [force[node] * (part / total if total else 1.0) for (node, part), total in zip(parts, whole)]
            self.area.append(self.area[-1] + sum(part for _, part in parts))
            self.force.append(self.force[-1] + sum(bear))
        count, beyond = len(self.area), min(len(self.area) - 1, AROUND_CORNER // 2)
        if closed:
            self.first = beyond
            for total in (self.area, self.force):
                after = [total[-1] + total[k] for k in range(1, beyond + 1)]
                before = [total[count - 1 - k] - total[-1] for k in range(beyond, 0, -1)]
                total[:] = before + total + after
            return
        if self.even[1] and not axis[chain[-1]]:
            for total in (self.area, self.force):
                total += [2 * total[count - 1] - total[count - 1 - k] for k in range(1, beyond + 1)]
        if self.even[0] and not axis[chain[0]]:
            self.first = beyond
            for total in (self.area, self.force):
                total[:0] = [-total[k] for k in range(beyond, 0, -1)]

    def slope(self, first, many, at):
        first = max(0, min(first, len(self.area) - many))
        return slope(self.area[first:first + many], self.force[first:first + many], at)

    def pressures(self, x, ring):
        """(pair, pressure) of all nodes except those at ends of contact. x of each pair."""
        if len(self.area) < LEAST:
            for end in (0, -1):
                if ring and x[self.chain[end]][0] == 0.0 and len(self.area) >= LEAST_AT_AXIS:
                    yield self.chain[end], self.slope(0, LEAST_AT_AXIS, self.area[end])
            return
        last = len(self.chain) - 1
        for i in range(0 if self.even[0] else 2, last + 1 if self.even[1] else last - 1):
            k, here = self.first + i // 2, self.chain[i]
            if i % 2 == 0:
                yield here, self.slope(k - AROUND_CORNER // 2, AROUND_CORNER, self.area[k])
                continue
            a, m, b = (x[node] for node in self.chain[i - 1:i + 2])
            one, two = (hypot(q[0] - p[0], q[1] - p[1]) * (p[0] + q[0] if ring else 1.0) for p, q in ((a, m), (m, b)))
            at = self.area[k] + (self.area[k + 1] - self.area[k]) * one / (one + two)
            yield here, self.slope(k - AROUND_MIDDLE // 2 + 1, AROUND_MIDDLE, at)


def on_symmetry(node, n, others, x, held, leader, near):
    """Is a node fixed along its edge, and the other body too, if it ends at the same line or everywhere; one of the two by itself?"""
    along = 0 if abs(n[1]) > UPRIGHT else 1 if abs(n[0]) > UPRIGHT else None

    def top(freedom):
        while leader.get(freedom, freedom) != freedom:
            freedom = leader[freedom]
        return freedom

    def guided(one):
        return (one, along) in held and top((one, 1 - along)) not in held

    if along is None or top((node, along)) not in held:
        return False
    others = [other for other in others if other != node]
    holding = [other for other in others if top((other, along)) in held]
    here = [other for other in holding if abs(x[other][along] - x[node][along]) <= near]
    return bool(here or len(holding) == len(others)) and any(guided(one) for one in [node, *here])


def stands(x, weights, node):
    """Coordinates of the projection of a pair's node on the other line. `weights`: of all nodes of the pair."""
    return [(1.0 - weights[node]) * x[node][c] - sum(w * x[other][c] for other, w in weights.items() if other != node) for c in (0, 1)]


def chains(sides, x, stands_on, feet):
    """For each slave edge with a node of the master on it: its ends, and (node of the edge, or None, and pair number of the master, or
    None) in their order. `stands_on`: nodes of the edge by pair number; `feet`: its coordinates."""
    found = {}
    for k, nodes in stands_on.items():
        found.setdefault(frozenset((nodes[0], nodes[-1])), []).append(k)
    for ends, tips in found.items():
        a, b, *middle = sides[ends].nodes
        order = [(node, None, x[node]) for node in (a, *middle, b)] + [(None, k, feet[k]) for k in tips]
        yield ends, sorted(order, key=lambda one: sum((one[2][c] - x[a][c]) * (x[b][c] - x[a][c]) for c in (0, 1)))


def divide(sides, x, pairs, own, group, stands_on, feet):
    """Nodes of the master on an edge share its area with the slave's: half of each piece belongs to each of its ends, which projects
    it along its own normal. For those edges the neighbours of each pair; and the pairs at one point, in twos."""

    def at(node, ends):
        """The node's pair with the opposite edge; of several the one whose normal is most nearly perpendicular to it."""
        (xa, ya), (xb, yb) = (x[end] for end in sides[ends].nodes[:2])
        own = [k for k in group if k not in stands_on and pairs[k][0] == node]
        return min(own, key=lambda k: abs((xb - xa) * pairs[k][1][0] + (yb - ya) * pairs[k][1][1]), default=None)

    of_group = {k: nodes for k, nodes in stands_on.items() if k in group}
    divided, close = {}, []
    for ends, order in chains(sides, x, of_group, feet):
        a, b = sides[ends].nodes[:2]
        chord = hypot(x[b][0] - x[a][0], x[b][1] - x[a][1])
        run = [(at(node, ends) if k is None else k, place) for node, k, place in order]
        for k, _ in run:
            if k is not None and (ends in own[k] or k in of_group):
                own[k][ends] = 0.0
        divided[ends] = {}
        for (one, p), (other, q) in zip(run, run[1:]):
            divided[ends].setdefault(one, set()).add(other)
            divided[ends].setdefault(other, set()).add(one)
            if one is not None and other is not None:
                piece = hypot(q[0] - p[0], q[1] - p[1])
                for k in (one, other):
                    own[k][ends] = own[k].get(ends, 0.0) + sum(share(sides[ends], x, pairs[k][1])) * piece / chord / 2
                if piece < CLOSE * chord / (len(sides[ends].nodes) - 1):
                    close.append((one, other))
    return divided, close


def level(close, own, forces, found):
    """Pairs at one point with a force get the pressure of all of them."""
    place = {}
    for pair in close:
        both = place.setdefault(pair[0], {pair[0]}) | place.setdefault(pair[1], {pair[1]})
        place.update(dict.fromkeys(both, both))
    for k, members in place.items():
        area = sum(sum(own[member].values()) for member in members)
        if forces[k] > 0.0 and area > 0.0:
            found[k] = sum(forces[member] for member in members) / area


def pressures(sides, x, held, leader, pairs, groups, forces, touching, stands_on=None):
    """Pressure of each pair, None without area. `pairs`: (node on an edge, normal, weights of all nodes of the pair); `held`: (node,
    direction); `leader`: of each dependent (node, direction); `groups`: the pair numbers of each contact; `stands_on`: for pairs of the master the
    nodes of the slave's edge."""
    stands_on = stands_on or {}
    feet = {k: stands(x, pairs[k][2], pairs[k][0]) for k in stands_on}
    said, others, pairs = touching, [list(weights) for *_, weights in pairs], [(node, n) for node, n, _ in pairs]
    own = areas(sides, x, pairs)
    for k in stands_on:
        own[k] = {}
    touching = list(said)
    beside, ends_here = {}, [False] * len(pairs)
    for group in groups:
        at = {pairs[k][0]: k for k in reversed(group) if k not in stands_on}
        for k in group:
            ends_here[k] = sum(any(node in at for node in (sides[ends].nodes[2:] or sides[ends].nodes) if node != pairs[k][0]) for ends in own[k]) < 2
            if own[k] and not any(own[k].values()):
                near = [at.get(node) for ends in own[k] for node in (sides[ends].nodes[2:] or sides[ends].nodes) if node != pairs[k][0]]
                beside[k] = next((other for other in near if other is not None and said[other]), None)
                touching[k] = said[k] or beside[k] is not None
    divided, close = zip(*(divide(sides, x, pairs, own, group, stands_on, feet) for group in groups)) if groups else ((), ())
    found = [force / sum(area.values()) if sum(area.values()) > 0 else None for force, area in zip(forces, own)]
    ring = any(side.thickness is None for side in sides.values())
    place = [x[node] for node, _ in pairs]
    chord = [max((hypot(x[b][0] - x[a][0], x[b][1] - x[a][1]) for a, b in (sides[ends].nodes[:2] for ends in area)), default=0.0) for area in own]
    mirrored = [ends_here[k] and on_symmetry(node, n, others[k], x, held, leader, BESIDE * chord[k]) for k, (node, n) in enumerate(pairs)]
    axis = [ring and p[0] == 0.0 for p in place]
    for group, split in zip(groups, divided):
        at = {pairs[k][0]: k for k in reversed(group) if k not in stands_on}
        shared = {k: {ends for ends in own[k] if any(touching[at[node]] for node in sides[ends].nodes[2:] if node in at)} for k in group if k not in stands_on}
        for ends, beside_it in split.items():
            for k in beside_it.keys() & shared.keys():
                if any(other is not None and touching[other] for other in beside_it[k]):
                    shared[k].add(ends)
                else:
                    shared[k].discard(ends)
        for chain in runs({ends: side for ends, side in sides.items() if ends not in split}, {node: k for node, k in at.items() if touching[k]}, own):
            for k, pressure in Run(chain, own, forces, mirrored, axis, shared).pressures(place, ring):
                found[k] = pressure
    level([pair for pairs_at in close for pair in pairs_at], own, forces, found)
    for k, other in beside.items():
        if other is not None and found[k] is None:
            found[k] = found[other]
        if not said[k]:
            found[k] = None
    return found
