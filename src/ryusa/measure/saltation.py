"""Hops of grains over a fixed bed: how high, how long, how hard they land, how fast they spin."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.measure._hops import BOUNCE, HOP, Bounces, PathOverBed, path_over_bed
from ryusa.measure._run import Floats, Run, crest_of, settle_time
from ryusa.measure.collisions import ContactTimes, contact_times
from ryusa.measure.statistics import Average, average, begin_in_words, ratio
from ryusa.measure.table import Averaged, Averages, rows_of

RISE = 0.1  # in diameters: a flight that rises less belongs to one bounce
RISES = (0.0, 0.02, 0.05, 0.1, 0.2, 0.5)


@dataclass(frozen=True, repr=False)
class Saltation(Averaged):
    """Everything about the hops of a run.

    Attributes
    ----------
    hops : structured array, one row per hop (see HOP), by grain and time.
    bounces : structured array, one row per bounce (see BOUNCE).
    contact_time : touch-to-end-of-force of every bed contact in the window [s].
    times : what Eq. (8) says for this grain, without and with added mass and dashpot.
    rise : threshold that separates two bounces, in diameters.
    averages : means over all starts, with standard errors.
    """

    hops: NDArray[Any]
    bounces: NDArray[Any]
    contact_time: Floats
    times: ContactTimes
    rise: float
    averages: Averages

    def series(self) -> list[dict[str, object]]:
        """One dictionary per hop."""
        return rows_of(self.hops)


def saltation(
    run: Run,
    settle: float | None = None,
    rise: float = RISE,
    hops: int | None = None,
    grains: Sequence[int] | None = None,
) -> Saltation:
    """Measure the hops of every free grain over the fixed grains.

    Parameters
    ----------
    run : a run folder with contact events.
    settle : bounces that began before are left out [s]; default the case's `record.settle`.
    rise : flights that rise less than this many diameters above the take-off join their bounces into one.
    hops : use only the first so many hops of each grain; default all.
    grains : ids of free grains; default all.

    Notes
    -----
    Height is given twice: above the take-off, and above the centre of a grain that stands on a crest of the
    bed. Length is the distance between successive landings. Speed is total length over total time. Bed
    shear is the impulse against the flow that the bed gave, over time; the shear ratio is that over the
    normal impulse; bed friction is the part of the bed shear that tangential forces give. Averages weigh
    hops alike; each grain is one series for the standard errors.
    """
    scene = run.scene
    begin = settle_time(run) if settle is None else settle
    ids = range(scene.n_grain) if grains is None else grains
    paths = [path_over_bed(run, grain, rise) for grain in ids]
    found = [one.since(begin, hops) for one in paths]
    times = contact_times(scene, int(ids[0])) if len(ids) else ContactTimes(math.nan, math.nan, math.nan)
    return Saltation(
        hops=np.concatenate([one.hops for one in found]) if found else np.zeros(0, HOP),
        bounces=np.concatenate([one.bounces for one in found]) if found else np.zeros(0, BOUNCE),
        contact_time=np.concatenate([one.contact_time for one in found]) if found else np.zeros(0),
        times=times,
        rise=rise,
        averages=_averages(found, times, begin, rise, crest_of(scene), _begin(run, paths, settle)),
    )


def grouping(run: Run, rises: Sequence[float] = RISES, settle: float | None = None) -> list[Saltation]:
    """The same run with other thresholds for what counts as one saltation; one result per threshold."""
    return [saltation(run, settle=settle, rise=rise) for rise in rises]


def _begin(run: Run, paths: Sequence[PathOverBed], settle: float | None) -> str:
    """From when on the jump height is steady, in words, by all hops since the begin of the run."""
    every = [one.hops for one in paths]
    hops = np.sort(np.concatenate(every), order="t_begin") if every else np.zeros(0, HOP)
    return begin_in_words("jump_height", hops["t_begin"], hops["rise"], settle_time(run), settle)


def _averages(
    found: list[Bounces], times: ContactTimes, begin: float, rise: float, crest: float, suggested: str
) -> Averages:
    end = max((float(one.hops["t_end"][-1]) for one in found if len(one.hops)), default=math.nan)
    window = (begin, end)

    def over(name: str, unit: str, pick: Callable[[Bounces], Floats]) -> Average:
        return average(name, unit, [pick(one) for one in found], window)

    def hop(name: str, unit: str, field: str) -> Average:
        return over(name, unit, lambda one: one.hops[field])

    def bounce(name: str, unit: str, field: str) -> Average:
        return over(name, unit, lambda one: one.bounces[field])

    def quotient(name: str, unit: str, above: str, below: str) -> Average:
        tops, bottoms = [one.hops[above] for one in found], [one.hops[below] for one in found]
        return ratio(name, unit, tops, bottoms, window)

    items = (
        hop("jump_height", "m", "rise"),
        hop("jump_height_crest", "m", "above_crest"),
        hop("jump_length", "m", "length"),
        hop("flight_length", "m", "flight_length"),
        hop("flight_time", "s", "flight_time"),
        quotient("speed", "m/s", "length", "period"),
        over("contact_time", "s", lambda one: one.contact_time),
        over("contact_time_alone", "s", lambda one: one.contact_time_alone),
        over("contact_time_over_eq8", "-", lambda one: one.contact_time / times.eq_8),
        over("contact_time_alone_over_eq8", "-", lambda one: one.contact_time_alone / times.eq_8),
        bounce("bounce_time", "s", "duration"),
        bounce("contacts_per_bounce", "-", "n_contact"),
        bounce("spin_before", "rad/s", "omega_before"),
        bounce("spin_after", "rad/s", "omega_after"),
        hop("impulse_normal", "N s", "impulse_normal"),
        hop("impulse_shear", "N s", "impulse_shear"),
        hop("impulse_friction", "N s", "impulse_friction"),
        quotient("bed_normal", "N", "impulse_normal", "period"),
        quotient("bed_shear", "N", "impulse_shear", "period"),
        quotient("bed_friction", "N", "impulse_friction", "period"),
        quotient("shear_ratio", "-", "impulse_shear", "impulse_normal"),
    )
    count = sum(len(one.hops) for one in found)
    highest = max((float(one.hops["rise"].max()) for one in found if len(one.hops)), default=math.nan)
    added = f"; with added mass {times.added:.4g} s; and" if times.added != times.eq_8 else ";"
    notes = (
        suggested,
        f"{count} hops of {sum(1 for one in found if len(one.hops))} starts after {begin:g} s; "
        f"a flight that rises less than {rise:g} d counts as part of one bounce",
        f"highest jump {highest:.4g} m above take-off; crest of the bed at z = {crest:.4g} m",
        f"Eq. (8): {times.eq_8:.4g} s{added} with dashpot {times.damped:.4g} s",
    )
    return Averages("saltation", items, notes)
