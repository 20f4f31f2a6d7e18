"""What is wrong with [[walls]], their servos and belts, and with [[planes]]."""

from collections.abc import Iterator

import numpy as np

from ryusa.casefile.builders.schema import PackingSection
from ryusa.casefile.builders.values import periodic
from ryusa.casefile.case import Case
from ryusa.casefile.facts import Derived
from ryusa.casefile.record.schema import Timeline
from ryusa.casefile.row.meshes import check_mesh_in_row
from ryusa.casefile.row.values import walls_of_stream
from ryusa.casefile.section import given
from ryusa.casefile.walls.mesh import box_of
from ryusa.casefile.walls.schema import MoveSection, WallSection
from ryusa.errors import CaseError
from ryusa.model.arrays import Floats
from ryusa.model.walls import corners_of_box
from ryusa.spelling import nearest_word

_KEYS = {  # of each shape: those it needs, those it may have
    "rectangle": (("at", "sides"), ()),
    "ridges": (("at", "sides", "number", "height"), ()),
    "disc": (("at", "normal", "radius"), ()),
    "cylinder": (("at", "axis", "radius"), ("ends",)),
    "mesh": (("file", "unit"), ("at", "scale", "turn_axis", "turn_angle")),
}
_OF_SHAPES = tuple(dict.fromkeys(key for needs, may in _KEYS.values() for key in (*needs, *may)))
LARGEST = 1.0e6  # of a wall, in largest diameters
_BEHIND = 1e-9  # of its size: nearer to a plane a wall lies in it


def check_walls(case: Case) -> Iterator[CaseError]:
    """Find walls with keys missing or without effect, and names used twice."""
    names: list[str] = []
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        if case.motion.plane:
            yield CaseError(key, wall.name, "needs motion.plane = false; a plane scene has [[planes]]")
        needs, may = _KEYS[wall.shape]
        for one in needs:
            if not given(wall, one):
                yield CaseError(
                    f"{key}.{one}", None, f"missing; shape '{wall.shape}' needs {', '.join(needs)}"
                )
        for one in _OF_SHAPES:
            if one not in (*needs, *may) and given(wall, one):
                yield CaseError(f"{key}.{one}", None, f"has no effect with shape '{wall.shape}'")
        if wall.name in names:
            yield CaseError(f"{key}.name", wall.name, "is used twice")
        names.append(wall.name)
        yield from _shape(key, wall)
        yield from _motion(case, key, wall)
        yield from check_servo(wall, key)
    for k, entry in enumerate(case.timeline):
        if entry.move is not None:
            name, at = entry.move.wall, f"timeline.{k}.move.wall"
            if name not in names and name in walls_of_stream(case):
                yield CaseError(at, name, "cannot move: it is one for grains and water; must be of [[walls]]")
            elif name not in names:
                known = ", ".join(names) or "there is none"
                yield CaseError(at, name, f"must be a wall: {known}", nearest_word(name, names))
            yield from _motion(case, f"timeline.{k}.move", entry.move)
    yield from check_moves(case.walls, case.timeline)
    yield from check_belts(case.walls, case.timeline)


def _shape(key: str, wall: WallSection) -> Iterator[CaseError]:
    if wall.sides is not None:
        one, other = (np.array(side) for side in wall.sides)
        area, sizes = np.linalg.norm(np.cross(one, other)), np.linalg.norm(one) * np.linalg.norm(other)
        if not area > 1e-6 * sizes:
            yield CaseError(f"{key}.sides", None, "must be two directions that span an area")
    for name in ("normal", "axis", "turn_axis"):
        value = getattr(wall, name)
        if value is not None and not any(value):
            yield CaseError(f"{key}.{name}", list(value), "must not be zero")
    if (wall.turn_axis is None) != (wall.turn_angle is None):
        missing = "turn_axis" if wall.turn_axis is None else "turn_angle"
        yield CaseError(f"{key}.{missing}", None, "missing; a turn needs turn_axis and turn_angle")


def _motion(case: Case, key: str, moved: WallSection | MoveSection) -> Iterator[CaseError]:
    spin = moved.angular_velocity or (0.0, 0.0, 0.0)
    for axis, is_periodic in enumerate(periodic(case)):
        if is_periodic and any(one != 0.0 for k, one in enumerate(spin) if k != axis):
            yield CaseError(
                f"{key}.angular_velocity", list(spin),
                f"turns the wall across {'xy'[axis]}, which is periodic: only about {'xy'[axis]} can it turn",
            )  # fmt: skip
    if (moved.amplitude is None) != (moved.frequency is None):
        missing = "amplitude" if moved.amplitude is None else "frequency"
        yield CaseError(f"{key}.{missing}", None, "missing; an oscillation needs amplitude and frequency")
    if isinstance(moved, WallSection) and moved.angular_velocity is not None and moved.axis_point is None:
        yield CaseError(f"{key}.axis_point", None, "missing; a wall that turns needs a point on its axis")
    if moved.axis_point is not None and moved.angular_velocity is None:
        yield CaseError(f"{key}.axis_point", None, "has no effect without angular_velocity")


def check_meshes(case: Case, derived: Derived) -> Iterator[CaseError]:
    """Find files that are no meshes, walls of a size that does not fit the grains, and walls out of reach."""
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        try:
            low, high = box_of(case.folder, wall, key)
        except CaseError as error:
            yield error
            continue
        size = high - low
        remedy = "check unit and scale" if wall.shape == "mesh" else "check its lengths"
        across = " x ".join(f"{one:.3g}" for one in size)
        if size.max() < derived.d_max:
            yield CaseError(
                f"{key}.name", wall.name,
                f"is {across} m, smaller than the largest grain, {derived.d_max:.3g} m; {remedy}",
            )  # fmt: skip
        elif size.max() > LARGEST * derived.d_max:
            yield CaseError(
                f"{key}.name", wall.name,
                f"is {across} m, over {LARGEST:g} times the largest grain, {derived.d_max:.3g} m; {remedy}",
            )  # fmt: skip
        elif not _moves(case.timeline, wall):
            yield from _out_of_reach(case, wall, key, low, high)
            if wall.shape == "mesh":
                yield from check_mesh_in_row(case, f"{key}.file", wall.unit or "", low, high, derived.d_max)


def _moves(timeline: Timeline, wall: WallSection) -> bool:
    """Whether a wall moves at any time."""
    own = any(given(wall, one) for one in ("velocity", "angular_velocity", "amplitude", "servo"))
    return own or any(entry.move is not None and entry.move.wall == wall.name for entry in timeline)


def _out_of_reach(case: Case, wall: WallSection, key: str, low: Floats, high: Floats) -> Iterator[CaseError]:
    """Find a wall at rest that lies wholly outside the domain, or behind a plane that is never removed."""
    bottom, top = case.domain.low, case.domain.high
    for axis, is_periodic in enumerate((*periodic(case), False)):
        if is_periodic:
            continue
        if (bottom is not None and high[axis] < bottom[axis]) or (top is not None and low[axis] > top[axis]):
            yield CaseError(
                f"{key}.name", wall.name, "lies outside domain.low and domain.high, where no grain gets"
            )
            return
    corners = corners_of_box(low, high)
    removed = {entry.remove for entry in case.timeline}
    for plane in case.planes:
        normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
        above = float(((corners - np.array(plane.point)) @ normal).max())
        if above < -_BEHIND * float((high - low).max()) and plane.name not in removed:
            yield CaseError(
                f"{key}.name", wall.name,
                f"lies behind the plane '{plane.name}', where no grain gets: move it {-above:.3g} m or more, "
                "or leave it out",
            )  # fmt: skip
            return


_ALONG = 1e-9  # sine of the angle up to which two directions are one


def check_servo(wall: WallSection, key: str) -> Iterator[CaseError]:
    """Find servos that press nothing, or that contradict the wall; `key` is that of the wall."""
    servo = wall.servo
    if servo is None:
        return
    if (servo.force is None) == (servo.pressure is None):
        yield CaseError(f"{key}.servo.force", servo.force, "needs either force or pressure, and not both")
    if wall.shape == "cylinder":
        yield CaseError(f"{key}.servo", wall.shape, "needs a wall that is a rectangle, a disc or a mesh")
    towards = np.array(servo.direction)
    if not towards.any():
        yield CaseError(f"{key}.servo.direction", list(servo.direction), "must not be zero")
        return
    towards = towards / np.linalg.norm(towards)
    if wall.sides is not None:
        across = np.cross(*wall.sides)
    elif wall.shape == "disc" and wall.normal is not None:
        across = np.array(wall.normal)
    else:
        across = towards
    if abs(float(across @ towards)) <= _ALONG * float(np.linalg.norm(across)):
        yield CaseError(
            f"{key}.servo.direction", list(servo.direction), "lies in the wall, which cannot press along it"
        )
    if wall.angular_velocity is not None:
        spin = np.array(wall.angular_velocity)
        if float(np.linalg.norm(np.cross(spin, towards))) > _ALONG * float(np.linalg.norm(spin)):
            yield CaseError(
                f"{key}.servo.direction", list(servo.direction),
                "must be along angular_velocity: a wall that turns across it presses elsewhere all the time",
            )  # fmt: skip


def check_moves(walls: tuple[WallSection, ...], timeline: Timeline) -> Iterator[CaseError]:
    """Find entries of the timeline that move a wall which a servo presses."""
    pressed = {wall.name for wall in walls if given(wall, "servo")}
    for k, entry in enumerate(timeline):
        if entry.move is not None and entry.move.wall in pressed:
            yield CaseError(
                f"timeline.{k}.move.wall", entry.move.wall,
                "has a servo, which moves it; a wall of its own motion has none",
            )  # fmt: skip


def check_belts(walls: tuple[WallSection, ...], timeline: Timeline) -> Iterator[CaseError]:
    """Find walls whose surface cannot run, and moves that would let it."""
    shape = {wall.name: wall.shape for wall in walls}
    asked = [(f"walls.{k}", wall.name, wall.surface_velocity) for k, wall in enumerate(walls)]
    asked += [
        (f"timeline.{k}.move", entry.move.wall, entry.move.surface_velocity)
        for k, entry in enumerate(timeline)
        if entry.move is not None
    ]
    for key, name, velocity in asked:
        if velocity is not None and shape.get(name) == "ridges":
            yield CaseError(
                f"{key}.surface_velocity", list(velocity),
                "cannot run over ridges, which would stand still: give velocity, with which they move along; "
                "a smooth belt is a rectangle",
            )  # fmt: skip


def check_planes(case: Case) -> Iterator[CaseError]:
    """Find planes without a direction, across a period, or with a name used twice."""
    period = dict(zip("xy", periodic(case), strict=True))
    opened = "; build.periodic = false opens the ends" if isinstance(case.build, PackingSection) else ""
    for k, plane in enumerate(case.planes):
        key, normal = f"planes.{k}.normal", list(plane.normal)
        if not any(normal):
            yield CaseError(key, normal, "must not be zero")
        elif case.motion.plane and normal[1] != 0.0:
            yield CaseError(key, normal, "must have y = 0 in a plane scene")
        for axis, one in enumerate(period):
            if period[one] and normal[axis] != 0.0:
                yield CaseError(key, normal, f"must have {one} = 0, because {one} is periodic{opened}")
    names = [plane.name for plane in case.planes]
    for k, name in enumerate(names):
        if name in names[:k]:
            yield CaseError(f"planes.{k}.name", name, "is used twice")
