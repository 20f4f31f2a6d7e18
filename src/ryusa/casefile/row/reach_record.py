"""What a periodic run over an even bed supplies: mean water over its bed, and grains that cross its end."""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ryusa.casefile.row.reach import FeederReach
from ryusa.errors import ResultsError
from ryusa.laws.families import BedKind
from ryusa.model.arrays import Floats
from ryusa.model.column import Column

if TYPE_CHECKING:
    from ryusa.results import Results
    from ryusa.results.water import WaterFrames

Ints = NDArray[np.int64]
LOOSE = 1.0 / 3.0  # of the packed concentration, from which grains are a bed: that of the inlet of a row
BLOCKS = 16  # equal parts of the record, whose means give the standard error of their mean
FEWEST = 2 * BLOCKS + 1  # frames


def supplied(run: "Results") -> FeederReach:
    """Water and grains that a run supplies from its settling time to its last frame.

    Raises
    ------
    ResultsError : it is no finished run of single grains in a periodic row over a moving bed, its record is
        too short, no grain crosses its end, or its mean flow does not run downstream over the bed.

    Notes
    -----
    Between two frames a grain is taken to move evenly: from its unwrapped centres, the time at which it
    crosses the downstream end of the period, its place across and its height, speed and spin are found by
    linear interpolation. The height of a grain in flight is then too small by at most g dt^2/8 between frames
    dt apart. A crossing upstream and one downstream of the same grain that follow one another count as none.
    """
    from ryusa.results import schema

    scene, row = run.scene, run.scene.row
    if row is None or not row.periodic or row.column.bed is not BedKind.MOVING:
        raise ResultsError("must be a run of a periodic row ([water.row] without ends) over a moving bed")
    if scene.bodies is not None or scene.materials is not None:
        raise ResultsError("holds clumps or several materials, and must hold spheres of one material")
    if run.provenance.get("status") != schema.COMPLETE:
        raise ResultsError("is not finished; `ryusa resume` continues it")
    if len(run.scenes) > 1:
        raise ResultsError("its timeline changes the scene, and must leave it as it is")
    settle = float((run.case.get("record") or {}).get("settle") or 0.0)
    frames = np.flatnonzero(run.frames.t >= settle - 1e-9)
    if len(frames) < FEWEST:
        raise ResultsError(
            f"has {len(frames)} frames from its record.settle of {settle:g} s on, and needs {FEWEST} or more"
        )
    water = run.row
    assert water is not None
    length, width = row.n_segment * row.dx, row.column.area / (row.n_segment * row.dx)
    t = np.asarray(run.frames.t, dtype=np.float64)[frames]
    bed = float(bed_lines(water.phi[frames].reshape(-1, row.column.n), row.column).mean())
    grains, moved, backwards = _crossings(run, frames, length, row.x_low)
    if not len(grains["t"]):
        raise ResultsError(f"no grain crosses the end of its period from {t[0]:g} to {t[-1]:g} s")
    z, u = _profile(water, frames, bed)
    over = z >= 0.0
    if not (u[over] > 0.0).all():
        raise ResultsError("its mean flow over the bed does not run downstream at every height")
    rates = moved / (width * length) / np.diff(t)
    parts = [float(one.mean()) for one in np.array_split(rates, BLOCKS)]
    across = grains["y"] if math.isinf(scene.period[1]) else grains["y"] % scene.period[1]
    return FeederReach(
        name=str(run.folder), begin=float(t[0]), end=float(t[-1]), length=length, width=width,
        side_walls=math.isinf(scene.period[1]), slope=math.atan2(row.column.g_x, row.g_z),
        frames=float(np.diff(t).max()),
        discharge=float((water.passed[frames[-1]] - water.passed[frames[0]]).mean() / (t[-1] - t[0])),
        in_bed=_share_below(water, frames, bed), bed=bed,
        depth=float((water.surface[frames] - row.bottom).mean()) - bed,
        z=z[over], u=u[over],
        solid_discharge=float(moved.sum() / (width * length) / (t[-1] - t[0])),
        error=float(np.std(parts, ddof=1) / math.sqrt(BLOCKS)), backwards=backwards,
        t=grains["t"] - t[0], y=across, height=grains["z"] - row.bottom[0] - bed, d=grains["d"],
        v=grains["v"], omega=grains["omega"], case=run.case,
    )  # fmt: skip


def bed_lines(phi: Floats, column: Column) -> Floats:
    """Thickness of the beds that lie on the lowest face of columns [m], shape (n_column,).

    phi : concentration [-], shape (n_column, n). The rule is that of the inlet of a row, `water.row_inlet`.
    """
    n, reach = column.n, 0.5 * column.d / column.dz - 0.5  # cells on either side, the last one partly
    mean = phi
    if reach > 0.0:
        apart = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
        full = math.floor(reach)
        part = np.where(apart <= full, 1.0, np.where(apart == full + 1, reach - full, 0.0))
        mean = phi @ (part / part.sum(axis=1, keepdims=True)).T
    least = LOOSE * column.phi_max
    top, goes_on = np.full(len(phi), -1), np.ones(len(phi), np.bool_)
    for k in range(n):
        dense = mean[:, k] >= least
        top = np.where(goes_on & dense, k, top)
        goes_on &= dense | ((k - top) * column.dz <= column.d)
    at, i = np.clip(top, 0, n - 2), np.arange(len(phi))
    here, above = mean[i, at], mean[i, at + 1]
    fall = np.where(here > above, here - above, 1.0)
    inner = (at + 0.5 + (here - least) / fall) * column.dz
    return np.where(top < 0, 0.0, np.where(top == n - 1, n * column.dz, inner))


def _profile(water: "WaterFrames", frames: Ints, bed: float) -> tuple[Floats, Floats]:
    """Heights of the middles of the cells over the bed line [m], and mean speeds there [m/s]."""
    column = water.row.column
    z = (np.arange(column.n) + 0.5) * column.dz - bed
    u = water.u[frames].mean(axis=(0, 1))
    return np.concatenate([[0.0], z]), np.concatenate([[float(np.interp(0.0, z, u))], u])


def _share_below(water: "WaterFrames", frames: Ints, bed: float) -> float:
    """Part of the discharge that passes below the bed line, by the means of speeds and water of cells [-]."""
    column = water.row.column
    passes = water.content[frames].mean(axis=(0, 1)) * water.u[frames].mean(axis=(0, 1))
    below = np.clip(bed / column.dz - np.arange(column.n), 0.0, 1.0)
    return float((below * passes).sum() / passes.sum())


def _crossings(
    run: "Results", frames: Ints, length: float, x_low: float
) -> tuple[dict[str, Floats], Floats, int]:
    """Grains that cross the downstream end of the period.

    Returns
    -------
    grains : t, y, z, d of shape (n,), v and omega (n, 3), in order of time.
    moved : sum over all grains of volume times way downstream between two frames [m4], (n_frame - 1,).
    backwards : crossings upstream that are left over.
    """
    held = run.frames[int(frames[0])]
    volume = run.scene.solid_volume
    rows: list[tuple[float, int, int, Floats]] = []  # time, grain, way, and the numbers of the grain
    moved = np.zeros(len(frames) - 1)
    for m, k in enumerate(frames[1:].tolist()):
        new = run.frames[k]
        moved[m] = float(volume @ (new.x[:, 0] - held.x[:, 0]))
        turns = [np.floor((one.x[:, 0] - x_low) / length).astype(np.int64) for one in (held, new)]
        for i in np.flatnonzero(turns[0] != turns[1]).tolist():
            first, last = int(turns[0][i]), int(turns[1][i])
            way = 1 if last > first else -1
            for level in range(first, last, way):
                at = x_low + (level + (way > 0)) * length
                part = (at - held.x[i, 0]) / (new.x[i, 0] - held.x[i, 0])
                both = [np.concatenate([one.x[i, 1:], one.v[i], one.omega[i]]) for one in (held, new)]
                rows.append((held.t + part * (new.t - held.t), i, way, both[0] + part * (both[1] - both[0])))
        held = new
    kept, backwards = _matched(rows)
    numbers = np.array([one[3] for one in kept]).reshape(-1, 8)
    t, ids = np.array([one[0] for one in kept]), np.array([one[1] for one in kept], np.int64)
    found = {
        "t": t, "d": run.scene.d[ids], "y": numbers[:, 0], "z": numbers[:, 1], "v": numbers[:, 2:5],
        "omega": numbers[:, 5:],
    }  # fmt: skip
    return found, moved, backwards


def _matched(
    rows: list[tuple[float, int, int, Floats]],
) -> tuple[list[tuple[float, int, int, Floats]], int]:
    """Crossings downstream that none upstream of the same grain undoes, and how many upstream are left."""
    open_ones: dict[int, list[tuple[float, int, int, Floats]]] = {}
    for row in sorted(rows, key=lambda one: (one[0], one[1])):
        mine = open_ones.setdefault(row[1], [])
        if mine and mine[-1][2] != row[2]:
            mine.pop()
        else:
            mine.append(row)
    left = [one for mine in open_ones.values() for one in mine]
    kept = sorted((one for one in left if one[2] > 0), key=lambda one: (one[0], one[1]))
    return kept, len(left) - len(kept)
