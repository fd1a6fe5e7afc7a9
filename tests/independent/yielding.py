"""Total theory of plasticity by the given uniaxial curve: bisection for the equivalent strain, all points at once.

The secant body of a strain has E' = sigma/eps of the curve and the Poisson's ratio mu = 0.5 - (0.5 - nu) E'/E; its
equivalent strain with that mu (and, in plane stress, with the transverse strain due to mu) must be eps itself.
"""
import numpy as np

HALVINGS = 70


class Law:
    """Stress of points of one section at their strains xx, yy, zz, xy (engineering); in plane stress zz follows."""

    def __init__(self, young, nu, plane_stress, curve=None, paper=False, hardening=(0.0, False)):
        self.young, self.nu, self.plane_stress, self.curve, self.paper = young, nu, plane_stress, curve, paper
        self.kinematic, self.remembers = hardening

    def curve_stress(self, total):
        strain, stress = self.curve
        k = np.clip(np.searchsorted(strain, total, side="right"), 1, len(strain) - 1)
        return stress[k - 1] + (stress[k] - stress[k - 1]) / (strain[k] - strain[k - 1]) * (total - strain[k - 1])

    def ratio(self, total):
        """Poisson's ratio of the secant body: exact, or the paper's (2-4)."""
        if self.paper:
            return 0.5 - (0.5 - self.nu) * self.curve[1][1] / self.curve_stress(total)
        return 0.5 - (0.5 - self.nu) * self.curve_stress(total) / total / self.young

    def equivalent_strain(self, strain, mu):
        x, y, z, g = strain.T
        z = -mu / (1 - mu) * (x + y) if self.plane_stress else z
        return np.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 0.75 * g * g) / (1 + mu)

    def respond(self, strain):
        """(stress xx yy zz xy, equivalent strain, secant modulus, yielded) of each point."""
        secant = np.full(len(strain), self.young)
        mu = np.full(len(strain), self.nu)
        total = self.equivalent_strain(strain, mu)
        plastic = np.zeros(len(strain), bool)
        if self.curve is not None:
            plastic = total > self.curve[0][1]
            if plastic.any():
                total[plastic] = self.search(strain[plastic])
                secant[plastic] = self.curve_stress(total[plastic]) / total[plastic]
                mu[plastic] = self.ratio(total[plastic])
        x, y, z, g = strain.T
        z = -mu / (1 - mu) * (x + y) if self.plane_stress else z
        shear = self.young / (3 * self.young / secant - (1 - 2 * self.nu))
        mean = (x + y + z) / 3
        pressure = self.young / (1 - 2 * self.nu) * mean
        stress = np.array([pressure + 2 * shear * (x - mean), pressure + 2 * shear * (y - mean),
                           pressure + 2 * shear * (z - mean), shear * g]).T
        if self.plane_stress:
            stress[:, 2] = 0.0
        return stress, total, secant, plastic

    def search(self, strain):
        low = np.full(len(strain), self.curve[0][1])
        high = 2 * low
        while True:
            beyond = self.equivalent_strain(strain, self.ratio(high)) > high
            if not beyond.any():
                break
            high[beyond] *= 2
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            above = self.equivalent_strain(strain, self.ratio(middle)) > middle
            low, high = np.where(above, middle, low), np.where(above, high, middle)
        return (low + high) / 2

    def tangent(self, strain):
        """d stress/d strain by central differences, with steps much smaller than the distance of kinks: Newton corrects the error."""
        step = 1e-6 * np.maximum(abs(strain).max(axis=1), 1e-12 if self.curve is None else 1e-3 * self.curve[0][1])
        columns = []
        for c in range(4):
            moved = np.zeros_like(strain)
            moved[:, c] = step
            columns.append((self.respond(strain + moved)[0] - self.respond(strain - moved)[0]) / (2 * step[:, None]))
        d = np.stack(columns, axis=2)
        return (d + d.transpose(0, 2, 1)) / 2

    def secant_matrix(self, strain):
        """D of stress = D strain."""
        secant = self.respond(strain)[2]
        shear = self.young / (3 * self.young / secant - (1 - 2 * self.nu))
        normal = self.young / (3 * (1 - 2 * self.nu)) - 2 / 3 * shear
        if self.plane_stress:
            normal = 2 * shear * normal / (normal + 2 * shear)
        d = np.zeros((len(strain), 4, 4))
        d[:, :3, :3] = normal[:, None, None] + 2 * shear[:, None, None] * np.eye(3)
        d[:, 3, 3] = shear
        if self.plane_stress:
            d[:, 2] = d[:, :, 2] = 0.0
        return d
