"""The tables that epcont writes beside a listing: DECK.summary.csv, DECK.contact.csv, ..."""
import csv


def rows(path):
    """The rows, each a dictionary of texts by column; OSError where there is no such file."""
    with open(path, newline="", encoding="latin-1") as file:
        return list(csv.DictReader(file))


def summary(path):
    """The values of a summary by key; rows that are cut off count as none."""
    return {row["key"]: row["value"] for row in rows(path) if row.get("key") and row.get("value") is not None}
