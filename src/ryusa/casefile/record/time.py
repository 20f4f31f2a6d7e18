"""[time]: the time step, and what limits it."""

from collections.abc import Iterator
from typing import Any

from ryusa.casefile.case import Case
from ryusa.casefile.contact.schema import ContactSection
from ryusa.casefile.contact.values import is_hertz, parting, timing
from ryusa.casefile.facts import Derived
from ryusa.casefile.rows import ExplainRow, number
from ryusa.casefile.shape import has_clumps
from ryusa.errors import CaseError
from ryusa.laws.families import ContactTiming

STEPS_PER_CONTACT = {ContactTiming.EXACT: 10.0, ContactTiming.AT_STEPS: 50.0}  # when the case gives no step
STEPS_LOSSLESS = 16.0  # with exact timing at restitution 1, where nothing takes what steps give (design/0014)
# Steps per contact of elastic spheres: e to 7e-3 at worst, as at 50 of linear springs (design/0018).
STEPS_OF_HERTZ = 25.0
TANGENTIAL_SHARE = 0.2  # of the largest stable step of the tangential motion, when the case gives no step
MOST_STEPS = 500.0  # per contact when the case gives no step; a case that needs more has to say so
STEPS_PER_FILM = 5.0  # in the time in which the thinnest film stops a grain, when the case gives no step
COARSEST, FINEST = 5.0, 1.0e4  # steps per contact that a given step must lie between
FEWEST_STEPS = 10.0  # per contact that begins at steps, below which the restitution is off: the paper
CLOSE = 0.5  # fraction of the largest stable step beyond which grains in several contacts may be unstable


def check_time(case: Case, derived: Derived, data: dict[str, Any]) -> Iterator[CaseError]:
    """Find a time step beyond the stability limit of a contact, too coarse or needlessly fine."""
    written = data.get("time", {})
    steps = case.time.steps_per_contact
    if steps is not None and steps < FEWEST_STEPS and not _exact(case):
        yield CaseError(
            "time.steps_per_contact",
            steps,
            f"must be at least {FEWEST_STEPS:g} with contact.law '{case.contact.law}'"
            if is_hertz(case.contact)
            else f"must be at least {FEWEST_STEPS:g} with contact.timing '{timing(case).word}'; "
            f"'{ContactTiming.EXACT.word}' allows {COARSEST:g}",
        )
    if derived.dt > derived.step_limit:
        key = "steps_per_contact" if case.time.step is None else "step"
        yield CaseError(f"time.{key}", written.get(key), _unstable(case.contact, derived, key))
    if case.time.step is None:
        return
    t_col, steps = derived.shortest, derived.steps_per_contact
    if steps < COARSEST:
        yield CaseError(
            "time.step",
            written.get("step"),
            f"must be below {t_col / COARSEST:.3g} s, a fifth of the shortest contact, {t_col:.3g} s",
        )
    if steps > FINEST:
        yield CaseError(
            "time.step",
            written.get("step"),
            f"must be above {t_col / FINEST:.3g} s, 1e-4 of the shortest contact, {t_col:.3g} s",
        )


def _exact(case: Case) -> bool:
    """Whether contacts begin and end within steps."""
    return timing(case) is ContactTiming.EXACT


def steps_by_default(case: Case) -> float:
    """Steps in the shortest contact when the case gives no step, as far as contacts decide."""
    return steps_of_law(is_hertz(case.contact), timing(case), case.contact.restitution == 1.0)


def steps_of_law(hertz: bool, when: ContactTiming, lossless: bool) -> float:
    """Steps in the shortest contact when none are given, of elastic spheres or lossless springs."""
    if hertz:
        return STEPS_OF_HERTZ
    return STEPS_LOSSLESS if lossless and when == ContactTiming.EXACT else STEPS_PER_CONTACT[when]


def _unstable(contact: ContactSection, derived: Derived, key: str) -> str:
    """Which motion is unstable, and what makes it stable."""
    tangential = derived.step_limit_shear == derived.step_limit
    which, softer = ("tangential", "contact.shear_ratio") if tangential else ("normal", "contact.stiffness")
    softer = "contact.youngs_modulus" if is_hertz(contact) else softer
    shorter = "a larger time.steps_per_contact" if key == "steps_per_contact" else "a smaller time.step"
    return (
        f"dt = {derived.dt:.3g} s is above {derived.step_limit:.3g} s, the largest step at which the {which} "
        f"motion in a contact is stable. Either take {shorter} (a shorter step), or raise the limit with a "
        f"smaller {softer} (a slower oscillation) or less damping"
    )


def time_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Durations of contacts and the time step."""
    rows: list[ExplainRow] = []
    undamped = "Eq. (8) with added mass, without damping"
    if is_hertz(case.contact):
        undamped = "Hertz, at the expected impact speed, with added mass, without damping"
    for name, pair in (("on a fixed grain", derived.fixed), ("between free grains", derived.free)):
        rows += [
            number("time", f"collision time {name}", pair.t_undamped, "s", undamped),
            number("time", f"contact time {name}", pair.t_col, "s", f"with damping, {parting(case.contact)}"),
        ]
    partners = "two free grains" if derived.meet else "a grain on a fixed one"
    if is_hertz(case.contact) and not derived.meet:
        partners = "a grain on a wall"
    size = ", both of the smallest diameter" if derived.meet else ", of the smallest diameter"
    partners += size if derived.d_max > derived.d_min else ""
    partners += ", pushed where a clump gives way most" if has_clumps(case.grains) else ""
    few = derived.steps_per_contact < FEWEST_STEPS and not _exact(case)
    ratio = "shortest contact over dt"
    ratio += "; the paper asks for at least ten: with fewer the restitution is not reached" if few else ""
    step = "time.step"
    if case.time.step is None:
        step = f"shortest contact over {derived.steps_per_contact:.4g} (steps per contact)"
    which = "tangential" if derived.step_limit_shear == derived.step_limit else "normal"
    close = derived.dt > CLOSE * derived.step_limit
    limit = (
        f"stability of the {which} motion in one contact; dt is {derived.dt / derived.step_limit:.2g} of it"
    )
    limit += "; a grain in several contacts at once needs a smaller step" if close else ""
    return [
        *rows,
        number("time", "shortest contact", derived.shortest, "s", partners),
        number("time", "largest stable step", derived.step_limit, "s", limit, "warning" if close else ""),
        number("time", "dt", derived.dt, "s", step),
        number("time", "steps per contact", derived.steps_per_contact, "-", ratio, "warning" if few else ""),
    ]
