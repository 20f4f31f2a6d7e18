"""Water on one grain: which law, told by number; every formula is a law."""
# ruff: noqa: F403, F405  (the columns of rows.py and immersed.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine._kernel import kernel
from ryusa.engine.rows import *
from ryusa.laws.drag import (
    c_d_ferguson_church_sand,
    c_d_ferguson_church_sphere,
    c_d_re_04,
    c_d_re_2,
    c_d_schiller_naumann,
    drag_factor,
    reynolds,
)
from ryusa.laws.hindrance import di_felice, gidaspow, power, richardson_zaki, wen_yu
from ryusa.laws.lift import (
    lift_saffman_mei,
    lift_wiberg_smith,
    magnus_loth,
    magnus_oesterle_dinh,
    magnus_rubinow_keller,
)
from ryusa.laws.water import log_law_rough, log_law_smooth, uniform
from ryusa.model.enums import Above, Buoyancy, Drag, Hindrance, Lift, Magnus, Profile
from ryusa.model.immersed import PHI, SHARE, SHEAR, U, V, W

ROUGH, SMOOTH, UNIFORM = int(Profile.LOG_ROUGH), int(Profile.LOG_SMOOTH), int(Profile.UNIFORM)
HOLD = int(Above.HOLD)
D_CONSTANT, D_04, D_2 = int(Drag.CONSTANT), int(Drag.RE_04), int(Drag.RE_2)
D_SN, D_FC_SPHERE = int(Drag.SCHILLER_NAUMANN), int(Drag.FERGUSON_CHURCH_SPHERE)
RICHARDSON_ZAKI, POWER, WEN_YU = int(Hindrance.RICHARDSON_ZAKI), int(Hindrance.POWER), int(Hindrance.WEN_YU)
GIDASPOW, DI_FELICE, STRESS = int(Hindrance.GIDASPOW), int(Hindrance.DI_FELICE), int(Buoyancy.STRESS)
WIBERG_SMITH, SAFFMAN_MEI = int(Lift.WIBERG_SMITH), int(Lift.SAFFMAN_MEI)
LOTH, OESTERLE_DINH = int(Magnus.LOTH), int(Magnus.OESTERLE_DINH)


@kernel(forceinline=True)
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


@kernel(forceinline=True)
def drag_of(law: int, speed: float, d: float, c: Any) -> float:
    """Drag over relative velocity [N s/m]."""
    if speed == 0.0:
        return 0.0
    re = reynolds(speed, d, c[C_NU])
    if law == D_CONSTANT:
        c_d = c[C_C_D]
    elif law == D_04:
        c_d = c_d_re_04(re)
    elif law == D_2:
        c_d = c_d_re_2(re)
    elif law == D_SN:
        c_d = c_d_schiller_naumann(re)
    elif law == D_FC_SPHERE:
        c_d = c_d_ferguson_church_sphere(re)
    else:
        c_d = c_d_ferguson_church_sand(re)
    return drag_factor(speed, c_d, c[C_RHO_W], c[C_A_2], d)


@kernel(forceinline=True)
def hindered(choice: Choice, slip: float, d: float, phi: float, c: Any) -> float:
    """Drag over relative velocity among neighbours [N s/m]."""
    if slip == 0.0:
        return 0.0
    law, stress, eps = choice.hindrance, choice.buoyancy == STRESS, 1.0 - phi
    speed, factor = slip, 1.0
    if law == RICHARDSON_ZAKI:
        speed, factor = richardson_zaki(slip, eps, c[C_HINDRANCE], stress)
    elif law == POWER:
        speed, factor = power(slip, eps, c[C_HINDRANCE])
    elif law == WEN_YU:
        speed, factor = wen_yu(slip, eps, stress)
    elif law == GIDASPOW:
        speed, factor = gidaspow(slip, eps, d, c[C_NU], stress)
    elif law == DI_FELICE:
        speed, factor = di_felice(slip, eps, d, c[C_NU], stress)
    return factor * drag_of(choice.drag, speed, d, c) * speed / slip


@kernel(forceinline=True)
def water_on(
    choice: Choice, c: Any, r: float, seen: Any, v: Any, w: Any
) -> tuple[float, float, float, float, float, float, float]:
    """Drag over slip [N s/m] of a column of water on one grain, then drag, then lift and Magnus force [N]."""
    d, nu, rho_w, shear = 2.0 * r, c[C_NU], c[C_RHO_W], seen[SHEAR]
    u_x, u_y, u_z = seen[U] - v[0], seen[V] - v[1], seen[W] - v[2]
    slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
    share = seen[SHARE]
    k_d = share * hindered(choice, slip, d, seen[PHI], c) if choice.drag else 0.0
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
