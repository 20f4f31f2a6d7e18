"""Flow along a bottom that is inclined to the x axis of a row of columns."""

import numpy as np
from numpy.typing import NDArray

from ryusa.measure._run import Run
from ryusa.measure.snapshot import scene_at
from ryusa.model import ColumnRow

Floats = NDArray[np.float64]


def gravity_at(run: Run, t: float) -> tuple[float, float]:
    """Gravity along x, and against z, at time t [s] [m/s2]."""
    g_x, _, g_z = np.asarray(scene_at(run, t).gravity).tolist()
    return g_x, -g_z


def fall_of(row: ColumnRow) -> Floats:
    """Fall of the bottom towards the x axis over distance [-], (n_segment,); 0 over closed dams."""
    bottom = np.pad(row.bottom, 1, mode="wrap") if row.periodic else row.bottom_with_ends()
    fall = (bottom[:-2] - bottom[2:]) / (2.0 * row.dx)  # mean of both ends
    return fall if row.solid is None else np.where(row.solid > 0, 0.0, fall)


def pull_of(fall: Floats, g_x: float, g_z: float) -> Floats:
    """Pull p with which depth and speed have the Froude number speed/sqrt(p depth) [m/s2].

    p = g cos(theta) cos(alpha)^3, as in the notes of `LongSection`; tan(alpha) is `fall`.
    """
    return (g_z - g_x * fall) / (1.0 + fall**2) ** 2
