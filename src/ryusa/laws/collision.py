"""Two grains joined by a linear spring and dashpot: Eq. (8), contact time, restitution, largest overlap.

omega_0 = sqrt(k_n/m) [rad/s] and zeta = eta_n/(2 sqrt(k_n m)) [-], where m is the effective mass of the pair:
a fixed partner has infinite mass, and added mass is included. *Tension*: the dashpot may pull until the
overlap ends. *No tension*: the force ends when it would become attractive.
"""

import math

from ryusa.laws._law import law
from ryusa.laws.reduced import reduced


@law
def collision_time(m: float, k_n: float) -> float:
    """Duration of a contact without damping [s], pi sqrt(m/k_n). Eq. (8); m [kg], k_n [N/m].

    Examples
    --------
    >>> round(collision_time(1.11e-5, 1.0), 4)  # d = 0.2 cm quartz, k_n = 0.01 N/cm
    0.0105
    """
    return math.pi * math.sqrt(m / k_n)


@law
def effective_mass(m_i: float, m_j: float) -> float:
    """Effective mass of a pair in the normal direction [kg]: 1/m = 1/m_i + 1/m_j; inf for a fixed partner.

    Parameters
    ----------
    m_i, m_j : masses that resist acceleration [kg], added mass included; not both inf.

    Examples
    --------
    >>> effective_mass(2.0, 2.0), effective_mass(2.0, math.inf)
    (1.0, 2.0)
    """
    return reduced(m_i, m_j)


@law
def effective_mass_tangential(
    m_i: float, r_i: float, inertia_i: float, m_j: float, r_j: float, inertia_j: float, rotates: bool
) -> float:
    """Effective mass of a pair in the tangential direction [kg]: 1/m_t = sum of 1/m + R**2/I.

    Parameters
    ----------
    m_i, m_j : masses [kg], added mass included; inf for a fixed partner.
    r_i, r_j : radii [m]; inf for a plane.
    inertia_i, inertia_j : moments of inertia [kg m2], without added mass; inf for a fixed partner.
    rotates : False if rotation is locked; R**2/I is then omitted.

    Notes
    -----
    Source: derived; the paper does not state it. For equal dry spheres it is 2/7 of the normal one.

    Examples
    --------
    >>> round(effective_mass_tangential(7.0, 1.0, 2.8, math.inf, math.inf, math.inf, True), 12)
    2.0
    >>> round(effective_mass_tangential(7.0, 1.0, 2.8, math.inf, math.inf, math.inf, False), 12)
    7.0
    """
    inverse = 1.0 / m_i + 1.0 / m_j
    if rotates:
        if inertia_i != math.inf:
            inverse += r_i * r_i / inertia_i
        if inertia_j != math.inf:
            inverse += r_j * r_j / inertia_j
    return 1.0 / inverse


@law
def omega_natural(k_n: float, m: float) -> float:
    """Undamped angular frequency of a contact sqrt(k_n/m) [rad/s]; k_n [N/m], m effective mass [kg].

    Examples
    --------
    >>> omega_natural(4.0, 1.0)
    2.0
    """
    return math.sqrt(k_n / m)


@law
def damping_ratio(eta: float, k: float, m: float) -> float:
    """Damping ratio zeta = eta/(2 sqrt(k m)) [-]; inverse of `contact.damping`.

    Examples
    --------
    >>> damping_ratio(2.0, 4.0, 1.0)
    0.5
    """
    return eta / (2.0 * math.sqrt(k * m))


@law
def phase_to_largest(zeta: float) -> float:
    """Phase omega_0 t [-] from first touch to the largest overlap.

    Notes
    -----
    Source: damped oscillator; acos(zeta)/sqrt(1 - zeta**2), 1 at zeta = 1, and acosh(zeta)/sqrt(zeta**2 - 1)
    above. Without tension the force ends at exactly twice this phase.

    Examples
    --------
    >>> round(phase_to_largest(0.0), 6), phase_to_largest(1.0)
    (1.570796, 1.0)
    """
    if zeta == 1.0:
        return 1.0
    if zeta < 1.0:
        s = math.sqrt((1.0 - zeta) * (1.0 + zeta))
        return math.atan2(s, zeta) / s
    s = math.sqrt((zeta - 1.0) * (zeta + 1.0))
    return math.asinh(s) / s


@law
def contact_time_tension(zeta: float, omega_0: float) -> float:
    """Contact time [s] when the dashpot may pull, pi/(omega_0 sqrt(1 - zeta**2)); inf for zeta >= 1.

    Examples
    --------
    >>> round(contact_time_tension(0.0, 2.0), 6)
    1.570796
    """
    if zeta >= 1.0:
        return math.inf
    return math.pi / (omega_0 * math.sqrt((1.0 - zeta) * (1.0 + zeta)))


@law
def contact_time_no_tension(zeta: float, omega_0: float) -> float:
    """Time until the normal force ends [s] when it may not pull.

    Notes
    -----
    Source: Schwager & Poeschel 2007, Eq. (21): omega_0 T = atan2(2 zeta w, 2 zeta**2 - 1)/w with
    w = sqrt(1 - zeta**2); 2 at zeta = 1; 2 ln(zeta + s)/s with s = sqrt(zeta**2 - 1) above. All three
    expressions are twice `phase_to_largest`.

    Examples
    --------
    >>> round(contact_time_no_tension(0.12221, 1.0), 4)  # e = 0.7
    2.9184
    """
    return 2.0 * phase_to_largest(zeta) / omega_0


@law
def contact_time(zeta: float, omega_0: float, tension: bool) -> float:
    """Contact time [s] of a damped contact.

    Parameters
    ----------
    zeta : damping ratio [-].
    omega_0 : undamped angular frequency [rad/s].
    tension : whether the dashpot may pull.

    Examples
    --------
    >>> contact_time(0.5, 1.0, True) == contact_time_tension(0.5, 1.0)
    True
    """
    return contact_time_tension(zeta, omega_0) if tension else contact_time_no_tension(zeta, omega_0)


@law
def shortest_contact(m: float, k_n: float, zeta: float, tension: bool) -> float:
    """Shortest contact that a pair can have [s], damped or undamped; the time step is a fraction of it.

    Parameters
    ----------
    m : effective mass of the lightest possible pair [kg].
    k_n : normal stiffness [N/m].
    zeta : damping ratio [-].
    tension : whether the dashpot may pull.

    Notes
    -----
    Source: the smaller of Eq. (8) and the damped contact time. Damping shortens a contact without tension and
    lengthens one with tension.

    Examples
    --------
    >>> t_col = collision_time(1.0, 1.0)
    >>> shortest_contact(1.0, 1.0, 0.12221, True) == t_col
    True
    >>> round(shortest_contact(1.0, 1.0, 0.12221, False) / t_col, 3)  # e = 0.7
    0.929
    """
    return min(contact_time(zeta, omega_natural(k_n, m), tension), collision_time(m, k_n))


@law
def restitution_tension(zeta: float) -> float:
    """Restitution e = exp(-pi zeta/sqrt(1 - zeta**2)) [-] when the dashpot may pull; 0 for zeta >= 1.

    Examples
    --------
    >>> round(restitution_tension(0.11281), 4)
    0.7
    """
    if zeta >= 1.0:
        return 0.0
    return math.exp(-math.pi * zeta / math.sqrt((1.0 - zeta) * (1.0 + zeta)))


@law
def restitution_no_tension(zeta: float) -> float:
    """Restitution e = exp(-zeta omega_0 T) [-] when the force may not pull; 1/(4 zeta**2) for heavy damping.

    Notes
    -----
    Source: Schwager & Poeschel 2007, Eq. (21), T from `contact_time_no_tension`.

    Examples
    --------
    >>> round(restitution_no_tension(0.12221), 4)
    0.7
    """
    return math.exp(-2.0 * zeta * phase_to_largest(zeta))


@law
def restitution_for_zeta(zeta: float, tension: bool) -> float:
    """Restitution [-] for a damping ratio zeta [-]; `tension`: whether the dashpot may pull.

    Examples
    --------
    >>> restitution_for_zeta(0.2, False) == restitution_no_tension(0.2)
    True
    """
    return restitution_tension(zeta) if tension else restitution_no_tension(zeta)


@law
def zeta_tension(e: float) -> float:
    """Damping ratio [-] that gives restitution e when the dashpot may pull; nan outside 0 < e <= 1.

    Examples
    --------
    >>> round(zeta_tension(0.7), 5)
    0.11281
    """
    if not 0.0 < e <= 1.0:
        return math.nan
    loss = abs(math.log(e))
    return loss / math.sqrt(math.pi * math.pi + loss * loss)


@law
def zeta_no_tension(e: float) -> float:
    """Damping ratio [-] that gives restitution e when the force may not pull; nan outside 0 < e <= 1.

    Notes
    -----
    Inverse of `restitution_no_tension`: Newton's method on 2 zeta phase_to_largest(zeta) = -ln e within the
    bracket [0, 1/sqrt(e)], with a bisection where a step would leave the bracket.

    Examples
    --------
    >>> round(zeta_no_tension(0.7), 5), zeta_no_tension(1.0)
    (0.12221, 0.0)
    """
    if not 0.0 < e <= 1.0:
        return math.nan
    loss = abs(math.log(e))
    low, high = 0.0, 1.0 / math.sqrt(e)
    zeta = min(loss / math.pi, high)
    for _ in range(100):
        phase = phase_to_largest(zeta)
        error = 2.0 * zeta * phase - loss
        if error > 0.0:
            high = zeta
        else:
            low = zeta
        gap = (1.0 - zeta) * (1.0 + zeta)
        slope = 4.0 / 3.0 if abs(gap) < 1.0e-5 else 2.0 * (phase + zeta * (zeta * phase - 1.0) / gap)
        trial = zeta - error / slope
        if not low <= trial <= high:
            trial = 0.5 * (low + high)
        if abs(trial - zeta) <= 1.0e-15 * zeta:
            return trial
        zeta = trial
    return zeta


@law
def zeta_for_restitution(e: float, tension: bool) -> float:
    """Damping ratio [-] that gives a restitution e [-]; `tension`: whether the dashpot may pull.

    Examples
    --------
    >>> zeta_for_restitution(0.7, False) == zeta_no_tension(0.7)
    True
    """
    return zeta_tension(e) if tension else zeta_no_tension(e)


@law
def overlap_max(speed: float, m: float, k_n: float, zeta: float) -> float:
    """Largest overlap of a damped impact [m], with or without tension.

    Parameters
    ----------
    speed : closing speed at first touch [m/s].
    m : effective mass [kg].
    k_n : normal stiffness [N/m].
    zeta : damping ratio [-].

    Notes
    -----
    Source: damped oscillator, (speed/omega_0) exp(-zeta phase_to_largest(zeta)).

    Examples
    --------
    >>> overlap_max(1.0, 4.0, 1.0, 0.0)
    2.0
    """
    return speed * math.sqrt(m / k_n) * math.exp(-zeta * phase_to_largest(zeta))


@law
def stiffness_for_overlap(overlap: float, speed: float, m: float, zeta: float) -> float:
    """Stiffness [N/m] that gives the largest overlap `overlap`; inverse of `overlap_max`.

    Parameters
    ----------
    overlap : largest overlap wanted [m].
    speed : closing speed at first touch [m/s].
    m : effective mass [kg].
    zeta : damping ratio [-].

    Examples
    --------
    >>> stiffness_for_overlap(2.0, 1.0, 4.0, 0.0)
    1.0
    """
    ratio = speed / overlap * math.exp(-zeta * phase_to_largest(zeta))
    return m * ratio * ratio


@law
def stiffness_for_time(t_col: float, m: float, zeta: float, tension: bool) -> float:
    """Stiffness [N/m] that gives the contact time `t_col`; inverse of `contact_time`.

    Parameters
    ----------
    t_col : contact time wanted [s].
    m : effective mass [kg].
    zeta : damping ratio [-].
    tension : whether the dashpot may pull.

    Notes
    -----
    With zeta = 0 the inverse of Eq. (8). With tension and zeta >= 1 no stiffness gives it (inf).

    Examples
    --------
    >>> round(stiffness_for_time(collision_time(1.11e-5, 1.0), 1.11e-5, 0.0, False), 12)
    1.0
    """
    phase = contact_time(zeta, 1.0, tension)
    return m * (phase / t_col) * (phase / t_col)


@law
def step_limit(zeta: float, omega_0: float) -> float:
    """Largest stable time step [s] of the semi-implicit scheme in one linear contact.

    Parameters
    ----------
    zeta : damping ratio [-].
    omega_0 : natural frequency of the contact [rad/s].

    Notes
    -----
    Source: omega_0 dt <= 2 (sqrt(1 + zeta**2) - zeta). Grains with several contacts need a smaller step.

    Examples
    --------
    >>> step_limit(0.0, 2.0)
    1.0
    """
    return 2.0 * (math.sqrt(1.0 + zeta * zeta) - zeta) / omega_0
