"""Triangle meshes of STL and OBJ files."""

import io
import re
from pathlib import Path

import numpy as np

from ryusa.errors import ParseError
from ryusa.formats.obj import read_obj
from ryusa.model.scene import Floats

KINDS = (".stl", ".obj")
MOST_TRIANGLES = 2_000_000
_LARGEST = 1 << 29  # bytes of a file
_HEAD, _ROW = 84, 50  # bytes of a binary STL file before its triangles, and of each


def read_mesh(path: Path, name: str) -> Floats:
    """Corners of the triangles of a mesh, in the unit of the file, shape (n, 3, 3).

    Polygons of more corners are cut into triangles. Materials, textures and normals are not read.

    Parameters
    ----------
    path : an STL (text or binary) or OBJ file.
    name : as the user wrote it, for errors.

    Raises
    ------
    ParseError : it is not such a file, is cut off, holds no triangle, too many, or a corner that is not
        finite.
    """
    if path.suffix.lower() not in KINDS:
        raise ParseError(name, 1, 1, f"must be an {' or '.join(one[1:].upper() for one in KINDS)} file")
    try:
        if path.stat().st_size > _LARGEST:
            raise ParseError(name, 1, 1, f"is larger than {_LARGEST >> 20} MiB, the limit for a mesh")
        corners = read_obj(path, name) if path.suffix.lower() == ".obj" else _read_stl(path, name)
    except OSError as error:
        raise ParseError(name, 1, 1, f"cannot be read ({error.strerror or error})") from error
    if not corners.size:
        raise ParseError(name, 1, 1, "holds no triangle; export the part as a mesh of triangles")
    if len(corners) > MOST_TRIANGLES:
        raise ParseError(
            name, 1, 1, f"holds {len(corners):,} triangles; at most {MOST_TRIANGLES:,}: coarsen the mesh"
        )
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if len(bad):
        raise ParseError(name, 1, 1, f"triangle {bad[0]} has a corner that is not finite")
    return corners


def _read_stl(path: Path, name: str) -> Floats:
    """Corners of an STL file; text and binary are told apart by the length, as many binary ones say solid.

    Some programs write more behind the triangles of a binary file; that is no triangle and is not read.
    """
    whole = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    stated = int.from_bytes(whole[80:_HEAD], "little") if len(whole) >= _HEAD else -1
    end = _HEAD + _ROW * stated
    if not stated >= 0 or len(whole) < end or (len(whole) > end and (not stated or _is_text(whole))):
        return _read_text(whole, stated, name)
    if stated == 0:
        return np.zeros((0, 3, 3))
    import trimesh

    with io.BytesIO(whole[:end]) as file:
        try:
            loaded = trimesh.load_mesh(file, file_type="stl", process=False, maintain_order=True)
            corners = np.asarray(loaded.vertices, dtype=np.float64)[np.asarray(loaded.faces, dtype=np.int64)]
            corners = corners.reshape(-1, 3, 3)
        except Exception as error:  # of any kind: the file is the user's, and the reader another's
            about = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
            raise ParseError(name, 1, 1, f"cannot be read as STL ({about})") from error
    return corners


def _is_text(whole: bytes) -> bool:
    return re.match(rb"\s*solid\b", whole, re.IGNORECASE) is not None and b"\0" not in whole


def _read_text(whole: bytes, stated: int, name: str) -> Floats:
    """Corners of a text file. trimesh prints what it cannot read, with the trace of its own error.

    Raises
    ------
    ParseError : it is no text of an STL file, is cut off, or a vertex is not three numbers.
    """
    if not whole.strip():
        raise ParseError(name, 1, 1, "is empty")
    if not _is_text(whole):
        if stated < 0:
            raise ParseError(name, 1, 1, "is neither text nor binary STL; is it another format?")
        raise ParseError(
            name, 1, 1,
            f"is no text STL, and as binary STL it would hold {stated:,} triangles in "
            f"{_HEAD + _ROW * stated:,} bytes, but has {len(whole):,}: it is cut off, "
            "damaged or of another format; export it again",
        )  # fmt: skip
    begun, ended, vertices = (
        len(re.findall(rb"^\s*%b\b" % word, whole, re.IGNORECASE | re.MULTILINE))
        for word in (b"facet", b"endfacet", b"vertex")
    )
    last = re.search(rb"^\s*endsolid\b[^\r\n]*\s*\Z", whole, re.IGNORECASE | re.MULTILINE)
    if last is None or begun != ended or vertices != 3 * begun:
        line = whole.count(b"\n") + 1
        ends = "with" if last is not None else "without"
        raise ParseError(
            name, line, 1,
            f"holds {begun} facets, of which {ended} end, and {vertices} vertices, and ends {ends} 'endsolid'"
            ": it is cut off or damaged; export it again",
        )  # fmt: skip
    rows = np.zeros((vertices, 3))
    for k, found in enumerate(re.finditer(rb"^\s*vertex\b([^\r\n]*)", whole, re.IGNORECASE | re.MULTILINE)):
        try:
            x, y, z = (float(one) for one in found.group(1).split())
        except ValueError:
            line, text = whole[: found.start(1)].count(b"\n") + 1, found.group(1).decode("utf-8", "replace")
            raise ParseError(
                name, line, 1, f"a vertex needs three numbers, found '{text.strip()[:40]}'"
            ) from None
        rows[k] = x, y, z
    return rows.reshape(-1, 3, 3)
