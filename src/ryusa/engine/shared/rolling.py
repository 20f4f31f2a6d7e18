"""Rolling friction of one pair, with its energy account."""

import math
from typing import Any

from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, kernel
from ryusa.laws._family import numbers
from ryusa.laws.dispatch import rolling_alike, rolling_length
from ryusa.laws.families import Rolling
from ryusa.laws.geometry import turn
from ryusa.laws.rolling import (
    epsd_damping,
    epsd_spring,
    epsd_stiffness,
    epsd_torque,
    inertia_rolling,
    inertia_spin,
    reduced_radius,
    rolling_constant,
    rolling_limited,
    rolling_printed,
    slider_scale,
    twisting_cap,
)
from ryusa.model.tally import Term

Vector = tuple[float, float, float]
# Radius, mass with added mass, inertia, contacts that share the inertia
Body = tuple[float, float, float, float]

NONE, PRINTED, CONSTANT, EPSD, LIMITED = numbers(
    __name__, Rolling.NONE, Rolling.PRINTED, Rolling.CONSTANT, Rolling.EPSD, Rolling.LIMITED
)
B_ROLL, B_RELEASED_R = int(Term.ROLL), int(Term.RELEASED_R)


@kernel(fastmath=FAST, forceinline=True)
def rolling_friction(
    model: int,
    arms: int,
    row: Any,
    c: Any,
    f_n: float,
    overlap: float,
    hdt: float,
    body_i: Body,
    body_j: Body,
    n: Vector,
    t: Vector,
    w_i: Vector,
    w_j: Vector,
    account: Any,
) -> tuple[float, float, float, float]:
    """Rolling and twisting friction of one contact: torque on grain i [N m], energy in its spring [J].

    `t` is n x F, the direction in which the tangential force turns both grains; Eq. (13), as printed or
    limited, opposes it on each of the two. The other models oppose the relative spin and give the
    opposite torque to j.
    """
    # One function: the models share arm, cap, relative spin and account
    r_i, m_i, inertia_i, share_i = body_i
    r_j, m_j, inertia_j, share_j = body_j
    dt, k_n = c[P.DT], c[P.K_N]
    sign = 1.0 if rolling_alike(model) else -1.0
    s_x, s_y, s_z = w_i[0] + sign * w_j[0], w_i[1] + sign * w_j[1], w_i[2] + sign * w_j[2]
    along = s_x * n[0] + s_y * n[1] + s_z * n[2]
    s_x, s_y, s_z = s_x - along * n[0], s_y - along * n[1], s_z - along * n[2]
    f = c[P.ROLLING] * rolling_length(arms, r_i, r_j, overlap)
    cap = rolling_printed(f_n, f)
    e_x = e_y = e_z = 0.0  # spring
    q_x = q_y = q_z = 0.0  # the rest
    energy = stored = 0.0
    p_x, p_y, p_z = row[M.SPRING_R], row[M.SPRING_R + 1], row[M.SPRING_R + 2]
    if rolling_alike(model):  # PRINTED or LIMITED
        size = math.sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
        if model == LIMITED:  # the same torque on both grains, so not beyond that of the shorter arm
            cap = rolling_limited(cap, size * min(r_i, r_j))
        if size > 0.0:
            q_x, q_y, q_z = -cap * t[0] / size, -cap * t[1] / size, -cap * t[2] / size
    elif model == CONSTANT:
        size = math.sqrt(s_x * s_x + s_y * s_y + s_z * s_z)
        if size > 0.0:
            # several contacts brake one grain at once: each may take its share of the inertia
            most = rolling_constant(cap, size, inertia_spin(inertia_i / share_i, inertia_j / share_j), dt)
            q_x, q_y, q_z = -most * s_x / size, -most * s_y / size, -most * s_z / size
    elif model == EPSD:
        k_r = epsd_stiffness(k_n, f, c[P.ROLLING_STIFFNESS])
        eta_r = epsd_damping(
            k_r, inertia_rolling(m_i, r_i, inertia_i, m_j, r_j, inertia_j), c[P.ROLLING_ZETA]
        )
        twist = 0.5 * dt * ((w_i[0] + w_j[0]) * n[0] + (w_i[1] + w_j[1]) * n[1] + (w_i[2] + w_j[2]) * n[2])
        p_x, p_y, p_z = turn(p_x, p_y, p_z, n[0], n[1], n[2], twist)
        e_x, e_y, e_z = (
            epsd_spring(p_x, s_x, k_r, dt),
            epsd_spring(p_y, s_y, k_r, dt),
            epsd_spring(p_z, s_z, k_r, dt),
        )
        scale = slider_scale(math.sqrt(e_x * e_x + e_y * e_y + e_z * e_z), cap)
        e_x, e_y, e_z = scale * e_x, scale * e_y, scale * e_z
        q_x = epsd_torque(e_x, s_x, eta_r, scale) - e_x
        q_y = epsd_torque(e_y, s_y, eta_r, scale) - e_y
        q_z = epsd_torque(e_z, s_z, eta_r, scale) - e_z
        if k_r > 0.0:
            energy = 0.5 * (e_x * e_x + e_y * e_y + e_z * e_z) / k_r
            stored = 0.5 * (p_x * p_x + p_y * p_y + p_z * p_z) / k_r
        taken = -hdt * (s_x * (p_x + e_x) + s_y * (p_y + e_y) + s_z * (p_z + e_z))
        if f_n <= 0.0:
            account[B_RELEASED_R] += taken + stored - energy
        elif scale < 1.0:
            account[B_ROLL] += taken + stored - energy
    elif model != NONE:
        q_x = q_y = q_z = math.nan  # `refusals` names such a model before any step
    if c[P.TWISTING] > 0.0:  # about the normal; with it the account is that of the whole relative spin
        twisting = twisting_torque(f_n, along, c[P.TWISTING], body_i, body_j, dt)
        q_x, q_y, q_z = q_x + twisting * n[0], q_y + twisting * n[1], q_z + twisting * n[2]
        s_x, s_y, s_z = s_x + along * n[0], s_y + along * n[1], s_z + along * n[2]
    account[B_ROLL] -= hdt * (
        s_x * (row[M.DASH_R] + q_x) + s_y * (row[M.DASH_R + 1] + q_y) + s_z * (row[M.DASH_R + 2] + q_z)
    )
    row[M.SPRING_R], row[M.SPRING_R + 1], row[M.SPRING_R + 2] = e_x, e_y, e_z
    row[M.DASH_R], row[M.DASH_R + 1], row[M.DASH_R + 2] = q_x, q_y, q_z
    return e_x + q_x, e_y + q_y, e_z + q_z, energy


@kernel(fastmath=FAST, forceinline=True)
def twisting_torque(
    f_n: float, along: float, coefficient: float, body_i: Body, body_j: Body, dt: float
) -> float:
    """Torque about the normal [N m] against the relative spin `along` it [rad/s], which it cannot reverse."""
    inertia = inertia_spin(body_i[2] / body_i[3], body_j[2] / body_j[3])
    limit = twisting_cap(f_n, coefficient, reduced_radius(body_i[0], body_j[0]))
    return -math.copysign(rolling_constant(limit, along, inertia, dt), along)


@kernel(fastmath=FAST, forceinline=True)
def end_rolling(
    rolling: int, row: Any, c: Any, hdt: float, w_i: Vector, w_j: Vector, radius: float, account: Any
) -> None:
    """Close the rolling account of a pair that parted: the last half interval, and what its spring held.

    `rolling` is the model, `radius` the reduced radius of the pair [m]; its part of the row is emptied.
    """
    sign = 1.0 if rolling_alike(rolling) else -1.0
    w_x, w_y, w_z = w_i[0] + sign * w_j[0], w_i[1] + sign * w_j[1], w_i[2] + sign * w_j[2]
    e_x, e_y, e_z = row[M.SPRING_R], row[M.SPRING_R + 1], row[M.SPRING_R + 2]
    k_r = epsd_stiffness(c[P.K_N], c[P.ROLLING] * radius, c[P.ROLLING_STIFFNESS])
    if rolling == EPSD and k_r > 0.0:
        account[B_RELEASED_R] += 0.5 * (e_x * e_x + e_y * e_y + e_z * e_z) / k_r
    account[B_RELEASED_R] -= hdt * (w_x * e_x + w_y * e_y + w_z * e_z)
    account[B_ROLL] -= hdt * (w_x * row[M.DASH_R] + w_y * row[M.DASH_R + 1] + w_z * row[M.DASH_R + 2])
    for k in range(M.SPRING_R, M.END_ROLLING):
        row[k] = 0.0
