#!/usr/bin/env python3
"""Check that every field of every card, every PARAM and every statement of case control changes the tables, gives a note, or is an error.

The catalogue (`epcont --cards`) is compared with the changes below, so that a new field needs one here. All decks run in one process."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools"))
import cards  # noqa: E402

PROGRAM = os.environ["EPCONT_PROGRAM"]
VERBOSE = "EPCONT_VERBOSE" in os.environ
#: Outcomes of a change: other tables; another listing, perhaps with the same tables; a note or a warning, and the same tables; exit status 2.
CHANGES, LISTED, NOTED, ZERO, BLANK = ("changes",), ("listed",), ("note", None), ("error", "is out of range"), ("error", "must be blank")


def error(text):
    return "error", text


def note(text):
    return "note", text


def unknown(what):
    return error(f"there is no {what} 99")


OUTPUT = "DISPLACEMENT = ALL|STRESS = ALL|"
CASES = OUTPUT + "SPC = 1|MPC = 7|SUBCASE 1|LOAD = 10|TEMPERATURE = 3|SUBCASE 2|LOAD = 10|TEMPERATURE = 4|SUBCASE 3|LOAD = 10|TEMPERATURE = 5|SUBCASE 4|" \
        "LOAD = 12|TEMPERATURE = 6|BEGIN BULK|"
CORNERS = "GRID,1,,0.,0.|GRID,2,,1.,0.|GRID,3,,1.1,1.|GRID,4,,0.,1.|"
MIDDLES = "GRID,5,,.5,-.1|GRID,6,,1.1,.5|GRID,7,,.5,1.1|GRID,8,,-.1,.5|GRID,9,,.55,.5|"
HELD = "SPC1,1,12,1,2|FORCE,1,3,,2.,1.,-1.|"
#: Base decks. In `plane` the lower block stands on two nodes, and a platen that rotates presses the upper one on it.
DECKS = {
    "plane": CASES + "PARAM,PLANE,STRAIN|GRID,1,0,0.,0.,0.,0|GRID,2,,1.,0.|GRID,3,,1.,1.|GRID,4,,0.,1.|GRID,5,,0.,1.01|GRID,6,,1.,1.01|GRID,7,,1.,2.|"
    "GRID,8,,0.,2.|GRID,9,,.5,2.|GRID,10,,5.,0.|CQUAD4,1,1,1,2,3,4|CQUAD4,2,1,5,6,7,8|PSHELL,1,1,1.,-1,,,,.1|MAT1,1,1000.,,.3,.5,1.-4,10.|"
    "SPC1,1,2,1,2|SPC1,1,1,9|SPC1,1,12,10|SPC,1,1,1,.001,2,1,.002|FORCE,1,9,0,1.,0.,-2.,0.|FORCE,2,5,,.1,1.,0.|MOMENT,1,9,0,.1,0.,0.,1.|"
    "PLOADX1,1,2,.1,.2,6,7,10.|RBE2,7,9,126,7,8|SUPORT,9,2,9,6|CGAP,11,9,4,5,,,,3|CGAP,12,8,3,6,,,,3|PGAP,8,.01|PGAP,9,0.|"
    "CORD2R,3,0,0.,0.,0.,0.,0.,1.,0.,1.,0.|CBAR,90,1,1,2|LOAD,10,1.,2.,1,.5,2,1.,4|LOAD,12,1.,1.,1|SPCD,4,1,1,.003,2,1,.004|SPCD,2,10,1,.005|"
    "TEMP,3,7,30.,8,35.,6,28.|TEMPD,3,20.,4,50.,5,60.,6,70.|GRAV,1,0,2.,0.,-1.,0.,0|RFORCE,1,10,0,.02,0.,0.,1.,2,.01,0,0|MPC,5,6,1,1.,5,1,-1.|"
    "MPC,6,3,1,1.,4,1,-.9,,,2,1,.05|MPCADD,7,5,6|CELAS1,31,31,3,2,1,2|CELAS1,32,30,4,2,10,2|CELAS2,33,40.,5,2,8,2,.0,.0|PELAS,30,50.,,,31,60.|",
    "ctria3": "PARAM,PLANE,STRESS|" + CORNERS + HELD + "CTRIA3,1,1,1,2,3|CTRIA3,2,2,1,3,4|PSHELL,1,1,1.|PSHELL,2,1,2.|MAT1,1,1000.,,.3|",
    "cquad4": "PARAM,PLANE,STRESS|" + CORNERS + HELD + "CQUAD4,1,1,1,2,3,4|PSHELL,1,1,1.|PSHELL,2,1,2.|MAT1,1,1000.,,.3|GRID,9,,2.,2.|SPC1,1,12,9|",
    "ctria6": "PARAM,PLANE,STRESS|" + CORNERS + MIDDLES + HELD + "CTRIA6,1,1,1,2,3,5,6,9|CTRIA6,2,2,1,3,4,9,7,8|PSHELL,1,1,1.|PSHELL,2,1,2.|MAT1,1,1000.,,.3|",
    "cquad8": "PARAM,PLANE,STRESS|" + CORNERS + MIDDLES + HELD + "CQUAD8,1,1,1,2,3,4,5,6,7,8|PSHELL,1,1,1.|PSHELL,2,1,2.|MAT1,1,1000.,,.3|SPC1,1,12,9|",
    "ctrax3": CORNERS + HELD + "SPC1,1,1,4|CTRAX3,1,1,1,2,3|CTRAX3,2,2,1,3,4|PSOLID,1,1|PSOLID,2,2|MAT1,1,1000.,,.3|MAT1,2,500.,,.3|",
    "ctrax6": CORNERS + MIDDLES.replace("-.1,.5", "0.,.5") + HELD + "SPC1,1,1,4,8|CTRAX6,1,1,1,5,2,6,3,9|CTRAX6,2,2,1,9,3,7,4,8|PSOLID,1,1|PSOLID,2,2|"
    "MAT1,1,1000.,,.3|MAT1,2,500.,,.3|",
    "quiet": "STRESS = ALL|BEGIN BULK|PARAM,PLANE,STRESS|" + CORNERS + HELD + "CQUAD4,1,1,1,2,3,4|PSHELL,1,1,1.|MAT1,1,1000.,,.3|",
    "strip": "PARAM,PLANE,STRESS|" + "".join(f"GRID,{2 * k + 1},,{k}.,0.|GRID,{2 * k + 2},,{k}.,1.|" for k in range(13))
    + "".join(f"CQUAD4,{k + 1},1,{2 * k + 1},{2 * k + 3},{2 * k + 4},{2 * k + 2}|" for k in range(12))
    + "PSHELL,1,1,1.|MAT1,1,1000.,,.3|SPC1,1,12,13,14,27,28|GRID,27,,12.,1.|GRID,28,,0.,1.|CGAP,30,9,26,27,,,,3|CGAP,31,9,2,28,,,,3|PGAP,9,.1|CORD2R,3,,0.,0.,0.,0.,0.,1.,0.,1.,0.|FORCE,1,24,,1.,0.,1.|",
    "feet": "PARAM,PLANE,STRAIN|PSHELL,1,1,1.|MAT1,1,1000.,,.3|GRID,1,,-1.,-1.|GRID,2,,5.,-1.|GRID,3,,5.,0.|GRID,4,,-1.,0.|CQUAD4,1,1,1,2,3,4|"
    "GRID,21,,0.,.05|GRID,22,,1.,.05|GRID,23,,1.,1.|GRID,24,,0.,1.|CQUAD4,2,1,21,22,23,24|GRID,31,,3.,.3|GRID,32,,4.,.3|GRID,33,,4.,1.|GRID,34,,3.,1.|"
    "CQUAD4,3,1,31,32,33,34|CQUAD4,4,1,23,22,31,34|SPC1,1,12,1,2,24,23,34,33|BLSEG,1,21,22,31,32|BLSEG,2,4,3|BCONP,1,1,2|",
    "lines": "PARAM,PLANE,STRAIN|GRID,1,,0.,0.|GRID,2,,1.,0.|GRID,3,,1.,1.|GRID,4,,0.,1.|GRID,5,,.2,1.05|GRID,6,,.8,1.05|GRID,7,,.8,2.|GRID,8,,.2,2.|"
    "CQUAD4,1,1,1,2,3,4|CQUAD4,2,1,5,6,7,8|PSHELL,1,1,1.|MAT1,1,1000.,,.3|SPC1,1,12,1,2|SPC,1,7,2,-.07,8,2,-.08|SPC1,1,1,7,8|BLSEG,1,4,3|BLSEG,2,5,6|BLSEG,3,7,8|"
    "BCONP,1,2,1,,.1,4,1,0|BFRIC,4,,,0.|PARAM,CORNER,20.|",
    "friction": "PARAM,PLANE,STRAIN|GRID,1,,0.,0.|GRID,2,,1.,0.|GRID,3,,1.,1.|GRID,4,,0.,1.|GRID,5,,.2,1.05|GRID,6,,.8,1.05|GRID,7,,.8,2.|GRID,8,,.2,2.|"
    "CQUAD4,1,1,1,2,3,4|CQUAD4,2,1,5,6,7,8|PSHELL,1,1,1.|MAT1,1,1000.,,.3|SPC1,1,12,1,2|SPC,1,7,2,-.07,8,2,-.08|SPC1,1,1,7,8|BLSEG,1,4,3|BLSEG,2,5,6|"
    "BCONP,1,2,1,,,4|BFRIC,4,,,.2|",
    "yield": "PARAM,PLANE,STRAIN|" + CORNERS + "SPC1,1,12,1,2|SPC,1,3,2,.02,4,2,.02|CQUAD4,1,1,1,2,3,4|PSHELL,1,1,1.|MAT1,1,1000.,,.3|"
    "MATS1,1,,PLASTIC,50.,1,1,10.|",
    "flow": OUTPUT + "NLPARM = 3|BEGIN BULK|PARAM,PLANE,STRAIN|" + CORNERS + "SPC1,1,12,1,2|SPC,1,3,2,.02,4,2,.02|CQUAD4,1,1,1,2,3,4|PSHELL,1,1,1.|"
    "MAT1,1,1000.,,.3|MATS1,1,,PLASTIC,50.,1,1,10.|PARAM,THEORY,FLOW|NLPARM,3,2|",
    "mixed": OUTPUT + "NLPARM = 3|BEGIN BULK|PARAM,PLANE,STRAIN|" + CORNERS + "SPC1,1,12,1,2|SPC,1,3,2,.02,4,2,.02|CQUAD4,1,1,1,2,3,4|PSHELL,1,1,1.|"
    "MAT1,1,1000.,,.3|MATS1,1,,PLASTIC,50.,1,3,10.|PARAM,HRFRAC,.5|NLPARM,3,2|",
    "table": "PARAM,PLANE,STRESS|" + CORNERS + "SPC1,1,12,1,2|SPC,1,3,2,.02,4,2,.02|CQUAD4,1,1,1,2,3,4|PSHELL,1,1,1.|MAT1,1,1000.,,.3|"
    "MATS1,1,3,NLELAST|TABLES1,3,,,,,,,,0.,0.,.01,10.,.1,12.,ENDT|TABLES1,4,,,,,,,,0.,0.,.01,10.,.1,13.,ENDT|",
}

ELEMENT = [("EID", "9", CHANGES), ("PID", "2", CHANGES)]
SPC = [("SID", "9", error("SPC")), ("G1", "10", error("has another prescribed displacement")), ("C1", "2", error("has another prescribed displacement")), ("D1", ".003", CHANGES), ("G2", "5", error("SPCD 4: direction 1 of GRID 2 is not fixed")),
       ("C2", "2", error("has another prescribed displacement")), ("D2", ".004", CHANGES)]
ANYTHING = ("", "1", NOTED)
#: For each card the base deck, the number of its card there, and for each field in order its name, another value, and the outcome.
#: A value such as `6=3 7=2` changes several fields, counted from 1.
CARDS = {
    "GRID": ("plane", 2, [("ID", "99", error("there is no GRID 3")), ("CP", "1", ZERO), ("X1", "1.1", CHANGES), ("X2", "1.1", CHANGES),
                          ("X3", "1.", ZERO), ("CD", "1", ZERO), ("PS", "2", CHANGES)]),
    "CTRIA3": ("ctria3", 0, [*ELEMENT, *((name, "99", unknown("GRID")) for name in ("G1", "G2", "G3"))]),
    "PSHELL": ("plane", 0, [("PID", "99", error("there is no PSHELL 1")), ("MID1", "99", unknown("MAT1")), ("T", "2.", CHANGES),
                            ("MID2", "1", NOTED), ANYTHING, ANYTHING, ANYTHING, ("NSM", ".2", CHANGES), ANYTHING, ANYTHING, ANYTHING]),
    "MAT1": ("plane", 0, [("MID", "99", error("there is no MAT1 1")), ("E", "900.", CHANGES), ("G", "400.", error("MAT1 1: G is not E/(2(1 + NU))")),
                          ("NU", ".2", CHANGES), ("RHO", ".6", CHANGES), ("A", "2.-4", CHANGES), ("TREF", "20.", CHANGES), ("GE", ".1", NOTED),
                          ("ST", ".1", NOTED), ("SC", ".1", NOTED), ("SS", ".1", NOTED), ("MCSID", "3", NOTED)]),
    "SPC": ("plane", 0, SPC),
    "SPC1": ("plane", 0, [("SID", "9", CHANGES), ("C", "12", error("has another prescribed displacement")), ("G1..", "3", CHANGES)]),
    "FORCE": ("plane", 0, [("SID", "2", CHANGES), ("G", "8", CHANGES), ("CID", "3", ZERO), ("F", "2.", CHANGES), ("N1", ".1", CHANGES), ("N2", "-1.", CHANGES),
                           ("N3", "1.", ZERO)]),
    "PLOADX1": ("plane", 0, [("SID", "2", CHANGES), ("EID", "99", unknown("element")), ("PA", ".2", CHANGES), ("PB", ".3", CHANGES),
                             ("GA", "5", error("not the ends of an edge")), ("GB", "8", error("not the ends of an edge")), ("THETA", "20.", CHANGES)]),
    "RBE2": ("plane", 0, [("EID", "1", error("the id is taken")), ("GN", "8", error("RBE2")), ("CM", "1", note("GRID 9 rotates")), ("GM1..", "6", error("GRID 6"))]),
    "SUPORT": ("plane", 0, [("ID1", "3", error("SUPORT")), ("C1", "1", error("SUPORT 9")), ("ID2", "3", error("GRID 3 has no direction 6")),
                            ("C2", "4", error("GRID 9 has no direction 4")), *((f"{name}{k}", f"{2 * k - 1}=3 {2 * k}=2", error("1 SUPORT DOF"))
                                                                            for k in (3, 4) for name in ("ID", "C"))]),
    "CORD2R": ("plane", 0, [("CID", "99", error("there is no CORD2R 3")), ("RID", "1", ZERO), ("A1", "3=.1 6=.1", CHANGES), ("A2", ".1", error("off the x-y plane")),
                            ("A3", "1.", error("lie on one line")), ("B1", "6=.1 9=1. 10=0.", error("off the x-y plane")), ("B2", ".1", error("off the x-y plane")), ("B3", "0.", error("lie on one line")),
                            ("C1", ".1", CHANGES), ("C2", "-1.", CHANGES), ("C3", "10=0. 11=1.", error("lie on one line"))]),
    "CGAP": ("plane", 0, [("EID", "13", CHANGES), ("PID", "8", CHANGES), ("GA", "3", CHANGES), ("GB", "6", CHANGES), ("X1", "1.", NOTED), ("X2", "1.", NOTED),
                          ("X3", "1.", NOTED), ("CID", "99", unknown("CORD2R"))]),
    "PGAP": ("plane", 0, [("PID", "99", error("there is no PGAP 8")), ("U0", ".02", CHANGES), ("F0", "1.", ZERO), ("KA", "1.", NOTED), ("KB", "1.", NOTED),
                          ("KT", "1.", NOTED), ("MU1", ".1", CHANGES), ("MU2", ".1", error("field 9 (MU2) differs from MU1")), ("TMAX", "1.", NOTED), ("MAR", "1.", NOTED), ("TRMIN", "1.", NOTED)]),
    "CBAR": ("plane", 0, [("EID", "91", NOTED), ("PID", "2", NOTED), ("GA", "3", NOTED), ("GB", "3", NOTED), *[ANYTHING] * 12]),
    "PARAM": ("plane", 0, [("NAME", "NONE", error("unknown parameter NONE")), ("VALUE", "NONE", error("PARAM PLANE: field 3 (VALUE)"))]),
    "MATS1": ("yield", 0, [("MID", "99", unknown("MAT1")), ("TID", "99", unknown("TABLES1")), ("TYPE", "ELASTIC", error("field 4 (TYPE)")), ("H", "60.", CHANGES),
                           ("YF", "2", ZERO), ("HR", "2", LISTED), ("LIMIT1", "9.", CHANGES)]),
    "TABLES1": ("table", 0, [("TID", "99", error("there is no TABLES1 3")), *[("", "1", BLANK)] * 7, ("X1 ..", ".1", error("TABLES1 3")),
                             ("Y1 ..", "1.", error("TABLES1 3")), ("Y4 ..", "14=13.", CHANGES)]),
    "CTRIA6": ("ctria6", 0, [*ELEMENT, *((f"G{k}", "99", unknown("GRID")) for k in range(1, 7))]),
    "CQUAD4": ("cquad4", 0, [*ELEMENT, *((f"G{k}", "99", unknown("GRID")) for k in range(1, 5))]),
    "CTRAX3": ("ctrax3", 0, [*ELEMENT, *((f"G{k}", "99", unknown("GRID")) for k in range(1, 4))]),
    "CTRAX6": ("ctrax6", 0, [*ELEMENT, *((f"G{k}", "99", unknown("GRID")) for k in range(1, 7))]),
    "PSOLID": ("ctrax3", 0, [("PID", "99", error("there is no PSOLID 1")), ("MID", "2", CHANGES)]),
    "BLSEG": ("lines", 1, [("ID", "99", error("there is no BLSEG 2")), ("G1..", "99", unknown("GRID"))]),
    "BCONP": ("lines", 0, [("ID", "8", LISTED), ("SLAVE", "3", error("BCONP 1")), ("MASTER", "3", CHANGES), ("", "1", BLANK), ("SFAC", ".2", NOTED),
                           ("FRICID", "99", unknown("BFRIC")), ("PTYPE", "2", ZERO), ("CID", "1", ZERO)]),
    "CQUAD8": ("cquad8", 0, [*ELEMENT, *((f"G{k}", "99", unknown("GRID")) for k in range(1, 9))]),
    "LOAD": ("plane", 0, [("SID", "99", error("LOAD = 10: the deck has no such set")), ("S", "2.", CHANGES), ("S1 ..", "3.", CHANGES), ("L1 ..", "2", CHANGES)]),
    "SPCD": ("plane", 0, [("SID", "2", error("there is no set 4")), ("G1", "3", error("direction 1 of GRID 3 is not fixed")), ("C1", "6", error("GRID 1 has no direction 6")),
                          ("D1", ".005", CHANGES), ("G2", "10", error("another displacement already")), ("C2", "2", CHANGES), ("D2", ".005", CHANGES)]),
    "TEMP": ("plane", 0, [("SID", "4", CHANGES), ("G1", "3", CHANGES), ("T1", "31.", CHANGES), ("G2", "3", CHANGES), ("T2", "31.", CHANGES), ("G3", "3", CHANGES),
                          ("T3", "31.", CHANGES)]),
    "TEMPD": ("plane", 0, [field for k, there in enumerate((3, 4, 5, 6), 1)
                           for field in ((f"SID{k}", "9", error(f"TEMPERATURE = {there}" if there > 3 else "has no temperature in set 3")), (f"T{k}", "21.", CHANGES))]),
    "GRAV": ("plane", 0, [("SID", "2", CHANGES), ("CID", "3", ZERO), ("A", "3.", CHANGES), ("N1", "1.", CHANGES), ("N2", "1.", CHANGES),
                          ("N3", "1.", ZERO), ("MB", "-1", NOTED)]),
    "RFORCE": ("plane", 0, [("SID", "2", CHANGES), ("G", "9", CHANGES), ("CID", "3", ZERO), ("A", ".03", CHANGES), ("R1", "1.", ZERO),
                            ("R2", "1.", error("the axis is not z")), ("R3", "2.", CHANGES), ("METHOD", "1", NOTED), ("RACC", ".02", CHANGES),
                            ("MB", "1", NOTED), ("IDRF", "1", ZERO)]),
    "MOMENT": ("plane", 0, [("SID", "2", CHANGES), ("G", "6", error("GRID 6 is not GN of an RBE2")), ("CID", "3", ZERO), ("M", ".2", CHANGES),
                            ("N1", "1.", ZERO), ("N2", "1.", ZERO), ("N3", "2.", CHANGES)]),
    "MPC": ("plane", 1, [("SID", "5", error("there is no set 6")), ("G1 ..", "4", error("MPC 6")), ("C1 ..", "3", error("GRID 3 has no direction 3")), ("A1 ..", "2.", CHANGES)]),
    "MPCADD": ("plane", 0, [("SID", "8", error("MPC = 7: the deck has no such set")), ("S1..", "6", CHANGES)]),
    "CELAS1": ("plane", 1, [("EID", "34", CHANGES), ("PID", "31", CHANGES), ("G1", "3", CHANGES), ("C1", "1", CHANGES), ("G2", "9", error("SUPORT")), ("C2", "1", CHANGES)]),
    "CELAS2": ("plane", 0, [("EID", "34", CHANGES), ("K", "50.", CHANGES), ("G1", "8", error("both ends at one DOF")), ("C1", "1", error("SUPORT")), ("G2", "9", error("SUPORT")), ("C2", "1", error("SUPORT")),
                            ("GE", ".1", NOTED), ("S", ".1", NOTED)]),
    "PELAS": ("plane", 0, [("PID1", "99", error("there is no PELAS 30")), ("K1", "60.", CHANGES), ("GE1", ".1", NOTED), ("S1", ".1", NOTED),
                           ("PID2", "99", error("there is no PELAS 31")), ("K2", "70.", CHANGES), ("GE2", ".1", NOTED), ("S2", ".1", NOTED)]),
    "NLPARM": ("flow", 0, [("ID", "9", error("there is no such NLPARM")), ("NINC", "4", CHANGES), *([ANYTHING]*3), ("MAXITER", "9", LISTED), *([ANYTHING]*2), ("EPSU", ".1", CHANGES), *([ANYTHING]*15)]),
    "BFRIC": ("friction", 0, [("FID", "99", error("there is no BFRIC 4")), ("FSTIF", "1.", NOTED), ("", "1", BLANK), ("MU1", ".1", CHANGES)]),
}
#: The same for each PARAM.
PARAMETERS = {
    "PLANE": ("ctria3", "STRAIN", CHANGES), "RULE": ("plane", "JOINED", LISTED), "GAPGEOM": ("plane", "YES", CHANGES), "UNITS": ("plane", "MM", LISTED),
    "METHOD": ("yield", "SECANT", LISTED), "TOL": ("yield", ".1", LISTED), "MAXIT": ("yield", "7", LISTED), "MUP": ("yield", "PAPER", LISTED),
    "ORIGINAL": ("plane", "YES", LISTED), "NLOAD": ("yield", "2", LISTED), "SAVE": ("yield", "YES", LISTED), "SEARCH": ("feet", ".1", CHANGES), "SOLVER": ("plane", "FRONTAL", LISTED),
    "ACCURACY": ("plane", ".1", LISTED), "THEORY": ("flow", "TOTAL", CHANGES), "HRFRAC": ("mixed", ".9", CHANGES), "CORNER": ("lines", "170.", LISTED),
    "WTMASS": ("plane", "2.", CHANGES), "FRICTION": ("friction", "NO", CHANGES), "LGDISP": ("plane", "-1", NOTED), "INREL": ("plane", "0", NOTED)}
#: The same for each statement of case control, put before the others of `plane` or in place of the one with its name.
STATEMENTS = {
    "SOL": ("SOL 103", note("SOL: epcont solves for static loads")), "CEND": ("CEND 1", error("CEND takes no value")), "TITLE": ("TITLE = X", LISTED), "ECHO": ("ECHO = SORT", LISTED),
    "CNTNLSUB": ("CNTNLSUB = YES", LISTED), "RESTART": ("RESTART = none.restart", error("RESTART: load cases do not depend on those before")), "SUBCASE": ("SUBCASE 9", CHANGES), "SUBTITLE": ("SUBTITLE = X", LISTED),
    "LABEL": ("LABEL = X", LISTED), "SPC": ("SPC = 9", error("SPC = 9: the deck has no such set")), "LOAD": ("LOAD = 12", CHANGES),
    "MPC": ("MPC = 5", CHANGES), "BCONTACT": ("BCONTACT = NONE", CHANGES), "DISPLACEMENT": ("DISPLACEMENT = NONE", CHANGES),
    "STRESS": ("STRESS = NONE", CHANGES), "SPCFORCES": ("SPCFORCES = ALL", CHANGES), "NLPARM": ("NLPARM = 5", error("NLPARM = 5: there is no such NLPARM")),
    "TEMPERATURE": ("TEMPERATURE = 4", CHANGES)}


def read(text):
    """A base deck: statements, and cards as lists of name and fields."""
    control, _, bulk = text.rpartition("BEGIN BULK|")
    return (control or OUTPUT).split("|")[:-1], [line.split(",") for line in bulk.split("|")[:-1]]


def lines_of(card, form):
    """A card in free, small or large fields; continuation lines with a mark, or with a blank name."""
    name, *fields = card
    step = 4 if form == "large" else 8
    for k in range(0, max(len(fields), 1), step):
        part = fields[k:k + step]
        head = name if k == 0 else "+" if form == "free" or not any(part) else ""   # a blank line continues nothing
        if form == "free":
            yield ",".join([head, *part])
        elif form == "small":
            yield "".join(f"{text:8}" for text in [head, *part]).rstrip()
        else:
            yield f"{(name if k == 0 else '') + '*':8}" + "".join(f"{text:16}" for text in part).rstrip()
    if form == "large" and (len(fields) + 3) // 4 % 2:
        yield "*"


def changed(card, value, slot):
    """The card with another value in a slot, or in several: `6=3 7=2`, counted from 1."""
    new = list(card)
    for one in value.split() if "=" in value else [f"{slot}={value}"]:
        at, _, text = one.partition("=")
        new += [""] * (int(at) + 1 - len(new))
        new[int(at)] = text
    return new


class EveryField(unittest.TestCase):
    """All changes at once, each in a separate deck beside the base that it changes."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.decks = {}     # expected outcome of each: base, outcome, change
        self.catalogue = cards.Catalogue(PROGRAM)
        for base, text in DECKS.items():
            self.write(base, *read(text))

    def write(self, name, control, bulk):
        form = ("free", "small", "large")[len(self.decks) % 3]
        text = "\n".join([*control, "BEGIN BULK", *(line for card in bulk for line in lines_of(card, form)), "ENDDATA"])
        (self.folder / f"{name}.dat").write_text(text + "\n")

    def add(self, base, outcome, what, control, bulk):
        name = f"d{len(self.decks):04}"
        self.write(name, control, bulk)
        self.decks[name] = base, outcome, what

    def run_all(self):
        """Messages for each deck, its tables, and its listing without the number of PARAMs."""
        names = [f"{name}.dat" for name in [*DECKS, *self.decks]]
        done = subprocess.run([PROGRAM, "--quiet", *names], capture_output=True, text=True, cwd=self.folder, check=False,
                              env={**os.environ, "OMP_NUM_THREADS": "1"})
        said = {name: "" for name in names}
        name = names[0]
        for line in done.stderr.splitlines():
            name = next((match[0] for match in [re.match(r"\w+\.dat(?=:)", line)] if match), name)
            said[name] += line + "\n"
        tables = {name: "".join(path.name.partition(".")[2] + path.read_text() for path in sorted(self.folder.glob(name[:-3] + "*csv"))) for name in names}
        tables = {name: re.sub(r"(?m)^(\d+,)?(notes|warnings),.*", "", text) for name, text in tables.items()}
        listings = {name: path.read_text() if (path := self.folder / (name[:-3] + "lst")).exists() else "" for name in names}
        return said, tables, {name: re.sub(r"(?m)^  PARAM .*|^WARNINGS AND NOTES(.*\n)+?\n", "", text) for name, text in listings.items()}

    def judge(self):
        said, tables, listings = self.run_all()
        for base in DECKS:
            self.assertTrue(tables[f"{base}.dat"], said[f"{base}.dat"])
        wrong = []
        for name, (base, outcome, what) in self.decks.items():
            deck = f"{name}.dat"
            notes = (self.folder / f"{name}.lst").read_text() if tables[deck] else ""
            same = tables[deck] == tables[f"{base}.dat"]
            right = {"changes": lambda: tables[deck] and not same, "listed": lambda: tables[deck] and listings[deck] != listings[f"{base}.dat"],
                     "note": lambda: same and outcome[1] in notes, "error": lambda: not tables[deck] and outcome[1] in said[deck]}[outcome[0]]()
            if not right:
                wrong.append(f"{what}: {outcome}, but {'the same tables' if same else 'other tables' if tables[deck] else 'rejected'}: {said[deck]}"
                             + (self.folder / deck).read_text() * VERBOSE)
        self.assertFalse(wrong, f"{len(wrong)} of {len(self.decks)}:\n" + "\n".join(wrong))

    def test_cards(self):
        self.assertEqual(set(self.catalogue.names), set(CARDS))
        for name, (base, which, fields) in CARDS.items():
            listed = [column.name for column in self.catalogue.columns[name] if column.kind]
            if name != "TABLES1":
                self.assertEqual(listed, [field[0] for field in fields if field[2] != BLANK], name)
            control, bulk = read(DECKS[base])
            at = [k for k, card in enumerate(bulk) if card[0] == name][which]
            for slot, (field, value, outcome) in enumerate(fields, 1):
                number = 10 * ((slot - 1) // 8) + (slot - 1) % 8 + 2
                label = f"{name}: field {number}" + (f" ({field})" if field else "")
                if outcome == NOTED:
                    outcome = note(f"{label} has no effect")
                self.add(base, outcome, f"{label} = {value}", control, bulk[:at] + [changed(bulk[at], value, slot)] + bulk[at + 1:])
        self.judge()

    def test_parameters(self):
        noted = {name: ("plane", "1", NOTED) for name in self.catalogue.parameters if name not in PARAMETERS}
        for name, (base, value, outcome) in {**PARAMETERS, **noted}.items():
            control, bulk = read(DECKS[base])
            outcome = note(f"PARAM {name} has no effect") if outcome == NOTED else outcome
            bulk = [card for card in bulk if card[:2] != ["PARAM", name]] + [["PARAM", name, value]]
            self.add(base, outcome, f"PARAM {name} {value}", control, bulk)
        self.judge()

    def test_statements(self):
        control, bulk = read(DECKS["plane"])
        self.write("unknown", ["XYZ = 1"], bulk)
        said = subprocess.run([PROGRAM, "--check", "unknown.dat"], capture_output=True, text=True, cwd=self.folder, check=False).stderr
        words = re.search(r"\^\^\^ (SOL.*)", said)[1].replace(" or ", ", ").split(", ")
        self.assertEqual(set(words), set(STATEMENTS))
        for word, (statement, outcome) in STATEMENTS.items():
            base = "quiet" if word == "SPCFORCES" else "plane"
            control, bulk = read(DECKS[base])
            at = next((k for k, line in enumerate(control) if line.split()[0] == word), None)
            new = [statement, *control] if at is None else control[:at] + [statement] + control[at + 1:]
            self.add(base, outcome, statement, new, bulk)
        self.judge()


if __name__ == "__main__":
    unittest.main()
