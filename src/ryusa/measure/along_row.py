"""Grains along a row of columns: their volume in its segments, what passes its stations, where they rest."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.laws._law import law
from ryusa.laws.slices import sphere_slice
from ryusa.measure._run import Floats, Run
from ryusa.measure.profiles import CHUNK
from ryusa.model import ColumnRow
from ryusa.model.traffic import IN, OUT
from ryusa.results.row import RowFrames

Ints = NDArray[np.int64]
SLOW = 0.1  # speed below which a grain rests, over sqrt(g d), as in `measure.entrainment`


@dataclass(frozen=True)
class GrainsAlongRow:
    """Free grains of a row of columns at some frames, per width.

    Attributes
    ----------
    width : of the bed [m].
    volume : of the grains in a segment, per area [m], shape (n_frame, n_segment).
    passed : volume that has passed a station since the first frame [m2], shape (n_frame, n_station).
    fed : volume that feeds have brought within a segment since then, less what exits have taken [m2],
        shape (n_frame, n_segment).
    flux : volume that passes a station by the speeds of the grains at a frame [m2/s], (n_frame, n_station).

    Notes
    -----
    A grain is shared between three segments by the weights with which it acts on their water, quadratic
    B-splines (design/0027), and passes a station while its weights pass it. So, to round-off,
    dx (volume - volume at the first frame) = passed[:, :-1] - passed[:, 1:] + fed. In a row with ends what
    feeds bring and exits take in the first and the last segment counts as passing the end.
    """

    width: float
    volume: Floats
    passed: Floats
    fed: Floats
    flux: Floats


def grains_along_row(run: Run, row: ColumnRow, frames: Ints) -> GrainsAlongRow:
    """Volume of the free grains in the segments of a row, and what has passed its stations.

    Parameters
    ----------
    run : its water is the row.
    frames : numbers of the frames, ascending.

    Raises
    ------
    ResultsError : grains enter or leave a periodic row, where the turns that they made are not known.
    """
    if run.scene.traffic is not None and row.periodic:
        raise ResultsError("what passes along a periodic row with feeds or exits is not recorded")
    solid, n = run.scene.solid_volume, row.n_segment
    width = row.column.area / (n * row.dx)
    held, beyond = np.zeros((len(frames), n)), np.zeros((len(frames), len(row.x_station)))
    flux = np.zeros_like(beyond)
    for m, k in enumerate(frames.tolist()):
        x, v = np.asarray(run.frames.x[k])[:, 0], np.asarray(run.frames.v[k])[:, 0]
        held[m], beyond[m] = _held(x, solid, row)
        flux[m] = _flux(x, solid * v, row)
    came, brought = _brought(run, row, np.asarray(run.frames.step)[frames] if run.scene.traffic else None)
    passed, fed = beyond - beyond[0] - brought, np.asarray(came)
    if not row.periodic:
        passed, fed = np.broadcast_to(passed, beyond.shape).copy(), np.broadcast_to(fed, held.shape).copy()
        passed[:, 0] += fed[:, 0]
        passed[:, -1] -= fed[:, -1] if n > 1 else 0.0
        fed[:, [0, -1]] = 0.0
    return GrainsAlongRow(
        width,
        held / (row.dx * width),
        passed / width,
        np.broadcast_to(fed, held.shape) / width,
        flux / (row.dx * width),
    )


def segments_of(x: Floats, row: ColumnRow) -> tuple[Ints, Floats, Floats]:
    """Segments that share each grain, with its weights, and the periods that it has crossed in each.

    Parameters
    ----------
    x : centres along the row, unwrapped [m], shape (n,).

    Returns
    -------
    at, weight : shape (n, 3).
    turn : whole numbers, shape (n, 3); 0 in a row with ends, where the last segment takes what lies beyond.
    """
    n = row.n_segment
    s = (x - row.x_low) / row.dx
    if not row.periodic:
        s = np.clip(s, 0.0, n)
    cell = np.floor(s)
    if not row.periodic:
        cell = np.minimum(cell, n - 1.0)
    t = s - cell - 0.5
    weight = np.stack([0.5 * (0.5 - t) ** 2, 0.75 - t * t, 0.5 * (0.5 + t) ** 2], axis=1)
    at = cell[:, None].astype(np.int64) + np.array([-1, 0, 1])
    if not row.periodic:
        return np.clip(at, 0, n - 1), weight, np.zeros(at.shape)
    return at % n, weight, (at // n).astype(np.float64)


def _held(x: Floats, solid: Floats, row: ColumnRow) -> tuple[Floats, Floats]:
    """Volume in each segment, and beyond each station less a constant [m3], of grains at x; nan: away."""
    there = np.isfinite(x)
    at, weight, turn = segments_of(x[there], row)
    parts = solid[there, None] * weight
    held = _sums(at.ravel(), parts.ravel(), row.n_segment)
    before = np.concatenate([[0.0], np.cumsum(held)])
    if row.periodic:
        return held, float((parts * turn).sum()) - before[:-1]
    return held, before[-1] - before


def _flux(x: Floats, carried: Floats, row: ColumnRow) -> Floats:
    """Volume times speed of the grains at each station, by the derivatives of the weights [m4/s]."""
    there = np.isfinite(x)
    s, n = (x[there] - row.x_low) / row.dx, row.n_segment
    inside = np.ones(len(s), np.bool_) if row.periodic else (s >= 0.0) & (s <= n)
    s, amount = s[inside], carried[there][inside]
    cell = np.floor(s) if row.periodic else np.minimum(np.floor(s), n - 1.0)
    past, at = s - cell, cell.astype(np.int64)
    count = len(row.x_station)
    sums = _sums(at % count, amount * (1.0 - past), count) + _sums((at + 1) % count, amount * past, count)
    if not row.periodic:
        sums[[0, -1]] *= 2.0  # half a segment
    return sums


def _sums(at: Ints, amounts: Floats, n: int) -> Floats:
    return np.asarray(np.bincount(at, amounts, n), dtype=np.float64)


def _brought(run: Run, row: ColumnRow, steps: Ints | None) -> tuple[Floats, Floats]:
    """What feeds brought less what exits took since the first frame: in the segments, beyond the stations.

    Returns
    -------
    Shapes (n_frame, n_segment) and (n_frame, n_station) [m3]; (1, ...) of zeros without feeds and exits.
    """
    if steps is None:
        return np.zeros((1, row.n_segment)), np.zeros((1, len(row.x_station)))
    rows = run.passages[run.passages["step"] > steps[0]]
    into, beyond = np.zeros((len(steps), row.n_segment)), np.zeros((len(steps), len(row.x_station)))
    volume = volumes_of_heads(run)
    for m in range(1, len(steps)):
        now = rows[(rows["step"] > steps[m - 1]) & (rows["step"] <= steps[m])]
        into[m], beyond[m] = into[m - 1], beyond[m - 1]
        for way in (IN, OUT):
            one = now[now["way"] == way]
            held, behind = _held(one["x"][:, 0], volume[one["grain"]], row)
            into[m] += way * held
            beyond[m] += way * behind
    return into, beyond


def volumes_of_heads(run: Run) -> Floats:
    """Volume of the grain of each id [m3]; the first sphere of a clump has that of the clump."""
    scene = run.scene
    volume = scene.solid_volume
    if scene.bodies is not None:
        volume = volume.copy()
        volume[scene.bodies.first] = np.pi / 6.0 * scene.bodies.d**3
    return volume


def moving_in_row(run: Run, found: RowFrames, k: int) -> Floats:
    """Concentration of the grains that move in frame k [-], shape (n_segment, n).

    A grain moves from a speed of 0.1 sqrt(g d) on, with the mean diameter, as in `measure.entrainment`.
    """
    row, scene = found.row, run.scene
    g = math.hypot(row.column.g_x, row.g_z)
    limit = SLOW * math.sqrt(g * scene.d_mean)
    v, x = np.asarray(run.frames.v[k]), np.asarray(run.frames.x[k])
    chosen = np.flatnonzero(np.isfinite(x[:, 0]) & (np.linalg.norm(v, axis=1) >= limit))
    sums = np.zeros((row.n_segment, row.column.n))
    solid = scene.solid_volume / (np.pi / 6.0 * scene.d**3)
    for first in range(0, len(chosen), CHUNK):
        some = chosen[first : first + CHUNK]
        at, weight, _ = segments_of(x[some, 0], row)
        z = x[some, 2] - _bottom_below(x[some, 0], row)
        _cut(z, 0.5 * scene.d[some], solid[some], at, weight, row.column.dz, sums)
    return sums / (row.column.area / row.n_segment * row.column.dz)


def _bottom_below(x: Floats, row: ColumnRow) -> Floats:
    """Height of the bottom below some points, by the weights of the segments [m]."""
    bottom = row.bottom_with_ends()
    s = (x - row.x_low) / row.dx
    n = row.n_segment
    s = s if row.periodic else np.clip(s, 0.0, n)
    cell = np.floor(s) if row.periodic else np.minimum(np.floor(s), n - 1.0)
    _, weight, _ = segments_of(x, row)
    at = cell[:, None].astype(np.int64) + np.array([-1, 0, 1])
    below = bottom[at % n] if row.periodic else bottom[at + 1]
    return np.asarray((weight * below).sum(axis=1))


@law  # for its compiler: a loop over arrays that calls laws
def _cut(z: Floats, r: Floats, solid: Floats, at: Ints, weight: Floats, dz: float, sums: Floats) -> None:
    """Add the slices of grains to the cells of the segments, sums (n_segment, n) [m3].

    z : heights of the centres over the lowest face of the cells [m], shape (n,). solid : volume of matter
    over that of the sphere [-]. at, weight : shape (n, 3).
    """
    n = sums.shape[1]
    for i in range(len(z)):
        low = min(max(int(np.floor((z[i] - r[i]) / dz)), 0), n - 1)
        high = min(max(int(np.floor((z[i] + r[i]) / dz)), 0), n - 1)
        for k in range(low, high + 1):
            a = -r[i] if k == low else k * dz - z[i]
            b = r[i] if k == high else (k + 1) * dz - z[i]
            part = solid[i] * sphere_slice(r[i], a, b)
            for c in range(at.shape[1]):
                sums[at[i, c], k] += weight[i, c] * part
