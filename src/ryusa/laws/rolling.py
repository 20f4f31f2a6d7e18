"""Rolling friction: Eq. (13) as printed, and the variants in common use.

All laws are scalar. For vectors an engine passes the magnitude of torque or spin to the law and multiplies
the direction by the result:

- printed: torque = -rolling_printed(f_n, f) * m_t / |m_t|, m_t the torque that drives the grain.
- printed-limited: the same with `rolling_limited` for its magnitude.
- constant: torque = -rolling_constant(cap, |w|, inertia, dt) * w / |w|, w the relative spin.
- spring-dashpot-slider: `epsd_spring` advances each component of the spring; all components are then
  multiplied by `slider_scale(|spring|, cap)`. A scale below 1 means sliding, and `epsd_torque` then omits the
  dashpot.
"""

import math

from ryusa.laws._law import law
from ryusa.laws.reduced import reduced


@law
def rolling_arm_width(r_i: float, r_j: float, overlap: float) -> float:
    """Contact width b of Eq. (13) [m]: diameter of the circle in which two spheres intersect.

    Parameters
    ----------
    r_i, r_j : radii [m]; inf for a plane.
    overlap : overlap [m]; the width is zero without overlap.

    Notes
    -----
    Source: the paper, Eq. (13), b = 2 sqrt(R**2 - (R - overlap/2)**2) for equal spheres. For unequal spheres
    the circle of intersection, with D the distance of the centres,
    (b/2)**2 = overlap (2 r_i - overlap) (2 r_j - overlap) (2 r_i + 2 r_j - overlap) / (2 D)**2;
    on a plane (b/2)**2 = overlap (2 r - overlap). Bitwise the same with i and j exchanged.

    Examples
    --------
    >>> round(rolling_arm_width(5.0, 5.0, 2.0), 6)  # 3-4-5: half distance 4, radius of the circle 3
    6.0
    >>> round(rolling_arm_width(5.0, math.inf, 1.0), 6)
    6.0
    """
    if overlap <= 0.0:
        return 0.0
    i_smaller = r_i < r_j
    small = r_i if i_smaller else r_j
    curvature = 1.0 / (r_j if i_smaller else r_i)
    bent = curvature * overlap
    apart = 1.0 + curvature * small - bent
    area = overlap * (2.0 * small - overlap) * (2.0 - bent) * (2.0 + 2.0 * curvature * small - bent)
    return math.sqrt(max(area, 0.0)) / apart


@law
def reduced_radius(r_i: float, r_j: float) -> float:
    """Reduced radius R* = r_i r_j/(r_i + r_j) [m]; R on a plane, whose radius is inf.

    Examples
    --------
    >>> reduced_radius(2.0, 2.0), reduced_radius(2.0, math.inf)
    (1.0, 2.0)
    """
    return reduced(r_i, r_j)


@law
def rolling_printed(f_n: float, f: float) -> float:
    """Magnitude of the rolling friction torque of Eq. (13), f N [N m]; its sign is -sign(M_t).

    Parameters
    ----------
    f_n : normal force [N]; an attractive force counts as zero.
    f : rolling arm [m], f' b or mu_r R*.

    Notes
    -----
    In the printed form a grain at rest oscillates without end, because the torque changes sign with the
    driving torque at full magnitude.

    Examples
    --------
    >>> rolling_printed(2.0, 0.25), rolling_printed(-1.0, 0.25)
    (0.5, 0.0)
    """
    return f * max(f_n, 0.0)


@law
def rolling_limited(cap: float, driving: float) -> float:
    """Magnitude of the rolling friction torque of Eq. (13), limited to the torque it opposes [N m].

    Parameters
    ----------
    cap : f N [N m], >= 0, from `rolling_printed`.
    driving : magnitude of M_t, the torque of the shear force [N m].

    Notes
    -----
    Eq. (13) with abs(M_f) <= abs(M_t): M_f can cancel the torque of the shear force, not reverse it. Where
    f N is larger the shear force turns the grain no more, and a grain that turns already goes on turning.

    Examples
    --------
    >>> rolling_limited(0.5, 2.0), rolling_limited(0.5, 0.25)
    (0.5, 0.25)
    """
    return min(driving, cap)


@law
def rolling_constant(cap: float, spin: float, inertia: float, dt: float) -> float:
    """Magnitude of a rolling friction torque that opposes the relative spin and cannot reverse it [N m].

    Parameters
    ----------
    cap : largest torque f N [N m], >= 0, from `rolling_printed`.
    spin : magnitude of the relative spin [rad/s].
    inertia : effective moment of inertia of the relative spin [kg m2], from `inertia_spin`.
    dt : time step [s].

    Notes
    -----
    Source: type A of Ai et al. 2011, limited to inertia spin/dt.

    Examples
    --------
    >>> rolling_constant(0.5, 10.0, 0.25, 0.5), rolling_constant(0.5, 0.1, 0.25, 0.5)
    (0.5, 0.05)
    """
    return min(inertia * abs(spin) / dt, cap)


@law
def inertia_spin(inertia_i: float, inertia_j: float) -> float:
    """Effective moment of inertia of the relative spin of two grains [kg m2]: 1/I = 1/I_i + 1/I_j.

    Parameters
    ----------
    inertia_i, inertia_j : moments of inertia [kg m2]; inf for a fixed grain.

    Examples
    --------
    >>> inertia_spin(2.0, 2.0), inertia_spin(2.0, math.inf)
    (1.0, 2.0)
    """
    return reduced(inertia_i, inertia_j)


@law
def inertia_rolling(
    m_i: float, r_i: float, inertia_i: float, m_j: float, r_j: float, inertia_j: float
) -> float:
    """Effective moment of inertia about the contact point [kg m2]: 1/I_r = sum of 1/(I + m R**2).

    Parameters
    ----------
    m_i, m_j : masses [kg].
    r_i, r_j : radii [m].
    inertia_i, inertia_j : moments of inertia [kg m2]. All three are inf for a fixed plane.

    Notes
    -----
    Source: Ai et al. 2011, for the rolling dashpot of type C.

    Examples
    --------
    >>> inertia_rolling(1.0, 1.0, 0.5, math.inf, math.inf, math.inf)
    1.5
    """
    return inertia_spin(inertia_i + m_i * r_i * r_i, inertia_j + m_j * r_j * r_j)


@law
def epsd_stiffness(k_n: float, f: float, factor: float) -> float:
    """Stiffness k_r = factor k_n f**2 [N m/rad] of the rolling spring, f = mu_r R* [m].

    Notes
    -----
    Source: Ai et al. 2011, type C (EPSD); the factor is 2.25 in 3D, as in LIGGGHTS.

    Examples
    --------
    >>> epsd_stiffness(16.0, 0.25, 2.25)
    2.25
    """
    return factor * k_n * (f * f)


@law
def epsd_damping(k_r: float, inertia: float, zeta: float) -> float:
    """Rolling dashpot 2 zeta sqrt(I_r k_r) [N m s]; I_r from `inertia_rolling` [kg m2].

    Examples
    --------
    >>> epsd_damping(4.0, 1.0, 0.3)
    1.2
    """
    return 2.0 * zeta * math.sqrt(inertia * k_r)


@law
def epsd_spring(spring: float, spin: float, k_r: float, dt: float) -> float:
    """One component of the torque of the rolling spring on grain i [N m] after a step, before the slider.

    Parameters
    ----------
    spring : its value one step before [N m].
    spin : the same component of the relative spin omega_i - omega_j [rad/s].
    k_r : rolling stiffness [N m/rad].
    dt : time step [s].

    Examples
    --------
    >>> epsd_spring(0.0, 2.0, 3.0, 0.5)
    -3.0
    """
    return spring - k_r * spin * dt


@law
def epsd_step(k_r: float, eta_r: float, inertia: float, partners: float) -> float:
    """Time step up to which the rolling springs of grains in a packing are stable [s].

    Parameters
    ----------
    k_r, eta_r : rolling spring [N m/rad] and dashpot [N m s] of a contact, > 0 and >= 0.
    inertia : moment of inertia of a grain [kg m2].
    partners : grains that it touches, each of which turns against it.

    Notes
    -----
    Derived. In the fastest motion all neighbours turn against each other, so that each contact turns twice as
    far as a grain: I domega/dt = -2 n (k_r angle + eta_r omega), with omega_0**2 = 2 n k_r/I and zeta =
    eta_r omega_0/(2 k_r). The scheme advances the spring with the spin half a step old and the dashpot too;
    its map has determinant 1 - 2 zeta h and trace 2 - 2 zeta h - h**2 with h = omega_0 dt, and no eigenvalue
    beyond 1 as long as h <= 2 (sqrt(1 + zeta**2) - zeta). With k_r and eta_r of type C (Ai et al. 2011) and
    equal spheres omega_0 grows with the coefficient mu_r, so that a step that is a tenth of a contact becomes
    too long for large ones.

    Examples
    --------
    >>> epsd_step(2.0, 0.0, 1.0, 1.0)  # omega_0 = 2
    1.0
    >>> epsd_step(2.0, 1.5, 1.0, 1.0)  # zeta = 0.75: half of it
    0.5
    """
    omega = math.sqrt(2.0 * partners * k_r / inertia)
    zeta = 0.5 * eta_r * omega / k_r
    return 2.0 * (math.sqrt(1.0 + zeta * zeta) - zeta) / omega


@law
def slider_scale(size: float, cap: float) -> float:
    """Factor <= 1 [-] that limits a spring of magnitude `size` to `cap` (both in the same unit).

    Examples
    --------
    >>> slider_scale(1.0, 2.0), slider_scale(4.0, 2.0)
    (1.0, 0.5)
    """
    if size <= cap:
        return 1.0
    return cap / size


@law
def epsd_torque(spring: float, spin: float, eta_r: float, scale: float) -> float:
    """One component of the rolling torque on grain i [N m]: spring plus dashpot; no dashpot while sliding.

    Parameters
    ----------
    spring : rolling spring after the cap [N m].
    spin : relative spin omega_i - omega_j [rad/s].
    eta_r : rolling dashpot [N m s].
    scale : result of `slider_scale` [-]; sliding if below 1.

    Examples
    --------
    >>> epsd_torque(-1.0, 2.0, 0.25, 1.0), epsd_torque(-1.0, 2.0, 0.25, 0.5)
    (-1.5, -1.0)
    """
    if scale < 1.0:
        return spring
    return spring - eta_r * spin


@law
def twisting_cap(f_n: float, coefficient: float, radius: float) -> float:
    """Largest torque about the normal that a contact transmits [N m].

    Parameters
    ----------
    f_n : normal force [N], >= 0.
    coefficient : torque over normal force and reduced radius [-].
    radius : reduced radius of the two grains [m].

    Notes
    -----
    By definition of the coefficient. What a contact disc can transmit is `torque_of_slipping_disc`.

    Examples
    --------
    >>> twisting_cap(2.0, 0.25, 0.5)
    0.25
    """
    return coefficient * radius * f_n


@law
def torque_of_slipping_disc(f_n: float, mu: float, a: float) -> float:
    """Torque of a contact disc that slips everywhere about its axis, under the pressure of Hertz [N m].

    Parameters
    ----------
    f_n : normal force [N].
    mu : friction coefficient [-].
    a : radius of the disc [m].

    Notes
    -----
    The integral of mu p r over the disc with p = 3 N/(2 pi a^2) sqrt(1 - r^2/a^2): 3 pi/16 mu a N.

    Examples
    --------
    >>> round(torque_of_slipping_disc(1.0, 1.0, 1.0), 6)
    0.589049
    """
    return 3.0 * math.pi / 16.0 * mu * a * f_n
