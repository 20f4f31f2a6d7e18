"""The feeder reach of a river, from the run that its case names or from what its own run folder keeps."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.files import inside
from ryusa.casefile.row.reach import END, KEY, FeederReach, digest_of
from ryusa.casefile.row.reach_record import supplied
from ryusa.casefile.row.schema import RowSection
from ryusa.errors import CaseError, ResultsError
from ryusa.model.arrays import Floats

_SHIFT = 0x5245  # tells the lateral shifts from other numbers drawn from the seed


def run_of_reach(row: RowSection | None) -> str | None:
    """Run folder of the feeder reach at the upper end of the row of a case; None without one."""
    end = None if row is None else row.upstream
    return end.run if end is not None and end.end == END else None


def fed_by_reach(row: RowSection | None) -> bool:
    """Whether a feeder reach supplies the upper end of the row of a case."""
    return run_of_reach(row) is not None


def reach_of(case: Case) -> FeederReach | None:
    """The feeder reach of a case; None without one.

    Raises
    ------
    CaseError : it cannot be read, or supplies nothing.
    """
    name = run_of_reach(case.row)
    if name is None:
        return None
    from ryusa.results import schema

    folder, path = case.folder, inside(case.folder, KEY, name)
    kept = folder / schema.REACH
    if schema.is_run_folder(folder) and kept.is_file() and not kept.is_symlink():
        return _kept(kept, name, kept.stat().st_mtime_ns)
    try:
        changed = (path / schema.PROVENANCE).stat().st_mtime_ns
    except OSError:
        raise CaseError(
            KEY, name, f"no such run folder in the folder of the case, {folder}: run the reach first"
        ) from None
    return _read(path, name, changed)


@lru_cache(maxsize=2)
def _read(path: Path, name: str, _changed: int) -> FeederReach:
    """What a run supplies."""
    from ryusa.results import Results

    try:
        return replace(supplied(Results.open(path)), name=name)
    except ResultsError as error:
        raise CaseError(KEY, name, str(error)) from None


@lru_cache(maxsize=2)
def _kept(path: Path, name: str, _changed: int) -> FeederReach:
    """What the run folder of a river keeps of its reach."""
    from ryusa.results import schema
    from ryusa.results.read import read_json

    content = path.read_bytes()
    said = read_json(path.parent / schema.PROVENANCE).get("feeder_reach")
    digest = said.get("sha256") if isinstance(said, dict) else None
    if digest is not None and digest != digest_of(content):
        raise CaseError(KEY, name, f"{path.name} in the run folder has changed since the run began")
    try:
        return FeederReach.from_bytes(content)
    except ValueError as error:
        raise CaseError(KEY, name, f"{path.name} in the run folder is damaged ({error})") from None


@dataclass(frozen=True)
class Repeated:
    """Crossings of a reach repeated up to the end of a river's run; arrays as those of `FeederReach`."""

    t: Floats  # of the river [s]
    y: Floats
    which: np.ndarray  # number of the crossing in the record, shape (n,), int64


def repeated(case: Case, reach: FeederReach) -> Repeated:
    """When and where across each grain of a reach is due in a river.

    Notes
    -----
    The record begins at t = 0, and again after each of its lengths, up to stop.time. From the second time on
    all places across are shifted by a part of the width drawn from the seed, where the reach is periodic
    across, so that the grains do not come in the same tracks.
    """
    end = case.stop.time
    assert end is not None
    times, places, which = list[Floats](), list[Floats](), list[np.ndarray]()
    for turn in range(max(math.ceil(end / reach.duration), 1)):
        t = turn * reach.duration + reach.t
        some = np.flatnonzero(t < end)
        y = reach.y[some]
        if turn and not reach.side_walls:
            part = float(np.random.default_rng([case.seed, _SHIFT, turn]).random())
            y = (y + part * reach.width) % reach.width
        times.append(t[some])
        places.append(y)
        which.append(some)
    return Repeated(np.concatenate(times), np.concatenate(places), np.concatenate(which))


def fed_by_reach_in_all(case: Case) -> int:
    """Number of grains that a feeder reach brings; 0 without one."""
    reach, end = reach_of(case), case.stop.time
    if reach is None or end is None:
        return 0
    turns = math.floor(end / reach.duration)
    return sum(int((turn * reach.duration + reach.t < end).sum()) for turn in range(turns + 1))
