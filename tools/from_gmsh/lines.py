"""Lines of edges: their order, and the distribution of a force to their nodes."""
import math

GAUSS = [(0.5 - math.sqrt(0.15), 5 / 18), (0.5, 8 / 18), (0.5 + math.sqrt(0.15), 5 / 18)]


def nodes_of(sides):
    """Each node once, in the order of the edges."""
    return list(dict.fromkeys(node for side in sides for node in (side[0], *side[2:], side[1])))


def chains(sides):
    """The nodes in order along each piece; a closed one ends with its first node. None if edges branch."""
    at = {}
    for side in sides:
        for node in side[:2]:
            at.setdefault(node, []).append(side)
    if any(len(own) > 2 for own in at.values()):
        return None
    found, left = [], dict.fromkeys(sides)
    for start in [node for node, own in at.items() if len(own) == 1] + list(at):
        chain, here = [start], start
        while True:
            side = next((side for side in at[here] if side in left), None)
            if side is None:
                break
            del left[side]
            here = side[1] if side[0] == here else side[0]
            chain += [*side[2:], here]
        if len(chain) > 1:
            found.append(chain)
    return found


def shares(sides, place, rings):
    """Nodal forces of a force that is uniform over the edges; if axisymmetric, over their area. None if the area is zero."""
    found = {}
    for side in sides:
        x = [place[node] for node in side]
        for s, weight in GAUSS:
            values, slopes = shape(len(side), s)
            along = math.hypot(*(sum(slope * p[c] for slope, p in zip(slopes, x)) for c in (0, 1)))
            radius = sum(value * p[0] for value, p in zip(values, x)) if rings else 1.0
            for node, value in zip(side, values):
                found[node] = found.get(node, 0.0) + weight * along * radius * value
    whole = sum(found.values())
    return {node: share / whole for node, share in found.items()} if whole > 0.0 else None


def shape(count, s):
    """Shape functions of start, end and mid-side node, and their slopes, at a coordinate from 0 to 1."""
    if count == 2:
        return (1 - s, s), (-1.0, 1.0)
    return ((1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)), (4 * s - 3, 4 * s - 1, 4 - 8 * s)
