"""Two equal cylinders, one quarter: Hertz's problem, elastic and beyond."""
from .deck import Deck
from .mesh import first_free, quarter_disc


def disc_of(radius, b, wanted):
    """The quarter disc whose number of nodes comes nearest to the wanted one."""
    candidates = [quarter_disc(radius, b, k / 10) for k in range(20, 60 if wanted < 400 else 400)
                  if 8.0 * (k / 10) ** 2 < 2 * wanted < 60.0 * (k / 10) ** 2]
    return min(candidates, key=lambda mesh: abs(len(mesh.point) - wanted))


#: The paper's steel: bilinear, kgf/mm2.
STEEL = [(0.0, 0.0), (85.0 / 20400.0, 85.0), (0.12, 100.0)]


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
    touch = [node for node in mesh.line["arc"] if mesh.point[node][0] < (1.9 if plastic else 1.5) * b]
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


def disc_spaced(spacing, far=1.0, b=0.0239):
    """The quarter disc with this spacing at the contact; the elements grow `far` times slower away from it."""
    return quarter_disc(1.0, b, b / spacing, 1.0 + spacing / (1.6 * b) / far)
