"""Meshes of bodies: blocks with a shaped side, discs, plates with a hole."""
import math


def number_of(length, h):
    return max(1, round(length / h))


def cells(body, xs, ys, h, full=lambda i, j: True, shape=lambda x, y: (x, y), up=None):
    """Blocks between lines x and y, if full; the number of elements is length over h and height over `up`; points are moved by shape."""
    for i, (x0, x1) in enumerate(zip(xs, xs[1:])):
        for j, (y0, y1) in enumerate(zip(ys, ys[1:])):
            if full(i, j):
                body.patch(lambda s, t: shape(x0 + (x1 - x0) * s, y0 + (y1 - y0) * t), number_of(x1 - x0, h), number_of(y1 - y0, up or h))


def profiled(body, xs, top, profile, h, up=None):
    """A block below y = top whose lower side is y = profile(x), with corners at xs."""
    depth = top - min(profile(x) for x in xs)
    cells(body, xs, [0.0, 1.0], h, up=(up or h) / depth, shape=lambda x, t: (x, profile(x) + (top - profile(x)) * t))


def profiled_up(body, xs, low, profile, h):
    """A block above y = low whose upper side is y = profile(x)."""
    height = max(map(profile, xs)) - low
    cells(body, xs, [0.0, 1.0], h, up=max(h, 0.2) / height, shape=lambda x, t: (x, low + (profile(x) - low) * t))


def nose(radius, middle=0.0):
    return lambda x: radius - math.sqrt(radius ** 2 - (x - middle) ** 2)


def disc(body, middle, radius, h, core=0.5):
    """A disc of five patches about a square core."""
    x0, y0 = middle
    c, m = core * radius / math.sqrt(2.0), number_of(1.4 * radius, h)

    def rim(k):
        def place(s, t):
            angle = math.pi * (0.5 * k - 0.25 + 0.5 * t)
            u, v = c, c * (2 * t - 1)
            for _ in range(k):
                u, v = -v, u
            return (x0 + (1 - s) * u + s * radius * math.cos(angle), y0 + (1 - s) * v + s * radius * math.sin(angle))
        return place

    body.patch(lambda s, t: (x0 + c * (2 * s - 1), y0 + c * (2 * t - 1)), m, m)
    for k in range(4):
        body.patch(rim(k), number_of(0.5 * radius, h), m)
    return c


def plate_with_hole(body, middle, radius, half, h, h_away):
    x0, y0 = middle
    m = number_of(1.57 * radius, h)

    def side(k):
        def place(s, t):
            angle = math.pi * (0.5 * k - 0.25 + 0.5 * t)
            u, v = half, half * (2 * t - 1)
            for _ in range(k):
                u, v = -v, u
            return (x0 + (1 - s) * radius * math.cos(angle) + s * u, y0 + (1 - s) * radius * math.sin(angle) + s * v)
        return place

    for k in range(4):
        body.patch(side(k), number_of(half - radius, h_away), m)
