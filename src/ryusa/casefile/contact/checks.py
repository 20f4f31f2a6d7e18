"""Checks of [contact] and [rolling] that need more than one key."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from ryusa.casefile.motion import may_rotate
from ryusa.errors import CaseError
from ryusa.laws.families import Arm, Rolling, Slip

if TYPE_CHECKING:
    from ryusa.casefile.case import Case


def check_contact(case: "Case") -> Iterator[CaseError]:
    """Find friction or damping that is missing, and a Coulomb limit that contradicts the slip rule."""
    contact = case.contact
    if contact.friction is None and contact.friction_angle is None:
        yield CaseError(
            "contact.friction_angle",
            None,
            "missing; give friction_angle or friction: there is no default, because results depend on it",
        )
    if contact.restitution is None and contact.damping is None:
        yield CaseError(
            "contact.restitution", None, "missing; give restitution, or damping (a constant dashpot)"
        )
    if "total" in Slip.of(contact.slip).marks and contact.cap == "spring":
        yield CaseError("contact.cap", "spring", f"must be 'total' (or left out) with slip '{contact.slip}'")


def check_rolling(case: "Case") -> Iterator[CaseError]:
    """Find keys of rolling resistance that are missing or contradict each other."""
    rolling = case.rolling
    if rolling.model != "none":
        if not may_rotate(case):
            yield CaseError("rolling.model", rolling.model, "needs motion.rotation = 'free'")
        if rolling.coefficient == 0.0:
            yield CaseError("rolling.coefficient", None, f"missing or zero; model '{rolling.model}' needs it")
    arm = rolling.arm and Arm.of(rolling.arm)
    if arm and "spring" in Rolling.of(rolling.model).marks and "varies" in arm.marks:
        yield CaseError(
            "rolling.arm", rolling.arm, "must be 'reduced radius' (or left out) with spring-dashpot-slider"
        )
