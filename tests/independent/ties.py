"""Ties between degrees of freedom: RBE2 and MPC. Standard library only.

A DOF is (node, component): 0 and 1 along x and y, 2 the rotation of the master node of an RBE2.
"""
from deck import ids


def rigid_ties(deck, rotating):
    """The master DOF of each dependent one, for RBE2 whose master nodes do not rotate."""
    return {(node, int(digit) - 1): (int(card[2]), int(digit) - 1) for card in deck.of("RBE2") if int(card[2]) not in rotating
            for node in ids(card[4:]) for digit in set(card[3]) & {"1", "2"}}


def end_of_chains(rigid):
    """The master DOFs, which do not depend on others of these."""
    found = {}
    for dof, master in rigid.items():
        while master in rigid:
            master = rigid[master]
        found[dof] = master
    return found


def sums(deck, x, rotating):
    """Terms {DOF: weight} of each DOF that is a sum of others: nodes on RBE2 that rotate, first terms of MPC. `x`: coordinates by id. The
    terms may be dependent themselves."""
    found = {}
    for card in deck.of("RBE2"):
        master = int(card[2])
        for node in ids(card[4:]) if master in rotating else ():
            arm = [x(node)[c] - x(master)[c] for c in (0, 1)]
            found[node, 0] = {(master, 0): 1.0, (master, 2): -arm[1]}
            found[node, 1] = {(master, 1): 1.0, (master, 2): arm[0]}
    for first, *others in deck.equations():
        terms = found[first[0]] = {}
        for dof, coefficient in others:
            terms[dof] = terms.get(dof, 0.0) - coefficient / first[1]
    return found


def resolved(rigid, sums):
    """Terms of each dependent DOF in independent ones."""
    given = {**{dof: {master: 1.0} for dof, master in rigid.items()}, **sums}
    done = {}

    def terms(dof):
        if dof not in given:
            return {dof: 1.0}
        if dof not in done:
            done[dof] = total = {}
            for other, weight in given[dof].items():
                for last, part in terms(other).items():
                    total[last] = total.get(last, 0.0) + weight * part
        return done[dof]

    return {dof: terms(dof) for dof in given}
