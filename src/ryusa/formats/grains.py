"""The grains of one moment as columns, between a run and a file of any format."""

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ResultsError
from ryusa.model import Scene
from ryusa.model.arrays import Bools, Floats

if TYPE_CHECKING:
    from ryusa.results import Results

UNITS = {
    **dict.fromkeys(("x", "y", "z", "d"), "m"),
    **dict.fromkeys(("vx", "vy", "vz"), "m/s"),
    **dict.fromkeys(("wx", "wy", "wz"), "rad/s"),
    "m": "kg",
    "density": "kg/m3",
}


NO_CLUMP = -1
PART_OF_A_CLUMP = "expected single spheres, with clump -1: a case cannot begin with clumps from a file"


@dataclass(frozen=True)
class PlaneWall:
    """A plane that a file states beside its grains."""

    name: str
    point: tuple[float, float, float]  # [m]
    normal: tuple[float, float, float]


@dataclass(frozen=True)
class GrainTable:
    """Grains of one moment in SI, one row per grain.

    Attributes
    ----------
    name : the file or folder, for messages.
    columns : x, y, z, d [m], vx, vy, vz [m/s], wx, wy, wz [rad/s], m [kg], density [kg/m3], each of shape
        (n,).
    fixed : whether a grain never moves, (n,).
    group : name of the group of each row, "" where none.
    labels : what messages call each row, such as "of line 7 of grains.csv".
    ids : as in the run, (n,).
    image : periods crossed in x and y, (n, 2).
    t, step : of the frame [s].
    period : in x and y [m], inf where open; None where the file does not say.
    planes : walls beside the grains.
    z_zero : zero of the water profile [m]; None where the file does not say.
    bed_area : area of bed under a column of water [m2]; None where the file does not say.
    clump : number of the clump of each row, `NO_CLUMP` for a grain of its own, (n,); None without clumps.
    orientation : unit quaternions (w, x, y, z) from the principal axes of the clump of each row to space,
        (1, 0, 0, 0) for a grain of its own, (n, 4); None without clumps.
    notes : what is in the file and is not used, and how it was read.
    """

    name: str
    columns: dict[str, Floats]
    fixed: Bools
    group: tuple[str, ...]
    labels: tuple[str, ...] = ()
    ids: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    image: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 2), np.int64))
    t: float = 0.0
    step: int = 0
    period: tuple[float, float] | None = None
    planes: tuple[PlaneWall, ...] = ()
    z_zero: float | None = None
    bed_area: float | None = None
    clump: NDArray[np.int64] | None = None
    orientation: Floats | None = None
    notes: tuple[str, ...] = ()

    @property
    def n(self) -> int:
        """Number of rows."""
        return len(self.fixed)

    def column(self, name: str) -> Floats:
        """Values of a column in SI; zeros where the table has none."""
        return self.columns.get(name, np.zeros(self.n))

    def vectors(self, *names: str) -> Floats:
        """Columns side by side, shape (n, 3)."""
        return np.stack([self.column(name) for name in names], axis=1)


def nearest_frame(run: "Results", t: float) -> int:
    """Number of the frame nearest to a time [s].

    Raises
    ------
    ResultsError : the run has no frame, or ends before that time.
    """
    times = run.frames.t
    if not len(times):
        raise ResultsError(f"{run.folder}: has no frame yet")
    slack = float(np.diff(times).max()) if len(times) > 1 else 1e-9 * abs(float(times[0]))
    if not times[0] - slack <= t <= times[-1] + slack:
        raise ResultsError(
            f"{run.folder}: has no frame at {t:g} s; its frames are from {times[0]:g} to {times[-1]:g} s"
        )
    return int(np.abs(times - t).argmin())


def table_of_frame(run: "Results", k: int) -> GrainTable:
    """Free and fixed grains of frame k of a run, inside the period.

    Notes
    -----
    Grains that have not entered, or have left, are left out. A fixed grain has the mass of a sphere of its
    size and of the density of the first free grain. Groups are those of fixed grains. A sphere of a clump has
    the spin of the clump.
    """
    frames, t = run.frames, float(run.frames.t[k])
    scene = run.scene_at(t)
    if not scene.n_grain + scene.n_fixed:
        raise ResultsError(
            "the run has water alone, and no grain to write: ryusa measure RUN WHAT --csv has numbers of it"
        )
    column = scene.column if scene.row is None else scene.row.column
    there = np.flatnonzero(scene.fixed_active)
    every, n_grain, n_fixed = frames.x_wrapped[k], scene.n_grain, len(there)
    here = np.arange(n_grain) if scene.traffic is None else np.flatnonzero(np.isfinite(every[:, 0]))
    n = len(here)
    x = np.concatenate([every[here], scene.x_fixed[there].reshape(-1, 3)])
    image = np.zeros((n + n_fixed, 2), dtype=np.int64)
    image[:n] = frames.image[k][here]
    for axis, period in enumerate(scene.period):
        if math.isfinite(period):  # engines wrap now and then, so a grain may be a little outside
            turns = np.floor(x[:, axis] / period)
            x[:, axis] -= turns * period
            image[:, axis] += turns.astype(np.int64)
    d = np.concatenate([scene.d[here], scene.d_fixed[there]])
    density = scene.m[0] / scene.solid_volume[0]  # a sphere of a clump has a share of its volume
    m = np.concatenate([scene.m[here], density * np.pi / 6.0 * scene.d_fixed[there] ** 3])
    still = np.zeros((n_fixed, 3))
    v, omega = (np.concatenate([part[k][here], still]) for part in (frames.v, frames.omega))
    names = ("x", "y", "z", "d", "vx", "vy", "vz", "wx", "wy", "wz", "m")
    ids = np.concatenate([here, n_grain + there]).astype(np.int64)
    clump, orientation = _clumps(run, k, scene, here, n_fixed)
    return GrainTable(
        name=run.folder.name,
        columns=dict(zip(names, [*x.T, d, *v.T, *omega.T, m], strict=True)),
        fixed=ids >= n_grain,
        group=_groups(scene.groups, ids),
        labels=tuple(f"{one} of {run.folder.name}" for one in ids.tolist()),
        ids=ids,
        image=image,
        t=t,
        step=int(frames.step[k]),
        period=scene.period,
        planes=_planes(scene),
        z_zero=scene.water.z_zero,
        bed_area=None if column is None else column.area,
        clump=clump,
        orientation=orientation,
    )


def _clumps(
    run: "Results", k: int, scene: Scene, here: NDArray[np.int64], n_fixed: int
) -> tuple[NDArray[np.int64] | None, Floats | None]:
    """Clump and orientation of the free spheres `here` at frame k, then of fixed grains."""
    if scene.bodies is None or run.bodies is None:
        return None, None
    alone = np.full(n_fixed, NO_CLUMP, np.int64)
    clump = np.concatenate([scene.bodies.of_grain(scene.n_grain)[here], alone])
    orientation = np.tile([1.0, 0.0, 0.0, 0.0], (len(clump), 1))
    orientation[clump != NO_CLUMP] = run.bodies.q[k][clump[clump != NO_CLUMP]]
    return clump, orientation


def _groups(groups: dict[str, tuple[int, int]], ids: NDArray[np.int64]) -> tuple[str, ...]:
    """Name of the group of each grain: of the smallest that it is in, beside `grains` and `bed`."""
    found = np.full(len(ids), "", dtype=object)
    for name, (first, end) in sorted(groups.items(), key=lambda one: one[1][0] - one[1][1]):
        if name not in {"grains", "bed"}:
            found[(ids >= first) & (ids < end)] = name
    return tuple(found.tolist())


def _planes(scene: Scene) -> tuple[PlaneWall, ...]:
    """Planes that are there, under the names of their groups."""
    first = scene.n_grain + scene.n_fixed
    names = {begin - first: name for name, (begin, _) in scene.groups.items() if begin >= first}
    return tuple(
        PlaneWall(
            names.get(k, f"plane {k}"),
            _triple(scene.plane_point[k]),
            _triple(scene.plane_normal[k]),
        )
        for k in np.flatnonzero(scene.plane_active).tolist()
    )


def _triple(values: Floats) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return x, y, z
