"""What epcont gives for the decks that are kept: the last paragraph of their heads.

Of these meshes and no others, so only the kept decks say it.
"""

MEASURED = {
    "hertz/hertz330.dat": "p_max 200.35, approach -0.00139709, half-width 0.0298, 6 of 9 pairs touch, 109 elements yield.",
    "hertz/hertz900.dat": "p_max 199.11, approach -0.00141228, half-width 0.0297, 10 of 14 pairs touch, 316 elements yield.",
    "tube/tube12.dat": "u(a) 0.111022, u(b) 0.0703737 (means), 72 elements yield, their centres within 106.6.",
    "tube/tube16.dat": "u(a) 0.183360, u(b) 0.111540 (means), 360 elements yield, their centres within 136.6.",
    "tube/tube_limit.dat": "u(a) 0.361949, u(b) 0.204948 (means), 840 elements yield, their centres within 186.6; 8 iterations.",
    "tube/tube_hardening.dat": "u(a) 0.154046, u(b) 0.0956347 (means), 264 elements yield, their centres within 126.6.",
    "bar/bar.dat": "all of these to twelve digits or more.",
    "one_element/one_element.dat": "all of these to their last digit.",
    "cook/cook_elastic.dat": "23.516 and 24.342.",
    "cook/cook.dat": "106.567 up at the middle of the end, 107.809 at its upper corner; 972 of 1152 elements yield.",
    "punch_limit/punch_limit.dat": "approach -0.256203, 1143 of 1240 elements yield, 14 iterations.",
    "faults/punch_beyond.dat": "load factor 0.6 is carried, 0.7 is not.",
    "insert_joint/insert_joint.dat": "231.7 at the mouth, 121.7 at the inner end, each on 4 pairs; 16 elements yield, 14 of them at "
                                     "the mouth; the end goes down by 0.3126. 5 iterations.",
}
