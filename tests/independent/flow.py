"""Flow theory of plasticity with isotropic, kinematic (Prager) or mixed hardening: backward Euler increments, all points at once.

With the multiplier m of an increment, plastic strain = m * (stress - back stress)', the relative stress decreases by a factor for
each of its components: all of the deviator by one, or in plane stress (Simo and Taylor 1986) the sum, the difference and the
shear of the stresses in the plane by two. Bisection finds m from the yield stress.
"""
import numpy as np

HALVINGS = 70
#: Sum and difference of x and y, over sqrt(2).
TURN = np.array([[1.0, 1.0], [1.0, -1.0]]) / np.sqrt(2.0)


def tensor(strain):
    """With the tensor's shear strain."""
    return strain * [1.0, 1.0, 1.0, 0.5]


def deviator(values):
    found = values.copy()
    found[:, :3] -= values[:, :3].mean(axis=1)[:, None]
    return found


def squared(values):
    """Sum of the squares of all components of symmetric tensors."""
    return values ** 2 @ [1.0, 1.0, 1.0, 2.0]


class FlowLaw:
    """Of the points of a section. `law`: its moduli and its curve (yielding.py); `kinematic`: part of the hardening that moves the yield surface."""

    def __init__(self, law, kinematic):
        self.young, self.nu, self.plane_stress, self.yields = law.young, law.nu, law.plane_stress, law.curve is not None
        self.shear, self.bulk, self.moves = self.young / (2 * (1 + self.nu)), self.young / (3 * (1 - 2 * self.nu)), 0.0
        if self.yields:
            self.grown, self.limit = law.curve[0][1:] - law.curve[1][1:] / self.young, law.curve[1][1:]
            self.grown = self.grown - self.grown[0]
            self.moves = kinematic * (self.limit[1] - self.limit[0]) / (self.grown[1] - self.grown[0])
            self.limit = self.limit - self.moves * self.grown
            self.area = np.concatenate([[0.0], np.cumsum(np.diff(self.grown) * (self.limit[1:] + self.limit[:-1]) / 2)])

    def yield_stress(self, grown):
        """At an equivalent plastic strain; and its integral."""
        k = np.clip(np.searchsorted(self.grown, grown, side="right"), 1, len(self.grown) - 1) - 1
        apart = grown - self.grown[k]
        slope = (self.limit[k + 1] - self.limit[k]) / (self.grown[k + 1] - self.grown[k])
        return self.limit[k] + slope * apart, self.area[k] + (self.limit[k] + slope * apart / 2) * apart

    def relative(self, strain, plastic):
        """Stress less back stress if the increment is elastic; for each component the decrease by the multiplier, and the weight of its
        square in the equivalent stress."""
        back, elastic = self.moves * 2 / 3 * tensor(plastic), tensor(strain - plastic)
        turns = 2 * self.shear + self.moves * 2 / 3
        if not self.plane_stress:
            return 2 * self.shear * deviator(elastic) - back, np.full(4, turns), np.array([1.5, 1.5, 1.5, 3.0])
        moduli = np.array([self.young / (1 - self.nu), 2 * self.shear])
        inside = elastic[:, :2] @ TURN * moduli - (back[:, :2] - back[:, 2:3]) @ TURN
        across = 2 * self.shear * elastic[:, 3] - back[:, 3]
        return np.column_stack([inside, across]), np.array([moduli[0] / 3 + self.moves * 2 / 3, turns, turns]), np.array([0.5, 1.5, 3.0])

    def beyond_yield(self, strain, plastic, grown):
        """Part of the yield stress by which an elastic increment would exceed it; negative if it does not."""
        if not self.yields:
            return np.full(len(grown), -1.0)
        relative, _, weight = self.relative(strain, plastic)
        return np.sqrt(relative ** 2 @ weight) / self.yield_stress(grown)[0] - 1

    def search(self, relative, decrease, weight, grown):
        """The multiplier; 0 if the increment is elastic."""
        def beyond(multiplier):
            size = np.sqrt((relative / (1 + multiplier[:, None] * decrease)) ** 2 @ weight)
            return size > self.yield_stress(grown + 2 / 3 * multiplier * size)[0]

        low, high = np.zeros(len(grown)), np.full(len(grown), 1 / self.shear)
        while (more := beyond(high)).any():
            high[more] *= 4
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            above = beyond(middle)
            low, high = np.where(above, middle, low), np.where(above, high, middle)
        return np.where(beyond(np.zeros(len(grown))), (low + high) / 2, 0.0)

    def increment(self, strain, plastic, grown):
        """At the end of an increment: stress xx, yy, zz, xy, plastic strain and its equivalent, equivalent total strain, and the work."""
        if self.yields:
            trial, decrease, weight = self.relative(strain, plastic)
            multiplier = self.search(trial, decrease, weight, grown)
            left = trial / (1 + multiplier[:, None] * decrease)
            grown = grown + 2 / 3 * multiplier * np.sqrt(left ** 2 @ weight)
            if self.plane_stress:
                inside = left[:, :2] / [3.0, 1.0] @ TURN
                left = np.column_stack([inside, -inside.sum(axis=1), left[:, 2]])
            plastic = plastic + multiplier[:, None] * left * [1.0, 1.0, 1.0, 2.0]
        elastic = strain - plastic
        if self.plane_stress:
            elastic[:, 2] = -self.nu / (1 - self.nu) * (elastic[:, 0] + elastic[:, 1])
        stress = 2 * self.shear * deviator(tensor(elastic))
        stress[:, :3] += self.bulk * elastic[:, :3].sum(axis=1)[:, None]
        if self.plane_stress:
            stress[:, 2] = 0.0
        total = np.sqrt(2 / 3 * squared(deviator(tensor(elastic + plastic))))
        total += (1 - 2 * self.nu) / (3 * self.young) * np.sqrt(1.5 * squared(deviator(stress)))
        work = (stress * elastic).sum(axis=1) / 2 + self.moves / 3 * squared(tensor(plastic))
        return stress, plastic, grown, total, work + self.yield_stress(grown)[1] if self.yields else work


class Memory:
    """Plastic strains of all points of a model at the start of an increment; without those of materials that forget them (NLELAST)."""

    def __init__(self, model):
        self.laws = [(FlowLaw(law, law.kinematic), members, law.remembers) for law, members in model.groups if len(members)]
        self.plastic, self.grown = np.zeros((len(model.volume), 4)), np.zeros(len(model.volume))

    def increment(self, strain):
        stress, plastic, grown, total, work = np.zeros((len(strain), 4)), self.plastic.copy(), self.grown.copy(), *np.zeros((2, len(strain)))
        for law, at, _ in self.laws:
            stress[at], plastic[at], grown[at], total[at], work[at] = law.increment(strain[at], self.plastic[at], self.grown[at])
        return stress, plastic, grown, total, work

    def beyond_yield(self, strain):
        found = np.zeros(len(strain))
        for law, at, _ in self.laws:
            found[at] = law.beyond_yield(strain[at], self.plastic[at], self.grown[at])
        return found

    def respond(self, strain):
        """Stress, equivalent strain, secant modulus and state at the end of an increment."""
        stress, _, grown, total, _ = self.increment(strain)
        secant = np.zeros(len(strain))
        for law, at, _ in self.laws:
            secant[at] = law.young
        plastic = grown > 0.0
        secant[plastic] = np.sqrt(1.5 * squared(deviator(stress[plastic]))) / total[plastic]
        return stress, total, secant, plastic

    def after(self, strain):
        """Plastic strain and its equivalent that remain at the end of an increment."""
        _, plastic, grown, _, _ = self.increment(strain)
        for _, at, remembers in self.laws:
            if not remembers:
                plastic[at], grown[at] = 0.0, 0.0
        return plastic, grown

    def commit(self, strain):
        self.plastic, self.grown = self.after(strain)

    def tangent(self, strain):
        """d stress/d strain by central differences."""
        step = np.full(len(strain), 1e-6 * max(abs(strain).max(initial=0.0), 1e-300))
        for law, at, _ in self.laws:
            if law.yields:
                step[at] = 1e-6 * np.maximum(abs(strain[at]).max(axis=1), 1e-3 * law.limit[0] / law.young)
        columns = []
        for c in range(4):
            moved = np.zeros_like(strain)
            moved[:, c] = step
            columns.append((self.increment(strain + moved)[0] - self.increment(strain - moved)[0]) / (2 * step[:, None]))
        d = np.stack(columns, axis=2)
        return (d + d.transpose(0, 2, 1)) / 2
