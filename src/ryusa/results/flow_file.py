"""What the water of a scene moves in, in its file: numbers as JSON, and one dataset for each array."""

from dataclasses import asdict, fields
from typing import Any, get_type_hints

import numpy as np

from ryusa.model.column import Column
from ryusa.model.course import Course
from ryusa.model.flow import Flow
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowDam, RowEnd

# those of numbers alone, by their key among the scalars
FLOWS: dict[str, type[Flow]] = {"column": Column}
ROW = "row"  # group of the datasets of a row, and its key
_ENDS = ("upstream", "downstream")
_MATRIX = tuple(PorousSolid.__dataclass_fields__)
_SEGMENTS = ("bottom", "solid", "start")
# names that `flow_arrays` may give
FLOW_ARRAYS = (*_SEGMENTS, *(f"porous/{name}" for name in _MATRIX), *(f"{name}/profile" for name in _ENDS))
_NUMBERS = {
    name: kind
    for name, kind in get_type_hints(ColumnRow).items()
    if isinstance(kind, type) and issubclass(kind, int | float)
}


def flow_scalars(flow: Flow | None) -> dict[str, Any]:
    """Numbers and words of what the water moves in, by the key of its kind."""
    found: dict[str, Any] = {"column": None}
    if isinstance(flow, ColumnRow):
        return found | {ROW: _row_scalars(flow)}
    return found | {name: asdict(flow) for name, kind in FLOWS.items() if type(flow) is kind}  # type: ignore[call-overload]


def _row_scalars(row: ColumnRow) -> dict[str, Any]:
    ends = {name: None if (end := getattr(row, name)) is None else asdict(end) for name in _ENDS}
    for end in ends.values():
        if end is not None:
            del end["profile"]  # a dataset
            if end["course"] is None:
                del end["course"]
    dams = [asdict(one) for one in row.dams]
    for dam in dams:
        if not dam["aerated"]:
            del dam["aerated"]  # digests stay
    default = {one.name: one.default for one in fields(row) if one.name != "x_low"}
    numbers = {name: getattr(row, name) for name in _NUMBERS}
    numbers = {name: one for name, one in numbers.items() if one != default.get(name)}  # digests stay
    return {"column": asdict(row.column), **ends, "dams": dams, **numbers}


def flow_arrays(flow: Flow | None) -> dict[str, np.ndarray]:
    """Arrays of what the water moves in by the name of their dataset; of a row alone."""
    if not isinstance(flow, ColumnRow):
        return {}
    found = {name: getattr(flow, name) for name in _SEGMENTS}
    found |= {f"porous/{name}": getattr(flow.porous, name) for name in _MATRIX if flow.porous is not None}
    ends = {name: getattr(flow, name) for name in _ENDS}
    found |= {f"{name}/profile": end.profile for name, end in ends.items() if end is not None}
    return {name: np.asarray(one) for name, one in found.items() if one is not None}


def numbers_of(kind: type, raw: dict[str, Any]) -> Any:
    """A dataclass of numbers and choices from their JSON."""
    hints = get_type_hints(kind)
    return kind(**{name: hints[name](value) for name, value in raw.items()})


def flow_from(scalars: dict[str, Any], arrays: dict[str, np.ndarray]) -> Flow | None:
    """What the water moves in, taken out of the scalars of a scene; None where it does not move.

    Raises
    ------
    ValueError, KeyError, TypeError : none of ryusa.
    """
    found = [
        numbers_of(kind, raw) for name, kind in FLOWS.items() if (raw := scalars.pop(name, None)) is not None
    ]
    given = scalars.pop(ROW, None)
    return _row_from(given, arrays) if given is not None else next(iter(found), None)


def _row_from(scalars: dict[str, Any], arrays: dict[str, np.ndarray]) -> ColumnRow:
    """A row from its parts, whose numbers go to compiled code and are therefore checked."""
    column: Column = numbers_of(Column, scalars["column"])
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
    given: dict[str, Any] = {
        name: None if scalars[name] is None else _end(scalars[name], arrays.get(f"{name}/profile"))
        for name in _ENDS
    }
    given |= {name: kind(scalars[name]) for name, kind in _NUMBERS.items() if name in scalars}
    row = ColumnRow(
        column, bottom=bottom, **given, solid=arrays.get("solid"), start=arrays.get("start"),
        porous=PorousSolid(**matrix) if matrix else None,
        dams=tuple(numbers_of(RowDam, one) for one in scalars["dams"]),
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
