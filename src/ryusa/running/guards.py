"""Guards of the loop: what no single step can see."""

import numpy as np

from ryusa.errors import EnergyCreated
from ryusa.model import Book, Scene, State, Tally
from ryusa.model.tally import HELD, residual_of

# Of the largest term of the energy account. Where grains boil, nearly all of it was created. Healthy runs
# stay below 1e-5; one contact just met, of two steps in all, has 0.5 for a moment.
CREATED = 0.5
_AT_REST = 1e-3  # of the weight of all grains times a diameter: less is round-off of grains that lie still


def energy_created(scene: Scene, state: State, tally: Tally) -> EnergyCreated | None:
    """Tell energy that came from nowhere, or from the step; None where the account holds.

    Parameters
    ----------
    scene, state, tally : at one moment of the run.

    Notes
    -----
    `Book.STEP`, springs met within a step, counts as created: it explains what a step too long for the
    springs gives, and nobody gave it.
    """
    created = tally.imbalance + tally.books[Book.STEP]
    if not created > 0.0:
        return None
    held = {name: getattr(tally, name) for name in HELD}
    share = residual_of(created, held, dict(zip(Book, tally.books, strict=True)))
    if not share > CREATED:
        return None
    weight = float(np.linalg.norm(scene.gravity)) * float((np.abs(scene.m_weight) * scene.d).sum())
    if created <= _AT_REST * weight:
        return None
    grain = int(np.argmax((scene.m + scene.m_added) * np.square(state.v).sum(axis=1)))
    return EnergyCreated(
        f"{created:.3g} J came from nowhere, {share:.2g} of the largest term of the energy "
        f"account (limit {CREATED:g}); the grain with most has {np.linalg.norm(state.v[grain]):.3g} m/s",
        grain=grain,
        step=state.step,
        t=state.t,
        hint="Either the step is too long to resolve a contact: raise time.steps_per_contact, which "
        "shortens the step. Or the springs are so soft that grains overlap deeply: raise "
        "contact.stiffness, which keeps overlaps small.",
    )
