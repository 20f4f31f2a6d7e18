"""A case cut short, to see whether it does what was meant: all its times shrink together."""

import math
from collections.abc import Sequence
from pathlib import Path

from ryusa.casefile.case import Case
from ryusa.casefile.feeds.values import sedigraph_points
from ryusa.casefile.read import read
from ryusa.casefile.row.ends import HYDROGRAPH, STAGE, hydrograph_points, stage_points
from ryusa.errors import CaseError
from ryusa.units import UnitError, quantity

LEAST_FRAMES = 10


def read_shortened(path: str | Path, overrides: dict[str, str], time: str) -> Case:
    """Read a case that ends at a time, whose timeline, feeds and settling keep their order within it.

    Parameters
    ----------
    path, overrides : as of `read`.
    time : simulated time at which it ends, such as "20 ms".

    Raises
    ------
    CaseError : as of `read`; not a time, or not shorter than stop.time.
    """
    try:
        end = quantity(time, "s")
    except UnitError as error:
        raise CaseError("--try", time, f"needs a time such as '20 ms': {error}") from None
    if not 0.0 < end < math.inf:
        raise CaseError("--try", time, "needs a time above 0, such as '20 ms'")
    whole = read(path, overrides)
    asked = whole.stop.time
    if asked is not None and end >= asked:
        raise CaseError("--try", time, f"must be shorter than stop.time, {asked:g} s: leave --try out")
    settle = whole.record.settle
    share = end / asked if asked is not None else min(0.5 * end / settle, 1.0) if settle else 1.0
    times = {
        "stop.time": end,
        "record.settle": settle * share,
        "record.frames": min(whole.record.frames, end / LEAST_FRAMES),
    }
    times |= {f"timeline.{k}.at": one.at * share for k, one in enumerate(whole.timeline)}
    for k, feed in enumerate(whole.feeds):
        if feed.sedigraph is None:
            times[f"feeds.{k}.begin"] = feed.begin * share
        if feed.end is not None:
            times[f"feeds.{k}.end"] = feed.end * share
    shorter = {key: f"'{one:.12g} s'" for key, one in times.items()}
    return read(path, overrides | shorter | _courses(whole, share))


def _courses(whole: Case, share: float) -> dict[str, str]:
    """Hydrograph, stage and sedigraphs whose times shrink, too, as points."""
    found: dict[str, str] = {}
    keys = whole.row
    if keys is not None and keys.upstream is not None and keys.upstream.hydrograph is not None:
        found[HYDROGRAPH] = _points(hydrograph_points(whole.folder, keys.upstream.hydrograph), share)
    if keys is not None and keys.downstream is not None and keys.downstream.stage is not None:
        points = stage_points(whole.folder, keys.downstream.stage)
        found[STAGE] = _points([(t, (z, "m")) for t, z in points], share)
    for k, feed in enumerate(whole.feeds):
        if feed.sedigraph is not None:
            found[f"feeds.{k}.sedigraph"] = _points(sedigraph_points(whole, feed), share)
    return found


def _points(points: Sequence[tuple[float, tuple[float, str]]], share: float) -> str:
    return "[" + ", ".join(f"['{t * share:.12g} s', '{y!r} {unit}']" for t, (y, unit) in points) + "]"
