"""RBE2, MPC and springs of a random model, and moments. Rigid-body modes of its bodies remain: SUPORT DOFs stay free."""


def ties(rng, scene):
    """Some of each; `scene.taken`: DOFs that cannot be dependent."""
    scene.taken = {*scene.held, *scene.support}
    scene.sets, scene.ties = set(), 0
    for add in rng.sample([platen, equations, bolt, springs], rng.choice([0, 1, 2, 2, 3, 4])):
        add(rng, scene)
    if len(scene.sets) == 1 and rng.random() < 0.5:
        return
    if scene.sets:
        scene.add_long("MPCADD", 9, *sorted(scene.sets))
        scene.control.append("MPC = 9")


def point(scene, x, y):
    """A node without elements."""
    node = scene.grid_point(x, y)
    scene.bodies[-1].remove(node)
    return node


def platen(rng, scene):
    """RBE2 of an edge: rigid along x or y, or with a master node that rotates: by a moment, an angle, or about a SUPORT."""
    tilts = turns(scene) and rng.random() < 0.5   # the master node has the SUPORT
    if tilts:
        scene.taken -= {(node, digit) for node, digit in scene.support}
    free = [node for node in scene.top if not {(node, "1"), (node, "2")} & scene.taken]
    if len(free) < 2:
        return
    scene.ties += 1
    if scene.rings or not tilts and rng.random() < 0.3:
        digits = rng.choice(["1", "2", "12"]) if not turns(scene) else "2"
        scene.add_long("RBE2", 8000, free[0], digits, *free[1:])
        scene.taken |= {(node, digit) for node in free[1:] for digit in digits}
        return
    x, y = scene.spot[free[-1]]
    master = rng.choice(free) if rng.random() < 0.4 else point(scene, x + rng.uniform(-0.5, 0.5), y + rng.uniform(0.1, 0.5))
    scene.add_long("RBE2", 8000, master, rng.choice(["12", "123456"]), *[node for node in free if node != master])
    scene.taken |= {(node, digit) for node in free for digit in "12"}
    how = rng.choice(["angle", "moment", "moment", "both"] if not turns(scene) else ["moment"])
    if tilts:
        scene.support = [(master, "2"), (master, "6")]
    if how != "angle":
        scene.add("MOMENT", rng.choice([1, 2, 3]), master, 0, rng.uniform(0.5, 2.0), 0.0, 0.0, rng.uniform(-0.03, 0.03))
        scene.add("MOMENT", 1, master, 0, rng.uniform(0.5, 2.0), 0.0, 0.0, rng.uniform(-0.03, 0.03))
    if how != "moment":
        scene.hold("6", master, value=rng.uniform(-2e-4, 2e-4) if how == "angle" else rng.choice([0.0, 1e-4]))
    if rng.random() < 0.5:
        scene.add("FORCE", 1, master, 0, 0.05, rng.uniform(-0.2, 0.2), -1.0)


def turns(scene):
    """Is there a body that nothing keeps from rotating? It is the first; MPC and springs on its straight edge do not."""
    return hasattr(scene, "straight")


def nodes_of(scene, body):
    return scene.straight if turns(scene) and body is scene.bodies[0] else body


def equations(rng, scene):
    """One to three: means of other DOFs, some with a point that a force moves. Later ones may contain the dependent DOFs of others."""
    for _ in range(rng.randint(1, 3)):
        body, digit = rng.choice(scene.bodies), rng.choice("12")
        nodes = nodes_of(scene, body)
        own = [node for node in nodes if (node, digit) not in scene.taken]
        if not own:
            continue
        a = rng.choice(own)
        b, c = rng.sample([node for node in nodes if node != a], 2)
        xa, xb, xc = (scene.spot[node][0] for node in (a, b, c))
        w = (xa - xc) / (xb - xc) if nodes is not body else rng.uniform(0.2, 0.8)
        factor = rng.choice([1.0, -2.0, rng.uniform(0.5, 3.0)])
        terms = [(a, factor), (b, -factor * w), (c, -factor * (1.0 - w))]
        scene.taken |= {(node, digit) for node in (a, b, c)}
        add_equation(rng, scene, [(node, digit, value) for node, value in terms])


def bolt(rng, scene):
    """Two bodies are pulled together by a force on an additional point."""
    if turns(scene):
        return
    upper, lower = scene.bodies[-1], scene.bodies[-2]
    own = [node for node in upper if (node, "2") not in scene.taken]
    other = [node for node in lower if (node, "2") not in scene.held]
    if not (own and other):
        return
    a, b, p = rng.choice(own), rng.choice(other), point(scene, 9.0, 9.0)
    scene.hold("2", p)
    scene.taken |= {(a, "2"), (b, "2"), (p, "1")}
    scene.add("FORCE", rng.choice([1, 1, 2]), p, 0, rng.uniform(0.05, 0.4), 1.0, 0.0)
    add_equation(rng, scene, [(a, "2", 1.0), (b, "2", -1.0), (p, "1", rng.uniform(0.5, 2.0))])


def add_equation(rng, scene, terms):
    number = rng.choice([5, 6])
    scene.sets.add(number)
    fields = [number]
    for k, term in enumerate(terms):
        fields += ([""] if k % 2 == 0 and k else []) + [*term] + ([""] if k % 2 else [])
    scene.add_long("MPC", *fields)


def springs(rng, scene):
    """One to four, between nodes of one body or two, or to the ground. One along y instead of a SUPORT may carry the last body."""
    floating = [body for body in scene.bodies if {node for node, _ in scene.support} & {*body}]
    for k in range(rng.randint(1, 4)):
        digit, kind = rng.choice("12"), rng.choice(["inside", "between", "ground", "carry"])
        body = scene.bodies[0] if turns(scene) else rng.choice(scene.bodies)
        if turns(scene):
            digit, kind = "1", "inside"
        elif body in floating:
            digit = "1" if kind != "inside" else digit
        a, b = (rng.choice(nodes_of(scene, body)) for _ in range(2))
        ends = [(a, digit), (b, digit)]
        if kind == "carry" and body is scene.bodies[-1] and body in floating:
            floating.remove(body)
            scene.support = [pair for pair in scene.support if pair[0] not in body]
            ends = [("", ""), (a, "2")]
        elif kind == "between":
            other = rng.choice([other for other in scene.bodies if other is not body])
            ends[1] = (rng.choice(other), "1" if other in floating else rng.choice("12"))
        elif kind != "inside":
            ends[rng.randint(0, 1)] = ("", "")
        if ends[0] == ends[1]:
            continue
        stiffness = 10.0 ** rng.uniform(0.0, 3.0)
        if rng.random() < 0.5:
            scene.add("CELAS2", 7000 + k, stiffness, *ends[0], *ends[1])
        else:
            scene.add("CELAS1", 7000 + k, 7100 + k, *ends[0], *ends[1])
            other = rng.choice([(), ("", "", 7200 + k, 1.0)])
            scene.add("PELAS", 7100 + k, stiffness, *other)
