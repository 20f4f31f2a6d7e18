"""Grains that do not come to rest: how far each moves within short windows, as in the paper's fig10."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.table import lines
from ryusa.printed import ByShape

WINDOW = 0.01  # [s], that of fig10
LEAST = 10  # frames in a window; with fewer a vibration could fall between them
LATE = 0.25  # of the time between frames, by which one may miss its time: it waits for a whole step

ExtentRule = Literal["z", "path", "net"]


@dataclass(frozen=True, repr=False)
class Vibration(ByShape):
    """Motion of grains within windows that follow one another.

    Attributes
    ----------
    grains : ids, shape (n_grain,).
    d : their diameters [m], shape (n_grain,).
    d_mean : mean diameter of all free grains [m].
    begin, end : edges of the windows [s], shape (n_window,); the end of one is the begin of the next.
    window : length of a window [s].
    n_frame : frames in each window, both edges included, shape (n_window,).
    net : z at the end less z at the begin [m], the paper's "relative displacement"; (n_window, n_grain).
    span_z : largest less smallest z of all frames in the window [m], the same shape.
    span : twice the largest distance from the grain's mean place in the window, in x, y and z [m].
    turn : path of the surface of a grain that spins: largest |omega| d/2 times the window [m]; 0 where
        rotation is locked.
    """

    grains: NDArray[np.int64]
    d: Floats
    d_mean: float
    begin: Floats
    end: Floats
    window: float
    n_frame: NDArray[np.int64]
    net: Floats
    span_z: Floats
    span: Floats
    turn: Floats

    def diameters(self, count: float) -> float:
        """So many mean diameters as a threshold [m]."""
        return count * self.d_mean

    def extent(self, by: ExtentRule = "z") -> Floats:
        """What a threshold is held against [m], (n_window, n_grain): span_z, span or the size of net."""
        return {"z": self.span_z, "path": self.span, "net": np.abs(self.net)}[by]

    def most_restless(self, count: int) -> list[int]:
        """Ids of the grains whose z spans most in the second half of the windows, the first ones first."""
        late = self.span_z[len(self.end) // 2 :].max(axis=0)
        return sorted(int(g) for g in self.grains[np.argsort(-late, kind="stable")[:count]])

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per window and grain."""
        columns = {
            "grain": self.grains, "begin_s": self.begin[:, None], "end_s": self.end[:, None],
            "net_m": self.net, "span_z_m": self.span_z, "span_m": self.span, "turn_m": self.turn,
        }  # fmt: skip
        return lines(columns)


@dataclass(frozen=True, repr=False)
class VibratingGrains(ByShape):
    """Grains that moved by more than a threshold within one window.

    Attributes
    ----------
    grains : their ids.
    share : their number over that of all measured grains [-].
    begin, end : the window [s].
    threshold : what they exceeded [m].
    """

    grains: NDArray[np.int64]
    share: float
    begin: float
    end: float
    threshold: float


def vibration(
    run: Run,
    window: float = WINDOW,
    begin: float = -math.inf,
    end: float = math.inf,
    grains: Sequence[int] | None = None,
) -> Vibration:
    """Motion of every grain within windows of a run.

    Parameters
    ----------
    run : a run folder.
    window : length of each window [s].
    begin, end : what of the run is cut into windows [s]; the first starts at the first frame in it. What is
        left over at the end is not measured.
    grains : ids of free grains; default all.

    Raises
    ------
    ResultsError : no whole window lies in it, or fewer than 10 frames fall into one.

    Notes
    -----
    The net displacement over 0.01 s hides a grain that comes back after a whole number of periods; the spans
    look at every frame between and do not.
    """
    scene, t = run.scene, np.asarray(run.frames.t, dtype=np.float64)
    gap = float(np.median(np.diff(t))) if len(t) > 1 else 0.0
    slack = LATE * gap
    first = int(np.searchsorted(t, begin - slack))
    last = min(end, float(t[-1])) if len(t) else -math.inf
    count = 0 if first == len(t) else max(math.floor((last - float(t[first]) + slack) / window), 0)
    if count == 0:
        raise ResultsError(f"no whole window of {window:g} s within the recorded {_extent(t, first, last)}")
    edges = float(t[first]) + window * np.arange(count + 1)
    near = np.clip(np.searchsorted(t, edges - 0.5 * gap), 0, len(t) - 1)
    frames = np.diff(near) + 1
    if frames.min() - 1 < LEAST:
        raise ResultsError(
            f"{frames.min() - 1} frames in a window of {window:g} s, {LEAST} needed to resolve a "
            f"vibration: record.frames = {window / LEAST:g} s or shorter, or a longer window"
        )
    ids = np.arange(scene.n_grain) if grains is None else np.asarray(grains, dtype=np.int64)
    shape = (count, len(ids))
    net, span_z, span, turn = np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape)
    radius = 0.5 * scene.d[ids]
    for k in range(count):  # one window at a time: a run may be larger than the memory
        rows = slice(int(near[k]), int(near[k + 1]) + 1)
        x = np.asarray(run.frames.x[rows], dtype=np.float64)[:, ids]
        omega = np.asarray(run.frames.omega[rows], dtype=np.float64)[:, ids]
        net[k] = x[-1, :, 2] - x[0, :, 2]
        span_z[k] = np.ptp(x[:, :, 2], axis=0)
        span[k] = 2.0 * np.linalg.norm(x - x.mean(axis=0), axis=2).max(axis=0)
        turn[k] = np.linalg.norm(omega, axis=2).max(axis=0) * radius * window
    return Vibration(
        grains=ids,
        d=scene.d[ids],
        d_mean=float(scene.d.mean()),
        begin=t[near[:-1]],
        end=t[near[1:]],
        window=window,
        n_frame=frames,
        net=net,
        span_z=span_z,
        span=span,
        turn=turn,
    )


def vibrating_grains(found: Vibration, t: float, threshold: float, by: ExtentRule = "z") -> VibratingGrains:
    """Grains that move by more than `threshold` within the window that ends at time t, or last before it.

    Parameters
    ----------
    found : `vibration`.
    t : [s]; before the end of the first window there is no answer (`ResultsError`).
    threshold : [m]; `found.diameters` gives one in diameters.
    by : "z" the span in z, "path" the span in all directions, "net" the net displacement in z.
    """
    k = int(np.searchsorted(found.end, t + 0.5 * found.window / found.n_frame[0], side="right")) - 1
    if k < 0:
        raise ResultsError(f"no window ends by t = {t:g} s; the first ends at {found.end[0]:g} s")
    over = found.extent(by)[k] > threshold
    share = float(over.mean()) if len(over) else 0.0
    return VibratingGrains(found.grains[over], share, float(found.begin[k]), float(found.end[k]), threshold)


def vibrating_share(found: Vibration, threshold: float, by: ExtentRule = "z") -> Floats:
    """Share of grains that move by more than `threshold` [m] in each window [-], shape (n_window,)."""
    over = found.extent(by) > threshold
    return over.mean(axis=1) if over.shape[1] else np.zeros(len(over))


def rest_time(found: Vibration, threshold: float, by: ExtentRule = "z") -> float:
    """First time after which no grain moves by more than `threshold` [m] in a window [s]; nan if never.

    It is known no better than to one window. A grain that rolls along the bed does not rest by "path".
    """
    busy = np.flatnonzero((found.extent(by) > threshold).any(axis=1))
    if len(busy) == 0:
        return float(found.begin[0])
    return float(found.end[busy[-1]]) if busy[-1] + 1 < len(found.end) else math.nan


def _extent(t: Floats, first: int, last: float) -> str:
    return "nothing" if first >= len(t) else f"{float(t[first]):.4g} .. {max(last, float(t[first])):.4g} s"
