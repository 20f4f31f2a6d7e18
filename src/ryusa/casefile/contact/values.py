"""What follows from [contact]: stiffness, friction, damping ratios, and the values of one pair of grains."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ryusa.casefile.builders.values import sizes
from ryusa.casefile.contact.schema import OverlapStiffnessSection, TimeStiffnessSection
from ryusa.casefile.grains import mass
from ryusa.casefile.motion import may_rotate
from ryusa.laws import collision
from ryusa.laws import contact as contact_law
from ryusa.laws._family import numbers
from ryusa.laws.families import Parting

if TYPE_CHECKING:
    from ryusa.casefile.case import Case

numbers(__name__, Parting.NO_TENSION, Parting.TENSION)
SHEAR_RATIO = 2.0 / 7.0  # k_s over k_n when the case gives neither


@dataclass(frozen=True)
class PairValues:
    """Masses, damping and durations of one kind of contact: a grain on a fixed one, or two free grains."""

    m: float  # effective mass, with added mass [kg]
    m_t: float  # effective mass in the tangential direction [kg]
    zeta_n: float  # damping ratio [-]
    zeta_s: float
    eta_n: float  # dashpots [N s/m]
    eta_s: float
    e: float  # normal restitution reached [-]
    e_s: float  # tangential restitution of the free oscillator [-]
    t_undamped: float  # Eq. (8) with this mass [s]
    t_col: float  # time the normal force lasts [s]
    t_shear: float  # half period of the tangential oscillator [s]; inf without spring


def may_pull(case: "Case") -> bool:
    """Whether the normal dashpot may pull before the overlap ends."""
    return Parting.of(case.contact.parting) is Parting.TENSION


def friction(case: "Case") -> float:
    """Friction coefficient mu = tan(phi) [-]."""
    contact = case.contact
    if contact.friction_angle is not None:
        return math.tan(contact.friction_angle)
    return contact.friction if contact.friction is not None else math.nan


def friction_at_last(case: "Case") -> float:
    """Friction coefficient after the last change of the timeline [-]."""
    for change in reversed(case.timeline):
        if change.friction_angle is not None:
            return math.tan(change.friction_angle)
        if change.friction is not None:
            return change.friction
    return friction(case)


def restitution(case: "Case") -> tuple[float, float, float, float]:
    """Normal and tangential restitution given, and the damping ratios that reach them; nan with constants.

    The tangential damping ratio is that of a two-sided oscillator whatever contact.parting is.
    """
    contact = case.contact
    if contact.restitution is None:
        return math.nan, math.nan, math.nan, math.nan
    e_n = contact.restitution
    e_s = contact.restitution_shear if contact.restitution_shear is not None else e_n
    tension = may_pull(case)
    return (
        e_n,
        e_s,
        collision.zeta_for_restitution(e_n, tension),
        collision.zeta_tension(e_s),
    )


def stiffness(case: "Case") -> tuple[float, float]:
    """Give k_n and k_s [N/m], as written or as they follow for a mean grain on a fixed one."""
    rule, contact = case.contact.stiffness, case.contact
    m, m_added, _, _ = mass(case, sizes(case)[0])
    if isinstance(rule, OverlapStiffnessSection):
        zeta = restitution(case)[2]
        zeta = 0.0 if math.isnan(zeta) else zeta
        k_n = collision.stiffness_for_overlap(rule.overlap * sizes(case)[0], rule.speed, m + m_added, zeta)
    elif isinstance(rule, TimeStiffnessSection):
        k_n = collision.stiffness_for_time(rule.collision_time, m + m_added, 0.0, False)
    else:
        k_n = rule
    if contact.shear_stiffness is not None:
        return k_n, contact.shear_stiffness
    return k_n, k_n * (SHEAR_RATIO if contact.shear_ratio is None else contact.shear_ratio)


def step_limit(case: "Case", d: float, free: bool) -> tuple[float, float]:
    """Largest stable step [s] of the normal and of the tangential motion of the pair of `pair_values`."""
    (k_n, k_s), one = stiffness(case), pair_values(case, d, free, may_rotate(case))
    normal = collision.step_limit(one.zeta_n, collision.omega_natural(k_n, one.m))
    if k_s > 0.0:
        return normal, collision.step_limit(one.zeta_s, collision.omega_natural(k_s, one.m_t))
    return normal, 2.0 * one.m_t / one.eta_s if one.eta_s > 0.0 else math.inf


def pair_values(case: "Case", d: float, free: bool, rotates: bool | None = None) -> PairValues:
    """Values of a grain of diameter d [m] on a fixed one, or of two such grains when `free`.

    `rotates` stands for motion.rotation, which applies when it is not given.
    """
    contact = case.contact
    m, m_added, _, inertia = mass(case, d)
    heavy, r, still = m + m_added, d / 2.0, math.inf
    k_n, k_s = stiffness(case)
    rotates = case.motion.rotation == "free" if rotates is None else rotates
    m_eff = collision.effective_mass(heavy, heavy if free else still)
    m_t = collision.effective_mass_tangential(
        heavy, r, inertia, heavy if free else still, r, inertia if free else still, rotates
    )
    _, _, zeta_n, zeta_s = restitution(case)
    if math.isnan(zeta_n):
        eta_n, eta_s = contact.damping or 0.0, contact.shear_damping or 0.0
        zeta_n = collision.damping_ratio(eta_n, k_n, m_eff)
        zeta_s = collision.damping_ratio(eta_s, k_s, m_t) if k_s > 0.0 else math.inf * eta_s if eta_s else 0.0
    else:
        eta_n, eta_s = contact_law.damping(zeta_n, k_n, m_eff), contact_law.damping(zeta_s, k_s, m_t)
    omega = collision.omega_natural(k_n, m_eff)
    tension = may_pull(case)
    return PairValues(
        m=m_eff,
        m_t=m_t,
        zeta_n=zeta_n,
        zeta_s=zeta_s,
        eta_n=eta_n,
        eta_s=eta_s,
        e=collision.restitution_for_zeta(zeta_n, tension),
        e_s=collision.restitution_tension(zeta_s),
        t_undamped=collision.collision_time(m_eff, k_n),
        t_col=collision.contact_time(zeta_n, omega, tension),
        t_shear=math.inf if k_s == 0.0 else collision.collision_time(m_t, k_s),
    )
