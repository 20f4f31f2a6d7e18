"""What follows from [contact]: stiffness, friction, damping ratios, and the values of one pair of grains."""

import math
from dataclasses import replace

from ryusa.casefile.builders.values import sizes
from ryusa.casefile.case import Case
from ryusa.casefile.contact.schema import ContactSection, OverlapStiffnessSection, TimeStiffnessSection
from ryusa.casefile.contact.speed import expected_speed
from ryusa.casefile.facts import PairValues
from ryusa.casefile.grains.values import mass
from ryusa.casefile.motion import may_rotate
from ryusa.casefile.record.schema import Timeline
from ryusa.casefile.shape import has_clumps
from ryusa.laws import collision, hertz
from ryusa.laws import contact as contact_law
from ryusa.laws._family import numbers
from ryusa.laws.families import (
    Adhesion,
    Cap,
    ContactForce,
    ContactTiming,
    DampingLaw,
    Parting,
    Slip,
    Unloading,
)
from ryusa.model import ContactLaw
from ryusa.model.contact_law import (
    elastic_spheres,
    hertz_stiffness_of,
    largest_overlap_of,
    rest_overlap_of,
    shortest_contact_of,
    step_limits_of,
)

numbers(__name__, Parting.NO_TENSION, Parting.TENSION)
SHEAR_RATIO = 2.0 / 7.0  # k_s over k_n when the case gives neither


def is_hertz(contact: ContactSection) -> bool:
    """Whether contacts are those of elastic spheres."""
    return ContactForce.of(contact.law) is ContactForce.HERTZ_MINDLIN


def timing(case: Case) -> ContactTiming:
    """Begin and end of contacts in time."""
    if case.contact.timing is not None:
        return ContactTiming.of(case.contact.timing)
    sticky = adhesion(case.contact) is not Adhesion.NONE
    at_steps = is_hertz(case.contact) or has_clumps(case.grains) or sticky
    return ContactTiming.AT_STEPS if at_steps else ContactTiming.EXACT


def adhesion(contact: ContactSection) -> Adhesion:
    """Attraction of grains in touch."""
    return Adhesion.of(contact.adhesion)


def adhesion_amount(contact: ContactSection) -> float:
    """Pull-off force [N], work of adhesion [J/m2] or energy density [Pa]; 0 without adhesion."""
    (value,) = [getattr(contact, key) for key in adhesion(contact).takes] or (None,)
    return value or 0.0


def parting(contact: ContactSection) -> str:
    """Word of the case for the end of the normal force."""
    return contact.damping_law if is_hertz(contact) else contact.parting


def may_pull(contact: ContactSection) -> bool:
    """Whether the normal dashpot may pull before the overlap ends."""
    if is_hertz(contact):
        return DampingLaw.of(contact.damping_law) is DampingLaw.TSUJI
    return Parting.of(contact.parting) is Parting.TENSION


def friction(contact: ContactSection) -> float:
    """Friction coefficient mu = tan(phi) [-]."""
    if contact.friction_angle is not None:
        return math.tan(contact.friction_angle)
    return contact.friction if contact.friction is not None else math.nan


def friction_at_last(contact: ContactSection, timeline: Timeline) -> float:
    """Friction coefficient after the last change of the timeline [-]."""
    for change in reversed(timeline):
        if change.friction_angle is not None:
            return math.tan(change.friction_angle)
        if change.friction is not None:
            return change.friction
    return friction(contact)


def restitution(contact: ContactSection) -> tuple[float, float, float, float]:
    """Normal and tangential restitution given, and the damping ratios that reach them; nan with constants.

    The tangential damping ratio is that of a two-sided oscillator whatever contact.parting is.
    """
    if contact.restitution is None:
        return math.nan, math.nan, math.nan, math.nan
    e_n = contact.restitution
    e_s = contact.restitution_shear if contact.restitution_shear is not None else e_n
    tension = may_pull(contact)
    return (
        e_n,
        e_s,
        collision.zeta_for_restitution(e_n, tension),
        collision.zeta_tension(e_s),
    )


def stiffness(case: Case) -> tuple[float, float]:
    """Give k_n and k_s [N/m], as written or as they follow for a mean grain on a fixed one."""
    rule, contact = case.contact.stiffness, case.contact
    if is_hertz(case.contact):
        law = hertz_law(case)
        return law.k_n, law.k_s
    assert rule is not None
    m, m_added, _, _ = mass(case, sizes(case)[0])
    if isinstance(rule, OverlapStiffnessSection):
        zeta = restitution(case.contact)[2]
        zeta = 0.0 if math.isnan(zeta) else zeta
        k_n = collision.stiffness_for_overlap(rule.overlap * sizes(case)[0], rule.speed, m + m_added, zeta)
    elif isinstance(rule, TimeStiffnessSection):
        k_n = collision.stiffness_for_time(rule.collision_time, m + m_added, 0.0, False)
    else:
        k_n = rule
    if contact.shear_stiffness is not None:
        return k_n, contact.shear_stiffness
    return k_n, k_n * (SHEAR_RATIO if contact.shear_ratio is None else contact.shear_ratio)


def hertz_law(case: Case) -> ContactLaw:
    """Contact law of a case with elastic spheres; its k_n is that of a mean grain on a fixed one."""
    contact, d = case.contact, sizes(case)[0]
    m, m_added, _, _ = mass(case, d)
    e_n, e_s, _, _ = restitution(case.contact)
    slip = Slip.of(contact.slip)
    return elastic_spheres(
        m + m_added,
        0.25 * d,
        youngs_modulus=contact.youngs_modulus or math.nan,
        poisson_ratio=contact.poisson_ratio,
        speed=expected_speed(case)[0],
        friction=friction(case.contact),
        restitution=e_n,
        restitution_shear=e_s,
        damping_law=DampingLaw.of(contact.damping_law),
        unloading=Unloading.of(contact.unloading),
        slip=slip,
        cap=None if contact.cap is None else Cap.of(contact.cap),
        cohesion=contact.cohesion,
        adhesion=adhesion(case.contact),
        adhesion_amount=adhesion_amount(case.contact),
    )


def law_of(case: Case) -> ContactLaw:
    """Contact law of a case, as far as estimates need it: springs, damping and adhesion."""
    if is_hertz(case.contact):
        return hertz_law(case)
    (k_n, k_s), (e_n, e_s, zeta_n, zeta_s) = stiffness(case), restitution(case.contact)
    one = pair_values(case, sizes(case)[0], False)
    return ContactLaw(
        k_n=k_n,
        k_s=k_s,
        mu=friction(case.contact),
        cohesion=case.contact.cohesion,
        e_n=e_n,
        e_s=e_s,
        zeta_n=one.zeta_n if math.isnan(zeta_n) else zeta_n,
        zeta_s=one.zeta_s if math.isnan(zeta_s) else zeta_s,
        tension=may_pull(case.contact),
        timing=timing(case),
        adhesion=adhesion(case.contact),
        adhesion_amount=adhesion_amount(case.contact),
    )


def reduced_radius(d: float, free: bool) -> float:
    """Reduced radius [m] of two grains, or if they cannot meet of one on a wall: the shortest contact."""
    return 0.25 * d if free else 0.5 * d


def shortest_contact(case: Case, d: float, free: bool) -> float:
    """Shortest contact of the pair of `pair_values` [s]; of elastic spheres at the expected speed."""
    one = pair_values(case, d, free)
    if is_hertz(case.contact):
        return shortest_contact_of(hertz_law(case), one.m, reduced_radius(d, free))
    return collision.shortest_contact(one.m, stiffness(case)[0], one.zeta_n, may_pull(case.contact))


def largest_overlap(case: Case, speed: float) -> float:
    """Largest overlap of a mean grain that hits a fixed one [m], as it were without adhesion."""
    d = sizes(case)[0]
    one = pair_values(case, d, False)
    if is_hertz(case.contact):
        law = replace(hertz_law(case), adhesion=Adhesion.NONE)
        return largest_overlap_of(law, one.m, 0.25 * d, speed)
    return collision.overlap_max(speed, one.m, stiffness(case)[0], one.zeta_n)


def overlap_under(case: Case, load: float) -> float:
    """Overlap of a mean grain on a fixed one under a load [N] at rest, with adhesion [m]."""
    if adhesion(case.contact) is not Adhesion.NONE:
        return rest_overlap_of(law_of(case), 0.25 * sizes(case)[0], load)
    if is_hertz(case.contact):
        return hertz.hertz_overlap(load, hertz_stiffness_of(hertz_law(case), 0.25 * sizes(case)[0]))
    return load / stiffness(case)[0]


def step_limit(case: Case, d: float, free: bool) -> tuple[float, float]:
    """Largest stable step [s] of the normal and of the tangential motion of the pair of `pair_values`."""
    if is_hertz(case.contact):
        one = pair_values(case, d, free, may_rotate(case.motion, case.timeline))
        return step_limits_of(hertz_law(case), one.m, one.m_t, reduced_radius(d, free))
    (k_n, k_s), one = stiffness(case), pair_values(case, d, free, may_rotate(case.motion, case.timeline))
    normal = collision.step_limit(one.zeta_n, collision.omega_natural(k_n, one.m))
    if k_s > 0.0:
        return normal, collision.step_limit(one.zeta_s, collision.omega_natural(k_s, one.m_t))
    return normal, 2.0 * one.m_t / one.eta_s if one.eta_s > 0.0 else math.inf


def pair_values(case: Case, d: float, free: bool, rotates: bool | None = None) -> PairValues:
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
    _, _, zeta_n, zeta_s = restitution(case.contact)
    if is_hertz(case.contact):
        return _pair_values_hertz(case, 0.25 * d, m_eff, m_t)
    if math.isnan(zeta_n):
        eta_n, eta_s = contact.damping or 0.0, contact.shear_damping or 0.0
        zeta_n = collision.damping_ratio(eta_n, k_n, m_eff)
        zeta_s = collision.damping_ratio(eta_s, k_s, m_t) if k_s > 0.0 else math.inf * eta_s if eta_s else 0.0
    else:
        eta_n, eta_s = contact_law.damping(zeta_n, k_n, m_eff), contact_law.damping(zeta_s, k_s, m_t)
    omega = collision.omega_natural(k_n, m_eff)
    tension = may_pull(case.contact)
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


def _pair_values_hertz(case: Case, r: float, m: float, m_t: float) -> PairValues:
    """Values of two elastic spheres of a reduced radius r [m]: all in an impact at the expected speed.

    Dashpots and the tangential oscillation are those at the largest overlap.
    """
    law = hertz_law(case)
    stiff, v = hertz_stiffness_of(law, r), law.speed
    root = math.sqrt(hertz.overlap_max_hertz(v, m, stiff, law.zeta_n))
    k_shear = hertz.mindlin_ratio(law.poisson_ratio) * stiff
    return PairValues(
        m=m,
        m_t=m_t,
        zeta_n=law.zeta_n,
        zeta_s=law.zeta_s,
        eta_n=hertz.hertz_damping(law.zeta_n, stiff, m) * math.sqrt(root),
        eta_s=hertz.mindlin_damping(law.zeta_s, k_shear, m_t) * math.sqrt(root),
        e=law.e_n,
        e_s=law.e_s,
        t_undamped=hertz.contact_time_hertz(v, m, stiff, 0.0, True),
        t_col=hertz.contact_time_hertz(v, m, stiff, law.zeta_n, law.tension),
        t_shear=collision.collision_time(m_t, k_shear * root),
    )
