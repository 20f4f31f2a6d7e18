"""Grains along a row of columns: their volume in its segments, what passes its stations, where they rest."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.compiled.function import compiled
from ryusa.errors import ResultsError
from ryusa.laws.slices import sphere_slice
from ryusa.measure._run import Floats, Run
from ryusa.measure.slices_in_layers import CHUNK
from ryusa.model import ColumnRow
from ryusa.model.row import RowDam
from ryusa.printed import ByShape
from ryusa.results.water import WaterFrames
from ryusa.spelling import nearest_word

Ints = NDArray[np.int64]
SLOW = 0.1  # speed below which a grain rests, over sqrt(g d), as in `measure.entrainment`


@dataclass(frozen=True, repr=False)
class GrainsAlongRow(ByShape):
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
    B-splines (design/0027), and passes a station while its weights pass it. As in the water, what would go
    to cells within a dam beside it the segment of its centre takes. So, to round-off,
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
    solid, r, n = run.scene.solid_volume, 0.5 * run.scene.d, row.n_segment
    width = row.column.area / (n * row.dx)
    held, beyond = np.zeros((len(frames), n)), np.zeros((len(frames), len(row.x_station)))
    flux = np.zeros_like(beyond)
    for m, k in enumerate(frames.tolist()):
        x, v = np.asarray(run.frames.x[k]), np.asarray(run.frames.v[k])
        held[m], beyond[m] = _held(x, r, solid, row)
        flux[m] = _flux(x, v, r, solid, row)
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
    cell, past = _cell_of(x, row)
    t = past - 0.5
    weight = np.stack([0.5 * (0.5 - t) ** 2, 0.75 - t * t, 0.5 * (0.5 + t) ** 2], axis=1)
    at = cell[:, None] + np.array([-1, 0, 1])
    if not row.periodic:
        return np.clip(at, 0, n - 1), weight, np.zeros(at.shape)
    return at % n, weight, (at // n).astype(np.float64)


def _cell_of(x: Floats, row: ColumnRow) -> tuple[Ints, Floats]:
    """Segment of each centre, as in an endless row where it is periodic, and how far along it that is [-]."""
    s = (x - row.x_low) / row.dx
    if row.periodic:
        cell = np.floor(s)
    else:
        s = np.clip(s, 0.0, row.n_segment)
        cell = np.minimum(np.floor(s), row.n_segment - 1.0)
    return cell.astype(np.int64), s - cell


def _shut(at: Ints, row: ColumnRow) -> Ints:
    """Cells below which each segment of a grain is within a dam, shape (n, 3); 0 in that of its centre."""
    return np.where(at == at[:, 1:2], 0, row.cells_of_dams()[row.inner][at])


def _beside_dams(x: Floats, r: Floats, at: Ints, row: ColumnRow) -> tuple[Floats, Floats]:
    """Part of grains below the crest of a dam in each of their segments, and its decrease as they rise.

    Parameters
    ----------
    x : centres [m], shape (n, 3). r : radii [m]. at : segments, shape (n, 3).

    Returns
    -------
    below [-], per_rise [1/m] : shape (n, 3), 0 where there is no dam.
    """
    shut = _shut(at, row)
    below, per_rise = np.zeros(at.shape), np.zeros(at.shape)
    some = np.flatnonzero(shut.any(axis=1))
    if len(some):
        z, _ = _above_bottom(x[some], row)
        levels = shut[some] * row.column.dz - z[:, None]
        below[some], per_rise[some] = _below(levels, r[some], shut[some])
    return below, per_rise


def _shared(x: Floats, r: Floats, row: ColumnRow) -> tuple[Ints, Floats, Floats]:
    """As `segments_of`, but what would go to cells within a dam the segment of the centre takes.

    x : centres [m], shape (n, 3). r : radii [m].
    """
    at, weight, turn = segments_of(x[:, 0], row)
    below, _ = _beside_dams(x, r, at, row)
    part = weight * (1.0 - below)
    part[:, 1] += (weight * below).sum(axis=1)
    return at, part, turn


def _held(x: Floats, r: Floats, solid: Floats, row: ColumnRow) -> tuple[Floats, Floats]:
    """Volume in each segment, and beyond each station less a constant [m3], of grains at x; nan: away."""
    there = np.isfinite(x[:, 0])
    at, part, turn = _shared(x[there], r[there], row)
    parts = solid[there, None] * part
    held = _sums(at.ravel(), parts.ravel(), row.n_segment)
    before = np.concatenate([[0.0], np.cumsum(held)])
    if row.periodic:
        return held, float((parts * turn).sum()) - before[:-1]
    return held, before[-1] - before


def _flux(x: Floats, v: Floats, r: Floats, solid: Floats, row: ColumnRow) -> Floats:
    """Volume that passes each station by the speeds of the grains: its parts beyond it, derived [m4/s].

    What passes a station beside a dam is that above the crest, and what rises over the crest.
    """
    inside = np.isfinite(x[:, 0])
    if not row.periodic:
        inside &= (x[:, 0] >= row.x_low) & (x[:, 0] <= row.x_low + row.n_segment * row.dx)
    x, v, r, solid = x[inside], v[inside], r[inside], solid[inside]
    cell, past = _cell_of(x[:, 0], row)
    at, weight, _ = segments_of(x[:, 0], row)
    below, per_rise = _beside_dams(x, r, at, row)
    west, east = v[:, 0] * (1.0 - past) * (1.0 - below[:, 0]), v[:, 0] * past * (1.0 - below[:, 2])
    if per_rise.any():
        _, tilt = _above_bottom(x, row)
        rise = row.dx * (v[:, 2] - tilt * v[:, 0])
        west -= rise * weight[:, 0] * per_rise[:, 0]
        east += rise * weight[:, 2] * per_rise[:, 2]
    count = len(row.x_station)
    sums = _sums(cell % count, solid * west, count) + _sums((cell + 1) % count, solid * east, count)
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
    rows = run.passages
    rows = rows[(rows["step"] > steps[0]) & (rows["step"] <= steps[-1])]
    at, part, _ = _shared(rows["x"], 0.5 * rows["d"], row)
    into = np.zeros((len(steps), row.n_segment))
    amounts = (rows["way"] * volumes_of_heads(run)[rows["grain"]])[:, None] * part
    np.add.at(into, (np.searchsorted(steps, rows["step"])[:, None], at), amounts)
    into = np.cumsum(into, axis=0)
    before = np.concatenate([np.zeros((len(steps), 1)), np.cumsum(into, axis=1)], axis=1)
    return into, before[:, -1:] - before


def volumes_of_heads(run: Run) -> Floats:
    """Volume of the grain of each id [m3]; the first sphere of a clump has that of the clump."""
    scene = run.scene
    volume = scene.solid_volume
    if scene.bodies is not None:
        volume = volume.copy()
        volume[scene.bodies.first] = np.pi / 6.0 * scene.bodies.d**3
    return volume


def moving_in_row(run: Run, found: WaterFrames, k: int) -> Floats:
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
        z, _ = _above_bottom(x[some], row)
        r = 0.5 * scene.d[some]
        _cut(z, r, solid[some], at, weight, _shut(at, row), row.column.dz, sums)
    return sums / (row.column.area / row.n_segment * row.column.dz)


def _above_bottom(x: Floats, row: ColumnRow) -> tuple[Floats, Floats]:
    """Heights of points over the bottom [m], and its slope below them [-], by the weights of the segments."""
    bottom = row.bottom_with_ends()
    cell, past = _cell_of(x[:, 0], row)
    _, weight, _ = segments_of(x[:, 0], row)
    grows = np.stack([past - 1.0, 1.0 - 2.0 * past, past], axis=1) / row.dx
    at = cell[:, None] + np.array([-1, 0, 1])
    below = bottom[at % row.n_segment] if row.periodic else bottom[at + 1]
    return x[:, 2] - (weight * below).sum(axis=1), np.asarray((grows * below).sum(axis=1))


@compiled()
def _below(levels: Floats, r: Floats, shut: Ints) -> tuple[Floats, Floats]:
    """Part of spheres below levels from their centres [m], shape (n, 3), and its derivative by the level.

    Both are 0 where shut is 0.
    """
    below, grows = np.zeros(levels.shape), np.zeros(levels.shape)
    for i in range(len(r)):
        whole = sphere_slice(r[i], -r[i], r[i])
        for b in range(levels.shape[1]):
            if shut[i, b] > 0:
                level = min(max(levels[i, b], -r[i]), r[i])
                below[i, b] = sphere_slice(r[i], -r[i], level) / whole
                grows[i, b] = np.pi * (r[i] - level) * (r[i] + level) / whole
    return below, grows


@compiled()
def _cut(
    z: Floats, r: Floats, solid: Floats, at: Ints, weight: Floats, shut: Ints, dz: float, sums: Floats
) -> None:
    """Add the slices of grains to the cells of the segments, sums (n_segment, n) [m3].

    z : heights of the centres over the lowest face of the cells [m], shape (n,). solid : volume of matter
    over that of the sphere [-]. at, weight, shut : shape (n, 3).
    """
    n = sums.shape[1]
    for i in range(len(z)):
        low = int(np.floor(min(max((z[i] - r[i]) / dz, 0.0), n)))
        high = int(np.ceil(min(max((z[i] + r[i]) / dz, 0.0), n)))
        for k in range(low, high):
            part = solid[i] * sphere_slice(r[i], k * dz - z[i], (k + 1) * dz - z[i])
            for c in range(at.shape[1]):
                taken = at[i, c] if k >= shut[i, c] else at[i, 1]
                sums[taken, k] += weight[i, c] * part


def dam_named(row: ColumnRow, name: str | None) -> RowDam | None:
    """The dam of that name, without a name the one farthest upstream; None in a row without dams.

    Raises
    ------
    ResultsError : the row has no dam of that name.
    """
    dams = sorted(row.dams, key=lambda one: one.first)
    names = [one.name for one in dams]
    if name is not None and name not in names:
        there = f"the row has {', '.join(names)}" if names else "the row has none"
        near = nearest_word(name, tuple(names))
        raise ResultsError(f"no dam {name!r}: {there}" + (f". Did you mean {near!r}?" if near else ""))
    return dams[0 if name is None else names.index(name)] if dams else None
