"""A quantity over time as CSV: time and quantity with their units, one row per point."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ryusa.errors import ParseError
from ryusa.formats.table import name_and_unit, read_table
from ryusa.units import UnitError, quantity

TIME = "t"


def read_series(
    path: Path, name: str, column: str, read: Callable[[str], Any], example: str
) -> tuple[tuple[float, Any], ...]:
    """Read the points of a quantity over time: time [s], and what `read` makes of number and unit.

    Parameters
    ----------
    path, name : the file, and what messages call it. Lines that are blank or begin with # are passed over;
        the first other line is the header, with the columns `t` and `column` and their units.
    column : name of the quantity in the header.
    read : reads one of it with its unit, such as "1 L/s"; a number in SI, or a pair of it and its kind.
    example : a header, for messages.

    Raises
    ------
    ParseError : the file is not such a table; names line and column.
    """
    known, kinds = (TIME, column), dict[str, Any]()

    def head(cell: str) -> tuple[str, float]:
        found, unit = name_and_unit(cell, known, example)
        try:
            one = quantity(f"1 {unit}", "s") if found == TIME else read(f"1 {unit}")
        except (UnitError, ValueError) as error:
            raise ValueError(f"column {found!r}: {error}") from None
        factor, kinds[found] = (one[0], one[1]) if isinstance(one, tuple) else (one, None)
        return found, factor

    rows, heads = read_table(path, name, "point", "at least two points", example, head, known)
    names = [one for one, _ in heads]
    places = [names.index(one) for one in known]
    t, y = rows.columns(places, ["a time t", f"a number of {column}"])
    if len(t) < 2:
        raise ParseError(name, 1, 1, "has one point; expected at least two")
    t, y = t * heads[places[0]][1], y * heads[places[1]][1]
    kind = kinds[column]
    values = y.tolist() if kind is None else [(one, kind) for one in y.tolist()]
    return tuple(zip(t.tolist(), values, strict=True))
