"""What the heap experiments (fig19, eq13, rolling_friction) share: runs, and the slope that is left."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.measure import HeapSurface, Snapshot, snapshot, surface
from ryusa.results import Results
from ryusa.study import Band, Interval, Trial, exact, over_seeds
from ryusa_studies.osada2004._parts import CaseRun, paper_run
from ryusa_studies.osada2004._shares import share_interval, share_trial

CASE = "fig19"
PHI_KEY = "timeline.0.friction_angle"
FITS = ("0.1 to 0.9", "0.2 to 0.8", "0.25 to 0.75")  # beside the shipped 0.15 to 0.85 of the heap's height
MEAN = "mean of four"
MOST = 0.5  # of the heaps of a setting


@dataclass(frozen=True)
class Heap:
    """The heap at the end of one run."""

    seen: Snapshot
    found: HeapSurface
    t_gate: float  # [s]
    t_end: float  # [s]
    residual: float  # of the energy account [-]
    rolled: (
        float  # lost to rolling friction since the gate went, over the height lost [-]; < 0: it made energy
    )

    def slope(self, fit: str = MEAN) -> float:
        """Slope over a range of height, or mean of four [deg]; nan where it stands as a wall there."""
        if self.wall:
            return math.nan
        if fit != MEAN:
            return math.degrees(self.found.angles[fit])
        return math.degrees(
            float(np.nanmean([self.found.angle, *(self.found.angles[name] for name in FITS)]))
        )

    @property
    def wall(self) -> bool:
        """True where there is no slope because the heap stands."""
        return not math.isfinite(self.found.angle)


def run(rotation: str, seed: int, changed: Mapping[str, str]) -> CaseRun:
    """One heap; the shipped one turns freely."""
    return paper_run(
        CASE, dict(changed) | ({} if rotation == "free" else {"timeline.1.rotation": rotation}), seed
    )


def heap(results: Results) -> Heap:
    """Measure the last frame."""
    gate = max(t for _, t, _ in results.scenes)
    since = int(np.searchsorted(results.tally["t"], gate))
    fell = float(results.tally["potential"][since] - results.tally["potential"][-1])
    rolled = float(results.tally["roll"][-1] - results.tally["roll"][since])
    return Heap(
        seen=snapshot(results),
        found=surface(results),
        t_gate=gate,
        t_end=float(results.frames.t[-1]),
        residual=float(results.summary.get("residual", math.nan)),
        rolled=rolled / fell,
    )


def slopes(heaps: Sequence[Heap], fit: str = MEAN) -> list[float]:
    """Slopes of the heaps that have one [deg], in the order of the seeds."""
    return [found for one in heaps if math.isfinite(found := one.slope(fit))]


def slope_trial(part: str, chosen: Mapping[str, str], heaps: Sequence[Heap], fit: str, band: Band) -> Trial:
    """Return the trial of the mean slope over seeds.

    Notes
    -----
    Heaps that stand as walls have no slope. A setting in which most of them do, by Wilson's interval, fails
    whatever was asked; with fewer it is undecided, and a note gives the mean of the others.
    """
    halves = (_held(heaps[0::2], fit, band), _held(heaps[1::2], fit, band))
    walls, n = [float(math.isnan(one.slope(fit))) for one in heaps], len(heaps)
    found = over_seeds(slopes(heaps, fit), "deg")
    if not any(walls):
        return Trial(part, chosen, found, band, halves=halves)
    others = "" if all(walls) else f", the others have {found.value:.3g} deg"
    note = f"{sum(walls):.0f} of {n} stand as a wall{others}"
    none = Interval(math.nan, math.nan, math.nan, "deg", n, found.how)
    failed = False if all(walls) or share_interval(walls, 1).low > MOST else None
    return Trial(part, chosen, none, band, failed, note, halves)


def _held(heaps: Sequence[Heap], fit: str, band: Band) -> bool | None:
    """Whether the mean slope of these heaps is inside; no where more of them stand than not."""
    found = slopes(heaps, fit)
    if not heaps or 2 * len(found) == len(heaps):
        return None
    return band.holds(exact(math.fsum(found) / len(found), "deg")) if 2 * len(found) > len(heaps) else False


def moving_trial(part: str, chosen: Mapping[str, str], heaps: Sequence[Heap], band: Band) -> Trial:
    """Return the trial of the share of grains that still move at the end."""
    grains = round(float(np.mean([len(one.found.grains) for one in heaps])))
    return share_trial(part, chosen, [one.found.moving * grains for one in heaps], grains, band)


def typical(heaps: Sequence[Heap]) -> Heap:
    """Heap whose slope is nearest to the mean; the first one where most stand as walls."""
    found = slopes(heaps)
    if 2 * len(found) <= len(heaps):
        return heaps[0]
    mean = sum(found) / len(found)
    return min((one for one in heaps if not one.wall), key=lambda one: abs(one.slope() - mean))


def line(one: Heap) -> dict[str, object]:
    """Numbers of one heap."""
    return {
        "slope_deg": one.slope(),
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
