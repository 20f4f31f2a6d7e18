"""VTKHDF PolyData files of points, which ParaView (5.12 or later) and the vtk package can open directly.

`grains.vtkhdf` is an index without data: each dataset is an HDF5 virtual dataset over the write-once parts,
so that the file can be rewritten quickly and replaced by a rename; a reader sees the old index or the new
one, both complete. Every `SUBINDEX_PARTS` parts have a sub-index of their own that is written once, so
that time and memory for the index of the run do not grow with the run.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ryusa.model import EVENT, Scene
from ryusa.model.wall_shape import in_world, triangles_of
from ryusa.model.walls import across
from ryusa.results import schema
from ryusa.running.disk import hdf5_image, write_atomically

_VERSION = np.array([2, 0], dtype=np.int64)  # the first version with time steps of PolyData
_CELLS = ("Vertices", "Lines", "Polygons", "Strips")
_INT = np.dtype(np.int64)
_FLOAT = np.dtype(np.float64)
# Parts in a sub-index; HDF5 uses 4 kB for each source of a virtual dataset until the file is closed.
SUBINDEX_PARTS = 32
POINTS = "points.h5"  # in parts/: data that all frames share
_PLANE_REACH = 50.0  # half the side, in largest d, of the square that is drawn for an unbounded plane


@dataclass(frozen=True)
class PartSize:
    """Number of frames and contacts in a part."""

    name: str
    n_frame: int
    n_contact: int
    end: int = 0  # step up to which all that was recorded is in this part or an earlier one


def write_hdf5(path: Path, fill: Callable[[h5py.File], None]) -> None:
    """Write a small HDF5 file atomically."""
    write_atomically(path, hdf5_image(fill))


def write_points(parts: Path, scene: Scene) -> None:
    """Write the data that all frames share: diameter, id, clump and one vertex cell per grain."""

    def fill(file: h5py.File) -> None:
        file["diameter"] = scene.d
        file["id"] = np.arange(scene.n_grain, dtype=np.int64)
        if scene.bodies is not None:
            file["clump"] = scene.bodies.of_grain(scene.n_grain)
        file["offsets"] = np.arange(scene.n_grain + 1, dtype=np.int64)

    write_hdf5(parts / POINTS, fill)


def write_index(
    folder: Path, parts: list[PartSize], n_grain: int, n_subindex: int = 0, clumps: bool = False
) -> int:
    """Write `grains.vtkhdf` over `parts`; at least one frame is needed.

    Parameters
    ----------
    clumps : whether `write_points` wrote the clump of each grain.
    n_subindex : number of sub-indices that this process has written.

    Returns
    -------
    n_subindex : number of sub-indices now.

    Notes
    -----
    A sub-index is never overwritten by a different one: until the new index is in place, readers of the old
    one need theirs.
    """
    subindices = [
        _subindex(k, parts[k * SUBINDEX_PARTS : (k + 1) * SUBINDEX_PARTS])
        for k in range(len(parts) // SUBINDEX_PARTS)
    ]
    for k, subindex in enumerate(subindices[n_subindex:], n_subindex):
        _write_subindex(
            folder / schema.PARTS / subindex.name,
            parts[k * SUBINDEX_PARTS : (k + 1) * SUBINDEX_PARTS],
            n_grain,
        )

    def fill(file: h5py.File) -> None:
        _fill_index(file, [*subindices, *parts[len(subindices) * SUBINDEX_PARTS :]], n_grain, clumps)

    write_hdf5(folder / schema.GRAINS, fill)
    return len(subindices)


def _subindex(k: int, parts: list[PartSize]) -> PartSize:
    frames, contacts = sum(one.n_frame for one in parts), sum(one.n_contact for one in parts)
    return PartSize(
        schema.subindex_name(k * SUBINDEX_PARTS, frames, contacts), frames, contacts, parts[-1].end
    )


def _write_subindex(path: Path, parts: list[PartSize], n: int) -> None:
    """Write an index that has the layout of one large part."""
    shapes = {
        name: ((n, *tail) if name in schema.PER_GRAIN else tail, dtype)
        for name, (dtype, tail) in schema.FRAME_DATASETS.items()
    }
    shapes |= {"point_offset": ((), _INT), "tally": ((), schema.TALLY), "contacts": ((), EVENT)}

    def fill(file: h5py.File) -> None:
        for name, (tail, dtype) in shapes.items():
            _gather(file, name, parts, name, tail, dtype, folder="", flat=False)

    write_hdf5(path, fill)


def _fill_index(file: h5py.File, parts: list[PartSize], n: int, clumps: bool) -> None:
    n_frame = sum(part.n_frame for part in parts)
    root = _root(file)
    root["NumberOfPoints"] = np.array([n], dtype=np.int64)
    _gather(root, "Points", parts, "x", (n, 3), _FLOAT)
    data = root.create_group("PointData")
    _gather(data, "velocity", parts, "v", (n, 3), _FLOAT)
    _gather(data, "spin", parts, "omega", (n, 3), _FLOAT)
    _share(data, "diameter", "diameter", n, _FLOAT)
    shared = ("id", "clump") if clumps else ("id",)
    for name in shared:
        _share(data, name, name, n, _INT)
    for kind in _CELLS:
        cells = root.create_group(kind)
        count = n if kind == "Vertices" else 0
        cells["NumberOfCells"] = cells["NumberOfConnectivityIds"] = np.array([count], dtype=np.int64)
        if kind == "Vertices":
            _share(cells, "Connectivity", "id", n, _INT)
            _share(cells, "Offsets", "offsets", n + 1, _INT)
        else:
            cells["Connectivity"], cells["Offsets"] = np.zeros(0, np.int64), np.zeros(1, np.int64)
    steps = root.create_group("Steps")
    steps.attrs["NSteps"] = np.int64(n_frame)
    _gather(steps, "Values", parts, "t", (), _FLOAT)
    _gather(steps, "PointOffsets", parts, "point_offset", (), _INT)
    # never written, so they take no space: every step begins at the same cells and the same shared arrays
    zeros = steps.create_dataset("PartOffsets", (n_frame,), np.int64)
    steps.create_dataset("NumberOfParts", (n_frame,), np.int64, fillvalue=1)
    steps["ConnectivityIdOffsets"] = steps.create_dataset("CellOffsets", (n_frame, 4), np.int64)
    offsets = steps.create_group("PointDataOffsets")
    offsets["velocity"] = offsets["spin"] = steps["PointOffsets"]
    for name in ("diameter", *shared):
        offsets[name] = zeros
    # for h5py: data that ParaView does not use
    more = file.create_group("ryusa")
    _gather(more, "step", parts, "step", (), _INT)
    _gather(more, "image", parts, "image", (n, 2), schema.FRAME_DATASETS["image"][0])
    _gather(more, "tally", parts, "tally", (), schema.TALLY)
    _gather(more, "contacts", parts, "contacts", (), EVENT)


def _root(file: h5py.File) -> h5py.Group:
    root = file.create_group("VTKHDF")
    root.attrs["Version"] = _VERSION
    root.attrs["Type"] = np.bytes_("PolyData")
    return root


def _gather(
    group: h5py.Group,
    name: str,
    parts: list[PartSize],
    source: str,
    tail: tuple[int, ...],
    dtype: np.dtype[Any],
    *,
    folder: str = f"{schema.PARTS}/",
    flat: bool = True,
) -> None:
    """Concatenate the rows of all parts as a virtual dataset; `flat` makes (k n, 3) of a part's (k, n, 3)."""
    counts = [part.n_contact if source == "contacts" else part.n_frame for part in parts]
    rows, rest = (tail[0], tail[1:]) if tail and flat else (1, tail)
    if sum(counts) * rows == 0:
        group.create_dataset(name, (0, *rest), dtype)
        return
    layout = h5py.VirtualLayout((sum(counts) * rows, *rest), dtype)
    begin = 0
    for part, count in zip(parts, counts, strict=True):
        if count:
            layout[begin : begin + count * rows] = h5py.VirtualSource(
                folder + part.name, source, shape=(count, *tail), dtype=dtype
            )
            begin += count * rows
    group.create_virtual_dataset(name, layout)


def _share(group: h5py.Group, name: str, source: str, count: int, dtype: np.dtype[Any]) -> None:
    layout = h5py.VirtualLayout((count,), dtype)
    layout[:] = h5py.VirtualSource(f"{schema.PARTS}/{POINTS}", source, shape=(count,), dtype=dtype)
    group.create_virtual_dataset(name, layout)


def write_bed(path: Path, scenes: list[tuple[float, Scene]]) -> None:
    """Write fixed grains (points with a diameter), planes and walls (squares whose corners have diameter 0).

    A triangle of a wall is a square with two corners in one place. Walls stand where they are at that time.

    One frame per (time [s], scene); more than one if the timeline removed grains or planes.
    """

    def fill(file: h5py.File) -> None:
        _fill_bed(file, scenes)

    write_hdf5(path, fill)


def _fill_bed(file: h5py.File, scenes: list[tuple[float, Scene]]) -> None:
    root = _root(file)
    shown = [_bed_points(scene, t) for t, scene in scenes]
    n_points = np.array([len(points) for points, _, _, _ in shown], dtype=np.int64)
    n_verts = np.array([n_vert for _, _, _, n_vert in shown], dtype=np.int64)
    n_squares = (n_points - n_verts) // 4
    root["NumberOfPoints"] = n_points
    root["Points"] = np.concatenate([points for points, _, _, _ in shown])
    data = root.create_group("PointData")
    data["diameter"] = np.concatenate([d for _, d, _, _ in shown])
    data["id"] = np.concatenate([ids for _, _, ids, _ in shown])
    counts = {"Vertices": (n_verts, 1), "Polygons": (n_squares, 4)}
    for kind in _CELLS:
        cells = root.create_group(kind)
        count, width = counts.get(kind, (np.zeros_like(n_verts), 1))
        cells["NumberOfCells"], cells["NumberOfConnectivityIds"] = count, count * width
        first = np.zeros_like(n_verts) if kind == "Vertices" else n_verts
        pairs = list(zip(first, count * width, strict=True))
        cells["Connectivity"] = np.concatenate([np.arange(a, a + m, dtype=np.int64) for a, m in pairs])
        cells["Offsets"] = np.concatenate([np.arange(m + 1, dtype=np.int64) * width for m in count])
    steps = root.create_group("Steps")
    n_step = len(scenes)
    steps.attrs["NSteps"] = np.int64(n_step)
    steps["Values"] = np.array([t for t, _ in scenes])
    steps["PartOffsets"] = np.arange(n_step, dtype=np.int64)
    steps["NumberOfParts"] = np.ones(n_step, dtype=np.int64)
    steps["PointOffsets"] = _starts(n_points)
    zero = np.zeros(n_step, dtype=np.int64)
    steps["CellOffsets"] = np.stack([_starts(n_verts), zero, _starts(n_squares), zero], axis=1)
    steps["ConnectivityIdOffsets"] = np.stack([_starts(n_verts), zero, _starts(4 * n_squares), zero], axis=1)
    offsets = steps.create_group("PointDataOffsets")
    offsets["diameter"] = offsets["id"] = steps["PointOffsets"]


def _starts(counts: np.ndarray) -> np.ndarray:
    return np.concatenate([[0], np.cumsum(counts)[:-1]]).astype(np.int64)


def _bed_points(scene: Scene, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, int]:
    """Points, diameters and ids of the present bed, and how many of the points are grains."""
    there = np.asarray(scene.fixed_active, dtype=bool)
    x, d = np.asarray(scene.x_fixed).reshape(-1, 3)[there], np.asarray(scene.d_fixed)[there]
    ids = scene.n_grain + np.flatnonzero(there)
    corners = [_square(scene, int(k)) for k in np.flatnonzero(scene.plane_active)]
    plane_ids = scene.n_grain + scene.n_fixed + np.repeat(np.flatnonzero(scene.plane_active), 4)
    if scene.walls is not None:
        triangles, wall = triangles_of(scene.walls)
        there = scene.walls.active[wall]
        triangles = in_world(scene.walls, triangles, wall, t)[there]
        corners += list(triangles[:, [0, 1, 2, 2]])
        first = scene.n_partner - scene.n_face
        plane_ids = np.append(plane_ids, np.repeat(first + wall[there], 4))
    points = np.concatenate([x, *corners]) if corners else x
    return (
        points,
        np.append(d, np.zeros(4 * len(corners))),
        np.append(ids, plane_ids).astype(np.int64),
        len(x),
    )


def _square(scene: Scene, k: int) -> np.ndarray:
    """Corners of the square that stands for plane k, shape (4, 3)."""
    normal, point = np.asarray(scene.plane_normal[k]), np.asarray(scene.plane_point[k], dtype=np.float64)
    finite = [length for length in scene.period if np.isfinite(length)]
    d = np.concatenate([np.asarray(scene.d), np.asarray(scene.d_fixed)])
    half = max(finite) / 2 if finite else _PLANE_REACH * (float(d.max()) if len(d) else 1.0)
    side = across(normal)
    other = np.cross(normal, side)
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return np.array([point + half * (a * side + b * other) for a, b in signs])
