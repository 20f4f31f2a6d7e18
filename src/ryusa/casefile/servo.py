"""walls.servo: a wall that is pressed on the grains, and what is wrong with what it is asked."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from ryusa.casefile.quantities import Force, Number, PositiveLength, Pressure, Speed
from ryusa.casefile.section import Section, given
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.walls import WallSection

_ALONG = 1e-9  # sine of the angle up to which two directions are one


class ServoSection(Section):
    """A wall that is pressed on the grains with a force, or a mean pressure, that a servo holds."""

    direction: tuple[Number, Number, Number]
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


def check_servo(case: "Case", wall: "WallSection", key: str) -> Iterator[CaseError]:
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


def check_moves(case: "Case") -> Iterator[CaseError]:
    """Find entries of the timeline that move a wall which a servo presses."""
    pressed = {wall.name for wall in case.walls if given(wall, "servo")}
    for k, entry in enumerate(case.timeline):
        if entry.move is not None and entry.move.wall in pressed:
            yield CaseError(
                f"timeline.{k}.move.wall", entry.move.wall,
                "has a servo, which moves it; a wall of its own motion has none",
            )  # fmt: skip


def servo_text(servo: ServoSection) -> str:
    """What a servo is asked, in words."""
    asked = f"{servo.pressure:.4g} Pa" if servo.pressure is not None else f"{servo.force or 0.0:.4g} N"
    towards = ", ".join(f"{one:g}" for one in servo.direction)
    return f"{asked} towards ({towards}), at most {servo.max_speed:.4g} m/s"
