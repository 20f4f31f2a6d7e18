"""Loads on the dams of a row of columns: of the water, of the grains, and of both."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run, frames_between, settle_time
from ryusa.measure.statistics import Average, average
from ryusa.measure.table import Averaged, Averages
from ryusa.measure.walls import forces_of_frames
from ryusa.model.row import RowDam
from ryusa.results.row import RowFrames

SHARES = (0.95, 0.99)  # of the time in which a load stays below a percentile


@dataclass(frozen=True, repr=False)
class Loads(Averaged):
    """Loads on dams, for the whole width of the stream; means from frame to frame.

    Attributes
    ----------
    t : middle of the time between two frames [s], shape (n,).
    names : of the dams.
    width : of the stream [m].
    toe : x and z of the foot on the downstream side of each dam [m], shape (n_dam, 2).
    water, grains : force along x [N], force along z [N] and overturning moment [N m], positive where it turns
        the dam downstream about its toe, shape (n, n_dam, 3).
    height : at which the horizontal force of the water acts, over the toe [m], shape (n, n_dam); nan without
        such a force.
    window : averaging time of the largest load and its percentiles [s].
    averages : means with their errors, then largest loads and percentiles, and the impulse of the window.
    """

    t: Floats
    names: tuple[str, ...]
    width: float
    toe: Floats
    water: Floats
    grains: Floats
    height: Floats
    window: float
    averages: Averages

    @property
    def total(self) -> Floats:
        """Load of water and grains together, as `water`."""
        return self.water + self.grains

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per time between two frames and dam."""
        parts = {"water": self.water, "grains": self.grains, "total": self.total}
        return [
            {
                "t_s": float(t),
                "dam": name,
                **{
                    f"{part}_{what}": float(of[k, d, a])
                    for part, of in parts.items()
                    for a, what in enumerate(("force_x_N", "force_z_N", "overturning_Nm"))
                },
                "water_acts_at_m": float(self.height[k, d]),
                "total_force_x_N_per_m": float(self.total[k, d, 0] / self.width),
            }
            for k, t in enumerate(self.t)
            for d, name in enumerate(self.names)
        ]


def loads(run: Run, begin: float | None = None, end: float = math.inf, window: float | None = None) -> Loads:
    """Force and overturning moment of water and grains on the dams of a row of columns.

    Parameters
    ----------
    run : a run folder whose water is a row with dams.
    begin, end : window [s]; `begin` defaults to the case's `record.settle`.
    window : averaging time of the largest load [s]; default the time between two frames, the shortest there
        is.

    Raises
    ------
    ResultsError : no row, no dam that stops water, or fewer than two frames in the window.

    Notes
    -----
    The water stands against each face with the level of the segment beside it, at rest:
    p = rho g_z (surface - z); on the top of a dam lies the weight of the water over it. Neither the momentum
    of a bore or a jet that strikes, nor uplift below the foot, nor friction is in it. Grains in the water
    leave its pressure as it is: what they carry from grain to grain is in their own force on the dam. The
    forces of the grains are those of `measure.walls`, means of every step between two frames; grains act on
    a dam where it is a wall for them, by its name.
    """
    frames = run.row
    if not isinstance(frames, RowFrames):
        raise ResultsError("loads are those on dams in a row of columns; the run has no [water.row]")
    dams = [one for one in frames.row.dams if not one.porous]
    if not dams:
        seeping = ", ".join(one.name for one in frames.row.dams)
        raise ResultsError(
            f"no dam stops the water of the row{f': it seeps through {seeping}' if seeping else ''}"
        )
    since = settle_time(run) if begin is None else begin
    every = np.asarray(frames.t, dtype=np.float64)
    kept = frames_between(every, since, end)
    t, row = every[kept], frames.row
    width = row.column.area / (row.n_segment * row.dx)
    toe = np.array([(row.x_low + one.end * row.dx, row.bottom[one.end - 1]) for one in dams])
    at = np.array([width * water_on_dam(frames, one)[kept] for one in dams]).transpose(1, 0, 2)
    water = 0.5 * (at[1:] + at[:-1])
    grains, touched = _of_grains(run, dams, toe, kept, water.shape)
    pushed = water[:, :, 0] != 0.0
    height = np.full(pushed.shape, np.nan)
    np.divide(water[:, :, 3], water[:, :, 0], out=height, where=pushed)
    shortest = float(np.diff(t).max())
    span = shortest if window is None else max(window, shortest)
    items = _averages(dams, np.diff(t), (float(t[0]), float(t[-1])), water, grains, height, width, span)
    said = [
        f"for a width of {width:.4g} m; largest loads and percentiles are of means over {span:.3g} s",
        "water: hydrostatic, from the level beside each face; no blow of a bore, no uplift, no friction",
    ]
    said += [f"no grain acts on {name}: it is no wall for them" for name in sorted(touched)]
    return Loads(
        0.5 * (t[1:] + t[:-1]), tuple(one.name for one in dams), width, toe, water[:, :, :3], grains, height,
        span, Averages("loads", tuple(items), tuple(said)),
    )  # fmt: skip


def water_on_dam(frames: RowFrames, dam: RowDam) -> Floats:
    """Load of the water at rest on a dam at every frame, per width.

    Returns
    -------
    Force along x and along z [N/m], moment about the toe that turns the dam downstream, and the part of it by
    the horizontal force [N], shape (n_frame, 4).
    """
    row, surface, floor = frames.row, np.asarray(frames.surface), frames.floor
    weight, n = row.column.rho_w * row.g_z, row.n_segment
    x_toe, z_toe = row.x_low + dam.end * row.dx, float(row.bottom[dam.end - 1])
    found = np.zeros((len(surface), 4))
    for station in range(dam.first, dam.end + 1):
        left, right = station - 1, station
        if not row.periodic and (left < 0 or right >= n):
            continue  # an end of the row stands there
        left, right = left % n, right % n
        low, side, sign = (left, right, 1.0) if floor[right] > floor[left] else (right, left, -1.0)
        level, foot, top = surface[:, low], float(floor[low]), float(floor[side])
        wet = np.clip(level, foot, top) - foot  # height of the face under water
        force = weight * wet * (level - foot - 0.5 * wet)
        lever = (level - foot) * wet**2 / 2.0 - wet**3 / 3.0  # about the foot of the face
        moment = weight * lever + force * (foot - z_toe)
        found[:, 0] += sign * force
        found[:, 3] += sign * moment
    found[:, 2] = found[:, 3]
    for k in range(dam.first, dam.end):
        above = weight * np.maximum(surface[:, k] - floor[k], 0.0) * row.dx
        found[:, 1] -= above
        found[:, 2] += above * (row.x[k] - x_toe)
    return found


def _of_grains(
    run: Run, dams: list[RowDam], toe: Floats, kept: slice, shape: tuple[int, ...]
) -> tuple[Floats, set[str]]:
    """Load of the grains on each dam, and the dams that are no walls for them."""
    found = np.zeros((*shape[:2], 3))
    names = () if run.scene.walls is None else run.scene.walls.names
    missing = {one.name for one in dams} - set(names)
    if len(missing) == len(dams):
        return found, missing
    of = forces_of_frames(run, kept)  # their account is of a step earlier: times do not serve
    for d, one in enumerate(dams):
        if one.name in missing:
            continue
        w = of.names.index(one.name)
        force, arm = of.force[:, w], toe[d] - of.axis_point[w, [0, 2]]
        found[:, d, 0], found[:, d, 1] = force[:, 0], force[:, 2]
        found[:, d, 2] = of.torque[:, w, 1] - (arm[1] * force[:, 0] - arm[0] * force[:, 2])
    return found, missing


def _averages(
    dams: list[RowDam], dt: Floats, span: tuple[float, float], water: Floats, grains: Floats, height: Floats,
    width: float, window: float,
) -> list[Average]:  # fmt: skip
    """Means with errors, then what is largest, and the impulse."""
    items: list[Average] = []
    for d, one in enumerate(dams):
        both = water[:, d, :3] + grains[:, d]
        parts = [("water", water[:, d]), ("grains", grains[:, d]), ("both", both)]
        items += [average(f"{one.name}: force x, {name}", "N", [of[:, 0]], span) for name, of in parts]
        items.append(average(f"{one.name}: force x, both, by width", "N/m", [both[:, 0] / width], span))
        items.append(average(f"{one.name}: force z, both", "N", [both[:, 1]], span))
        items += [average(f"{one.name}: overturning, {name}", "N m", [of[:, 2]], span) for name, of in parts]
        items.append(average(f"{one.name}: water acts over the toe at", "m", [height[:, d]], span))
        over, turns = (running_mean(both[:, a], dt, window) for a in (0, 2))
        for share in SHARES:
            what = f"{one.name}: force x, both, {100.0 * share:g} % below"
            items.append(_one(what, "N", float(np.quantile(over, share)), span))
        items.append(_one(f"{one.name}: force x, both, largest", "N", float(over.max()), span))
        items.append(_one(f"{one.name}: force x, both, largest, by width", "N/m", over.max() / width, span))
        items.append(_one(f"{one.name}: overturning, both, largest", "N m", float(turns.max()), span))
        items.append(_one(f"{one.name}: impulse x, both", "N s", float(both[:, 0] @ dt), span))
    return items


def running_mean(values: Floats, dt: Floats, window: float) -> Floats:
    """Means over a time of a record of means over given times.

    Parameters
    ----------
    values : means over `dt` that follow one another.
    dt : their times [s].
    window : averaging time [s]; the whole record where that is shorter.

    >>> running_mean(np.array([0.0, 1.0, 0.0, 0.0]), np.ones(4), 2.0).tolist()
    [0.5, 0.5, 0.0]
    """
    at = np.concatenate([[0.0], np.cumsum(dt)])
    whole = np.concatenate([[0.0], np.cumsum(values * dt)])
    window = min(window, float(at[-1]))
    starts = at[at <= at[-1] - window * (1.0 - 1e-9)]
    return (np.interp(starts + window, at, whole) - np.interp(starts, at, whole)) / window


def _one(name: str, unit: str, value: float, span: tuple[float, float]) -> Average:
    """A number of the whole record, which has no error of a mean."""
    nan = math.nan
    return Average(name, unit, float(value), nan, 1, 0, nan, span, nan, nan, nan)
