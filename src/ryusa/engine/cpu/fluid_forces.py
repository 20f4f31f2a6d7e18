"""Forces of the water on the grains of a block, their work, and the impulse that the water owes."""

import math
from typing import Any

from ryusa.engine.cpu import grain_layout as G
from ryusa.engine.cpu.arrays import GrainArrays
from ryusa.engine.cpu.simd.vec4 import fill4
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import column_forces, water_speed
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.torque import torque_dennis, torque_stokes
from ryusa.model.enums import Above, WaterTorque
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, SHEAR, SUBMERGED
from ryusa.model.resistance import drag_of
from ryusa.model.tally import Book

DRY = int(Above.DRY)
STOKES = int(WaterTorque.STOKES)
B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Book.DRAG), int(Book.TORQUE), int(Book.LIFT), int(Book.FLOW)
B_FILM = int(Book.FILM)


@inner(fastmath=FAST)
def fluid_forces(
    variant: KernelVariant, choice: LawChoice, i: int, c: Any, grains: GrainArrays, table: Any
) -> None:
    """Lay forces and torques of the water on grain i beside those of contacts."""
    x, v, w, fluid, impulse, film = grains.x, grains.v, grains.w, grains.fluid, grains.impulse, grains.film
    d_x = d_y = d_z = l_x = l_y = l_z = e_x = e_z = turn = 0.0
    share = 1.0
    if variant.column:
        share = fluid[i, SUBMERGED]
        dry = share == 0.0
        added = table[G.ADDED] * share  # water moves along with what of a grain is in it
        fill4(table, G.ADDED, added)
        e_x, e_z = fluid[i, EXTRA_X] + added * fluid[i, A_X], fluid[i, EXTRA_Z]
        turn = 0.5 * fluid[i, SHEAR]
        if not dry:
            k_d, d_x, d_y, d_z, l_x, l_y, l_z = column_forces(choice, c, x[i, 3], fluid[i], v[i], w[i])
            impulse[i, DRAG] = k_d
    else:
        z = x[i, 2] - c[P.Z_ZERO]
        dry = choice.profile == 0 or (choice.above == DRY and z > c[P.DEPTH])
        if choice.drag and not dry:
            u_x, u_y, u_z = water_speed(choice.profile, choice.above, z, c) - v[i, 0], -v[i, 1], -v[i, 2]
            slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
            k_d = drag_of(choice.drag, slip, 2.0 * x[i, 3], c[P.NU], c[P.RHO_W], c[P.A_2], c[P.C_D])
            d_x, d_y, d_z = k_d * u_x, k_d * u_y, k_d * u_z
    k_t = 0.0
    if variant.rotation and choice.torque and not dry:
        o_x, o_y, o_z = w[i, 0], w[i, 1] - turn, w[i, 2]
        size = math.sqrt(o_x * o_x + o_y * o_y + o_z * o_z)
        if choice.torque == STOKES:
            k_t = share * torque_stokes(size, 2.0 * x[i, 3], c[P.NU], c[P.RHO_W])
        else:
            k_t = share * torque_dennis(size, 2.0 * x[i, 3], c[P.NU], c[P.RHO_W])
        table[G.TORQUE] -= k_t * o_x
        table[G.TORQUE + 1] -= k_t * o_y
        table[G.TORQUE + 2] -= k_t * o_z
    if variant.plane_case:
        d_y = l_y = 0.0
    for k, along in enumerate((l_x + e_x, l_y, l_z + e_z)):
        table[G.FORCE + k] += along
        if variant.film:
            table[G.FORCE + k] += film[i, k]
    for k, along in enumerate((d_x, d_y, d_z)):
        table[G.DRAG + k] = along
    for k, along in enumerate((l_x, l_y, l_z)):
        table[G.LIFT + k] = along
    table[G.FLOW], table[G.FLOW + 1], table[G.FLOW + 2] = e_x, turn, e_z
    table[G.LIFT + 3], table[G.FLOW + 3] = k_t, 0.0 if dry else 1.0


@inner(fastmath=FAST)
def fluid_work(
    variant: KernelVariant, choice: LawChoice, i: int, half: float, c: Any, grains: GrainArrays, table: Any,
    account: Any, stats: Any,
) -> None:  # fmt: skip
    """Book the work of the water on grain i in the step, and what they took from it.

    `half` is half a step [s], or nothing in the first. Films are emptied.
    """
    dt, fluid, impulse, film = c[P.DT], grains.fluid, grains.impulse, grains.film
    v_x, v_y, v_z = table[G.V], table[G.V + 1], table[G.V + 2]
    a_x, a_y, a_z = table[G.V_NEW], table[G.V_NEW + 1], table[G.V_NEW + 2]
    d_x, d_y, d_z = table[G.DRAG], table[G.DRAG + 1], table[G.DRAG + 2]
    account[B_DRAG] += half * (d_x * v_x + d_y * v_y + d_z * v_z)
    stats[S.PENDING_DRAG] += 0.5 * dt * (d_x * a_x + d_y * a_y + d_z * a_z)
    if variant.column:
        l_x, l_y, l_z = table[G.LIFT], table[G.LIFT + 1], table[G.LIFT + 2]
        e_x, e_z, added = table[G.FLOW], table[G.FLOW + 2], table[G.ADDED]
        if table[G.FLOW + 3] > 0.0:
            impulse[i, 0] += dt * (d_x + l_x + added * fluid[i, A_X]) - added * (a_x - v_x)
            impulse[i, 1] += dt * (d_y + l_y) - added * (a_y - v_y)
            impulse[i, 2] += dt * (d_z + l_z) - added * (a_z - v_z)
        account[B_LIFT] += half * (l_x * v_x + l_y * v_y + l_z * v_z)
        stats[S.PENDING_LIFT] += 0.5 * dt * (l_x * a_x + l_y * a_y + l_z * a_z)
        account[B_FLOW] += half * (e_x * v_x + e_z * v_z)
        stats[S.PENDING_FLOW] += 0.5 * dt * (e_x * a_x + e_z * a_z)
    if variant.film:
        h_x, h_y, h_z = film[i, 0], film[i, 1], film[i, 2]
        account[B_FILM] -= half * (h_x * v_x + h_y * v_y + h_z * v_z)
        stats[S.PENDING_FILM] += 0.5 * dt * (h_x * a_x + h_y * a_y + h_z * a_z)
        fill4(film, 4 * i, 0.0)
    k_t = table[G.LIFT + 3]
    if variant.rotation and k_t > 0.0:
        o_x, o_y, o_z = table[G.W], table[G.W + 1], table[G.W + 2]
        b_x, b_y, b_z = table[G.W_NEW], table[G.W_NEW + 1], table[G.W_NEW + 2]
        o_rel = o_y - table[G.FLOW + 1]
        account[B_TORQUE] -= half * k_t * (o_x * o_x + o_rel * o_y + o_z * o_z)
        stats[S.PENDING_TORQUE] -= 0.5 * dt * k_t * (o_x * b_x + o_rel * b_y + o_z * b_z)
