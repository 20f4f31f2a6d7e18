"""VTK XML grids of points, for ParaView and OVITO: one file a frame, and a .pvd with their times."""

import base64
import math
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from ryusa.formats.grains import GrainTable

_TYPES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}
_VERTEX = 1  # number of VTK for a cell of one point


def vtu_file(table: GrainTable) -> bytes:
    """One frame. The numbers are stored as they are, in base64."""
    n = table.n
    period = np.array(table.period or (math.inf, math.inf))
    zero = np.zeros((n, 1), dtype=np.int64)
    steps = np.arange(n, dtype=np.int64)
    points = [_array("Points", table.vectors("x", "y", "z"))]
    data = [
        _array("velocity", table.vectors("vx", "vy", "vz")),
        _array("spin", table.vectors("wx", "wy", "wz")),
        _array("diameter", table.column("d")),
        _array("mass", table.column("m")),
        _array("id", table.ids),
        _array("fixed", table.fixed.astype(np.uint8)),
        _array("image", np.hstack([table.image, zero])),
    ]
    cells = [
        _array("connectivity", steps),
        _array("offsets", steps + 1),
        _array("types", np.full(n, _VERTEX, dtype=np.uint8)),
    ]
    about = [
        _array("TimeValue", np.array([table.t]), tuples=1),
        _array("step", np.array([table.step]), tuples=1),
        _array("period", period, tuples=2),
    ]
    lines = [
        '<?xml version="1.0"?>',
        "<!-- written by ryusa export: metres, seconds, kilograms, radians -->",
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">',
        "<UnstructuredGrid>",
        "<FieldData>", *about, "</FieldData>",
        f'<Piece NumberOfPoints="{n}" NumberOfCells="{n}">',
        "<Points>", *points, "</Points>",
        "<Cells>", *cells, "</Cells>",
        "<PointData>", *data, "</PointData>",
        "</Piece>", "</UnstructuredGrid>", "</VTKFile>", "",
    ]  # fmt: skip
    return "\n".join(lines).encode("ascii")


def pvd_file(frames: list[tuple[float, str]]) -> bytes:
    """List of files with their times [s]."""
    lines = [
        '<?xml version="1.0"?>',
        '<VTKFile type="Collection" version="1.0" byte_order="LittleEndian">',
        "<Collection>",
        *(f'<DataSet timestep="{t!r}" part="0" file={quoteattr(name)}/>' for t, name in frames),
        "</Collection>", "</VTKFile>", "",
    ]  # fmt: skip
    return "\n".join(lines).encode("utf-8")


def _array(name: str, values: NDArray[Any], *, tuples: int = 0) -> str:
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    kind = _TYPES[little.dtype.str[1:]]
    width = f' NumberOfComponents="{values.shape[1]}"' if values.ndim == 2 else ""
    count = f' NumberOfTuples="{tuples}"' if tuples else ""
    size = np.array([little.nbytes], dtype="<u8").tobytes()
    text = base64.b64encode(size + little.tobytes()).decode("ascii")
    return f'<DataArray type="{kind}" Name="{name}"{width}{count} format="binary">{text}</DataArray>'
