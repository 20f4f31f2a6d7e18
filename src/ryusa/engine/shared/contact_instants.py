"""A contact in the steps in which it begins or ends: exact touch and release (design/0014).

The states of a pair tell what its next step has to do. Between the first and the last step of a contact the
force is that of the map (laws/contact_map.py). Nothing here branches but `instant_step`: an engine that works
on many pairs at once calls its parts in loops that become vector instructions.
"""

import math
from typing import Any

from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.laws.contact import shear_strength, slide
from ryusa.laws.contact_map import (
    begin_in_step,
    decay_of_map,
    end_in_step,
    time_of_release,
    velocity_of_map,
)
from ryusa.laws.slip_within_step import slip_within_step

Vector = tuple[float, float, float]
Rules = tuple[bool, bool, bool]
Springs = tuple[float, float, float, float]  # stiffnesses [N/m], cohesion [N], friction [-] of a pair

# States of a pair
APART = 0
HELD = 1  # on the map
BEGAN = 2  # touched within the last step: the closing speed is still to be corrected
ENDING = 3  # the force ended within the last step: the closing speed is still to be corrected
ENDED = 4  # without force, until the overlap ends or the force comes back
PARTED = 5  # without overlap, in the one step after its end in which the closing speed was corrected

# What a step does with a pair
FREE = 0.0  # no force
ON_MAP = 1.0  # the force of the map
BEGINS = 2.0
MAY_END = 3.0  # `end_contact` tells
CORRECTS = 4.0  # the closing speed after the end

_ROUND_OFF = 1e-9  # steps by which a release may lie beyond the next step and still be looked upon as at it
_LATE = 2.0  # steps of approach within which a first overlap is that of a touch; a larger one was put there


@inner(fastmath=FAST, forceinline=True)
def may_end(closing: float, raw: float, k_d: float, c: Any) -> bool:
    """Whether the force `raw` of a map [N] may end within the coming step, whatever the masses."""
    falls = c[P.FADING] * raw <= -k_d * closing * c[P.DT]
    return (closing < 0.0) & (falls | (raw <= 0.0))  # no branch, for a loop over pairs


@inner(fastmath=FAST, forceinline=True)
def kind_of_step(
    state: float, overlap: float, closing: float, raw: float, fades: bool, tension: bool, dt: float
) -> float:
    """What a step does with a pair; `raw` is the force of the map [N], `fades` whether it `may_end`."""
    apart, ended = state == APART, state >= ENDED
    free = overlap <= 0.0 or ((apart or ended) and raw <= 0.0 and not tension)
    begins = apart and overlap <= _LATE * closing * dt
    ends = state == BEGAN or (state == HELD and fades)
    kind = BEGINS if begins else MAY_END if ends else ON_MAP
    kind = FREE if free else kind
    return CORRECTS if state == ENDING else kind


@inner(fastmath=FAST, forceinline=True)
def oscillators(
    m: float, eta_d: float, m_t: float, eta_sd: float, k_n: float, c: Any
) -> tuple[float, float, float, float]:
    """Oscillators of the normal and the tangential map of a pair.

    Returns decay rate [1/s] and squared frequency [1/s2] of the first, decay rate and dashpot [N s/m] of
    the second.
    """
    a, a_t = decay_of_map(eta_d, m, c[P.DT]), decay_of_map(eta_sd, m_t, c[P.DT])
    return a, k_n / m - a * a, a_t, 2.0 * a_t * m_t


@inner(fastmath=FAST, forceinline=True)
def begin_contact(
    overlap: float, closing: float, curve: float, m: float, k_d: float, eta_d: float, m_t: float, k_sd: float,
    eta_sd: float, s: Vector, rules: Rules, law: Springs, c: Any,
) -> tuple[float, float, Vector, Vector, bool]:  # fmt: skip
    """Normal force and that of its spring [N], tangential force as in `instant_step`, and whether it slid."""
    dt, (k_n, k_s, cohesion, mu) = c[P.DT], law
    total, drop, cap_total = rules
    a, q, _, eta_s = oscillators(m, eta_d, m_t, eta_sd, k_n, c)
    since, v_touch, y, rate, brake = begin_in_step(overlap, closing, curve, dt, a, q)
    p_x, p_y, p_z, s_x, s_y, s_z, _, _, _, slid = slip_within_step(
        since, 0.0, v_touch, a, q, m, 0.0, 0.0, 0.0, s[0], s[1], s[2], k_s, eta_s, m_t, cohesion, mu, total,
        drop, cap_total,
    )  # fmt: skip
    _, _, _, _, _, _, way_x, way_y, way_z, slid_too = slip_within_step(
        dt, y, rate, a, q, m, p_x, p_y, p_z, s_x, s_y, s_z, k_s, eta_s, m_t, cohesion, mu, total, drop,
        cap_total,
    )  # fmt: skip
    softer = k_sd / k_s if k_s > 0.0 else 0.0
    e = (p_x * softer, p_y * softer, p_z * softer)
    b = (
        m_t * (way_x / dt - s[0]) / dt - e[0],
        m_t * (way_y / dt - s[1]) / dt - e[1],
        m_t * (way_z / dt - s[2]) / dt - e[2],
    )
    return m * brake / dt, k_d * y, e, b, slid + slid_too > 0.0


@inner(fastmath=FAST, forceinline=True)
def _slip_to_the_end(
    until: float, overlap: float, v: float, a: float, q: float, m: float, push: float, e_n: float,
    m_t: float, k_sd: float, eta_sd: float, eta_s: float, p: Vector, f_t: Vector, s: Vector, rules: Rules,
    law: Springs, c: Any,
) -> tuple[Vector, bool]:  # fmt: skip
    """Tangential force on i [N] in the step in which the normal force ends, and whether the contact slid."""
    dt, (_, k_s, cohesion, mu) = c[P.DT], law
    total, drop, cap_total = rules
    stiffer = k_s / k_sd if k_sd > 0.0 else 0.0
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


@inner(fastmath=FAST, forceinline=True)
def end_contact(
    rest: float, overlap: float, closing: float, m: float, k_d: float, eta_d: float, m_t: float, k_sd: float,
    eta_sd: float, p: Vector, f_t: Vector, s: Vector, tension: bool, rules: Rules, law: Springs,
    c: Any,
) -> tuple[bool, float, float, float, Vector, bool, float]:  # fmt: skip
    """Forces of a contact on its map that may end within the coming step.

    Parameters as in `instant_step`, the rest zero but in the second step of a contact. Returns whether it
    ends, and then `rest`, `f_n`, `push`, `b`, `slid` and `until` as in `instant_step`.
    """
    dt, e_n = c[P.DT], k_d * overlap
    closing += rest
    raw = e_n + eta_d * closing
    onward = closing - dt * raw / m
    fades = closing < 0.0 and k_d * (overlap + dt * onward) + eta_d * onward <= P.LEAST_NEXT * raw
    a, q, _, eta_s = oscillators(m, eta_d, m_t, eta_sd, law[0], c)
    v = velocity_of_map(overlap, closing, dt, a, q)
    until = time_of_release(overlap, v, a, q, tension)
    ends = fades and until <= (1.0 + _ROUND_OFF) * dt
    until = until if ends else 0.0
    v_mean, v_end = end_in_step(overlap, v, until, dt, a, q)
    b, slid = _slip_to_the_end(
        until, overlap, v, a, q, m, raw, e_n, m_t, k_sd, eta_sd, eta_s, p, f_t, s, rules, law, c
    )
    f_n = (m * (closing - v_mean) / dt if ends else raw) - m * rest / dt
    return ends, v_end - v_mean, f_n, raw, b, slid, until if ends else math.inf


@inner(fastmath=FAST)
def instant_step(
    state: int, rest: float, overlap: float, closing: float, curve: float, m: float, k_d: float, eta_d: float,
    m_t: float, k_sd: float, eta_sd: float, p: Vector, f_t: Vector, s: Vector, tension: bool, rules: Rules,
    law: Springs, c: Any,
) -> tuple[int, float, float, float, float, bool, Vector, Vector, bool, float]:  # fmt: skip
    """Forces of a pair in a step that begins or ends its contact, or may end it.

    Parameters
    ----------
    state : of the pair after the last step.
    rest : correction of the closing speed that the last step left [m/s].
    overlap, closing : as `contact_kinematics` gives them [m], [m/s].
    curve : as `contact_map.passing` gives it [m/s2].
    m, m_t : effective masses in the normal and the tangential direction [kg].
    k_d, eta_d, k_sd, eta_sd : stiffness [N/m] and dashpots [N s/m] of the map.
    p, f_t : tangential spring force, and whole tangential force, on i in the last step [N].
    s : slip velocity of i relative to j [m/s].
    tension : the force ends with the overlap; else where it would pull.
    rules : of sliding, `total`, `drop` and `cap_total` of `tangential_step`.
    law : of the pair.
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
    e_n, none = k_d * overlap, (0.0, 0.0, 0.0)
    raw = e_n + eta_d * closing
    kind = kind_of_step(state, overlap, closing, raw, True, tension, c[P.DT])
    if kind == CORRECTS:
        now = ENDED if overlap > 0.0 else PARTED
        return now, 0.0, -m * rest / c[P.DT], 0.0, 0.0, True, none, none, False, -math.inf
    if kind == FREE:
        now, until = ENDED if overlap > 0.0 else APART, -math.inf if state >= ENDED else 0.0
        return now, 0.0, 0.0, 0.0, 0.0, True, none, none, False, until
    if kind == BEGINS:
        f_n, e_n, e, b, slid = begin_contact(
            overlap, closing, curve, m, k_d, eta_d, m_t, k_sd, eta_sd, s, rules, law, c
        )
        return BEGAN, 0.0, f_n, e_n, f_n, True, e, b, slid, math.inf
    if kind == MAY_END:
        rest = rest if state == BEGAN else 0.0
        ends, rest, f_n, raw, b, slid, until = end_contact(
            rest, overlap, closing, m, k_d, eta_d, m_t, k_sd, eta_sd, p, f_t, s, tension, rules, law, c
        )
        if ends:
            return ENDING, rest, f_n, e_n, raw, True, none, b, slid, until
        return HELD, 0.0, f_n, e_n, raw, False, none, none, False, math.inf
    return HELD, 0.0, raw, e_n, raw, False, none, none, False, math.inf
