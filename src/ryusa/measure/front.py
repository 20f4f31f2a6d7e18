"""The front of the grains that have moved: where it is and how fast, over time."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import Average, ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model import Scene
from ryusa.model.arrays import Bools
from ryusa.model.feeds import IN, OUT, PASSAGE

FAR = 5.0  # distance from its first place from which a grain counts, in mean diameters
SHARE = 0.05  # of the volume, beyond the front


@dataclass(frozen=True, repr=False)
class Front(Averaged):
    """Front of the grains that have moved, at each frame; arrays of shape (n_frame,).

    Attributes
    ----------
    t : times of the frames [s].
    first : place of the first grain, the farthest downstream [m]; nan before any has moved.
    front : place beyond which 5 % of the volume of the grains that have moved is [m].
    moved : that volume, of grains that have left too [m3].
    averages : speeds of both over the window.
    """

    t: Floats
    first: Floats
    front: Floats
    moved: Floats
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One line for each frame; speeds are those since the frame before, nan at the first."""
        columns = {
            "t_s": self.t, "first_m": self.first, "front_m": self.front, "moved_m3": self.moved,
            "first_speed_m_per_s": _rate(self.first, self.t),
            "front_speed_m_per_s": _rate(self.front, self.t),
        }  # fmt: skip
        return lines(columns)


def front(run: Run, begin: float | None = None, end: float = math.inf) -> Front:
    """Place and speed of the front of the grains that have moved.

    Parameters
    ----------
    run : open along x.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.

    Raises
    ------
    ResultsError : a scene that is periodic along x, without free grains, or fewer than two frames.

    Notes
    -----
    A grain has moved that came in since the first frame of the window, or is farther than five mean diameters
    from where it was then, in any direction: grains of a bed over which the front has not gone do not count.
    One that has left counts where it left, and each sphere of a clump with its share of the volume. Two
    fronts are given, since single grains may run ahead: that of the first grain, and that beyond which 5 % of
    the volume is. Mean speeds are the way of a front over the time until it first is within a diameter of the
    farthest that it comes: not over the time in which it lies there or has left.
    """
    scene = run.scene
    if math.isfinite(float(scene.period[0])):
        raise ResultsError("the scene is periodic along x: a front needs one that is open")
    times = np.asarray(run.frames.t, dtype=np.float64)
    begin = settle_time(run) if begin is None else begin
    frames = np.flatnonzero((times >= begin) & (times <= end))
    if not scene.n_grain or len(frames) < 2:
        raise ResultsError(f"{len(frames)} frames of grains from {begin:g} to {end:g} s: needs two or more")
    t, solid, least = times[frames], scene.solid_volume, FAR * scene.d_mean
    start = np.asarray(run.frames.x[int(frames[0])], dtype=np.float64)
    left = np.full(start.shape, math.nan)  # where grains that are away left
    came = np.zeros(scene.n_grain, np.bool_)
    first, main, moved = np.full((3, len(t)), math.nan)
    passages = run.passages if scene.traffic is not None else np.zeros(0, PASSAGE)
    until = np.searchsorted(passages["step"], np.asarray(run.frames.step)[frames], side="right")
    for m, k in enumerate(frames.tolist()):
        if m:
            _note_passages(scene, passages[until[m - 1] : until[m]], came, left)
        x = np.asarray(run.frames.x[k], dtype=np.float64)
        x = np.where(np.isfinite(x), x, left)
        way = np.linalg.norm(x - start, axis=1)
        counted = np.isfinite(x[:, 0]) & (came | (way > least))
        moved[m] = solid[counted].sum()
        if counted.any():
            first[m], main[m] = x[counted, 0].max(), _beyond(x[counted, 0], solid[counted])
    window = (float(t[0]), float(t[-1]))
    known = np.isfinite(main)
    items: list[Average] = []
    for name, one in (("first", first), ("front", main)):
        way, at = one[known], t[known]
        on = 1 + int(np.argmax(way >= way.max(initial=-math.inf) - scene.d_mean)) if len(way) else 0
        items.append(ratio(f"{name}_speed", "m/s", [np.diff(way[:on])], [np.diff(at[:on])], window))
    note = f"at the end no grain has come in or is farther than {FAR:g} d from where it was"
    if known[-1]:
        note = (
            f"grains that came in or moved more than {FAR:g} d; the first of them, and the front beyond "
            f"which {SHARE:.0%} of their volume is, are at {first[-1]:.4g} m and {main[-1]:.4g} m at the end"
        )
    return Front(t, first, main, moved, Averages("front", tuple(items), (note,)))


def _note_passages(scene: Scene, rows: NDArray[np.void], came: Bools, left: Floats) -> None:
    """Mark the grains that came in between two frames, and note where others left."""
    for row in rows:
        spheres = scene.spheres_of(np.array([row["grain"]]))
        if row["way"] == IN:
            came[spheres] = True
        elif row["way"] == OUT:
            left[spheres] = row["x"]


def _beyond(x: Floats, volume: Floats) -> float:
    """Place beyond which a share of the volume is, that of one of the grains [m]."""
    order = np.argsort(-x)
    beyond = np.cumsum(volume[order])
    return float(x[order][np.searchsorted(beyond, SHARE * beyond[-1])])


def _rate(places: Floats, t: Floats) -> Floats:
    return np.concatenate([[math.nan], np.diff(places) / np.diff(t)])
