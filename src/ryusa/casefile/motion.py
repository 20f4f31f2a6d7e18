"""[motion]: rotation, plane or space, slope and gravity."""

import math
from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from ryusa.casefile.quantities import Acceleration, Boolean, PositiveLength, Slope, SlopeAngle
from ryusa.casefile.record.schema import Timeline
from ryusa.casefile.section import Section
from ryusa.errors import CaseError

RIVALS = (("slope", "slope_angle"),)
STEEPEST = 1.0  # tangent, beyond which a slope is given as an angle


class MotionSection(Section):
    """How grains may move, and the gravity that acts on them."""

    rotation: Literal["locked", "free"]
    """Whether grains rotate: "free", or "locked" (translation only)."""
    plane: Boolean = True
    """true: grains move in the x-z plane only; false: in three dimensions."""
    slope: Slope | None = None
    """Bed slope as a tangent, positive where the bed falls towards +x; 0 when no slope is given."""
    slope_angle: SlopeAngle | None = None
    """Bed slope as an angle, instead of slope."""
    gravity: Annotated[Acceleration, Field(ge=0, le=1.0e4)] = 9.80665
    """Acceleration of gravity g."""
    slab_width: PositiveLength | None = None
    """Width in y that a plane scene stands for when concentrations and fluxes are computed; the mean diameter
    when not given."""


def slope(motion: MotionSection) -> float:
    """Bed slope at the start [rad], positive down towards +x."""
    return motion.slope_angle if motion.slope_angle is not None else math.atan(motion.slope or 0.0)


def slope_at_last(motion: MotionSection, timeline: Timeline) -> float:
    """Bed slope after the last change of the timeline [rad], positive down towards +x."""
    for change in reversed(timeline):
        if change.slope is not None or change.slope_angle is not None:
            return change.slope_angle if change.slope_angle is not None else math.atan(change.slope or 0.0)
    return slope(motion)


def may_rotate(motion: MotionSection, timeline: Timeline) -> bool:
    """Whether grains rotate from the start or after some change of the timeline."""
    return motion.rotation == "free" or any(change.rotation == "free" for change in timeline)


def too_steep(key: str, value: float) -> CaseError:
    """Fault of a slope that is rather degrees or per cent."""
    turned = math.degrees(math.atan(value))
    return CaseError(
        key, value, f"is the tangent of {turned:.3g} deg; steeper than 45 deg is asked for as "
        f"{key}_angle = '{turned:.3g} deg'. Were {value:g} deg meant, or '{value:g} %'?",
    )  # fmt: skip


def check_motion(motion: MotionSection, timeline: Timeline) -> Iterator[CaseError]:
    """Find keys of [motion] that have no effect, and slopes that are rather degrees or per cent."""
    slopes = {"motion.slope": motion.slope}
    slopes |= {f"timeline.{k}.slope": change.slope for k, change in enumerate(timeline)}
    for key, value in slopes.items():
        if value is not None and abs(value) > STEEPEST:
            yield too_steep(key, value)
    if motion.slab_width is not None and not motion.plane:
        yield CaseError("motion.slab_width", motion.slab_width, "has no effect unless motion.plane = true")
