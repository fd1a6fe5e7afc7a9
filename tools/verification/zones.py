"""Contact zones from the pairs in contact: neighbours along the boundary, runs, half-widths."""
import math

from pressures import ALONG, BESIDE, chains, on_symmetry, stands


class Zone:
    """`half_width`: None if no end is found on either side."""

    def __init__(self, run, force, peak, width, half_width):
        self.first, self.last, self.force, self.peak, self.width, self.half_width = run[0], run[-1], force, peak, width, half_width


def neighbours(scene):
    """Neighbours of each pair along its tangent, in the same contact, including the pairs of the master's nodes between them. Also
    the pairs on symmetry lines at which a line ends."""
    around = {}
    for side in scene.side.values():
        for node in side.nodes:
            around.setdefault(node, []).append(side)
    found, mirrored = {}, set()
    for contact in scene.contacts:
        at = pairs_by_side(scene, contact)
        for name in contact:
            pair, own = scene.pair[name], []
            for side in around.get(pair.node, []) if not pair.stands_on else []:
                a, b = side.nodes[:2]
                along = [scene.x[b][c] - scene.x[a][c] for c in (0, 1)]
                if abs(along[0] * pair.normal[0] + along[1] * pair.normal[1]) > ALONG * math.hypot(*along):
                    continue
                beside = [a, b] if pair.node in side.nodes[2:] else [*side.nodes[2:], b if pair.node == a else a][:1]
                own += [at(node, side) for node in beside]
            found[name] = own[:2]
            longest = max((math.dist(*(scene.x[end] for end in side.nodes[:2])) for side in around.get(pair.node, [])), default=0.0)
            if not pair.stands_on and sum(other is not None for other in own[:2]) < 2 and \
                    on_symmetry(pair.node, pair.normal, pair.weights, scene.x, scene.held, scene.leader, BESIDE * longest):
                mirrored.add(name)
        insert_masters(scene, contact, at, found)
    return {name: [other for other in others if other is not None] for name, others in found.items()}, mirrored


def pairs_by_side(scene, contact):
    """Return a function of node and edge: the node's pair with the opposite edge; if there are several, that with the normal most nearly perpendicular to it."""
    of_node = {}
    for name in contact:
        if not scene.pair[name].stands_on:
            of_node.setdefault(scene.pair[name].node, []).append(name)

    def at(node, side):
        (xa, ya), (xb, yb) = (scene.x[end] for end in side.nodes[:2])
        return min(of_node.get(node, []), default=None,
                   key=lambda name: abs((xb - xa) * scene.pair[name].normal[0] + (yb - ya) * scene.pair[name].normal[1]))
    return at


def insert_masters(scene, contact, at, found):
    """Insert the pairs of the master's nodes between neighbouring nodes of a slave edge."""
    on = {name: scene.pair[name].stands_on for name in contact if scene.pair[name].stands_on}
    feet = {name: stands(scene.x, scene.pair[name].weights, scene.pair[name].node) for name in on}
    for ends, order in chains(scene.side, scene.x, on, feet):
        run = [at(node, scene.side[ends]) if tip is None else tip for node, tip, _ in order]
        fixed = [k for k, (_, tip, _) in enumerate(order) if tip is None]
        for first, last in zip(fixed, fixed[1:]):
            if last == first + 1:
                continue
            for k, step, beyond in ((first, 1, last), (last, -1, first)):
                if run[k] is not None:
                    own = found[run[k]]
                    own += [None] * (2 - len(own))
                    slot = own.index(run[beyond]) if run[beyond] in own else own.index(None) if None in own else 1
                    own[slot] = run[k + step]
            for k in range(first + 1, last):
                found[run[k]] = [run[k - 1], run[k + 1]]


def zones(scene, touching, force, pressure, told=()):
    """Find the runs of pairs in contact, in the order of the deck; all arguments are by the name of a pair. A pair without pressure (a corner on the
    axis) is in contact if a neighbour is. `told`: nodes at the ends of runs, because a closed run may
    begin anywhere."""
    beside, mirrored = neighbours(scene)
    touching = {name: touches or pressure[name] < 0.0 and any(touching[other] for other in beside[name]) for name, touches in touching.items()}
    linked = {name: set() for name in scene.pair}
    for name, others in beside.items():
        for other in others:
            if touching[name] and touching[other]:
                linked[name].add(other)
                linked[other].add(name)
    rank, done, found = {name: k for k, name in enumerate(scene.pair)}, set(), []
    for name in scene.pair:
        if not touching[name] or name in done:
            continue
        reached, front = {name}, [name]
        while front:
            front = [other for each in front for other in linked[each] if other not in reached and not reached.add(other)]
        done |= reached
        run = walk(beside, touching, walk(beside, touching, name)[-1])
        run = run if rank[run[0]] <= rank[run[-1]] else run[::-1]
        if len(run) > 2 and run[0] in beside[run[-1]]:
            run = next((way for way in turned(run) if (scene.pair[way[0]].ends[1], scene.pair[way[-1]].ends[1]) in told), run)
        found.append(measured(scene, beside, mirrored, touching, force, pressure, run))
    return found


def walk(beside, touching, start):
    run, seen = [start], {start}
    while True:
        following = next((other for other in beside[run[-1]] if touching[other] and other not in seen), None)
        if following is None:
            return run
        run.append(following)
        seen.add(following)


def turned(run):
    """All start points and directions of a closed run."""
    for k in range(len(run)):
        way = run[k:] + run[:k]
        yield from (way, way[::-1])


def measured(scene, beside, mirrored, touching, force, pressure, run):
    def apart(a, b):
        return math.dist(scene.x[scene.pair[a].node], scene.x[scene.pair[b].node])

    def beyond(run):
        """Distance from the last pair to the end of the pressure, with p**2 linear; if the pressure rises at the end, at most to the first open
        pair. None if the pressure there is not below half of the largest."""
        opened = [other for other in beside[run[-1]] if not touching[other]]
        if len(run) < 2 or not opened or pressure[run[-1]] >= 0.5 * max(pressure[name] for name in run):
            return None
        drop, to_open = pressure[run[-2]] ** 2 - pressure[run[-1]] ** 2, apart(run[-1], opened[-1])
        return min(apart(run[-1], run[-2]) * pressure[run[-1]] ** 2 / drop, to_open) if drop > 0.0 else to_open

    length = math.fsum(apart(a, b) for a, b in zip(run, run[1:]))
    ends = [beyond(run[::-1]), beyond(run)]
    if (run[0] in mirrored) != (run[-1] in mirrored):
        part, ends = 1.0, ends[1:] if run[0] in mirrored else ends[:1]
    else:
        part = 0.5
    half_width = part * (length + sum(ends)) if None not in ends else None
    return Zone(run, math.fsum(force[name] for name in run), max(pressure[name] for name in run), part * length, half_width)
