"""Paths of grains in the x-z plane, and the bed under them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run
from ryusa.measure.snapshot import scene_at
from ryusa.measure.table import lines
from ryusa.model import Scene
from ryusa.model.scene import Bools
from ryusa.printed import ByShape

REST = 1.0  # diameters by which a grain at rest moves less within the window


@dataclass(frozen=True, repr=False)
class Tracks(ByShape):
    """Paths of some grains.

    Attributes
    ----------
    grains : ids.
    t : times [s], shape (n_frame,).
    x, z : centres, x unwrapped and z above the datum [m], shape (n_frame, n_grain).
    d : diameters [m], shape (n_grain,).
    bed_x, bed_z, bed_d : fixed grains in the lane of the first grain, the farthest (largest y) first [m].
    loose_x, loose_z, loose_d : other free grains in that lane that lie still, at the last frame and in the
        same order [m]: from the first frame to the last they move by less than a diameter.
    period : period along x [m]; inf where open.
    """

    grains: tuple[int, ...]
    t: Floats
    x: Floats
    z: Floats
    d: Floats
    bed_x: Floats
    bed_z: Floats
    bed_d: Floats
    loose_x: Floats
    loose_z: Floats
    loose_d: Floats
    period: float

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per frame and grain."""
        grains = np.array(self.grains, np.int64)[:, None]
        return lines({"grain": grains, "t_s": self.t, "x_m": self.x.T, "z_m": self.z.T})


def tracks(
    run: Run, grains: Sequence[int] | None = None, begin: float = -math.inf, end: float = math.inf
) -> Tracks:
    """Paths of some grains within a time window.

    Parameters
    ----------
    run : a run folder.
    grains : ids of free grains; default all.
    begin, end : window [s].
    """
    ids = tuple(range(run.scene.n_grain)) if grains is None else tuple(int(g) for g in grains)
    t = np.asarray(run.frames.t, dtype=np.float64)
    low, high = int(np.searchsorted(t, begin, side="left")), int(np.searchsorted(t, end, side="right"))
    places = np.asarray(run.frames.x[low:high], dtype=np.float64)
    x = places[:, list(ids)]
    scene = scene_at(run, float(t[high - 1])) if len(x) else run.scene
    y = float(x[0, 0, 1]) if x.size else None
    bed = _lane(scene.x_fixed, scene.d_fixed, scene.fixed_active, y, scene)
    loose = np.zeros((0, 4))
    if len(places):
        still = np.linalg.norm(places[-1] - places[0], axis=1) < REST * scene.d
        still[list(ids)] = False
        loose = _lane(places[-1], scene.d, still, y, scene)
    return Tracks(
        grains=ids,
        t=t[low:high],
        x=x[:, :, 0],
        z=x[:, :, 2],
        d=scene.d[list(ids)],
        bed_x=bed[:, 0],
        bed_z=bed[:, 2],
        bed_d=bed[:, 3],
        loose_x=loose[:, 0],
        loose_z=loose[:, 2],
        loose_d=loose[:, 3],
        period=float(scene.period[0]),
    )


def _lane(x: Floats, d: Floats, chosen: Bools, y: float | None, scene: Scene) -> Floats:
    """Centres and diameters (n, 4) of the chosen grains, in a plane scene those in the lane at y [m]."""
    rows = np.column_stack([x.reshape(-1, 3), d])[chosen]
    if len(rows) and y is not None and scene.plane_case:  # lanes of a plane scene lie side by side in y
        away = np.abs(rows[:, 1] - y)
        rows = rows[away <= 0.5 * float(scene.d.max())]
    return rows[np.argsort(-rows[:, 1], kind="stable")]


def farthest(run: Run, begin: float = -math.inf, end: float = math.inf) -> int:
    """Id of the free grain that goes farthest along the bed within a window [s]; 0 where there is none.

    Parameters
    ----------
    run, begin, end : as in `tracks`.
    """
    t = np.asarray(run.frames.t, dtype=np.float64)
    inside = np.flatnonzero((t >= begin) & (t <= end))
    if len(inside) < 2:
        return 0
    first, last = (np.asarray(run.frames.x[int(k)], dtype=np.float64)[:, 0] for k in inside[[0, -1]])
    return int(np.argmax(np.abs(last - first)))
