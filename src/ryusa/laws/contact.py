"""Normal and tangential contact forces, Eqs. (1)-(4), and the variants of sliding."""

import math

from ryusa.laws._law import law


@law
def normal_force(overlap: float, closing: float, k_n: float, eta_n: float) -> float:
    """Normal force of a linear spring and dashpot that may pull until the overlap ends [N].

    Parameters
    ----------
    overlap : overlap of the two grains [m], Eq. (12); positive in touch.
    closing : speed at which the two surfaces approach along the normal [m/s]; positive when approaching.
    k_n, eta_n : normal stiffness [N/m] and dashpot [N s/m], both >= 0.

    Returns
    -------
    f_n : normal force [N]; positive pushes apart.

    Notes
    -----
    Source: the paper, Eq. (1), with the overlap as displacement. Valid while the grains touch.

    >>> round(normal_force(1.0e-5, 0.1, 1.0e4, 0.1), 12)
    0.11
    """
    return k_n * overlap + eta_n * closing


@law
def normal_force_no_tension(overlap: float, closing: float, k_n: float, eta_n: float) -> float:
    """Normal force of a linear spring and dashpot that never pulls [N].

    Parameters
    ----------
    overlap, closing, k_n, eta_n : as in `normal_force`.

    Notes
    -----
    Source: the paper, Eq. (1), limited to f_n >= 0 as in Schwager & Poeschel 2007, Granular Matter 9, 465.

    >>> normal_force_no_tension(1.0e-5, -10.0, 1.0e4, 0.1)
    0.0
    """
    return max(k_n * overlap + eta_n * closing, 0.0)


@law
def shear_strength(push: float, cohesion: float, mu: float) -> float:
    """Largest tangential force of a contact before it slides [N]. Eq. (4), tau_c.

    Parameters
    ----------
    push : normal force in Eq. (4) [N]: the spring e_n as printed, or the whole f_n.
    cohesion : grain-level cohesion c [N].
    mu : tan(friction angle) [-].

    >>> round(shear_strength(0.1, 0.0, 0.5), 12)
    0.05
    """
    return max(cohesion + mu * push, 0.0)


@law
def slip_spring(spring_s: float, spring_n: float, cohesion: float, mu: float) -> float:
    """Tangential spring limited to tau_c, with its sign [N]. Eqs. (3)-(4) along one tangent.

    Parameters
    ----------
    spring_s : tangential spring force before the cap [N].
    spring_n : normal spring force e_n [N].
    cohesion : grain-level cohesion c [N].
    mu : tan(friction angle) [-].

    >>> slip_spring(-3.0, 1.0, 0.0, 0.5)
    -0.5
    """
    tau_c = shear_strength(spring_n, cohesion, mu)
    return math.copysign(tau_c, spring_s) if abs(spring_s) >= tau_c else spring_s


@law
def slip_scale(size: float, tau_c: float) -> float:
    """Factor that shortens a tangential vector of length `size` to tau_c [-]; 1 without sliding. Eq. (3).

    Parameters
    ----------
    size : length of the tangential force before the cap [N].
    tau_c : shear strength [N].

    >>> slip_scale(2.0, 1.0), slip_scale(0.5, 1.0), slip_scale(0.0, 0.0)
    (0.5, 1.0, 1.0)
    """
    return tau_c / size if size > tau_c else 1.0


@law
def slide(size: float, tau_c: float, drop: bool, total: bool) -> tuple[float, float, float]:
    """Cap the tangential force in one of three variants.

    Parameters
    ----------
    size : length of the force before the cap [N]: of the spring, abs(e), or with `total` of the sum of spring
        and dashpot, abs(e + d).
    tau_c : shear strength [N].
    drop : the dashpot is set to zero while sliding.
    total : spring and dashpot are capped together, as in LAMMPS: the dashpot keeps its value, and the spring
        is adjusted so that the sum has length tau_c. With neither, the spring is capped and the dashpot
        kept: Eq. (3) as printed.

    Returns
    -------
    a, b, c : e becomes a e + b d and d becomes c d, where e is the spring force and d the dashpot force:
        vectors in 3D, components along the only tangent in a plane scene; a < 1 means sliding [-].

    >>> slide(2.0, 1.0, False, False), slide(2.0, 1.0, True, False), slide(2.0, 1.0, False, True)
    ((0.5, 0.0, 1.0), (0.5, 0.0, 0.0), (0.5, -0.5, 1.0))
    """
    scale = slip_scale(size, tau_c)
    return scale, scale - 1.0 if total else 0.0, 0.0 if drop and scale < 1.0 else 1.0


@law
def damping(zeta: float, k: float, m_eff: float) -> float:
    """Dashpot of a linear oscillator [N s/m]: eta = 2 zeta sqrt(k m_eff).

    Parameters
    ----------
    zeta : damping ratio [-].
    k : stiffness [N/m].
    m_eff : effective mass of the pair [kg], added mass included; a fixed grain has infinite mass.

    >>> round(damping(0.1, 1.0e4, 1.0e-5), 9)
    0.063245553
    """
    return 2.0 * zeta * math.sqrt(k * m_eff)


@law
def damping_in_steps(eta: float, m_eff: float, dt: float) -> float:
    """Dashpot that damps like `eta` although it acts on the velocity of half a step before [N s/m].

    Parameters
    ----------
    eta : dashpot wanted in the limit of small steps [N s/m].
    m_eff : effective mass of the pair [kg].
    dt : time step [s].

    Notes
    -----
    Source: derived. In the semi-implicit scheme the dashpot acts on v(t - dt/2) = v + (k x + eta v) dt/(2 m),
    which increases both stiffness and dashpot by the factor 1 + eps/2, eps = eta dt/m, and the damping ratio
    by its square root. The factor y solves y**2 (1 + eps y/2) = 1 to second order. At 50 steps per contact
    and e = 0.3 it reduces the mean error of restitution from 3e-3 to below 1e-3; it tends to 1 for small
    steps.

    >>> damping_in_steps(0.1, 1.0e-5, 0.0)
    0.1
    """
    eps = eta * dt / m_eff
    return eta * (1.0 - eps * (0.25 - 0.15625 * eps))
