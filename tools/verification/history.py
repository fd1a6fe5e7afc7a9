"""Flow theory: stresses depend on all increments, and tables hold the ends of load cases only. The independent program solves the history
(tests/independent, with numpy and scipy). Its plastic strains before the last increment give the stresses of the displacements in the tables.
"""
import numpy as np
from compare import compare, increments, pairs_of_lines
from solve import solve


class End:
    """The last increment of a load case. `points`: of each element, (stress, equivalent strain, secant modulus) at its points; `plastic`: their
    plastic strains, zero if not yielded; `yielding`: least and largest number of elements that yield in it; `differences`: (quantity, relative difference, position) of both solutions; `faults`: other ones."""

    def __init__(self, found, problem, tables, drift):
        model = problem.model
        u = np.array([[float(tables.nodes[node][key]) for key in ("ux", "uy")] for node in model.node]).ravel()
        strain = model.strains(u)
        stress, total, secant, _ = problem.memory.respond(strain)
        plastic, beyond = problem.memory.after(strain)[0], problem.memory.beyond_yield(strain)
        self.yielding = [len(set(model.owner[beyond > least])) for least in (drift, -drift)]
        self.points, self.plastic = {element: [] for element in model.element}, {element: [] for element in model.element}
        for k, owner in enumerate(model.owner):
            self.points[model.element[owner]].append((stress[k].tolist(), float(total[k]), float(secant[k])))
            self.plastic[model.element[owner]].append(plastic[k].tolist())
        worst, self.faults = compare(found, tables.directory, tables.stem, tables.case)
        self.differences = [(kind, *of) for kind, of in worst.items()]

    def lines(self, tolerance):
        """Lines of the report and the number of faults."""
        found = [(f"{kind}, both solutions, {place}", value, value <= tolerance) for kind, value, place in self.differences]
        report = [f"{name:30s} {value:24.16E} {'':>26s}  {'ok' if good else 'WRONG'}" for name, value, good in found]
        return [*report, *(f"{fault}  WRONG" for fault in self.faults)], sum(not good for *_, good in found) + len(self.faults)


def ends(deck, directory, cases):
    """(its number, tables of the independent solution or None, its model or the reason) of each load case, with the increments of the run."""
    parts = {case.number: increments(deck, directory, case.number) for case in cases}
    for number, found, problem in solve(deck, pairs_of_lines(deck, directory), parts):
        yield found, problem
