"""A row of columns of a scene in its file: numbers as JSON, and one dataset for each array."""

from dataclasses import asdict
from typing import Any

import numpy as np

from ryusa.laws.families import Pressure
from ryusa.model.column import Column
from ryusa.model.course import Course
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowDam, RowEnd

ROW = "row"  # group of the datasets, and key among the scalars
_ENDS = ("upstream", "downstream")
_MATRIX = tuple(PorousSolid.__dataclass_fields__)
_SEGMENTS = ("bottom", "solid", "start")


def row_scalars(row: ColumnRow) -> dict[str, Any]:
    """Numbers and words of a row."""
    ends = {name: None if (end := getattr(row, name)) is None else asdict(end) for name in _ENDS}
    for end in ends.values():
        if end is not None:
            del end["profile"]  # a dataset
            if end["course"] is None:
                del end["course"]
    return {
        "column": asdict(row.column), "dx": row.dx, "g_z": row.g_z, "x_low": row.x_low, **ends,
        "dams": [asdict(one) for one in row.dams], "pressure": int(row.pressure),
    }  # fmt: skip


def row_arrays(row: ColumnRow) -> dict[str, np.ndarray]:
    """Arrays of a row by the name of their dataset."""
    found = {name: getattr(row, name) for name in _SEGMENTS}
    found |= {f"porous/{name}": getattr(row.porous, name) for name in _MATRIX if row.porous is not None}
    ends = {name: getattr(row, name) for name in _ENDS}
    found |= {f"{name}/profile": end.profile for name, end in ends.items() if end is not None}
    return {name: np.asarray(one) for name, one in found.items() if one is not None}


def dataset_names() -> tuple[str, ...]:
    """Names that `row_arrays` may give."""
    ends = tuple(f"{name}/profile" for name in _ENDS)
    return (*_SEGMENTS, *(f"porous/{name}" for name in _MATRIX), *ends)


def row_from(scalars: dict[str, Any], arrays: dict[str, np.ndarray], column: Column) -> ColumnRow:
    """A row from its parts, whose numbers go to compiled code and are therefore checked.

    Raises
    ------
    ValueError, KeyError, TypeError : not a row of ryusa.
    """
    for name, one in arrays.items():
        wanted = np.int64 if name == "solid" else np.float64
        if one.dtype != wanted or not np.isfinite(one).all():
            raise ValueError(f"row/{name} is no array of finite numbers of type {wanted.__name__}")
        one.flags.writeable = False
    bottom = arrays["bottom"]
    n = len(bottom)
    shapes: dict[str, tuple[int, ...]] = dict.fromkeys(_SEGMENTS, (n,))
    shapes |= {f"porous/{name}": (n, column.n) for name in _MATRIX}
    for name, one in arrays.items():
        if name in shapes and one.shape != shapes[name]:
            raise ValueError(f"row/{name} is {one.shape}, expected {shapes[name]}")
    matrix = {name: arrays[f"porous/{name}"] for name in _MATRIX if f"porous/{name}" in arrays}
    ends = {
        name: None if scalars[name] is None else _end(scalars[name], arrays.get(f"{name}/profile"))
        for name in _ENDS
    }
    row = ColumnRow(
        column, float(scalars["dx"]), bottom, float(scalars["g_z"]), ends["upstream"], ends["downstream"],
        arrays.get("solid"), float(scalars["x_low"]), PorousSolid(**matrix) if matrix else None,
        arrays.get("start"),
        tuple(
            RowDam(
                str(one["name"]), int(one["first"]), int(one["end"]), float(one["crest"]), bool(one["porous"])
            )
            for one in scalars["dams"]
        ),
        Pressure(int(scalars.get("pressure", 0))),
    )  # fmt: skip
    if faults := row.refuses():
        raise ValueError("; ".join(faults))
    return row


def _end(raw: dict[str, Any], profile: np.ndarray | None) -> RowEnd:
    numbers = {name: float(raw[name]) for name in ("level", "discharge", "depth")}
    course = None
    if (given := raw.get("course")) is not None:
        t, y = (tuple(map(float, given[name])) for name in ("t", "y"))
        course = Course(t, y)
    return RowEnd(
        EndKind(int(raw["kind"])), profile=profile, developed=bool(raw["developed"]), course=course, **numbers
    )
