"""Read the tables that epcont writes beside a listing: DECK.summary.csv, DECK.contact.csv, ..."""
import csv


def rows(path):
    """Rows as dictionaries of texts by column; OSError if there is no such file."""
    with open(path, newline="", encoding="latin-1") as file:
        return list(csv.DictReader(file))


def summary(path):
    """The values of a summary by key; incomplete rows are ignored."""
    return {row["key"]: row["value"] for row in rows(path) if row.get("key") and row.get("value") is not None}


def case_of(place, stem, wanted=None):
    """The given load case, or the one with the largest pressure, the first of equals; None if the deck has only one.
    ValueError if there is no such case."""
    path = place / f"{stem}.cases.csv"
    found = rows(path) if path.exists() else []
    if wanted is not None and all(row["subcase"] != str(wanted) for row in found):
        numbers = ", ".join(row["subcase"] for row in found[:10]) + ", ..." * (len(found) > 10)
        raise ValueError(f"no SUBCASE {wanted}: the deck has " + (numbers or "only one case"))
    if wanted is not None or not found:
        return wanted
    return int(max(found, key=lambda row: float(row["max_pressure"] or -1.0))["subcase"])


def of_case(found, case):
    """The rows of a load case; all rows if there is only one."""
    return found if case is None else [row for row in found if row["subcase"] == str(case)]
