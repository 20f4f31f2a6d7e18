"""A line along the stream as CSV: x and z with their units, one row per point."""

from pathlib import Path

from ryusa.formats.table import metres, name_and_unit, read_table

COLUMNS = ("x", "z")
_EXAMPLE = "'x [m],z [mm]'"


def read_line(path: Path, name: str) -> tuple[tuple[float, float], ...]:
    """Read the points of a line: x and z [m], in the order of the file.

    Parameters
    ----------
    path, name : the file, and what messages call it. Lines that are blank or begin with # are passed over;
        the first other line is the header, with the columns `x` and `z` and their units: x [m],z [mm].

    Raises
    ------
    ParseError : the file is not such a table; names line and column.
    """
    rows, heads = read_table(path, name, "point", "at least two points", _EXAMPLE, _column, COLUMNS)
    names = [one for one, _ in heads]
    places = names.index("x"), names.index("z")
    x, z = rows.columns(list(places), ["a place x", "a height z"])
    x, z = x * heads[places[0]][1], z * heads[places[1]][1]
    return tuple(zip(x.tolist(), z.tolist(), strict=True))


def _column(cell: str) -> tuple[str, float]:
    """Name of a column and its factor.

    Raises
    ------
    ValueError : an unknown column, or one without a unit of length.
    """
    column, unit = name_and_unit(cell, COLUMNS, _EXAMPLE)
    return column, metres(column, unit)
