"""What follows from a case: masses, stiffness, damping, time step, friction velocity."""

import math

from ryusa.casefile.builders.table import lightest_in_file
from ryusa.casefile.builders.values import counts, room, sizes
from ryusa.casefile.case import Case
from ryusa.casefile.column.values import column_u_star
from ryusa.casefile.contact.values import (
    friction,
    is_hertz,
    pair_values,
    restitution,
    shortest_contact,
    step_limit,
    stiffness,
)
from ryusa.casefile.facts import Derived
from ryusa.casefile.films import step_limits
from ryusa.casefile.grains.values import mass
from ryusa.casefile.materials.values import lightest_of, meeting, smallest_of
from ryusa.casefile.motion import slope
from ryusa.casefile.record.time import MOST_STEPS, STEPS_PER_FILM, TANGENTIAL_SHARE, steps_by_default
from ryusa.casefile.row.values import stream, water_alone, water_step
from ryusa.casefile.shape import least_mass, spheres_per_grain
from ryusa.casefile.water.values import u_star_given
from ryusa.laws import drag, water


def derive(case: Case) -> Derived:
    """Everything that follows from a case."""
    d, d_min, d_max = sizes(case)
    m, m_added, m_weight, inertia = mass(case, d)
    k_n, k_s = stiffness(case)
    e_n, e_s, _, _ = restitution(case.contact)
    n_grain, n_fixed, meet = counts(case)
    pairs = [
        (lightest_of(case, a, b, both), smallest_of(case, a, b), both)
        for (a, b), both in meeting(case).items()
    ]
    pairs = pairs if case.materials else [(lightest_in_file(case), d_min, meet)]
    lighter = least_mass(case)
    power = 0.4 if is_hertz(case.contact) else 0.5  # of the mass in the duration of a contact
    shortest = lighter**power * min(shortest_contact(one, d, both) for one, d, both in pairs)
    steps = [step_limit(one, d, both) for one, d, both in pairs]
    slower = math.sqrt(lighter)
    limits = slower * min(normal for normal, _ in steps), slower * min(shear for _, shear in steps)
    if case.time.step is not None:
        dt = case.time.step
    elif water_alone(case):
        dt = water_step(case)
    elif case.time.steps_per_contact is not None:
        dt = shortest / case.time.steps_per_contact
    else:
        wet_limits = [step_limits(one, stiffness(one)[0], d, both) for one, d, both in pairs]
        wet_steps = min(one for one, _ in wet_limits), min(one for _, one in wet_limits)
        dt = _default_step(case, shortest, limits[1], wet_steps)
    u_star, tau_star, k_rough = _shear_of_water(case, d)
    return Derived(
        d=d,
        d_min=d_min,
        d_max=d_max,
        room=room(case),
        volume=drag.volume(d, case.grains.shape_volume),
        m=m,
        m_added=m_added,
        m_weight=m_weight,
        inertia=inertia,
        g=case.motion.gravity,
        slope=slope(case.motion),
        k_n=k_n,
        k_s=k_s,
        mu=friction(case.contact),
        e_n=e_n,
        e_s=e_s,
        fixed=pair_values(case, d, False),
        free=pair_values(case, d, True),
        n_grain=n_grain,
        n_sphere=round(n_grain * spheres_per_grain(case)),
        n_fixed=n_fixed,
        meet=meet,
        shortest=shortest,
        dt=dt,
        step_limit=min(limits),
        step_limit_shear=limits[1],
        steps_per_contact=shortest / dt if dt > 0.0 else math.nan,
        u_star=u_star,
        tau_star=tau_star,
        k_rough=k_rough,
    )


def _shear_of_water(case: Case, d: float) -> tuple[float, float, float]:
    """Friction velocity [m/s], Shields number [-] and roughness [m] of the water; nan where it has none.

    `d` is the mean diameter [m].
    """
    wet, rho_s, g = case.water, case.grains.density, case.motion.gravity
    if wet is None:
        return math.nan, math.nan, math.nan
    k_rough = wet.roughness if wet.roughness is not None else d
    row = water_alone(case) or stream(case)  # its flow follows from its ends
    driven = wet.profile == "column" and case.column.drive == "tau_star"
    u_star, tau_star = u_star_given(case), math.nan
    if wet.tau_star is not None and not driven:
        tau_star = wet.tau_star
    elif (wet.profile == "column" and not row) or wet.u_star is not None:
        u_star = column_u_star(case, k_rough) if math.isnan(u_star) or driven else u_star
        if rho_s > wet.density and g > 0.0:
            tau_star = water.tau_star_from_u_star(u_star, rho_s, wet.density, g, d)
    return u_star, tau_star, k_rough


def _default_step(case: Case, shortest: float, tangential: float, wet: tuple[float, float]) -> float:
    """Time step when the case gives none [s].

    Parameters
    ----------
    shortest : duration of the shortest contact [s].
    tangential : largest stable step of the tangential motion of a pair [s].
    wet : largest steps for the most damped wet contact and for the thinnest film [s].
    """
    rebound, film = wet
    in_contact = shortest / steps_by_default(case)
    wanted = min(in_contact, TANGENTIAL_SHARE * tangential, rebound, film / STEPS_PER_FILM)
    return max(wanted, shortest / MOST_STEPS)
