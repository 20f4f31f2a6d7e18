"""A contact in the steps in which it begins or ends: exact touch and release (design/0014).

At a step a pair in touch is kicked; between two steps it goes on by a shear. Where it touches or is released
within a step, its velocity and its place are corrected there to those of its exact flow. Nothing here
branches but `middle_of_pair`: an engine that works on many pairs at once calls its parts in loops that become
vector instructions.
"""

import math
from typing import Any, NamedTuple

from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.laws.contact import shear_strength
from ryusa.laws.kick_and_shear import (
    decay_of_kick,
    kick_and_shear,
    part_in_step,
    time_of_release,
    touch_in_step,
)
from ryusa.laws.slip_within_step import slip_within_step

Vector = tuple[float, float, float]
Rules = tuple[bool, bool, bool]
Law = tuple[float, float, float, float]  # stiffnesses [N/m], cohesion [N], friction [-] of a pair

# States of a pair after a step
APART = 0
HELD = 1  # in touch: kicked, and half of its dashpot of the next kick is done
SLID = 2  # as HELD, and its last kick was cut down to the strength
BACK = 3  # its force came back since the last kick: its spring is that of the next one
BEGAN = 4  # touched since the last kick: likewise
FREED = 5  # without force, until the overlap ends or the force comes back
GONE = 6  # the force and the overlap ended since the last kick

# Displacements of the fastest grain in a step by which the shear of its pairs may move it, and within which
# pairs are looked at that may touch
AHEAD, REACH = 1.1, 2.5

# What happens to a pair between two kicks
NOTHING = 0.0
TOUCHES = 1.0
MAY_PART = 2.0  # `part` tells

_ROUND_OFF = 1e-9  # steps by which a release may lie beyond the next step and still be looked upon as at it
_BEYOND = 1.25  # times the strength: a spring that the next kick cuts down to it
SLIDES = 1.0 - 1e-9  # of the strength, from which on a contact slides


class Middle(NamedTuple):
    """What a pair does between two kicks."""

    state: float
    change: float  # of the closing speed by the pair [m/s]
    shift: float  # of the overlap by the pair, beside the flight of its grains [m]
    push: Vector  # tangential impulse on i [N s]
    spring: Vector  # tangential spring force on i from now on [N]
    spent_n: float  # dissipated in the normal and the tangential direction [J]
    spent_s: float
    slid: float  # 1 if it slid
    when: float  # time of touch or release after the step [s]; inf if there is none


@inner(fastmath=FAST, forceinline=True)
def pushes(state: float, overlap: float) -> bool:
    """Whether a pair is kicked at a step: by its place, not by what was foreseen (design/0014)."""
    return (overlap > 0.0) & (state != FREED)


@inner(fastmath=FAST, forceinline=True)
def is_held(state: float) -> bool:
    """Whether a pair was kicked at the last step and not released since."""
    return (state > APART) & (state < BACK)


@inner(fastmath=FAST, forceinline=True)
def bending(u_square: float, closing: float, distance: float) -> float:
    """Rate at which the closing speed of two free grains falls as they pass each other [m/s2].

    The second derivative of the distance of two points in uniform motion: (u**2 - v**2)/distance, of a
    distance of 0 for a grain and a plane, which do not turn as they pass.
    """
    return (u_square - closing * closing) / distance if distance > 0.0 else 0.0


@inner(fastmath=FAST, forceinline=True)
def half_dashpot(eta_d: float, m: float, dt: float) -> float:
    """Energy that half a dashpot of kicks takes, over the square of the velocity before it [kg]."""
    return 0.5 * eta_d * dt * (2.0 - eta_d * dt / m)


@inner(fastmath=FAST, forceinline=True)
def bounding(f_n: float, e_n: float) -> float:
    """Normal force that bounds the tangential one [N]; of a pair that parts, that of the kick.

    `f_n` is the whole normal force, and `e_n` that of the spring; the kick has half of the dashpot.
    """
    return max(f_n, 0.5 * (f_n + e_n))


@inner(fastmath=FAST, forceinline=True)
def after_kick(
    state: float, closing: float, f_n: float, eta_d: float, eta_sd: float, rules: Rules, dt: float
) -> tuple[float, float]:
    """Tangential impulse of a pair in touch after its kick, over slip velocity [kg] and over its force [s].

    Half of the dashpot, or where the strength holds for all of the force, what the strength is of the normal
    impulse after the kick; `f_n` is of `bounding` [N].
    """
    total, drop, cap_total = rules
    slid = state == SLID
    rubs = slid & total & cap_total & (f_n > 0.0)
    return 0.0 if slid and (total or drop) else -eta_sd * dt, eta_d * closing * dt / f_n if rubs else 0.0


@inner(fastmath=FAST, forceinline=True)
def dashes(state: float) -> bool:
    """Whether the second half of a dashpot is due at a step."""
    return (state > APART) & (state < FREED)


@inner(fastmath=FAST, forceinline=True)
def kind_between(
    state: float, overlap: float, closing: float, bend: float, k_n: float, eta: float, way: float,
    left: float, before: float, tension: bool, dt: float,
) -> float:  # fmt: skip
    """What happens to a pair until the next step, seen from its kick.

    `eta` is no less than its dashpot [N s/m], `bend` is of `bending` [m/s2].
    """
    y = overlap + way * closing
    falls = k_n * y + eta * (left * left * closing - before * y) <= 0.0
    ends = (y < 0.0) if tension else ((closing < 0.0) & falls)
    back = k_n * overlap + eta * closing > 0.0
    meets = (closing > 0.0) & (overlap + (closing - 0.5 * bend * dt) * dt > 0.0)
    begins = (back & (overlap > 0.0)) if state == FREED else meets
    held = is_held(state)
    return MAY_PART if held and ends else TOUCHES if (not held) and begins else NOTHING


@inner(fastmath=FAST, forceinline=True)
def spent_in_touch(
    overlap: float, closing: float, way: float, after: float, before: float, left: float, m: float, k_n: float
) -> float:
    """Energy that the dashpot of a pair takes over a step in touch [J]."""
    y, v = overlap + way * closing, closing + after * overlap
    rate = left * left * closing - before * y
    return 0.5 * (m * (v * v - rate * rate) + k_n * (overlap * overlap - y * y))


@inner(fastmath=FAST, forceinline=True)
def _tangential_kicks(
    m_t: float, k_s: float, eta_sd: float, dt: float
) -> tuple[float, float, float, float, float]:
    """Dashpot [N s/m], spring of a kick over that of the law, rates after and before a kick, what is left."""
    a = decay_of_kick(eta_sd, m_t, dt)
    _, after, before, left = kick_and_shear(dt, a, k_s / m_t - a * a)
    stiffer = m_t * (after + before) / (dt * k_s) if k_s > 0.0 else 0.0
    return 2.0 * a * m_t, stiffer, after, before, left


@inner(fastmath=FAST, forceinline=True)
def touch(
    overlap: float, closing: float, m: float, eta_d: float, way: float, after: float, before: float,
    left: float, m_t: float, k_sd: float, eta_sd: float, s: Vector, rules: Rules, law: Law, c: Any,
) -> Middle:  # fmt: skip
    """What a pair does that touches until the next step, or whose force comes back."""
    dt, (k_n, k_s, cohesion, mu) = c[P.DT], law
    total, drop, cap_total = rules
    a = decay_of_kick(eta_d, m, dt)
    q = k_n / m - a * a
    since, y, rate = touch_in_step(overlap, closing, dt, a, q)
    since = max(since, 0.0)
    held = max(overlap, 0.0)
    eta_s, stiffer, _, before_s, left_s = _tangential_kicks(m_t, k_s, eta_sd, dt)
    p_x, p_y, p_z, s_x, s_y, s_z, _, _, _, slid = slip_within_step(
        since, held, closing, a, q, m, 0.0, 0.0, 0.0, s[0], s[1], s[2], k_s, eta_s, m_t, cohesion, mu, total,
        drop, cap_total,
    )  # fmt: skip
    ahead = (rate + before * y) / left  # the kick at the next step takes the rest
    # of friction it takes what it takes of the force that limits it, if it slides; else what the spring takes
    e_n = k_n * y
    f_n = e_n + 2.0 * a * m * rate
    soft, dash = 1.0 / k_s if k_s > 0.0 else 0.0, eta_s if total else 0.0
    w_x, w_y, w_z = p_x - dash * s_x, p_y - dash * s_y, p_z - dash * s_z
    strength, size = (
        shear_strength(f_n if cap_total else e_n, cohesion, mu),
        math.sqrt(w_x * w_x + w_y * w_y + w_z * w_z),
    )
    slides = size >= SLIDES * strength
    # Rate of the limit, by the normal force or its spring.
    of_limit = m * (ahead - rate) / f_n if total else m * before / k_n
    of_limit *= strength / (m_t * size) if slides and size > 0.0 else 0.0
    of_spring, whole = 0.0 if slides else before_s * soft, slides and total
    over = 1.0 if slides and (total or drop) else 1.0 / left_s
    v_x = over * (s_x - of_limit * w_x - of_spring * p_x)
    v_y = over * (s_y - of_limit * w_y - of_spring * p_y)
    v_z = over * (s_z - of_limit * w_z - of_spring * p_z)
    push = (m_t * (v_x - s[0]), m_t * (v_y - s[1]), m_t * (v_z - s[2]))
    held_on, on_w, back = (
        _BEYOND - 1.0 if slides else 0.0,
        1.0 if slides else 0.0,
        2.0 * eta_sd if whole else 0.0,
    )
    on_p = 0.0 if slides else stiffer
    e_x, e_y, e_z = (
        on_w * w_x + on_p * p_x + back * v_x,
        on_w * w_y + on_p * p_y + back * v_y,
        on_w * w_z + on_p * p_z + back * v_z,
    )
    spring = e_x + held_on * w_x, e_y + held_on * w_y, e_z + held_on * w_z
    soft_d = 0.5 / k_sd if k_sd > 0.0 else 0.0
    spent_n = 0.5 * (m * (closing * closing - rate * rate) + k_n * (held * held - y * y))
    moved = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - (s_x * s_x + s_y * s_y + s_z * s_z)
    spent_s = 0.5 * m_t * moved - soft_d * (e_x * e_x + e_y * e_y + e_z * e_z)
    state, shift = float(BACK if overlap > 0.0 else BEGAN), y - overlap - dt * ahead
    return Middle(
        state, ahead - closing, shift, push, spring, spent_n, spent_s, slid, dt - since
    )  # fmt: skip


@inner(fastmath=FAST, forceinline=True)
def part(
    state: float, overlap: float, closing: float, f_n: float, m: float, eta_d: float, way: float,
    after: float, before: float, left: float, m_t: float, k_sd: float, eta_sd: float, p: Vector, f_t: Vector,
    s: Vector, tension: bool, rules: Rules, law: Law, c: Any,
) -> Middle:  # fmt: skip
    """What a pair in touch does until the next step if it may be released.

    `f_n` bounds its tangential force, `p` is its tangential spring force, `f_t` all of that force, on i [N].
    """
    dt, (k_n, k_s, cohesion, mu) = c[P.DT], law
    total, drop, cap_total = rules
    a = decay_of_kick(eta_d, m, dt)
    q = k_n / m - a * a
    v = closing + after * overlap
    until = time_of_release(overlap, v, a, q, tension)
    ends = until <= (1.0 + _ROUND_OFF) * dt
    until = min(until, dt) if ends else 0.0
    y, rate = part_in_step(overlap, v, until, dt, a, q)
    eta_s, stiffer, after_s, _, _ = _tangential_kicks(m_t, k_s, eta_sd, dt)
    softer = 1.0 / stiffer if stiffer > 0.0 else 0.0
    p_x, p_y, p_z = softer * p[0], softer * p[1], softer * p[2]
    slides = state == SLID
    soft = 1.0 / k_s if k_s > 0.0 else 0.0
    of_all = m * after * overlap / (m_t * f_n) if f_n > 0.0 else 0.0
    of_spring = stiffer * dt * after / (m_t * (after + before)) if slides else after_s * soft
    of_all, of_spring = of_all if slides and total else 0.0, 0.0 if slides and total else of_spring
    b_x = s[0] - of_all * f_t[0] - of_spring * p_x
    b_y = s[1] - of_all * f_t[1] - of_spring * p_y
    b_z = s[2] - of_all * f_t[2] - of_spring * p_z
    _, _, _, s_x, s_y, s_z, _, _, _, slid = slip_within_step(
        until, overlap, v, a, q, m, p_x, p_y, p_z, b_x, b_y, b_z, k_s, eta_s, m_t, cohesion, mu, total, drop,
        cap_total,
    )  # fmt: skip
    spent_n = 0.5 * (m * (v * v - rate * rate) + k_n * overlap * overlap)
    moved = b_x * b_x + b_y * b_y + b_z * b_z - (s_x * s_x + s_y * s_y + s_z * s_z)
    soft_d = 0.5 / k_sd if k_sd > 0.0 else 0.0
    spent_s = 0.5 * m_t * moved + soft_d * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2])
    go, stay = 1.0 if ends else 0.0, 0.0 if ends else 1.0
    dash, rub = after_kick(state, closing, f_n, eta_d, eta_sd, rules, dt)
    dash, rub = stay * dash, stay * rub
    freed = FREED if y > 0.0 else GONE
    return Middle(
        freed if ends else state,
        go * (rate - closing) - stay * (1.0 - left) * closing,
        go * (y - overlap - dt * rate) + stay * (way - dt * left) * closing,
        (
            go * m_t * (s_x - s[0]) + dash * s[0] + rub * f_t[0],
            go * m_t * (s_y - s[1]) + dash * s[1] + rub * f_t[1],
            go * m_t * (s_z - s[2]) + dash * s[2] + rub * f_t[2],
        ),
        (stay * p[0], stay * p[1], stay * p[2]),
        go * spent_n + stay * spent_in_touch(overlap, closing, way, after, before, left, m, k_n),
        go * spent_s + half_dashpot(-dash / dt, m_t, dt) * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]),
        go * max(slid, 1.0 if slides else 0.0), until if ends else math.inf,
    )  # fmt: skip


@inner(fastmath=FAST)
def middle_of_pair(
    state: float, overlap: float, closing: float, bend: float, f_n: float, m: float, eta_d: float,
    k_nd: float, way: float, after: float, m_t: float, k_sd: float, eta_sd: float, p: Vector, f_t: Vector,
    s: Vector, tension: bool, rules: Rules, law: Law, c: Any,
) -> Middle:  # fmt: skip
    """What a pair does between two kicks.

    Parameters
    ----------
    state : of the pair after the kick.
    overlap, closing : as `contact_kinematics` gives them [m], [m/s], after the kick.
    bend : as `bending` gives it [m/s2].
    f_n : of `bounding` at the kick [N].
    m, m_t : effective masses in the normal and the tangential direction [kg].
    eta_d, k_nd, way, after : dashpot and spring of its kicks, and its shear, as `memory_rows` has them.
    k_sd, eta_sd : tangential spring [N/m] and dashpot [N s/m] of its kicks, likewise.
    p, f_t : tangential spring force, and whole tangential force, on i at the kick [N].
    s : slip velocity of i relative to j [m/s], after the kick.
    tension : the force ends with the overlap; else where it would pull.
    rules : of sliding, `total`, `drop` and `cap_total` of `tangential_step`.
    law : of the pair.
    c : parameters.
    """
    dt, k_n = c[P.DT], law[0]
    left, before = 1.0 - eta_d * dt / m, k_nd * dt / m - after
    kind = kind_between(
        state, overlap, closing, bend, k_n, 2.0 * eta_d / left, way, left, before, tension, dt
    )
    none = (0.0, 0.0, 0.0)
    if kind == TOUCHES:
        return touch(
            overlap, closing, m, eta_d, way, after, before, left, m_t, k_sd, eta_sd, s, rules, law, c
        )
    if kind == MAY_PART:
        return part(
            state, overlap, closing, f_n, m, eta_d, way, after, before, left, m_t, k_sd, eta_sd, p, f_t, s,
            tension, rules, law, c,
        )  # fmt: skip
    if is_held(state):
        spent = spent_in_touch(overlap, closing, way, after, before, left, m, k_n)
        dash, rub = after_kick(state, closing, f_n, eta_d, eta_sd, rules, dt)
        push = dash * s[0] + rub * f_t[0], dash * s[1] + rub * f_t[1], dash * s[2] + rub * f_t[2]
        spent_s = half_dashpot(-dash / dt, m_t, dt) * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
        shift = (way - dt * left) * closing
        return Middle(state, (left - 1.0) * closing, shift, push, p, spent, spent_s, 0.0, math.inf)
    return Middle(state, 0.0, 0.0, none, none, 0.0, 0.0, 0.0, math.inf)
