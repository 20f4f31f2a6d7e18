"""Estimates of what the flow of a row can carry, and of the deposit behind a dam."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.column.packed import packed
from ryusa.casefile.feeds.schema import FeedSection
from ryusa.casefile.feeds.values import corners_of, feed_end, grains_per_second, mean_mass
from ryusa.casefile.grading import grading_of, reference_diameter
from ryusa.casefile.motion import slope
from ryusa.casefile.row.ends import discharge_of, hydrograph_of, width_of
from ryusa.casefile.row.reach_source import fed_by_reach
from ryusa.casefile.row.schema import RowDamSection
from ryusa.casefile.row.values import bed_over, bottom_points, crest_of, dam_span, normal_depth, row_plan
from ryusa.laws.transport import solid_discharge_smart_jaeggi

GENTLEST, STEEPEST = 0.005, 0.2  # slopes of the experiments of Smart and Jaeggi [-]
THRESHOLD = 0.05  # Shields number at the threshold of motion [-]
CLOSE = 1.0e-9  # of a slope, which is rounded


@dataclass(frozen=True)
class DamDeposit:
    """The deposit behind a dam, as wide as the stream.

    Attributes
    ----------
    slope : of its surface, at which the flow carries on what the feeds bring [-]; 0.005 where that is less.
    volume : between dam, bed and that surface, with pores, per width [m2].
    time : in which the feeds bring it [s].
    reaches_feed : whether the surface meets the first feed before it meets the bed.
    lasts : how long the feed that lasts longest brings grains [s].
    length : from the dam to where the surface meets the bed or the feed [m].
    adapts : h/S, the way over which the flow becomes normal on the deposit [m].
    """

    slope: float
    volume: float
    time: float
    reaches_feed: bool
    lasts: float
    length: float
    adapts: float


def capacity(case: Case, angle: float, q: float) -> float:
    """Volume of grains that uniform flow of a discharge [m2/s] carries on a slope [rad], per width [m2/s].

    nan without a discharge, for grains that do not sink, and outside the slopes of the formula.
    """
    wet, tangent = case.water, math.tan(angle)
    if wet is None or not q > 0.0 or not GENTLEST * (1.0 - CLOSE) <= tangent <= STEEPEST * (1.0 + CLOSE):
        return math.nan
    s, graded = case.grains.density / wet.density, grading_of(case)
    if not s > 1.0:
        return math.nan
    spread = 1.0 if graded is None else graded.diameter(0.9) / graded.diameter(0.3)
    depth, d = normal_depth(case, q, angle), reference_diameter(case)
    return solid_discharge_smart_jaeggi(q, tangent, depth, s, d, spread, THRESHOLD)


def shields_number(case: Case, angle: float, depth: float) -> float:
    """Shields number of uniform flow of a depth [m] on a slope [rad] [-]; nan for grains that do not sink."""
    wet = case.water
    if wet is None or not case.grains.density > wet.density:
        return math.nan
    return depth * math.sin(angle) / ((case.grains.density / wet.density - 1.0) * reference_diameter(case))


def dam_deposit(case: Case, dam: RowDamSection) -> DamDeposit | None:
    """The deposit that feeds build behind a dam; None where no estimate can be made.

    Notes
    -----
    Behind the dam the bed takes the slope at which the flow carries the feed on, from the crest upstream to
    where it meets the bed of the start: V = P**2/(2 (S_0 - S)) behind a dam P high on a plane bed of slope
    S_0. Half a diameter of bed above or of room below that surface counts as none. No estimate is made for
    the second dam below a feed, for one that lets water through, for a hydrograph or a feeder reach, and for
    a feed beyond the formula, of another material, or to which an exit leads.
    """
    keys, width, plan = case.row, width_of(case), row_plan(case)
    first = plan.x_low + dam_span(plan, dam)[0] * plan.dx
    feeds = [(at, one) for one in case.feeds if (at := _place(one)) is not None and at < first]
    back = {one.to for one in case.exits}
    odd = any(one.material is not None or one.name in back for _, one in feeds)
    odd = odd or any(one.discharge is not None for one in case.timeline) or hydrograph_of(case) is not None
    odd = odd or fed_by_reach(case.row)
    if keys is None or width is None or dam.concentration is not None or not feeds or odd:
        return None
    start = max(at for at, _ in feeds)
    if any(start < other.begin < dam.begin and other.concentration is None for other in keys.dams):
        return None
    rate = sum(_volume_rate(case, one) for _, one in feeds) / width
    angle = _slope_that_carries(case, rate)
    if angle is None or not rate > 0.0:
        return None
    x = np.linspace(start, first, 4001)
    low = np.interp(x, *np.array(bottom_points(case)).T) + bed_over(case, x)
    room = crest_of(plan, dam) + (first - x) * math.tan(angle - slope(case.motion)) - low
    half = 0.5 * reference_diameter(case)
    shut = np.flatnonzero(room <= -half)
    taken = room[shut[-1] + 1 if len(shut) else 0 :].clip(0.0)
    dx = x[1] - x[0]
    volume = float(taken.sum() * dx) if taken.max(initial=0.0) > half else 0.0
    return DamDeposit(
        slope=math.tan(angle),
        volume=volume,
        time=volume * packed(case) / rate,
        reaches_feed=not len(shut),
        lasts=max(feed_end(case, one) - one.begin for _, one in feeds),
        length=float((taken > half).sum() * dx),
        adapts=normal_depth(case, discharge_of(case), angle) / math.tan(angle),
    )


def _place(feed: FeedSection) -> float | None:
    """Middle of a feed along the row [m]; None where it moves or its keys are missing."""
    corners = None if feed.moves_with is not None else corners_of(feed)
    return None if corners is None else float(0.5 * (corners[0][0] + corners[1][0]))


def _volume_rate(case: Case, feed: FeedSection) -> float:
    """Volume of grains that a feed brings [m3/s]."""
    own = case.materials.get(feed.material or "")
    density = (own.density if own is not None else None) or case.grains.density
    return grains_per_second(case, feed) * mean_mass(case, feed.material) / density


def _slope_that_carries(case: Case, rate: float) -> float | None:
    """Slope at which uniform flow carries a volume per width [m2/s] [rad]; None beyond the formula."""
    low, high = math.atan(GENTLEST), math.atan(STEEPEST)
    q = discharge_of(case)
    if not capacity(case, high, q) >= rate:
        return None
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if capacity(case, middle, q) < rate else (low, middle)
    return high
