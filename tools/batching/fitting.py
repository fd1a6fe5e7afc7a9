"""Format values of a table for the fields of a deck: 8 columns, 16 columns, or between commas."""
import re
from decimal import Decimal

import cards

NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]?([+-]\d+)|[eEdD](\d+))?", re.ASCII)   # ASCII digits only
MOST_ROUNDED = 1e-6   # relative to the value; most reals of seven digits fit a small field


class Unfit(Exception):
    """A value does not fit its field; the text gives fault and remedy."""


def fit(text, kind, width):
    """Format `text` for a field of a given type (as in `epcont --cards`) and width; without a width it stands between commas."""
    text = text.strip()
    if text == "":
        return ""
    if kind == "":
        raise Unfit("the field must be blank: remove the value")
    if kind == "integer" or (kind == "any" and re.fullmatch("[+-]?[0-9]+", text)):
        text = whole(text)
    elif kind == "real" or (kind == "any" and NUMBER.fullmatch(text)):
        text = real(text, width)
    elif kind == "digits" and not re.fullmatch("[1-6]{1,6}", text):
        raise Unfit("not a list of components: give digits from 1 to 6")
    elif kind in ("word", "any") and not re.fullmatch(r"[A-Za-z][!-+\--~]{0,7}", text):
        raise Unfit("not a word: give at most 8 characters, first a letter")
    if width and len(text) > width:
        raise Unfit(f"{len(text)} characters in a field of {width}: use a large field (a * after the card's name; 16 characters) "
                    "or free format (commas)")
    return text


def whole(text):
    """Tables often contain whole numbers written as reals."""
    match = re.fullmatch(r"([+-]?[0-9]+)(\.0*)?", text)
    if not match:
        raise Unfit("not a whole number: give one")
    return match[1]


def real(text, width):
    """Keep the text if it has a decimal point and fits; otherwise round it to the digits that fit."""
    match = NUMBER.fullmatch(text)
    if not match:
        raise Unfit("not a real: write it as 1.5, 1.5E-3 or 1.5-3")
    value = number(text)
    if not value.is_zero() and not -300 < value.adjusted() < 300:
        raise Unfit("out of the range of reals: give a value between 1E-300 and 1E300")
    if "." in match[1] and len(text) <= (width or len(text)):
        return text
    try:
        short = cards.written(value, width or None)
    except ValueError as error:
        raise Unfit(str(error)) from None
    off = abs(number(short) - value)
    if off > abs(value) * Decimal(MOST_ROUNDED):
        raise Unfit(f"{width} columns hold only {short}, with a relative error of {float(off / abs(value)):.1g}: "
                    "use a large field (a * after the card's name) or free format (commas)")
    return short


def number(text):
    """Number of a text; None if it is not a number."""
    match = NUMBER.fullmatch(text.strip())
    return match and Decimal(f"{match[1]}E{match[2] or match[3] or 0}")


def digits(text):
    """Number of digits of a real."""
    return len(re.sub("[^0-9]", "", NUMBER.fullmatch(text.strip())[1]).lstrip("0"))
