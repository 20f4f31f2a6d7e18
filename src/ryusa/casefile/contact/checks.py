"""Checks of [contact] and [rolling] that need more than one key."""

import math
from collections.abc import Iterator

from ryusa.casefile.case import Case
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.contact.values import adhesion, is_hertz, timing
from ryusa.casefile.motion import may_rotate
from ryusa.casefile.shape import has_clumps
from ryusa.errors import CaseError
from ryusa.laws.families import Adhesion, Arm, ContactTiming, Rolling, Slip


def check_contact(case: Case) -> Iterator[CaseError]:
    """Find stiffness, friction or damping that is missing, and choices that contradict each other."""
    contact, elastic = case.contact, is_hertz(case.contact)
    if elastic and contact.youngs_modulus is None:
        yield CaseError("contact.youngs_modulus", None, f"missing; law '{contact.law}' needs it")
    if not elastic and contact.stiffness is None:
        yield CaseError(
            "contact.stiffness",
            None,
            "missing; normal stiffness k_n of the linear spring: a value, or { overlap, speed }, or "
            "{ collision_time }",
        )
    if elastic and timing(case) is not ContactTiming.AT_STEPS:
        yield CaseError(
            "contact.timing",
            contact.timing,
            f"must be 'at steps' (or left out) with law '{contact.law}', whose contacts cannot begin and end "
            "within steps (design/0018)",
        )
    if has_clumps(case.grains) and timing(case) is not ContactTiming.AT_STEPS:
        allowed = "must be 'at steps' (or left out) with clumps: within a step, contacts would be those of "
        yield CaseError("contact.timing", contact.timing, allowed + "spheres (design/0022)")
    yield from _check_adhesion(case)
    if contact.friction is None and contact.friction_angle is None:
        yield CaseError(
            "contact.friction_angle",
            None,
            "missing; give friction_angle or friction: there is no default, because results depend on it",
        )
    if contact.restitution is None and contact.damping is None:
        yield CaseError(
            "contact.restitution",
            None,
            "missing; there is no default"
            if elastic
            else "missing; give restitution, or damping (a constant dashpot)",
        )
    if "total" in Slip.of(contact.slip).marks and contact.cap == "spring":
        yield CaseError("contact.cap", "spring", f"must be 'total' (or left out) with slip '{contact.slip}'")


def _check_adhesion(case: Case) -> Iterator[CaseError]:
    """Find adhesion without its amount, without an area, or with contacts that begin within steps."""
    contact, chosen = case.contact, adhesion(case.contact)
    for key in chosen.takes:
        if getattr(contact, key) is None:
            yield CaseError(f"contact.{key}", None, f"missing; adhesion '{chosen.word}' needs it")
    if chosen is Adhesion.NONE:
        return
    if "elastic" in chosen.marks and not is_hertz(contact):
        yield CaseError(
            "contact.adhesion", chosen.word,
            f"needs law 'Hertz-Mindlin', whose contacts have an area; '{Adhesion.CONSTANT.word}' and "
            f"'{Adhesion.DMT.word}' go with law '{contact.law}'",
        )  # fmt: skip
    springs = not is_hertz(contact) and not has_clumps(case.grains)
    if timing(case) is not ContactTiming.AT_STEPS and springs:
        yield CaseError(
            "contact.timing", contact.timing,
            "must be 'at steps' (or left out) with adhesion: contacts that begin and end within steps are "
            "those of springs alone (design/0024)",
        )  # fmt: skip


def check_expected_speed(case: Case) -> Iterator[CaseError]:
    """Find elastic spheres whose contacts have no duration, because nothing makes them fast."""
    if is_hertz(case.contact) and not 0.0 < expected_speed(case)[0] < math.inf:
        yield CaseError(
            "contact.expected_speed",
            None,
            "missing; the contact time of elastic spheres depends on the impact speed, and none follows from "
            "gravity and the builder",
        )


def check_rolling(case: Case) -> Iterator[CaseError]:
    """Find keys of rolling resistance that are missing or contradict each other."""
    rolling = case.rolling
    if rolling.model != "none":
        if not may_rotate(case.motion, case.timeline):
            yield CaseError("rolling.model", rolling.model, "needs motion.rotation = 'free'")
        if rolling.coefficient == 0.0:
            yield CaseError("rolling.coefficient", None, f"missing or zero; model '{rolling.model}' needs it")
    if rolling.twisting_coefficient > 0.0:
        key, value = "rolling.twisting_coefficient", rolling.twisting_coefficient
        if not may_rotate(case.motion, case.timeline):
            yield CaseError(key, value, "needs motion.rotation = 'free'")
        if case.motion.plane:
            yield CaseError(key, value, "needs motion in space: motion.plane = false")
        if "both alike" in Rolling.of(rolling.model).marks:
            allowed = (
                "needs rolling.model none, constant or spring-dashpot-slider, which oppose relative spin"
            )
            yield CaseError(key, value, allowed)
    arm = rolling.arm and Arm.of(rolling.arm)
    if arm and "spring" in Rolling.of(rolling.model).marks and "varies" in arm.marks:
        yield CaseError(
            "rolling.arm", rolling.arm, "must be 'reduced radius' (or left out) with spring-dashpot-slider"
        )
