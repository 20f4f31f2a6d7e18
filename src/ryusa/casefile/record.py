"""[stop], [[timeline]] and [record]: when a run ends, what changes on the way, and what is kept of it."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field

from ryusa.casefile.builders.schema import FromFile, SaltationSection
from ryusa.casefile.builders.values import counts
from ryusa.casefile.precision import PrecisionSection
from ryusa.casefile.quantities import (
    Boolean,
    Count,
    Duration,
    FrictionAngle,
    FrictionCoefficient,
    Length,
    Moment,
    Slope,
    SlopeAngle,
    Speed,
)
from ryusa.casefile.row.schema import RowDischarge
from ryusa.casefile.row.values import water_alone
from ryusa.casefile.section import Section
from ryusa.casefile.walls import MoveSection
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived

LONG = 5.0e-3  # [s] that no contact of grains lasts
MANY = 1000  # free grains above which contacts are recorded only on request
CHANGES = (
    "remove", "slope", "slope_angle", "friction_angle", "friction", "rotation", "move", "discharge", "level",
)  # fmt: skip


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


def events_of(case: "Case") -> Literal["all", "tracked", "none"]:
    """Which contacts are recorded."""
    if case.record.events is not None:
        return case.record.events
    if water_alone(case):
        return "none"
    return "all" if counts(case)[0] <= MANY or case.stop.saltations is not None else "none"


def check_stop(case: "Case") -> Iterator[CaseError]:
    """Find a run without an end, and saltations without a bed."""
    stop = case.stop
    if stop.time is None and stop.saltations is None and stop.rest is None:
        yield CaseError("stop", None, "needs at least one of time, saltations, rest")
    if stop.saltations is not None and not isinstance(case.build, SaltationSection | FromFile):
        yield CaseError(
            "stop.saltations",
            stop.saltations,
            "needs a bed to saltate over: builder 'saltation', 'table' or 'run'",
        )


def check_timeline(case: "Case", data: dict[str, Any]) -> Iterator[CaseError]:
    """Find changes with several keys or none, out of order, or after the end of the run."""
    before, written = 0.0, data.get("timeline", [])
    for k, change in enumerate(case.timeline):
        key, at = f"timeline.{k}", written[k]["at"]
        present = [name for name in CHANGES if getattr(change, name) is not None]
        if len(present) != 1:
            yield CaseError(
                key, None, f"needs exactly one of {', '.join(CHANGES)} beside at; it has {len(present)}"
            )
        if change.at < before:
            yield CaseError(
                f"{key}.at", at, "is earlier than the change before it; write the timeline in order of time"
            )
        if case.stop.time is not None and change.at > case.stop.time:
            yield CaseError(f"{key}.at", at, f"comes after stop.time, {data['stop']['time']}")
        before = max(before, change.at)


def check_record(case: "Case", derived: "Derived") -> Iterator[CaseError]:
    """Find tracked grains that do not exist, and a settling time beyond the end of the run."""
    record, n_grain = case.record, derived.n_grain
    for k, one in enumerate(record.tracked):
        if one >= n_grain:
            yield CaseError(f"record.tracked.{k}", one, f"must be below {n_grain}, the number of free grains")
    if record.events == "tracked" and not record.tracked:
        yield CaseError("record.tracked", None, "missing; events = 'tracked' needs the numbers of grains")
    if case.stop.time is not None and record.settle >= case.stop.time:
        yield CaseError(
            "record.settle",
            record.settle,
            f"must be shorter than stop.time, {case.stop.time:g} s: the case lets so much time pass before "
            "measures begin; give a shorter one in [record] or with --set record.settle=...",
        )


def check_frames(case: "Case", derived: "Derived", data: dict[str, Any]) -> Iterator[CaseError]:
    """Find frames closer together than steps, or farther apart than begin and end of the run."""
    interval, end = case.record.frames, case.stop.time
    written = data.get("record", {}).get("frames", f"{interval:g} s")
    if end is not None and interval > end:
        allowed = (
            f"must be at most stop.time, {data['stop']['time']}: the run would keep its first frame alone"
        )
        yield CaseError("record.frames", written, allowed)
    if interval < derived.dt:
        stiffness = "youngs_modulus" if case.contact.youngs_modulus is not None else "stiffness"
        given = data.get("contact", {}).get(stiffness)
        if case.time.step is None and derived.shortest > max(interval, LONG):
            yield CaseError(
                f"contact.{stiffness}", given, f"is so small that the shortest contact lasts "
                f"{derived.shortest:.4g} s and a step {derived.dt:.4g} s, longer than record.frames, "
                f"{interval:g} s: take stiffer contacts (`ryusa check` shows overlaps) or fewer frames",
            )  # fmt: skip
            return
        yield CaseError("record.frames", written, f"must be at least one step, {derived.dt:.4g} s")
