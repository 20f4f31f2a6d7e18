"""Feeds and exits of a scene from arrays: grains of given sizes that enter, and places where grains leave."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from ryusa.build.feeds import seed_of_feed
from ryusa.build.placement import Placement, at_rest
from ryusa.casefile.feeds.values import FULLEST, FULLEST_PLANE, share_at_disc, share_in_box
from ryusa.errors import CaseError
from ryusa.model import Exit, Feed, Scene, Traffic
from ryusa.model.feeds import NONE, Vector
from ryusa.model.scene import Floats
from ryusa.model.wall_feeds import corners
from ryusa.spelling import nearest_word

_WIDE = 1.0e9  # half the width across a plane scene of the box of an exit [m]


@dataclass(frozen=True)
class FedGrains:
    """A feed with the grains that it will bring."""

    place: Feed
    d: Floats  # diameters in the order in which they enter [m]
    moves_with: str | None = None  # name of a wall


@dataclass(frozen=True)
class Outlet:
    """An exit, with the names of the feed that it leads to and of the wall with which it moves."""

    place: Exit
    to: str | None = None
    moves_with: str | None = None


def feed_disc(
    name: str,
    d: ArrayLike,
    rate: float,
    centre: Sequence[float],
    radius: float,
    *,
    normal: Sequence[float] = (0.0, 0.0, -1.0),
    by_mass: bool = False,
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    begin: float = 0.0,
    moves_with: str | None = None,
) -> FedGrains:
    """A disc that grains pass on their way in, evenly in time.

    Parameters
    ----------
    name : of the feed, and of the group of its grains.
    d : diameters of the grains that it brings, in their order [m], shape (n,); none where it only takes what
        an exit sends.
    rate : grains in a second, or with `by_mass` kilograms in a second; 0 where `d` is empty.
    centre, radius, normal : of the disc [m]; the length of `normal` means nothing.
    velocity : of every grain that enters [m/s], relative to the wall with which the feed moves.
    begin : when the first grain is due [s].
    moves_with : name of a wall; place, normal and velocity are those at t = 0.

    >>> feed_disc("hose", [0.002] * 50, 500.0, (0, 0, 0.045), 0.01).place.is_box
    False
    """
    place = Feed(
        name, centre=_vector(centre, "centre"), normal=_unit(normal, "normal"), radius=float(radius),
        velocity=_vector(velocity, "velocity"), rate=float(rate), by_mass=by_mass, begin=float(begin),
    )  # fmt: skip
    return FedGrains(place, np.asarray(d, np.float64), moves_with)


def feed_box(
    name: str,
    d: ArrayLike,
    rate: float,
    low: Sequence[float],
    high: Sequence[float],
    *,
    by_mass: bool = False,
    velocity: Sequence[float] = (0.0, 0.0, 0.0),
    begin: float = 0.0,
    moves_with: str | None = None,
) -> FedGrains:
    """A box in which whole grains are placed at random; `low` and `high` are its corners [m].

    The other parameters are those of `feed_disc`.
    """
    place = Feed(
        name, low=_vector(low, "low"), high=_vector(high, "high"), velocity=_vector(velocity, "velocity"),
        rate=float(rate), by_mass=by_mass, begin=float(begin),
    )  # fmt: skip
    return FedGrains(place, np.asarray(d, np.float64), moves_with)


def exit_plane(
    name: str,
    point: Sequence[float],
    normal: Sequence[float],
    *,
    to: str | None = None,
    moves_with: str | None = None,
) -> Outlet:
    """A plane beyond which grains leave, in the direction of `normal`; their centre counts.

    Parameters
    ----------
    point : on the plane [m].
    to : name of a feed at which they come in again.
    moves_with : name of a wall; the plane is where it is at t = 0.
    """
    place = Exit(name, point=_vector(point, "point"), normal=_unit(normal, "normal"))
    return Outlet(place, to, moves_with)


def exit_box(
    name: str,
    low: Sequence[float],
    high: Sequence[float],
    *,
    to: str | None = None,
    moves_with: str | None = None,
) -> Outlet:
    """A box in which grains leave; `low` and `high` are its corners [m], the others as in `exit_plane`."""
    return Outlet(Exit(name, low=_vector(low, "low"), high=_vector(high, "high")), to, moves_with)


def with_array_feeds(placement: Placement, feeds: Sequence[FedGrains]) -> Placement:
    """Add the grains that feeds will bring after the first ones, each waiting at its feed."""
    n_first = first = len(placement.d)
    sizes, centres, groups = [placement.d], [placement.x], list[tuple[str, int, int]]()
    for one in feeds:
        low, high = corners(one.place)
        sizes.append(one.d)
        centres.append(np.tile(0.5 * (low + high), (len(one.d), 1)))
        groups += [(one.place.name, first, len(one.d))] if len(one.d) else []
        first += len(one.d)
    waiting = at_rest(first - n_first)
    return replace(
        placement, d=np.concatenate(sizes), x=np.concatenate(centres),
        v=np.concatenate([placement.v, waiting]), omega=np.concatenate([placement.omega, waiting]),
        free_groups=tuple(groups),
    )  # fmt: skip


def array_traffic(
    feeds: Sequence[FedGrains],
    exits: Sequence[Outlet],
    walls: Sequence[str],
    n_first: int,
    seed: int,
    plane_case: bool,
) -> Traffic | None:
    """Feeds and exits as a scene has them, its interval still 1; `walls` are the names of its walls."""
    if not feeds and not exits:
        return None
    names, first = [one.place.name for one in feeds], n_first
    made: list[Feed] = []
    for k, one in enumerate(feeds):
        wall = NONE if one.moves_with is None else walls.index(one.moves_with)
        count = len(one.d)
        made.append(replace(one.place, first=first, count=count, seed=seed_of_feed(seed, k), wall=wall))
        first += count
    out: list[Exit] = []
    for way in exits:
        wall = NONE if way.moves_with is None else walls.index(way.moves_with)
        place = replace(way.place, to=NONE if way.to is None else names.index(way.to), wall=wall)
        if plane_case and not place.is_plane:
            (a, _, c), (b, _, e) = place.low, place.high
            place = replace(place, low=(a, -_WIDE, c), high=(b, _WIDE, e))
        out.append(place)
    return Traffic(tuple(made), tuple(out), 1, n_first)


def refuse_traffic(
    feeds: Sequence[FedGrains],
    exits: Sequence[Outlet],
    taken: Sequence[str],
    walls: Sequence[str],
    plane_case: bool,
    period: tuple[float, float],
) -> None:
    """Raise a `CaseError` for a feed or an exit that cannot do what it is asked.

    Parameters
    ----------
    taken : names of planes, walls and groups.
    walls : names of walls, with which feeds and exits may move.
    """
    used, names = list(taken), [one.place.name for one in feeds]
    for key, ways in (("feeds", feeds), ("exits", exits)):
        for k, one in enumerate(ways):
            if one.place.name in used:
                raise CaseError(f"{key}.{k}.name", one.place.name, "is used twice")
            used.append(one.place.name)
            if one.moves_with is not None and one.moves_with not in walls:
                allowed = f"must be one of the walls: {', '.join(walls) or 'there is none'}"
                raise CaseError(
                    f"{key}.{k}.moves_with", one.moves_with, allowed, nearest_word(one.moves_with, walls)
                )
    for k, one in enumerate(feeds):
        led = any(way.to == one.place.name for way in exits)
        _refuse_feed(f"feeds.{k}", one, led, plane_case)
    for k, way in enumerate(exits):
        _refuse_exit(f"exits.{k}", way, names, plane_case, period)
        for one in feeds:
            if _meet(one.place, way.place):
                raise CaseError(
                    f"exits.{k}", way.place.name,
                    f"holds a part of feed '{one.place.name}', whose grains would leave at once; move one of "
                    "them",
                )  # fmt: skip


def refuse_crowded_feeds(scene: Scene) -> None:
    """Raise a `CaseError` for a feed whose grains cannot all find room at its rate."""
    g, plane = float(np.linalg.norm(scene.gravity)), scene.plane_case
    most = FULLEST_PLANE if plane else FULLEST
    for k, feed in enumerate(scene.traffic.feeds if scene.traffic is not None else ()):
        if not feed.count:
            continue
        own = slice(feed.first, feed.first + feed.count)
        d = scene.d[own]
        per_grain = float(np.mean(np.pi / 4.0 * d**2 if plane else np.pi / 6.0 * d**3))
        volume = per_grain * feed.rate / (float(np.mean(scene.m[own])) if feed.by_mass else 1.0)
        if feed.is_box:
            sides = [b - a for a, b in zip(feed.low, feed.high, strict=True)]
            share = share_in_box(volume, sides, feed.velocity, g, plane)
        else:
            through = abs(sum(v * n for v, n in zip(feed.velocity, feed.normal, strict=True)))
            share = share_at_disc(volume, feed.radius, through, float(np.mean(d)), g, plane)
        if share > most:
            unit = "kg/s" if feed.by_mass else "grains/s"
            raise CaseError(
                f"feeds.{k}.rate", feed.rate,
                f"cannot fit: grains would fill {share:.2g} of the room at the feed, and at most {most:g} "
                f"can be filled at random; lower it below {feed.rate * most / share:.3g} {unit}, or give "
                "more room or speed",
            )  # fmt: skip


def _refuse_feed(key: str, one: FedGrains, led: bool, plane_case: bool) -> None:
    place, d = one.place, one.d
    if d.ndim != 1 or not np.all(np.isfinite(d) & (d > 0.0)):
        raise CaseError(f"{key}.d", None, f"must have shape (n,), finite and greater than 0, not {d.shape}")
    if len(d) and not 0.0 < place.rate < math.inf:
        raise CaseError(f"{key}.rate", place.rate, "must be finite and greater than 0")
    if not len(d) and (place.rate != 0.0 or not led):
        raise CaseError(f"{key}.d", None, "brings no grain: give diameters, or lead an exit here at rate 0")
    if not 0.0 <= place.begin < math.inf:
        raise CaseError(f"{key}.begin", place.begin, "must be finite and at least 0")
    largest = float(d.max(initial=0.0))
    if place.is_box:
        _refuse_box(key, place.low, place.high, largest, plane_case)
    elif not max(0.5 * largest, 1e-300) <= place.radius < math.inf:
        raise CaseError(f"{key}.radius", place.radius, f"must be finite and at least {0.5 * largest:.4g} m")
    if plane_case:
        for name, vector in (
            ("velocity", place.velocity),
            ("centre", place.centre),
            ("normal", place.normal),
        ):
            if not (math.isnan(vector[1]) or vector[1] == 0.0):
                raise CaseError(f"{key}.{name}", vector, "must have y = 0 in a plane scene")


def _refuse_box(key: str, low: Vector, high: Vector, largest: float, plane_case: bool) -> None:
    axes = (0, 2) if plane_case else (0, 1, 2)
    if plane_case and (low[1], high[1]) != (0.0, 0.0):
        raise CaseError(f"{key}.low", low, "must have y = 0 in a plane scene, as high")
    if any(low[axis] >= high[axis] for axis in axes):
        raise CaseError(f"{key}.low", low, f"must lie below {key}.high, {high}, in every direction")
    if min(high[axis] - low[axis] for axis in axes) < largest:
        raise CaseError(key, None, f"is smaller than its largest grain, {largest:.4g} m: make it wider")


def _refuse_exit(
    key: str, way: Outlet, feeds: Sequence[str], plane_case: bool, period: tuple[float, float]
) -> None:
    place = way.place
    if way.to is not None and way.to not in feeds:
        allowed = f"must be a feed: {', '.join(feeds) or 'there is none'}"
        raise CaseError(f"{key}.to", way.to, allowed, nearest_word(way.to, feeds))
    if way.moves_with is not None and any(math.isfinite(one) for one in period):
        raise CaseError(
            f"{key}.moves_with", way.moves_with,
            "cannot be used where x or y is periodic: the exit would leave the period",
        )  # fmt: skip
    if not place.is_plane:
        _refuse_box(key, place.low, place.high, 0.0, plane_case)
        return
    for axis, name in enumerate("xy"):
        if place.normal[axis] == 0.0:
            continue
        if math.isfinite(period[axis]):
            raise CaseError(f"{key}.normal", place.normal, f"must have {name} = 0, because it is periodic")
        if plane_case and axis == 1:
            raise CaseError(f"{key}.normal", place.normal, "must have y = 0 in a plane scene")


def _meet(feed: Feed, way: Exit) -> bool:
    """Whether a grain can be within an exit as it enters."""
    low, high = corners(feed)
    if not way.is_plane:
        return bool(np.all(low <= np.array(way.high)) and np.all(high >= np.array(way.low)))
    normal, middle = np.array(way.normal), 0.5 * (low + high)
    if feed.is_box:
        reach = float(0.5 * (high - low) @ np.abs(normal))
    else:
        reach = feed.radius * math.sqrt(max(1.0 - float(normal @ np.array(feed.normal)) ** 2, 0.0))
    return float((middle - np.array(way.point)) @ normal) + reach > 0.0


def _vector(values: Sequence[float], key: str) -> Vector:
    found = np.asarray(values, np.float64)
    if found.shape != (3,) or not np.isfinite(found).all():
        raise CaseError(key, values, "must be three finite numbers")
    x, y, z = found.tolist()
    return x, y, z


def _unit(values: Sequence[float], key: str) -> Vector:
    x, y, z = _vector(values, key)
    length = math.hypot(x, y, z)
    if length == 0.0:
        raise CaseError(key, values, "must not be zero")
    return x / length, y / length, z / length
