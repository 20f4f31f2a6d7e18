"""Small CSV tables whose header names the columns with their units."""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ParseError
from ryusa.formats.dialect import Dialect, dialect_of
from ryusa.formats.text import Lines, Rows, opened, shown
from ryusa.units import UnitError, quantity

LARGEST_FILE = 1 << 20  # bytes


def read_table(
    path: Path,
    name: str,
    row: str,
    least: str,
    example: str,
    column: Callable[[str], tuple[str, float]],
    needed: Sequence[str],
) -> tuple[Rows, list[tuple[str, float]]]:
    """Rows of a table, and the name of each column with its factor to SI.

    Lines that are blank or begin with # are passed over; the first other line is the header.

    Parameters
    ----------
    path, name : the file, and what messages call it.
    row : what a row is, in one word.
    least : how many there must be, for messages; the caller counts those of a table that has any.
    example : a header, for messages.
    column : name and factor of a cell of the header; raises ValueError with what is wrong.
    needed : columns that must be there.

    Raises
    ------
    ParseError : the file is not such a table; names line and column.
    """
    if path.stat().st_size > LARGEST_FILE:
        raise ParseError(name, 1, 1, f"is larger than 1 MiB, the limit for a table of a row per {row}")
    with opened(path, name) as lines:
        heads, dialect = _head(lines, row, example, column, needed)
        where: list[tuple[int, str]] = []
        while lines.advance():
            if dialect.blank(lines.text):
                continue
            cells_of(lines, dialect, len(heads))
            where.append((lines.number, lines.text))
        if not where:
            raise lines.error(f"expected {least} below the header")
    return Rows(name, where, dialect.column, dialect.split, dialect.number), heads


def header_of(
    lines: Lines, column: Callable[[str], tuple[str, float]]
) -> tuple[Rows, list[tuple[str, float]], Dialect]:
    """The header read last as a row, each column as `column` says it, and how cells are separated."""
    dialect = dialect_of(lines.text)
    header = Rows(lines.name, [(lines.number, lines.text)], dialect.column)
    heads: list[tuple[str, float]] = []
    for k, cell in enumerate(dialect.heads(lines.text)):
        try:
            heads.append(column(cell))
        except ValueError as error:
            raise header.error(0, k, str(error)) from None
    return header, heads, dialect


def cells_of(lines: Lines, dialect: Dialect, n: int) -> list[str]:
    """Cells of the line read last; raises `ParseError` if they are not as many as the header has."""
    cells = dialect.cells(lines.text, n)
    if len(cells) != n:
        raise lines.error(f"line {lines.number} has {len(cells)} cells, the header has {n}")
    return cells


def read_lengths(
    path: Path, name: str, row: str, least: str, example: str, called: Mapping[str, str]
) -> tuple[Rows, list[int], list[NDArray[np.float64]]]:
    """Rows of a table of lengths, the place of each column, and its values [m].

    Parameters
    ----------
    path, name, row, least, example : as of `read_table`.
    called : columns that must be there, and what messages call a value of each.

    Raises
    ------
    ParseError : the file is not such a table; names line and column.
    """

    def column(cell: str) -> tuple[str, float]:
        one, unit = name_and_unit(cell, called, example)
        return one, metres(one, unit)

    rows, heads = read_table(path, name, row, least, example, column, tuple(called))
    names = [one for one, _ in heads]
    places = [names.index(one) for one in called]
    values = rows.columns(places, list(called.values()))
    return rows, places, [one * heads[k][1] for one, k in zip(values, places, strict=True)]


def name_and_unit(cell: str, known: Collection[str], example: str) -> tuple[str, str]:
    """Name and unit of a cell of the header, such as x [mm].

    Raises
    ------
    ValueError : an unknown column, or one without a unit.
    """
    column, _, rest = cell.partition("[")
    column, unit = column.strip().lower(), rest.rstrip().removesuffix("]").strip()
    if column not in known:
        raise ValueError(f"unknown column {shown(column)}; known are {', '.join(known)}")
    if not unit:
        raise ValueError(f"column {column!r} needs its unit in the header, such as {example}")
    return column, unit


def metres(column: str, unit: str) -> float:
    """Factor of a column to metres.

    Raises
    ------
    ValueError : it is no unit of length.
    """
    try:
        return quantity(f"1 {unit}", "m")
    except UnitError as error:
        raise ValueError(f"column {column!r}: {error}") from None


def _head(
    lines: Lines,
    row: str,
    example: str,
    column: Callable[[str], tuple[str, float]],
    needed: Sequence[str],
) -> tuple[list[tuple[str, float]], Dialect]:
    """Name of each column and its factor, and how cells are separated."""
    while lines.advance():
        if lines.text.strip() and not lines.text.lstrip().startswith("#"):
            break
    else:
        raise lines.error(f"expected a header such as {example}, and below it a row per {row}")
    header, heads, dialect = header_of(lines, column)
    names = [one for one, _ in heads]
    for one in needed:
        if one not in names:
            raise header.error(
                0, len(names), f"column '{one}' is missing; a header reads, for example, {example}"
            )
        if names.count(one) > 1:
            raise header.error(0, len(names) - 1 - names[::-1].index(one), "a column appears twice")
    return heads, dialect
