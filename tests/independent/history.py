"""Load histories with flow theory: each increment is the minimum of a convex potential with open gaps (the work of the stresses, flow.py).

The first step of an increment is elastic, the others have tangents by differences. Each step is a linear contact problem (solve.py),
shortened until the potential decreases; with friction there is no potential, and the residual must decrease. Steps iterate to rounding.
"""
import numpy as np

from flow import Memory

NEWTON_STEPS = 100
#: Fraction of the expected decrease that is enough, smallest part of a step, rounding of the potential.
ENOUGH, LEAST_PART, ROUNDING = 1e-4, 1e-6, 1e-13


class Diverged(Exception):
    pass


class History:
    """The end of a load case, from which the next one of a sequence starts; at first unloaded."""

    def __init__(self, model):
        self.loads, self.memory, self.far = {}, Memory(model), 0.0
        self.u = np.zeros(2 * len(model.node))
        self.v = np.zeros(len(model.own))

    def follow(self, problem, parts):
        """The answer of a load case, with loads that grow linearly from those at the end of the case before, in increments that end at
        these parts."""
        model = problem.model
        problem.memory, end = self.memory, model.loads()
        for part in parts:
            model.take_loads({name: part * value + (1 - part) * self.loads.get(name, 0.0) for name, value in end.items()})
            if part != parts[0]:
                self.commit()
            problem.begin(self.u)
            found = self.increment(problem)
            self.strain, self.end = model.strains(problem.move(found)), problem.move(found)
            problem.record(part, found)
        return found

    def commit(self):
        self.memory.commit(self.strain)
        self.u = self.end

    def finish(self, model):
        """Start the next load case from this one."""
        self.commit()
        self.loads = model.loads()

    def increment(self, problem):
        model, before, d = problem.model, np.inf, problem.elastic
        for step_number in range(NEWTON_STEPS):
            strain = model.strains(problem.move([self.v]))
            if step_number:
                d = self.memory.tangent(strain)
            problem.linearise(d, self.memory.respond(strain)[0] - np.einsum("eij,ej->ei", d, strain))
            found = problem.linear_answer()
            step = found[0] - self.v
            u = abs(problem.move(found)).max(initial=0.0)
            if step_number == 0:   # prescribed displacements may have changed: only then are they those of the increment
                self.v = found[0]
                continue
            self.far = max(self.far, u)
            self.v = self.v + self.part_of_step(problem, step, found[1]) * step
            size = abs(model.tie @ step).max(initial=0.0) / (self.far or 1.0)
            if size <= 1e-12 or size <= 1e-9 and size > before / 2:
                return found
            if not np.isfinite(size) or size > 1e4:
                raise Diverged("displacements without bound")
            before = size
        raise Diverged(f"an increment does not converge: {size:.1e}")

    def potential(self, problem, v):
        """Potential of independent displacements, the sum of magnitudes of its terms, and its slopes."""
        model, u = problem.model, problem.move([v])
        strain = model.strains(u)
        stress, *_, work = self.memory.increment(strain)
        stretch, pull = model.stretch @ u, model.pull @ u
        terms = np.concatenate([model.volume * work, stretch * pull / 2, -model.force * u, -model.twist[model.own] * v])
        slopes = model.tie.T @ (model.nodal(stress) + model.stretch.T @ pull - model.force) - model.twist[model.own]
        return terms.sum(), abs(terms).sum(), slopes

    def part_of_step(self, problem, step, force):
        """`force`: contact forces at the end of the step."""
        start, size, slopes = self.potential(problem, self.v)
        slope, push = slopes @ step, problem.n.T @ force

        def merit(v):
            value, _, slopes = self.potential(problem, v)
            return np.linalg.norm(slopes - push) if len(problem.model.sliding) else value

        if len(problem.model.sliding):
            start, size = merit(self.v), np.linalg.norm(push)
            slope = -start
        part = 1.0
        while part > LEAST_PART and merit(self.v + part * step) > start + ENOUGH * part * slope + ROUNDING * size:
            part /= 2
        return part
