"""What the experiments on a movable bed (fig22, fig22-free) share: the water, and the numbers of one run."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.measure import Profiles, Rods, Snapshot, profiles, rods, snapshot, transport
from ryusa.measure.statistics import Floats
from ryusa.results import Results
from ryusa.study import short
from ryusa_studies.osada2004._parts import CaseRun

MOMENTS = 3  # drawn of a rod


@dataclass(frozen=True)
class MovableBedRun:
    """One run, after it has settled.

    Attributes
    ----------
    rods : rods, and the null model.
    q : flux of grains per width [m2/s].
    v, spin : speeds along the bed [m/s] and spins [rad/s] of grains that move, all frames together.
    profile : means over height from the mean crest of the fixed grains.
    followed : the longest rod at `MOMENTS` moments of its window; none where there is no rod.
    """

    rods: Rods
    q: float
    v: Floats
    spin: Floats
    profile: Profiles
    followed: tuple[Snapshot, ...]

    @property
    def speed(self) -> float:
        """Mean speed of grains that move [m/s]; nan where none does."""
        return float(self.v.mean()) if len(self.v) else math.nan

    @property
    def fast_spin(self) -> float:
        """What a twentieth of the spins of movers exceeds [rad/s]; nan where nothing moves."""
        return float(np.quantile(np.abs(self.spin), 0.95)) if len(self.spin) else math.nan

    @property
    def rolling(self) -> float:
        """Spin times radius over speed, means of the movers [-]; 1 for grains that roll."""
        return 0.5 * self.profile.d * float(self.spin.mean()) / self.speed if len(self.spin) else math.nan


def measure(run: Results, one: CaseRun) -> MovableBedRun:
    """Rods, flux, speeds and spins of the movers, and the longest rod on its way."""
    del one
    found = rods(run)
    profile = profiles(run, above="mean crest", bed=True)
    rows = np.searchsorted(np.asarray(run.frames.t), (float(profile.t[0]), float(profile.t[-1])))
    v = np.asarray(run.frames.v[rows[0] : rows[1] + 1], dtype=np.float64)[:, :, 0]
    spin = np.asarray(run.frames.omega[rows[0] : rows[1] + 1], dtype=np.float64)[:, :, 1]
    moves = v > profile.d / found.window  # the speed of a mover in rods
    longest = found.longest
    moments = [] if longest is None else longest.begin + found.window * np.linspace(0.0, 1.0, MOMENTS)
    return MovableBedRun(
        rods=found,
        q=transport(run).averages["q"].value,
        v=v[moves],
        spin=spin[moves],
        profile=profile,
        followed=tuple(snapshot(run, float(t)) for t in moments),
    )


def mean(values: Sequence[float]) -> str:
    """Mean of the numbers that are numbers, in words."""
    kept = [value for value in values if math.isfinite(value)]
    return short(float(np.mean(kept))) if kept else "none"


def row(bed: MovableBedRun) -> dict[str, object]:
    """Numbers of one run for the CSV table."""
    return {
        "movers": int(bed.rods.movers.sum()),
        "windows": len(bed.rods.begin),
        "in_rods": bed.rods.share,
        "shuffled": bed.rods.null_share,
        "kept": bed.rods.kept,
        "grains_in_a_rod": bed.rods.mean_length,
        "q_m2_per_s": bed.q,
        "speed_of_movers_m_per_s": bed.speed,
        "spin_95_rad_per_s": bed.fast_spin,
        "rolling": bed.rolling,
    }
