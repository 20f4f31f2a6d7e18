"""Faults: what LAMMPS reports, and what its grains show at an inspection."""

from typing import Any

from ryusa.engine.shared.parameters import LARGEST_DISPLACEMENT
from ryusa.errors import GrainLost, ListUnsafe, NotANumber, OverlapTooLarge, RunError, RyusaError
from ryusa.model import Scene
from ryusa.model.contact_law import stiffness_key

INSPECTED = "LAMMPS is inspected at intervals: it happened within the last {} steps."
LISTED = "LAMMPS noticed it as it listed neighbours: it happened since the last list."
_LONGER = "raise time.steps_per_contact, which shortens the step"


class LammpsFailed(RyusaError):
    """LAMMPS reported an error of its own, in its words."""

    exit_code = 3


class SharedFault(Exception):
    """An error that LAMMPS reported on all ranks.

    Attributes
    ----------
    error : what to say.
    """

    def __init__(self, error: RyusaError) -> None:
        self.error = error
        super().__init__(str(error))


class RankFault(SharedFault):
    """An error of one rank, for which the others wait."""


def fault_of_lammps(error: Exception, lost: RunError | None) -> SharedFault:
    """What an exception of the module of LAMMPS means.

    Parameters
    ----------
    lost : the error of a grain of this rank, if one explains the exception.
    """
    said = lost or LammpsFailed(f"LAMMPS: {' '.join(str(error).split())}")
    alone = type(error).__name__ == "MPIAbortException"
    return RankFault(said) if alone else SharedFault(said)


def not_a_number(grain: int, step: int, t: float, when: str) -> NotANumber:
    """The error of a grain whose position, velocity or spin is not finite.

    Parameters
    ----------
    step, t : where it was noticed; t in s.
    when : a sentence that says how much earlier it may have happened.
    """
    hint = f"Most likely the step is too long for the springs: {_LONGER}. {when}"
    return NotANumber("position, velocity or spin is not finite", grain=grain, step=step, t=t, hint=hint)


def fault_of_grains(scene: Scene, found: Any, step: int, t: float, since: int) -> RunError | None:
    """The first fault that an inspection shows; None without one.

    Parameters
    ----------
    found : extremes of all grains (`answers.Extremes`).
    step, t : step and time of the inspection [s].
    since : steps since the one before.
    """
    where: dict[str, Any] = {"step": step, "t": t}
    ago = INSPECTED.format(since)
    if found.not_finite >= 0:
        return not_a_number(found.not_finite, step, t, ago)
    if found.overlap > scene.overlap_limit:
        key = stiffness_key(scene.contact)
        return OverlapTooLarge(
            f"overlap is {found.overlap:.3g} of the smaller diameter, more than the limit "
            f"{scene.overlap_limit:g}",
            grain=found.pair[0], partner=found.pair[1],
            hint=f"Use stiffer contacts ({key}), or raise domain.overlap_limit if this is meant. {ago}",
            **where,
        )  # fmt: skip
    smallest = scene.d_min
    if found.speed * scene.dt > LARGEST_DISPLACEMENT * smallest:
        return ListUnsafe(
            f"a grain moves {found.speed * scene.dt / smallest:.2g} diameters in one step "
            f"({found.speed:.3g} m/s)",
            grain=found.fastest,
            hint="At this speed it could pass through another grain between two steps. Most likely the step "
            f"is too long for a contact that accelerated it: {_LONGER}. {ago}",
            **where,
        )  # fmt: skip
    if found.outside >= 0:
        hint = (
            "It flew, rolled or fell out, through a gap or a bed too soft to hold it: close the gap, raise "
            f"{stiffness_key(scene.contact)}, or widen domain.low and domain.high. {ago}"
        )
        return GrainLost("a grain left the world", grain=found.outside, hint=hint, **where)
    return None
