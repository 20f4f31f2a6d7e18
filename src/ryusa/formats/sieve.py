"""A sieve curve as CSV: diameter with its unit and percent finer by mass, one row per sieve."""

from pathlib import Path

from ryusa.errors import ParseError
from ryusa.formats.csv import cell_column, split_cells
from ryusa.formats.text import D_HIGH, D_LOW, Lines, Rows, opened
from ryusa.model.grading import Grading, GradingFault
from ryusa.units import UnitError, quantity

LARGEST_FILE = 1 << 20  # bytes
COLUMNS = {"diameter": "diameter", "d": "diameter", "finer": "finer", "passing": "finer"}
_EXAMPLE = "'diameter [mm],finer [%]'"


def read_sieve_curve(path: Path, name: str) -> tuple[tuple[float, float], ...]:
    """Read the points of a sieve curve: diameter [m] and percent finer by mass, in the order of the file.

    Parameters
    ----------
    path, name : the file, and what messages call it. Lines that are blank or begin with # are passed over;
        the first other line is the header, with the columns `diameter` (or `d`) and `finer` (or `passing`)
        and their units, such as diameter [mm],finer [%].

    Raises
    ------
    ParseError : the file is not a grading curve; names line and column.
    """
    if path.stat().st_size > LARGEST_FILE:
        raise ParseError(name, 1, 1, "is larger than 1 MiB, the limit for a sieve curve")
    with opened(path, name) as lines:
        heads = _head(lines)
        where: list[tuple[int, str]] = []
        while lines.advance():
            if not lines.text.strip(" ,\t") or lines.text.lstrip().startswith("#"):
                continue
            cells = split_cells(lines.text)
            if len(cells) != len(heads):
                raise lines.error(f"line {lines.number} has {len(cells)} cells, the header has {len(heads)}")
            where.append((lines.number, lines.text))
        if not where:
            raise lines.error("expected at least two sieves below the header")
    rows = Rows(name, where, cell_column, split_cells)
    names = [one for one, _ in heads]
    k_d, k_finer = names.index("diameter"), names.index("finer")
    d, finer = rows.columns([k_d, k_finer], ["a diameter", "percent finer"])
    d = d * heads[k_d][1]
    for row, one in enumerate(d.tolist()):
        if not D_LOW <= one <= D_HIGH:
            raise rows.error(row, k_d, f"expected a diameter from {D_LOW:g} to {D_HIGH:g} m, found {one:g} m")
    points = tuple(zip(d.tolist(), finer.tolist(), strict=True))
    try:
        Grading.of([(one, percent / 100.0) for one, percent in points])
    except GradingFault as fault:
        raise rows.error(min(fault.point, len(where) - 1), 0, str(fault)) from None
    return points


def _head(lines: Lines) -> list[tuple[str, float]]:
    """Name of each column and its factor to SI, or to percent."""
    while lines.advance():
        if lines.text.strip() and not lines.text.lstrip().startswith("#"):
            break
    else:
        raise lines.error(f"expected a header such as {_EXAMPLE}, and below it a row per sieve")
    header = Rows(lines.name, [(lines.number, lines.text)], cell_column, split_cells)
    heads: list[tuple[str, float]] = []
    for k, cell in enumerate(split_cells(lines.text)):
        try:
            heads.append(_column(cell))
        except ValueError as error:
            raise header.error(0, k, str(error)) from None
    names = [one for one, _ in heads]
    for needed in ("diameter", "finer"):
        if needed not in names:
            raise header.error(
                0, len(names), f"column '{needed}' is missing; a header reads, for example, {_EXAMPLE}"
            )
        if names.count(needed) > 1:
            raise header.error(0, len(names) - 1 - names[::-1].index(needed), "a column appears twice")
    return heads


def _column(cell: str) -> tuple[str, float]:
    """Name of a column and its factor.

    Raises
    ------
    ValueError : an unknown column, or one without a unit that fits.
    """
    if ";" in cell or "\t" in cell:
        raise ValueError(f"columns are separated by commas, as in {_EXAMPLE}")
    column, _, rest = cell.partition("[")
    column, unit = column.strip().lower(), rest.rstrip().removesuffix("]").strip()
    if column not in COLUMNS:
        raise ValueError(f"unknown column {column[:40]!r}; known are {', '.join(COLUMNS)}")
    name = COLUMNS[column]
    if not unit:
        raise ValueError(f"column {column!r} needs its unit in the header, such as {_EXAMPLE}")
    if name == "finer":
        if unit != "%":
            raise ValueError(f"column {column!r} is in percent, '{column} [%]', not in {unit[:20]!r}")
        return name, 1.0
    try:
        return name, quantity(f"1 {unit}", "m")
    except UnitError as error:
        raise ValueError(f"column {column!r}: {error}") from None
