"""A sieve curve as CSV: diameter with its unit and percent finer by mass, one row per sieve."""

from dataclasses import replace
from pathlib import Path

from ryusa.formats.table import metres, name_and_unit, read_table
from ryusa.formats.text import D_HIGH, D_LOW
from ryusa.model.grading import Grading, GradingFault

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
    rows, heads = read_table(
        path, name, "sieve", "at least two sieves", _EXAMPLE, _column, ("diameter", "finer")
    )
    names = [one for one, _ in heads]
    k_d, k_finer = names.index("diameter"), names.index("finer")
    (d,) = rows.columns([k_d], ["a diameter"])
    signed = replace(rows, number=lambda cell: rows.number(cell.strip().removesuffix("%")))
    (finer,) = signed.columns([k_finer], ["percent finer"])
    d = d * heads[k_d][1]
    for row, one in enumerate(d.tolist()):
        if not D_LOW <= one <= D_HIGH:
            raise rows.error(row, k_d, f"expected a diameter from {D_LOW:g} to {D_HIGH:g} m, found {one:g} m")
    points = tuple(zip(d.tolist(), finer.tolist(), strict=True))
    try:
        Grading.of([(one, percent / 100.0) for one, percent in points])
    except GradingFault as fault:
        raise rows.error(min(fault.point, len(rows.where) - 1), 0, str(fault)) from None
    return points


def _column(cell: str) -> tuple[str, float]:
    """Name of a column and its factor.

    Raises
    ------
    ValueError : an unknown column, or one without a unit that fits.
    """
    column, unit = name_and_unit(cell, COLUMNS, _EXAMPLE)
    name = COLUMNS[column]
    if name == "finer":
        if unit != "%":
            raise ValueError(f"column {column!r} is in percent, '{column} [%]', not in {unit[:20]!r}")
        return name, 1.0
    return name, metres(column, unit)
