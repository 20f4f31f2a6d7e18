"""Spin of the grains: against the distance they went, and on average."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.laws.families import Profile
from ryusa.laws.torque import torque_in_range
from ryusa.laws.water import log_law_rough
from ryusa.measure._run import Floats, Run, settle_time
from ryusa.measure.statistics import average, ratio
from ryusa.measure.table import Averaged, Averages, lines

TURN = 2.0 * math.pi


@dataclass(frozen=True, repr=False)
class Spin(Averaged):
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

    @property
    def settled(self) -> float:
        """Time from which on the averages are taken [s]."""
        return self.averages["spin"].window[0]

    def farthest(self, count: int) -> list[int]:
        """Ids of so many grains that travelled farthest along x up to the last frame, in that order."""
        return [int(g) for g in np.argsort(-np.abs(self.distance[-1]), kind="stable")[:count]]

    def series(self) -> list[dict[str, object]]:
        """One dictionary per frame and grain."""
        columns = {
            "grain": np.arange(self.omega.shape[1])[:, None], "t_s": self.t, "x_m": self.distance.T,
            "omega_y_rad_per_s": self.omega.T,
        }  # fmt: skip
        return lines(columns)


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


def spin_against(run: Run, settle: float | None = None) -> Averages:
    """Spin of free grains beside the three spins it could be held against.

    Parameters
    ----------
    run : a run folder.
    settle : frames before are left out [s]; default the case's `record.settle`.

    Notes
    -----
    `rolling` is spin times radius over the speed along the bed: 1 for a grain whose underside stands still,
    as if it rolled. `water_turn` is half the vorticity of Eq. (9) at the grain's centre, the spin at which
    the water's torque would leave it alone; nan for other profiles. `beyond_dennis` is the share of frames
    in which the spin is outside the range that `laws.torque.torque_dennis` was fitted to.
    """
    begin = settle_time(run) if settle is None else settle
    scene = run.scene
    t = np.asarray(run.frames.t, dtype=np.float64)
    late = t >= begin
    z = np.asarray(run.frames.x[:], dtype=np.float64)[late, :, 2]
    v = np.asarray(run.frames.v[:], dtype=np.float64)[late, :, 0]
    omega = np.asarray(run.frames.omega[:], dtype=np.float64)[late, :, 1]
    window = (begin, float(t[-1]) if len(t) else math.nan)
    ids = range(omega.shape[1])
    surface = omega * (0.5 * scene.d)
    beyond = np.array([
        [not torque_in_range(one, scene.d[g], scene.water.nu) for one in omega[:, g]] for g in ids
    ]).astype(np.float64)  # fmt: skip
    turn = _water_turn(run, z)
    return Averages(
        "spin against",
        (
            ratio("rolling", "-", [surface[:, g] for g in ids], [v[:, g] for g in ids], window),
            average("water_turn", "rad/s", [turn[:, g] for g in ids], window),
            average("beyond_dennis", "-", list(beyond), window),
        ),
        (),
    )


def _water_turn(run: Run, z: Floats) -> Floats:
    """Half the vorticity of Eq. (9) at heights z [rad/s], by differences over a thousandth of the height."""
    water = run.scene.water
    if water.profile != Profile.LOG_ROUGH:
        return np.full(z.shape, math.nan)
    high = z - water.z_zero
    speeds = [
        np.array([log_law_rough(one * far, water.u_star, water.k_rough) for one in high.ravel()])
        for far in (0.999, 1.001)
    ]
    return 0.5 * (speeds[1] - speeds[0]).reshape(z.shape) / (0.002 * high)
