"""Triangle meshes of STL and OBJ files."""

from pathlib import Path

import numpy as np

from ryusa.errors import ParseError
from ryusa.model.scene import Floats

KINDS = (".stl", ".obj")
MOST_TRIANGLES = 2_000_000
_LARGEST = 1 << 29  # bytes of a file


def read_mesh(path: Path, name: str) -> Floats:
    """Corners of the triangles of a mesh, in the unit of the file, shape (n, 3, 3).

    Polygons of more corners are cut into triangles. Materials, textures and normals are not read.

    Parameters
    ----------
    path : an STL (text or binary) or OBJ file.
    name : as the user wrote it, for errors.

    Raises
    ------
    ParseError : it is not such a file, holds no triangle, too many, or a corner that is not finite.
    """
    import trimesh

    if path.suffix.lower() not in KINDS:
        raise ParseError(name, 1, 1, f"must be an {' or '.join(one[1:].upper() for one in KINDS)} file")
    if path.stat().st_size > _LARGEST:
        raise ParseError(name, 1, 1, f"is larger than {_LARGEST >> 20} MiB, the limit for a mesh")
    kind = path.suffix.lower()[1:]
    with path.open("rb") as file:
        try:
            loaded = trimesh.load_mesh(
                file, file_type=kind, process=False, maintain_order=True, skip_materials=True
            )
            corners = np.asarray(loaded.vertices, dtype=np.float64)[np.asarray(loaded.faces, dtype=np.int64)]
        except Exception as error:  # of any kind: the file is the user's, and the reader another's
            about = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
            raise ParseError(name, 1, 1, f"cannot be read as {kind.upper()} ({about})") from error
    if not corners.size:
        raise ParseError(name, 1, 1, "holds no triangle; export the part as a mesh of triangles")
    corners = corners.reshape(-1, 3, 3)
    if len(corners) > MOST_TRIANGLES:
        raise ParseError(name, 1, 1, f"holds {len(corners):,} triangles; at most {MOST_TRIANGLES:,}")
    bad = np.flatnonzero(~np.isfinite(corners).all(axis=(1, 2)))
    if len(bad):
        raise ParseError(name, 1, 1, f"triangle {bad[0]} has a corner that is not finite")
    return corners
