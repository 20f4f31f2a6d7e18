"""Rows of an explained case: the table that `ryusa check` prints."""

from dataclasses import dataclass
from typing import Literal

from ryusa.units import format_quantity

Flag = Literal["", "note", "warning"]


@dataclass(frozen=True)
class ExplainRow:
    """One number or word of an explained case."""

    section: str
    name: str
    value: float | int | str  # SI, or a word
    unit: str  # of the value; "" for words and counts
    shown: str  # value and unit as printed
    origin: str  # the key or formula it comes from, and what to note about it
    flag: Flag = ""


def number(section: str, name: str, value: float, unit: str, origin: str, flag: Flag = "") -> ExplainRow:
    """Row of a number in SI, printed in `unit`."""
    si = _SI.get(unit, (unit, unit))
    return ExplainRow(section, name, value, si[0], format_quantity(value, si[1]), origin, flag)


def word(section: str, name: str, value: str, origin: str, flag: Flag = "") -> ExplainRow:
    """Row of a word."""
    return ExplainRow(section, name, value, "", value, origin, flag)


def count(section: str, name: str, value: int, origin: str, flag: Flag = "") -> ExplainRow:
    """Row of a whole number."""
    return ExplainRow(section, name, value, "", f"{value:,}", origin, flag)


_SI = {  # unit printed: (SI unit of the value, unit for the formatter)
    "cm": ("m", "cm"),
    "cm3": ("m3", "cm3"),
    "N/cm": ("N/m", "N/cm"),
    "N s/cm": ("N s/m", "N s/cm"),
    "deg": ("rad", "deg"),
    "": ("", ""),
    "-": ("", ""),
}
