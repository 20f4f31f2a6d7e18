"""Films of water between grains: their keys checked, and explained back."""

import math
from collections.abc import Iterator

from ryusa.casefile.derive import Derived, restitution
from ryusa.casefile.rows import Row, row_of
from ryusa.casefile.schema import Case, Water
from ryusa.casefile.water import terminal_velocity
from ryusa.errors import CaseError
from ryusa.laws import collision, immersed

REACH = 0.25  # of a film when the case gives none, in mean diameters


def film_reach(case: Case) -> float:
    """Gap from which films resist [m]; 0 where they do not."""
    wet = case.water
    if wet is None or wet.film == "none":
        return 0.0
    return wet.film_reach if wet.film_reach is not None else REACH * case.grains.diameter


def check_films(case: Case) -> Iterator[CaseError]:
    """Find keys of films that are missing, have no meaning or contradict each other."""
    wet = case.water
    if wet is None:
        return
    given, film = wet.model_fields_set, wet.film != "none"
    if wet.rebound != "dry" and film:
        text = f"counts the approach that rebound '{wet.rebound}' counts already; take one of the two"
        yield CaseError("water.film", wet.film, text)
    if wet.rebound != "dry" and case.contact.restitution is None:
        text = f"missing; rebound '{wet.rebound}' begins from the restitution in air"
        yield CaseError("contact.restitution", None, text)
    elif wet.rebound != "dry" and wet.rebound_least > (case.contact.restitution or 1.0):
        text = f"must not be above contact.restitution = {case.contact.restitution:g}"
        yield CaseError("water.rebound_least", wet.rebound_least, text)
    for key, needed in (
        ("rebound_stokes", wet.rebound == "exponential"),
        ("rebound_least", wet.rebound != "dry"),
    ):
        if key in given and not needed:
            text = f"has no meaning with rebound '{wet.rebound}'"
            yield CaseError(f"water.{key}", getattr(wet, key), text)
    if wet.film_reach is not None and not film:
        yield CaseError("water.film_reach", wet.film_reach, f"has no meaning with film '{wet.film}'")
    yield from _lengths(case, wet, film)


def _lengths(case: Case, wet: Water, film: bool) -> Iterator[CaseError]:
    d, needed = case.grains.diameter, film or wet.rebound == "Davis"
    if wet.asperity is None:
        if needed:
            who = f"film '{wet.film}'" if film else f"rebound '{wet.rebound}'"
            yield CaseError("water.asperity", None, f"missing; {who} ends where the grains touch")
        return
    if not needed:
        text = f"has no meaning with rebound '{wet.rebound}' and film '{wet.film}'"
        yield CaseError("water.asperity", wet.asperity, text)
    elif wet.asperity >= 0.5 * d:
        text = f"must be below the mean radius, {0.5 * d:g} m"
        yield CaseError("water.asperity", wet.asperity, text)
    if film and wet.film_reach is not None and wet.film_reach > d:
        yield CaseError("water.film_reach", wet.film_reach, f"must not be above the mean diameter, {d:g} m")


def check_film_step(case: Case) -> Iterator[CaseError]:
    """Find a time step too long for the dashpot of a wet contact, or for a film about to touch."""
    wet, found = case.water, case.derived
    if wet is None:
        return
    lightest = _lightest(case, found)
    if wet.rebound != "dry":
        zeta = _zeta(case, wet.rebound_least)
        m = 0.5 * lightest if found.meet else lightest
        most = collision.step_limit(zeta, collision.omega_natural(found.k_n, m))
        if found.dt > most:
            text = (
                f"a contact so damped needs a step below {most:.3g} s, and dt = {found.dt:.3g} s; take a "
                f"shorter step or let more rebound"
            )
            yield CaseError("water.rebound_least", wet.rebound_least, text)
    if wet.film != "none" and wet.asperity is not None:
        rate = _film_rate(found.d_min, lightest, wet)
        if found.dt * rate > 1.0:
            text = (
                f"a film of {wet.asperity:.3g} m stops a grain within {1.0 / rate:.3g} s, which dt = "
                f"{found.dt:.3g} s does not resolve; take a shorter step or rougher grains"
            )
            yield CaseError("water.asperity", wet.asperity, text)


def _lightest(case: Case, found: Derived) -> float:
    """Mass of the smallest grain with its added mass [kg]."""
    return (found.m + found.m_added) * (found.d_min / found.d) ** 3


def _film_rate(d: float, m: float, wet: Water) -> float:
    """Rate at which the thinnest film slows a grain of mass m [kg] against a wall [1/s]."""
    return 1.0 / (
        immersed.stokes_number(1.0, m, 0.5 * d, wet.density, wet.viscosity) * (wet.asperity or math.nan)
    )


def _zeta(case: Case, e: float) -> float:
    tension = case.contact.parting == "tension"
    return collision.zeta_tension(e) if tension else collision.zeta_no_tension(e)


def film_rows(case: Case) -> list[Row]:
    """Rows about rebound under water; none where it is dry."""
    wet, found = case.water, case.derived
    if wet is None or (wet.rebound == "dry" and wet.film == "none"):
        return []
    rows: list[Row] = []
    speed = terminal_velocity(case)
    if 0.0 < speed < math.inf:
        st = immersed.stokes_number(speed, found.m + found.m_added, 0.5 * found.d, wet.density, wet.viscosity)
        rows.append(row_of("water", "Stokes number", st, "-", "of a wall met at the settling velocity"))
        if wet.rebound != "dry":
            e = restitution(case)[0]
            if wet.rebound == "exponential":
                e = immersed.restitution_exponential(e, st, wet.rebound_stokes)
            else:
                e = immersed.restitution_davis(e, st, wet.asperity or math.nan, found.d)
            how = f"rebound {wet.rebound} at that speed, at least {wet.rebound_least:g}"
            rows.append(row_of("water", "restitution under water", max(e, wet.rebound_least), "-", how))
    if wet.film != "none":
        rows.append(row_of("water", "reach of films", film_reach(case), "cm", f"film {wet.film}"))
    return rows
