"""How many steps of the grains lie between two exchanges with the water: as many as resolve the drag."""

import math

from ryusa.errors import WaterError
from ryusa.model.column import STIFF


def steps_resolved(fastest: float, dt: float, longest: int) -> int:
    """Steps of dt [s] for which an interval resolves the drag, at least one and at most `longest`.

    `fastest` is the largest rate of relaxation by drag [1/s].
    """
    if fastest * dt * longest <= STIFF:
        return longest
    return max(math.floor(STIFF / (fastest * dt)), 1)


def refuse_unresolved(fastest: float, dt: float, most: float, t: float, step: int) -> None:
    """Refuse a step of dt [s] that is longer than `most` of the time in which drag acts.

    Parameters
    ----------
    fastest : largest rate of relaxation by drag [1/s].
    t, step : of the water, for the message.

    Raises
    ------
    WaterError : a step does not resolve it.
    """
    if fastest * dt > most:
        raise WaterError(
            f"Drag brings grains to the speed of the water within {1.0 / fastest:.3g} s, which a step of "
            f"{dt:.3g} s does not resolve",
            step=step,
            t=t,
            hint="Take a shorter step (time.step), larger grains or a less viscous fluid.",
        )
