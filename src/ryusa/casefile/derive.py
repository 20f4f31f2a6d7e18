"""What follows from a case: masses, stiffness, damping, the time step, the friction velocity."""

import math
from dataclasses import asdict, dataclass
from typing import Any, Literal

from ryusa.casefile.column import CELL, ONLY_IN_A_COLUMN, Column
from ryusa.casefile.grains import counts, packed, sizes, water_over
from ryusa.casefile.schema import Case, StiffnessForOverlap, StiffnessForTime
from ryusa.laws import collision, drag, motion, water
from ryusa.laws import contact as contact_law

STEPS_PER_CONTACT = 50.0
MANY = 1000  # free grains beyond which contacts are recorded only when asked for
SHEAR_RATIO = 2.0 / 7.0


@dataclass(frozen=True)
class Pair:
    """One kind of contact, seen from a grain of the given mass."""

    m: float  # effective mass, added mass counted [kg]
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


@dataclass(frozen=True)
class Derived:
    """Numbers that follow from a case, SI."""

    d: float  # mean diameter [m]
    d_min: float
    d_max: float
    volume: float  # of the mean grain [m3]
    m: float  # its mass [kg]
    m_added: float  # its added mass [kg]
    m_weight: float  # the mass that gravity sees [kg]
    inertia: float  # [kg m2]
    g: float  # [m/s2]
    slope: float  # [rad]
    k_n: float  # [N/m]
    k_s: float
    mu: float  # [-]
    e_n: float  # restitution asked for [-]; nan for constants
    e_s: float
    fixed: Pair  # mean grain on a fixed one
    free: Pair  # two mean grains
    n_grain: int
    n_fixed: int
    meet: bool  # can two free grains meet
    shortest: float  # shortest contact that can occur [s]
    dt: float  # [s]
    step_limit: float  # largest stable step in one contact [s]
    step_limit_shear: float  # that of its tangential motion [s]
    steps_per_contact: float
    u_star: float  # [m/s]; nan without a log profile, and in a column that nothing drives
    tau_star: float
    k_rough: float  # [m]; nan without water


def mass(case: Case, d: float) -> tuple[float, float, float, float]:
    """Mass, added mass, mass that gravity sees [kg], moment of inertia [kg m2]; diameter d [m]."""
    volume = drag.volume(d, case.grains.shape_volume)
    m = case.grains.density * volume
    inertia = motion.inertia_sphere(m, d)
    if case.water is None:
        return m, 0.0, m, inertia
    rho_w = case.water.density
    return (
        m,
        drag.added_mass(rho_w, case.water.added_mass, volume),
        drag.submerged_mass(m, rho_w, volume),
        inertia,
    )


def may_spin(case: Case) -> bool:
    """Whether grains spin from the start or from some time on."""
    return case.motion.rotation == "free" or any(change.rotation == "free" for change in case.timeline)


def events_of(case: Case) -> Literal["all", "tracked", "none"]:
    """Which contacts are recorded."""
    if case.record.events is not None:
        return case.record.events
    return "all" if counts(case)[0] <= MANY or case.stop.saltations is not None else "none"


def slope(case: Case) -> float:
    """Bed slope [rad], down towards +x."""
    if case.motion.slope_angle is not None:
        return case.motion.slope_angle
    return math.atan(case.motion.slope or 0.0)


def slope_at_last(case: Case) -> float:
    """Bed slope after the last change of the timeline [rad], down towards +x."""
    for change in reversed(case.timeline):
        if change.slope is not None or change.slope_angle is not None:
            return change.slope_angle if change.slope_angle is not None else math.atan(change.slope or 0.0)
    return slope(case)


def u_star_asked(case: Case) -> float:
    """Friction velocity that water.tau_star or water.u_star asks for, at water.zero [m/s]; nan without."""
    wet = case.water
    if wet is None:
        return math.nan
    if wet.tau_star is not None:
        d, g = sizes(case)[0], case.motion.gravity
        return water.u_star_from_tau_star(wet.tau_star, case.grains.density, wet.density, g, d)
    return math.nan if wet.u_star is None else wet.u_star


def column_u_star(case: Case, k_rough: float) -> float:
    """Friction velocity of a column over its bed [m/s]: of its driver in steady flow; nan if nothing does.

    A discharge is that of Eq. (9), whose mean over the depth is the speed at depth/e. The driver TAU holds
    the stress asked for at the zero of the water: loose grains above it have water in their pores too.
    """
    wet = case.water
    assert wet is not None
    keys, depth = wet.column or Column(), water_over(case)
    if not depth > 0.0:
        return math.nan
    if keys.discharge is not None:
        unit = water.log_law_rough(depth / math.e, 1.0, k_rough)
        return abs(keys.discharge) / depth / unit if unit > 0.0 else math.nan
    along = case.motion.gravity * math.sin(slope_at_last(case))
    pull = along + (keys.pressure_gradient or 0.0) / wet.density
    if keys.drive == "tau_star" and wet.depth is not None:
        if depth == wet.depth:
            return u_star_asked(case)
        within = depth + max(wet.depth - depth, 0.0) * (1.0 - packed(case))
        pull += (u_star_asked(case) ** 2 - along * within) / wet.depth
    return math.sqrt(abs(pull) * depth) or math.nan


def friction(case: Case) -> float:
    """Friction coefficient mu = tan(phi) [-]."""
    contact = case.contact
    if contact.friction_angle is not None:
        return math.tan(contact.friction_angle)
    return contact.friction if contact.friction is not None else math.nan


def friction_at_last(case: Case) -> float:
    """Friction coefficient after the last change of the timeline [-]."""
    for change in reversed(case.timeline):
        if change.friction_angle is not None:
            return math.tan(change.friction_angle)
        if change.friction is not None:
            return change.friction
    return friction(case)


def restitution(case: Case) -> tuple[float, float, float, float]:
    """Restitution asked for, normal and tangential, and the damping ratios that give them; nan for constants.

    The tangential ratio is that of a two-sided oscillator whichever way contacts part.
    """
    contact = case.contact
    if contact.restitution is None:
        return math.nan, math.nan, math.nan, math.nan
    e_n = contact.restitution
    e_s = contact.restitution_shear if contact.restitution_shear is not None else e_n
    tension = contact.parting == "tension"
    return (
        e_n,
        e_s,
        collision.zeta_tension(e_n) if tension else collision.zeta_no_tension(e_n),
        collision.zeta_tension(e_s),
    )


def stiffness(case: Case) -> tuple[float, float]:
    """Give k_n and k_s [N/m], as written or as asked for by a mean grain on a fixed one."""
    rule, contact = case.contact.stiffness, case.contact
    m, m_added, _, _ = mass(case, sizes(case)[0])
    if isinstance(rule, StiffnessForOverlap):
        zeta = restitution(case)[2]
        zeta = 0.0 if math.isnan(zeta) else zeta
        k_n = collision.stiffness_for_overlap(rule.overlap * sizes(case)[0], rule.speed, m + m_added, zeta)
    elif isinstance(rule, StiffnessForTime):
        k_n = collision.stiffness_for_time(rule.collision_time, m + m_added, 0.0, False)
    else:
        k_n = rule
    if contact.shear_stiffness is not None:
        return k_n, contact.shear_stiffness
    return k_n, k_n * (SHEAR_RATIO if contact.shear_ratio is None else contact.shear_ratio)


def step_limit(case: Case, d: float, free: bool) -> tuple[float, float]:
    """Largest stable step [s] of the normal and of the tangential motion of one such pair."""
    (k_n, k_s), one = stiffness(case), pair(case, d, free, may_spin(case))
    normal = collision.step_limit(one.zeta_n, collision.omega_natural(k_n, one.m))
    if k_s > 0.0:
        return normal, collision.step_limit(one.zeta_s, collision.omega_natural(k_s, one.m_t))
    return normal, 2.0 * one.m_t / one.eta_s if one.eta_s > 0.0 else math.inf


def pair(case: Case, d: float, free: bool, spins: bool | None = None) -> Pair:
    """One grain of diameter d [m] on a fixed one, or two such grains; `spins` overrules motion.rotation."""
    contact = case.contact
    m, m_added, _, inertia = mass(case, d)
    heavy, r, still = m + m_added, d / 2.0, math.inf
    k_n, k_s = stiffness(case)
    spins = case.motion.rotation == "free" if spins is None else spins
    m_eff = collision.effective_mass(heavy, heavy if free else still)
    m_t = collision.effective_mass_tangential(
        heavy, r, inertia, heavy if free else still, r, inertia if free else still, spins
    )
    _, _, zeta_n, zeta_s = restitution(case)
    if math.isnan(zeta_n):
        eta_n, eta_s = contact.damping or 0.0, contact.shear_damping or 0.0
        zeta_n = collision.damping_ratio(eta_n, k_n, m_eff)
        zeta_s = collision.damping_ratio(eta_s, k_s, m_t) if k_s > 0.0 else math.inf * eta_s if eta_s else 0.0
    else:
        eta_n, eta_s = contact_law.damping(zeta_n, k_n, m_eff), contact_law.damping(zeta_s, k_s, m_t)
    omega = collision.omega_natural(k_n, m_eff)
    tension = contact.parting == "tension"
    time, rest = (
        (collision.contact_time_tension, collision.restitution_tension)
        if tension
        else (collision.contact_time_no_tension, collision.restitution_no_tension)
    )
    return Pair(
        m=m_eff,
        m_t=m_t,
        zeta_n=zeta_n,
        zeta_s=zeta_s,
        eta_n=eta_n,
        eta_s=eta_s,
        e=rest(zeta_n),
        e_s=collision.restitution_tension(zeta_s),
        t_undamped=collision.collision_time(m_eff, k_n),
        t_col=time(zeta_n, omega),
        t_shear=math.inf if k_s == 0.0 else collision.collision_time(m_t, k_s),
    )


def derive(case: Case) -> Derived:
    """Everything that follows from a case."""
    d, d_min, d_max = sizes(case)
    m, m_added, m_weight, inertia = mass(case, d)
    k_n, k_s = stiffness(case)
    e_n, e_s, _, _ = restitution(case)
    n_grain, n_fixed, meet = counts(case)
    lightest, limits = pair(case, d_min, meet), step_limit(case, d_min, meet)
    tension = case.contact.parting == "tension"
    shortest = collision.shortest_contact(lightest.m, k_n, lightest.zeta_n, tension)
    if case.time.step is not None:
        dt = case.time.step
    else:
        dt = shortest / (case.time.steps_per_contact or STEPS_PER_CONTACT)
    u_star, tau_star, k_rough, g = math.nan, math.nan, math.nan, case.motion.gravity
    if case.water is not None:
        wet, rho_s = case.water, case.grains.density
        k_rough = wet.roughness if wet.roughness is not None else d
        driven = wet.profile == "column" and (wet.column or Column()).drive == "tau_star"
        u_star = u_star_asked(case)
        if wet.tau_star is not None and not driven:
            tau_star = wet.tau_star
        elif wet.profile == "column" or wet.u_star is not None:
            u_star = column_u_star(case, k_rough) if math.isnan(u_star) or driven else u_star
            heavier = rho_s > wet.density and g > 0.0
            tau_star = water.tau_star_from_u_star(u_star, rho_s, wet.density, g, d) if heavier else math.nan
    return Derived(
        d=d,
        d_min=d_min,
        d_max=d_max,
        volume=drag.volume(d, case.grains.shape_volume),
        m=m,
        m_added=m_added,
        m_weight=m_weight,
        inertia=inertia,
        g=g,
        slope=slope(case),
        k_n=k_n,
        k_s=k_s,
        mu=friction(case),
        e_n=e_n,
        e_s=e_s,
        fixed=pair(case, d, False),
        free=pair(case, d, True),
        n_grain=n_grain,
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


def resolved(case: Case) -> dict[str, Any]:
    """Give the case as plain data in SI with what follows filled in; numbers that do not exist are None."""
    data: dict[str, Any] = case.model_dump(mode="json", by_alias=True)
    found = case.derived
    data["contact"] |= {
        "stiffness": found.k_n,
        "shear_stiffness": found.k_s,
        "shear_ratio": found.k_s / found.k_n,
    }
    data["contact"] |= {"friction": found.mu, "friction_angle": math.atan(found.mu)}
    if not math.isnan(found.e_n):
        data["contact"] |= {"restitution": found.e_n, "restitution_shear": found.e_s}
    data["motion"] |= {"slope": math.tan(found.slope), "slope_angle": found.slope}
    data["motion"]["slab_width"] = case.motion.slab_width or found.d
    data["record"]["events"] = events_of(case)
    data["time"] |= {"step": found.dt, "steps_per_contact": found.steps_per_contact}
    if case.water is not None:
        data["water"] |= {"u_star": found.u_star, "tau_star": found.tau_star, "roughness": found.k_rough}
        _resolve_column(case, data["water"])
    data["derived"] = asdict(found)
    return _plain(data)


def _resolve_column(case: Case, data: dict[str, Any]) -> None:
    """Fill in the column of water; where there is none, its keys say nothing."""
    wet = case.water
    assert wet is not None
    if wet.profile == "column":
        keys = wet.column or Column()
        cell = keys.cell or CELL * case.grains.diameter
        data["column"] = keys.model_dump(mode="json") | {"cell": cell, "mixing_length": keys.mixing}
        data["column"]["packed"] = packed(case)
        return
    for key in ONLY_IN_A_COLUMN:
        del data[key]


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
