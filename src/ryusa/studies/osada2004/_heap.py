"""What the heap experiments (fig19, eq13) share: the case, its choices, and the slope that is left."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from ryusa.measure import HeapSurface, Snapshot, snapshot, surface
from ryusa.results import Results
from ryusa.studies.osada2004._parts import PHI, SLIP, CaseRun, Plan, paper_run
from ryusa.study import CONFIDENCE, Interval, Pooled, over_seeds

CASE = "fig19"
SHIPPED = {PHI: "30 deg", SLIP: "spring"}
KEYS = {PHI: "timeline.0.friction_angle", SLIP: "contact.slip"}
FITS = ("0.1 to 0.9", "0.2 to 0.8", "0.25 to 0.75")  # beside the shipped 0.15 to 0.85 of the heap's height
MOVING = 0.01  # share of grains that may still move in a heap that is called at rest
STARTS = 3  # heaps per seed where a verdict hangs on them: slopes of single heaps scatter by several degrees
SECOND = 100_000  # from one seed to the next start


@dataclass(frozen=True)
class Heap:
    """The heap at the end of one run."""

    seen: Snapshot
    found: HeapSurface
    start: Snapshot | None  # as the gate goes; None where it was not kept
    t_gate: float  # [s]
    t_end: float  # [s]
    residual: float  # of the energy account [-]
    rolled: (
        float  # lost to rolling friction since the gate went, over the height lost [-]; < 0: it made energy
    )

    @property
    def slope(self) -> float:
        """Mean of the slopes over four ranges of height [rad]; nan where it stands like a wall."""
        if not math.isfinite(self.found.angle):
            return math.nan
        angles = [self.found.angle, *(self.found.angles[name] for name in FITS)]
        return float(np.nanmean(angles))

    @property
    def wall(self) -> bool:
        """True where there is no slope because the heap stands."""
        return not math.isfinite(self.found.angle)


def run(
    chosen: Mapping[str, str], rotation: str, seed: int, more: Mapping[str, str] | None = None
) -> CaseRun:
    """One heap; the shipped one turns freely."""
    changed = {KEYS[name]: value for name, value in chosen.items() if name in KEYS and SHIPPED[name] != value}
    changed |= {} if rotation == "free" else {"timeline.1.rotation": rotation}
    return paper_run(CASE, changed | dict(more or {}), seed)


def starts(plan: Plan, n: int = STARTS) -> list[int]:
    """Seeds of `n` heaps for each of the plan's; quick: of one."""
    return [seed + SECOND * k for seed in plan.seeds for k in range(plan.pick(1, n))]


def heap(results: Results) -> Heap:
    """Measure the last frame."""
    gate = max(t for _, t, _ in results.scenes)
    since = int(np.searchsorted(results.tally["t"], gate))
    fell = float(results.tally["potential"][since] - results.tally["potential"][-1])
    rolled = float(results.tally["roll"][-1] - results.tally["roll"][since])
    return Heap(
        seen=snapshot(results),
        found=surface(results),
        start=snapshot(results, gate),
        t_gate=gate,
        t_end=float(results.frames.t[-1]),
        residual=float(results.summary.get("residual", math.nan)),
        rolled=rolled / fell,
    )


def slopes(heaps: Sequence[Heap]) -> list[float]:
    """Slopes in degrees, one per seed."""
    return [math.degrees(one.slope) for one in heaps]


def slope_interval(heaps: Sequence[Heap], spread: Pooled | None) -> tuple[Interval, bool | None, str]:
    """Slope over seeds; a verdict and a note where heaps stand like walls.

    Heaps that all stand like a wall have no slope, and fail whatever was asked; so does a setting under which
    most heaps do, at 95 % (Clopper & Pearson 1934, Biometrika 26, 404). Where only some do, the mean of the
    others is given but decides nothing.
    """
    standing, n = sum(one.wall for one in heaps), len(heaps)
    found = over_seeds(slopes([one for one in heaps if not one.wall]), "deg", spread)
    if standing == n:
        return found, False, "stands as a wall"
    if standing:
        note = f"{standing} of {n} stand as a wall, the others {found.value:.3g} deg"
        most = stats.binomtest(standing, n).proportion_ci(CONFIDENCE).low > 0.5
        none = Interval(math.nan, math.nan, math.nan, "deg", n, found.how)
        return none, False if most else None, note
    return found, None, ""


def moving(heaps: Sequence[Heap]) -> Interval:
    """Largest share of grains that still move at the end, over seeds."""
    shares = [one.found.moving for one in heaps]
    return Interval(
        max(shares), min(shares), max(shares), "-", len(shares), f"range over {len(shares)} seeds"
    )


def line(one: Heap) -> dict[str, object]:
    """Numbers of one heap."""
    return {
        "slope_deg": math.degrees(one.slope),
        "fit_error_deg": math.degrees(one.found.error),
        "fit_spread_deg": math.degrees(one.found.spread),
        "stands_like_a_wall": one.wall,
        "moving_share": one.found.moving,
        "run_out_cm": 100.0 * one.found.run_out,
        "crest_cm": 100.0 * one.found.crest,
        "t_end_s": one.t_end,
        "residual": one.residual,
        "lost_to_rolling": one.rolled,
    }
