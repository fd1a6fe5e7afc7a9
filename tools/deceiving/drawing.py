"""Parts shared by families of random models: random parameters, loads on a body, a block as base."""
from deceiving.scenes import PLANE, Scene
from deceiving.shapes import cells

FAMILIES = {}


def family(function):
    FAMILIES[function.__name__] = function
    return function


class Draw:
    """A model and the parameters that most families draw: element types, moduli, element sizes (slave h, master h / ratio)."""

    def __init__(self, pick, n, kinds=PLANE, ratios=(1.0, 1.0, 1.3, 2.0, 3.0, 5.0, 8.0, 0.75, 0.5, 0.33), h=(0.15, 0.5)):
        self.pick = pick
        self.kinds = [pick.choice(kinds)] * 2
        if pick.random() < 0.3:
            self.kinds[1] = pick.choice(kinds)
        self.scene = Scene(n, 1.0, pick.choice(["STRAIN", "STRAIN", "STRESS"]), pick.random() < 0.3, pick.random() < 0.5)
        self.ratio = pick.choice(ratios)
        self.h = pick.uniform(*h)
        self.young = pick.choice([1e3, 1e3, 2e5])
        self.soft = pick.choice([1.0, 1.0, 0.3, 0.05, 10.0])
        self.poisson = pick.choice([0.0, 0.3, 0.3, 0.45])
        self.force = pick.random() < 0.4
        self.sway = pick.choice([0.0, 0.0, 0.1, -0.3])
        self.strain = pick.uniform(0.003, 0.02)
        fine = max(self.h / max(self.ratio, 1e-9), 0.06)
        self.h_slave, self.h_master = (self.h, fine) if self.ratio >= 1 else (max(self.h * self.ratio, 0.06), self.h)

    def slave(self):
        return self.scene.body(self.kinds[0], self.young * self.soft, self.poisson)

    def master(self):
        return self.scene.body(self.kinds[1], self.young, self.poisson)

    def block(self, left, right, low, high):
        """A slave."""
        body = self.slave()
        cells(body, [left, right], [low, high], self.h_slave)
        return body

    def hold(self, body, a, b, *how):
        """The line of a body from a to b."""
        self.scene.hold(body.line(a, b), *how)

    def press(self, body, right, left, top, travel, width):
        """Move the upper side of the body by a prescribed displacement (down and sideways), or load it with a force that gives the drawn strains."""
        nodes = body.line((right, top), (left, top))
        if self.force:
            self.scene.platen(nodes, self.strain * min(body.young, self.young) * width)
        else:
            self.scene.hold(nodes, "12", (self.sway * travel, -travel))

    def either(self, slave, master, turn=0.5):
        """Put the two lines in contact; the slave is chosen at random."""
        if self.pick.random() < turn:
            slave, master = master, slave
        self.scene.contact(slave, master)


def base(draw, left, right, depth=1.0):
    """A block below y = 0, fixed at its lower side."""
    body = draw.master()
    cells(body, [left, right], [-depth, 0.0], draw.h_master, up=max(draw.h_master, depth / 5))
    draw.hold(body, (left, -depth), (right, -depth))
    return body
