"""Tangential motion of a contact over a part of a time step, with the normal motion of an oscillator.

Used in the two steps of a contact in which it begins and ends (kick_and_shear.py), where friction acts over a
part of a step only and its limit changes from or to zero.
"""

import math

from ryusa.laws._law import step_law
from ryusa.laws.contact import shear_strength, slide
from ryusa.laws.kick_and_shear import free_response

PARTS = 2  # into which the span is cut (design/0014)


@step_law
def slip_within_step(
    span: float, y: float, rate: float, a: float, q: float, m: float, p_x: float, p_y: float, p_z: float,
    s_x: float, s_y: float, s_z: float, k_s: float, eta_s: float, m_t: float, cohesion: float, mu: float,
    total: bool, drop: bool, cap_total: bool,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:  # fmt: skip
    """Integrate spring and slip velocity of a contact over a span of time within a step.

    Parameters
    ----------
    span : duration [s].
    y, rate : overlap at its beginning [m] and its rate [m/s].
    a, q : decay rate [1/s] and squared frequency [1/s2] of the normal oscillator.
    m : effective mass in the normal direction [kg].
    p_x, p_y, p_z : tangential spring force on grain i at the beginning [N].
    s_x, s_y, s_z : slip velocity of i relative to j at the beginning [m/s].
    k_s, eta_s : tangential stiffness [N/m] and dashpot [N s/m], without corrections for the step.
    m_t : effective mass in the tangential direction [kg].
    cohesion, mu : of the shear strength, as in `contact.shear_strength` [N], [-].
    total, drop : variant of sliding, as in `contact.slide`.
    cap_total : the whole normal force enters Eq. (4); else only its spring.

    Returns
    -------
    p_x, p_y, p_z, s_x, s_y, s_z : spring force [N] and slip velocity [m/s] at the end.
    way_x, way_y, way_z : displacement of i relative to j at the contact point [m].
    slid : 1 if the contact slid, else 0 [-].

    Notes
    -----
    Source: midpoint rule, implicit in spring and dashpot, in `PARTS` parts; Eqs. (2)-(4). In a plane scene
    the second and third components are zero.

    >>> normal, rules = (1.0, 1.0, 0.0, 0.0, 1.0, 1.0), (False, False, False)
    >>> spring, slip = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    >>> slip_within_step(*normal, *spring, *slip, 0.0, 0.0, 1.0, 0.0, 0.5, *rules)[3:]
    (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    """
    # One function: half of its lines are the three components
    part = span / PARTS
    g, h = free_response(0.5 * part, a, q)
    k_n, eta_n = m * (a * a + q), 2.0 * a * m
    trace, determinant = 2.0 * (h + a * g), h * (h + 2.0 * a * g) + (a * a + q) * g * g
    e_old, f_old = k_n * y, k_n * y + eta_n * rate  # at the beginning, then at every half part
    y_half, rate_half = y * (h + 2.0 * a * g) + rate * g, rate * h - (a * a + q) * y * g
    e_n, f_n = k_n * y_half, k_n * y_half + eta_n * rate_half
    way_x = way_y = way_z = 0.0
    slid = 0.0
    kick = part / m_t  # impulse over mass of a force of 1 N in a part
    soft = 1.0 / (1.0 + 0.5 * kick * (0.5 * part * k_s + eta_s))
    for _ in range(PARTS):
        tau_c = shear_strength(f_n if cap_total else e_n, cohesion, mu)
        u_x = soft * (s_x + 0.5 * kick * p_x)
        u_y = soft * (s_y + 0.5 * kick * p_y)
        u_z = soft * (s_z + 0.5 * kick * p_z)
        e_x, e_y, e_z = (
            p_x - 0.5 * part * k_s * u_x,
            p_y - 0.5 * part * k_s * u_y,
            p_z - 0.5 * part * k_s * u_z,
        )
        b_x, b_y, b_z = -eta_s * u_x, -eta_s * u_y, -eta_s * u_z
        w_x, w_y, w_z = e_x, e_y, e_z
        if total:
            w_x, w_y, w_z = w_x + b_x, w_y + b_y, w_z + b_z
        share, swap, keep = slide(math.sqrt(w_x * w_x + w_y * w_y + w_z * w_z), tau_c, drop, total)
        e_x, e_y, e_z = share * e_x + swap * b_x, share * e_y + swap * b_y, share * e_z + swap * b_z
        slides = share < 1.0
        slid = 1.0 if slides else slid
        step_x, step_y, step_z = (
            part * (s_x + 0.5 * kick * (e_x + keep * b_x)),
            part * (s_y + 0.5 * kick * (e_y + keep * b_y)),
            part * (s_z + 0.5 * kick * (e_z + keep * b_z)),
        )
        way_x, way_y, way_z = way_x + step_x, way_y + step_y, way_z + step_z
        s_x += kick * (e_x + keep * b_x)
        s_y += kick * (e_y + keep * b_y)
        s_z += kick * (e_z + keep * b_z)
        e_old, e_n = e_n, trace * e_n - determinant * e_old  # at the end of the part
        f_old, f_n = f_n, trace * f_n - determinant * f_old
        tau_c = shear_strength(f_n if cap_total else e_n, cohesion, mu)
        if slides:  # from the middle of the part, where the force was the limit
            p_x, p_y, p_z = e_x - 0.5 * k_s * step_x, e_y - 0.5 * k_s * step_y, e_z - 0.5 * k_s * step_z
        else:
            p_x, p_y, p_z = p_x - k_s * step_x, p_y - k_s * step_y, p_z - k_s * step_z
        b_x, b_y, b_z = -eta_s * s_x, -eta_s * s_y, -eta_s * s_z
        w_x, w_y, w_z = p_x, p_y, p_z
        if total:
            w_x, w_y, w_z = w_x + b_x, w_y + b_y, w_z + b_z
        share, swap, _ = slide(math.sqrt(w_x * w_x + w_y * w_y + w_z * w_z), tau_c, drop, total)
        slid = 1.0 if share < 1.0 else slid
        p_x, p_y, p_z = share * p_x + swap * b_x, share * p_y + swap * b_y, share * p_z + swap * b_z
        e_old, e_n = e_n, trace * e_n - determinant * e_old  # in the middle of the next
        f_old, f_n = f_n, trace * f_n - determinant * f_old
    return p_x, p_y, p_z, s_x, s_y, s_z, way_x, way_y, way_z, slid
