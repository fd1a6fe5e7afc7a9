"""Values of a table as text that the reader of decks takes: in 8 columns, in 16, or between commas."""
import re
from decimal import Decimal

import cards

NUMBER = re.compile(r"([+-]?(?:\d+\.?\d*|\.\d+))(?:[eEdD]?([+-]\d+)|[eEdD](\d+))?", re.ASCII)   # digits of other scripts are none
MOST_ROUNDED = 1e-6   # of a value; most reals of seven digits fit a small field


class Unfit(Exception):
    """What is wrong, and what would be right."""


def fit(text, kind, width):
    """`text` for a field of a kind (that of `epcont --cards`) and a width, or between commas (no width)."""
    text = text.strip()
    if text == "":
        return ""
    if kind == "":
        raise Unfit("the field must be blank")
    if kind == "integer" or (kind == "any" and re.fullmatch("[+-]?[0-9]+", text)):
        text = whole(text)
    elif kind == "real" or (kind == "any" and NUMBER.fullmatch(text)):
        text = real(text, width)
    elif kind == "digits" and not re.fullmatch("[1-6]{1,6}", text):
        raise Unfit("digits from 1 to 6 would be right")
    elif kind in ("word", "any") and not re.fullmatch(r"[A-Za-z][!-+\--~]{0,7}", text):
        raise Unfit("a word of at most 8 characters, first a letter, would be right")
    if width and len(text) > width:
        raise Unfit(f"{len(text)} characters in a field of {width}; a large field (a * behind the card's name) has 16, "
                    "a free one (commas) has room")
    return text


def whole(text):
    """Tables often write whole numbers as reals."""
    match = re.fullmatch(r"([+-]?[0-9]+)(\.0*)?", text)
    if not match:
        raise Unfit("a whole number would be right")
    return match[1]


def real(text, width):
    """As it stands where that has a point and fits; else with as many digits as there is room for."""
    match = NUMBER.fullmatch(text)
    if not match:
        raise Unfit("a real such as 1.5, 1.5E-3 or 1.5-3 would be right")
    value = number(text)
    if not value.is_zero() and not -300 < value.adjusted() < 300:
        raise Unfit("beyond what a real holds")
    if "." in match[1] and len(text) <= (width or len(text)):
        return text
    try:
        short = cards.written(value, width or None)
    except ValueError as error:
        raise Unfit(str(error)) from None
    off = abs(number(short) - value)
    if off > abs(value) * Decimal(MOST_ROUNDED):
        raise Unfit(f"{width} columns hold {short}, off by {float(off / abs(value)):.1g} of it; "
                    "a large field (a * behind the card's name) or a free one (commas) holds it")
    return short


def number(text):
    """The number that a text is, or none."""
    match = NUMBER.fullmatch(text.strip())
    return match and Decimal(f"{match[1]}E{match[2] or match[3] or 0}")


def digits(text):
    """How many digits a real has."""
    return len(re.sub("[^0-9]", "", NUMBER.fullmatch(text.strip())[1]).lstrip("0"))
