"""The table of grains that ryusa writes and reads: units in the header, one row per grain and frame."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ParseError
from ryusa.formats.dialect import Dialect
from ryusa.formats.grains import NO_CLUMP, PART_OF_A_CLUMP, UNITS, GrainTable, PlaneWall
from ryusa.formats.names import not_used
from ryusa.formats.table import cells_of, header_of
from ryusa.formats.text import LARGEST, Lines, Rows, checked, opened, shown
from ryusa.model.arrays import Floats
from ryusa.units import UnitError, quantity

MARK = "# ryusa "  # before the JSON object that states periods and planes
NUMBERS = ("x", "y", "z", "d", "vx", "vy", "vz", "wx", "wy", "wz", "m")
HEAD = ("t [s]", "step", "id", "fixed", "group", "ix", "iy", *(f"{one} [{UNITS[one]}]" for one in NUMBERS))
_ROW = "%r,%d,%d,%d,%s,%d,%d" + ",%r" * len(NUMBERS)
TURN = ("qw", "qx", "qy", "qz")  # orientation of a clump
CLUMP_HEAD = ("clump", *TURN)  # columns of a run with clumps, after the others
_CLUMP_ROW = ",%d" + ",%r" * len(TURN)


def csv_head(table: GrainTable) -> bytes:
    """First two lines: what holds for all rows, as JSON in a comment, and the names of the columns."""
    period = table.period or (math.inf, math.inf)
    about = {
        "period": [length if math.isfinite(length) else None for length in period],
        "planes": [[one.name, one.point, one.normal] for one in table.planes],
        "water_zero": table.z_zero,
        "bed_area": table.bed_area,
    }
    names = HEAD if table.clump is None else (*HEAD, *CLUMP_HEAD)
    return f"{MARK}{json.dumps(about)}\n{','.join(names)}\n".encode()


def csv_frame(table: GrainTable) -> bytes:
    """Rows of one frame."""
    quoted = {name: _quoted(name) for name in set(table.group)}
    n, row_form = table.n, _ROW
    more: list[list[Any]] = []
    if table.clump is not None and table.orientation is not None:
        row_form += _CLUMP_ROW
        more = [table.clump.tolist(), *table.orientation.T.tolist()]
    rows = zip(
        [table.t] * n,
        [table.step] * n,
        table.ids.tolist(),
        table.fixed.tolist(),
        [quoted[name] for name in table.group],
        *(table.image[:, axis].tolist() for axis in (0, 1)),
        *(table.column(name).tolist() for name in NUMBERS),
        *more,
        strict=True,
    )
    return "".join(row_form % row + "\n" for row in rows).encode()


def _quoted(name: str) -> str:
    name = " ".join(name.split())
    return '"' + name.replace('"', '""') + '"' if set(name) & set(',"#') else name


NEEDED = ("x", "z", "d")
# columns that are no numbers of a grain
_WORDS = ("fixed", "group", "t", "step", "id", "ix", "iy", *CLUMP_HEAD)
_YES, _NO = {"1", "true", "yes", "fixed"}, {"0", "false", "no", "free", ""}


def read_csv(path: Path, name: str, frame: int | None = None) -> GrainTable:
    """Read the grains of a table; of several frames the last, or the one of that number.

    Rows of one frame stand together and have the same `t`; a table without `t` is one frame.
    """
    with opened(path, name) as lines:
        about, heads, dialect = _head(lines)
        names = [one for one, _ in heads]
        when = names.index("t") if "t" in names else None
        rows: list[tuple[int, str]] = []
        now, n_frame = "", 0
        while lines.advance():
            if dialect.blank(lines.text):
                continue
            cells = cells_of(lines, dialect, len(heads))
            t = cells[when] if when is not None else ""
            if n_frame == 0 or t != now:
                if n_frame - 1 == frame:
                    break
                now, n_frame, rows = t, n_frame + 1, []
            rows.append((lines.number, lines.text))
        if not rows:
            raise lines.error("expected at least one grain below the header")
        if frame is not None and frame >= n_frame:
            raise lines.error(f"build.frame = {frame}: the file has frames 0 to {n_frame - 1}")
        notes = lines.notes
    turns = [] if "clump" in names else [one for one in names if one in TURN]  # of spheres
    more = not_used(name, turns) + not_used(name, about.pop("others", ()), "entries of the line '# ryusa'")
    made = Rows(name, rows, dialect.column, dialect.split, dialect.number)
    return replace(_table(made, heads, about), notes=(*notes, *more))


def _head(lines: Lines) -> tuple[dict[str, Any], list[tuple[str, float]], Dialect]:
    """What a comment states for all rows, name and factor of each column, and how cells are separated."""
    about: dict[str, Any] = {}
    while lines.advance():
        if lines.text.startswith(MARK):
            about = _about(lines)
        elif lines.text.strip() and not lines.text.lstrip().startswith("#"):
            break
    else:
        raise lines.error("expected a header and at least one grain")
    header, heads, dialect = header_of(lines, _column)
    names = [one for one, _ in heads]
    for needed in NEEDED:
        if needed not in names:
            raise header.error(0, len(names), f"column '{needed} [cm]' is missing")
    if len(set(names)) < len(names):
        raise header.error(
            0, next(k for k, one in enumerate(names) if one in names[:k]), "a column appears twice"
        )
    return about, heads, dialect


def _about(lines: Lines) -> dict[str, Any]:
    """Periods, planes and zero of the water, from the comment that `csv_head` writes."""
    try:
        given = json.loads(lines.text.removeprefix(MARK))
        period = tuple(math.inf if one is None else _finite(one) for one in given["period"])
        if len(period) != 2 or not all(one > 0.0 for one in period):
            raise ValueError("period")
        planes = [
            PlaneWall(str(name)[:64], _point(point), _point(normal))
            for name, point, normal in given["planes"]
        ]
        if not all(any(one.normal) for one in planes):
            raise ValueError("planes")
        zero, area = (
            None if given[key] is None else _finite(given[key]) for key in ("water_zero", "bed_area")
        )
        if area is not None and area <= 0.0:
            raise ValueError("bed_area")
        known = ("period", "planes", "water_zero", "bed_area")
        return {
            "others": [shown(one) for one in given if one not in known],
            "period": period,
            "planes": tuple(planes),
            "z_zero": zero,
            "bed_area": area,
        }
    except (ValueError, KeyError, TypeError, RecursionError, OverflowError):
        raise ParseError(
            lines.name,
            lines.number,
            len(MARK) + 1,
            "expected the JSON that ryusa export writes: period, planes, water_zero, bed_area",
        ) from None


def _finite(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
        raise ValueError("not a number")
    return float(value)


def _point(values: Any) -> tuple[float, float, float]:
    x, y, z = (_finite(one) for one in values)
    return x, y, z


def _column(cell: str) -> tuple[str, float]:
    """Name of a column and the factor to SI.

    Raises
    ------
    ValueError : an unknown column, or one without a unit that fits.
    """
    column, _, rest = cell.partition("[")
    column, unit = column.strip(), rest.rstrip().removesuffix("]").strip()
    if column in _WORDS:
        return column, 1.0
    if column not in UNITS:
        raise ValueError(f"unknown column {column[:40]!r}; known are {', '.join([*UNITS, *_WORDS])}")
    if not unit:
        raise ValueError(
            f"column {column!r} needs its unit in the header, such as '{column} [{UNITS[column]}]'"
        )
    try:
        return column, quantity(f"1 {unit}", UNITS[column])
    except UnitError as error:
        raise ValueError(f"column {column!r}: {error}") from None


def _table(rows: Rows, heads: list[tuple[str, float]], about: dict[str, Any]) -> GrainTable:
    words = {name: k for k, (name, _) in enumerate(heads)}
    numbers = [name for name in words if name in UNITS]
    values = rows.columns([words[name] for name in numbers], [f"column '{name}'" for name in numbers])
    columns: dict[str, Floats] = {
        name: one * heads[words[name]][1] for name, one in zip(numbers, values, strict=True)
    }
    fixed: list[bool] = []
    group: list[str] = []
    for row, (_, text) in enumerate(rows.where):
        cells = rows.split(text)
        word = cells[words["fixed"]].strip().lower() if "fixed" in words else ""
        if word not in _YES | _NO:
            raise rows.error(row, words["fixed"], f"fixed must be 0 or 1, not {word[:40]!r}")
        fixed.append(word in _YES)
        group.append(cells[words["group"]].strip() if "group" in words else "")
    clumps = _integers(rows, words, "clump") if "clump" in words else np.zeros(0, np.int64)
    if (clumps != NO_CLUMP).any():
        row = int((clumps != NO_CLUMP).argmax())
        raise rows.error(row, words["clump"], PART_OF_A_CLUMP)
    table = GrainTable(
        name=rows.name,
        columns=columns,
        fixed=np.array(fixed, dtype=np.bool_),
        group=tuple(group),
        labels=tuple(f"of line {line} of {rows.name}" for line, _ in rows.where),
        ids=rows.integers(words["id"], "an id") if "id" in words else np.arange(len(fixed)),
        image=np.stack([_integers(rows, words, name) for name in ("ix", "iy")], axis=1),
        t=float(rows.columns([words["t"]], ["a time"])[0][0]) if "t" in words else 0.0,
        step=int(_integers(rows, words, "step")[0]),
        **about,
    )
    return checked(table, rows, words)


def _integers(rows: Rows, words: dict[str, int], name: str) -> NDArray[np.int64]:
    """A column of whole numbers; zeros where the table has none."""
    return rows.integers(words[name], name) if name in words else np.zeros(len(rows.where), np.int64)
