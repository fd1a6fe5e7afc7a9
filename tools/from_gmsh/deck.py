"""Make the cards of a model on its mesh."""
from .cards import card
from .faults import listed, spot
from .lines import nodes_of, shares
from .match import APART, Groups, check_bodies

AXES = {"1": "x", "2": "y"}
ELEMENTS = {3: "CTRIA3", 4: "CQUAD4", 6: "CTRIA6", 8: "CQUAD8"}
RINGS = {3: "CTRAX3", 6: "CTRAX6"}


class Maker:
    """Check a model against its mesh, and make the lines of the deck and of the mesh file that it includes."""

    def __init__(self, scene, mesh, faults):
        self.scene, self.mesh, self.faults = scene, mesh, faults
        check_bodies(scene, mesh, faults)
        self.groups = Groups(mesh, faults)
        self.contacts = self.find_contacts()
        self.held = self.find_held()
        self.platens = self.find_platens()
        self.free = self.find_free()
        self.loads_of = [self.find_loads(case) for case in scene.cases]   # pressures and forces of each load case
        self.moved_of = [self.find_moved(case) for case in scene.cases]
        self.check_temperatures()
        self.groups.note_unused()
        moved = any(value for own in self.held.values() for value, _ in own.values())
        heated = any(case.temperature is not None for case in scene.cases)
        if not (faults.errors or moved or heated or any(case.has_loads for case in scene.cases)):
            faults.note("[load]", "there is no load and no prescribed displacement: only initial overlaps give forces")
        faults.end()
        self.number = self.numbers()
        self.first = {}   # number of the first element of each body
        for name, elements in mesh.bodies.items():
            self.first[name] = 1 + sum(len(mesh.bodies[other]) for other in self.first)
        self.elements = sum(map(len, mesh.bodies.values()))

    def find_contacts(self):
        """(slave, master) of each contact, their nodes in order."""
        found = []
        for k, (slave, master, _) in enumerate(self.scene.contacts, 1):
            where = f"[[contact]] {k}" if len(self.scene.contacts) > 1 else "[[contact]]"
            lines = [self.groups.chain(f"{where} {role}", name) if name else [] for role, name in (("slave", slave), ("master", master))]
            if slave == master or not all(lines) or self.groups.share_nodes(where, slave, master):
                continue
            common = set(lines[0][1:-1]) & set(lines[1]) | set(lines[1][1:-1]) & set(lines[0])
            if common:
                self.faults.add(where, f"'{slave}' and '{master}' have {len(common)} nodes in common, the first at "
                                f"{spot(self.mesh.place[min(common)])}", APART + self.mesh.file)
            found.append(lines)
        return found

    def find_held(self):
        """{node: {direction: (value, table)}}; on the axis of axisymmetric bodies direction 1 is fixed."""
        held = {}
        for name, values in self.scene.supports.items():
            where = f"[support.{name}]"
            nodes = self.groups.find(where, name)
            given = [(node, digit, value, *held.setdefault(node, {}).setdefault(digit, (value, where))) for node in nodes for digit, value in values.items()]
            for node, digit, value, other, table in [each for each in given if each[2] != each[3]][:1]:
                self.faults.add(where, f"{AXES[digit]} = {value:g} at {spot(self.mesh.place[node])}, but {table} has {other:g}",
                                "give one displacement for each node")
        for node, place in self.mesh.place.items():
            if self.scene.rings and place[0] == 0.0:
                held.setdefault(node, {}).setdefault("1", (0.0, "the axis of the rings"))
        return held

    def find_platens(self):
        """{line: (directions, nodes)}; the first node is the master."""
        found, tied = {}, {}
        for name, digits in self.scene.platens.items():
            where = f"[platen] {name}"
            nodes = self.groups.find(where, name, points_too=False)
            tables = {(node, digit): self.held.get(node, {}).get(digit, (0.0, tied.get((node, digit))))[1] for node in nodes for digit in digits}
            for (node, digit), table in [each for each in tables.items() if each[1]][:1]:
                self.faults.add(where, f"its node at {spot(self.mesh.place[node])} is also fixed or tied in {AXES[digit]} by {table}",
                                "give each direction of a node in one of them only")
            tied.update(dict.fromkeys(tables, where))
            found[name] = (digits, nodes)
        return found

    def leader(self, node, digit):
        """The master node of a node, or itself."""
        return next((nodes[0] for digits, nodes in self.platens.values() if digit in digits and node in nodes), node)

    def find_free(self):
        """(node, direction) of each SUPORT DOF."""
        found = []
        for name, digits in self.scene.free.items():
            where = f"[free] {name}"
            nodes = self.groups.find(where, name)
            for digit in digits if nodes else "":
                leaders = dict.fromkeys(self.leader(node, digit) for node in nodes)
                table = self.held.get(nodes[0], {}).get(digit, (0.0, ""))[1]
                if len(leaders) > 1:
                    self.faults.add(where, f"its {len(nodes)} nodes are not tied in {AXES[digit]}, but a SUPORT DOF belongs to one node",
                                    f'use a point of {self.mesh.file}, or make it a platen: [platen] {name} = "{AXES[digit]}"')
                elif table:
                    self.faults.add(where, f"is fixed in {AXES[digit]} by {table}", "give a direction in which the body is unconstrained")
                else:
                    found.append((*leaders, digit))
        return found

    def find_moved(self, case):
        """{(node, direction): displacement} that replace those of the model's supports."""
        found = {}
        for name, values in case.moved.items():
            where = f"[{case.inside}support.{name}]"
            given = {(node, digit): value for node in self.groups.find(where, name) for digit, value in values.items()}
            for node, digit in [(node, digit) for node, digit in given if digit not in self.held.get(node, {})][:1]:
                self.faults.add(where, f"{AXES[digit]} of the node at {spot(self.mesh.place[node])} is not fixed",
                                f"add [support] {name}.{AXES[digit]} = 0.0: all load cases fix the same DOFs")
            found.update(given)
        return found

    def check_temperatures(self):
        """The bodies with temperatures are those of the model."""
        for case in self.scene.cases:
            for name in case.temperature if isinstance(case.temperature, dict) else ():
                if name not in self.scene.bodies:
                    self.faults.add(f"[{case.inside}temperature] {name}", f"there is no body '{name}'", f"use one of: {listed(self.scene.bodies)}")

    def find_loads(self, case):
        """(body, element, a, b, pressure) of each loaded edge; {node: [x, y]} of forces."""
        pressures, forces, pressed = [], {}, {}
        for name, load in case.loads.items():
            where = f"[{case.inside}load.{name}]"
            if "pressure" in load:
                sides = self.groups.boundary(f"{where} pressure", name)
                pressures += [(body, k, side[0], side[1], load["pressure"]) for side, body, k in sides]
                twice = {pressed.setdefault(frozenset(side), where) for side, _, _ in sides} - {where}
                if twice:
                    self.faults.note(f"{where} pressure", f"acts on edges of {listed(sorted(twice))} as well: the pressures are added")
            if "force" in load:
                nodes = self.groups.find(f"{where} force", name)
                parts = dict.fromkeys(nodes, 1.0 / max(len(nodes), 1))
                if nodes and name in self.mesh.lines:
                    parts = shares(self.mesh.lines[name], self.mesh.place, self.scene.rings)
                if parts is None:
                    self.faults.add(f"{where} force", "acts on a line on the axis, which has no area", "load a point on the axis instead")
                for node, part in (parts or {}).items():
                    for c, digit in enumerate("12"):
                        if load["force"][c] == 0.0:
                            continue
                        forces.setdefault(self.leader(node, digit), [0.0, 0.0])[c] += part * load["force"][c]
        return pressures, forces

    def numbers(self):
        """Numbers of the nodes: first along the contact lines, so that they rise there (pyNastran sorts a BLSEG's nodes)."""
        found = {}
        for line in [line for pair in self.contacts for line in pair]:
            for node in line[::-1] if line[-1] in found and line[0] not in found else line:
                found.setdefault(node, len(found) + 1)
        for node in sorted(self.mesh.place):
            found.setdefault(node, len(found) + 1)
        return found

    def mesh_lines(self):
        """GRID and elements."""
        lines = [f"$ mesh of {self.mesh.file}: the deck includes this file"]
        for node, number in sorted(self.number.items(), key=lambda item: item[1]):
            lines += card("GRID", number, None, *self.mesh.place[node][:2], 0.0)
        for section, (name, elements) in enumerate(self.mesh.bodies.items(), 1):
            lines.append(f"$ {name}")
            for k, (corners, nodes) in enumerate(elements):
                if self.scene.rings and len(nodes) == 6:   # CTRAX6 lists its nodes in order around the element
                    nodes = [nodes[i] for i in (0, 3, 1, 4, 2, 5)]
                kind = (RINGS if self.scene.rings else ELEMENTS)[len(nodes)]
                lines += card(kind, self.first[name] + k, section, *(self.number[node] for node in nodes))
        return lines + ["ENDDATA"]

    def deck_lines(self, made, mesh_file):
        """All other cards; `made` names the sources."""
        scene = self.scene
        lines = [f"$ {made}", "SOL 106", "CEND", f"TITLE = {scene.title}"]
        lines += ["SPC = 1"] if any(self.held.values()) else []
        lines += self.case_control() + ["BEGIN BULK"] + ([] if scene.rings else card("PARAM", "PLANE", scene.kind.split()[1].upper()))
        lines += card("PARAM", "UNITS", scene.units.upper()) if scene.units else []
        for name, value in scene.parameters.items():
            lines += card("PARAM", name, value.upper() if isinstance(value, str) else value)
        lines += self.sections() + self.supports() + self.loads() + self.touching()
        return lines + [f"INCLUDE '{mesh_file}'", "ENDDATA"]

    def case_control(self):
        """Cards of each load case; a single one has no SUBCASE."""
        lines = [f"CNTNLSUB = {'YES' if self.scene.sequence else 'NO'}"] if len(self.scene.cases) > 1 else []
        for k, case in enumerate(self.scene.cases, 1):
            if len(self.scene.cases) > 1:
                lines += [f"SUBCASE {k}", f"SUBTITLE = {case.title}"]
            lines += [f"LOAD = {k}"] if case.has_loads else []
            lines += [f"TEMPERATURE(LOAD) = {k}"] if case.temperature is not None else []
            lines += [f"NLPARM = {k}"] if case.increments else []
            lines += [] if case.contact else ["BCONTACT = NONE"]
        return lines

    def sections(self):
        lines = []
        used = dict.fromkeys(self.scene.bodies[name][0] for name in self.mesh.bodies)
        for number, name in enumerate(self.mesh.bodies, 1):
            material, thickness = self.scene.bodies[name]
            which = list(used).index(material) + 1
            lines += [f"$ body {name}"]
            lines += card("PSOLID", number, which) if self.scene.rings else card("PSHELL", number, which, thickness)
        for number, name in enumerate(used, 1):
            material = self.scene.materials[name]
            lines += [f"$ material {name}"] + card("MAT1", number, material.young, None, material.poisson, material.density,
                                                       material.expansion, material.reference)
            rule = {0.0: 1, 1.0: 2}.get(material.kinematic, 3)   # isotropic, kinematic, both
            if material.curve:
                points = [0.0, 0.0] + [value for point in material.curve for value in point]
                lines += card("MATS1", number, number, "PLASTIC", None, 1, rule, material.stress)
                lines += card("TABLES1", number, *[None] * 7, *points, "ENDT")
            elif material.stress:
                lines += card("MATS1", number, None, "PLASTIC", material.hardening, 1, rule, material.stress)
        return lines

    def supports(self):
        """SPC1 for zero displacements, SPC for prescribed ones; one remark for each table."""
        lines, sets = [], {}
        for node, own in self.held.items():
            for table in dict.fromkeys(table for _, table in own.values()):
                still = "".join(sorted(digit for digit, (value, t) in own.items() if t == table and value == 0.0))
                moved = tuple((digit, value) for digit, (value, t) in sorted(own.items()) if t == table and value != 0.0)
                sets.setdefault((table, still, moved), []).append(self.number[node])
        for (table, still, moved), nodes in sorted(sets.items()):
            lines.append(f"$ {table}")
            for i in range(0, len(nodes) if still else 0, 6):
                lines += card("SPC1", 1, still, *sorted(nodes)[i:i + 6])
            for digit, value in moved:
                for node in sorted(nodes):
                    lines += card("SPC", 1, node, digit, value)
        for k, (name, (digits, nodes)) in enumerate(self.platens.items(), 1):
            lead, *others = (self.number[node] for node in nodes)
            lines += [f"$ [platen] {name}"] + card("RBE2", self.elements + k, lead, digits, *others)
        for node, digit in self.free:
            lines += ["$ [free]"] + card("SUPORT", self.number[node], digit)
        return lines

    def loads(self):
        lines, axis = [], None
        if self.scene.axis and self.scene.spins:
            axis = len(self.number) + 1
            lines += ["$ axis"] + card("GRID", axis, None, *self.scene.axis, 0.0) + card("SPC1", 1, 12, axis)
        for k, case in enumerate(self.scene.cases, 1):
            lines += [f"$ {case.where} {case.title}"] if case.where else []
            lines += card("NLPARM", k, case.increments) if case.increments else []
            lines += self.loads_of_case(k, case) + self.body_loads(k, case, axis) + self.temperatures(k, case)
        return lines

    def loads_of_case(self, k, case):
        pressures, forces = self.loads_of[k - 1]
        lines = ["$ [load]"] if pressures or forces else []
        for body, element, a, b, value in pressures:
            lines += card("PLOADX1", k, self.first[body] + element, case.factor * value, case.factor * value, self.number[a], self.number[b])
        for node, (x, y) in sorted(forces.items(), key=lambda item: self.number[item[0]]):
            lines += card("FORCE", k, self.number[node], 0, case.factor, x, y, 0.0)
        for (node, digit), value in self.moved_of[k - 1].items():
            lines += card("SPCD", k, self.number[node], digit, value)
        return lines

    def body_loads(self, k, case, axis):
        lines = []
        if case.gravity:
            lines += ["$ gravity"] + card("GRAV", k, None, 1.0, *case.gravity, 0.0)
        if case.spin:
            direction = (0.0, 1.0, 0.0) if self.scene.rings else (0.0, 0.0, 1.0)
            lines += ["$ spin"] + card("RFORCE", k, axis, None, case.spin, *direction)
        return lines

    def temperatures(self, k, case):
        """TEMPD, or TEMP for every node: bodies without a temperature have that of zero thermal strain."""
        if case.temperature is None:
            return []
        lines = ["$ temperatures"]
        if not isinstance(case.temperature, dict):
            return lines + card("TEMPD", k, case.temperature)
        for name, elements in self.mesh.bodies.items():
            cold = self.scene.materials[self.scene.bodies[name][0]].reference or 0.0
            value = case.temperature.get(name, cold)
            nodes = sorted({self.number[node] for _, own in elements for node in own})
            for i in range(0, len(nodes), 3):
                lines += card("TEMP", k, *(part for node in nodes[i:i + 3] for part in (node, value)))
        return lines

    def touching(self):
        lines, number = [], {}
        for (slave, master, _), (slave_nodes, master_nodes) in zip(self.scene.contacts, self.contacts):
            for name, nodes in ((slave, slave_nodes), (master, master_nodes)):
                if name not in number:
                    number[name] = len(number) + 1
                    nodes = [self.number[node] for node in nodes]
                    rising = nodes[::-1] if nodes[0] > nodes[-1] else nodes
                    lines += [f"$ line {name}"] + card("BLSEG", number[name], *rising)
        for k, (slave, master, friction) in enumerate(self.scene.contacts, 1):
            lines += [f"$ {slave} on {master}"] + card("BCONP", k, number[slave], number[master], *(["", "", k] if friction else []))
            lines += card("BFRIC", k, "", "", friction) if friction else []
        return lines

    def told(self):
        """Summary of the deck in one line."""
        kinds = {}
        for elements in self.mesh.bodies.values():
            for _, nodes in elements:
                kind = (RINGS if self.scene.rings else ELEMENTS)[len(nodes)]
                kinds[kind] = kinds.get(kind, 0) + 1
        return f"{len(self.number)} nodes, " + ", ".join(f"{count} {kind}" for kind, count in kinds.items()) + \
            f"; bodies: {listed(self.mesh.bodies)}"

    def described(self, number):
        """Position of the node of a GRID."""
        node, bodies = self.home(number)
        return f"GRID {number} is at {spot(self.mesh.place[node])}, on {listed(bodies)}"

    def home(self, number):
        """The node of a GRID, and its bodies."""
        node = next(node for node, other in self.number.items() if other == number)
        return node, [name for name, elements in self.mesh.bodies.items() if any(node in nodes for _, nodes in elements)]

    def freed(self, number, motions):
        """Remedies in terms of the model for an unconstrained rigid-body mode that epcont reports at a GRID."""
        _, bodies = self.home(number)
        own = {node for name in bodies for _, nodes in self.mesh.bodies[name] for node in nodes}
        lines = [name for name, sides in self.mesh.lines.items() if own & set(nodes_of(sides))]
        points = [name for name, nodes in self.mesh.points.items() if own & set(nodes)]
        axes = [axis for axis, shift in (("x", "translate along (1.000, 0.0)"), ("y", "translate along (0.0, 1.000)")) if shift in motions]
        turns = "rotate" in motions
        missing = [f"in {axis}" for axis in axes] + ["in rotation"] * turns
        if axes or not turns:
            held = " and ".join(f"NAME.{axis} = 0" for axis in axes or "x")
            remedy = f'{held}; or, if contact restrains it, [free] NAME = "{"".join(axes) or "x"}", for a point or a [platen]' \
                f"{'; for the rotation one more point' * turns}"
        else:
            remedy = 'NAME.x = 0 or NAME.y = 0 for one more point; or, if contact restrains it, [free] NAME = "x" or "y" of one more'
        return f"unconstrained: {listed(bodies)} {' and '.join(missing or ['in one direction'])}\n" \
            f"  [support] {remedy}; its lines: {listed(lines)}; its points: {listed(points)}"
