"""Cards in small fields where all digits of their reals fit, in large ones else."""

SMALL, LARGE = 8, 16


def written(value, width):
    """A real as a field of so many columns has it: with a decimal point, and as many digits as fit."""
    for digits in range(17, 0, -1):
        for text in (plain(value, digits), with_exponent(value, digits)):
            if text and len(text) <= width:
                return text
    raise ValueError(value)


def plain(value, digits):
    """`.025`, `12.`; empty where that takes an exponent."""
    text = f"{value + 0.0:.{digits}g}"   # without the sign of a zero
    if "e" in text:
        return ""
    text = text if "." in text else text + "."
    return text if text == "0." else text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def with_exponent(value, digits):
    """`1.5-3`, as NASTRAN has it."""
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    mantissa = mantissa.rstrip("0") if "." in mantissa else mantissa + "."
    return f"{mantissa}{int(exponent):+d}"


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
