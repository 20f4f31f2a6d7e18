"""From what a kernel flagged to an error that names grain, partner, step and remedy."""

from typing import Any

import numpy as np

from ryusa.engine.cpu.arrays import Grains
from ryusa.engine.shared.rows import (
    C_DT,
    C_OVERLAP_LIMIT,
    C_T_ZERO,
    FAULT_NOT_A_NUMBER,
    FAULT_OVERLAP,
    N_FAULT,
    N_FAULT_GRAIN,
    N_FAULT_PARTNER,
    N_OVERLAP_MAX,
)
from ryusa.errors import ContactSlotsFull, GrainLost, ListUnsafe, NotANumber, OverlapTooLarge, RunError
from ryusa.model.scene import Floats


def fault_of(now: Floats, numbers: Floats, step: int) -> RunError:
    """The first fault that a block flagged in this step."""
    block = int(np.argmax(now[:, N_FAULT] != 0))
    fault, grain, partner = (int(now[block, k]) for k in (N_FAULT, N_FAULT_GRAIN, N_FAULT_PARTNER))
    t = float(numbers[C_T_ZERO] + step * numbers[C_DT])
    where: dict[str, Any] = {
        "grain": grain,
        "step": step,
        "t": t,
        "partner": None if partner < 0 else partner,
    }
    if fault == FAULT_NOT_A_NUMBER:
        hint = (
            "Forces grew without bound, most likely a step too long for its springs: take more "
            "time.steps_per_contact, and look at the frames before."
        )
        return NotANumber("velocity is not finite", **where, hint=hint)
    if fault == FAULT_OVERLAP:
        found = f"overlap is {now[block, N_OVERLAP_MAX]:.3g} of the smaller diameter, more than the limit"
        hint = "Use stiffer springs (contact.stiffness), or raise domain.overlap_limit if this is meant."
        return OverlapTooLarge(f"{found} {numbers[C_OVERLAP_LIMIT]:g}", **where, hint=hint)
    hint = "Record fewer of them: record.events = 'tracked' or 'none'."
    return ContactSlotsFull("more contacts ended in one step than the record holds", **where, hint=hint)


def unsafe_of(grains: Grains, n: int, numbers: Floats, smallest: float, step: int, t: float) -> ListUnsafe:
    """The fastest grain, which went too far in one step."""
    speed = np.linalg.norm(grains.v[:n, :3], axis=1)
    place = int(speed.argmax())
    way = speed[place] * numbers[C_DT] / smallest
    return ListUnsafe(
        f"a grain moves {way:.2g} diameters in one step ({speed[place]:.3g} m/s)",
        grain=int(grains.ids[place]),
        step=step,
        t=t,
        hint="So fast, it could pass through others unseen. Most likely a contact too stiff or too deep for "
        "the step threw it: take more time.steps_per_contact, and look at the frames before.",
    )


def lost_of(grains: Grains, grain: int, step: int, t: float) -> GrainLost:
    """A grain outside the world."""
    place = int(np.flatnonzero(grains.ids == grain)[0])
    where = ", ".join(f"{a:.4g}" for a in grains.x[place, :3])
    hint = (
        "It flew, rolled or fell out, through a gap or a bed too soft to hold it: close the gap, take a "
        "larger contact.stiffness, or widen domain.low and domain.high."
    )
    return GrainLost(f"a grain left the world at ({where}) m", grain=grain, step=step, t=t, hint=hint)
