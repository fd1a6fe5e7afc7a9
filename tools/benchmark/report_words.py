"""Tables and numbers of the page."""
import math


def table(head, rows):
    return "\n".join(["| " + " | ".join(head) + " |", "| " + " | ".join("---" for _ in head) + " |",
                      *("| " + " | ".join("" if cell is None else str(cell) for cell in row) + " |" for row in rows)])


def short(value, digits=3):
    if value is None or math.isnan(value):
        return ""
    return f"{value:.{digits}g}" if abs(value) < 10 ** digits else f"{value:.0f}"


def per_cent(value):
    return "" if math.isnan(value) else f"{100 * value:+.2f}"


def best(rows, kind, program):
    return [row for row in rows if row["kind"] == kind and row["program"] == program and row["best"]]


def exponent(points):
    """Slope of the logarithms by least squares."""
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mx, my = (sum(values) / len(logs) for values in zip(*logs))
    return sum((x - mx) * (y - my) for x, y in logs) / sum((x - mx) ** 2 for x, _ in logs)


def milliseconds(seconds):
    return short(1e3 * seconds)
