"""The kick of a pair at a step, with exact timing (design/0014); contact_instants.py has what follows it."""

import math

from ryusa.engine.shared.contact_instants import (
    APART,
    BACK,
    BEGAN,
    FREED,
    GONE,
    HELD,
    SLIDES,
    bounding,
    dashes,
    half_dashpot,
    pushes,
)
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.laws.contact import shear_strength
from ryusa.laws.contact_step import tangential_step

Vector = tuple[float, float, float]


@inner(fastmath=FAST, forceinline=True)
def kick_along(
    state: float, overlap: float, closing: float, k_n: float, eta_d: float
) -> tuple[int, float, float, float]:
    """State of a pair after a kick, and its normal forces.

    Parameters
    ----------
    state : after the step before.
    overlap, closing : as `contact_kinematics` gives them [m], [m/s].
    k_n, eta_d : spring [N/m] and dashpot [N s/m] of kicks, as `memory_rows` has them.

    Returns
    -------
    state : HELD where it may have slid.
    kick : normal force of the kick, half of the dashpot in it; the other half acts after it [N].
    e_n, f_n : force of the spring, and whole normal force [N].
    """
    held = pushes(state, overlap)
    dash = eta_d * closing if dashes(state) else 0.0
    push = k_n * overlap if held else 0.0
    # released and still in touch, be it by others or by round-off: nothing damps it any more, and no spring
    # holds what it is pushed with
    kept = held & ((state != GONE) | (eta_d <= 0.0))
    e_n = push if kept else 0.0
    apart = FREED if overlap > 0.0 else APART
    return HELD if kept else apart, push + dash, e_n, e_n + 2.0 * dash if kept else 0.0


@inner(fastmath=FAST, forceinline=True)
def kick_across(
    plane: bool, total: bool, drop: bool, cap_total: bool, was: float, held: bool, normal: Vector,
    twist: float, kick: float, f_n: float, e_n: float, s: Vector, p: Vector, q: Vector, k_d: float,
    eta_d: float, m_t: float, cohesion: float, mu: float, dt: float, hdt: float,
) -> tuple[Vector, Vector, Vector, float, float, float, bool]:  # fmt: skip
    """Tangential forces of a pair at a kick, and their account over the interval before it.

    Parameters
    ----------
    plane, total, drop, cap_total, twist, cohesion, mu, dt, hdt : as in `tangential_step`; s, p, q likewise.
    was, held : state after the step before, and whether the pair is held by this one.
    kick, f_n, e_n : of `kick_along` [N].
    k_d, eta_d, m_t : tangential spring [N/m] and dashpot [N s/m] of kicks, effective mass [kg].

    Returns
    -------
    e, b : force of spring and of the whole dashpot on i [N].
    h : tangential force of the kick on i [N].
    taken : twice the energy that the spring has taken up [J].
    dashpot, sliding : energy dissipated [J].
    slides : whether the contact slides.
    """
    began = (was == BEGAN) | (was == BACK)
    # "total" takes its part of the dashpot after the kick, too (`after_kick`); a capped spring acts at once
    bound = bounding(f_n, e_n) if total else f_n
    # of a contact that began the spring is that of this step, and the step before has no share in it
    way, before = 0.0 if began else dt, 0.0 if began else hdt
    soft = 1.0 / k_d if k_d > 0.0 else 0.0
    e_x, e_y, e_z, b_x, b_y, b_z, share, dashpot, sliding, _ = tangential_step(
        plane, total, drop, cap_total, normal[0], normal[1], normal[2], twist, bound, e_n,
        1.0 if held else 0.0, s[0], s[1], s[2], p[0], p[1], p[2], q[0], q[1], q[2], k_d, soft, 2.0 * eta_d,
        cohesion, mu, way, before,
    )  # fmt: skip
    size, slip_2 = math.fabs(e_x + b_x), s[0] * s[0]
    stored, old = e_x * e_x, 0.0 if began else p[0] * p[0]
    if not plane:
        size = math.sqrt((e_x + b_x) ** 2 + (e_y + b_y) ** 2 + (e_z + b_z) ** 2)
        slip_2 += s[1] * s[1] + s[2] * s[2]
        stored += e_y * e_y + e_z * e_z
        old += 0.0 if began else p[1] * p[1] + p[2] * p[2]
    # half of the dashpot acts after the kick; of a force at its strength, what the strength is then
    whole = total & (size >= SLIDES * shear_strength(bound if cap_total else e_n, cohesion, mu))
    slides = whole | (share < 1.0)
    of_all = max(kick, 0.0) / bound if whole and cap_total and bound > 0.0 else 1.0
    later = 0.0 if whole else 0.5
    half = half_dashpot(eta_d, m_t, dt) * slip_2 if held and not (drop and slides) else 0.0
    sliding += dashpot if whole else 0.0
    dashpot = 0.0 if whole else half * (2.0 * before / dt)
    h_x, h_y, h_z = of_all * (e_x + b_x), of_all * (e_y + b_y), of_all * (e_z + b_z)
    h = h_x - later * b_x, h_y - later * b_y, h_z - later * b_z
    return (e_x, e_y, e_z), (b_x, b_y, b_z), h, soft * (stored - old), dashpot, sliding, slides
