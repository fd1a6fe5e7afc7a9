"""Cards in small fields if all digits of their reals fit, otherwise in large ones."""

from cards import written

SMALL, LARGE = 8, 16


def fits_small(value):
    return not isinstance(value, float) or float_of(written(value, SMALL)) == value


def float_of(text):
    """The number of a field."""
    at = max(text.rfind("+"), text.rfind("-"))
    return float(text) if at < 1 else float(f"{text[:at]}e{text[at:]}")


def card(name, *values):
    """The lines of a card; None and "" are blank."""
    width = SMALL if all(fits_small(value) for value in values) else LARGE
    fields = ["" if value is None else written(value, width) if isinstance(value, float) else str(value) for value in values]
    on_line = 64 // width
    first, further = (name, "") if width == SMALL else (name + "*", "*")
    return [((first if i == 0 else further).ljust(8) + "".join(field.ljust(width) for field in fields[i:i + on_line])).rstrip()
            for i in range(0, len(fields), on_line)]
