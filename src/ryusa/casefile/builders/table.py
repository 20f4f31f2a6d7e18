"""A CSV table of first grains: one row per grain, units in the header."""

import csv
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ryusa.casefile.builders.schema import TableSection
from ryusa.errors import CaseError
from ryusa.formats.grains import GrainTable
from ryusa.units import UnitError, quantity

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

UNITS = {
    **dict.fromkeys(("x", "y", "z", "d"), "m"),
    **dict.fromkeys(("vx", "vy", "vz"), "m/s"),
    **dict.fromkeys(("wx", "wy", "wz"), "rad/s"),
}
NEEDED = ("x", "z", "d")
LARGEST_FILE = 1 << 30  # bytes
_YES, _NO = {"1", "true", "yes", "fixed"}, {"0", "false", "no", "free", ""}


def table_of(case: "Case") -> GrainTable | None:
    """Read the table that a case names; None for other builders."""
    if not isinstance(case.build, TableSection):
        return None
    folder = (case.path.parent if case.path is not None else Path()).resolve()
    path = (folder / case.build.file).resolve()
    if not path.is_relative_to(folder):
        raise CaseError("build.file", case.build.file, "points outside the folder of the case file")
    try:
        stamp = path.stat()
    except OSError:
        raise CaseError(
            "build.file", case.build.file, f"no such file in the folder of the case, {folder}"
        ) from None
    if stamp.st_size > LARGEST_FILE:
        raise CaseError("build.file", case.build.file, "is larger than 1 GiB, the limit for a table")
    return _read(path, case.build.file, stamp.st_mtime_ns, stamp.st_size)


@lru_cache(maxsize=4)
def _read(path: Path, name: str, _changed: int, _size: int) -> GrainTable:
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = [
                (number, row)
                for number, row in enumerate(csv.reader(file), 1)
                if any(cell.strip() for cell in row)
            ]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise CaseError("build.file", name, f"cannot be read: {error}") from None
    rows = [(number, row) for number, row in rows if not row[0].lstrip().startswith("#")]
    if len(rows) < 2:
        raise CaseError("build.file", name, "needs a header and at least one grain")
    heads = [_head(cell, name) for cell in rows[0][1]]
    names = [one for one, _ in heads]
    for needed in NEEDED:
        if needed not in names:
            raise CaseError("build.file", name, f"column '{needed} [cm]' is missing")
    if len(set(names)) < len(names):
        raise CaseError("build.file", name, "a column appears twice")
    columns: dict[str, list[float]] = {one: [] for one in names if one in UNITS}
    fixed: list[bool] = []
    group: list[str] = []
    for line, row in rows[1:]:
        if len(row) != len(heads):
            raise CaseError(
                "build.file", name, f"line {line} has {len(row)} cells, the header has {len(heads)}"
            )
        cells = dict(zip(names, row, strict=True))
        for (column, factor), cell in zip(heads, row, strict=True):
            if column in UNITS:
                columns[column].append(_number(cell, factor, f"line {line}, column {column}", name))
        if columns["d"][-1] <= 0.0:
            raise CaseError("build.file", name, f"line {line}: d must be greater than 0")
        word = cells.get("fixed", "").strip().lower()
        if word not in _YES | _NO:
            raise CaseError("build.file", name, f"line {line}: fixed must be 0 or 1, not {word!r}")
        fixed.append(word in _YES)
        group.append(cells.get("group", "").strip())
    if all(fixed):
        raise CaseError("build.file", name, "has no free grain")
    arrays = {one: np.array(values, dtype=np.float64) for one, values in columns.items()}
    return GrainTable(
        name=name,
        columns=arrays,
        fixed=np.array(fixed, dtype=np.bool_),
        group=tuple(group),
        labels=tuple(f"of line {line} of {name}" for line, _ in rows[1:]),
    )


def _head(cell: str, name: str) -> tuple[str, float]:
    column, _, rest = cell.partition("[")
    column, unit = column.strip(), rest.rstrip().removesuffix("]").strip()
    if column in {"fixed", "group"}:
        return column, 1.0
    if column not in UNITS:
        raise CaseError(
            "build.file",
            name,
            f"unknown column {column!r}; known are {', '.join([*UNITS, 'fixed', 'group'])}",
        )
    if not unit:
        raise CaseError(
            "build.file",
            name,
            f"column {column!r} needs its unit in the header, such as '{column} [{UNITS[column]}]'",
        )
    try:
        return column, quantity(f"1 {unit}", UNITS[column])
    except UnitError as error:
        raise CaseError("build.file", name, f"column {column!r}: {error}") from None


def _number(cell: str, factor: float, where: str, name: str) -> float:
    try:
        value = float(cell) * factor
    except ValueError:
        value = float("nan")
    if not np.isfinite(value):
        raise CaseError("build.file", name, f"{where}: {cell.strip()!r} is not a finite number")
    return value
