"""Checks of [[feeds]] and [[exits]]."""

import math
from collections.abc import Iterator, Sequence
from itertools import product

from ryusa.casefile.builders.schema import DropSection, EmptySection, SaltationSection
from ryusa.casefile.builders.values import periodic, size_range, sizes
from ryusa.casefile.case import Case
from ryusa.casefile.course import faults_of_course
from ryusa.casefile.domain import DomainSection
from ryusa.casefile.feeds.schema import ExitSection, FeedSection
from ryusa.casefile.feeds.values import (
    FULLEST,
    FULLEST_PLANE,
    end_of_total,
    fed_count,
    feed_begin,
    feed_end,
    grains_per_second,
    sedigraph_of,
    sedigraph_points,
    share_filled,
    unit_of,
)
from ryusa.casefile.motion import MotionSection
from ryusa.casefile.section import given
from ryusa.casefile.shape import extent
from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

Corners = tuple[Sequence[float], Sequence[float]]


def check_traffic(case: Case) -> Iterator[CaseError]:
    """Find feeds and exits that are incomplete, contradict others, or cannot do what they are asked."""
    if not case.feeds and not case.exits:
        if isinstance(case.build, EmptySection) and case.row is None:
            yield CaseError("build.kind", "empty", "gives no grain; give [[feeds]]")
        return
    if isinstance(case.build, EmptySection) and not any(feed.brings for feed in case.feeds):
        yield CaseError("build.kind", "empty", "gives no grain, and no feed has a rate: give feeds.0.rate")
    yield from _case(case)
    yield from _names(case)
    yield from _walls(case)
    shapes = [*_shapes(case)]
    yield from shapes
    if not shapes:
        for k, feed in enumerate(case.feeds):
            yield from _feed(case, f"feeds.{k}", feed)
        yield from _targets(case.feeds, case.domain)
        for k, one in enumerate(case.exits):
            yield from _reach(case, f"exits.{k}", one)


def _case(case: Case) -> Iterator[CaseError]:
    """Find what does not go together with grains that enter and leave."""
    if isinstance(case.build, DropSection | SaltationSection):
        key = "feeds" if case.feeds else "exits"
        yield CaseError(key, None, f"cannot be used with builder '{case.build.kind}', whose starts are alone")
    if case.stop.saltations is not None:
        yield CaseError("stop.saltations", case.stop.saltations, "cannot end a run with feeds or exits")
    if case.stop.precision is not None:
        yield CaseError("stop.precision", None, "cannot end a run with feeds or exits; give stop.time")


def _names(case: Case) -> Iterator[CaseError]:
    """Find names used twice, and exits that lead to no feed."""
    taken = [one.name for one in (*case.planes, *case.walls)] + ["grains", "bed"]
    names = [feed.name for feed in case.feeds]
    for kind, entries in (("feeds", case.feeds), ("exits", case.exits)):
        for k, one in enumerate(entries):
            if one.name in taken:
                yield CaseError(f"{kind}.{k}.name", one.name, "is used twice")
            taken.append(one.name)
    for k, one in enumerate(case.exits):
        if one.to is not None and one.to not in names:
            allowed = f"must be a feed: {', '.join(names) or 'there is none'}"
            yield CaseError(f"exits.{k}.to", one.to, allowed, nearest_word(one.to, names))


def _walls(case: Case) -> Iterator[CaseError]:
    """Find feeds and exits that move with a wall that is not there, or is removed."""
    names, removed = [wall.name for wall in case.walls], [entry.remove for entry in case.timeline]
    for kind, entries in (("feeds", case.feeds), ("exits", case.exits)):
        for k, one in enumerate(entries):
            key, name = f"{kind}.{k}.moves_with", one.moves_with
            if name is None:
                continue
            if name not in names:
                allowed = f"must be one of [[walls]]: {', '.join(names) or 'there is none'}"
                yield CaseError(key, name, allowed, nearest_word(name, names))
            elif name in removed:
                yield CaseError(key, name, "is removed by the timeline, and must stay to the end")
            elif kind == "exits" and any(periodic(case)):
                yield CaseError(
                    key, name, "cannot be used where x or y is periodic: the exit would leave the period"
                )


def _shapes(case: Case) -> Iterator[CaseError]:
    """Find regions with missing keys, without a direction or a volume, or beside a plane scene."""
    for k, feed in enumerate(case.feeds):
        key = f"feeds.{k}"
        box, disc = (feed.low, feed.high), (feed.centre, feed.radius)
        if any(one is not None for one in box) == any(one is not None for one in disc):
            yield CaseError(key, None, "needs either low and high (a box) or centre and radius (a disc)")
            continue
        pairs = (("low", "high"), box) if box != (None, None) else (("centre", "radius"), disc)
        yield from _missing(key, *pairs)
        yield from _direction(case.motion, f"{key}.normal", feed.normal, "normal" in feed.model_fields_set)
        yield from _box(case.motion, key, feed.low, feed.high, _largest(case, feed))
        if case.motion.plane:
            for name, point in (("centre", feed.centre), ("velocity", feed.velocity)):
                if point is not None and point[1] != 0.0:
                    yield CaseError(f"{key}.{name}", list(point), "must have y = 0 in a plane scene")
    for k, one in enumerate(case.exits):
        key = f"exits.{k}"
        box, plane = (one.low, one.high), (one.point, one.normal)
        if any(part is not None for part in box) == any(part is not None for part in plane):
            yield CaseError(key, None, "needs either point and normal (a plane) or low and high (a box)")
            continue
        pairs = (("low", "high"), box) if box != (None, None) else (("point", "normal"), plane)
        yield from _missing(key, *pairs)
        if one.normal is not None:
            yield from _direction(case.motion, f"{key}.normal", one.normal, True)
            for axis, is_periodic in zip((0, 1), periodic(case), strict=True):
                if is_periodic and one.normal[axis] != 0.0:
                    name = "xy"[axis]
                    yield CaseError(
                        f"{key}.normal", list(one.normal), f"must have {name} = 0, because {name} is periodic"
                    )
        yield from _box(case.motion, key, one.low, one.high, _largest(case))


def _missing(key: str, names: tuple[str, str], values: tuple[object, object]) -> Iterator[CaseError]:
    for name, value in zip(names, values, strict=True):
        if value is None:
            other = next(one for one in names if one != name)
            yield CaseError(f"{key}.{name}", None, f"missing; {other} needs it")


def _direction(motion: MotionSection, key: str, normal: Sequence[float], given: bool) -> Iterator[CaseError]:
    if given and not any(normal):
        yield CaseError(key, list(normal), "must not be zero")
    elif given and motion.plane and normal[1] != 0.0:
        yield CaseError(key, list(normal), "must have y = 0 in a plane scene")


def _largest(case: Case, feed: FeedSection | None = None) -> float:
    """Diameter of the sphere that holds the largest grain, or that of a feed, however it is turned [m]."""
    own = feed is not None and not _led(case.exits, feed)
    return (size_range(case, feed.material)[1] if own and feed else sizes(case)[2]) * extent(case)


def _led(exits: tuple[ExitSection, ...], feed: FeedSection) -> bool:
    """Whether an exit leads to a feed, which may bring it grains of any size."""
    return any(one.to == feed.name for one in exits)


def _box(
    motion: MotionSection, key: str, low: Sequence[float] | None, high: Sequence[float] | None, largest: float
) -> Iterator[CaseError]:
    """Find boxes without a volume, or thinner than the largest grain."""
    if low is None or high is None:
        return
    plane = motion.plane
    if plane and (low[1], high[1]) != (0.0, 0.0):
        yield CaseError(f"{key}.low", list(low), "must have y = 0 in a plane scene, as high")
    axes = (0, 2) if plane else (0, 1, 2)
    if any(low[axis] >= high[axis] for axis in axes):
        yield CaseError(f"{key}.low", list(low), f"must lie below {key}.high in every direction")
    elif min(high[axis] - low[axis] for axis in axes) < largest:
        yield CaseError(
            key, None, f"is smaller than the largest grain, {largest:.4g} m: make the box wider than that"
        )


def _feed(case: Case, key: str, feed: FeedSection) -> Iterator[CaseError]:
    """Find feeds without grains, with too small an opening, or a rate that cannot fit."""
    largest = _largest(case, feed)
    if feed.radius is not None and 2.0 * feed.radius < largest:
        yield CaseError(
            f"{key}.radius", feed.radius, f"is too small for the largest grain: at least {largest / 2:.4g} m"
        )
        return
    if not feed.brings and not _led(case.exits, feed):
        yield CaseError(f"{key}.rate", None, "missing; no exit leads to this feed, so it would bring nothing")
    if feed.sedigraph is not None:
        faults = [*_sedigraph(case, key, feed)]
        yield from faults or _rate(case, key, feed)
    elif feed.rate is not None:
        yield from _rate(case, key, feed)
    for k, one in enumerate(case.exits):
        if _meet(feed, one):
            yield CaseError(
                key,
                None,
                f"lies within exits.{k} ('{one.name}'): its grains would leave at once; move one of them",
            )
    points = _points(feed)
    for plane in case.planes:
        away = [
            sum(n * (a - b) for n, a, b in zip(plane.normal, x, plane.point, strict=True)) for x in points
        ]
        if max(away) <= 0.0:
            yield CaseError(key, None, f"lies behind the plane '{plane.name}': no grain finds a place there")


def _sedigraph(case: Case, key: str, feed: FeedSection) -> Iterator[CaseError]:
    """Find a sedigraph beside what it stands for, out of order, or with rates that cannot be."""
    for name in ("rate", "begin", "end"):
        if given(feed, name):
            yield CaseError(f"{key}.{name}", None, f"stands beside {key}.sedigraph, which says it: give one")
    points = sedigraph_points(case, feed)
    yield from faults_of_course(f"{key}.sedigraph", points)
    units = sorted({unit for _, (_, unit) in points})
    if len(units) > 1:
        yield CaseError(f"{key}.sedigraph", None, f"mixes {' and '.join(units)}: give all rates alike")
    for t, (rate, unit) in points:
        if not 0.0 <= rate < math.inf:
            yield CaseError(f"{key}.sedigraph", f"{rate:g} {unit}", f"is at {t:g} s; must be 0 or above")
            return
    if not any(rate > 0.0 for _, (rate, _) in points):
        yield CaseError(f"{key}.sedigraph", None, "brings no grain: every rate is 0")


def _rate(case: Case, key: str, feed: FeedSection) -> Iterator[CaseError]:
    course, begin = sedigraph_of(case, feed), feed_begin(case, feed)
    rate, unit = (max(course.y), unit_of(case, feed)) if course is not None else feed.rate or (0.0, "")
    text, end, which = f"{rate:g} {unit}", feed_end(case, feed), "rate" if course is None else "sedigraph"
    if not 0.0 < rate < math.inf:
        yield CaseError(f"{key}.rate", text, "must be greater than 0")
        return
    if feed.total is not None:
        amount, name = feed.total
        lasts = [feed.end, case.stop.time, None if course is None else course.t[-1]]
        last, done = min(one for one in (*lasts, math.inf) if one is not None), end_of_total(case, feed)
        if not amount > 0.0:
            yield CaseError(f"{key}.total", f"{amount:g} {name}", "must be greater than 0")
            return
        if done > last * (1.0 + 1e-9):
            needs = "" if course else f": at this rate it takes {done - begin:.4g} s from {begin:g} s on"
            yield CaseError(f"{key}.total", f"{amount:g} {name}", f"is not fed by {last:g} s{needs}")
            return
    if math.isinf(end):
        yield CaseError(f"{key}.end", None, "missing; without stop.time a feed needs an end")
        return
    if begin >= end:
        name = "end" if feed.end is not None and feed.end == end else "begin"
        name = name if course is None else which
        yield CaseError(
            f"{key}.{name}",
            begin if course else getattr(feed, name),
            "leaves no time to feed: begin must come before end and stop.time",
        )
        return
    if fed_count(case, feed) < 1:
        yield CaseError(f"{key}.{which}", text, f"brings no grain before {end:g} s")
    most = FULLEST_PLANE if case.motion.plane else FULLEST
    share = share_filled(case, feed, grains_per_second(case, feed))
    if share > most:
        fits = rate * most / share
        yield CaseError(
            f"{key}.{which}", text,
            f"cannot fit: grains would fill {share:.2g} of the room at the feed, and at most {most:g} can be "
            f"filled at random; lower it below {fits:.3g} {unit}, or give more room or speed",
        )  # fmt: skip


def _targets(feeds: tuple[FeedSection, ...], domain: DomainSection) -> Iterator[CaseError]:
    """Find feeds outside the domain that the case gives."""
    low, high = domain.low, domain.high
    for k, feed in enumerate(feeds):
        for x in _points(feed):
            if (low is not None and any(a < b for a, b in zip(x, low, strict=True))) or (
                high is not None and any(a > b for a, b in zip(x, high, strict=True))
            ):
                yield CaseError(f"feeds.{k}", None, "lies outside domain.low and domain.high")
                break


def _reach(case: Case, key: str, one: ExitSection) -> Iterator[CaseError]:
    """Find exits that no grain can get to: outside the domain, or behind a plane that is never removed."""
    corners = None
    if one.low is not None and one.high is not None:
        corners = list(product(*zip(one.low, one.high, strict=True)))
    low, high = case.domain.low, case.domain.high
    if corners is not None:
        apart = low is not None and any(b < a for a, b in zip(low, one.high or low, strict=True))
        apart |= high is not None and any(b > a for a, b in zip(high, one.low or high, strict=True))
    elif low is not None and high is not None and one.point is not None and one.normal is not None:
        within = [_above(x, one.point, one.normal) for x in product(*zip(low, high, strict=True))]
        apart = max(within) <= 0.0
    else:
        apart = False
    if apart:
        yield CaseError(key, one.name, "lies outside domain.low and domain.high: no grain gets there")
    removed = {entry.remove for entry in case.timeline}
    for plane in case.planes:
        if plane.name in removed:
            continue
        if corners is not None:
            behind = max(_above(x, plane.point, plane.normal) for x in corners) <= 0.0
        else:
            assert one.point is not None
            assert one.normal is not None
            behind = _opposite(one.normal, plane.normal) and _above(one.point, plane.point, plane.normal) <= 0
        if behind:
            yield CaseError(key, one.name, f"lies behind the plane '{plane.name}': no grain gets there")


def _above(x: Sequence[float], point: Sequence[float], normal: Sequence[float]) -> float:
    """Height of a point above a plane, times the length of its normal."""
    return sum(n * (a - b) for n, a, b in zip(normal, x, point, strict=True))


def _opposite(one: Sequence[float], other: Sequence[float]) -> bool:
    """Whether two directions are opposite."""
    along = sum(a * b for a, b in zip(one, other, strict=True))
    return along <= -(1.0 - 1e-12) * math.hypot(*one) * math.hypot(*other)


def _points(feed: FeedSection) -> list[tuple[float, ...]]:
    """Corners of a box, or four points on the rim of a disc [m]."""
    if feed.low is not None and feed.high is not None:
        pairs = list(zip(feed.low, feed.high, strict=True))
        return [(x, y, z) for x in pairs[0] for y in pairs[1] for z in pairs[2]]
    assert feed.centre is not None
    assert feed.radius is not None
    a, b, c = (part / math.hypot(*feed.normal) for part in feed.normal)
    level = math.hypot(a, c)
    one = (c / level, 0.0, -a / level) if level > 0.0 else (1.0, 0.0, 0.0)
    other = (b * one[2], c * one[0] - a * one[2], -b * one[0])
    sides = [tuple(sign * part for part in side) for side in (one, other) for sign in (-1.0, 1.0)]
    return [tuple(x + feed.radius * s for x, s in zip(feed.centre, side, strict=True)) for side in sides]


def _meet(feed: FeedSection, one: ExitSection) -> bool:
    """Whether a grain of a feed can be within an exit when it enters."""
    points = _points(feed)
    if one.point is not None and one.normal is not None:
        away = [sum(n * (a - b) for n, a, b in zip(one.normal, x, one.point, strict=True)) for x in points]
        return max(away) > 0.0
    assert one.low is not None
    assert one.high is not None
    low, high = (tuple(part(x[k] for x in points) for k in range(3)) for part in (min, max))
    return all(a <= d and c <= b for a, b, c, d in zip(low, high, one.low, one.high, strict=True))
