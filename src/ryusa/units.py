"""Quantities with units: `"100 N/cm"` to 1.0e4 in SI, and back. All other modules use SI units only."""

import math
import re
import unicodedata
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from functools import cache
from typing import Any

LONGEST = 64  # largest number of characters of a quantity
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3}(?![0-9]))?")
_PLAIN_SIGNS = {0x3000: " ", 0x2212: "-"} | {0xFEE0 + code: chr(code) for code in range(0x21, 0x7F)}
_FRACTION = re.compile(r"([+-]?)(?:([0-9]+)[ -])?([0-9]+)/([1-9][0-9]*)(?=\s*[A-Za-z\"])")  # of an inch
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]+,[0-9]+(?![0-9,])")
_FACTOR = re.compile(r"([A-Za-zμΩÅ°%‰]+)(?:\s*(?:\^|\*\*)?\s*([+-]?[0-9]{1,2})(?![0-9]))?")
_NAMES = {  # quantity that an SI unit measures, for messages
    "m": "a length",
    "s": "a time",
    "kg": "a mass",
    "kg/m3": "a density",
    "m/s": "a speed",
    "m/s2": "an acceleration",
    "m2/s": "a viscosity or discharge per width",
    "N": "a force",
    "N/m": "a stiffness",
    "N s/m": "a damping constant",
    "Pa/m": "a pressure gradient",
    "rad": "an angle",
    "rad/s": "a spin",
    "Hz": "a frequency",
    "J/m2": "an energy per area",
}
_SI_UNITS = (*_NAMES, "kg/s", "Pa", "J", "m2")
_METRE, _SECOND, _GRAM, _RADIAN = (("meter", 1),), (("second", 1),), (("gram", 1),), (("radian", 1),)
_NEWTON, _PASCAL = (("gram", 1), ("meter", 1), ("second", -2)), (("gram", 1), ("meter", -1), ("second", -2))
_JOULE, _BIT = (("gram", 1), ("meter", 2), ("second", -2)), (("bit", 1),)
COMMON = {  # common units, because Pint takes long to read its definitions; a test compares the two
    "%": (0.01, ()),
    "m": (1.0, _METRE),
    "km": (1e3, _METRE),
    "cm": (1e-2, _METRE),
    "mm": (1e-3, _METRE),
    "um": (1e-6, _METRE),
    "s": (1.0, _SECOND),
    "ms": (1e-3, _SECOND),
    "us": (1e-6, _SECOND),
    "min": (60.0, _SECOND),
    "h": (3600.0, _SECOND),
    "kg": (1.0, _GRAM),
    "g": (1e-3, _GRAM),
    "N": (1.0, _NEWTON),
    "kN": (1e3, _NEWTON),
    "Pa": (1.0, _PASCAL),
    "kPa": (1e3, _PASCAL),
    "MPa": (1e6, _PASCAL),
    "GPa": (1e9, _PASCAL),
    "J": (1.0, _JOULE),
    "rad": (1.0, _RADIAN),
    "deg": (math.pi / 180.0, _RADIAN),
    "Hz": (1.0, (("second", -1),)),
    "rpm": (2.0 * math.pi / 60.0, (("radian", 1), ("second", -1))),
    "byte": (8.0, _BIT),
    "B": (8.0, _BIT),
    "kB": (8e3, _BIT),
    "MB": (8e6, _BIT),
    "GB": (8e9, _BIT),
}
TRADE = {  # units of the trade in countries that measure in feet, which Pint does not know or calls otherwise
    "cfs": (0.3048**3, (("meter", 3), ("second", -1))),
    "gpm": (3.785411784e-3 / 60.0, (("meter", 3), ("second", -1))),  # of the United States
    "pcf": (0.45359237 / 0.3048**3, (("gram", 1), ("meter", -3))),
    "psf": (0.45359237 * 9.80665 / 0.3048**2, _PASCAL),
    "permille": (1e-3, ()),
    "‰": (1e-3, ()),
}


class UnitError(ValueError):
    """A text that is not a quantity of the expected dimension; the message says what is allowed."""


def quantity(text: object, unit: str) -> float:
    """Convert a number with its unit to SI.

    Parameters
    ----------
    text : the text, such as `"0.2 cm"`.
    unit : SI unit of the result, such as `"m"`; the dimension is checked, and angle counts as a dimension.

    Returns
    -------
    value : the number in `unit`; finite.

    Raises
    ------
    UnitError : no number, no unit, an unknown unit, another dimension, or a number that is not finite.

    >>> quantity("100 N/cm", "N/m")
    10000.0
    >>> quantity("0.2cm", "m"), quantity("1 1/2 in", "m"), round(quantity("10 cfs", "m3/s"), 6)
    (0.002, 0.0381, 0.283168)
    """
    example = _example(unit)
    if isinstance(text, bool) or not isinstance(text, str):
        if isinstance(text, (int, float)) and not isinstance(text, bool):
            raise UnitError(
                f"missing unit: needs {_kind(unit)}, written as text with its unit, such as {example}"
            )
        raise UnitError(f"needs {_kind(unit)}, written as text with its unit, such as {example}")
    if len(text) > LONGEST:
        raise UnitError(f"longer than {LONGEST} characters; needs {_kind(unit)} such as {example}")
    number, written = _parts(text)
    if number and (comma := _DECIMAL_COMMA.match(plain_signs(text).strip())):
        rest = plain_signs(text).strip()[comma.end() :]
        raise UnitError(f"decimals stand behind a point: write '{comma.group().replace(',', '.')}{rest}'")
    if not number:
        raise UnitError(f"needs {_kind(unit)}: a finite number and its unit, such as {example}")
    if not written:
        raise UnitError(f"missing unit: needs {_kind(unit)}, such as {example}")
    value = float(Decimal(number) * Decimal(repr(_factor(written, unit))))
    if not math.isfinite(value):
        raise UnitError(f"too large a number; needs {_kind(unit)}, such as {example}")
    if value == 0.0 and Decimal(number) != 0:
        raise UnitError(f"too small a number; needs {_kind(unit)}, such as {example}")
    return value + 0.0  # no -0.0


def span(text: str, unit: str) -> tuple[float, float]:
    """Two quantities, as `quantity` reads each.

    >>> span("0.5 m to 2 m", "m")
    (0.5, 2.0)
    """
    begin, between, end = text.partition(" to ")
    if not between:
        raise UnitError(f'must be two of {_kind(unit)} with their units, such as "0.5 {unit} to 2 {unit}"')
    return quantity(begin, unit), quantity(end, unit)


def _parts(text: str) -> tuple[str, str]:
    """Number and unit of a quantity as written; "" for what is missing."""
    body = plain_signs(text[:LONGEST]).strip()
    if fraction := _FRACTION.match(body):
        sign, whole, top, below = fraction.groups()
        body = f"{sign}{int(whole or 0) + int(top) / int(below):.17g} {body[fraction.end() :]}"
    found = _NUMBER.match(body)
    return (found.group(), body[found.end() :].strip()) if found else ("", "")


def plain_signs(text: str) -> str:
    r"""Text with plain signs in place of full-width ones, as Japanese input writes digits, and a plain minus.

    >>> plain_signs("\uff12\uff0e\uff15 mm"), plain_signs("10²")
    ('2.5 mm', '10²')
    """
    return text if text.isascii() else text.translate(_PLAIN_SIGNS)


def format_quantity(value: float, unit: str, digits: int = 4) -> str:
    """Format an SI value in a given unit.

    >>> format_quantity(1.0e4, "N/cm")
    '100 N/cm'
    >>> format_quantity(0.7, "-")
    '0.7'
    """
    if unit in {"", "-"}:
        return f"{value:.{digits}g}"
    return f"{value / _to_si(unit)[0]:.{digits}g} {unit}"


def limit_as_typed(text: object, limit: float, *, least: bool, unit: str = "") -> str:
    """A limit in SI as who typed a quantity would write it; without a unit where the text has none.

    Parameters
    ----------
    text : what was typed.
    limit : in the SI unit of the text, or in `unit`.
    least : whether the limit is a lower one; it is rounded to its permitted side.

    >>> limit_as_typed("95 deg", math.pi / 2, least=False), limit_as_typed("-0.2 cm", 1e-7, least=True)
    ('90 deg', '1e-05 cm')
    >>> limit_as_typed("89 deg", 1.5, least=False), limit_as_typed("-5 cm", 0.0, least=True)
    ('85.94 deg', '0 cm')
    """
    written = _parts(text)[1] if isinstance(text, str) else ""
    try:
        factor = _to_si(written)[0] / (_to_si(unit)[0] if unit else 1.0) if written else 1.0
    except UnitError:
        written, factor = "", 1.0
    side = Context(prec=4, rounding=ROUND_CEILING if least else ROUND_FLOOR)
    return f"{float(side.create_decimal(f'{limit / factor:.12g}')):g} {written}".strip()


def si_unit(text: str) -> str:
    """SI unit of a quantity as written; "" for a number without one, and for what is no quantity.

    >>> si_unit("0.2 cm"), si_unit("100 N/cm"), si_unit("5 %"), si_unit("free")
    ('m', 'N/m', '', '')
    """
    written = _parts(text)[1]
    try:
        dimension = _to_si(written)[1] if written else ()
    except UnitError:
        return ""
    return next((unit for unit in _SI_UNITS if dimension and _to_si(unit)[1] == dimension), "")


def _kind(unit: str) -> str:
    return f"{_NAMES[unit]} [{unit}]" if unit in _NAMES else f"a quantity in {unit}"


def _example(unit: str) -> str:
    examples = {
        "m": "0.2 cm",
        "N/m": "100 N/cm",
        "rad": "30 deg",
        "s": "1 ms",
        "m/s": "0.6 m/s",
        "N s/m": "0.001 N s/cm",
        "byte": "5 MB",
    }
    return f"'{examples.get(unit, f'1 {unit}')}'"


@cache
def _factor(written: str, unit: str) -> float:
    """Factor from the unit `written` to `unit`; both must have the same dimension."""
    try:
        factor, dimension = _to_si(written)
    except UnitError as error:
        raise UnitError(f"{error}; needs {_kind(unit)}, such as {_example(unit)}") from None
    wanted, target = _to_si(unit)
    if dimension != target:
        raise UnitError(
            f"wrong unit: '{written}' does not measure {_kind(unit)}; write it as {_example(unit)}"
        )
    return _rounded(factor / wanted)


def _rounded(factor: float) -> float:
    """Remove the round-off that chained conversions leave in a round number."""
    rounded = float(f"{factor:.14g}")
    return rounded if abs(rounded - factor) <= 4e-16 * abs(factor) else factor


@cache
def _to_si(written: str) -> tuple[float, tuple[tuple[str, int], ...]]:
    """Factor to SI and dimension of a unit such as `N s/cm`, `kg/m3`, `m s^-2`."""
    text = unicodedata.normalize("NFKC", written).translate(
        {ord("⋅"): "*", ord("·"): "*", ord("−"): "-", 0xB5: "μ"}
    )
    text = text.replace("/", " / ")
    position, factor, sign, pending = 0, 1.0, 1, False
    dimension: dict[str, int] = {}
    while position < len(text):
        rest = text[position:]
        found = _FACTOR.match(rest)
        if found is not None:
            one, bases = _atom(found.group(1))
            power = sign * int(found.group(2) or 1)
            if abs(power) > 9:
                raise UnitError(f"cannot read the unit '{written}'")
            try:
                factor *= one**power
            except OverflowError:
                raise UnitError(f"too large a unit: '{written}'") from None
            for base, exponent in bases:
                dimension[base] = dimension.get(base, 0) + exponent * power
            position, sign, pending = position + found.end(), 1, False
        elif rest[0] == "/" and sign == 1 and position > 0 and not pending:
            position, sign, pending = position + 1, -1, True
        elif rest[0] == "*" and position > 0 and not pending:
            position, pending = position + 1, True
        elif rest[0].isspace():
            position += 1
        else:
            raise UnitError(f"cannot read the unit '{written}'")
    if pending or not text.strip():
        raise UnitError(f"cannot read the unit '{written}'")
    return factor, tuple(sorted((base, power) for base, power in dimension.items() if power))


@cache
def _atom(name: str) -> tuple[float, tuple[tuple[str, int], ...]]:
    """Factor to SI and root dimension of one unit name; angles keep `radian`."""
    return COMMON.get(name) or TRADE.get(name) or from_pint(name)


def from_pint(name: str) -> tuple[float, tuple[tuple[str, int], ...]]:
    """As `_atom`, but from Pint, which first reads some thousand definitions."""
    registry, plain = _registry(), {"°": "degree"}.get(name, name)
    if plain in {"degC", "degF", "celsius", "fahrenheit", "°C", "°F"}:
        raise UnitError(f"'{name}' has an offset and cannot be used here")
    try:
        factor, root = registry.get_root_units(registry.parse_units(plain))
        pairs = [(str(base), float(power)) for base, power in root._units.items()]
        factor = float(factor)
    except Exception:
        raise UnitError(f"unknown unit '{name}'") from None
    if any(power != int(power) for _, power in pairs) or not math.isfinite(factor) or factor <= 0.0:
        raise UnitError(f"unknown unit '{name}'")
    grams = sum(int(power) for base, power in pairs if base == "gram")
    return _rounded(factor * 1000.0**-grams), tuple((base, int(power)) for base, power in pairs)


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()
