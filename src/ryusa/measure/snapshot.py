"""One moment of a run: where grains, bed and planes are, in one lane of a plane scene."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.measure._run import Floats, Run
from ryusa.model import Scene
from ryusa.model.wall_shape import in_world, lines_of, outlines_of, within_periods
from ryusa.printed import ByShape

UPRIGHT = 1.0e-6  # component along y up to which a plane shows as a line in the x-z plane
# Share of the values that a colour scale covers: a few fast grains would leave the others in one colour.
SHARE = 0.99
WIDEST = 600.0  # diameters of the largest grain, up to which a picture is widened to show the dams of a row
ROOMY = 1.5  # sizes of what grains take up, up to which the walls around them are shown whole
DRY = 1.0e-6  # depth up to which a segment of a row is dry [m]
_PLACES, _FRAMES = 20_000_000, 60  # grains and frames from which bounds are taken, of not fewer frames


@dataclass(frozen=True)
class Bounds:
    """Box that holds the grains of a lane, and the ends of their colour scales.

    Attributes
    ----------
    left, right, bottom, top : of grains, of fixed grains near them, and of the water [m].
    d_max : largest diameter of free and fixed grains [m].
    speed, spin : that 99 % of the grains do not exceed [m/s], [rad/s]; spin about y, without its sign.
    """

    left: float
    right: float
    bottom: float
    top: float
    d_max: float
    speed: float
    spin: float


@dataclass(frozen=True, repr=False)
class Snapshot(ByShape):
    """Grains at one moment.

    Attributes
    ----------
    t : time of the frame [s].
    grains : ids of the free grains shown, shape (n,).
    x : their centres inside the period [m], shape (n, 3).
    d : their diameters [m], shape (n,).
    speed : [m/s], shape (n,).
    spin : about y, positive rolls towards +x [rad/s], shape (n,).
    bed_x, bed_d : fixed grains that are there now [m], shapes (n_bed, 3) and (n_bed,).
    plane_point, plane_normal : planes that are there now and stand upright on the x-z plane, (n_plane, 3).
    period : along x [m]; inf where open.
    surface : height of the water's surface where a column was solved [m]; nan elsewhere.
    wall_lines : ends of the edges of walls, where they are now [m], shape (n_line, 2, 3).
    along_row : middle, bottom, floor with its dams, and surface of the water of each segment of a row of
        columns [m], shape (n_segment, 4); the surface is nan where it is dry.
    fall : angle by which the x axis falls downstream [rad].
    lane, lanes : number of the lane shown, in order of y, and of all lanes; 0 and 1 where there are none.
    """

    t: float
    grains: NDArray[np.int64]
    x: Floats
    d: Floats
    speed: Floats
    spin: Floats
    bed_x: Floats
    bed_d: Floats
    plane_point: Floats
    plane_normal: Floats
    period: float
    lane: int = 0
    lanes: int = 1
    surface: float = math.nan
    wall_lines: Floats = field(default_factory=lambda: np.zeros((0, 2, 3)))
    along_row: Floats = field(default_factory=lambda: np.zeros((0, 4)))
    fall: float = 0.0

    @property
    def bounds(self) -> Bounds:
        """Of this moment."""
        d_max = float(self.d.max(initial=0.0))
        ends = _with_walls(np.array([_ends(self.x, self.d)]), self.wall_lines)
        ends = _with_dams(ends, self.along_row, d_max)
        highest = self.surface if math.isfinite(self.surface) else _highest(self.along_row, ends)
        return _bounds(ends, self.speed, self.spin, (self.bed_x, self.bed_d), self.period, highest, d_max)

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per free grain."""
        columns = {f"{name}_m": self.x[:, axis] for axis, name in enumerate("xyz")}
        columns |= {"d_m": self.d, "speed_m_per_s": self.speed, "spin_rad_per_s": self.spin}
        rows: list[dict[str, object]] = []
        for k, g in enumerate(self.grains):
            row: dict[str, object] = {"grain": int(g), "t_s": self.t}
            rows.append(row | {name: float(values[k]) for name, values in columns.items()})
        return rows


def snapshot(run: Run, t: float | None = None, lane: int | None = None) -> Snapshot:
    """Grains, bed and planes at the frame nearest to a time.

    Parameters
    ----------
    run : a run folder.
    t : [s]; default the last frame.
    lane : lane of a plane scene, counted from 0 in order of y; default that of grain 0.

    Raises
    ------
    ResultsError : no frame near that time, or no such lane.
    """
    k = frame_at(run, t)
    now = float(run.frames.t[k])
    scene = scene_at(run, now)
    x = inside_periods(np.asarray(run.frames.x[k], dtype=np.float64), scene)
    v, omega = np.asarray(run.frames.v[k]), np.asarray(run.frames.omega[k])
    places, lanes = lanes_of(np.nan_to_num(x[:, 1]), scene)
    chosen = (int(places[0]) if len(places) else 0) if lane is None else lane
    if not 0 <= chosen < lanes:
        raise ResultsError(f"no lane {chosen}: there are {lanes}, counted from 0")
    shown = np.flatnonzero((places == chosen) & np.isfinite(x[:, 0]))  # nan: not there
    bed = scene.fixed_active.copy()
    if lanes > 1 and len(shown):
        bed &= np.abs(scene.x_fixed[:, 1] - x[shown[0], 1]) < 0.5 * float(scene.d.max())
    water = getattr(run, "water", None)
    planes = scene.plane_active.copy()
    if len(planes):
        planes &= np.abs(scene.plane_normal[:, 1]) < UPRIGHT
    return Snapshot(
        t=now,
        grains=shown,
        x=x[shown],
        d=scene.d[shown],
        speed=np.linalg.norm(v[shown], axis=1),
        spin=omega[shown, 1],
        bed_x=scene.x_fixed[bed].reshape(-1, 3),
        bed_d=scene.d_fixed[bed],
        plane_point=scene.plane_point[planes].reshape(-1, 3),
        plane_normal=scene.plane_normal[planes].reshape(-1, 3),
        period=float(scene.period[0]),
        lane=chosen,
        lanes=lanes,
        surface=math.nan if water is None else float(water.z_surface[k]),
        wall_lines=_lines_of_walls(scene, now),
        along_row=_along_row(run, k),
        fall=math.atan2(float(scene.gravity[0]), -float(scene.gravity[2])) if scene.gravity.any() else 0.0,
    )


def _along_row(run: Run, k: int) -> Floats:
    """Middle, bottom, floor and surface of each segment of a row at a frame [m]; nan where it is dry."""
    found = getattr(run, "row", None)
    if found is None:
        return np.zeros((0, 4))
    surface = np.where(found.depth[k] > DRY, found.surface[k], math.nan)
    return np.column_stack([found.row.x, found.row.bottom, found.floor, surface])


def _highest(along_row: Floats, ends: Floats) -> float:
    """Highest point of water and dams of a row between the grains [m]; -inf without a row."""
    near = (along_row[:, 0] >= ends[:, 0].min()) & (along_row[:, 0] <= ends[:, 1].max())
    return float(np.nanmax(along_row[near, 2:], initial=-math.inf))


def _with_walls(ends: Floats, lines: Floats) -> Floats:
    """Ends of grains, (n, 4) as of `_ends`, and those of walls that are not much larger, such as a drum."""
    if not len(lines):
        return ends
    walls = [end(lines[:, :, axis]) for axis in (0, 2) for end in (np.min, np.max)]
    own = [ends[:, 0].min(), ends[:, 1].max(), ends[:, 2].min(), ends[:, 3].max()]
    near = all(walls[k + 1] - walls[k] < ROOMY * (own[k + 1] - own[k]) for k in (0, 2))
    return np.concatenate([ends, [walls]]) if near else ends


def _with_dams(ends: Floats, along_row: Floats, d_max: float) -> Floats:
    """Ends of grains, (n, 4) as of `_ends`, and those of the dams of a row that are not too far from them."""
    x, bottom, floor, _ = along_row[along_row[:, 2] > along_row[:, 1]].T
    half = 0.5 * (along_row[1, 0] - along_row[0, 0]) if len(along_row) > 1 else 0.0
    left, right = float(ends[:, 0].min()), float(ends[:, 1].max())
    near = np.maximum(right, x + half) - np.minimum(left, x - half) < WIDEST * d_max
    dams = np.column_stack([x - half, x + half, bottom, floor])[near]
    return np.concatenate([ends, dams]) if math.isfinite(right) else ends


def _lines_of_walls(scene: Scene, t: float) -> Floats:
    """Ends of the edges of the walls there at a time, inside the periods as grains [m], (n_line, 2, 3)."""
    if scene.walls is None:
        return np.zeros((0, 2, 3))
    ends, owner = lines_of(scene.walls, rules=False)
    sides, round_ = outlines_of(scene.walls, t, np.array([0.0, 1.0, 0.0]))
    there = scene.walls.active[np.append(owner, round_)]
    lines = np.concatenate([in_world(scene.walls, ends, owner, t), sides])[there]
    return within_periods(lines, np.zeros(3), np.array([*scene.period, math.inf]))


def bounds(run: Run, lane: int | None = None) -> Bounds:
    """Box and colour scales that suit every frame of a run, so that pictures of two moments compare.

    Parameters
    ----------
    run : a run folder; of a very large one some frames are read, evenly spaced.
    lane : as in `snapshot`.
    """
    seen, scene = snapshot(run, lane=lane), run.scene
    bed = np.ones(scene.n_fixed, dtype=np.bool_)
    ids = seen.grains if scene.traffic is None else np.arange(scene.n_grain)  # also those away by then
    if seen.lanes > 1 and len(seen.x):
        bed = np.abs(scene.x_fixed[:, 1] - seen.x[0, 1]) < 0.5 * float(scene.d.max())
    n_frame = len(run.frames.t)
    count = min(max(_PLACES // max(scene.n_grain, 1), _FRAMES), n_frame)
    ends: list[tuple[float, ...]] = []
    speed: list[Floats] = []
    spin: list[Floats] = []
    for k in np.unique(np.linspace(0, n_frame - 1, count).round().astype(np.int64)):
        x = inside_periods(np.asarray(run.frames.x[k])[ids], scene)
        there = np.isfinite(x[:, 0])
        ends.append(_ends(x[there], scene.d[ids][there]))
        speed.append(np.linalg.norm(np.asarray(run.frames.v[k])[ids][there], axis=1))
        spin.append(np.asarray(run.frames.omega[k])[ids, 1][there])
    water = getattr(run, "water", None)
    rows = [_along_row(run, k) for k in (0, n_frame // 2, n_frame - 1)]
    d_max = float(scene.d[ids].max(initial=0.0))
    lines = [_lines_of_walls(scene_at(run, t), t) for t in (float(run.frames.t[0]), float(run.frames.t[-1]))]
    shown = _with_dams(_with_walls(np.array(ends), np.concatenate(lines)), np.concatenate(rows), d_max)
    highest = max(_highest(one, shown) for one in rows) if water is None else water.z_surface.max()
    return _bounds(
        shown, np.concatenate(speed), np.concatenate(spin),
        (scene.x_fixed[bed].reshape(-1, 3), scene.d_fixed[bed]), seen.period, float(highest), d_max,
    )  # fmt: skip


def _ends(x: Floats, d: Floats) -> tuple[float, ...]:
    """Left, right, bottom and top of some grains [m]."""
    low, high = (x - 0.5 * d[:, None]), (x + 0.5 * d[:, None])
    return (
        float(low[:, 0].min(initial=math.inf)), float(high[:, 0].max(initial=-math.inf)),
        float(low[:, 2].min(initial=math.inf)), float(high[:, 2].max(initial=-math.inf)),
    )  # fmt: skip


def _bounds(
    ends: Floats, speed: Floats, spin: Floats, bed: tuple[Floats, Floats], period: float, highest: float,
    d_max: float,
) -> Bounds:  # fmt: skip
    """Bounds of some frames, whose ends are (n_frame, 4); `highest` of the water's surface [m]."""
    left, right = float(ends[:, 0].min()), float(ends[:, 1].max())
    bottom, top = float(ends[:, 2].min()), float(ends[:, 3].max())
    x, d = bed
    if not math.isfinite(right):  # no free grains
        left, right, bottom, top = _ends(x, d) if len(x) else (-0.01, 0.01, 0.0, 0.01)
    d_max = max(d_max, float(d.max(initial=0.0)))
    if math.isfinite(period):
        left, right = 0.0, period
    near = (x[:, 0] > left - d_max) & (x[:, 0] < right + d_max) & (x[:, 2] < top + d_max)
    bottom = min(bottom, float((x[near, 2] - 0.5 * d[near]).min(initial=math.inf)))
    most = [float(np.quantile(one, SHARE)) if len(one) else 0.0 for one in (speed, np.abs(spin))]
    return Bounds(left, right, bottom, max(top, highest), d_max, *most)


def frame_at(run: Run, t: float | None = None) -> int:
    """Number of the frame nearest to time t [s]; of the last one for None."""
    times = np.asarray(run.frames.t, dtype=np.float64)
    if len(times) == 0:
        raise ResultsError("the run holds no frame")
    if t is None:
        return len(times) - 1
    gap = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    if not times[0] - gap <= t <= times[-1] + gap:
        raise ResultsError(f"no frame at t = {t:g} s; the run holds {times[0]:g} .. {times[-1]:g} s")
    return int(np.abs(times - t).argmin())


def scene_at(run: Run, t: float) -> Scene:
    """The scene that held at time t [s]; that of the start where a run knows no other."""
    at = getattr(run, "scene_at", None)
    return run.scene if at is None else at(t)


def lanes_of(y: Floats, scene: Scene) -> tuple[NDArray[np.int64], int]:
    """Lane of each grain at y [m], shape (n,), and how many there are: copies of a plane scene."""
    if not scene.plane_case or len(y) == 0:
        return np.zeros(len(y), dtype=np.int64), 1
    order = np.sort(y)
    edges = order[1:][np.diff(order) > 0.5 * float(scene.d.max())]
    return np.searchsorted(edges, y, side="right").astype(np.int64), len(edges) + 1


def inside_periods(x: Floats, scene: Scene) -> Floats:
    """Centres taken back into the periods [m]."""
    x = x.copy()
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):
            inside = np.mod(x[:, axis], period)
            x[:, axis] = np.where(inside < period, inside, 0.0)  # round-off
    return x
