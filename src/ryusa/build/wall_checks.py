"""What is wrong with walls, feeds and exits beside first grains, each named before the first step."""

import math
from dataclasses import replace

import numpy as np

from ryusa.build.change import change, replay
from ryusa.build.servo import pressed_area
from ryusa.casefile.case import Case
from ryusa.casefile.contact.impact import STABLE
from ryusa.casefile.feeds.values import (
    FULLEST,
    FULLEST_PLANE,
    grains_per_second,
    mean_mass,
    share_filled,
    unit_of,
)
from ryusa.errors import CaseError
from ryusa.model import FaceKind, Feed, Scene, State
from ryusa.model.arrays import Bools, Floats
from ryusa.model.contact_law import rest_overlap_of, stiffness_key
from ryusa.model.feeds import NONE
from ryusa.model.wall_shape import WallsAt
from ryusa.model.walls import ASKED, MOST_SPEED, MOST_TRAVEL, TOWARDS, Ints, across, face_boxes, largest_speed

_TRIED = 200  # places of a grain in a feed
_STREAM = 0x524F4F4D  # tells their random numbers from others
_SIDE_BY_SIDE = math.sqrt(3.0) / 2.0  # area that a grain takes in the closest layer, over d**2
MOST_STEP = 0.25  # smallest diameters that a wall may go in a step; the engines' LARGEST_DISPLACEMENT


def refuse_wide_round_faces(
    face: Floats, kind: Ints, period: tuple[float, float], d: float, key: str
) -> None:
    """Raise a `CaseError` for discs and cylinders of which a grain could touch two images at once.

    The image of a face that a grain may touch is found from its middle. Triangles are cut to fit.

    Parameters
    ----------
    d : largest diameter [m].
    """
    low, high = face_boxes(face, kind)
    for axis, name in enumerate("xy"):
        if not math.isfinite(period[axis]):
            continue
        wide = (high - low)[:, axis] + d > period[axis]
        endless = np.abs(face[:, 3 + axis]) == 1.0  # along the axis of a shell all images are one
        level = np.abs(face[:, 5]) == 1.0  # of level discs the image nearest to the middle is the nearest
        good = np.where(kind == FaceKind.CYLINDER, endless, level)
        bad = np.flatnonzero((kind != FaceKind.TRIANGLE) & wide & ~good)
        if len(bad):
            size = float((high - low)[bad[0], axis])
            raise CaseError(
                key, None,
                f"is {size:.4g} m wide in {name}, too wide for the period, {period[axis]:.4g} m: at most the "
                f"period less the largest diameter, {period[axis] - d:.4g} m; make it narrower, or a mesh",
            )  # fmt: skip


def refuse_fast_walls(case: Case, scene: Scene) -> None:
    """Raise a `CaseError` for a wall that goes so far in a step that it could pass through a grain."""
    if scene.walls is None or not len(scene.d) + len(scene.d_fixed):
        return
    smallest = scene.d_min
    most = MOST_STEP * smallest / scene.dt
    _refuse_faster(scene, most, {name: f"walls.{w}" for w, name in enumerate(scene.walls.names)})
    for key, entry, after in replay(case, scene):
        if entry.move is not None:
            _refuse_faster(after, most, {entry.move.wall: f"{key}.move"})


def _refuse_faster(scene: Scene, most: float, keys: dict[str, str]) -> None:
    assert scene.walls is not None
    for name, key in keys.items():
        alone = np.array(scene.walls.names) == name
        speed = largest_speed(replace(scene.walls, active=scene.walls.active & alone))
        if not speed <= most:
            raise CaseError(
                key, name,
                f"moves at up to {speed:.3g} m/s and could pass through a grain in a step: at most "
                f"{most:.3g} m/s, {MOST_STEP:g} of the smallest diameter in a step; lower its speed, or "
                "raise time.steps_per_contact",
            )  # fmt: skip


def refuse_idle_servos(case: Case, scene: Scene, state: State) -> None:
    """Raise a `CaseError` for a servo that presses away from all grains, or too far from the nearest."""
    walls = scene.walls
    if walls is None or not len(walls.servo) or case.feeds:  # what feeds bring may lie anywhere
        return
    x = np.vstack([state.x, scene.x_fixed.reshape(-1, 3)])
    radius = 0.5 * np.concatenate([scene.d, scene.d_fixed])
    there = np.isfinite(x).all(axis=1)
    x, radius = x[there], radius[there]
    for w in np.flatnonzero(walls.servo[:, ASKED] > 0.0):
        row, key = walls.servo[w], f"walls.{w}.servo"
        towards = row[TOWARDS : TOWARDS + 3]
        mine = walls.wall == w
        back, front = _extent(walls.face[mine], walls.kind[mine], towards)
        along = x @ towards
        ahead = along + radius > back
        if len(x) and not ahead.any():
            raise CaseError(
                f"{key}.direction", [round(float(one), 6) for one in towards],
                f"presses away from all first grains: wall '{walls.names[w]}' is at {back:.4g} m along it, "
                f"the farthest grain at {float((along + radius).max()):.4g} m; turn it round",
            )  # fmt: skip
        gap = float((along - radius)[ahead].min()) - front if len(x) else 0.0
        span = math.inf if case.stop.time is None else case.stop.time
        if gap > row[MOST_TRAVEL] and row[MOST_SPEED] * span > row[MOST_TRAVEL]:
            raise CaseError(
                f"{key}.max_travel", float(row[MOST_TRAVEL]),
                f"ends before the first grain, which is {gap:.4g} m ahead: raise it, or move the wall",
            )  # fmt: skip


def refuse_crushing_servos(scene: Scene) -> tuple[str, ...]:
    """Notes on servos that press grains out of the stable range of overlaps; a `CaseError` beyond the limit.

    The force is shared among all grains, or as many as can lie side by side under the wall: no overlap at the
    wall is less in the mean. Of several materials the pair that yields least is taken.
    """
    walls, notes = scene.walls, list[str]()
    if walls is None or not len(walls.servo):
        return ()
    d = scene.d_mean
    laws = (scene.contact,) if scene.materials is None else scene.materials.contact
    for w in np.flatnonzero(walls.servo[:, ASKED] > 0.0):
        row = walls.servo[w]
        area, _ = pressed_area(scene, int(w), row[TOWARDS : TOWARDS + 3])
        bearing = min(max(area / (_SIDE_BY_SIDE * d * d), 1.0), len(scene.whole_grains()[0]))
        load = float(row[ASKED]) / bearing
        least = min(rest_overlap_of(law, 0.5 * d, load) for law in laws) / d
        law, name = laws[0], walls.names[w]
        text = f"presses at most {bearing:.0f} grains side by side, each by at least {least:.2g} d"
        if least > scene.overlap_limit:
            raise CaseError(
                f"walls.{w}.servo", name,
                f"{text}, more than domain.overlap_limit, {scene.overlap_limit:g}: lower its force or "
                f"pressure below {scene.overlap_limit / least:.2g} of what it is, or raise "
                f"{stiffness_key(law)}",
            )  # fmt: skip
        if least > STABLE[1]:
            notes.append(
                f"wall '{name}' {text}, above {STABLE[1]:g} d: raise {stiffness_key(law)} or lower its force "
                f"(walls.{w}.servo)"
            )
    return tuple(notes)


def _extent(face: Floats, kind: Ints, along: Floats) -> tuple[float, float]:
    """Least and largest coordinate of faces along a unit vector [m]; a cylinder has no servo."""
    a, b, c = face[:, :3] @ along, face[:, 3:6] @ along, face[:, 6:9] @ along
    round_ = kind != FaceKind.TRIANGLE
    across = face[:, 6] * np.sqrt(np.maximum(1.0 - b**2, 0.0))
    low = np.where(round_, a - across, a + np.minimum(0.0, np.minimum(b, c)))
    high = np.where(round_, a + across, a + np.maximum(0.0, np.maximum(b, c)))
    return float(low.min()), float(high.max())


def refuse_grains_beyond_exits(scene: Scene, state: State) -> tuple[str, ...]:
    """Notes on first grains that leave at once; a `CaseError` for an exit through which all of them would."""
    notes: list[str] = []
    if scene.traffic is None:
        return ()
    there = state.present if len(state.present) else np.ones(scene.n_grain, np.bool_)
    for k, one in enumerate(scene.traffic.exits):
        gone, n = int(np.sum(one.beyond(state.x[there]))), int(there.sum())
        if gone == n > 0:
            text = f"takes all {n} first grains at once: move it, or turn its normal round"
            raise CaseError(f"exits.{k}", one.name, text)
        if gone:
            notes.append(f"exit '{one.name}' takes {gone} of the {n} first grains at once (exits.{k})")
    return tuple(notes)


def refuse_full_feeds(case: Case, scene: Scene) -> None:
    """Raise a `CaseError` for a feed in which walls that stay where they are leave too little room.

    Grains of its largest diameter are tried at random places beside planes, walls and fixed grains that are
    at rest and never removed.
    """
    traffic = scene.traffic
    if traffic is None:
        return
    still = _still(case, scene)
    for k, feed in enumerate(traffic.feeds):
        if not feed.count or feed.wall != NONE:  # one that moves may begin anywhere
            continue
        if traffic.arrivals is not None and traffic.arrivals.feed == k:  # each grain has its place
            continue
        d = float(scene.d[feed.first : feed.first + feed.count].max())
        places = _places(feed, scene.plane_case, d, np.random.default_rng([_STREAM, k]))
        taken = _taken(still, places, d, feed.begin)
        free = 1.0 - float(np.mean(np.any(list(taken.values()), axis=0))) if taken else 1.0
        most = max(taken, key=lambda name: int(taken[name].sum()), default="")
        if free == 0.0:
            raise CaseError(
                f"feeds.{k}", feed.name,
                f"has no room for a grain of {d:.4g} m, {most} is in the way: move or enlarge it",
            )  # fmt: skip
        keys = case.feeds[k]
        share = share_filled(case, keys, grains_per_second(case, keys)) / free
        fullest = FULLEST_PLANE if scene.plane_case else FULLEST
        if share > fullest and keys.brings:
            each = mean_mass(case, keys.material) if unit_of(case, keys) == "kg/s" else 1.0
            rate, unit = grains_per_second(case, keys) * each, unit_of(case, keys)
            raise CaseError(
                f"feeds.{k}.{'rate' if keys.sedigraph is None else 'sedigraph'}", f"{rate:g} {unit}",
                f"cannot fit: {most} leaves {free:.2g} of the room at the feed, of which grains would fill "
                f"{share:.2g}, and at most {fullest:g} can be filled at random; lower it below "
                f"{rate * fullest / share:.3g} {unit}, or move the feed",
            )  # fmt: skip


def _still(case: Case, scene: Scene) -> Scene:
    """The scene with only those planes, walls and fixed grains that stay for ever."""
    for entry in case.timeline:
        if entry.remove is not None:
            scene = change(case, scene, entry)
    walls = scene.walls
    if walls is not None:
        moved = {entry.move.wall for entry in case.timeline if entry.move is not None}
        at_rest = ~walls.moving() & np.array([name not in moved for name in walls.names])
        scene = replace(scene, walls=replace(walls, active=walls.active & at_rest))
    return scene


def _places(feed: Feed, plane_case: bool, d: float, rng: np.random.Generator) -> Floats:
    """Random centres of grains of diameter d [m] in a feed, as the run places them [m], (n, 3)."""
    u = rng.uniform(size=(_TRIED, 3))
    if feed.is_box:
        low, high = np.array(feed.low), np.array(feed.high)
        return 0.5 * (low + high) + (u - 0.5) * np.maximum(high - low - d, 0.0)
    normal, reach = np.array(feed.normal), feed.radius - 0.5 * d
    side = np.array([normal[2], 0.0, -normal[0]])
    if plane_case:
        return np.array(feed.centre) + reach * (2.0 * u[:, :1] - 1.0) * side
    side = across(normal)
    far, turn = reach * np.sqrt(u[:, :1]), 2.0 * math.pi * u[:, 1:2]
    return np.array(feed.centre) + far * (np.cos(turn) * side + np.sin(turn) * np.cross(normal, side))


def _taken(scene: Scene, places: Floats, d: float, t: float) -> dict[str, Bools]:
    """Whether each place is taken, by what takes it."""
    found: dict[str, Bools] = {}
    groups = {name: ends for name, ends in scene.groups.items() if ends[0] >= scene.n_grain}
    first = scene.n_grain + scene.n_fixed
    for name, (begin, end) in groups.items():
        for p in range(max(begin, first) - first, min(end - first, scene.n_plane)):
            if scene.plane_active[p]:
                away = (places - scene.plane_point[p]) @ scene.plane_normal[p]
                found[f"the plane '{name}'"] = away < 0.5 * d
    stones = scene.fixed_active
    if stones.any():
        from scipy.spatial import KDTree

        tree = KDTree(scene.x_fixed.reshape(-1, 3)[stones])
        near = tree.query(places)[0]
        found["the bed"] = near < 0.5 * (d + float(scene.d_fixed[stones].min()))
    if scene.walls is not None:
        low, high = places.min(axis=0) - 0.5 * d, places.max(axis=0) + 0.5 * d
        for w in np.flatnonzero(scene.walls.active):
            alone = np.arange(scene.n_wall) == w
            walls = WallsAt(replace(scene.walls, active=alone), t, scene.period).around(low, high)
            found[f"the wall '{scene.walls.names[w]}'"] = np.array([walls.touch(x, 0.5 * d) for x in places])
    return found
