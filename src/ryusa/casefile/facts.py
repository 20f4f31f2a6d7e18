"""Frozen facts: what follows from a case."""

from dataclasses import dataclass


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


@dataclass(frozen=True)
class Derived:
    """Numbers that follow from a case, SI."""

    d: float  # mean diameter [m]
    d_min: float
    d_max: float
    room: float  # diameter of the sphere that holds any free grain, as clumps reach farther [m]
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
    fixed: PairValues  # mean grain on a fixed one
    free: PairValues  # two mean grains
    n_grain: int
    n_sphere: int  # free grains with the spheres of clumps counted one by one
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
