"""Keys of [[walls]], of their servos, and of the moves of the timeline."""

from typing import Annotated, Literal

from pydantic import Field

from ryusa.casefile.files import RelativePath
from ryusa.casefile.quantities import (
    Angle,
    Force,
    Frequency,
    Name,
    Number,
    Point,
    PositiveLength,
    Pressure,
    Speed,
    Spin,
)
from ryusa.casefile.section import Section

Vector = tuple[Number, Number, Number]
VelocityVector = tuple[Speed, Speed, Speed]
SpinVector = tuple[Spin, Spin, Spin]


class ServoSection(Section):
    """A wall that is pressed on the grains with a force, or a mean pressure, that a servo holds."""

    direction: Vector
    """Direction in which the wall presses, of any length."""
    force: Annotated[Force, Field(gt=0)] | None = None
    """Force on the grains in this direction."""
    pressure: Annotated[Pressure, Field(gt=0)] | None = None
    """In place of a force: force over the area of the wall, seen along the direction, that lies within the
    sample: one period, or between side walls. `ryusa check` says how large it is."""
    max_speed: Annotated[Speed, Field(gt=0)]
    """Largest speed along the direction, either way; a wall that touches no grain has it."""
    max_travel: PositiveLength | None = None
    """Largest distance along the direction from the first place, either way: beyond it the run ends with an
    error. By default the largest extent of the wall."""


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
