"""[[walls]]: finite walls, at rest or moving; the shapes of their faces, and what is wrong with them."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from ryusa.casefile.belts import belt_rows, check_belts
from ryusa.casefile.builders.values import periodic
from ryusa.casefile.files import RelativePath
from ryusa.casefile.mesh import mesh_of, mesh_rows
from ryusa.casefile.quantities import (
    Angle,
    Frequency,
    Name,
    Number,
    Point,
    PositiveLength,
    Speed,
    Spin,
)
from ryusa.casefile.row.meshes import Boxes, check_mesh_in_row, dam_rows
from ryusa.casefile.row.values import walls_of_stream
from ryusa.casefile.rows import ExplainRow, word
from ryusa.casefile.section import Section, given
from ryusa.casefile.servo import ServoSection, check_moves, check_servo, servo_text
from ryusa.errors import CaseError
from ryusa.model.arrays import Floats
from ryusa.model.walls import corners_of_box
from ryusa.spelling import nearest_word

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived

Vector = tuple[Number, Number, Number]
VelocityVector = tuple[Speed, Speed, Speed]
SpinVector = tuple[Spin, Spin, Spin]
_KEYS = {  # of each shape: those it needs, those it may have
    "rectangle": (("at", "sides"), ()),
    "ridges": (("at", "sides", "number", "height"), ()),
    "disc": (("at", "normal", "radius"), ()),
    "cylinder": (("at", "axis", "radius"), ("ends",)),
    "mesh": (("file", "unit"), ("at", "scale", "turn_axis", "turn_angle")),
}
_OF_SHAPES = tuple(dict.fromkeys(key for needs, may in _KEYS.values() for key in (*needs, *may)))
LARGEST = 1.0e6  # of a wall, in largest diameters
WIDE = 1.0e4  # from which the size of a wall is doubted
_BEHIND = 1e-9  # of its size: nearer to a plane a wall lies in it


class WallSection(Section):
    """A finite wall with the contact law of the grains; grains touch both of its sides."""

    name: Name
    """Name of the wall; [[timeline]] can move it or remove it by this name."""
    shape: Literal["rectangle", "ridges", "disc", "cylinder", "mesh"]
    """A rectangle, one covered by triangular ridges as a rough plate, a disc, the shell of a cylinder, or
    triangles from a file."""
    at: Point | None = None
    """One corner of a rectangle, with ridges or not, the centre of a disc, the centre of one end of a
    cylinder; where the origin of the file of a mesh goes, by default (0, 0, 0)."""
    sides: tuple[Point, Point] | None = None
    """The two sides of a rectangle from that corner. Ridges follow each other along the first and rise on
    the side of the first crossed with the second."""
    number: Annotated[int, Field(ge=1, le=10_000)] | None = None
    """Number of ridges along the first side."""
    height: PositiveLength | None = None
    """Height of the ridges above the rectangle."""
    normal: Vector | None = None
    """Direction normal to a disc, of any length."""
    axis: Point | None = None
    """From the centre of one end of a cylinder to that of the other."""
    radius: PositiveLength | None = None
    """Radius of a disc or a cylinder."""
    ends: Literal["open", "closed", "first", "last"] = "open"
    """Ends of a cylinder that discs close: none, both, the one at `at`, or the other."""
    file: RelativePath | None = None
    """STL or OBJ file of a mesh, in the folder of the case file or below it."""
    unit: Annotated[str, Field(min_length=1, max_length=16)] | None = None
    """Unit of length in that file, such as "mm"; STL and OBJ files do not say."""
    scale: Annotated[Number, Field(gt=0)] = 1.0
    """Factor by which the mesh is enlarged."""
    turn_axis: Vector | None = None
    """Axis through the origin of the file about which the mesh is turned before it is placed."""
    turn_angle: Angle | None = None
    """Angle of that turn, right-handed."""
    velocity: VelocityVector | None = None
    """Velocity of the wall."""
    angular_velocity: SpinVector | None = None
    """Angular velocity of the wall about an axis through axis_point, right-handed."""
    axis_point: Point | None = None
    """A point on that axis; it moves with the wall."""
    amplitude: Point | None = None
    """Amplitude of an oscillation, half of the stroke in each direction."""
    frequency: Frequency | None = None
    """Frequency of that oscillation."""
    phase: Angle = 0.0
    """Phase of that oscillation at the start."""
    surface_velocity: VelocityVector | None = None
    """Velocity of the surface of a belt against the wall, which itself may stand still. At each contact its
    part along the face counts. It turns with the wall, and is that at t = 0."""
    servo: ServoSection | None = None
    """Presses the wall on the grains with a given force or pressure, beside its other motion."""
    material: Name | None = None
    """Material of [materials]; that of [contact] when not given."""


class MoveSection(Section):
    """New motion of a wall, in place of the one it had; what is not given is zero."""

    wall: Name
    """Name of the wall."""
    velocity: VelocityVector | None = None
    """Velocity of the wall."""
    angular_velocity: SpinVector | None = None
    """Angular velocity of the wall."""
    axis_point: Point | None = None
    """A point on the axis of rotation; where the point of the wall is by then, when not given."""
    amplitude: Point | None = None
    """Amplitude of an oscillation that begins now."""
    frequency: Frequency | None = None
    """Frequency of that oscillation."""
    phase: Angle = 0.0
    """Phase at which it begins."""
    surface_velocity: VelocityVector | None = None
    """Velocity of the surface of a belt against the wall from now on."""


def check_walls(case: "Case") -> Iterator[CaseError]:
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
        yield from check_servo(case, wall, key)
    for k, entry in enumerate(case.timeline):
        if entry.move is not None:
            name, at = entry.move.wall, f"timeline.{k}.move.wall"
            if name not in names and name in walls_of_stream(case):
                yield CaseError(at, name, "cannot move: it is one for grains and water; must be of [[walls]]")
            elif name not in names:
                known = ", ".join(names) or "there is none"
                yield CaseError(at, name, f"must be a wall: {known}", nearest_word(name, names))
            yield from _motion(case, f"timeline.{k}.move", entry.move)
    yield from check_moves(case)
    yield from check_belts(case)


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


def _motion(case: "Case", key: str, moved: WallSection | MoveSection) -> Iterator[CaseError]:
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


def check_meshes(case: "Case", derived: "Derived") -> Iterator[CaseError]:
    """Find files that are no meshes, walls of a size that does not fit the grains, and walls out of reach."""
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        try:
            low, high = box_of(case, wall, key)
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
        elif not _moves(case, wall):
            yield from _out_of_reach(case, wall, key, low, high)
            if wall.shape == "mesh":
                yield from check_mesh_in_row(case, f"{key}.file", wall.unit or "", low, high, derived.d_max)


def _moves(case: "Case", wall: WallSection) -> bool:
    """Whether a wall moves at any time."""
    own = any(given(wall, one) for one in ("velocity", "angular_velocity", "amplitude", "servo"))
    return own or any(entry.move is not None and entry.move.wall == wall.name for entry in case.timeline)


def _out_of_reach(
    case: "Case", wall: WallSection, key: str, low: Floats, high: Floats
) -> Iterator[CaseError]:
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


def box_of(case: "Case", wall: WallSection, key: str) -> tuple[Floats, Floats]:
    """Lowest and highest corner of the box round a wall in its first place [m], shape (3,) each."""
    if wall.shape == "mesh":
        mesh = mesh_of(case, wall, key)
        return mesh.low, mesh.high
    at = np.array(wall.at or (0.0, 0.0, 0.0))
    if wall.sides is not None:
        one, other = (np.array(side) for side in wall.sides)
        up = np.cross(one, other)
        up *= (wall.height or 0.0) / np.linalg.norm(up)
        ends = at + np.array([a * one + b * other + c * up for a, b, c in np.ndindex(2, 2, 2)])
        return ends.min(axis=0), ends.max(axis=0)
    along = np.array(wall.axis or wall.normal or (0.0, 0.0, 1.0))
    n = along / np.linalg.norm(along)
    across = (wall.radius or 0.0) * np.sqrt(np.maximum(1.0 - n**2, 0.0))
    end = at + along if wall.axis is not None else at
    return np.minimum(at, end) - across, np.maximum(at, end) + across


def wall_rows(case: "Case", derived: "Derived") -> list[ExplainRow]:
    """Shape, size and motion of each wall."""
    rows: list[ExplainRow] = []
    meshes: Boxes = []
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        low, high = box_of(case, wall, key)
        size = " x ".join(f"{100.0 * one:.4g}" for one in high - low)
        ratio = float((high - low).max()) / derived.d_max
        wide = f"; {ratio:.3g} of the largest grains across"
        doubt = f", more than {WIDE:g}: check its lengths and units" if ratio > WIDE else ""
        about, flag = f"{wall.shape}{wide}{doubt}", "warning" if doubt else ""
        rows.append(word("walls", f"{wall.name}: size in x, y, z", f"{size} cm", about, flag))
        if wall.shape == "mesh":
            meshes.append((wall.name, low, high))
            rows += mesh_rows(case, derived, wall, key)
        moves = [name for name in ("velocity", "angular_velocity", "amplitude") if given(wall, name)]
        if moves:
            rows.append(word("walls", f"{wall.name}: moves", _motion_text(wall), ", ".join(moves)))
        rows += belt_rows(case, wall)
        if wall.servo is not None:
            rows.append(word("walls", f"{wall.name}: presses with", servo_text(wall.servo), "servo"))
    return rows + dam_rows(case, meshes, derived.d_max)


def _motion_text(wall: WallSection) -> str:
    parts: list[str] = []
    if wall.velocity is not None:
        parts.append(f"{math.hypot(*wall.velocity):.4g} m/s")
    if wall.angular_velocity is not None:
        rate = math.hypot(*wall.angular_velocity)
        parts.append(f"{rate:.4g} rad/s ({60.0 * rate / (2.0 * math.pi):.4g} rpm)")
    if wall.amplitude is not None and wall.frequency is not None:
        parts.append(f"{100.0 * math.hypot(*wall.amplitude):.4g} cm at {wall.frequency:g} Hz")
    return ", ".join(parts)
