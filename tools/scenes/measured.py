"""epcont's results for the kept decks: the last paragraph of their heads.

They hold for these meshes only, so only the kept decks have them.
"""

MEASURED = {
    "hertz/hertz330.dat": "p_max 200.35, approach -0.00139709, half-width 0.0298, 6 of 9 pairs touch, 109 elements yield.",
    "hertz/hertz900.dat": "p_max 199.11, approach -0.00141228, half-width 0.0297, 10 of 14 pairs touch, 316 elements yield.",
    "hertz/hertz330_unloaded.dat": "p_max 197.32, approach -0.00139110; unloaded: approach -0.00016802, sx from -31.5 to 46.1; loaded again: the "
                                   "same as at first.",
    "hertz/hertz900_unloaded.dat": "p_max 193.320, approach -0.00140571; unloaded: approach -0.00017830, sx from -29.33 to 65.34; loaded again: "
                                   "p_max 193.320. An independent program has the same with these increments.",
    "tube/tube12.dat": "u(a) 0.111022, u(b) 0.0703737 (means), 72 elements yield, their centres within 106.6.",
    "tube/tube16.dat": "u(a) 0.183360, u(b) 0.111540 (means), 360 elements yield, their centres within 136.6.",
    "tube/tube_limit.dat": "u(a) 0.361949, u(b) 0.204948 (means), 840 elements yield, their centres within 186.6; 8 iterations.",
    "tube/tube_hardening.dat": "u(a) 0.154046, u(b) 0.0956347 (means), 264 elements yield, their centres within 126.6.",
    "rolling/rolling.dat": "the passes add plastic strains of at most 1.190, 0.080, 0.041, 0.026, 0.019, 0.015, 0.011, 0.009, 0.007 and 0.006 k/G.",
    "bar/bar.dat": "all of these to twelve digits or more.",
    "one_element/one_element.dat": "all of these to their last digit.",
    "cook/cook_elastic.dat": "23.516 and 24.342.",
    "cook/cook.dat": "106.567 up at the middle of the end, 107.809 at its upper corner; 972 of 1152 elements yield.",
    "punch_limit/punch_limit.dat": "approach -0.256203, 1143 of 1240 elements yield, 14 iterations.",
    "faults/punch_beyond.dat": "load factor 0.6 is carried, 0.7 is not.",
    "insert_joint/insert_joint.dat": "231.7 at the mouth, 121.7 at the inner end, each on 4 pairs; 16 elements yield, 14 of them at "
                                     "the mouth; the end goes down by 0.3126. 5 iterations.",
    "hertz/hertz_ctria6.dat": "p_max 265.85, approach -0.00131988, half-width 0.0236, 8 of 11 pairs touch; pressures within 0.2 % "
                              "but for the side at which the contact ends.",
    "hertz/hertz_cquad4.dat": "p_max 266.71, approach -0.00132174, half-width 0.0241, 6 of 9 pairs touch.",
    "tube/tube_ctria6.dat": "u(a) 0.183588, u(b) 0.111646 (means), 96 elements yield, their centres within 136.5.",
    "tube/tube_cquad4.dat": "u(a) 0.183236, u(b) 0.111482 (means), 168 elements yield, their centres within 132.4.",
    "tube/tube_near_incompressible.dat": "u(a) 0.00131550, u(b) 0.000657841 (means), 120 elements yield, their centres within 1.224; "
                                         "5 iterations.",
    "punch_limit/punch_limit_ctria6.dat": "approach -0.0174278, 375 of 680 elements yield, 20 iterations. This mesh carries 3.03 "
                                          "times the yield stress.",
    "ball/ball_on_flat.dat": "p_max 1462.6, half-width 0.20027, approach -0.00395851, 9 of 13 pairs touch. The approach is 1.0 % short, as "
                             "is that of finer meshes: the far points are one radius away (0.5 % with --part 0.01).",
    "cattaneo/cattaneo.dat": "p_max 0.55031; the middle sticks up to 0.63558, then up to 0.78080 (up to 0.63017 and 0.77581 with -n 32).",
    "cattaneo/cattaneo_lines.dat": "p_max 0.55031; the middle sticks up to 0.63561, then up to 0.78081.",
    "dovetail_friction/dovetail_friction.dat": "426.18, 852.37, 604.75 and 852.37, the means of both flanks.",
    "pull_off/pull_off.dat": "it slips off under 37135.1, between the second and the third step of 0.001.",
    "spinning_disc/spinning_disc.dat": "pressures from 7.3336 to 7.3969; all 25 pairs touch.",
}
