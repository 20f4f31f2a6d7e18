"""VTK XML grids of points, for ParaView and OVITO: one file a frame, and a .pvd with their times."""

import base64
import binascii
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ParseError
from ryusa.formats.grains import NO_CLUMP, PART_OF_A_CLUMP, GrainTable
from ryusa.formats.names import not_used
from ryusa.formats.text import D_HIGH, D_LOW, LARGEST, shown

_TYPES = {"f8": "Float64", "i8": "Int64", "u1": "UInt8"}
_VERTEX = 1  # number of VTK for a cell of one point


def vtu_file(table: GrainTable) -> bytes:
    """One frame. The numbers are stored as they are, in base64; quaternions as (w, x, y, z), as in VTK."""
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
    if table.clump is not None and table.orientation is not None:
        data += [_array("clump", table.clump), _array("orientation", table.orientation)]
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
    from xml.sax.saxutils import quoteattr  # it loads what opens addresses of the web

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


_READ = {  # array: its type and width, 0 for one number a grain
    "Points": ("Float64", 3),
    "velocity": ("Float64", 3),
    "spin": ("Float64", 3),
    "diameter": ("Float64", 0),
    "mass": ("Float64", 0),
    "id": ("Int64", 0),
    "fixed": ("UInt8", 0),
}


# arrays that ryusa writes beside these, of which nothing need be said
_BESIDE = {
    "period", "clump", "orientation", "image", "TimeValue", "step", "connectivity", "offsets", "types",
}  # fmt: skip


@dataclass
class _Stored:
    """A data array of the file, not yet decoded."""

    about: dict[str, str]
    line: int
    column: int
    text: list[str] = field(default_factory=lambda: [])


def read_vtu(path: Path, name: str) -> GrainTable:
    """Read a frame that ryusa wrote."""
    stored, n, line = _arrays(path, name)

    def values(one: str, shape: tuple[int, ...], kind: str) -> NDArray[Any]:
        if one not in stored:
            raise ParseError(name, line, 1, f"expected an array '{one}', as ryusa export writes it")
        return _decoded(stored[one], name, one, shape, kind)

    found = {one: values(one, (n, width) if width else (n,), kind) for one, (kind, width) in _READ.items()}
    period = values("period", (2,), "Float64").tolist()
    for one, (low, high) in {
        "Points": (-LARGEST, LARGEST),
        "velocity": (-LARGEST, LARGEST),
        "spin": (-LARGEST, LARGEST),
        "diameter": (D_LOW, D_HIGH),
        "mass": (0.0, LARGEST),
    }.items():
        wrong = ~((found[one] >= low) & (found[one] <= high))
        if wrong.any():
            where = stored[one]
            raise ParseError(
                name, where.line, where.column,
                f"'{one}': expected numbers from {low:g} to {high:g}, found {found[one][wrong][0]:g}",
            )  # fmt: skip
    if "clump" in stored and (values("clump", (n,), "Int64") != NO_CLUMP).any():
        raise ParseError(name, stored["clump"].line, stored["clump"].column, PART_OF_A_CLUMP)
    where = stored["fixed"]
    if found["fixed"].all():
        raise ParseError(name, where.line, where.column, "expected at least one free grain")
    if len(np.unique(found["id"])) < n:
        raise ParseError(name, stored["id"].line, stored["id"].column, "an id appears twice")
    if not all(length > 0.0 for length in period):
        where = stored["period"]
        raise ParseError(name, where.line, where.column, "expected periods above 0")
    order = np.argsort(found["id"], kind="stable")
    names = ("x", "y", "z", "d", "vx", "vy", "vz", "wx", "wy", "wz", "m")
    alone = found["diameter"][:, None], found["mass"][:, None]
    arrays = [found["Points"], alone[0], found["velocity"], found["spin"], alone[1]]
    ids = found["id"][order]
    return GrainTable(
        name=name,
        columns=dict(zip(names, np.hstack(arrays)[order].T, strict=True)),
        fixed=found["fixed"][order] != 0,
        group=("",) * n,
        labels=tuple(f"{one} of {name}" for one in ids.tolist()),
        ids=ids,
        period=(period[0], period[1]),
        notes=not_used(name, (one for one in stored if one not in _READ and one not in _BESIDE), "arrays"),
    )


def _arrays(path: Path, name: str) -> tuple[dict[str, _Stored], int, int]:
    """Data arrays by name, the number of grains, and the last line."""
    parser = expat.ParserCreate()
    stored: dict[str, _Stored] = {}
    pieces: list[int] = []
    inside: list[_Stored] = []

    def here(message: str) -> ParseError:
        return ParseError(name, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1, message)

    def begin(tag: str, about: dict[str, str]) -> None:
        if tag == "VTKFile":
            wanted = {"type": "UnstructuredGrid", "byte_order": "LittleEndian", "header_type": "UInt64"}
            for key, word in wanted.items():
                if about.get(key) != word:
                    raise here(f"expected {key}='{word}', found {shown(about.get(key, ''))}")
            if "compressor" in about:
                raise here("expected a file without compression, as ryusa export writes it")
        elif tag == "Piece":
            count = about.get("NumberOfPoints", "")
            if not (count.isascii() and count.isdecimal() and len(count) < 19 and int(count) > 0):
                raise here(f"expected NumberOfPoints above 0, found {shown(count)}")
            pieces.append(int(count))
        elif tag == "DataArray":
            known = about.get("Name", "")
            if known in stored:
                raise here(f"the array {shown(known)} appears twice")
            stored[known] = _Stored(about, parser.CurrentLineNumber, parser.CurrentColumnNumber + 1)
            inside[:] = [stored[known]]

    def end(tag: str) -> None:
        if tag == "DataArray":
            inside.clear()

    def text(data: str) -> None:
        for one in inside:
            one.text.append(data)

    def declared(*_about: object) -> None:
        raise here("expected no DOCTYPE")

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = text, declared
    try:
        with path.open("rb") as file:
            parser.ParseFile(file)
    except expat.ExpatError as error:
        message = f"expected XML as VTK writes it ({expat.ErrorString(error.code)})"
        raise ParseError(name, error.lineno, error.offset + 1, message) from None
    except OSError as error:
        raise ParseError(name, 1, 1, f"cannot be read ({error.strerror or error})") from None
    if len(pieces) != 1:
        raise here("expected one piece")
    return stored, pieces[0], parser.CurrentLineNumber


def _decoded(stored: _Stored, name: str, one: str, shape: tuple[int, ...], kind: str) -> NDArray[Any]:
    """Numbers of an array; its type and size must be those of ryusa."""
    about = stored.about

    def wrong(message: str) -> ParseError:
        return ParseError(name, stored.line, stored.column, f"'{one}': {message}")

    if about.get("type") != kind or about.get("format") != "binary":
        raise wrong(f"expected type='{kind}' and format='binary', as ryusa export writes it")
    try:
        content = base64.b64decode("".join(stored.text).strip(), validate=True)
    except (binascii.Error, ValueError) as error:
        raise wrong(f"expected base64 ({error})") from None
    dtype = np.dtype({word: code for code, word in _TYPES.items()}[kind]).newbyteorder("<")
    size = dtype.itemsize * math.prod(shape)
    if len(content) != 8 + size or int.from_bytes(content[:8], "little") != size:
        raise wrong(
            f"expected {math.prod(shape)} numbers, found {max(len(content) - 8, 0) / dtype.itemsize:g}"
        )
    return np.frombuffer(content[8:], dtype=dtype).reshape(shape).astype(dtype.newbyteorder("="))
