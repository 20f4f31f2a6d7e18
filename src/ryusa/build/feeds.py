"""Grains that feeds will bring, with sizes drawn before the run; feeds and exits as a scene has them."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.build.placement import Placement, at_rest
from ryusa.build.reach import reach_feed
from ryusa.build.sizes import draw
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.feeds.schema import ExitSection, FeedSection
from ryusa.casefile.feeds.values import fed_amount, fed_count, feed_begin, feed_end, sedigraph_of, unit_of
from ryusa.casefile.grains.values import mass, sized_as
from ryusa.casefile.materials.values import of_material
from ryusa.casefile.row.reach_source import fed_by_reach
from ryusa.casefile.walls.schema import WallSection
from ryusa.errors import CaseError
from ryusa.model import Exit, Feed, Scene, State, Traffic
from ryusa.model.feeds import NONE
from ryusa.model.scene import Floats
from ryusa.model.wall_feeds import speed_of_feed
from ryusa.model.walls import ASKED, INTERVAL

_WIDE = 1.0e9  # half the width across a plane scene of the box of an exit [m]
_STREAM = 0x46454544  # tells the sizes of fed grains from those of the first ones
_BEYOND = 100.0  # largest diameters that the domain reaches beyond an exit, where the case gives none
_TRAVEL = 0.5  # diameters that a grain falls from rest between two instants


def with_feeds(placement: Placement, case: Case, derived: Derived) -> tuple[Placement, Traffic | None]:
    """Add the grains that feeds will bring, each waiting at its feed, and give feeds and exits.

    Raises
    ------
    CaseError : the builder already uses the name of a feed.
    """
    if not case.feeds and not case.exits and not fed_by_reach(case.row):
        return placement, None
    taken = placement.groups()
    n_first = first = len(placement.d)
    feeds: list[Feed] = []
    sizes, centres = [placement.d], [placement.x]
    for k, keys in enumerate(case.feeds):
        if keys.name in taken:
            raise CaseError(
                f"feeds.{k}.name", keys.name, "is already used by the builder; choose another name"
            )
        d = _sizes_of(case, keys, np.random.default_rng([case.seed, _STREAM, k]))
        feeds.append(_feed(case, keys, k, first, len(d)))
        sizes.append(d)
        centres.append(np.tile(_middle(keys), (len(d), 1)))
        first += len(d)
    arrivals = None
    if (found := reach_feed(case, len(feeds), first)) is not None:
        feed, arrivals, d = found
        feeds.append(feed)
        sizes.append(d)
        centres.append(np.tile(0.5 * (np.array(feed.low) + np.array(feed.high)), (len(d), 1)))
        first += len(d)
    n = first - n_first
    traffic = Traffic(
        tuple(feeds), tuple(_exit(case, one) for one in case.exits),
        steps_between(feeds, derived.d_min, derived.g, derived.dt), n_first, arrivals,
    )  # fmt: skip
    groups = tuple((one.name, one.first, one.count) for one in feeds if one.count)
    return replace(
        placement,
        d=np.concatenate(sizes),
        x=np.concatenate(centres),
        v=np.concatenate([placement.v, at_rest(n)]),
        omega=np.concatenate([placement.omega, at_rest(n)]),
        free_groups=(*placement.free_groups, *groups),
    ), traffic


def before_feeding(
    scene: Scene, state: State, traffic: Traffic | None, low: bool = True, high: bool = True
) -> tuple[Scene, State]:
    """Scene and state with only the first grains there; the others wait.

    `low` and `high` tell on which sides the domain is the default, and makes room for the exits.
    """
    if traffic is None:
        return scene, state
    scene = _reaching(scene, traffic, low, high)
    there = np.arange(scene.n_grain) < traffic.n_first
    there.flags.writeable = False
    motion = {name: np.where(there[:, None], getattr(state, name), np.nan) for name in ("x", "v", "omega")}
    image = np.where(there[:, None], state.image, 0).astype(np.int32)
    for array in (*motion.values(), image):
        array.flags.writeable = False
    return replace(scene, traffic=traffic), replace(state, **motion, image=image, present=there)


def _reaching(scene: Scene, traffic: Traffic, by_default_low: bool, by_default_high: bool) -> Scene:
    """The scene with a default domain that holds every exit, and what is beyond it until it is removed."""
    every = [one.point if one.is_plane else corner for one in traffic.exits for corner in (one.low, one.high)]
    if not every:
        return scene
    room = _BEYOND * scene.d_max
    low, high = np.min(every, axis=0) - room, np.max(every, axis=0) + room
    if by_default_low:
        x, y, z = np.minimum(low, scene.world_low).tolist()
        scene = replace(scene, world_low=(x, y, z))
    if by_default_high:
        x, y, z = np.maximum(high, scene.world_high).tolist()
        scene = replace(scene, world_high=(x, y, z))
    return scene


def _sizes_of(case: Case, keys: FeedSection, rng: np.random.Generator) -> Floats:
    """Diameters of all grains of a feed that are due before its end [m]."""
    count = fed_count(case, keys)
    sized = sized_as(case, keys.material)
    d = draw(sized, count, rng)
    if unit_of(case, keys) != "kg/s":
        return d
    wanted = fed_amount(case, keys)
    while True:
        m = np.array([mass(of_material(case, keys.material), one)[0] for one in d.tolist()])
        due = np.concatenate([[0.0], np.cumsum(m)])  # mass before each grain
        if due[-1] >= wanted:
            return d[: int(np.searchsorted(due, wanted * (1.0 - 1e-12)))]
        d = np.concatenate([d, draw(sized, max(count // 10, 10), rng)])


def _middle(keys: FeedSection) -> Floats:
    if keys.low is None or keys.high is None:
        assert keys.centre is not None
        return np.array(keys.centre)
    return 0.5 * (np.array(keys.low) + np.array(keys.high))


def seed_of_feed(seed: int, k: int) -> int:
    """Seed of the places of feed k."""
    return (seed + 7919 * (k + 1)) % 2**62


def _unit(normal: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = (part / math.hypot(*normal) for part in normal)
    return x, y, z


def _feed(case: Case, keys: FeedSection, k: int, first: int, count: int) -> Feed:
    course = sedigraph_of(case, keys)
    rate = max(course.y) if course is not None else 0.0 if keys.rate is None else keys.rate[0]
    common = Feed(
        keys.name, velocity=keys.velocity, rate=rate, by_mass=unit_of(case, keys) == "kg/s",
        begin=feed_begin(case, keys), end=feed_end(case, keys), first=first, count=count,
        seed=seed_of_feed(case.seed, k), wall=_wall(case.walls, keys),
        times=() if course is None else course.t, rates=() if course is None else course.y,
    )  # fmt: skip
    if keys.low is not None and keys.high is not None:
        return replace(common, low=keys.low, high=keys.high)
    assert keys.centre is not None
    assert keys.radius is not None
    return replace(common, centre=keys.centre, normal=_unit(keys.normal), radius=keys.radius)


def _exit(case: Case, keys: ExitSection) -> Exit:
    names = [feed.name for feed in case.feeds]
    to, wall = -1 if keys.to is None else names.index(keys.to), _wall(case.walls, keys)
    if keys.point is not None and keys.normal is not None:
        return Exit(keys.name, point=keys.point, normal=_unit(keys.normal), to=to, wall=wall)
    assert keys.low is not None
    assert keys.high is not None
    low, high = keys.low, keys.high
    if case.motion.plane:
        low, high = (low[0], -_WIDE, low[2]), (high[0], _WIDE, high[2])
    return Exit(keys.name, low=low, high=high, to=to, wall=wall)


def _wall(walls: tuple[WallSection, ...], keys: FeedSection | ExitSection) -> int:
    return NONE if keys.moves_with is None else [one.name for one in walls].index(keys.moves_with)


def moving_with(scene: Scene) -> Scene:
    """The scene with instants near enough to each other for feeds and exits that move with its walls.

    A grain and its feed go a diameter at most between two of them; and what moves with a servo has one
    speed between two corrections, which are therefore instants.
    """
    traffic, walls = scene.traffic, scene.walls
    if traffic is None or walls is None or not traffic.moves:
        return scene
    fastest = [math.hypot(*one.velocity) + speed_of_feed(scene, one) for one in traffic.feeds]
    steps, d_min = traffic.interval, float(scene.d.min())
    if max(fastest, default=0.0) > 0.0:
        steps = max(1, min(steps, int(d_min / max(fastest) / scene.dt)))
    carried = {one.wall for one in (*traffic.feeds, *traffic.exits)}
    if len(walls.servo) and any(walls.servo[w, ASKED] != 0.0 for w in carried - {NONE}):
        correction = int(walls.servo[0, INTERVAL])
        steps = max(k for k in range(1, min(steps, correction) + 1) if correction % k == 0)
    return replace(scene, traffic=replace(traffic, interval=steps))


def leaving_row(scene: Scene) -> Scene:
    """The scene with instants near enough to each other for grains that leave a row of columns.

    Beyond an open end a grain counts as lying in the last segment, which those that follow need: between two
    instants none goes farther than half the smallest diameter, at the speed of a fall through all of the row.
    """
    traffic, row = scene.traffic, scene.row
    if traffic is None or row is None or row.periodic or not traffic.exits:
        return scene
    levels = row.column.g_x * row.x - row.g_z * row.bottom
    fall = float(np.ptp(levels)) + row.g_z * row.column.dz * row.column.n
    steps = int(_TRAVEL * float(scene.d.min()) / math.sqrt(2.0 * fall) / scene.dt)
    return replace(scene, traffic=replace(traffic, interval=max(1, min(steps, traffic.interval))))


def steps_between(feeds: Sequence[Feed], d_min: float, g: float, dt: float) -> int:
    """Steps between two instants at which grains enter and leave.

    In that time a grain falls from rest by half the smallest diameter, or goes a diameter at the speed of
    the fastest feed, whichever is sooner.

    Parameters
    ----------
    d_min : smallest diameter [m].
    g, dt : gravity [m/s2] and time step [s].
    """
    times = [math.sqrt(2.0 * _TRAVEL * d_min / g)] if g > 0.0 else []
    fastest = max((math.hypot(*feed.velocity) for feed in feeds), default=0.0)
    times += [d_min / fastest] if fastest > 0.0 else []
    return max(1, int(min(times) / dt)) if times else 100
