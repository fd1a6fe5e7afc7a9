"""Part 8: two cylinders pressed and pushed with friction, in increments, beside CalculiX with the same mesh and increments."""
import statistics

import calculix_deck
import tables
from process import peak, settled, timed
from scenes import friction

#: Elements in a for some 3 000 and 11 000 nodes; increments of each load case; tangential loads over mu P, one after the other.
ACROSS, INCREMENTS, PUSHES = {3000: 9, 11000: 38}, 10, (0.6, 0.95, 0.0)
#: CalculiX: contact, normal stiffness, and stiffness while it sticks, over Young's modulus. Only one is run in turns, and on the larger mesh with yielding.
#: On the smaller mesh it finds no answer with 1e4 and 1e5, nor with a normal stiffness of 1e5.
CONTACT, NORMAL, TANGENTIAL, FASTEST = "SURFACE TO SURFACE, SMALL SLIDING", 1e3, (1e1, 1e2, 1e3), 1e2
#: Seconds: limit of a run, and the most that is run in turns.
MOST, LONG = 1800, 120.0
#: Allowed difference of the contact forces, over the largest.
WITHIN = 0.02


def deck_of(across, yields):
    return friction.cattaneo(across, lines=True, pushes=PUSHES, steps=INCREMENTS, yields=friction.LARGEST / 3.0 if yields else None, element="ctria3",
                             growth=(1.2, 1.2), reach=1.7)


def compare(place, name, text):
    """Largest differences over all load cases: displacements of the upper platen along y and x, contact and friction forces, each over the largest; pairs
    that stick in one program only. None if CalculiX did not reach the end."""
    moved, forces = calculix_deck.displacements(place / f"{name}.dat"), calculix_deck.contact_forces(place / f"{name}.dat", text)
    if len(moved) <= len(PUSHES):
        return None
    rows = tables.rows(place / "scene.friction.csv")
    approach = {(row["subcase"], row["key"][-1]): float(row["value"]) for row in tables.rows(place / "scene.summary.csv") if row["key"].startswith("approach_")}
    largest, limit = (max(float(row[key]) for row in rows) for key in ("force", "limit"))
    worst = [0.0, 0.0, 0.0, 0.0, 0]
    for time, at in forces.items():
        case = f"{time:.0f}"
        of = [(row, *at[int(row["pair"])]) for row in rows if row["subcase"] == case]
        figures = [abs(moved[time][axis - 1] - approach[case, str(axis)]) / max(abs(value) for (_, a), value in approach.items() if a == str(axis)) for axis in (2, 1)]
        figures.append(max(abs(float(row["force"]) - y) for row, _, y in of) / largest)
        figures.append(max(abs(float(row["friction_force"]) - x) for row, x, _ in of) / limit)
        # CalculiX sticks where its friction force is a thousandth below the limit.
        figures.append(sum((row["state"] == "sticks") != (y > 1e-4 * largest and abs(x) < 0.999 * friction.MU * y) for row, x, y in of))
        worst = [max(pair) for pair in zip(worst, figures)]
    return worst


def pushed(place, program, sizes, turns, say):
    """A row for each mesh, material and stiffness: differences, and times in turns if the run is short and the answer sound."""
    rows = []
    for wanted in sizes:
        for yields in (False, True) if wanted == min(ACROSS) else (True,):
            folder = place / f"pushed{wanted}{yields}"
            folder.mkdir()
            text = deck_of(ACROSS[wanted], yields).text()
            (folder / "scene.dat").write_text(text, encoding="ascii")
            ours = [str(program), "scene.dat"]
            _, memory, _, _ = peak(ours, folder)
            for tangential in TANGENTIAL if wanted == min(ACROSS) else (FASTEST,):
                name = f"at{tangential:.0f}"
                calculix_deck.write_sequence(folder / f"{name}.inp", text, CONTACT, INCREMENTS, NORMAL, tangential)
                command = ["timeout", str(MOST), "ccx", name]
                status, much, seconds, _ = peak(command, folder)
                worst = compare(folder, name, text)
                row = {"nodes": text.count("\nGRID"), "yields": yields, "tangential": tangential, "memory": memory, "ccx_memory": much, "status": status,
                       "worst": worst, "ccx": seconds, "ours": settled(ours, folder)[1]}
                row["ratio"] = seconds / row["ours"]
                if worst and worst[2] <= WITHIN and tangential == FASTEST and seconds < LONG:
                    turned = [(timed(command, folder)[1], settled(ours, folder)[1]) for _ in range(turns)]
                    row |= {"ccx": statistics.median(a for a, _ in turned), "ours": statistics.median(b for _, b in turned),
                            "ratio": statistics.median(a / b for a, b in turned)}
                rows.append(row)
                say(f"{row}")
    return rows
