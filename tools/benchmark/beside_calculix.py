"""Part 5: many pairs beside CalculiX on the same meshes: the fastest of its settings that ends with epcont's approach."""
import statistics

import calculix_deck
import tables
from process import peak, settled, timed
from scenes import many

#: Name, deck, plastic or not; required speed ratio.
SCENES = (("dovetail, 852 pairs", many.dovetail, False, 60.0), ("dovetail, 852 pairs", many.dovetail, True, 50.0),
          ("blocks, 1 500 pairs", many.blocks, False, 60.0), ("blocks, 1 500 pairs", many.blocks, True, 50.0))
SOLVERS = ("SPOOLES", "ITERATIVE CHOLESKY")
#: First load increment: the full load; if it does not converge CalculiX reduces it.
INCREMENT = 1.0
#: Allowed difference of the approach, relative to epcont's: CalculiX has flow theory, and a penalty.
WITHIN = {False: 0.01, True: 0.06}
#: Seconds: limit of a run of CalculiX, and with --quick; above the third, one turn only.
MOST, MOST_QUICK, LONG, SHORT = 1800, 300, 60.0, 5.0


def run(command, place, first):
    status, cpu, _, out = (settled if first < SHORT else timed)(command, place)
    return status, cpu, out


def scout(place, text, contact, solver, approach, within, most):
    """Command, seconds, MB and a note, which is empty if the answer is correct."""
    name = f"{contact}_{solver}".lower().replace(" ", "_")
    calculix_deck.write(place / f"{name}.inp", text, contact, solver, INCREMENT)
    command = ["timeout", str(most), "ccx", name]
    status, memory, seconds, _ = peak(command, place)
    found = calculix_deck.answer(place / f"{name}.dat")
    note = ""
    if status or found is None:
        note = f"not ended in {most} s" if status == 124 else f"exit status {status}" if status else "no answer"
    elif abs(found / approach - 1) > within:
        note = f"not sound: approach {found:.6g}, epcont's {approach:.6g}"
    return {"setting": f"{contact}, {solver}", "command": command, "seconds": seconds, "memory": memory, "note": note}


def one(place, program, scene, turns, most, say):
    name, make, yields, wanted = scene
    place.mkdir()
    text = make(yields=yields).text()
    (place / "scene.dat").write_text(text, encoding="ascii")
    command = [str(program), "scene.dat"]
    _, memory, _, _ = peak(command, place)
    summary = tables.summary(place / "scene.summary.csv")
    approach = next(float(value) for key, value in summary.items() if key.startswith("approach"))
    tried = [scout(place, text, contact, solver, approach, WITHIN[yields], most) for contact in calculix_deck.CONTACTS for solver in SOLVERS]
    sound = [setting for setting in tried if not setting["note"]]
    row = {"scene": name, "yielding": yields, "wanted": wanted, "memory": memory, "best": None,
           "tried": [{key: setting[key] for key in ("setting", "seconds", "memory", "note")} for setting in tried]}
    if sound:
        best = min(sound, key=lambda setting: setting["seconds"])
        turned = [(run(command, place, 0.0)[1], run(best["command"], place, best["seconds"])[1])
                  for _ in range(turns if best["seconds"] < LONG else 1)]
        row |= {"best": best["setting"], "ours": statistics.median(a for a, _ in turned), "ccx": statistics.median(b for _, b in turned),
                "ratio": statistics.median(b / a for a, b in turned), "lean": best["memory"] / memory}
    else:
        row["ours"] = run(command, place, 0.0)[1]
    say(f"{row}")
    for file in place.iterdir():
        file.unlink()
    return row


def beside_calculix(place, program, turns, quick, say):
    """With `quick` only the elastic dovetail."""
    chosen = [scene for scene in SCENES if not quick or scene[1] is many.dovetail and not scene[2]]
    return [one(place / f"ccx{k}", program, scene, turns, MOST_QUICK if quick else MOST, say) for k, scene in enumerate(chosen)]
