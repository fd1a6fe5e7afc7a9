"""Compute stresses from strains by total theory, with the uniaxial curve."""
import math


def on_curve(points, total):
    """Stress at a total strain; the curve is extrapolated with its last slope."""
    k = next((k for k in range(2, len(points)) if points[k][0] >= total), len(points) - 1)
    (e0, s0), (e1, s1) = points[k - 1], points[k]
    return s0 + (s1 - s0) / (e1 - e0) * (total - e0)


def respond(strain, young, nu, plane_stress, points=None, paper=False):
    """Stresses xx, yy, zz, xy, equivalent strain and secant modulus for strains xx, yy, zz, xy by total theory: those of the secant body whose
    equivalent strain lies on the curve, found by bisection."""
    x, y, given, g = strain

    def across(mu):
        return -mu / (1 - mu) * (x + y) if plane_stress else given

    def equivalent(mu):
        z = across(mu)
        return math.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 0.75 * g * g) / (1 + mu)

    def ratio(total):
        stress = on_curve(points, total)
        return 0.5 - (0.5 - nu) * (points[1][1] / stress if paper else stress / total / young)

    mu, secant, total = nu, young, equivalent(nu)
    if points and total > points[1][0]:
        low, high = points[1][0], 2 * points[1][0]
        while equivalent(ratio(high)) > high:
            high *= 2
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if equivalent(ratio(middle)) > middle else (low, middle)
        mu, secant, total = ratio(low), on_curve(points, low) / low, low
    shear = young / (3 * young / secant - (1 - 2 * nu))
    mean = (x + y + across(mu)) / 3
    pressure = young / (1 - 2 * nu) * mean
    stress = (pressure + 2 * shear * (x - mean), pressure + 2 * shear * (y - mean),
              0.0 if plane_stress else pressure + 2 * shear * (across(mu) - mean), shear * g)
    return stress, total, secant


def von_mises(stress):
    x, y, z, s = stress
    return math.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 3 * s * s)
