"""Forces of the water on one grain by the law that a number names, and the account of its half intervals."""

import math
from typing import Any

from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws._family import numbers
from ryusa.laws.dispatch import drag_of, hindered, magnus, profile_speed, shear_lift, water_torque
from ryusa.laws.families import Above, Buoyancy, Profile
from ryusa.laws.lift import magnus_force, shear_lift_force
from ryusa.model.fluid import PHI, SHEAR, SUBMERGED, U, V, W
from ryusa.model.tally import Term

NO_WATER = int(Profile.NONE)
CONTINUE, HOLD, DRY = numbers(__name__, Above.CONTINUE, Above.HOLD, Above.DRY)
# the column adds what is beyond the weight of the displaced water; only the drag asks for its form
WEIGHT, STRESS, PRESSURE = numbers(__name__, Buoyancy.WEIGHT, Buoyancy.STRESS, Buoyancy.PRESSURE)
B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Term.DRAG), int(Term.TORQUE), int(Term.LIFT), int(Term.FLOW)
B_FILM = int(Term.FILM)
B_STEP, B_DASH_N, B_DASH_S, B_SLIDE = int(Term.STEP), int(Term.DASH_N), int(Term.DASH_S), int(Term.SLIDE)


@inner(fastmath=FAST, forceinline=True)
def height_in_profile(above: int, z: float, z_zero: float, depth: float) -> tuple[float, float]:
    """Height over the zero of a given profile at which its speed is taken [m], and 0 above the water, else 1.

    `z` is the height of the grain [m], `depth` that of the water over `z_zero` [m].
    """
    height = z - z_zero
    there = 0.0 if above == DRY and height > depth else 1.0
    return min(height, depth) if above == HOLD else height, there


@inner(fastmath=FAST, forceinline=True)
def length(x: float, y: float, z: float) -> float:
    """Length of a vector."""
    return math.sqrt(x * x + y * y + z * z)


@inner(forceinline=True)
def column_forces(
    choice: LawChoice, c: Any, r: float, fluid: Any, v: Any, w: Any
) -> tuple[float, float, float, float, float, float, float]:
    """Drag over slip [N s/m] of a column of water on one grain, then drag, then lift and Magnus force [N]."""
    d, nu, rho_w, shear = 2.0 * r, c[P.NU], c[P.RHO_W], fluid[SHEAR]
    u_x, u_y, u_z = fluid[U] - v[0], fluid[V] - v[1], fluid[W] - v[2]
    slip = length(u_x, u_y, u_z)
    share = fluid[SUBMERGED]
    k_d = 0.0
    if choice.drag:
        k_d = share * hindered(
            choice.drag, choice.hindrance, choice.buoyancy == STRESS, c[P.HINDRANCE], slip, fluid[PHI],
            d, nu, rho_w, c[P.A_2], c[P.C_D],
        )  # fmt: skip
    l_x = l_y = l_z = 0.0
    if choice.lift:
        half = 0.5 * shear * d
        normal, k = shear_lift(
            choice.lift, u_x + half, u_x - half, slip, shear, d, nu, rho_w, c[P.A_2], c[P.C_L]
        )
        l_x, l_z = shear_lift_force(normal, k, u_x, u_z)
    if choice.magnus:
        o_x, o_y, o_z = -w[0], 0.5 * shear - w[1], -w[2]
        k = magnus(choice.magnus, slip, length(o_x, o_y, o_z), d, nu, rho_w)
        m_x, m_y, m_z = magnus_force(k, o_x, o_y, o_z, u_x, u_y, u_z)
        l_x, l_y, l_z = l_x + m_x, l_y + m_y, l_z + m_z
    return k_d, k_d * u_x, k_d * u_y, k_d * u_z, share * l_x, share * l_y, share * l_z


@inner(fastmath=FAST)
def profile_drag(
    choice: LawChoice, c: Any, r: float, z: float, v_x: float, v_y: float, v_z: float
) -> tuple[bool, float, float, float]:
    """Whether a grain at height z is out of the water of a given profile, and the drag on it [N]."""
    height, there = height_in_profile(choice.above, z, c[P.Z_ZERO], c[P.DEPTH])
    dry = choice.profile == NO_WATER or there == 0.0
    d_x = d_y = d_z = 0.0
    if choice.drag and not dry:
        speed = profile_speed(choice.profile, height, c[P.U_STAR], c[P.K_ROUGH], c[P.NU], c[P.U_UNIFORM])
        u_x, u_y, u_z = speed - v_x, -v_y, -v_z
        slip = length(u_x, u_y, u_z)
        k_d = drag_of(choice.drag, slip, 2.0 * r, c[P.NU], c[P.RHO_W], c[P.A_2], c[P.C_D])
        d_x, d_y, d_z = k_d * u_x, k_d * u_y, k_d * u_z
    return dry, d_x, d_y, d_z


@inner(fastmath=FAST)
def torque_over_spin(
    choice: LawChoice, c: Any, submerged: float, r: float, o_x: float, o_y: float, o_z: float
) -> float:
    """Torque of the water on a grain over its spin o against the water [N m s]."""
    spin = length(o_x, o_y, o_z)
    return submerged * water_torque(choice.torque, spin, 2.0 * r, c[P.NU], c[P.RHO_W])


@inner(fastmath=FAST)
def close_fluid_interval(account: Any, stats: Any) -> None:
    """Book what belongs to the interval after the last step: of water, and of contacts with exact timing."""
    account[B_DRAG] += stats[S.PENDING_DRAG]
    account[B_TORQUE] += stats[S.PENDING_TORQUE]
    account[B_LIFT] += stats[S.PENDING_LIFT]
    account[B_FLOW] += stats[S.PENDING_FLOW]
    account[B_FILM] -= stats[S.PENDING_FILM]
    account[B_STEP] += stats[S.PENDING_STEP]
    account[B_DASH_N] += stats[S.PENDING_DASH_N]
    account[B_DASH_S] += stats[S.PENDING_DASH_S]
    account[B_SLIDE] += stats[S.PENDING_SLIDE]
    stats[S.PENDING_STEP] = stats[S.PENDING_DASH_N] = stats[S.PENDING_DASH_S] = stats[S.PENDING_SLIDE] = 0.0
    stats[S.PENDING_DRAG] = stats[S.PENDING_TORQUE] = stats[S.PENDING_LIFT] = stats[S.PENDING_FLOW] = stats[
        S.PENDING_FILM
    ] = 0.0
