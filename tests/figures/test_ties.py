#!/usr/bin/env python3
"""Platens that rotate (RBE2), equations (MPC) and springs (CELAS) compared with closed forms of beams, and the messages for invalid ones."""
import unittest

import scenes  # noqa: F401  (adds the folder of scene.py to the path)

import scene

LENGTH, HEIGHT, YOUNG = 10.0, 1.0, 1000.0
STIFFNESS = YOUNG * HEIGHT**3 / 12   # bending


def beam(cards, case="", nu=0.0, hold=True):
    """A cantilever of ten CQUAD8, plane stress, fixed at its left end: nodes 1 to 5 from below, 51 to 55 at the right, 53 on the axis."""
    lines = ["DISPLACEMENT=ALL", "SPCFORCES=ALL", case, "BEGIN BULK", "PARAM,PLANE,STRESS", "PSHELL,1,1,1.0", f"MAT1,1,{YOUNG!r},,{nu!r}"]
    name = {}
    for i in range(11):
        for j in range(5):
            if i % 2 and j % 2:
                continue
            name[i, j] = 5 * i + j + 1
            lines.append(f"GRID,{name[i, j]},,{LENGTH * i / 10!r},{HEIGHT * (j / 4 - 0.5)!r},0.0")
    for a in range(0, 10, 2):
        for b in range(0, 4, 2):
            n = [name[a + i, b + j] for i, j in ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))]
            lines.append(f"CQUAD8,{10 * a + b + 1},1," + ",".join(map(str, n[:6])) + ",+\n+," + ",".join(map(str, n[6:])))
    if hold:
        lines.append("SPC1,1,12,1,2,3,4,5")
    return "\n".join([line for line in lines if line] + cards.split("|") + ["ENDDATA"]) + "\n"


RIGHT = "RBE2,901,900,123456,51,52,53,54,55"
TURN = 2e-3 * LENGTH / STIFFNESS   # under a moment of 0.002


class Ties(scene.Extremes):

    def test_moment(self):
        """A moment at the master node bends the beam to a circle; so does the angle, and its reaction is that moment."""
        run = self.valid(beam(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|MOMENT,1,900,,0.001,0.0,0.0,2.0"))
        self.near(run.summary["angle_900"], TURN, 1e-8)
        self.near(run.nodes[900]["uy"], TURN * LENGTH / 2, 1e-8)
        self.near(run.nodes[55]["ux"], -TURN * HEIGHT / 2, 1e-8)
        run = self.valid(beam(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|SPC,1,900,6,{TURN!r}"))
        self.near(run.summary["moment_900"], 2e-3, 1e-8)
        self.near(run.nodes[900]["uy"], TURN * LENGTH / 2, 1e-8)

    def test_position_of_the_master_node(self):
        """A force at a master node beside the beam has a lever arm: the platen rotates, and moves the node."""
        run = self.valid(beam(f"GRID,900,,{LENGTH},3.0,0.0|{RIGHT}|SUPORT,990,1|GRID,990,,20.0,0.0,0.0|SPC1,1,2,990|"
                              "FORCE,1,900,,1.0E-3,-1.0,0.0,0.0|MOMENT,1,900,,0.0,0.0,0.0,1.0"))
        self.near(run.summary["angle_900"], 3e-3 * LENGTH / STIFFNESS, 1e-8)
        self.near(run.nodes[900]["ux"], -3.0 * 3e-3 * LENGTH / STIFFNESS - 1e-3 * LENGTH / YOUNG, 1e-8)

    def test_held(self):
        """If nothing names its rotation, a master node is fixed; SPC1 6 fixes it under a moment, which is the reaction."""
        run = self.valid(beam(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|FORCE,1,900,,0.001,0.0,1.0,0.0"))
        self.assertNotIn("angle_900", run.summary)
        self.near(run.nodes[55]["ux"], 0.0, 1e-8, 1e-3)
        run = self.valid(beam(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|SPC1,1,6,900|MOMENT,1,900,,0.002,0.0,0.0,1.0"))
        self.near(run.summary["moment_900"], -2e-3, 1e-12)
        self.near(run.summary["max_displacement"], 0.0, 1e-12, 1e-3)

    def test_lever(self):
        """A lever about a fixed master node, an approach in radians, rests on one point: forces by its arms."""
        cards = ("GRID,900,,-1.0,0.0,0.0|SPC1,1,12,900,990|RBE2,901,900,12,1,2,3,4,5|SUPORT,900,6|GRID,990,,10.0,-0.6,0.0|PGAP,5,0.001|"
                 "CGAP,970,5,990,51|FORCE,1,30,,0.02,0.0,-1.0,0.0")
        run = self.valid(beam(cards, nu=0.3, hold=False))
        self.near(run.force[0], 0.02 * 6 / 11, 1e-9)
        self.near(run.summary["approach_900_6"], run.summary["angle_900"], 1e-9)
        self.assertLess(run.summary["angle_900"], -0.001 / 11)

    def test_moment_in_two_cases(self):
        """Each case has its own moment."""
        run = scene.solve(beam(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|MOMENT,1,900,,0.002,0.0,0.0,1.0|MOMENT,2,900,,0.004,0.0,0.0,-1.0",
                               case="CNTNLSUB=NO\nSUBCASE 1\nLOAD=1\nSUBCASE 2\nLOAD=2"))
        self.assertEqual(0, run.status, run.message)
        angles = [row["value"] for row in run.table("summary") if row["key"] == "angle_900"]
        self.near(angles[0], TURN, 1e-8)
        self.near(angles[1], -2 * TURN, 1e-8)

    def test_equations(self):
        """Equations equivalent to an RBE2, with its angle as the displacement of a point, bend the beam in the same way."""
        arms = {51: -0.5, 52: -0.25, 54: 0.25, 55: 0.5}
        cards = "|".join(f"MPC,5,{node},1,1.0,53,1,-1.0,,+|+,,990,1,{arm!r}|MPC,5,{node},2,2.0,53,2,-2.0" for node, arm in arms.items())
        run = self.valid(beam(f"GRID,990,,0.0,5.0,0.0|SPC1,1,2,990|{cards}|FORCE,1,990,,0.002,1.0,0.0,0.0"))
        self.near(run.nodes[990]["ux"], TURN, 1e-8)
        self.near(run.nodes[53]["uy"], TURN * LENGTH / 2, 1e-8)

    def test_sets_of_equations(self):
        """MPC = n chooses, MPCADD combines; a chain of equations is followed to its end."""
        cards = "MPC,5,51,1,1.0,52,1,-1.0|MPC,6,52,1,1.0,53,1,-1.0|MPC,7,54,1,1.0,51,1,1.0|MPCADD,9,5,6|FORCE,1,51,,0.01,1.0,0.0,0.0"
        run = self.valid(beam(cards, case="MPC=9"))
        self.near(run.nodes[51]["ux"], run.nodes[53]["ux"], 1e-10)
        self.assertGreater(abs(run.nodes[54]["ux"] + run.nodes[51]["ux"]), 1e-6)

    def test_springs(self):
        """Springs in a row with a bar: to the ground, to a moved point, and one that alone restrains a body."""
        end = "RBE2,901,53,1,51,52,54,55"
        run = self.valid(beam(f"{end}|CELAS2,950,100.0,53,1|FORCE,1,53,,0.02,1.0,0.0,0.0"))
        self.near(run.nodes[53]["ux"], 0.02 / 200, 1e-9)
        self.near(run.summary["spring_950"], -0.01, 1e-9)
        run = self.valid(beam(f"{end}|GRID,990,,12.0,0.0,0.0|SPC,1,990,12,2.0E-4|CELAS1,950,7,53,1,990,1|PELAS,8,5.0,,,7,100.0"))
        self.near(run.nodes[53]["ux"], 1e-4, 1e-9)
        self.near(run.nodes[990]["rx"], 0.01, 1e-9)
        run = self.valid(beam(f"{end}|RBE2,902,3,1,1,2,4,5|SPC1,1,2,3,53|CELAS2,950,50.0,0,0,3,1|FORCE,1,53,,0.02,1.0,0.0,0.0", hold=False))
        self.near(run.nodes[3]["ux"], 0.02 / 50, 1e-9)
        self.near(run.summary["spring_950"], 0.02, 1e-9)

    def hot(self, cards, case="TEMPERATURE(LOAD) = 7", density=""):
        """A beam that expands by 1E-5 per degree, and has mass."""
        return self.valid(beam(cards, case).replace(f"MAT1,1,{YOUNG!r},,0.0", f"MAT1,1,{YOUNG!r},,0.0,{density},1.0E-5"))

    def test_heat_and_ties(self):
        """Thermal expansion presses a spring, follows equations, and rotates a master node: temperatures along the beam, and across it."""
        end = "RBE2,901,53,1,51,52,54,55|SPC1,1,2,53"
        run = self.hot(f"{end}|CELAS2,950,100.0,53,1|TEMPD,7,40.0")
        self.near(run.summary["spring_950"], -0.2, 1e-9)   # free expansion is 4E-3; half of that is pressed back
        self.near(run.nodes[53]["ux"], 2e-3, 1e-9)
        run = self.hot(f"{end}|GRID,990,,20.0,0.0,0.0|SPC1,1,2,990|MPC,9,990,1,1.0,53,1,-2.0|TEMPD,7,40.0", "MPC = 9\nTEMPERATURE(LOAD) = 7")
        self.near(run.nodes[990]["ux"], 8e-3, 1e-9)
        heat = "|".join(f"TEMP,7,{node},{40.0 * ((node - 1) % 5 - 2)!r}" for node in range(1, 56) if (node - 1) // 5 % 2 == 0 or (node - 1) % 5 % 2 == 0)
        bent = -1e-5 * 160.0 * LENGTH / HEIGHT
        run = self.hot(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|MOMENT,1,900,,0.0,0.0,0.0,1.0|{heat}|TEMP,7,900,0.0")
        self.near(run.summary["angle_900"], bent, 1e-8)
        self.near(run.nodes[900]["uy"], bent * LENGTH / 2, 1e-8)
        run = self.hot(f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|SPC1,1,6,900|MOMENT,1,900,,0.0,0.0,0.0,1.0|{heat}|TEMP,7,900,0.0")
        self.near(run.summary["moment_900"], -bent * STIFFNESS / LENGTH, 1e-8)

    def test_weight_and_ties(self):
        """The dead weight rotates the master node at a beam's end; along the beam it pulls a spring."""
        weight = "GRAV,1,,1.0,0.0,-1.0,0.0|GRAV,2,,1.0,1.0,0.0,0.0|MOMENT,1,900,,0.0,0.0,0.0,1.0|MOMENT,2,900,,0.0,0.0,0.0,1.0"
        cards = f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|CELAS2,950,100.0,900,1|{weight}"
        angle, pulled = -1e-3 * LENGTH**3 / (6 * STIFFNESS), 1e-3 * LENGTH**2 / (2 * YOUNG) / 2
        run = self.hot(cards, "LOAD = 1", density="1.0E-3")
        self.near(run.summary["angle_900"], angle, 1e-8)
        run = self.hot(cards, "LOAD = 2", density="1.0E-3")
        self.near(run.summary["angle_900"], 0.0, 1e-8, 1e-3)
        self.near(run.nodes[900]["ux"], pulled, 1e-8)
        self.near(run.summary["spring_950"], -100.0 * pulled, 1e-8)

    def test_joined(self):
        """A body with a spring is joined."""
        run = self.valid(beam("CELAS2,950,100.0,53,1|FORCE,1,53,,0.02,1.0,0.0,0.0|PARAM,RULE,JOINED|GRID,991,,5.0,-0.6,0.0|SPC1,1,12,991|CGAP,700,701,23,991|PGAP,701"))
        self.assertIn("contact solver JOINED:", run.listing)

    def test_yielding(self):
        """With a spring and a platen that rotates each method finds the same yielded state."""
        cards = (f"GRID,900,,{LENGTH},0.0,0.0|{RIGHT}|MOMENT,1,900,,0.002,0.0,0.0,1.0|CELAS2,950,1.0,900,2|"
                 "MATS1,1,,PLASTIC,100.0,,,0.008|PARAM,TOL,1.E-9")
        runs = [self.valid(beam(f"{cards}|PARAM,METHOD,{word}", nu=0.3)) for word in ("NEWTON", "MODSEC", "INISTR")]
        for run in runs:
            self.assertGreater(run.summary["plastic_elements"], 0)
            self.near(run.summary["angle_900"], runs[0].summary["angle_900"], 1e-6)

    def test_rejected_decks(self):
        """The exact text."""
        ring = "GRID,1,,1.0,0.0|GRID,2,,2.0,0.0|GRID,3,,1.0,1.0|CTRAX3,1,1,1,2,3|PSOLID,1,1|MAT1,1,1000.0,,0.3|SPC1,1,2,1|RBE2,9,1,12,3|" \
               "MOMENT,1,1,,1.0,0.0,0.0,1.0"
        for deck, words in (
                ("\n".join(["BEGIN BULK", *ring.split("|"), "ENDDATA"]) + "\n",
                 "RBE2 9: GRID 1 would rotate, and axisymmetric bodies do not\n"),
                (beam("MOMENT,1,53,,1.0,0.0,0.0,1.0"), "MOMENT 1: GRID 53 is not GN of an RBE2, and elements have no rotations\n"),
                (beam("RBE2,9,53,12,55|MOMENT,1,53,,1.0,1.0,0.0,1.0"), "MOMENT 1: field 6 (N1) is out of range\n"),
                (beam("RBE2,9,53,12,55|SPC,1,53,6,0.1|SUPORT,53,6"),
                 "SUPORT 53: direction 6 of GRID 53 is fixed by a support or depends on an RBE2\n"),
                (beam("MPC,5,1,1,1.0,53,1,-1.0"), "MPC 5: direction 1 of GRID 1 is fixed by a support, and cannot depend on the others\n"),
                (beam("MPC,5,53,6,1.0,51,1,-1.0"), "MPC 5: GRID 53 has no direction 6\n"),
                (beam("MPC,5,53,1,1.0,51,1,-1.0|MPC,5,53,1,1.0,52,1,-1.0"),
                 "MPC 5: direction 1 of GRID 53 depends on an RBE2 or another MPC already, and cannot depend on the others\n"),
                (beam("MPC,5,53,1,1.0,51,1,-1.0|MPC,5,51,1,1.0,53,1,-1.0"), "MPC 5: direction 1 of GRID 53 would depend on itself\n"),
                (beam("MPC,5,53,1,0.0,51,1,-1.0"), "MPC 5: direction 1 of GRID 53 has the coefficient 0.0, and cannot depend on the others\n"),
                (beam("CELAS1,950,7,53,1"), "CELAS1 950: field 3 (PID): there is no PELAS 7\n"),
                (beam("CELAS2,950,1.0"), "CELAS2 950: has no node\n"),
                (beam("CELAS2,950,1.0,53"), "CELAS2 950: has no direction there\n"),
                (beam("CELAS2,950,1.0,53,1,53,1"), "CELAS2 950: has both ends at one DOF\n")):
            with self.subTest(words=words):
                result = scene.solve(deck)
                self.assertEqual(2, result.status)
                self.assertIn(words, result.message)
                self.assertIn(": 1 error\n", result.message)

    def test_cards_that_are_not_here(self):
        """Their messages, and the remedies."""
        for card, words in (("CBUSH", "CBUSH is not supported: connectors with several directions\n"), ("CELAS3", "CELAS3 is not supported: scalar points\n"),
                            ("BOLTFOR", "BOLTFOR is not supported: bolts with a preload\n"), ("BCTSET", "BCTSET is not supported: contact of bodies\n"),
                            ("RBE3", "RBE3 is not supported: weighted means of displacements\n")):
            with self.subTest(card=card):
                self.assertIn(words, scene.solve(beam(f"{card},1")).message)


if __name__ == "__main__":
    unittest.main()
