"""A punch on a block, as a half or whole, rigid or elastic, of any element, in any position: models whose results must agree.

The block is 4 high, the punch 1; contact is at y = 0 about x = 0, the symmetry line or the axis.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "extremes"))
from scene import PLANE_STRAIN, RINGS, Deck  # noqa: E402

FIRST_OF_PUNCH, LEADER = 5001, 9999


def grid(first, x0, y0, width, height, across, up, kind):
    """Coordinates by id, elements, and the rows of ids. Diagonals are mirrored at x = 0."""
    step = 2 if kind.endswith("6") else 1
    rows = [[first + i + j * (step * across + 1) for i in range(step * across + 1)] for j in range(step * up + 1)]
    place = {rows[j][i]: (x0 + width * i / (step * across), y0 + height * j / (step * up))
             for j in range(step * up + 1) for i in range(step * across + 1)}
    elements = []
    for j in range(0, step * up, step):
        for i in range(0, step * across, step):
            a, b, c, d = rows[j][i], rows[j][i + step], rows[j + step][i + step], rows[j + step][i]
            left = place[a][0] + place[b][0] < 0.0
            if kind == "CQUAD4":
                elements.append((a, b, c, d))
            elif step == 1:
                elements += [(a, b, d), (b, c, d)] if left else [(a, b, c), (a, c, d)]
            else:
                ab, bc, cd, da, m = rows[j][i + 1], rows[j + 1][i + 2], rows[j + 2][i + 1], rows[j + 1][i], rows[j + 1][i + 1]
                elements += [(a, b, d, ab, m, da), (b, c, d, bc, cd, m)] if left else [(a, b, c, ab, bc, m), (a, c, d, m, cd, da)]
    return place, elements, rows


def new_deck(kind, young=1000.0):
    return Deck(young, 0.3, plane=RINGS if kind.startswith("CTRAX") else PLANE_STRAIN)


def block(deck, first, x0, y0, width, height, across, up, kind):
    """Such a grid, in a deck."""
    place, elements, rows = grid(first, x0, y0, width, height, across, up, kind)
    for n, at in place.items():
        deck.grid(n, *at)
    for nodes in elements:
        deck.element(1, *nodes, kind=kind)
    return place, elements, rows


class Punch:
    """`shape`: height of the punch's face over x. `how`: rigid (tied by RBE2 to a guided node), held (all its nodes are fixed, and moved
    down), elastic (pressed by a platen on the nodes of its top from `platen` on). `load`: of the whole; `travel` of the held one."""

    def __init__(self, kind, half=True, shape=lambda x: 0.0, how="elastic", slave="punch", pairs=False, across=10, finer=1.0, load=60.0,
                 travel=0.03, platen=0.0, reach=4.0):
        self.kind, self.rings, self.slave, self.pairs = kind, kind.startswith("CTRAX"), slave, pairs
        sides, left = (1, 0.0) if half else (2, -1.0)
        block, below, low = grid(1, 4.0 * left, -4.0, 4.0 * sides, 4.0, across * sides, 5, kind)
        punch, above, high = grid(FIRST_OF_PUNCH, reach * left, 0.0, reach * sides, 1.0, round(across * finer * reach / 4.0) * sides, 2, kind)
        self.place = {**block, **{n: (x, y + shape(x) * (1.0 - y)) for n, (x, y) in punch.items()}}
        self.elements = [(1, nodes) for nodes in below] + [(2, nodes) for nodes in above]
        self.upper, self.lower = high[0], low[-1]
        axis = [n for n, (x, y) in self.place.items() if x == 0.0]
        self.held = {(n, 2): 0.0 for n in low[0]}
        self.held.update({(n, 1): 0.0 for n in axis if half or n in low[0] or (n in punch and how == "elastic")})
        self.tied, self.driven = None, None
        if how == "held":
            self.held.update({(n, 1): 0.0 for n in punch} | {(n, 2): -travel for n in punch})
            return
        top = [n for n in high[-1] if abs(self.place[n][0]) >= platen]
        if how == "rigid":
            self.place[LEADER] = (0.0, 2.0)
            self.held = {freedom: value for freedom, value in self.held.items() if freedom[0] not in punch} | {(LEADER, 1): 0.0}
            self.tied = (LEADER, (1, 2), list(punch))
        else:
            self.tied = (top[0], (2,), top[1:])
        self.driven = self.tied[0], -(load / 2 if half and not self.rings else load)

    def deck(self, image=None, backwards=False, rename=lambda n: n):
        """`image`: transformation of vectors; lines or pairs in the opposite direction; other ids."""
        image = image or (lambda v: v)
        (ax, ay), (bx, by) = image((1.0, 0.0)), image((0.0, 1.0))
        turned_over = ax * by - ay * bx < 0.0
        deck = new_deck(self.kind)
        deck.material(2, 5000.0, 0.3)
        for n, at in self.place.items():
            deck.grid(rename(n), *image(at))
        for material, nodes in self.elements:
            if turned_over:
                nodes = nodes[:1] + nodes[:0:-1] if len(nodes) < 6 else (nodes[0], nodes[2], nodes[1], nodes[5], nodes[4], nodes[3])
            deck.element(material, *map(rename, nodes), kind=self.kind)
        for (n, c), value in self.held.items():
            along, size = self.turned(image, c)
            deck.displace(rename(n), along, size * value)
        if self.tied:
            leader, directions, nodes = self.tied
            deck.card("RBE2", 99999, rename(leader), "".join(sorted(str(self.turned(image, c)[0]) for c in directions)), *map(rename, nodes))
            deck.support(self.turned(image, 2)[0], rename(leader))
            deck.force(rename(leader), *image((0.0, self.driven[1])))
        self.contact(deck, image, backwards, rename)
        return deck

    @staticmethod
    def turned(image, c):
        """Image of a direction, and its sign."""
        x, y = image((1.0, 0.0) if c == 1 else (0.0, 1.0))
        return (1, x) if x else (2, y)

    def contact(self, deck, image, backwards, rename):
        if self.pairs:
            deck.parameter("GAPGEOM", "YES")
            at = {round(self.place[n][0], 9): n for n in self.lower}
            for k, n in enumerate(reversed(self.upper) if backwards else self.upper):
                deck.pair(80001 + k, rename(at[round(self.place[n][0], 9)]), rename(n), normal=image((0.0, 1.0)))
            return
        way = (2 if self.kind.endswith("6") else 1) * (-1 if backwards else 1)
        deck.lines(*(map(rename, line[::way]) for line in (self.upper, self.lower)), 1 if self.slave == "punch" else 2)
