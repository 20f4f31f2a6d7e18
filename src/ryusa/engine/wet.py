"""Water on one grain: which law, told by number; every formula is a law."""
# ruff: noqa: F403, F405  (the columns of rows.py and immersed.py, all of them plain integers)

import math
from typing import Any

from ryusa.engine._kernel import kernel
from ryusa.engine.rows import *
from ryusa.laws.lift import (
    lift_saffman_mei,
    lift_wiberg_smith,
    magnus_loth,
    magnus_oesterle_dinh,
    magnus_rubinow_keller,
)
from ryusa.laws.water import log_law_rough, log_law_smooth, uniform
from ryusa.model.enums import Above, Buoyancy, Lift, Magnus, Profile
from ryusa.model.immersed import PHI, SHARE, SHEAR, U, V, W
from ryusa.model.resistance import hindered

ROUGH, SMOOTH, UNIFORM = int(Profile.LOG_ROUGH), int(Profile.LOG_SMOOTH), int(Profile.UNIFORM)
HOLD = int(Above.HOLD)
STRESS = int(Buoyancy.STRESS)
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
