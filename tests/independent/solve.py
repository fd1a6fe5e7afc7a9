#!/usr/bin/env python3
"""Solve an elastic contact deck with another method than epcont's and write tables with the same columns.

    . tools/venv && python tests/independent/solve.py DECK... [-o DIRECTORY]

One stiffness matrix of all bodies including the rigid-body modes; a saddle-point matrix of displacements and contact
forces, factored again (SuperLU) for every active set. The set: all pairs exchanged at once
(primal-dual active set); if that cycles, one at a time, the first wrong one (Murty), with weak springs at the
SUPORT DOFs until the set is found. The answer is solved without springs and refined.

With friction a pair is open, sticks, or slips one way or the other: semismooth Newton steps compare forces with slips; if they cycle,
only half of the wrong pairs change in each step, by chance; then Lemke's algorithm finds the states (lemke.py).

Yielding (yielding.py): secant steps, each with its contact, until they converge; then Newton with tangents by
differences, halved if the residual grows. Both iterate to rounding, whatever METHOD and TOL the deck has.

Exit status: 0 if solved, 1 if there is no equilibrium, 2 if the deck is not supported.
"""
import argparse
import csv
import pathlib
import sys
import warnings

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from deck import DeckError, read
from history import Diverged, History
from lemke import friction_states
from model import Model
from pressures import pressures


#: Secant steps end at this change of the displacements; growth by this factor is divergence. Near a limit load they are slow: then this number of Newton's
#: steps finds the answer, or none.
SETTLED, SECANT_STEPS, FAR = 1e-4, 500, 1e3
NEWTON_STEPS = 60
#: Number of answers with springs that are tried; stiffness of the springs.
APPROACHES, WEAK = 10, 1e-7
#: State of a pair; others: 0 in contact, without slip; -1 or 1: sign of its slip.
OPEN = 2


class NoEquilibrium(Exception):
    pass


class Problem:
    def __init__(self, model):
        self.model = model
        self.n = (model.contact_matrix @ model.tie).tocsr()   # rows of gaps, then those of slips
        self.pairs, self.exchanges = len(model.initial), 0
        self.state = np.zeros(self.pairs, int)   # start of the search
        self.begin(np.zeros(2 * len(model.node)))
        nothing = np.zeros((len(model.volume), 4))
        self.elastic = model.of_points("secant_matrix", nothing, 4, 4)
        self.memory = model   # or plastic strains (history.py)
        self.increments = []  # rows of their table, by columns
        self.linearise(self.elastic, nothing)
        self.stiff = abs(self.k.diagonal()).max()

    def begin(self, before):
        """Slips count from these displacements of all nodes."""
        model = self.model
        self.g = np.concatenate([model.initial, np.zeros(len(model.sliding))]) + model.contact_matrix @ model.held
        self.g[self.pairs:] -= model.contact_matrix[self.pairs:] @ before

    def linearise(self, d, initial):
        """Stress = d strain + initial at all points."""
        model = self.model
        self.full = model.stiffness(d)
        self.k = (model.tie.T @ self.full @ model.tie).tocsc()
        unmoved = initial - np.einsum("eij,ej->ei", d, model.free)
        self.f = model.tie.T @ (model.force - model.nodal(unmoved) - self.full @ model.held) + model.twist[model.own]

    def springs(self, factor):
        """Weak springs at the SUPORT DOFs."""
        weak = np.isin(self.model.own, [i for *_, i in self.model.support])
        return sp.diags(factor * self.stiff * weak)

    def solve(self, state, spring=0.0):
        """Displacements, forces of all rows, gaps and slips."""
        slides, mu = self.model.sliding, self.model.friction
        sign = np.where(state[slides] == OPEN, 0, state[slides])
        sticks = (state[slides] == 0) & (abs(self.n[self.pairs:]).sum(axis=1).A1 > 0.0)
        active = np.flatnonzero(np.concatenate([state != OPEN, sticks]))   # rows without gap or slip
        bound = sp.csr_matrix((-mu * sign, (self.pairs + np.arange(len(slides)), slides)), shape=2 * self.g.shape)
        drive = (sp.identity(len(self.g), format="csr") + bound)[:, active]   # all forces, of those of the active rows
        n = self.n[active]
        k = self.k + self.springs(spring) if spring else self.k
        scale = self.stiff
        matrix = sp.bmat([[k, -self.n.T @ drive * scale], [-n * scale, None]], format="csc") if len(active) else k.tocsc()
        pulled = self.f + self.springs(spring) @ self.rest if spring else self.f
        right = np.concatenate([pulled, self.g[active] * scale])
        self.exchanges += 1
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                factor = spl.splu(matrix)
            except (RuntimeError, Warning):
                return None
        z = factor.solve(right)
        for _ in range(4):
            rest = (right.astype(np.longdouble) - product(matrix, z)).astype(float)
            z = z + factor.solve(rest)
        if not np.all(np.isfinite(z)):
            return None
        v = z[:len(self.f)]
        force = drive @ z[len(self.f):] * scale
        gap = self.g + self.n @ v
        gap[active] = 0.0
        return v, force, gap

    def better(self, state, v, force, gap):
        """The states that forces, gaps and slips call for."""
        small = 1e-11 * max(abs(force).max(initial=0), 1e-300)
        near = 1e-11 * max(abs(self.g).max(initial=0), abs(v).max(initial=0), 1e-300)
        (force, friction), (gap, slip) = ((both[:self.pairs], both[self.pairs:]) for both in (force, gap))
        new = np.where((state != OPEN) & (force < -small), OPEN, np.where((state == OPEN) & (gap < -near), 0, state))
        of, mu, rows = self.model.sliding, self.model.friction, self.n[self.pairs:]
        closes, before = (state[of] == OPEN) & (new[of] != OPEN), np.where(state[of] == OPEN, 0, state[of])
        soft = rows.multiply(rows) @ (1 / np.maximum(abs(self.k.diagonal()), 1e-12 * self.stiff))
        stiff = 1 / np.where(soft > 0.0, soft, 1.0)   # converts slips to forces
        bound = mu * np.where(closes, -stiff * gap[of], force[of])
        pull = friction - stiff * slip
        wants = np.where(soft > 0.0, np.where(abs(pull) <= bound, 0, -np.sign(pull)), np.where(abs(slip) <= near, 0, np.sign(slip))).astype(int)
        wrong = np.where(before == 0, (abs(friction) > bound + small) | (soft == 0.0), before * slip < -near)
        new[of] = np.where((new[of] != OPEN) & (closes | wrong), wants, new[of])
        return new

    def find(self, spring, changed, limit):
        state, tried = self.state, set()
        for _ in range(limit):
            if changed is all_changed and state.tobytes() in tried:
                return None
            tried.add(state.tobytes())
            answer = self.solve(state, spring)
            if answer is None:
                return None
            better = self.better(state, *answer)
            if (better == state).all():
                self.state = state
                return state, answer
            state = changed(state, better)
        return None

    def pivoted(self, chance):
        """States by Lemke's algorithm, with springs."""
        factor = spl.splu((self.k + self.springs(WEAK)).tocsc())
        start = self.g + self.n @ factor.solve(self.f + self.springs(WEAK) @ self.rest)
        found = friction_states(self.n @ factor.solve(self.n.T.toarray()), start, self.model.sliding, self.model.friction,
                               chance.uniform(0.1, 1.0, self.pairs + 2 * len(self.model.sliding)))
        state = found and np.where(found[0], OPEN, found[1])
        answer = found and self.solve(state, WEAK)
        return answer and (state, answer)

    def check_free(self):
        """DeckError if a rigid-body mode remains even with fixed SUPORT DOFs."""
        k = self.k + self.springs(1.0)
        try:
            pivots = abs(spl.splu(k.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0).U.diagonal())
        except RuntimeError:
            pivots = np.zeros(1)
        if len(pivots) and pivots.min() <= 1e-11 * abs(self.k.diagonal()).min():
            raise DeckError("a body is free to move and has no SUPORT")

    def record(self, part, found):
        """Keep the figures of an increment that ends at this part of the loads."""
        figures = {key: value for key, value, _ in tables(self, *found)["summary"][1]}
        self.increments.append({"increment": len(self.increments) + 1, "load_factor": part, "max_pressure": figures.get("max_pressure"),
                                **{key.replace("total_f", "f"): value for key, value in figures.items()
                                   if key in ("total_contact_force", "plastic_elements", "total_friction_force") or key.startswith(("approach", "pairs_"))}})

    def answer(self, history=None, parts=()):
        """`history`: the loads before, with flow theory; `parts` of the loads at the ends of increments."""
        self.check_free()
        if history:
            return history.follow(self, parts)
        found = self.linear_answer()
        if any(law.curve is not None for law, _ in self.model.groups):
            found = self.yielding_answer(found)
        return found

    def move(self, found):
        return self.model.tie @ found[0] + self.model.held

    def off_curve(self, u, force):
        """Largest residual force at a free DOF, with the stresses on the curve."""
        model = self.model
        stress = model.respond(model.strains(u))[0]
        rest = model.tie.T @ model.unbalanced(u, stress, force) - model.twist[model.own]
        return abs(rest).max(initial=0.0) / model.nodal(stress, abs).max()

    def yielding_answer(self, found):
        model = self.model
        u = self.move(found)
        for _ in range(SECANT_STEPS):
            before = u
            self.linearise(model.of_points("secant_matrix", model.strains(u), 4, 4), np.zeros((len(model.volume), 4)))
            found = self.linear_answer()
            u = self.move(found)
            if abs(u).max() > FAR * abs(before).max() or not np.isfinite(u).all():
                raise NoEquilibrium("displacements without bound")
            if abs(u - before).max() <= SETTLED * abs(u).max():
                break
        residual, before = self.off_curve(u, found[1]), np.inf
        for _ in range(NEWTON_STEPS):
            strain = model.strains(u)
            d = model.of_points("tangent", strain, 4, 4)
            self.linearise(d, model.respond(strain)[0] - np.einsum("eij,ej->ei", d, strain))
            found = self.linear_answer()
            step, length = self.move(found) - u, 1.0
            while self.off_curve(u + length * step, found[1]) > max(residual, 1e-11) and length > 1e-3:
                length /= 2
            u = u + length * step
            residual = self.off_curve(u, found[1])
            size = abs(step).max() / abs(u).max()
            if size <= 1e-12 or (size <= 1e-9 and (residual < 1e-13 or size > before / 2)):
                return found
            before = size
        raise NoEquilibrium(f"Newton does not end: residual {residual:.1e}")

    def linear_answer(self):
        """Find the set without springs, or with springs that pull to the previous answer, until they no longer change the set."""
        found, self.rest = self.find(0.0, all_changed, 200), np.zeros(len(self.f))
        exact = self.without_springs(found[0]) if found else None
        for attempt in range(APPROACHES):
            if exact is not None:
                return exact
            if len(self.model.sliding):
                found = self.find_friction(attempt)
            else:
                found = self.find(WEAK, all_changed, 200) or self.find(WEAK, one_changed, 20 * self.pairs + 200)
                if found is None:
                    break
            if found:
                state, (self.rest, *_) = found
                exact = self.without_springs(state)
        if exact is None:
            raise NoEquilibrium("no set of pairs found, or a body moves away")
        return exact

    def find_friction(self, attempt):
        """States with springs; every second attempt begins with random ones."""
        chance = np.random.default_rng(attempt)
        if attempt % 2:
            self.state = chance.integers(-1, OPEN, self.pairs, endpoint=True) * np.isin(np.arange(self.pairs), self.model.sliding)
        return self.find(WEAK, all_changed, 200) or self.pivoted(chance) or self.find(WEAK, half_changed(chance), 10 * self.pairs + 100)

    def without_springs(self, state):
        """The answer from a set that is nearly correct; None if this set gives none."""
        for _ in range(50):
            exact = self.solve(state)
            if exact is None:
                return None
            v, force, gap = exact
            better = self.better(state, *exact)
            if (better == state).all():
                break
            state = one_changed(state, better)
        else:
            return None
        # A singular matrix may factor, with noise as last pivot: displacements far above all that forces and gaps explain.
        softest = abs(self.k.diagonal())[abs(self.k.diagonal()) > 0].min(initial=self.stiff)
        if abs(v).max(initial=0) > 1e8 * (abs(self.f).max(initial=0) / softest + abs(self.g).max(initial=0)):
            return None
        return v, force, gap, state


def all_changed(_, better):
    return better


def half_changed(chance):
    """Change about half of the wrong states, by chance."""
    return lambda state, better: np.where(chance.random(len(state)) < 0.5, better, state)


def one_changed(state, better):
    """States with the first difference only."""
    return np.where(np.arange(len(state)) == np.argmax(better != state), better, state)


def product(matrix, z):
    """matrix @ z in extended precision."""
    coo = matrix.tocoo()
    result = np.zeros(matrix.shape[0], np.longdouble)
    np.add.at(result, coo.row, coo.data.astype(np.longdouble) * z[coo.col])
    return result


def tables(problem, v, force, gap, state):
    model, touching = problem.model, state != OPEN
    u = model.tie @ v + model.held
    strain = model.strains(u)
    stress, total, secant, plastic = problem.memory.respond(strain)
    reaction = np.where(model.dof_held, model.lead.T @ model.unbalanced(u, stress, force) - model.twist, 0.0)
    reaction, moments = reaction[:len(u)].reshape(-1, 2), reaction[len(u):]
    slid = model.contact_matrix[problem.pairs:] @ u
    (force, friction), (gap, slip) = ((both[:problem.pairs], both[problem.pairs:]) for both in (force, gap))
    masters, pulls = model.masters(v), model.pull @ u
    u = u.reshape(-1, 2)
    within = {int(row) for members in model.members for row in members}
    places = [(b if b in within else a, n, nodes) for (a, b), n, nodes in zip(model.ends, model.normal, model.pair_weights)]
    pressure = pressures(model.boundary, model.x, model.held_directions, model.leader, places, model.contacts, force, touching,
                         {k: nodes for k, nodes in enumerate(model.stands_on) if nodes})
    contact = []
    for k, pair in enumerate(model.pair):
        a, b = model.ends[k]
        contact.append([pair, model.node[a], model.node[b], *model.x[b], *model.normal[k], model.initial[k], force[k],
                        pressure[k] or 0.0, gap[k], "touching" if touching[k] else "open"])
    rubbed = [[model.pair[k], mu, friction[j], mu * force[k], (pressure[k] or 0.0) * friction[j] / (force[k] or 1.0), slip[j], slid[j],
               "open" if state[k] == OPEN else "slips" if state[k] else "sticks"] for j, (k, mu) in enumerate(zip(model.sliding, model.friction))]
    nodes = [[node, *model.x[i], *u[i], *reaction[i]] for i, node in enumerate(model.node)]
    sx, sy, sz, txy = stress.T
    mises = np.sqrt(((sx - sy) ** 2 + (sy - sz) ** 2 + (sz - sx) ** 2) / 2 + 3 * txy ** 2)
    columns = np.array([model.mean(values) for values in (sx, sy, sz, txy, mises, total, secant)]).T
    yielded = np.bincount(model.owner, plastic, len(model.element)) > 0
    elements = [[element, *model.x[model.members[k]].mean(axis=0), *columns[k], "plastic" if yielded[k] else "elastic"]
                for k, element in enumerate(model.element)]
    summary = [["status", "solved", ""]]
    if contact:
        summary.append(["max_pressure", max(row[9] for row in contact), ""])
    summary += [["total_contact_force", float(force.sum()), ""],
               ["pairs_in_contact", int(touching.sum()), ""],
               ["plastic_elements", int(yielded.sum()), ""],
               ["max_equivalent_stress", float(mises.max(initial=0.0)), ""],
               ["max_displacement", float(np.hypot(*u.T).max()), ""]]
    summary += [[f"approach_{node}_{digit}", masters[i], ""] for node, digit, i in model.support]
    for k, node in enumerate(model.rotating, len(model.is_held)):
        summary.append([f"angle_{node}", masters[k], ""])
        if model.dof_held[k]:
            summary.append([f"moment_{node}", moments[k - len(model.is_held)], ""])
    summary += [[f"spring_{number}", pull, ""] for (number, *_), pull in zip(model.springs, pulls)]
    if rubbed:
        counts = [(word, sum(row[7] == state for row in rubbed)) for word, state in (("stick", "sticks"), ("slipp", "slips"))]
        summary += [["total_friction_force", float(abs(friction).sum()), ""], *([f"pairs_{word}ing", n, ""] for word, n in counts)]
    yields = any(law.curve is not None for law, _ in model.groups)
    if problem.increments and yields:
        remaining = np.column_stack(problem.memory.after(strain))
        plastic_strains = np.array([model.mean(values) for values in remaining.T]).T
    return {"summary": (["key", "value", "unit"], summary),
            **({"increments": (list(problem.increments[0]), [list(row.values()) for row in problem.increments])} if problem.increments else {}),
            **({"plastic": ("element plastic_x plastic_y plastic_z plastic_xy accumulated".split(),
                            [[element, *row] for element, row in zip(model.element, plastic_strains.tolist())])} if problem.increments and yields else {}),
            **({"friction": ("pair friction friction_force limit shear slip slid state".split(), rubbed)} if rubbed else {}),
            "contact": ("pair ga gb x y nx ny initial_gap force pressure gap status".split(), contact),
            "nodes": ("node x y ux uy rx ry".split(), nodes),
            "elements": ("element x y sx sy sz txy equivalent_stress equivalent_strain secant_modulus state".split(), elements)}


def text(value):
    return f"{value:.17g}" if isinstance(value, float) else str(value)


def solve(path, told=None, parts=None):
    """(number of the load case, its tables, its problem), or None and a reason instead, for each case of a deck. `told`: nodes of the
    pairs of lines of each, if another program has found them; `parts`: of the loads at the ends of increments, likewise."""
    history, ended = None, True
    for deck in read(path).by_case():
        try:
            if not ended:
                raise NoEquilibrium("the load case before has no end to start from")
            problem = Problem(Model(deck, told and told.get(deck.number)))
            if not deck.by_increments:
                yield deck.number, tables(problem, *problem.answer()), problem
                continue
            history = history if history and deck.is_sequence else History(problem.model)
            n = deck.increments()[0]
            found = problem.answer(history, parts and parts.get(deck.number) or [k / n for k in range(1, n + 1)])
            yield deck.number, tables(problem, *found), problem
            history.finish(problem.model)
        except (DeckError, NoEquilibrium, Diverged) as error:
            ended = not (deck.by_increments and deck.is_sequence)
            yield deck.number, None, error


def say(name, found, problem):
    """Print a line about a load case; return its exit status."""
    if found is None:
        print(f"{name}: {'deck' if isinstance(problem, DeckError) else 'no equilibrium'}: {problem}")
        return 2 if isinstance(problem, DeckError) else 1
    summary = {row[0]: row[1] for row in found["summary"][1]}
    last = [row for row in found["contact"][1] if row[11] == "touching"]
    print(f"{name}: p_max {summary.get('max_pressure', 0.0):.6g}, " +
          ", ".join(f"{key} {value:.6g}" for key, value in summary.items() if key.startswith("approach")) +
          f", {len(last)} of {len(found['contact'][1])} touching, {problem.exchanges} factorizations")
    return 0


def write(place, stem, cases):
    """The tables of all load cases with an answer, with a column for the case if there are several."""
    place.mkdir(parents=True, exist_ok=True)
    for name in cases[0][1]:
        with open(place / f"{stem}.{name}.csv", "w", newline="", encoding="ascii") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["subcase"] * (cases[0][0] is not None) + list(cases[0][1][name][0]))
            for number, found in cases:
                writer.writerows([[str(number)] * (number is not None) + [text(value) for value in row] for row in found[name][1]])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("decks", nargs="+", type=pathlib.Path)
    parser.add_argument("-o", "--output", type=pathlib.Path)
    options = parser.parse_args()
    worst = 0
    for path in options.decks:
        cases = []
        try:
            for number, found, problem in solve(path):
                worst = max(worst, say(path.stem + (f" SUBCASE {number}" if number is not None else ""), found, problem))
                cases += [(number, found)] if found else []
        except DeckError as error:
            worst = max(worst, say(path.stem, None, error))
        if options.output and cases:
            write(options.output, path.stem, cases)
    return worst


if __name__ == "__main__":
    sys.exit(main())
