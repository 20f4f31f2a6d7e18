"""XYZ and extended XYZ, as OVITO and ASE open it: written in SI and read in any unit."""

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.errors import ParseError
from ryusa.formats.grains import GrainTable
from ryusa.formats.names import meaning_of, not_used, open_in_z
from ryusa.formats.text import Lines, ReadOptions, Rows, checked, frame_asked_for, opened, shown
from ryusa.model.arrays import Floats

PROPERTIES = "species:S:1:pos:R:3:id:I:1:fixed:I:1:image:I:3:velo:R:3:omega:R:3:radius:R:1:mass:R:1"
OF_CLUMPS = ":clump:I:1:orientation:R:4"  # x, y, z, w, the order of OVITO
SPECIES = "X"  # neither program knows gravel; X is what ASE calls an unknown element
_ROW = SPECIES + " %r %r %r %d %d %d %d 0 %r %r %r %r %r %r %r %r"
_CLUMP_ROW = " %d %r %r %r %r"


def xyz_frame(table: GrainTable) -> bytes:
    """One frame; the box encloses the grains where there is no period."""
    period = (*(table.period or (math.inf, math.inf)), math.inf)
    radius = table.column("d") / 2.0
    shut = [math.isfinite(length) for length in period]
    low = [
        0.0 if periodic or not table.n else float((table.column(axis) - radius).min())
        for axis, periodic in zip("xyz", shut, strict=True)
    ]
    sides = [
        length if periodic else float((table.column(axis) + radius).max(initial=begin)) - begin
        for axis, periodic, length, begin in zip("xyz", shut, period, low, strict=True)
    ]
    a, b, c = sides
    more: list[list[Any]] = []
    if table.clump is not None and table.orientation is not None:
        more = [table.clump.tolist(), *np.roll(table.orientation, -1, axis=1).T.tolist()]
    row_form = _ROW + _CLUMP_ROW * bool(more)
    about = [
        f'Lattice="{a!r} 0.0 0.0 0.0 {b!r} 0.0 0.0 0.0 {c!r}"',
        f'Origin="{" ".join(map(repr, low))}"',
        f"Properties={PROPERTIES}{OF_CLUMPS if more else ''}",
        f'pbc="{" ".join("T" if periodic else "F" for periodic in shut)}"',
        f"Time={table.t!r}",
        f"Step={table.step}",
        'units="SI: m s kg rad"',
    ]
    rows = zip(
        *(table.column(name).tolist() for name in ("x", "y", "z")),
        table.ids.tolist(),
        table.fixed.tolist(),
        *(table.image[:, axis].tolist() for axis in (0, 1)),
        *(table.column(name).tolist() for name in ("vx", "vy", "vz", "wx", "wy", "wz")),
        radius.tolist(),
        table.column("m").tolist(),
        *more,
        strict=True,
    )
    return "\n".join([str(table.n), " ".join(about), *(row_form % row for row in rows), ""]).encode("ascii")


_KEY = re.compile(r"""([A-Za-z_][A-Za-z0-9_-]*)\s*=\s*(?:"([^"]*)"|'([^']*)'|(\S+))""")
_PLAIN = "species:S:1:pos:R:3"  # a file without Properties
_READ = {  # property: columns of a table
    "pos": ("x", "y", "z"),
    **dict.fromkeys(("velo", "vel", "velocity", "velocities"), ("vx", "vy", "vz")),
    **dict.fromkeys(("omega", "angular_velocity"), ("wx", "wy", "wz")),
}
_WITHOUT_USE = {"species", "id", "fixed", "image"}  # of which nothing need be said
# keys of the line that describes a frame; of those that are not read nothing need be said
_KEYS = {"lattice", "properties", "pbc", "origin", "time", "step", "units"}
_PERIODIC = {"t": True, "true": True, "1": True, "f": False, "false": False, "0": False}


def read_xyz(path: Path, name: str, options: ReadOptions) -> GrainTable:
    """Read one frame."""
    with opened(path, name) as lines:
        head, rows = frame_asked_for(lines, options, lambda: _head(lines))
        return _table(head, rows, options, lines.notes)


@dataclass(frozen=True)
class _Head:
    """What stands before the grains of a frame."""

    n: int
    line: int  # that describes the columns
    text: str


def _head(lines: Lines) -> _Head | None:
    """Head of the next frame; None at the end of the file."""
    while lines.advance():
        if not lines.text.strip():
            continue
        n = lines.integer(0, "the number of grains")
        if len(lines.text.split()) > 1:
            raise lines.error("expected the number of grains alone on its line", 1)
        lines.need("the line that describes the columns")
        return _Head(n, lines.number, lines.text)
    return None


def _table(head: _Head, rows: Rows, options: ReadOptions, notes: tuple[str, ...]) -> GrainTable:
    line, about = head.line, head.text
    keys = {found[1].lower(): found for found in _KEY.finditer(about)}

    def value(key: str) -> str:
        found = keys[key]
        return found[2] or found[3] or found[4] or ""

    def wrong(key: str, message: str) -> ParseError:
        return ParseError(rows.name, line, keys[key].start() + 1, message)

    text = value("properties") if "properties" in keys else _PLAIN
    words, factors, unused, width = _properties(text, partial(wrong, "properties"))
    for row, (_, one) in enumerate(rows.where):
        if (got := len(one.split())) != width:
            raise rows.error(row, min(got, width), f"expected {width} words, found {got}")
    names = [one for one in words if one not in {"id", "fixed"}]
    values = rows.columns([words[one] for one in names], [f"'{one}'" for one in names])
    found: dict[str, Floats] = dict(zip(names, values, strict=True))
    found |= {name: factor * found[name] for name, factor in factors.items() if name in found}
    period, shut_above = _period(keys, value, wrong, options.length)
    n, still, at = len(rows.where), words.get("fixed"), words.get("id")
    table = GrainTable(
        name=rows.name,
        columns=options.in_si(found),
        fixed=rows.integers(still, "fixed, 0 or 1") != 0 if still is not None else np.zeros(n, np.bool_),
        group=("",) * n,
        labels=tuple(f"of line {number} of {rows.name}" for number, _ in rows.where),
        ids=rows.integers(at, "an id") if at is not None else np.zeros(0, np.int64),
        period=period,
        notes=(
            *notes,
            *not_used(rows.name, unused),
            *not_used(rows.name, (found[1] for key, found in keys.items() if key not in _KEYS), "keys"),
            *open_in_z(rows.name, shut_above),
            *(
                (f"{rows.name} has a Lattice but no pbc: its sides are taken as open",)
                * ("lattice" in keys and "pbc" not in keys)
            ),
        ),
    )
    return checked(table, rows, words)


def _properties(
    text: str, wrong: Callable[[str], ParseError]
) -> tuple[dict[str, int], dict[str, float], list[str], int]:
    """Place and factor of each column, properties without use, and the number of words in a row."""
    words: dict[str, int] = {}
    factors: dict[str, float] = {}
    unused: list[str] = []
    width = 0
    parts = text.split(":")
    for k in range(0, len(parts), 3):
        known, kind, count = (*parts[k : k + 3], "", "")[:3]
        if kind not in {"S", "I", "R", "L"} or not count.isdecimal() or not 1 <= int(count[:4]) <= 100:
            raise wrong(f"expected Properties as name:type:count:..., found {shown(text)}")
        word, size = known.lower(), meaning_of(known)
        columns = _READ.get(word, (word,) if word in {"id", "fixed"} else (size[0],) if size else ())
        if columns and len(columns) != int(count):
            raise wrong(f"expected {len(columns)} columns of '{known}', found {int(count)}")
        if any(column in words for column in columns):  # a radius beside a diameter
            unused.append(known)
        for j, column in enumerate(columns):
            words.setdefault(column, width + j)
        if size is not None:
            factors.setdefault(size[0], size[1])
        if not columns and word not in _WITHOUT_USE:
            unused.append(known)
        width += int(count)
    if "x" not in words:
        raise wrong("expected a property pos:R:3, the positions")
    return words, factors, unused, width


def _period(
    keys: Mapping[str, object],
    value: Callable[[str], str],
    wrong: Callable[[str, str], ParseError],
    unit: float,
) -> tuple[tuple[float, float] | None, bool]:
    """Periods in x and y, and whether there is one in z.

    The periods are None where the file does not state both its sides and which of them are periodic.
    """
    if "pbc" not in keys:
        return None, False
    flags = [_PERIODIC.get(one.lower()) for one in value("pbc").split()]
    if len(flags) != 3 or None in flags:
        raise wrong("pbc", "expected three of T and F")
    if not any(flags):
        return (math.inf, math.inf), False
    if "lattice" not in keys:
        raise wrong("pbc", "expected Lattice beside pbc")
    try:
        sides = np.array([float(one) for one in value("lattice").split()]).reshape(3, 3)
    except ValueError:
        raise wrong("lattice", "expected nine numbers") from None
    if not np.array_equal(sides, np.diag(np.diag(sides))):
        raise wrong("lattice", "expected a box that is not skewed")
    lengths = [float(sides[k, k]) if flags[k] else math.inf for k in (0, 1)]
    if not all(length > 0.0 for length in lengths):
        raise wrong("lattice", "expected sides above 0")
    return (lengths[0] * unit, lengths[1] * unit), bool(flags[2])
