"""Text dumps of LAMMPS: `dump custom` of spheres, written in SI and read in any unit."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.formats.grains import GrainTable
from ryusa.formats.names import meaning_of, not_used, open_in_z
from ryusa.formats.text import Lines, ReadOptions, Rows, checked, frame_asked_for, opened, shown
from ryusa.model.arrays import Floats

FREE_TYPE, FIXED_TYPE = 1, 2
COLUMNS = "id type x y z ix iy iz vx vy vz omegax omegay omegaz diameter mass"  # names of LAMMPS
OF_CLUMPS = " mol quatw quati quatj quatk"  # names of LAMMPS as well; molecule 0 is a grain of its own
# Once in a file, as LAMMPS writes it: OVITO reads one frame of a dump that repeats it.
DUMP_HEAD = b"ITEM: UNITS\nsi\n"
_ROW = "%d %d %r %r %r %d %d 0 %r %r %r %r %r %r %r %r"
_CLUMP_ROW = " %d %r %r %r %r"


def dump_frame(table: GrainTable) -> bytes:
    """One frame. Ids are those of the run plus 1, since LAMMPS counts from 1; type 2 is fixed.

    The spheres of a clump are a molecule, numbered from 1.

    The box is the period where there is one, and encloses the grains elsewhere.
    """
    period = (*(table.period or (math.inf, math.inf)), math.inf)
    radius = table.column("d") / 2.0
    sides, bounds = list[str](), list[str]()
    for axis, length in zip("xyz", period, strict=True):
        x = table.column(axis)
        shut = math.isfinite(length)
        low, high = 0.0, length
        if not shut:
            low = float((x - radius).min()) if table.n else 0.0
            high = float((x + radius).max(initial=low))
        sides.append("pp" if shut else "ss")
        bounds.append(f"{low!r} {high!r}")
    more: list[list[Any]] = []
    if table.clump is not None and table.orientation is not None:
        more = [(table.clump + 1).tolist(), *table.orientation.T.tolist()]
    row_form = _ROW + _CLUMP_ROW * bool(more)
    head = [
        "ITEM: TIME", repr(table.t), "ITEM: TIMESTEP", str(table.step),
        "ITEM: NUMBER OF ATOMS", str(table.n), f"ITEM: BOX BOUNDS {' '.join(sides)}", *bounds,
        f"ITEM: ATOMS {COLUMNS}{OF_CLUMPS if more else ''}",
    ]  # fmt: skip
    names = ("x", "y", "z"), ("vx", "vy", "vz", "wx", "wy", "wz", "d", "m")
    rows = zip(
        (table.ids + 1).tolist(),
        [FIXED_TYPE if fixed else FREE_TYPE for fixed in table.fixed.tolist()],
        *(table.column(name).tolist() for name in names[0]),
        *(table.image[:, axis].tolist() for axis in (0, 1)),
        *(table.column(name).tolist() for name in names[1]),
        *more,
        strict=True,
    )
    return "\n".join([*head, *(row_form % row for row in rows), ""]).encode("ascii")


_READ = {
    **{name: (name, 1.0) for name in ("vx", "vy", "vz")},
    **{f"omega{axis}": (f"w{axis}", 1.0) for axis in "xyz"},
}
_WITHOUT_USE = {"id", "type", "element", "proc", "ix", "iy", "iz"}  # of which nothing need be said
_PLACES = (("", "u"), ("s", "su"))  # endings of x, y, z: lengths; shares of the box


@dataclass(frozen=True)
class _Head:
    """What stands before the grains of a frame."""

    n: int
    low: tuple[float, ...]
    size: tuple[float, ...]
    sides: list[str]  # such as pp; () where the file does not say
    columns: list[str]
    line: int
    text: str


def read_dump(path: Path, name: str, options: ReadOptions) -> GrainTable:
    """Read one frame of a dump."""
    with opened(path, name) as lines:
        head, rows = frame_asked_for(lines, options, lambda: _head(lines, options))
        return _table(head, rows, options, lines.notes)


def _head(lines: Lines, options: ReadOptions) -> _Head | None:
    """Head of the next frame; None at the end of the file."""
    n: int | None = None
    low, size = list[float](), list[float]()
    sides = list[str]()
    begun = False
    while lines.advance():
        words = lines.text.split()
        if not words and not begun:
            continue
        begun = True
        match words:
            case ["ITEM:", "TIMESTEP"]:
                lines.need("the number of a time step")
                lines.integer(0, "the number of a time step")
            case ["ITEM:", "TIME"]:
                lines.need("a time")
                lines.floats(0, 1, "a time")
            case ["ITEM:", "UNITS"]:
                units = lines.need("a style of units").strip()
                if units != "si" and not options.stated:
                    raise lines.error(
                        f"the file has units {shown(units)}: state build.length_unit and build.time_unit"
                    )
            case ["ITEM:", "NUMBER", "OF", "ATOMS"]:
                lines.need("the number of grains")
                n = lines.integer(0, "the number of grains")
            case ["ITEM:", "BOX", "BOUNDS", *sides]:
                if len(sides) not in {0, 3} or not all(len(one) == 2 for one in sides):
                    raise lines.error("expected sides such as 'pp ff ff': a box that is not skewed", 3)
                low, size = [], []
                for axis in "xyz":
                    lines.need(f"the bounds of the box in {axis}")
                    begin, end = lines.floats(0, 2, f"a bound of the box in {axis}")
                    if not begin < end and n != 0:
                        raise lines.error("expected a lower bound below the upper one")
                    low.append(begin)
                    size.append(end - begin)
            case ["ITEM:", "ATOMS", *columns]:
                if n is None or not low:
                    raise lines.error("expected NUMBER OF ATOMS and BOX BOUNDS before ATOMS")
                return _Head(n, tuple(low), tuple(size), list(sides), columns, lines.number, lines.text)
            case _:
                raise lines.error(f"expected 'ITEM: ...' as LAMMPS writes it, found {shown(lines.text)}")
    if begun:
        raise lines.error("the file ends; expected the grains of a frame, 'ITEM: ATOMS ...'")
    return None


def _table(head: _Head, rows: Rows, options: ReadOptions, notes: tuple[str, ...]) -> GrainTable:
    columns: dict[str, Floats] = {}
    words: dict[str, int] = {}
    factors: dict[str, float] = {}
    scaled: set[str] = set()
    for word, one in enumerate(head.columns):
        place, share = one[:1], one[1:]
        known, factor = _READ.get(one) or meaning_of(one) or (None, 1.0)
        if place in {"x", "y", "z"} and share in (*_PLACES[0], *_PLACES[1]):
            known = place
            if share in _PLACES[1]:
                scaled.add(place)
        if known is not None and known not in words:
            words[known], factors[known] = word, factor
    header = Rows(rows.name, [(head.line, head.text)])
    for axis in "xyz":
        if axis not in words:
            raise header.error(0, 2, f"expected a column '{axis}' (or {axis}u, {axis}s) in ITEM: ATOMS")
    values = rows.columns(list(words.values()), [f"column '{head.columns[k]}'" for k in words.values()])
    for known, one in zip(words, values, strict=True):
        columns[known] = one * factors[known]
    for axis in scaled:
        k = "xyz".index(axis)
        columns[axis] = head.low[k] + columns[axis] * head.size[k]
    at = {one: k for k, one in enumerate(head.columns)}
    unused = [one for one, k in at.items() if k not in words.values() and one not in _WITHOUT_USE]
    ids = rows.integers(at["id"], "an id") if "id" in at else np.zeros(0, np.int64)
    inf = math.inf
    table = GrainTable(
        name=rows.name,
        columns=options.in_si(columns),
        fixed=options.fixed(rows, at.get("type")),
        group=("",) * head.n,
        labels=tuple(f"of line {line} of {rows.name}" for line, _ in rows.where),
        ids=ids,
        period=(
            head.size[0] * options.length if "p" in head.sides[0] else inf,
            head.size[1] * options.length if "p" in head.sides[1] else inf,
        )
        if head.sides
        else None,
        notes=(
            *notes,
            *not_used(rows.name, unused),
            *open_in_z(rows.name, bool(head.sides) and "p" in head.sides[2]),
        ),
    )
    return checked(table, rows, {**words, "id": at.get("id", 0)})
