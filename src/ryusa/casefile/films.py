"""Water films between grains: restitution under water and lubrication, keys of [water]."""

import math
from collections.abc import Iterator

from ryusa.casefile.case import Case
from ryusa.casefile.contact.values import may_pull, restitution
from ryusa.casefile.facts import Derived
from ryusa.casefile.grading import reference_diameter
from ryusa.casefile.grains.values import mass
from ryusa.casefile.rows import ExplainRow, number
from ryusa.casefile.water.schema import WaterSection
from ryusa.casefile.water.values import terminal_velocity
from ryusa.errors import CaseError
from ryusa.laws import collision, immersed
from ryusa.laws._family import evaluate, numbers
from ryusa.laws.families import Film, Rebound

numbers(__name__, Film.NONE, Film.LUBRICATION)  # engines know a film by its reach
REACH = 0.25  # of a film when the case gives none, in mean diameters


def film_reach(case: Case) -> float:
    """Gap below which the film force acts [m]; 0 without film force."""
    wet = case.water
    if wet is None or Film.of(wet.film) is Film.NONE:
        return 0.0
    return wet.film_reach if wet.film_reach is not None else REACH * reference_diameter(case)


def check_films(case: Case) -> Iterator[CaseError]:
    """Find keys of films that are missing or contradict each other."""
    wet = case.water
    if wet is None:
        return
    film = wet.film != "none"
    if wet.rebound != "dry" and film:
        text = f"contradicts rebound '{wet.rebound}', which includes the film; take one of the two"
        yield CaseError("water.film", wet.film, text)
    if wet.rebound != "dry" and case.contact.restitution is None:
        text = f"missing; rebound '{wet.rebound}' reduces the restitution in air"
        yield CaseError("contact.restitution", None, text)
    elif wet.rebound != "dry" and wet.rebound_least > (case.contact.restitution or 1.0):
        text = f"must not be above contact.restitution = {case.contact.restitution:g}"
        yield CaseError("water.rebound_least", wet.rebound_least, text)
    yield from _lengths(case, wet, film)


def _lengths(case: Case, wet: WaterSection, film: bool) -> Iterator[CaseError]:
    d = reference_diameter(case)
    needed = "asperity" in (*Film.of(wet.film).takes, *Rebound.of(wet.rebound).takes)
    if wet.asperity is None:
        if needed:
            who = f"film '{wet.film}'" if film else f"rebound '{wet.rebound}'"
            yield CaseError(
                "water.asperity", None, f"missing; {who} needs the film thickness at which grains touch"
            )
        return
    if needed and wet.asperity >= 0.5 * d:
        text = f"must be below the mean radius, {0.5 * d:g} m"
        yield CaseError("water.asperity", wet.asperity, text)
    if film and wet.film_reach is not None and wet.film_reach > d:
        yield CaseError("water.film_reach", wet.film_reach, f"must not be above the mean diameter, {d:g} m")


def check_film_step(case: Case, derived: Derived) -> Iterator[CaseError]:
    """Find a time step too long for the dashpot of a wet contact, or for a film about to touch."""
    wet = case.water
    if wet is None:
        return
    rebound, film = step_limits(case, derived.k_n, derived.d_min, derived.meet)
    if derived.dt > rebound:
        text = (
            f"a contact damped to this restitution needs a step below {rebound:.3g} s, and dt = "
            f"{derived.dt:.3g} s; take a shorter step or a larger water.rebound_least"
        )
        yield CaseError("water.rebound_least", wet.rebound_least, text)
    if derived.dt > film:
        text = (
            f"a film of {wet.asperity:.3g} m stops a grain within {film:.3g} s, which dt = "
            f"{derived.dt:.3g} s does not resolve; take a shorter step or a larger asperity"
        )
        yield CaseError("water.asperity", wet.asperity, text)


def step_limits(case: Case, k_n: float, d_min: float, meet: bool) -> tuple[float, float]:
    """Largest steps [s] for the most damped wet contact, and for the thinnest film; inf without them.

    Parameters
    ----------
    k_n : stiffness [N/m].
    d_min : smallest diameter [m].
    meet : whether two free grains can meet.
    """
    wet = case.water
    if wet is None:
        return math.inf, math.inf
    m = sum(mass(case, d_min)[:2])
    rebound = film = math.inf
    if wet.rebound != "dry":
        zeta = collision.zeta_for_restitution(wet.rebound_least, may_pull(case.contact))
        rebound = collision.step_limit(zeta, collision.omega_natural(k_n, 0.5 * m if meet else m))
    if wet.film != "none" and wet.asperity is not None:
        film = wet.asperity * immersed.stokes_number(1.0, m, 0.5 * d_min, wet.density, wet.viscosity)
    return rebound, film


def film_rows(case: Case, derived: Derived) -> list[ExplainRow]:
    """Restitution under water and reach of films; none where contacts are those in air."""
    wet = case.water
    if wet is None or (wet.rebound == "dry" and wet.film == "none"):
        return []
    rows: list[ExplainRow] = []
    speed = terminal_velocity(case)
    if 0.0 < speed < math.inf:
        m, r = derived.m + derived.m_added, 0.5 * derived.d
        st = immersed.stokes_number(speed, m, r, wet.density, wet.viscosity)
        rows.append(
            number("water", "Stokes number", st, "-", "of an impact on a wall at the settling velocity")
        )
        if wet.rebound != "dry":
            e = restitution(case.contact)[0]
            e = evaluate(
                Rebound.of(wet.rebound), e_dry=e, st=st, st_c=wet.rebound_stokes,
                roughness=wet.asperity or math.nan, d=derived.d,
            )  # fmt: skip
            origin = f"rebound {wet.rebound} at this Stokes number, not below {wet.rebound_least:g}"
            e = max(e, wet.rebound_least)
            rows.append(number("water", "restitution under water", e, "-", origin))
    if wet.film != "none":
        origin = (
            "water.film_reach" if wet.film_reach is not None else f"{REACH:g} d (water.film_reach not given)"
        )
        rows.append(number("water", "reach of films", film_reach(case), "cm", origin))
    return rows
