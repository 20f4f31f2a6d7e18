"""A contact in the steps in which it begins or ends: exact touch and release (design/0014).

The states of a pair tell what its next step has to do. Between the first and the last step of a contact the
force is that of the map (laws/contact_map.py), and nothing here is called.
"""

import math
from typing import Any

from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import inner
from ryusa.laws.contact import shear_strength, slide
from ryusa.laws.contact_map import (
    begin_in_step,
    decay_of_map,
    end_in_step,
    frequency_of_map,
    time_of_release,
    velocity_of_map,
)
from ryusa.laws.slip_within_step import slip_within_step

Vector = tuple[float, float, float]
Rules = tuple[bool, bool, bool]

# States of a pair
APART = 0
HELD = 1  # on the map
BEGAN = 2  # touched within the last step: the closing speed is still to be corrected
ENDING = 3  # the force ended within the last step: the closing speed is still to be corrected
ENDED = 4  # without force, until the overlap ends or the force comes back

_LATE = 2.0  # steps of approach within which a first overlap is that of a touch; a larger one was put there
_FAR_FROM_ZERO = 0.25  # of the present force: a next force above it does not end within the step


@inner()
def _tangential_oscillator(m_t: float, k_sd: float, eta_sd: float, dt: float) -> tuple[float, float, float]:
    """Stiffness [N/m] and dashpot [N s/m] of a tangential map, and that stiffness over the one of the map."""
    a, q = decay_of_map(eta_sd, m_t, dt), frequency_of_map(k_sd, eta_sd, m_t, dt)
    k_s = m_t * (a * a + q)
    return k_s, 2.0 * a * m_t, k_s / k_sd if k_sd > 0.0 else 0.0


@inner()
def _begin(
    overlap: float, closing: float, m: float, k_d: float, eta_d: float, m_t: float, k_sd: float,
    eta_sd: float, s: Vector, rules: Rules, c: Any,
) -> tuple[float, float, Vector, Vector, bool]:  # fmt: skip
    """Normal force and that of its spring [N], tangential force as in `instant_step`, and whether it slid."""
    dt, cohesion, mu = c[P.DT], c[P.COHESION], c[P.MU]
    total, drop, cap_total = rules
    a, q = decay_of_map(eta_d, m, dt), frequency_of_map(k_d, eta_d, m, dt)
    k_s, eta_s, stiffer = _tangential_oscillator(m_t, k_sd, eta_sd, dt)
    since, y, rate, v_new = begin_in_step(overlap, closing, dt, a, q)
    p_x, p_y, p_z, s_x, s_y, s_z, _, _, _, slid = slip_within_step(
        since, 0.0, closing, a, q, m, 0.0, 0.0, 0.0, s[0], s[1], s[2], k_s, eta_s, m_t, cohesion, mu, total,
        drop, cap_total,
    )  # fmt: skip
    _, _, _, _, _, _, way_x, way_y, way_z, slid_too = slip_within_step(
        dt, y, rate, a, q, m, p_x, p_y, p_z, s_x, s_y, s_z, k_s, eta_s, m_t, cohesion, mu, total, drop,
        cap_total,
    )  # fmt: skip
    softer = 1.0 / stiffer if stiffer > 0.0 else 0.0
    e = (p_x * softer, p_y * softer, p_z * softer)
    b = (
        m_t * (way_x / dt - s[0]) / dt - e[0],
        m_t * (way_y / dt - s[1]) / dt - e[1],
        m_t * (way_z / dt - s[2]) / dt - e[2],
    )
    return m * (closing - v_new) / dt, k_d * y, e, b, slid + slid_too > 0.0


@inner()
def _slip_to_the_end(
    until: float, overlap: float, v: float, a: float, q: float, m: float, push: float, e_n: float,
    m_t: float, k_sd: float, eta_sd: float, p: Vector, f_t: Vector, s: Vector, rules: Rules, c: Any,
) -> tuple[Vector, bool]:  # fmt: skip
    """Tangential force on i [N] in the step in which the normal force ends, and whether the contact slid."""
    dt, cohesion, mu = c[P.DT], c[P.COHESION], c[P.MU]
    total, drop, cap_total = rules
    k_s, eta_s, stiffer = _tangential_oscillator(m_t, k_sd, eta_sd, dt)
    e_x, e_y, e_z = p[0] - k_sd * s[0] * dt, p[1] - k_sd * s[1] * dt, p[2] - k_sd * s[2] * dt
    b_x, b_y, b_z = -eta_sd * s[0], -eta_sd * s[1], -eta_sd * s[2]
    w_x, w_y, w_z = e_x, e_y, e_z
    if total:
        w_x, w_y, w_z = w_x + b_x, w_y + b_y, w_z + b_z
    tau_c = shear_strength(push if cap_total else e_n, cohesion, mu)
    share, swap, keep = slide(math.sqrt(w_x * w_x + w_y * w_y + w_z * w_z), tau_c, drop, total)
    e_x, e_y, e_z = share * e_x + swap * b_x, share * e_y + swap * b_y, share * e_z + swap * b_z
    lag = dt / (6.0 * m_t)  # from the mean of the last step to now, with a force that changes linearly
    _, _, _, s_x, s_y, s_z, _, _, _, slid = slip_within_step(
        until, overlap, v, a, q, m, stiffer * e_x, stiffer * e_y, stiffer * e_z,
        s[0] + lag * (2.0 * (e_x + keep * b_x) + f_t[0]), s[1] + lag * (2.0 * (e_y + keep * b_y) + f_t[1]),
        s[2] + lag * (2.0 * (e_z + keep * b_z) + f_t[2]), k_s, eta_s, m_t, cohesion, mu, total, drop,
        cap_total,
    )  # fmt: skip
    force = (m_t * (s_x - s[0]) / dt, m_t * (s_y - s[1]) / dt, m_t * (s_z - s[2]) / dt)
    return force, slid > 0.0 or share < 1.0


@inner()
def instant_step(
    state: int, rest: float, overlap: float, closing: float, m: float, k_d: float, eta_d: float, m_t: float,
    k_sd: float, eta_sd: float, p: Vector, f_t: Vector, s: Vector, tension: bool, rules: Rules, c: Any,
) -> tuple[int, float, float, float, float, bool, Vector, Vector, bool, float]:  # fmt: skip
    """Forces of a pair in a step that begins or ends its contact, or may end it.

    Parameters
    ----------
    state : of the pair after the last step.
    rest : correction of the closing speed that the last step left [m/s].
    overlap, closing : as `contact_kinematics` gives them [m], [m/s].
    m, m_t : effective masses in the normal and the tangential direction [kg].
    k_d, eta_d, k_sd, eta_sd : stiffness [N/m] and dashpots [N s/m] of the map.
    p, f_t : tangential spring force, and whole tangential force, on i in the last step [N].
    s : slip velocity of i relative to j [m/s].
    tension : the force ends with the overlap; else where it would pull.
    rules : of sliding, `total`, `drop` and `cap_total` of `tangential_step`.
    c : parameters.

    Returns
    -------
    state, rest : after this step; the rest only of one whose force ends.
    f_n, e_n : normal force and that of its spring [N].
    push : normal force without corrections, which limits friction if the whole force does [N].
    given : whether the tangential force is given here; else it is that of `tangential_step`.
    e, b : tangential spring force, and the rest of the tangential force, on i [N].
    slid : whether the contact slid.
    until : time from this step to the end of the force [s]; inf if it goes on, -inf if it ended before.
    """
    dt, e_n, none = c[P.DT], k_d * overlap, (0.0, 0.0, 0.0)
    raw = e_n + eta_d * closing
    if state == ENDING:
        return ENDED, 0.0, -m * rest / dt, 0.0, 0.0, True, none, none, False, -math.inf
    if overlap <= 0.0 or (state in (APART, ENDED) and raw <= 0.0 and not tension):
        now, until = ENDED if overlap > 0.0 else APART, -math.inf if state == ENDED else 0.0
        return now, 0.0, 0.0, 0.0, 0.0, True, none, none, False, until
    if state == ENDED or (state == APART and overlap > _LATE * closing * dt):
        return HELD, 0.0, raw, e_n, raw, False, none, none, False, math.inf
    if state == APART:
        f_n, e_n, e, b, slid = _begin(overlap, closing, m, k_d, eta_d, m_t, k_sd, eta_sd, s, rules, c)
        return BEGAN, 0.0, f_n, e_n, f_n, True, e, b, slid, math.inf
    correction = 0.0
    if state == BEGAN:
        closing += rest
        correction = -m * rest / dt
        raw = e_n + eta_d * closing
    onward = closing - dt * raw / m
    if closing >= 0.0 or k_d * (overlap + dt * onward) + eta_d * onward > _FAR_FROM_ZERO * raw:
        return HELD, 0.0, raw + correction, e_n, raw, False, none, none, False, math.inf
    a, q = decay_of_map(eta_d, m, dt), frequency_of_map(k_d, eta_d, m, dt)
    v = velocity_of_map(overlap, closing, dt, a, q)
    until = time_of_release(overlap, v, a, q, tension)
    if until > dt:
        return HELD, 0.0, raw + correction, e_n, raw, False, none, none, False, math.inf
    v_mean, v_end = end_in_step(overlap, v, until, dt, a, q)
    b, slid = _slip_to_the_end(until, overlap, v, a, q, m, raw, e_n, m_t, k_sd, eta_sd, p, f_t, s, rules, c)
    f_n = m * (closing - v_mean) / dt + correction
    return ENDING, v_end - v_mean, f_n, e_n, raw, True, none, b, slid, until
