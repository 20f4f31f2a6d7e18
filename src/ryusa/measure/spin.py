"""Spin of the grains: against the distance they went, and on average."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import average
from ryusa.measure.table import Averages

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Spin:
    """Spin about y of every free grain; positive rolls downstream.

    Attributes
    ----------
    t : times of the frames [s], shape (n_frame,).
    distance : way along x since the first frame [m], shape (n_frame, n_grain).
    omega : spin [rad/s], shape (n_frame, n_grain).
    largest : largest absolute spin in the window [rad/s].
    averages : means over the window (after `settle`).
    """

    t: Floats
    distance: Floats
    omega: Floats
    largest: float
    averages: Averages

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per average."""
        return self.averages.rows()

    def samples(self) -> list[dict[str, object]]:
        """One dictionary per frame and grain."""
        return [
            {"grain": g, "t_s": float(t), "x_m": float(x), "omega_y_rad_per_s": float(omega)}
            for g in range(self.omega.shape[1])
            for t, x, omega in zip(self.t, self.distance[:, g], self.omega[:, g], strict=True)
        ]


def spin(run: Run, settle: float | None = None) -> Spin:
    """Spin against distance and time.

    Parameters
    ----------
    run : a run folder.
    settle : frames before are left out of the averages [s]; default the case's `record.settle`.
    """
    begin = settle_time(run) if settle is None else settle
    t = np.asarray(run.frames.t, dtype=np.float64)
    x = np.asarray(run.frames.x[:], dtype=np.float64)[:, :, 0]
    omega = np.asarray(run.frames.omega[:], dtype=np.float64)[:, :, 1]
    late = t >= begin
    window = (begin, float(t[-1]) if len(t) else math.nan)
    columns = [omega[late, g] for g in range(omega.shape[1])]
    largest = float(np.abs(omega[late]).max()) if late.any() and omega.shape[1] else math.nan
    averages = Averages(
        "spin",
        (
            average("spin", "rad/s", columns, window),
            average("turns", "1/s", [one / TURN for one in columns], window),
            average("spin_absolute", "rad/s", [np.abs(one) for one in columns], window),
        ),
        (f"largest spin after {begin:g} s: {largest:.4g} rad/s ({largest / TURN:.4g} turns/s)",),
    )
    return Spin(t, x - x[:1], omega, largest, averages)
