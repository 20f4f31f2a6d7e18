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
from ryusa.model.fluid import PHI, SHEAR, SUBMERGED, U, V, W
from ryusa.model.tally import Term

NO_WATER = int(Profile.NONE)
CONTINUE, HOLD, DRY = numbers(__name__, Above.CONTINUE, Above.HOLD, Above.DRY)
# the column adds what is beyond the weight of the displaced water; only the drag asks for its form
WEIGHT, STRESS, PRESSURE = numbers(__name__, Buoyancy.WEIGHT, Buoyancy.STRESS, Buoyancy.PRESSURE)
B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Term.DRAG), int(Term.TORQUE), int(Term.LIFT), int(Term.FLOW)
B_FILM = int(Term.FILM)


@inner(forceinline=True)
def water_speed(profile: int, above: int, z: float, c: Any) -> float:
    """Speed of the water along x at height z over the zero of the profile [m/s]."""
    if above == HOLD:
        z = min(z, c[P.DEPTH])
    return profile_speed(profile, z, c[P.U_STAR], c[P.K_ROUGH], c[P.NU], c[P.U_UNIFORM])


@inner(forceinline=True)
def column_forces(
    choice: LawChoice, c: Any, r: float, fluid: Any, v: Any, w: Any
) -> tuple[float, float, float, float, float, float, float]:
    """Drag over slip [N s/m] of a column of water on one grain, then drag, then lift and Magnus force [N]."""
    d, nu, rho_w, shear = 2.0 * r, c[P.NU], c[P.RHO_W], fluid[SHEAR]
    u_x, u_y, u_z = fluid[U] - v[0], fluid[V] - v[1], fluid[W] - v[2]
    slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
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
        l_x, l_z = -k * u_z, normal + k * u_x
    if choice.magnus:
        o_x, o_y, o_z = -w[0], 0.5 * shear - w[1], -w[2]
        spin = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
        k = magnus(choice.magnus, slip, spin, d, nu, rho_w)
        l_x += k * (o_y * u_z - o_z * u_y)
        l_y += k * (o_z * u_x - o_x * u_z)
        l_z += k * (o_x * u_y - o_y * u_x)
    return k_d, k_d * u_x, k_d * u_y, k_d * u_z, share * l_x, share * l_y, share * l_z


@inner(fastmath=FAST)
def profile_drag(
    choice: LawChoice, c: Any, r: float, z: float, v_x: float, v_y: float, v_z: float
) -> tuple[bool, float, float, float]:
    """Whether a grain at height z is out of the water of a given profile, and the drag on it [N]."""
    z = z - c[P.Z_ZERO]
    dry = choice.profile == NO_WATER or (choice.above == DRY and z > c[P.DEPTH])
    d_x = d_y = d_z = 0.0
    if choice.drag and not dry:
        u_x, u_y, u_z = water_speed(choice.profile, choice.above, z, c) - v_x, -v_y, -v_z
        slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
        k_d = drag_of(choice.drag, slip, 2.0 * r, c[P.NU], c[P.RHO_W], c[P.A_2], c[P.C_D])
        d_x, d_y, d_z = k_d * u_x, k_d * u_y, k_d * u_z
    return dry, d_x, d_y, d_z


@inner(fastmath=FAST)
def torque_over_spin(
    choice: LawChoice, c: Any, submerged: float, r: float, o_x: float, o_y: float, o_z: float
) -> float:
    """Torque of the water on a grain over its spin o against the water [N m s]."""
    spin = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
    return submerged * water_torque(choice.torque, spin, 2.0 * r, c[P.NU], c[P.RHO_W])


@inner()
def close_fluid_interval(account: Any, stats: Any) -> None:
    """Book the second half of the work of the water in the step before."""
    account[B_DRAG] += stats[S.PENDING_DRAG]
    account[B_TORQUE] += stats[S.PENDING_TORQUE]
    account[B_LIFT] += stats[S.PENDING_LIFT]
    account[B_FLOW] += stats[S.PENDING_FLOW]
    account[B_FILM] -= stats[S.PENDING_FILM]
    stats[S.PENDING_DRAG] = stats[S.PENDING_TORQUE] = stats[S.PENDING_LIFT] = stats[S.PENDING_FLOW] = stats[
        S.PENDING_FILM
    ] = 0.0
