"""What follows from [[feeds]]: times, numbers of grains, how densely a feed is filled."""

import math
from collections.abc import Sequence

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.course import Points, points_of
from ryusa.casefile.feeds.schema import FeedSection, read_rate
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import mass, mean_cube, sized_as
from ryusa.casefile.row.reach_source import fed_by_reach_in_all
from ryusa.model.arrays import Floats
from ryusa.model.course import Course
from ryusa.model.wall_feeds import corners_of_disc

FULLEST = 0.38  # largest share of a volume that spheres take that are placed at random one after another
FULLEST_PLANE = 0.547  # discs in a plane


def feed_begin(case: Case, feed: FeedSection) -> float:
    """When the first grain of a feed is due [s]."""
    course = sedigraph_of(case, feed)
    return feed.begin if course is None else course.when(0.0)


def feed_end(case: Case, feed: FeedSection) -> float:
    """When the last grain of a feed may be due [s]; inf where the case does not say."""
    ends = [one for one in (feed.end, case.stop.time) if one is not None]
    if (course := sedigraph_of(case, feed)) is not None:
        ends.append(course.t[-1])
    return min([*ends, end_of_total(case, feed)])


def end_of_total(case: Case, feed: FeedSection) -> float:
    """When a feed has brought its `total` [s]; inf without one, and where it never has."""
    if feed.total is None:
        return math.inf
    amount, unit = feed.total
    if unit == "kg" and unit_of(case, feed) != "kg/s":
        amount /= mean_mass(case, feed.material)
    elif unit == "grains" and unit_of(case, feed) == "kg/s":
        amount *= mean_mass(case, feed.material)
    if (course := sedigraph_of(case, feed)) is not None:
        return course.when(amount) if amount <= course.total(course.t[-1]) * (1.0 + 1e-12) else math.inf
    return feed.begin + amount / feed.rate[0] if feed.rate is not None and feed.rate[0] > 0.0 else math.inf


def sedigraph_of(case: Case, feed: FeedSection) -> Course | None:
    """Rate of a feed over time, in its unit; None where none is given."""
    if feed.sedigraph is None:
        return None
    points = sedigraph_points(case, feed)
    return Course(tuple(t for t, _ in points), tuple(rate for _, (rate, _) in points))


def sedigraph_points(case: Case, feed: FeedSection) -> Points:
    """Points of a sedigraph as given, or as its file holds them."""
    key = f"feeds.{case.feeds.index(feed)}.sedigraph"
    assert feed.sedigraph is not None
    return points_of(case.folder, key, feed.sedigraph, "rate", read_rate, "'t [s],rate [kg/s]'")


def unit_of(case: Case, feed: FeedSection) -> str:
    """Unit of the rate of a feed: kg/s or grains/s; nothing where none of its own grains come."""
    if feed.sedigraph is not None:
        return str(sedigraph_points(case, feed)[0][1][1])
    return "" if feed.rate is None else feed.rate[1]


def corners_of(feed: FeedSection) -> tuple[Floats, Floats] | None:
    """Lowest and highest corner of a feed [m], shape (3,) each; None where keys are missing."""
    if feed.low is not None and feed.high is not None:
        return np.array(feed.low), np.array(feed.high)
    if feed.centre is None or feed.radius is None or not any(feed.normal):
        return None
    return corners_of_disc(feed.centre, np.array(feed.normal) / math.hypot(*feed.normal), feed.radius)


def mean_mass(case: Case, material: str | None = None) -> float:
    """Mean mass of a grain of the size distribution of a material [kg]; not the mass of the mean grain."""
    sized = sized_as(case, material)
    d = reference_diameter(sized)
    heavier = 1.0
    if material in case.materials:
        heavier = (case.materials[material].density or case.grains.density) / case.grains.density
    return heavier * mass(sized, d)[0] * mean_cube(sized) / d**3


def grains_per_second(case: Case, feed: FeedSection) -> float:
    """Grains of its own that a feed brings in a second, at most where its rate changes."""
    course = sedigraph_of(case, feed)
    rate = max(course.y) if course is not None else 0.0 if feed.rate is None else feed.rate[0]
    return rate / mean_mass(case, feed.material) if unit_of(case, feed) == "kg/s" else rate


def fed_amount(case: Case, feed: FeedSection) -> float:
    """Grains or kilograms, as its rate has it, that a feed brings up to its end."""
    begin, end = feed_begin(case, feed), feed_end(case, feed)
    if (course := sedigraph_of(case, feed)) is not None:
        return max(course.total(end), 0.0)
    return 0.0 if feed.rate is None else feed.rate[0] * (end - begin)


def fed_count(case: Case, feed: FeedSection) -> int:
    """Number of its own grains that a feed brings; by the mean mass where its rate is a mass."""
    each = mean_mass(case, feed.material) if unit_of(case, feed) == "kg/s" else 1.0
    return math.ceil(fed_amount(case, feed) / each * (1.0 - 1e-12))


def fed_in_all(case: Case) -> int:
    """Number of grains that all feeds bring, that of a feeder reach too."""
    return sum(fed_count(case, feed) for feed in case.feeds) + fed_by_reach_in_all(case)


def share_filled(case: Case, feed: FeedSection, rate: float) -> float:
    """Share of the volume (in a plane scene area) at a feed that its grains fill [-].

    Parameters
    ----------
    rate : grains in a second.

    Notes
    -----
    A grain leaves a box after the time in which its velocity and gravity carry it through, and the place
    behind a disc after a diameter.
    """
    sized = sized_as(case, feed.material)
    plane, d, g = case.motion.plane, reference_diameter(sized), case.motion.gravity
    grain = math.pi / 4.0 * d * d if plane else math.pi / 6.0 * mean_cube(sized)
    if feed.radius is not None:
        return share_at_disc(rate * grain, feed.radius, _speed_through(feed), d, g, plane)
    assert feed.low is not None
    assert feed.high is not None
    sides = [b - a for a, b in zip(feed.low, feed.high, strict=True)]
    return share_in_box(rate * grain, sides, feed.velocity, g, plane)


def share_at_disc(volume: float, radius: float, speed: float, d: float, g: float, plane: bool) -> float:
    """Share of the room behind a disc that grains fill [-].

    Parameters
    ----------
    volume : of grains in a second [m3/s]; in a plane scene their area [m2/s].
    radius, speed : of the disc [m], and of grains through it [m/s].
    d, g : diameter [m] and gravity [m/s2].
    """
    speed = math.sqrt(speed * speed + 2.0 * g * d)
    opening = 2.0 * radius if plane else math.pi * radius**2
    return volume / (opening * speed) if speed > 0.0 else math.inf


def share_in_box(
    volume: float, sides: Sequence[float], velocity: Sequence[float], g: float, plane: bool
) -> float:
    """Share of a box of given sides [m] that grains fill [-]; the others as in `share_at_disc`."""
    times = [
        _time_through(side, abs(speed), g if axis == 2 else 0.0)
        for axis, (side, speed) in enumerate(zip(sides, velocity, strict=True))
        if not (plane and axis == 1)
    ]
    room = sides[0] * sides[2] * (1.0 if plane else sides[1])
    return volume * min(times) / room if room > 0.0 else math.inf


def _speed_through(feed: FeedSection) -> float:
    """Speed at which grains pass a disc [m/s]."""
    along = sum(v * n for v, n in zip(feed.velocity, feed.normal, strict=True))
    return abs(along) / math.hypot(*feed.normal)


def _time_through(side: float, speed: float, g: float) -> float:
    """Time to pass a side [m] from a speed [m/s] under gravity [m/s2]; inf at rest."""
    if g > 0.0:
        return (math.sqrt(speed * speed + 2.0 * g * side) - speed) / g
    return side / speed if speed > 0.0 else math.inf
