#!/usr/bin/env python3
"""check_rules.py PROGRAM DECK OUTPUT: a deck must give the same tables by RULE CONRY and by RULE BLOCK."""
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "tools"))
from common import load  # noqa: E402

# What tells of the way to the answer, not of the answer.
WAY = {"pivots"}


def run(program, deck, rule, output):
    """Solve the deck by one rule; its tables, without the pivots, are left in `output`."""
    output.mkdir(parents=True, exist_ok=True)
    for old in output.glob("*"):
        old.unlink()
    lines = [line for line in deck.read_text().splitlines() if not re.match(r"PARAM[\s,]+(RULE|ORIGINAL)", line, re.IGNORECASE)]
    begin = [line.strip().upper() for line in lines].index("BEGIN BULK")
    lines.insert(begin + 1, f"PARAM,RULE,{rule}")
    copy = output / deck.name
    copy.write_text("\n".join(lines) + "\n")
    status = subprocess.run([program, copy, "-o", output, "--tables", "all", "--quiet"], stderr=subprocess.DEVNULL).returncode
    for path in [copy, *output.glob("*.lst"), *output.glob("*.pivots.csv")]:
        path.unlink()
    for table in output.glob("*.csv"):
        rows = [line.split(",") for line in table.read_text().splitlines()]
        kept = [k for k, name in enumerate(rows[0]) if name not in WAY]
        rows = [[row[k] for k in kept] for row in rows if row[0] not in WAY]
        table.write_text("\n".join(",".join(row) for row in rows) + "\n")
    return status


def main():
    program, deck, output = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    status = {rule: run(program, deck, rule, output / rule) for rule in ("CONRY", "BLOCK")}
    if status["CONRY"] != status["BLOCK"]:
        sys.exit(f"exit status {status['CONRY']} by CONRY, {status['BLOCK']} by BLOCK")
    names = [sorted(path.name for path in (output / rule).glob("*.csv")) for rule in ("CONRY", "BLOCK")]
    if names[0] != names[1] or not names[0]:
        sys.exit(f"tables {names[0]} by CONRY, {names[1]} by BLOCK")
    compare = load("compare").main
    sys.exit(max(compare(["--relative", "1e-9", "--absolute", "1e-12", *(str(output / rule / name) for rule in ("CONRY", "BLOCK"))])
                 for name in names[0]))


if __name__ == "__main__":
    main()
