"""Guards of the loop: what no single step can see."""

import numpy as np

from ryusa.errors import EnergyCreated
from ryusa.model import Scene, State, Tally

CREATED = 0.5  # of the largest term of the energy account; overlaps of a third of a diameter leave 0.02
_AT_REST = 1e-3  # of the weight of all grains times a diameter: less is round-off of grains that lie still


def energy_created(scene: Scene, state: State, tally: Tally) -> EnergyCreated | None:
    """Tell energy that came from nowhere; None where the account holds.

    Parameters
    ----------
    scene, state, tally : at one moment of the run.
    """
    if not (tally.imbalance > 0.0 and tally.residual > CREATED):
        return None
    weight = float(np.linalg.norm(scene.gravity)) * float((np.abs(scene.m_weight) * scene.d).sum())
    if tally.imbalance <= _AT_REST * weight:
        return None
    grain = int(np.argmax((scene.m + scene.m_added) * np.square(state.v).sum(axis=1)))
    return EnergyCreated(
        f"{tally.imbalance:.3g} J came from nowhere, {tally.residual:.2g} of the largest term of the energy "
        f"account (limit {CREATED:g}); the grain with most has {np.linalg.norm(state.v[grain]):.3g} m/s",
        grain=grain,
        step=state.step,
        t=state.t,
        hint="The step is too long for the springs, or they are too soft: take more time.steps_per_contact, "
        "or a larger contact.stiffness.",
    )
