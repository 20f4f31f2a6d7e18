"""Paths of grains in the x-z plane, and the bed under them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run


@dataclass(frozen=True)
class Tracks:
    """Paths of some grains.

    Attributes
    ----------
    grains : ids.
    t : times [s], shape (n_frame,).
    x, z : centres, x unwrapped [m], shape (n_frame, n_grain).
    d : diameters [m], shape (n_grain,).
    bed_x, bed_z, bed_d : fixed grains in the lane of the first grain [m].
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
    period: float

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per frame and grain."""
        return [
            {"grain": g, "t_s": float(self.t[k]), "x_m": float(self.x[k, c]), "z_m": float(self.z[k, c])}
            for c, g in enumerate(self.grains)
            for k in range(len(self.t))
        ]


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
    scene = run.scene
    ids = tuple(range(scene.n_grain)) if grains is None else tuple(int(g) for g in grains)
    t = np.asarray(run.frames.t, dtype=np.float64)
    low, high = int(np.searchsorted(t, begin, side="left")), int(np.searchsorted(t, end, side="right"))
    x = np.asarray(run.frames.x[low:high], dtype=np.float64)[:, list(ids)]
    bed = scene.x_fixed
    near = np.ones(len(bed), dtype=np.bool_)
    if len(bed) and len(x) and ids and scene.plane_case:  # lanes of a plane scene lie side by side in y
        away = np.abs(bed[:, 1] - x[0, 0, 1])
        near = away <= away.min() + 0.25 * float(scene.d_fixed.min())
    return Tracks(
        grains=ids,
        t=t[low:high],
        x=x[:, :, 0],
        z=x[:, :, 2],
        d=scene.d[list(ids)],
        bed_x=bed[near, 0] if len(bed) else np.zeros(0),
        bed_z=bed[near, 2] if len(bed) else np.zeros(0),
        bed_d=scene.d_fixed[near] if len(bed) else np.zeros(0),
        period=float(scene.period[0]),
    )


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
