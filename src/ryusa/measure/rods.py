"""Rods: moving grains that stay in contact and keep their bearing, as one rigid body (fig22)."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.measure.statistics import Average, ratio
from ryusa.measure.table import Averaged, Averages
from ryusa.measure.transport import window_of
from ryusa.model import Scene
from ryusa.model.groups import groups
from ryusa.model.near_pairs import near_pairs
from ryusa.model.scene import Bools
from ryusa.printed import ByShape

LASTS = 5.0  # a window lasts so long, over sqrt(d/g)
WAY = 1.0  # a mover goes at least so far along the bed in it, over mean d
BEARING = math.radians(15.0)  # the direction from one grain to the other turns by less in it
GAP = 0.05  # two grains touch up to so large a gap, over the mean of both diameters
SHUFFLES = 10

Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Rod:
    """One rod: the grains that are in it from `begin` on [s], at least for a window."""

    begin: float
    grains: tuple[int, ...]


@dataclass(frozen=True)
class _Criteria:
    """Least displacement of a mover [m], largest turn of a bearing [rad], largest gap over the mean d [-]."""

    way: float
    bearing: float
    gap: float


@dataclass(frozen=True, repr=False)
class _Seen(ByShape):
    """Movers of one window: centres (n_frame, n, 3) [m], pairs that touch at its begin, diameters, layers."""

    x: Floats
    pairs: Ints
    d: Floats
    layer: Ints


@dataclass(frozen=True, repr=False)
class Rods(Averaged):
    """Moving grains that keep contact and bearing throughout a window of time.

    Attributes
    ----------
    begin : of the windows [s], shape (n_window,); one follows the other.
    movers : grains that went far enough in each, shape (n_window,).
    touching : of these, grains that touch another mover as the window begins.
    bound : of these, grains that keep contact and bearing with one to its end: they are in a rod.
    lengths : how many rods of n grains there were in all windows, shape (longest + 1,); n is the index.
    null : movers in a rod if every mover had the displacement of one drawn at random from its layer and any
        window, mean of the shuffles, shape (n_window,).
    longest : the rod of the most grains, of several the first; None where there is none.
    window : how long a rod lasts at least [s].
    averages : shares of the movers, and the mean number of grains in a rod.
    """

    begin: Floats
    movers: Ints
    touching: Ints
    bound: Ints
    lengths: Ints
    null: Floats
    longest: Rod | None
    window: float
    averages: Averages

    @property
    def share(self) -> float:
        """Movers in rods over all movers [-]; nan where nothing moves."""
        whole = int(self.movers.sum())
        return float(self.bound.sum()) / whole if whole else math.nan

    @property
    def null_share(self) -> float:
        """The same for shuffled displacements [-]."""
        whole = int(self.movers.sum())
        return float(self.null.sum()) / whole if whole else math.nan

    @property
    def kept(self) -> float:
        """Movers in rods over movers that touched another when the window began [-]."""
        whole = int(self.touching.sum())
        return float(self.bound.sum()) / whole if whole else math.nan

    @property
    def mean_length(self) -> float:
        """Grains in a rod [-]; nan where there is none."""
        whole = int(self.lengths.sum())
        return float(self.lengths @ np.arange(len(self.lengths))) / whole if whole else math.nan

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per number of grains in a rod."""
        return [{"grains": n, "rods": int(count)} for n, count in enumerate(self.lengths.tolist()) if n > 1]


def rods(
    run: Run,
    begin: float | None = None,
    end: float = math.inf,
    window: float | None = None,
    way: float = WAY,
    bearing: float = BEARING,
    gap: float = GAP,
    shuffles: int = SHUFFLES,
    seed: int = 1,
) -> Rods:
    """Find rods in windows of time that follow one another.

    Parameters
    ----------
    run : a run folder, periodic along x.
    begin, end : where the windows lie [s]; `begin` defaults to the case's `record.settle`.
    window : how long a rod must last [s]; default 5 sqrt(d/g), rounded to whole frames.
    way : displacement along the bed in a window from which a grain is a mover, in mean diameters.
    bearing : the direction from one grain to the other turns by less than this [rad].
    gap : largest gap of two grains that touch, over the mean of their diameters.
    shuffles, seed : of the null model.

    Raises
    ------
    ResultsError : not one window fits in.

    Notes
    -----
    Two movers are bound where in every frame of the window they touch and the direction from one to the
    other is within `bearing` of that at its begin: they neither part nor roll or climb over each other. A rod
    is a cluster of movers that are bound one to the next. A rod that outlasts a window counts again in the
    next. A grain that climbs from one pocket of a bed of equal grains to the next turns by 60 degrees about
    the one below. The null model gives every mover its own place and the displacement of a mover drawn at
    random from all windows, whose mean height is in the same layer, one diameter thick: grains that move as
    grains of their height do, independently of each other.
    """
    t, first, _, scene, _ = window_of(run, begin, end, least=3)
    d = float(scene.d.mean())
    g = float(np.linalg.norm(scene.gravity))
    frame = float(t[-1] - t[0]) / (len(t) - 1)  # a frame comes with the first step after its time
    asked = LASTS * math.sqrt(d / g) if window is None else window
    n = max(round(asked / frame), 2)
    starts = np.arange(0, len(t) - n, n)
    if not len(starts):
        raise ResultsError(f"no window of {n * frame:.3g} s from t = {t[0]:g} s to {t[-1]:g} s")
    criteria = _Criteria(way * d, bearing, gap)
    movers, touching, bound = np.zeros((3, len(starts)), dtype=np.int64)
    found: list[Rod] = []
    seen: list[_Seen] = []
    for k, start in enumerate(starts.tolist()):
        x = np.asarray(run.frames.x[first + start : first + start + n + 1], dtype=np.float64)
        ids, one = _movers(x, scene, criteria)
        kept = one.pairs[_bound(one.x, one.pairs, one.d, scene, criteria)]
        movers[k], touching[k], bound[k] = len(ids), len(np.unique(one.pairs)), len(np.unique(kept))
        found += [Rod(float(t[start]), tuple(ids[group].tolist())) for group in _clusters(kept, len(ids))]
        seen.append(one)
    null = _null(seen, scene, criteria, shuffles, seed)
    sizes = np.array([len(one.grains) for one in found], dtype=np.int64)
    return Rods(
        begin=t[starts],
        movers=movers,
        touching=touching,
        bound=bound,
        lengths=np.bincount(sizes, minlength=2).astype(np.int64),
        null=null,
        longest=max(found, key=lambda one: len(one.grains), default=None),
        window=n * frame,
        averages=Averages(
            "rods",
            _shares(movers, touching, bound, null, (float(t[0]), float(t[-1]))),
            (
                f"a rod: moving grains that touch (gap below {gap:g} d) for {n * frame:.3g} s, travel "
                f"{way:g} d or more in it and turn about each other by less than "
                f"{math.degrees(bearing):.3g} deg; judged from {n + 1} frames in each of {len(starts)} "
                "windows",
            ),
        ),
    )


def _movers(x: Floats, scene: Scene, criteria: _Criteria) -> tuple[Ints, _Seen]:
    """Grains that move in one window with frames x (n_frame, n_grain, 3) [m], and their ids."""
    d = float(scene.d.mean())
    ids = np.flatnonzero(x[-1, :, 0] - x[0, :, 0] >= criteria.way)
    x = np.ascontiguousarray(x[:, ids])
    pairs = _pairs(x[0], scene.d[ids], scene, criteria.gap)
    layer = np.floor(x[:, :, 2].mean(axis=0) / d).astype(np.int64)
    return ids, _Seen(x, pairs, scene.d[ids], layer)


def _null(seen: Sequence[_Seen], scene: Scene, criteria: _Criteria, shuffles: int, seed: int) -> Floats:
    """Movers in rods in each window when displacements are shuffled, mean over the shuffles, (n_window,)."""
    rng = np.random.default_rng(seed)
    null = np.zeros(len(seen))
    for _ in range(shuffles):
        for k, x in enumerate(_shuffled(seen, rng)):
            one = seen[k]
            null[k] += len(np.unique(one.pairs[_bound(x, one.pairs, one.d, scene, criteria)]))
    return null / max(shuffles, 1)


def _shares(
    movers: Ints, touching: Ints, bound: Ints, null: Floats, window: tuple[float, float]
) -> tuple[Average, ...]:
    """Share of the movers in rods, the same of the null model, and the share of contacts that is kept."""
    every, touch, kept = ([one.astype(np.float64)] for one in (movers, touching, bound))
    return (
        ratio("share", "-", kept, every, window),
        ratio("null_share", "-", [null], every, window),
        ratio("kept", "-", kept, touch, window),
    )


def companions(run: Run, begin: float | None = None, end: float = math.inf, gap: float = GAP) -> float:
    """Correlation of the speeds along the bed of grains that touch, over their layer's mean [-].

    1 where neighbours move together, 0 where they are independent, below 0 where they have just collided.
    The mean that is subtracted is that of all grains and frames whose centres lie in the same layer, half a
    diameter thick. nan where nothing touches.
    """
    t, first, last, scene, _ = window_of(run, begin, end, least=2)
    d = float(scene.d.mean())
    x = np.asarray(run.frames.x[first:last], dtype=np.float64)
    v = np.asarray(run.frames.v[first:last], dtype=np.float64)[:, :, 0]
    layer = np.floor(x[:, :, 2] / (0.5 * d)).astype(np.int64)
    layer -= layer.min()
    count = np.bincount(layer.ravel())
    mean = np.bincount(layer.ravel(), v.ravel()) / np.maximum(count, 1)
    about = v - mean[layer]
    products, squares = 0.0, 0.0
    for f in range(len(t)):
        i, j = _pairs(x[f], scene.d, scene, gap).T
        products += float(about[f, i] @ about[f, j])
        squares += 0.5 * float(about[f, i] @ about[f, i] + about[f, j] @ about[f, j])
    return products / squares if squares > 0.0 else math.nan


def _pairs(x: Floats, d: Floats, scene: Scene, gap: float) -> Ints:
    """Pairs of grains at x [m] that touch, (n_pair, 2)."""
    if len(x) < 2:
        return np.zeros((0, 2), dtype=np.int64)
    periods = [p if math.isfinite(p) else 0.0 for p in scene.period] + [0.0]
    inside = x.copy()
    for axis, period in enumerate(periods):
        if period > 0.0:
            inside[:, axis] = np.mod(x[:, axis], period)
            inside[inside[:, axis] >= period, axis] = 0.0  # round-off
    pairs = near_pairs(inside, d, np.array(periods), share=gap).astype(np.int64)
    apart = np.linalg.norm(_between(x, pairs, scene), axis=-1)
    pairs = pairs[apart <= 0.5 * (1.0 + gap) * (d[pairs[:, 0]] + d[pairs[:, 1]])]
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]


def _between(x: Floats, pairs: Ints, scene: Scene) -> Floats:
    """Way from one centre to the nearest image of the other [m], (..., n_pair, 3)."""
    way = x[..., pairs[:, 1], :] - x[..., pairs[:, 0], :]
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            way[..., axis] -= period * np.rint(way[..., axis] / period)
    return way


def _bound(x: Floats, pairs: Ints, d: Floats, scene: Scene, criteria: _Criteria) -> Bools:
    """Whether pairs keep contact and bearing in all frames of x (n_frame, n, 3), shape (n_pair,)."""
    way = _between(x, pairs, scene)
    apart = np.linalg.norm(way, axis=2)
    touch = apart <= 0.5 * (1.0 + criteria.gap) * (d[pairs[:, 0]] + d[pairs[:, 1]])
    along = np.einsum("fpc,pc->fp", way, way[0]) / np.maximum(apart * apart[0], 1.0e-300)
    return np.asarray((touch & (along > math.cos(criteria.bearing))).all(axis=0))


def _clusters(pairs: Ints, n: int) -> Iterator[Ints]:
    """Give the grains of every cluster of bound pairs among n grains."""
    if not len(pairs):
        return
    label = groups(pairs, n)
    for one in np.unique(label[pairs[:, 0]]):
        yield np.flatnonzero(label == one)


def _shuffled(seen: Sequence[_Seen], rng: np.random.Generator) -> Iterator[Floats]:
    """Centres in every window once its movers go ways picked from their layer in any window."""
    ways = np.concatenate([one.x - one.x[:1] for one in seen], axis=1)
    layers = np.concatenate([one.layer for one in seen])
    pools = {int(layer): np.flatnonzero(layers == layer) for layer in np.unique(layers)}
    for one in seen:
        taken = np.array([rng.choice(pools[int(layer)]) for layer in one.layer], dtype=np.int64)
        yield one.x[:1] + ways[:, taken]
