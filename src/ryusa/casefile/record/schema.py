"""Keys of [time], [stop], [[timeline]] and [record]."""

from typing import Annotated, Literal

from pydantic import Field

from ryusa.casefile.precision import PrecisionSection
from ryusa.casefile.quantities import (
    Boolean,
    Count,
    Duration,
    FrictionAngle,
    FrictionCoefficient,
    Length,
    Moment,
    Number,
    Slope,
    SlopeAngle,
    Speed,
)
from ryusa.casefile.row.schema import RowDischarge
from ryusa.casefile.section import Section
from ryusa.casefile.walls.schema import MoveSection

RIVALS = (("steps_per_contact", "step"),)  # of [time]: two keys for one thing


class RestSection(Section):
    """When all grains count as at rest."""

    speed: Annotated[Speed, Field(gt=0)]
    """Every grain stays slower than this ..."""
    duration: Annotated[Duration, Field(alias="for")]
    """... for this long."""


class StopSection(Section):
    """When the run ends, by whichever comes first; at least one key is needed."""

    time: Duration | None = None
    """Simulated time."""
    saltations: Annotated[Count, Field(ge=1)] | None = None
    """Number of saltations that every start has completed after record.settle."""
    rest: RestSection | None = None
    """All grains at rest."""
    precision: PrecisionSection | None = None
    """Averages known to these standard errors, each worth 60 independent samples; needs stop.time, the latest
    end."""


class ChangeSection(Section):
    """A change of the scene during the run: exactly one key beside `at`."""

    at: Moment
    """Simulated time of the change."""
    remove: str | None = None
    """Name of the group of fixed grains, of the plane or of the wall to remove."""
    slope: Slope | None = None
    """New bed slope as a tangent."""
    slope_angle: SlopeAngle | None = None
    """New bed slope as an angle."""
    friction_angle: FrictionAngle | None = None
    """New internal friction angle."""
    friction: FrictionCoefficient | None = None
    """New friction coefficient."""
    rotation: Literal["locked", "free"] | None = None
    """Lock or free the rotation of grains."""
    move: MoveSection | None = None
    """Give a wall another motion."""
    discharge: RowDischarge | None = None
    """New discharge at the upper end of a row of columns, per width or of the whole width; one that rises and
    falls is water.row.upstream.hydrograph."""
    level: Length | None = None
    """New height of the surface beyond the lower end of a row of columns, end = "level"."""


Timeline = tuple[ChangeSection, ...]


class RecordSection(Section):
    """What the run folder keeps."""

    frames: Duration = 1.0e-3
    """Simulated time between two frames."""
    events: Literal["all", "tracked", "none"] | None = None
    """Contacts recorded: all, those of tracked grains, or none. When not given: all with up to 1000 free
    grains or where saltations end the run, else none."""
    tracked: tuple[Annotated[Count, Field(ge=0)], ...] = ()
    """Numbers of the tracked grains, from 0."""
    forces: Boolean = False
    """Whether every frame holds the contact forces, which `ryusa measure RUN contact_stress` needs."""
    settle: Moment = 0.0
    """Simulated time before which measures ignore the run."""


class TimeSection(Section):
    """The time step."""

    steps_per_contact: Annotated[Number, Field(ge=5, le=10_000)] | None = None
    """Number of steps in the shortest contact that can occur. When no step is given, 10 with contact.timing
    "exact" (16 where the restitution is 1), 50 with "at steps", and 25 of elastic spheres, or more where a
    tangential oscillation or a film of water needs them."""
    step: Duration | None = None
    """Time step dt, instead of steps_per_contact."""
