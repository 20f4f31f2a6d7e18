"""Check of the energy account during a run, which a single step cannot make."""

import math
from dataclasses import dataclass

import numpy as np

from ryusa.errors import EnergyCreated
from ryusa.laws.families import ContactTiming
from ryusa.model import Scene, State, Tally, Term
from ryusa.model.contact_law import stiffness_key
from ryusa.model.tally import HELD, N_TERM, residual_of

# Of the largest term of the energy account. In an unstable run nearly all energy is spurious. Sound runs stay
# below 1e-5; a single contact that lasts two steps in all reaches 0.5 for one step.
CREATED = 0.5
_AT_REST = 1e-3  # of the weight of all grains times a diameter; less is round-off in a bed at rest
_STILL = 1e-4  # of the energy gained: grains with less energy of motion rest under a load, as under a lid
_ROUND_OFF = 1e-12  # of the largest term of an account


@dataclass(frozen=True)
class SinceRest:
    """The energy account at the last frame in which the grains rested; all zero before.

    Attributes
    ----------
    created : energy that no force supplied [J].
    held : energies of motion, height and springs [J].
    terms : summed terms [J], by `Term`.

    Notes
    -----
    Under a load F a resting contact has the speed F dt/(2 m) in the middle of a step where contacts have
    exact timing: its dashpot takes at once what the step gives. Both sums grow with the time of rest, and
    nothing moves. Steps too long for the springs are seen at their onset, when nearly all that was gained is
    still in motion.
    """

    created: float = 0.0
    held: float = 0.0
    terms: tuple[float, ...] = (0.0,) * N_TERM

    def after(self, tally: Tally) -> "SinceRest":
        """The account at a frame if the grains rest in it, else this one."""
        created = _created(tally)
        if not 0.0 < tally.kinetic <= _STILL * created:
            return self
        return SinceRest(created, sum(getattr(tally, name) for name in HELD), tuple(tally.terms))


NO_REST = SinceRest()


def _created(tally: Tally) -> float:
    return tally.imbalance + tally.terms[Term.STEP]


def energy_created(
    scene: Scene, state: State, tally: Tally, rest: SinceRest = NO_REST
) -> EnergyCreated | None:
    """Return an error if the grains gained energy that no force supplied; None if the account closes.

    Parameters
    ----------
    scene, state, tally : at one moment of the run.
    rest : the account when the grains last rested: what was gained since must be as large a share as all.

    Notes
    -----
    `Term.STEP`, the energy of springs that begin within a step, counts as spurious: it is the error of a step
    that is too long for the springs, not the work of a force.
    """
    created, share = _created(tally), math.inf
    if not created > _ROUND_OFF * max(map(abs, tally.terms)):
        return None
    held = {name: getattr(tally, name) for name in HELD}
    for since in (NO_REST, rest):  # by both: soon after a rest there is little of anything
        terms = [one - before for one, before in zip(tally.terms, since.terms, strict=True)]
        if since.created > 0.0:
            terms[Term.START] = since.held
        work = dict(zip(Term, terms, strict=True))
        share = min(share, residual_of(max(created - since.created, 0.0), held, work))
    if not share > CREATED:
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
