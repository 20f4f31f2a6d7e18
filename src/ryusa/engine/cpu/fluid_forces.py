"""Water on grains: which law, told by number, and what its forces do; every formula is a law."""
# ruff: noqa: F403, F405  (l is a lane; places and columns of lanes.py, rows.py and immersed.py, all plain integers)

import math
from typing import Any

from ryusa.engine.cpu.arrays import Grains
from ryusa.engine.cpu.batch_layout import *
from ryusa.engine.cpu.simd.vec4 import spread4
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.rows import *
from ryusa.laws.lift import (
    lift_saffman_mei,
    lift_wiberg_smith,
    magnus_loth,
    magnus_oesterle_dinh,
    magnus_rubinow_keller,
)
from ryusa.laws.torque import torque_dennis, torque_stokes
from ryusa.laws.water import log_law_rough, log_law_smooth, uniform
from ryusa.model.enums import Above, Buoyancy, Lift, Magnus, Profile, WaterTorque
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, PHI, SHARE, SHEAR, U, V, W
from ryusa.model.resistance import drag_of, hindered
from ryusa.model.tally import Book

ROUGH, SMOOTH, UNIFORM = int(Profile.LOG_ROUGH), int(Profile.LOG_SMOOTH), int(Profile.UNIFORM)
HOLD, DRY = int(Above.HOLD), int(Above.DRY)
STOKES = int(WaterTorque.STOKES)
STRESS = int(Buoyancy.STRESS)
WIBERG_SMITH, SAFFMAN_MEI = int(Lift.WIBERG_SMITH), int(Lift.SAFFMAN_MEI)
LOTH, OESTERLE_DINH = int(Magnus.LOTH), int(Magnus.OESTERLE_DINH)
B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Book.DRAG), int(Book.TORQUE), int(Book.LIFT), int(Book.FLOW)
B_FILM = int(Book.FILM)


@inner(forceinline=True)
def water_speed(profile: int, above: int, z: float, c: Any) -> float:
    """Speed of the water along x at height z over the zero of the profile [m/s]."""
    if above == HOLD:
        z = min(z, c[C_DEPTH])
    if profile == ROUGH:
        return log_law_rough(z, c[C_U_STAR], c[C_K_ROUGH])
    if profile == SMOOTH:
        return log_law_smooth(z, c[C_U_STAR], c[C_NU])
    if profile == UNIFORM:
        return uniform(z, c[C_U_UNIFORM])
    return 0.0


@inner(forceinline=True)
def water_on(
    choice: Choice, c: Any, r: float, seen: Any, v: Any, w: Any
) -> tuple[float, float, float, float, float, float, float]:
    """Drag over slip [N s/m] of a column of water on one grain, then drag, then lift and Magnus force [N]."""
    d, nu, rho_w, shear = 2.0 * r, c[C_NU], c[C_RHO_W], seen[SHEAR]
    u_x, u_y, u_z = seen[U] - v[0], seen[V] - v[1], seen[W] - v[2]
    slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
    share = seen[SHARE]
    k_d = 0.0
    if choice.drag:
        k_d = share * hindered(
            choice.drag, choice.hindrance, choice.buoyancy == STRESS, c[C_HINDRANCE], slip, seen[PHI],
            d, nu, rho_w, c[C_A_2], c[C_C_D],
        )  # fmt: skip
    l_x = l_y = l_z = 0.0
    if choice.lift == WIBERG_SMITH:
        half = 0.5 * shear * d
        l_z = lift_wiberg_smith(u_x + half, u_x - half, c[C_C_L], rho_w, c[C_A_2], d)
    elif choice.lift == SAFFMAN_MEI:
        k = lift_saffman_mei(slip, shear, d, nu, rho_w)
        l_x, l_z = -k * u_z, k * u_x
    if choice.magnus:
        o_x, o_y, o_z = -w[0], 0.5 * shear - w[1], -w[2]
        spin = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
        if choice.magnus == LOTH:
            k = magnus_loth(slip, spin, d, nu, rho_w)
        elif choice.magnus == OESTERLE_DINH:
            k = magnus_oesterle_dinh(slip, spin, d, nu, rho_w)
        else:
            k = magnus_rubinow_keller(d, rho_w)
        l_x += k * (o_y * u_z - o_z * u_y)
        l_y += k * (o_z * u_x - o_x * u_z)
        l_z += k * (o_x * u_y - o_y * u_x)
    return k_d, k_d * u_x, k_d * u_y, k_d * u_z, share * l_x, share * l_y, share * l_z


@inner()
def close_interval(book: Any, now: Any) -> None:
    """Book the second half of the work of the water in the step before."""
    book[B_DRAG] += now[N_PEND_DRAG]
    book[B_TORQUE] += now[N_PEND_TORQUE]
    book[B_LIFT] += now[N_PEND_LIFT]
    book[B_FLOW] += now[N_PEND_FLOW]
    book[B_FILM] -= now[N_PEND_FILM]
    now[N_PEND_DRAG] = now[N_PEND_TORQUE] = now[N_PEND_LIFT] = now[N_PEND_FLOW] = now[N_PEND_FILM] = 0.0


@inner(fastmath=FAST)
def push_of_water(kind: Variant, choice: Choice, i: int, c: Any, grains: Grains, table: Any) -> None:
    """Lay forces and torques of the water on grain i beside those of contacts."""
    x, v, w, seen, taken, film = grains.x, grains.v, grains.w, grains.seen, grains.taken, grains.film
    d_x = d_y = d_z = l_x = l_y = l_z = e_x = e_z = turn = 0.0
    share = 1.0
    if kind.column:
        share = seen[i, SHARE]
        dry = share == 0.0
        added = table[M_ADDED] * share  # water moves along with what of a grain is in it
        spread4(table, M_ADDED, added)
        e_x, e_z = seen[i, EXTRA_X] + added * seen[i, A_X], seen[i, EXTRA_Z]
        turn = 0.5 * seen[i, SHEAR]
        if not dry:
            k_d, d_x, d_y, d_z, l_x, l_y, l_z = water_on(choice, c, x[i, 3], seen[i], v[i], w[i])
            taken[i, DRAG] = k_d
    else:
        z = x[i, 2] - c[C_Z_ZERO]
        dry = choice.profile == 0 or (choice.above == DRY and z > c[C_DEPTH])
        if choice.drag and not dry:
            u_x, u_y, u_z = water_speed(choice.profile, choice.above, z, c) - v[i, 0], -v[i, 1], -v[i, 2]
            slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
            k_d = drag_of(choice.drag, slip, 2.0 * x[i, 3], c[C_NU], c[C_RHO_W], c[C_A_2], c[C_C_D])
            d_x, d_y, d_z = k_d * u_x, k_d * u_y, k_d * u_z
    k_t = 0.0
    if kind.rotation and choice.torque and not dry:
        o_x, o_y, o_z = w[i, 0], w[i, 1] - turn, w[i, 2]
        size = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
        if choice.torque == STOKES:
            k_t = share * torque_stokes(size, 2.0 * x[i, 3], c[C_NU], c[C_RHO_W])
        else:
            k_t = share * torque_dennis(size, 2.0 * x[i, 3], c[C_NU], c[C_RHO_W])
        table[M_TURN] -= k_t * o_x
        table[M_TURN + 1] -= k_t * o_y
        table[M_TURN + 2] -= k_t * o_z
    if kind.plane_case:
        d_y = l_y = 0.0
    for k, along in enumerate((l_x + e_x, l_y, l_z + e_z)):
        table[M_PUSH + k] += along
        if kind.film:
            table[M_PUSH + k] += film[i, k]
    for k, along in enumerate((d_x, d_y, d_z)):
        table[M_DRAG + k] = along
    for k, along in enumerate((l_x, l_y, l_z)):
        table[M_LIFT + k] = along
    table[M_FLOW], table[M_FLOW + 1], table[M_FLOW + 2] = e_x, turn, e_z
    table[M_LIFT + 3], table[M_FLOW + 3] = k_t, 0.0 if dry else 1.0


@inner(fastmath=FAST)
def work_of_water(
    kind: Variant, choice: Choice, i: int, half: float, c: Any, grains: Grains, table: Any,
    book: Any, now: Any,
) -> None:  # fmt: skip
    """Book the work of the water on grain i in the step, and what they took from it.

    `half` is half a step [s], or nothing in the first. Films are emptied.
    """
    dt, seen, taken, film = c[C_DT], grains.seen, grains.taken, grains.film
    v_x, v_y, v_z = table[M_V], table[M_V + 1], table[M_V + 2]
    a_x, a_y, a_z = table[M_V_NEW], table[M_V_NEW + 1], table[M_V_NEW + 2]
    d_x, d_y, d_z = table[M_DRAG], table[M_DRAG + 1], table[M_DRAG + 2]
    book[B_DRAG] += half * (d_x * v_x + d_y * v_y + d_z * v_z)
    now[N_PEND_DRAG] += 0.5 * dt * (d_x * a_x + d_y * a_y + d_z * a_z)
    if kind.column:
        l_x, l_y, l_z = table[M_LIFT], table[M_LIFT + 1], table[M_LIFT + 2]
        e_x, e_z, added = table[M_FLOW], table[M_FLOW + 2], table[M_ADDED]
        if table[M_FLOW + 3] > 0.0:
            taken[i, 0] += dt * (d_x + l_x + added * seen[i, A_X]) - added * (a_x - v_x)
            taken[i, 1] += dt * (d_y + l_y) - added * (a_y - v_y)
            taken[i, 2] += dt * (d_z + l_z) - added * (a_z - v_z)
        book[B_LIFT] += half * (l_x * v_x + l_y * v_y + l_z * v_z)
        now[N_PEND_LIFT] += 0.5 * dt * (l_x * a_x + l_y * a_y + l_z * a_z)
        book[B_FLOW] += half * (e_x * v_x + e_z * v_z)
        now[N_PEND_FLOW] += 0.5 * dt * (e_x * a_x + e_z * a_z)
    if kind.film:
        h_x, h_y, h_z = film[i, 0], film[i, 1], film[i, 2]
        book[B_FILM] -= half * (h_x * v_x + h_y * v_y + h_z * v_z)
        now[N_PEND_FILM] += 0.5 * dt * (h_x * a_x + h_y * a_y + h_z * a_z)
        spread4(film, 4 * i, 0.0)
    k_t = table[M_LIFT + 3]
    if kind.rotation and k_t > 0.0:
        o_x, o_y, o_z = table[M_W], table[M_W + 1], table[M_W + 2]
        b_x, b_y, b_z = table[M_W_NEW], table[M_W_NEW + 1], table[M_W_NEW + 2]
        o_rel = o_y - table[M_FLOW + 1]
        book[B_TORQUE] -= half * k_t * (o_x * o_x + o_rel * o_y + o_z * o_z)
        now[N_PEND_TORQUE] -= 0.5 * dt * k_t * (o_x * b_x + o_rel * b_y + o_z * b_z)
