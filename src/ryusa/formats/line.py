"""A line along the stream as CSV: x and z with their units, one row per point."""

from pathlib import Path

from ryusa.formats.table import read_lengths

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
    called = {"x": "a place x", "z": "a height z"}
    _, _, (x, z) = read_lengths(path, name, "point", "at least two points", _EXAMPLE, called)
    return tuple(zip(x.tolist(), z.tolist(), strict=True))
