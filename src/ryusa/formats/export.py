"""Frames of a run as a file of another program."""

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from ryusa.errors import CaseError, ResultsError
from ryusa.formats.csv import csv_frame, csv_head
from ryusa.formats.extxyz import xyz_frame
from ryusa.formats.grains import GrainTable, nearest_frame, table_of_frame
from ryusa.formats.lammps_dump import DUMP_HEAD, dump_frame
from ryusa.formats.parquet import need_pyarrow, write_parquet
from ryusa.formats.vtu import pvd_file, vtu_file
from ryusa.formats.writing import written
from ryusa.results import Results

FORMATS = ("lammps-dump", "extxyz", "vtu", "csv", "parquet")
_FRAMES: dict[str, Callable[[GrainTable], bytes]] = {
    "lammps-dump": dump_frame,
    "extxyz": xyz_frame,
    "vtu": vtu_file,
    "csv": csv_frame,
}
_HEADS: dict[str, Callable[[GrainTable], bytes]] = {  # what stands once, before the first frame
    "csv": csv_head,
    "lammps-dump": lambda _: DUMP_HEAD,
}
_BYTES_PER_ROW = 160  # of parquet, before it is compressed
_SPARE = 1.1  # the frame that is measured may be shorter than others


def export(
    run: Results,
    path: Path,
    to: str,
    *,
    at: float | None = None,
    begin: float = -np.inf,
    end: float = np.inf,
    every: int = 1,
    progress: Callable[[float], None] = lambda share: None,
) -> list[Path]:
    """Write frames of a run, with their fixed grains, in SI.

    Parameters
    ----------
    path : the file to write; for "vtu" a .pvd, with the frames in a folder of the same name beside it.
    to : one of `FORMATS`.
    at : time of the one frame to write, the nearest [s].
    begin, end : window of the frames to write [s].
    every : write every so many frames of the window.
    progress : called with the share that is done, 0 to 1.

    Returns
    -------
    paths : of the files written; the first is the one to open.

    Raises
    ------
    ResultsError : no frame lies in the window, or the disk is too small or refuses.
    """
    if to == "parquet":
        need_pyarrow()
    chosen = [nearest_frame(run, at)] if at is not None else _window(run, begin, end, every)
    _refuse_if_too_big(run, path, to, chosen)

    def tables() -> Iterator[GrainTable]:
        for count, k in enumerate(chosen):
            yield table_of_frame(run, k)
            progress((count + 1) / len(chosen))

    if to == "vtu":
        return _write_vtu(path, tables(), len(chosen))
    with written(path) as temporary:
        if to == "parquet":
            write_parquet(temporary, tables())
            return [path]
        with temporary.open("wb") as file:
            for count, table in enumerate(tables()):
                if to in _HEADS and count == 0:
                    file.write(_HEADS[to](table))
                file.write(_FRAMES[to](table))
    return [path]


def _window(run: Results, begin: float, end: float, every: int) -> list[int]:
    if every < 1:
        raise CaseError("--every", every, "must be at least 1")
    times = run.frames.t
    found = np.flatnonzero((times >= begin) & (times <= end))[::every].tolist()
    if not found:
        there = f"its frames are from {times[0]:g} to {times[-1]:g} s" if len(times) else "it has none yet"
        raise ResultsError(f"{run.folder}: no frame lies in the window; {there}")
    return found


def _refuse_if_too_big(run: Results, path: Path, to: str, chosen: list[int]) -> None:
    """Measure the last frame as it would be written, and compare with the free disk."""
    table = table_of_frame(run, chosen[-1])
    size = table.n * _BYTES_PER_ROW if to == "parquet" else len(_FRAMES[to](table))
    needed = _SPARE * size * len(chosen)
    place = next(one for one in path.absolute().parents if one.exists())
    free = shutil.disk_usage(place).free
    if needed > free:
        raise ResultsError(
            f"{path}: {len(chosen)} frames take about {needed / 1e9:.3g} GB, but only {free / 1e9:.3g} GB "
            "are free; take fewer frames with --every, --begin and --end"
        )


def _write_vtu(path: Path, tables: Iterator[GrainTable], n_frame: int) -> list[Path]:
    """Write the frames, then the list of them: who finds the .pvd finds every frame."""
    frames: list[tuple[float, str]] = []
    paths: list[Path] = []
    folder = path.with_suffix("")
    digits = max(len(str(n_frame - 1)), 4)
    for count, table in enumerate(tables):
        one = folder / f"{path.stem}-{count:0{digits}d}.vtu"
        with written(one) as temporary:
            temporary.write_bytes(vtu_file(table))
        frames.append((table.t, f"{folder.name}/{one.name}"))
        paths.append(one)
    with written(path) as temporary:
        temporary.write_bytes(pvd_file(frames))
    return [path, *paths]
