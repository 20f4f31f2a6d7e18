"""Shape of grain paths in a flow: advance, vertical range, reversals; contacts with bed and moving grains."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ryusa.compiled.function import compiled
from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, crest_of, settle_time
from ryusa.measure.snapshot import scene_at
from ryusa.measure.statistics import average, ratio
from ryusa.measure.table import Averaged, Averages, lines
from ryusa.model import Scene
from ryusa.model.scene import EventRule

WINDOW = 1.0  # [s], that of fig16
THRESHOLD = 0.02  # vertical excursion that counts, in diameters of the grain
REACH = 0.5  # a grain is at the bed while its centre is lower than the crest and so many of its diameters
AWAY = 1.0  # and has left it once it is higher than the crest and so many
LEAST = 10  # frames in a window
ROUND_OFF = 1.0e-6  # of a window, by which a frame may miss its edge

Ints = NDArray[np.int64]
TurnRule = Literal["contacts", "heights"]


@dataclass(frozen=True, repr=False)
class Paths(Averaged):
    """Paths of grains within consecutive windows; arrays are (n_window, n_grain).

    Attributes
    ----------
    grains : ids, shape (n_grain,).
    d : their diameters [m], shape (n_grain,).
    begin, end : edges of the windows [s], shape (n_window,).
    threshold : vertical excursion from which a turn counts, in diameters of the grain [-].
    crest : height of the top of the highest fixed grain above the datum [m].
    advance : displacement along the bed from begin to end [m].
    range_z : highest less lowest centre [m].
    reversals : turns of the vertical motion per second [1/s].
    way_z : sum of the heights gained and lost between those turns [m].
    above_crest : mean height of the centre above that crest [m].
    near : share of time in which the centre is lower than crest + 0.5 d [-].
    averages : means over grains and windows.
    """

    grains: Ints
    d: Floats
    begin: Floats
    end: Floats
    threshold: float
    crest: float
    advance: Floats
    range_z: Floats
    reversals: Floats
    way_z: Floats
    above_crest: Floats
    near: Floats
    averages: Averages

    @property
    def jaggedness(self) -> Floats:
        """Vertical way over advance [-], (n_window, n_grain); nan for a grain that did not advance."""
        found = np.full(self.advance.shape, math.nan)
        ahead = self.advance > 0.0
        found[ahead] = self.way_z[ahead] / self.advance[ahead]
        return found

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per window and grain."""
        columns = {
            "grain": self.grains, "begin_s": self.begin[:, None], "end_s": self.end[:, None], "d_m": self.d,
            "advance_m": self.advance, "range_z_m": self.range_z, "reversals_per_s": self.reversals,
            "way_z_m": self.way_z, "jaggedness": self.jaggedness, "above_crest_m": self.above_crest,
            "near": self.near,
        }  # fmt: skip
        return lines(columns)


@dataclass(frozen=True)
class Alternating:
    """Grains that alternate between the fixed bed and moving grains, most changes first.

    Attributes
    ----------
    grains : ids.
    turns : changes from bed to moving grains or back, one per grain.
    by : "contacts" where they were recorded; else "heights".
    """

    grains: Ints
    turns: Ints
    by: TurnRule


def paths(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    window: float = WINDOW,
    grains: Sequence[int] | None = None,
    threshold: float = THRESHOLD,
) -> Paths:
    """Advance, vertical range, reversals and jaggedness of the path of every grain.

    Parameters
    ----------
    run : a run folder.
    begin, end : what of the run is cut into windows [s]; `begin` defaults to the case's `record.settle`. What
        is left over at the end is not measured.
    window : length of each window [s].
    grains : ids of free grains; default all.
    threshold : a turn of the vertical motion counts once the grain has come back by more than so many of its
        diameters; smaller oscillations count neither as turns nor as vertical path.

    Raises
    ------
    ResultsError : no whole window lies in it, or fewer than 10 frames fall into one.

    Notes
    -----
    Paths are those of the recorded frames: motion between two of them is not resolved. Compare runs
    with the same frame interval and the same threshold only. The crest is the top of the highest fixed grain.
    Averages are over grains, each window of each grain a sample; grains of one flow collide with each other,
    so that their standard error is a lower bound. Jaggedness is the sum of vertical paths over the sum of
    advances.
    """
    since = settle_time(run) if begin is None else begin
    t = np.asarray(run.frames.t, dtype=np.float64)
    scene = scene_at(run, since)
    ids = np.arange(scene.n_grain) if grains is None else np.asarray(list(grains), dtype=np.int64)
    first, edges = _windows(t, since, end, window)
    d, crest, count = scene.d[ids], crest_of(scene), len(edges) - 1
    advance, range_z, turns, way, height, near = (np.zeros((count, len(ids))) for _ in range(6))
    spans = t[first[1:]] - t[first[:-1]]
    for k in range(count):
        rows = slice(int(first[k]), int(first[k + 1]) + 1)
        x = np.asarray(run.frames.x[rows], dtype=np.float64)[:, ids]
        z = np.ascontiguousarray(x[:, :, 2])
        advance[k] = x[-1, :, 0] - x[0, :, 0]
        range_z[k] = z.max(axis=0) - z.min(axis=0)
        _zigzag(z, threshold * d, turns[k], way[k])
        height[k] = z.mean(axis=0) - crest
        near[k] = (z < crest + REACH * d).mean(axis=0)
    reversals = turns / spans[:, None]
    return Paths(
        grains=ids,
        d=d,
        begin=edges[:-1],
        end=edges[1:],
        threshold=threshold,
        crest=crest,
        advance=advance,
        range_z=range_z,
        reversals=reversals,
        way_z=way,
        above_crest=height,
        near=near,
        averages=_averages(
            advance, range_z, reversals, way, height, near, (float(edges[0]), float(edges[-1]))
        ),
    )


def alternating(
    run: Run, begin: float | None = None, end: float = math.inf, turns: int = 2, by: TurnRule | None = None
) -> Alternating:
    """Grains that touch the fixed bed and moving grains alternately within a window.

    Parameters
    ----------
    run : a run folder.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    turns : least number of changes from bed to moving grains or back.
    by : "contacts", as they began one after another, or "heights": at the bed below crest + 0.5 d, away from
        it above crest + d, in between as before. Default contacts where the run recorded them; of a run that
        recorded tracked grains, those only.

    Notes
    -----
    Bed is a fixed grain or a plane that faces upwards. Contacts still open when the run ended are not known.
    """
    since = settle_time(run) if begin is None else begin
    scene = scene_at(run, since)
    way: TurnRule = by or ("heights" if scene.events == EventRule.NONE else "contacts")
    found = (_turns_of_contacts if way == "contacts" else _turns_of_heights)(run, scene, since, end)
    if way == "contacts" and scene.events == EventRule.TRACKED:
        found = np.where(scene.tracked, found, 0)
    order = np.argsort(-found, kind="stable")
    order = order[found[order] >= turns]
    return Alternating(order, found[order], way)


@compiled()
def _zigzag(z: Floats, threshold: Floats, turns: Floats, way: Floats) -> None:
    """Count turns that a way back by more than the threshold confirms, and the heights between them.

    z : (n_frame, n_grain) [m]; threshold : (n_grain,) [m]. turns, way : (n_grain,), written.
    """
    for g in range(z.shape[1]):
        low = high = last = z[0, g]  # last: height of the last turn
        rising, falling, count, total = False, False, 0.0, 0.0
        for f in range(z.shape[0]):
            now = z[f, g]
            low, high = min(low, now), max(high, now)
            if not falling and high - now > threshold[g]:  # it turned at `high`
                if rising:
                    count, total = count + 1.0, total + high - last
                rising, falling, last, low = False, True, high, now
            elif not rising and now - low > threshold[g]:
                if falling:
                    count, total = count + 1.0, total + last - low
                rising, falling, last, high = True, False, low, now
        turns[g] = count
        way[g] = total + (high - last if rising else last - low if falling else 0.0)


def _windows(t: Floats, begin: float, end: float, window: float) -> tuple[Ints, Floats]:
    """Frames at the edges of the windows, and the edges [s]."""
    slack = ROUND_OFF * window
    start = int(np.searchsorted(t, begin - slack))
    last = min(end, float(t[-1])) if len(t) else -math.inf
    count = 0 if start == len(t) else max(math.floor((last - float(t[start]) + slack) / window), 0)
    if count == 0:
        raise ResultsError(f"no whole window of {window:g} s from t = {begin:g} s to {last:.4g} s")
    edges = float(t[start]) + window * np.arange(count + 1, dtype=np.float64)
    gap = float(np.median(np.diff(t[start:])))  # a frame comes with the first step after its time
    first = np.clip(np.searchsorted(t, edges - max(0.5 * gap, slack)), 0, len(t) - 1).astype(np.int64)
    if int(np.diff(first).min()) < LEAST:
        raise ResultsError(f"{np.diff(first).min()} frames in a window of {window:g} s, {LEAST} needed")
    return first, edges


def _averages(
    advance: Floats, range_z: Floats, reversals: Floats, way: Floats, height: Floats, near: Floats,
    window: tuple[float, float],
) -> Averages:  # fmt: skip
    named = (
        ("advance", "m", advance),
        ("range_z", "m", range_z),
        ("reversals", "1/s", reversals),
        ("above_crest", "m", height),
        ("near_bed", "-", near),
    )
    items = [average(name, unit, list(values.T), window) for name, unit, values in named]
    return Averages(
        "paths",
        (*items, ratio("jaggedness", "-", list(way.T), list(advance.T), window)),
        ("errors are lower bounds: grains of one flow collide with each other",),
    )


def _turns_of_contacts(run: Run, scene: Scene, begin: float, end: float) -> Ints:
    events = run.contacts
    events = events[(events["t_part"] >= begin) & (events["t_begin"] <= end)]
    n, planes = scene.n_grain, scene.n_grain + scene.n_fixed
    i, j = events["i"], events["j"]
    upward = np.concatenate([np.ones(planes, dtype=np.bool_), scene.plane_normal[:, 2] > 0.5])
    upward = np.concatenate([upward, np.zeros(scene.n_face, dtype=np.bool_)])
    mover, bed = j < n, (j >= n) & upward[j]
    grain = np.concatenate([i[bed], i[mover], j[mover]])
    among = np.concatenate([np.zeros(bed.sum()), np.ones(2 * mover.sum())])
    since = np.concatenate([events["t_begin"][bed], *[events["t_begin"][mover]] * 2])
    order = np.lexsort((since, grain))
    grain, among = grain[order], among[order]
    change = (grain[1:] == grain[:-1]) & (among[1:] != among[:-1])
    return np.bincount(grain[1:][change], minlength=n).astype(np.int64)


def _turns_of_heights(run: Run, scene: Scene, begin: float, end: float) -> Ints:
    t = np.asarray(run.frames.t, dtype=np.float64)
    rows = slice(int(np.searchsorted(t, begin, "left")), int(np.searchsorted(t, end, "right")))
    z = np.asarray(run.frames.x[rows], dtype=np.float64)[:, :, 2]
    over = z - crest_of(scene)
    state = np.where(over < REACH * scene.d, -1, np.where(over > AWAY * scene.d, 1, 0))
    known = np.maximum.accumulate(np.where(state != 0, np.arange(len(z))[:, None], 0), axis=0)
    state = np.take_along_axis(state, known, axis=0)
    change = (state[1:] != state[:-1]) & (state[:-1] != 0)
    return change.sum(axis=0).astype(np.int64)
