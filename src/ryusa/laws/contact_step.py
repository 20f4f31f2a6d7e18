"""One contact, one time step: kinematics of a pair, forces between the grains, and the work of the forces.

Every engine calls these functions: it gathers the numbers of a pair and scatters the results. Work is
accounted by velocity interval. Over the interval from x(n-1) to x(n), with the velocity v(n-1/2), the work of
a force is v dt (f(n-1) + f(n))/2, which is exact for the scheme with the kinetic energy
m v(n-1/2).v(n+1/2)/2. Vectors have components along x, y and z. A plane scene has one tangential component,
along (n_z, 0, -n_x), stored as the first of the three: it needs no rotation of the contact frame and no
square root for the length.
"""

import math

from ryusa.laws._law import step_law
from ryusa.laws.contact import shear_strength, slide
from ryusa.laws.geometry import arm, turn
from ryusa.laws.geometry import overlap as overlap_of


@step_law
def contact_kinematics(
    plane: bool, d_x: float, d_y: float, d_z: float, reach: float, r_i: float, u_x: float, u_y: float,
    u_z: float, w_ix: float, w_iy: float, w_iz: float, w_jx: float, w_jy: float, w_jz: float, dt: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """Kinematics of the contact of grains i and j.

    Parameters
    ----------
    plane : the grains move in the x-z plane; y components, and spins other than that about y, are not used.
    d_x, d_y, d_z : vector from the centre of i to the nearest periodic image of the centre of j [m].
    reach : sum of the two radii [m].
    r_i : radius of i [m].
    u_x, u_y, u_z : velocity of i minus that of j [m/s].
    w_ix, w_iy, w_iz, w_jx, w_jy, w_jz : spins [rad/s].
    dt : time step [s].

    Returns
    -------
    n_x, n_y, n_z : unit normal from i to j [-].
    overlap : positive in touch [m].
    a_i, a_j : arms from the centres to the contact point [m].
    closing : speed at which the surfaces approach [m/s].
    s_x, s_y, s_z : slip velocity of i relative to j at the contact point [m/s].
    twist : angle by which the pair turned about its normal during the step [rad].

    Notes
    -----
    Source: the paper, Eqs. (2) and (12), with unit normals instead of angles, and with arms to the middle of
    the overlap (`geometry.arm`). Two equal spheres that roll on each other have no slip:

    >>> spins = 0.0, 3.0, 0.0, 0.0, -3.0, 0.0
    >>> met = contact_kinematics(True, 1.5, 0.0, 0.0, 2.0, 1.0, 0.5, 0.0, 0.0, *spins, 0.1)
    >>> met[:6], met[6], met[7]
    ((1.0, 0.0, 0.0, 0.5, 0.75, 0.75), 0.5, 0.0)
    """
    n_y = s_y = s_z = twist = 0.0
    square = d_x * d_x + d_z * d_z
    if not plane:
        square += d_y * d_y
    distance = math.sqrt(square)
    inverse = 1.0 / distance
    n_x, n_z = d_x * inverse, d_z * inverse
    overlap = overlap_of(reach, 0.0, distance)
    a_i = arm(r_i, overlap)
    a_j = distance - a_i
    closing = u_x * n_x + u_z * n_z
    if plane:
        s_x = u_x * n_z - u_z * n_x
        s_x += a_i * w_iy + a_j * w_jy
    else:
        n_y = d_y * inverse
        closing += u_y * n_y
        s_x, s_y, s_z = u_x - closing * n_x, u_y - closing * n_y, u_z - closing * n_z
        g_x, g_y, g_z = a_i * w_ix + a_j * w_jx, a_i * w_iy + a_j * w_jy, a_i * w_iz + a_j * w_jz
        s_x += g_y * n_z - g_z * n_y
        s_y += g_z * n_x - g_x * n_z
        s_z += g_x * n_y - g_y * n_x
        twist = 0.5 * dt * ((w_ix + w_jx) * n_x + (w_iy + w_jy) * n_y + (w_iz + w_jz) * n_z)
    return n_x, n_y, n_z, overlap, a_i, a_j, closing, s_x, s_y, s_z, twist


@step_law
def normal_step(
    overlap: float, closing: float, raw: float, was_touching: bool, least: float, k_n: float, hdt: float
) -> tuple[float, float, float, float, float, float, float]:
    """Normal force at a step, and its work over the half interval before it.

    Parameters
    ----------
    overlap, closing : as `contact_kinematics` gives them [m], [m/s].
    raw : normal force before the limit is applied (`contact.normal_force`) [N].
    was_touching : whether the pair touched at the previous step.
    least : smallest normal force that a contact may have [N]: 0, or -inf if the dashpot may pull.
    k_n : normal stiffness [N/m].
    hdt : half the time step [s]; 0 in the first step of a run.

    Returns
    -------
    f_n : normal force [N]; positive pushes apart.
    e_n : force of the spring alone [N].
    held, touching : 1 if the contact exerts a force, and if the grains touch; else 0 [-].
    dashpot, released : energy dissipated by the dashpot, and lost because the force was limited [J].
    step : energy added because the contact began between two steps [J].

    Notes
    -----
    Source: the paper, Eq. (1), with the overlap as displacement. A spring whose contact begins between two
    steps holds k_n overlap**2/2, while the work of the half interval is e_n closing hdt: `step` is the
    difference.

    >>> [round(x, 9) for x in normal_step(1.0e-5, 0.1, 0.11, True, 0.0, 1.0e4, 1.0e-6)]
    [0.11, 0.1, 1.0, 1.0, 1e-09, 0.0, 0.0]
    """
    touching = overlap > 0.0
    e_n = k_n * overlap if touching else 0.0
    f_n = max(raw, least) if touching else 0.0
    held = touching and f_n > least
    work = hdt * closing * (f_n - e_n)
    begins = touching and (not was_touching) and hdt > 0.0
    step = -0.5 * e_n * (2.0 * hdt * closing - overlap) if begins else 0.0
    dashpot, released = work if held else 0.0, 0.0 if held else work
    return f_n, e_n, 1.0 if held else 0.0, 1.0 if touching else 0.0, dashpot, released, step


@step_law
def normal_work_of_last_force(
    closing: float, f_old: float, d_old: float, ends: bool, least: float, soft_n: float, hdt: float
) -> tuple[float, float, float]:
    """Work of the normal force of the previous step over the half interval after it [J].

    Parameters
    ----------
    closing : present closing speed, which is that of the interval [m/s].
    f_old : normal force at the previous step [N].
    d_old : that force without its spring [N].
    ends : whether the pair touched at the previous step and no longer touches.
    least : as in `normal_step` [N].
    soft_n : inverse of the normal stiffness [m/N]; 0 without a spring.
    hdt : half the time step [s].

    Returns
    -------
    dashpot, released : energy dissipated by the dashpot, and lost because the force was limited [J].
    step : energy added because the contact ended between two steps [J].

    >>> [round(x, 12) for x in normal_work_of_last_force(-0.1, 0.11, 0.01, False, 0.0, 1.0e-4, 1.0e-6)]
    [-1e-09, 0.0, 0.0]
    """
    work, e_old, held = hdt * closing * d_old, f_old - d_old, f_old > least
    step = 0.5 * e_old * (-2.0 * hdt * closing - e_old * soft_n) if ends else 0.0
    return work if held else 0.0, 0.0 if held else work, step


@step_law
def tangential_step(
    plane: bool, total: bool, drop: bool, cap_total: bool, n_x: float, n_y: float, n_z: float, twist: float,
    f_n: float, e_n: float, held: float, s_x: float, s_y: float, s_z: float, p_x: float, p_y: float,
    p_z: float, q_x: float, q_y: float, q_z: float, k_s: float, soft_s: float, eta_s: float, cohesion: float,
    mu: float, dt: float, hdt: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """Tangential spring and dashpot force on grain i after a step, and the work of the whole interval.

    Parameters
    ----------
    plane : as in `contact_kinematics`.
    total, drop : variant of sliding, as in `contact.slide`.
    cap_total : the whole normal force enters Eq. (4); else only its spring, as printed.
    n_x, n_y, n_z, twist, s_x, s_y, s_z : as `contact_kinematics` gives them [-], [rad], [m/s].
    f_n, e_n, held : as `normal_step` gives them [N], [N], [-].
    p_x, p_y, p_z : spring force on i at the previous step [N].
    q_x, q_y, q_z : dashpot force on i at the previous step [N].
    k_s, eta_s : tangential stiffness [N/m] and dashpot [N s/m].
    soft_s : inverse of the stiffness [m/N]; 0 without a spring.
    cohesion, mu : of the shear strength, as in `contact.shear_strength` [N], [-].
    dt, hdt : time step and half of it [s]; `hdt` is 0 in the first step of a run.

    Returns
    -------
    e_x, e_y, e_z : spring force on i [N].
    b_x, b_y, b_z : dashpot force on i [N].
    share : fraction of the spring force that remains after the cap [-]; less than 1 if the contact slides.
    dashpot, sliding, released : energy dissipated by the dashpot, dissipated by sliding, and lost because the
        contact exerts no force [J].

    Notes
    -----
    Source: the paper, Eqs. (2)-(4). In plane motion components y and z are returned unchanged. Sliding
    dissipates the work of the interval on the spring minus the increase of the spring's energy; with `total`
    that on the dashpot, too, which the spring then holds against, so that the sum is that of friction.

    >>> flags, normal, slip = (True, False, False, False), (0.0, 0.0, 1.0, 0.0), (-0.1, 0.0, 0.0)
    >>> before, law = (0.5, 0.0, 0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0, 0.5)
    >>> spring = tangential_step(*flags, *normal, 1.0, 1.0, 1.0, *slip, *before, *law, 0.1, 0.05)
    >>> spring[0], round(spring[6], 3), round(spring[8], 12)
    (0.5, 0.98, 0.005)
    """
    tau_c = shear_strength(f_n if cap_total else e_n, cohesion, mu)
    if plane:
        e_x, e_y, e_z = p_x - k_s * s_x * dt, p_y, p_z
        b_x, b_y, b_z = -eta_s * s_x, q_y, q_z
        size = math.fabs(e_x + b_x if total else e_x)
    else:
        p_x, p_y, p_z = turn(p_x, p_y, p_z, n_x, n_y, n_z, twist)
        e_x, e_y, e_z = p_x - k_s * s_x * dt, p_y - k_s * s_y * dt, p_z - k_s * s_z * dt
        b_x, b_y, b_z = -eta_s * s_x, -eta_s * s_y, -eta_s * s_z
        g_x = e_x + b_x if total else e_x
        g_y, g_z = e_y + b_y if total else e_y, e_z + b_z if total else e_z
        size = math.sqrt(g_x * g_x + g_y * g_y + g_z * g_z)
    share, swap, keep = slide(size, tau_c, drop, total)
    share, swap, keep = held * share, held * swap, held * keep
    e_x, b_x = share * e_x + swap * b_x, keep * b_x
    taken, lost = s_x * (p_x + e_x), s_x * (q_x + b_x)
    spent = p_x * p_x - e_x * e_x
    if not plane:
        e_y, b_y = share * e_y + swap * b_y, keep * b_y
        e_z, b_z = share * e_z + swap * b_z, keep * b_z
        taken += s_y * (p_y + e_y) + s_z * (p_z + e_z)
        lost += s_y * (q_y + b_y) + s_z * (q_z + b_z)
        spent += p_y * p_y - e_y * e_y + (p_z * p_z - e_z * e_z)
    spent = spent if hdt > 0.0 else 0.0  # springs held in the first step belong to the start
    taken, lost = 0.5 * spent * soft_s - hdt * taken if share < 1.0 else 0.0, -hdt * lost
    by_sliding = lost if total and share < held else 0.0
    return (
        e_x, e_y, e_z, b_x, b_y, b_z, share, lost - by_sliding, held * taken + by_sliding,
        taken - held * taken,
    )  # fmt: skip


@step_law
def contact_force(
    plane: bool, n_x: float, n_y: float, n_z: float, f_n: float, h_x: float, h_y: float, h_z: float
) -> tuple[float, float, float, float, float, float]:
    """Force of a contact on grain i, and the vector that times an arm is the torque on either grain.

    Parameters
    ----------
    plane : as in `contact_kinematics`.
    n_x, n_y, n_z : unit normal from i to j [-].
    f_n : normal force [N].
    h_x, h_y, h_z : tangential force on i [N].

    Returns
    -------
    f_x, f_y, f_z : force on i [N]; that on j is opposite.
    t_x, t_y, t_z : cross product of normal and tangential force [N]; times its arm it is the torque on each
        of the two grains.

    Notes
    -----
    Source: the paper, Eqs. (5)-(7).

    >>> contact_force(True, 0.0, 0.0, 1.0, 2.0, 0.5, 0.0, 0.0)
    (0.5, 0.0, -2.0, 0.0, 0.5, 0.0)
    """
    if plane:
        t_x, t_y, t_z = 0.0, h_x, 0.0
        h_x, h_y, h_z = h_x * n_z, 0.0, -h_x * n_x
    else:
        t_x, t_y, t_z = n_y * h_z - n_z * h_y, n_z * h_x - n_x * h_z, n_x * h_y - n_y * h_x
    return h_x - f_n * n_x, h_y - f_n * n_y, h_z - f_n * n_z, t_x, t_y, t_z
