"""Lines of an explained case."""

from dataclasses import dataclass
from typing import Literal

from ryusa.units import format_quantity


@dataclass(frozen=True)
class Row:
    """One line of the explanation."""

    section: str
    name: str
    value: float | int | str  # SI, or a word
    unit: str  # of the value; "" for words and counts
    shown: str  # value and unit as a person writes them
    how: str  # where it comes from
    flag: Literal["", "note", "warning"] = ""


def row_of(
    section: str, name: str, value: float, unit: str, how: str, flag: Literal["", "note", "warning"] = ""
) -> Row:
    """Line whose value is shown in the unit asked for."""
    si = _SHOWN.get(unit, (unit, unit))
    return Row(section, name, value, si[0], format_quantity(value, si[1]), how, flag)


_SHOWN = {  # unit asked for: (SI unit of the value, unit shown)
    "cm": ("m", "cm"),
    "N/cm": ("N/m", "N/cm"),
    "N s/cm": ("N s/m", "N s/cm"),
    "deg": ("rad", "deg"),
    "": ("", ""),
    "-": ("", ""),
}
