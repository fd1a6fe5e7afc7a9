"""Two equal cylinders, one quarter: Hertz's problem, elastic and beyond."""
import math

from .deck import Deck
from .mesh import first_free, on_circle, quarter_disc, quarter_disc_squared


def disc_of(radius, b, wanted, element="ctria3"):
    """The quarter disc whose number of nodes comes nearest to the wanted one."""
    if element == "cquad4":
        candidates = [disc_squared(radius, b, k) for k in range(2, 100) if wanted < 60 * k * k < 40 * wanted]
        return min(candidates, key=lambda mesh: abs(len(mesh.point) - wanted))
    corners = wanted // 4 if element == "ctria6" else wanted
    candidates = [quarter_disc(radius, b, k / 10) for k in range(10 if corners < wanted else 20, 60 if corners < 400 else 400)
                  if 8.0 * (k / 10) ** 2 < 2 * corners < 60.0 * (k / 10) ** 2]
    return curved(min(candidates, key=lambda mesh: abs(len(mesh.point) - corners)), radius, element)


def curved(mesh, radius, element):
    """With middles on the circle, where the elements have such."""
    return mesh.with_middles(on_circle((0.0, radius), radius)) if element.endswith("6") else mesh


def disc_squared(radius, b, n, far=1.0):
    """Quadrilaterals, n of them in a core 1.6 b wide."""
    core = 1.6 * b
    return quarter_disc_squared(radius, n, core, round(far * math.log(1.2 * radius / core) / math.log(1 + math.pi / (4 * n))))


def disc_spaced(spacing, far=1.0, b=0.0239, element="ctria3"):
    """The quarter disc with this spacing at the contact; the elements grow `far` times slower away from it."""
    if element == "cquad4":
        return disc_squared(1.0, b, max(2, round(1.6 * b / spacing)), far)
    return curved(quarter_disc(1.0, b, b / spacing, 1.0 + spacing / (1.6 * b) / far), 1.0, element)


#: The paper's steel: bilinear, kgf/mm2.
STEEL = [(0.0, 0.0), (85.0 / 20400.0, 85.0), (0.12, 100.0)]


def touching(mesh, reach, line="arc"):
    """The nodes of a line within reach, up to a corner of an element."""
    corners = {node for nodes in mesh.element for node in (nodes[:3] if len(nodes) == 6 else nodes)}
    near = [node for node in mesh.line[line] if mesh.point[node][0] < reach]
    return near if near[-1] in corners else near[:-1]


def hertz(mesh, plastic=False, b=0.0239):
    """Two equal cylinders, as hertz44 but on a mesh that resolves the contact."""
    kind = "ELASTOPLASTIC" if plastic else "ELASTIC"
    words = ["Two equal steel cylinders, R = 1 mm, P = 10 kgf a mm of length; "
             f"{'bilinear steel' if plastic else 'elastic'}. Units kgf, mm. One quarter: x = 0 is a line "
             "of symmetry, y = 0 the plane of symmetry between the cylinders (fixed nodes), y = 1 a platen with half of P."]
    if plastic:
        words.append("Known answer (converged, total theory): p_max 198.6, half-width 0.030, approach 0.00142 (half of 0.00284).")
    else:
        words.append("Known answer (Hertz): p_max 266.4, b 0.0239; approach 0.00132 (half of Johnson's 0.00264).")
    deck = Deck(f"TWO EQUAL STEEL CYLINDERS, {len(mesh.point)} NODES, {kind}", words, units="KGF-MM")
    touch = touching(mesh, (1.9 if plastic else 1.5) * b)
    first = first_free(mesh)
    deck.nodes(mesh)
    deck.elements(mesh, 1)
    deck.material(1, 20400.0, 0.29)
    if plastic:
        deck.follows(1, STEEL)
    deck.hold(1, mesh.line["axis"])
    deck.platen(10 * first, 2, mesh.line["top"])
    deck.card("SUPORT", mesh.line["top"][0] + 1, 2)
    deck.card("FORCE", 1, mesh.line["top"][0] + 1, 0, 5.0, 0.0, -1.0, 0.0)
    deck.remark("Plane between the cylinders, and the pairs")
    deck.ground([(mesh.point[node][0], 0.0) for node in touch], first + 1)
    deck.upward()
    deck.pairs(10 * first + 1, [(first + 1 + i, node + 1) for i, node in enumerate(touch)], 21)
    return deck

