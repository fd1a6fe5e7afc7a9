#!/usr/bin/env python3
"""Decks of strangers (tests/found/*.bdf) with which the program was wrong, or said so where it need not."""
import pathlib
import unittest

import scenes  # noqa: F401  (the path to scene)

import scene

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "found"


def deck(name):
    return (FOLDER / f"{name}.bdf").read_text()


def shifted(text, nodes, by):
    """The deck with the x of these GRIDs so much larger."""
    lines = [line.split(",") for line in text.splitlines()]
    return "\n".join(",".join([*fields[:3], repr(float(fields[3]) + by), *fields[4:]]) if fields[0] == "GRID" and int(fields[1]) in nodes
                     else ",".join(fields) for fields in lines) + "\n"


class Found(scene.Extremes):

    def test_joint_without_gap(self):
        """A block on two that meet flush stands as on two with a joint between: on edges of the joint, and where its corners are."""
        flush = self.valid(deck("joint_gap0"))
        apart = self.valid(shifted(deck("joint_gap0"), range(26, 35), 1e-3))
        self.near(flush.summary["max_pressure"], apart.summary["max_pressure"], 1e-3)
        pressed = {(pair["pair"], pair["ga"]): pair["force"] for pair in flush.table("contact")}
        for top, edge in ((35, 25), (36, 32)):
            on_edge, = (force for (name, a), force in pressed.items() if name == edge and a == 35)
            on_top, = (force for (name, _), force in pressed.items() if name == top)
            self.near(on_edge + on_top, 50.0, 1e-9)
            self.near(on_edge, 17.278, 1e-4)


if __name__ == "__main__":
    unittest.main()
