"""Check of the energy account during a run, which a single step cannot make."""

import numpy as np

from ryusa.errors import EnergyCreated
from ryusa.laws.families import ContactTiming
from ryusa.model import Scene, State, Tally, Term
from ryusa.model.contact_law import stiffness_key
from ryusa.model.tally import HELD, residual_of

# Of the largest term of the energy account. In an unstable run nearly all energy is spurious. Sound runs stay
# below 1e-5; a single contact that lasts two steps in all reaches 0.5 for one step.
CREATED = 0.5
_AT_REST = 1e-3  # of the weight of all grains times a diameter; less is round-off in a bed at rest
_STILL = 1e-4  # of the energy gained: grains with less energy of motion rest under a load, as under a lid
_ROUND_OFF = 1e-12  # of the largest term of an account


def energy_created(scene: Scene, state: State, tally: Tally) -> EnergyCreated | None:
    """Return an error if the grains gained energy that no force supplied; None if the account closes.

    Parameters
    ----------
    scene, state, tally : at one moment of the run.

    Notes
    -----
    `Term.STEP`, the energy of springs that begin within a step, counts as spurious: it is the error of a step
    that is too long for the springs, not the work of a force. Under a load F a resting contact has the speed
    F dt/(2 m) in the middle of a step where contacts have exact timing: its dashpot takes at once what the
    step gives. Both sums grow with the time of rest, and nothing moves. Steps too long for the springs are
    seen at their onset, when nearly all that was gained is still in motion.
    """
    created = tally.imbalance + tally.terms[Term.STEP]
    if not created > _ROUND_OFF * max(map(abs, tally.terms)):
        return None
    held = {name: getattr(tally, name) for name in HELD}
    share = residual_of(created, held, dict(zip(Term, tally.terms, strict=True)))
    if not share > CREATED or tally.kinetic <= _STILL * created:
        return None
    weight = float(np.linalg.norm(scene.gravity)) * float((np.abs(scene.m_weight) * scene.d).sum())
    if created <= _AT_REST * weight:
        return None
    motion = np.nan_to_num(np.square(state.v)).sum(axis=1)  # nan where a grain is not there
    grain = int(np.argmax((scene.m + scene.m_added) * motion))
    hint = (
        "Either the step is too long to resolve a contact: raise time.steps_per_contact, which shortens the "
        "step. Or the contacts are so soft that grains overlap deeply: raise "
        f"{stiffness_key(scene.contact)}, which keeps overlaps small."
    )
    if scene.contact.timing is ContactTiming.EXACT:
        hint += (
            " Or grains that hardly move bear a heavy load, under which each step gives and takes a little: "
            "contact.timing = 'at steps' does not."
        )
    return EnergyCreated(
        f"the grains gained {created:.3g} J that no force supplied, {share:.2g} of the largest term of the "
        f"energy account (limit {CREATED:g}); the grain with the highest kinetic energy moves at "
        f"{np.linalg.norm(state.v[grain]):.3g} m/s",
        grain=grain,
        step=state.step,
        t=state.t,
        hint=hint,
    )
