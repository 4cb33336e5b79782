"""Quantities with units, as cases and command lines write them: "2.5 mm", "120 rpm", "7.8 g/cm^3"."""
from __future__ import annotations

import math
import re

from .errors import UsageError

# factor to SI, exponents of kg, m, s, rad, K, whether prefixes are allowed. The radian is a dimension of its own, as in the tools.
_SYMBOLS: dict[str, tuple[float, tuple[int, int, int, int, int], bool]] = {
    "m": (1.0, (0, 1, 0, 0, 0), True), "g": (1e-3, (1, 0, 0, 0, 0), True), "t": (1e3, (1, 0, 0, 0, 0), False),
    "s": (1.0, (0, 0, 1, 0, 0), True), "min": (60.0, (0, 0, 1, 0, 0), False), "h": (3600.0, (0, 0, 1, 0, 0), False),
    "in": (0.0254, (0, 1, 0, 0, 0), False), "N": (1.0, (1, 1, -2, 0, 0), True), "Pa": (1.0, (1, -1, -2, 0, 0), True),
    "bar": (1e5, (1, -1, -2, 0, 0), True), "J": (1.0, (1, 2, -2, 0, 0), True), "W": (1.0, (1, 2, -3, 0, 0), True),
    "Hz": (1.0, (0, 0, -1, 0, 0), True), "rad": (1.0, (0, 0, 0, 1, 0), True), "deg": (math.pi / 180, (0, 0, 0, 1, 0), False),
    "°": (math.pi / 180, (0, 0, 0, 1, 0), False), "rev": (2 * math.pi, (0, 0, 0, 1, 0), False), "rpm": (2 * math.pi / 60, (0, 0, -1, 1, 0), False),
    "K": (1.0, (0, 0, 0, 0, 1), True),
}
_PREFIXES = {"p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12}
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$", re.S)
_FACTOR = re.compile(r"([a-zA-Zµμ]+|°)([²³])?(?:\^?(-?\d))?")


def _symbol(word: str, where: str) -> tuple[float, tuple[int, int, int, int, int]]:
    if word in _SYMBOLS:
        return _SYMBOLS[word][:2]
    rest = _SYMBOLS.get(word[1:])
    if word[:1] in _PREFIXES and rest is not None and rest[2]:
        return _PREFIXES[word[0]] * rest[0], rest[1]
    raise UsageError(f"{where}: unknown unit '{word}'")


def _unit(text: str, where: str) -> tuple[float, list[int]]:
    factor, exponents, sign, at, open_slash, bracket = 1.0, [0, 0, 0, 0, 0], 1, 0, False, False
    while at < len(text):
        if text[at] in " *" or (text[at] == "1" and at == 0):
            at += 1
        elif text[at] == "/":
            if open_slash or bracket:
                raise UsageError(f"{where}: two slashes without a unit between them")
            sign, at, open_slash = -1, at + 1, True
        elif text[at] == "(" and open_slash and not bracket:
            at, bracket = at + 1, True
        elif text[at] == ")" and bracket and not open_slash:
            sign, at, bracket = 1, at + 1, False
        else:
            match = _FACTOR.match(text, at)
            if match is None:
                raise UsageError(f"{where}: '{text[at]}' is not part of a unit")
            power = sign * int(match[3] or {"²": 2, "³": 3}.get(match[2] or "", 1))
            one, of_one = _symbol(match[1], where)
            factor *= one**power
            exponents = [e + power * o for e, o in zip(exponents, of_one)]
            at, open_slash = match.end(), False
    if open_slash or bracket:
        raise UsageError(f"{where}: nothing after the slash, or a bracket that is not closed")
    return factor, exponents


def si(quantity: str | float, unit: str = "") -> float:
    """Value in SI units of a number or of a text with a unit: si("2.5 mm") is 0.0025. A number without a unit is SI already.

    unit   when given, for instance "m": the quantity must have this dimension
    Raises UsageError for a text that is no quantity, an unknown unit or another dimension.
    """
    if not isinstance(quantity, str):
        return float(quantity)
    where = f'"{quantity}"'
    match = _NUMBER.match(quantity)
    if match is None:
        raise UsageError(f'{where}: no number at its beginning; expected a quantity such as "2.5 mm"')
    if match[2] in ("degC", "°C") and unit in ("", "K"):
        return float(match[1]) + 273.15
    factor, exponents = _unit(match[2], where)
    if match[2] and unit and exponents != _unit(unit, where)[1]:
        raise UsageError(f"{where}: not in units of {unit}")
    return float(match[1]) * factor
