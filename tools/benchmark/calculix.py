"""The two cylinders as input of CalculiX, and its results.

The same nodes and elements as epcont's deck (CTRIA3: CPE3, plane strain), the same bilinear steel, line of symmetry and
load. The platen is one *EQUATION for each of its other nodes; the rigid plane is one of:

gap     GAPUNI elements from fixed nodes to the contact nodes, with the initial gaps of the deck as clearance. CalculiX iterates only
        if the material is nonlinear (or NLGEOM is on): the elastic inputs have a *PLASTIC card that is never reached.
pair    *CONTACT PAIR, NODE TO SURFACE, linear pressure-overclosure, with one fixed quadrilateral.

Closed gaps have stiffness 1e5 E in both. Plasticity is flow theory in CalculiX, total theory in epcont.
"""
import pathlib

from scenes.cylinders import STEEL

YOUNG, NU, LOAD = 20400.0, 0.29, 5.0
STIFFNESS = 1e5 * YOUNG


def counterclockwise(mesh):
    for a, b, c in mesh.element:
        (ax, ay), (bx, by), (cx, cy) = (mesh.point[node] for node in (a, b, c))
        yield (a, b, c) if (bx - ax) * (cy - ay) > (by - ay) * (cx - ax) else (a, c, b)


def listed(nodes):
    return "".join(", ".join(str(node + 1) for node in nodes[i:i + 12]) + ",\n" for i in range(0, len(nodes), 12))


def write(path, mesh, touch, plastic, contact="gap", solver="SPOOLES", increment=1.0, loads=()):
    """The input; `touch`: the contact nodes from the axis outwards. `loads`: parts of the load at the end of each step of a history, whose
    increments CalculiX may only reduce."""
    n, e, top = len(mesh.point), len(mesh.element), mesh.line["top"]
    point = [mesh.point[node] for node in touch]
    text = ["*NODE\n"]
    text += [f"{i + 1},{x:.12g},{y:.12g},0\n" for i, (x, y) in enumerate(mesh.point)]
    text += ["*ELEMENT, TYPE=CPE3, ELSET=SOLID\n"]
    text += [f"{k + 1},{a + 1},{b + 1},{c + 1}\n" for k, (a, b, c) in enumerate(counterclockwise(mesh))]
    text += [f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{YOUNG},{NU}\n"]
    if plastic:
        (_, first), (end, last) = STEEL[1:]
        text += [f"*PLASTIC\n{first},0.\n{last},{end - last / YOUNG:.12g}\n"]
    elif contact == "gap":
        text += ["*PLASTIC\n1e9,0.\n2e9,1.\n"]
    text += ["*SOLID SECTION, ELSET=SOLID, MATERIAL=STEEL\n1.\n", "*NSET, NSET=AXIS\n", listed(mesh.line["axis"]),
             "*NSET, NSET=TOUCH\n", listed(touch), f"*NSET, NSET=PLATEN\n{top[0] + 1}\n"]
    text += [f"*EQUATION\n2\n{i + 1},2,1.,{top[0] + 1},2,-1.\n" for i in top[1:]]
    if contact == "gap":
        text += ["*NODE, NSET=GROUND\n"]
        text += [f"{n + 1 + i},{x:.12g},0,0\n" for i, (x, _) in enumerate(point)]
        for i, (node, (_, y)) in enumerate(zip(touch, point)):
            text += [f"*ELEMENT, TYPE=GAPUNI, ELSET=G{i}\n{e + 1 + i},{n + 1 + i},{node + 1}\n",
                     f"*GAP, ELSET=G{i}\n{y:.12g},0.,1.,0.,,{STIFFNESS:.6g},{1e-9 * LOAD:.3g}\n"]
    else:
        wide = 2 * point[-1][0]
        text += [f"*NODE, NSET=GROUND\n{n + 1},{-wide},0,0\n{n + 2},{wide},0,0\n{n + 3},{wide},{-wide},0\n{n + 4},{-wide},{-wide},0\n",
                 f"*ELEMENT, TYPE=CPE4, ELSET=PLANE\n{e + 1},{n + 4},{n + 3},{n + 2},{n + 1}\n",
                 "*SOLID SECTION, ELSET=PLANE, MATERIAL=STEEL\n1.\n",
                 f"*SURFACE, NAME=SLAVE, TYPE=NODE\nTOUCH\n*SURFACE, NAME=MASTER\n{e + 1},S3\n",
                 "*SURFACE INTERACTION, NAME=HARD\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n",
                 f"{STIFFNESS:.6g},{1e-9 * LOAD:.3g}\n*CONTACT PAIR, INTERACTION=HARD, TYPE=NODE TO SURFACE\nSLAVE,MASTER\n"]
    text += ["*BOUNDARY\nAXIS,1,1\nGROUND,1,3\n"]
    for part in loads or (1.0,):
        text += [f"*STEP, INC=1000\n*STATIC, SOLVER={solver}\n{increment},1.{f',1e-5,{increment}' if loads else ''}\n",
                 f"*CLOAD\n{top[0] + 1},2,{-part * LOAD}\n*NODE PRINT, NSET=PLATEN, FREQUENCY=1000\nU\n",
                 "*NODE PRINT, NSET=GROUND, FREQUENCY=1000\nRF\n" if contact == "gap" else "*CONTACT PRINT, FREQUENCY=1000\nCSTR\n",
                 "*END STEP\n"]
    pathlib.Path(path).write_text("".join(text), encoding="ascii")


def answer(path, touch, contact, end=1.0):
    """Forces at the contact nodes and the platen's displacement at the end of a step; None if it was not reached."""
    block, platen, force = "", None, {}
    for line in path.read_text(encoding="ascii").splitlines() if path.exists() else []:
        words = line.split()
        if "time" in words:
            block = words[0] if float(words[-1]) == end else ""
        elif len(words) == 4 and block == "displacements":
            platen = float(words[2])
        elif len(words) == 4 and block:
            force[int(words[0])] = float(words[2 if block == "forces" else 1])
    if platen is None or not force:
        return None
    if contact == "gap":
        return list(force.values()), platen
    whole = sum(force.values())  # CSTR is the force over an area that is equal for all nodes
    return [LOAD * force.get(node + 1, 0.0) / whole for node in touch], platen
