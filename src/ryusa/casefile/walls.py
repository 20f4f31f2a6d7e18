"""[[walls]]: finite walls, at rest or moving; the shapes of their faces, and what is wrong with them."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import AfterValidator, Field

from ryusa.casefile.files import inside, relative
from ryusa.casefile.quantities import (
    Angle,
    Frequency,
    Number,
    Point,
    PositiveLength,
    Speed,
    Spin,
)
from ryusa.casefile.rows import ExplainRow, count, word
from ryusa.casefile.section import Section, given
from ryusa.casefile.servo import ServoSection, check_moves, check_servo, servo_text
from ryusa.errors import CaseError, ParseError
from ryusa.formats.mesh import read_mesh
from ryusa.laws.walls import turned_about
from ryusa.model.scene import Floats
from ryusa.units import quantity

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


class WallSection(Section):
    """A finite wall with the contact law of the grains; grains touch both of its sides."""

    name: Annotated[str, Field(min_length=1, max_length=64)]
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
    file: Annotated[str, Field(min_length=1, max_length=400), AfterValidator(relative)] | None = None
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
    servo: ServoSection | None = None
    """Presses the wall on the grains with a given force or pressure, beside its other motion."""
    material: Annotated[str, Field(min_length=1, max_length=64)] | None = None
    """Material of [materials]; that of [contact] when not given."""


class MoveSection(Section):
    """New motion of a wall, in place of the one it had; what is not given is zero."""

    wall: Annotated[str, Field(min_length=1, max_length=64)]
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


@dataclass(frozen=True)
class Mesh:
    """A mesh in its place."""

    corners: Floats  # [m], shape (n, 3, 3), without triangles of no area
    empty: int  # triangles of no area that were left out


def mesh_of(case: "Case", wall: WallSection, key: str) -> Mesh:
    """Read the mesh of a wall, in SI and in its place; `key` is that of the wall.

    Raises
    ------
    CaseError : no such file, not a mesh, or an unknown unit.
    """
    assert wall.file is not None
    path = inside(case, f"{key}.file", wall.file)
    if not path.is_file():
        raise CaseError(f"{key}.file", wall.file, f"no such file in the folder of the case, {path.parent}")
    try:
        unit = quantity(f"1 {wall.unit}", "m")
    except ValueError as error:
        allowed = f"must be a unit of length such as 'mm' ({error})"
        raise CaseError(f"{key}.unit", wall.unit, allowed) from None
    stamp = path.stat()
    try:
        corners = _read(path, wall.file, stamp.st_mtime_ns, stamp.st_size)
    except ParseError as error:
        raise CaseError(f"{key}.file", None, str(error)) from error
    corners = corners * (unit * wall.scale)
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    longest = np.linalg.norm(np.ptp(corners, axis=1), axis=1)
    flat = area <= 1e-12 * longest**2
    if flat.all():
        raise CaseError(f"{key}.file", wall.file, f"all its {len(corners)} triangles have no area")
    corners = corners[~flat]
    if wall.turn_axis is not None and wall.turn_angle is not None:
        axis = np.array(wall.turn_axis) / np.linalg.norm(wall.turn_axis)
        angle, (x, y, z) = wall.turn_angle, axis.tolist()
        turn = np.array([turned_about(a, b, c, x, y, z, angle) for a, b, c in np.eye(3).tolist()])
        corners = corners @ turn
    return Mesh(corners + np.array(wall.at or (0.0, 0.0, 0.0)), int(flat.sum()))


@lru_cache(maxsize=8)
def _read(path: Path, name: str, _changed: int, _size: int) -> Floats:
    return read_mesh(path, name)


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
        yield from _motion(key, wall)
        yield from check_servo(case, wall, key)
    for k, entry in enumerate(case.timeline):
        if entry.move is not None:
            if entry.move.wall not in names:
                known = ", ".join(names) or "there is none"
                yield CaseError(f"timeline.{k}.move.wall", entry.move.wall, f"must be a wall: {known}")
            yield from _motion(f"timeline.{k}.move", entry.move)
    yield from check_moves(case)


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


def _motion(key: str, moved: WallSection | MoveSection) -> Iterator[CaseError]:
    if (moved.amplitude is None) != (moved.frequency is None):
        missing = "amplitude" if moved.amplitude is None else "frequency"
        yield CaseError(f"{key}.{missing}", None, "missing; an oscillation needs amplitude and frequency")
    if isinstance(moved, WallSection) and moved.angular_velocity is not None and moved.axis_point is None:
        yield CaseError(f"{key}.axis_point", None, "missing; a wall that turns needs a point on its axis")
    if moved.axis_point is not None and moved.angular_velocity is None:
        yield CaseError(f"{key}.axis_point", None, "has no effect without angular_velocity")


def check_meshes(case: "Case", derived: "Derived") -> Iterator[CaseError]:
    """Find files that are no meshes, and walls of a size that does not fit the grains."""
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        try:
            size = size_of(case, wall, key)
        except CaseError as error:
            yield error
            continue
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


def size_of(case: "Case", wall: WallSection, key: str) -> Floats:
    """Size of a wall along each axis [m], shape (3,)."""
    if wall.shape == "mesh":
        corners = mesh_of(case, wall, key).corners.reshape(-1, 3)
        return np.asarray(np.ptp(corners, axis=0))
    if wall.sides is not None:
        flat = np.abs(np.array(wall.sides)).sum(axis=0)
        up = np.cross(*wall.sides)
        return np.asarray(flat + np.abs(up) / np.linalg.norm(up) * (wall.height or 0.0))
    radius = wall.radius or 0.0
    along = np.array(wall.axis or wall.normal or (0.0, 0.0, 1.0))
    n = along / np.linalg.norm(along)
    across = 2.0 * radius * np.sqrt(np.maximum(1.0 - n**2, 0.0))
    return np.asarray(across + (np.abs(along) if wall.axis is not None else 0.0))


def open_sides(corners: Floats) -> tuple[int, int]:
    """Sides of triangles that no other triangle shares, and that more than two share.

    >>> open_sides(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
    (3, 0)
    """
    points = np.round(corners.reshape(-1, 3) / (1e-9 * max(float(np.ptp(corners)), 1e-300)))
    _, number = np.unique(points, axis=0, return_inverse=True)
    number = number.reshape(-1, 3)
    sides = np.concatenate([np.sort(number[:, [k, (k + 1) % 3]], axis=1) for k in range(3)])
    _, times = np.unique(sides, axis=0, return_counts=True)
    return int((times == 1).sum()), int((times > 2).sum())


def wall_rows(case: "Case") -> list[ExplainRow]:
    """Shape, size and motion of each wall."""
    rows: list[ExplainRow] = []
    for k, wall in enumerate(case.walls):
        key = f"walls.{k}"
        size = " x ".join(f"{100.0 * one:.4g}" for one in size_of(case, wall, key))
        rows.append(word("walls", f"{wall.name}: size in x, y, z", f"{size} cm", wall.shape))
        if wall.shape == "mesh":
            rows += _mesh_rows(case, wall, key)
        moves = [name for name in ("velocity", "angular_velocity", "amplitude") if given(wall, name)]
        if moves:
            rows.append(word("walls", f"{wall.name}: moves", _motion_text(wall), ", ".join(moves)))
        if wall.servo is not None:
            rows.append(word("walls", f"{wall.name}: presses with", servo_text(wall.servo), "servo"))
    return rows


def _mesh_rows(case: "Case", wall: WallSection, key: str) -> list[ExplainRow]:
    mesh = mesh_of(case, wall, key)
    single, several = open_sides(mesh.corners)
    found = [count("walls", f"{wall.name}: triangles", len(mesh.corners), f"{wall.file}, in {wall.unit}")]
    if mesh.empty:
        about = "triangles of no area in the file; they are left out"
        found.append(count("walls", f"{wall.name}: left out", mesh.empty, about, "note"))
    if single:
        about = "sides that one triangle has alone: the mesh is open, or has holes that grains may pass"
        found.append(count("walls", f"{wall.name}: open sides", single, about, "note"))
    if several:
        about = "sides that more than two triangles share: corners there are not smoothed"
        found.append(count("walls", f"{wall.name}: shared sides", several, about, "note"))
    return found


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
