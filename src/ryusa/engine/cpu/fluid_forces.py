"""Forces of the water on the grains of a block, their work, and the impulse that the water owes."""

from typing import Any

from ryusa.engine.cpu import grain_layout as G
from ryusa.engine.cpu.arrays import GrainArrays
from ryusa.engine.cpu.simd.vec4 import fill4
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import column_forces, profile_drag, torque_over_spin
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.grain_step import (
    flow_force,
    impulse_from_fluid,
    resisted_torque,
    work_of_force,
    work_of_force_in_plane,
)
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, SHEAR, SUBMERGED
from ryusa.model.tally import Term

B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Term.DRAG), int(Term.TORQUE), int(Term.LIFT), int(Term.FLOW)
B_FILM = int(Term.FILM)


@inner(fastmath=FAST)
def fluid_forces(
    variant: KernelVariant, choice: LawChoice, i: int, c: Any, grains: GrainArrays, table: Any
) -> None:
    """Store forces and torques of the water on grain i beside those of contacts."""
    x, v, w, fluid, impulse, film = grains.x, grains.v, grains.w, grains.fluid, grains.impulse, grains.film
    d_x = d_y = d_z = l_x = l_y = l_z = e_x = e_z = turn = 0.0
    submerged = 1.0
    if variant.column:
        submerged = fluid[i, SUBMERGED]
        dry = submerged == 0.0
        added = table[G.ADDED] * submerged  # water moves along with what of a grain is in it
        fill4(table, G.ADDED, added)
        e_x, e_z = flow_force(fluid[i, EXTRA_X], added, fluid[i, A_X]), fluid[i, EXTRA_Z]
        turn = 0.5 * fluid[i, SHEAR]
        if not dry:
            k_d, d_x, d_y, d_z, l_x, l_y, l_z = column_forces(choice, c, x[i, 3], fluid[i], v[i], w[i])
            impulse[i, DRAG] = k_d
    else:
        dry, d_x, d_y, d_z = profile_drag(choice, c, x[i, 3], x[i, 2], v[i, 0], v[i, 1], v[i, 2])
    k_t = 0.0
    if variant.rotation and choice.torque and not dry:
        o_x, o_y, o_z = w[i, 0], w[i, 1] - turn, w[i, 2]
        k_t = torque_over_spin(choice, c, submerged, x[i, 3], o_x, o_y, o_z)
        table[G.TORQUE] = resisted_torque(table[G.TORQUE], k_t, o_x)
        table[G.TORQUE + 1] = resisted_torque(table[G.TORQUE + 1], k_t, o_y)
        table[G.TORQUE + 2] = resisted_torque(table[G.TORQUE + 2], k_t, o_z)
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
    after = 0.5 * dt
    done, pending = work_of_force(half, after, d_x, d_y, d_z, v_x, v_y, v_z, a_x, a_y, a_z)
    account[B_DRAG] += done
    stats[S.PENDING_DRAG] += pending
    if variant.column:
        l_x, l_y, l_z = table[G.LIFT], table[G.LIFT + 1], table[G.LIFT + 2]
        e_x, e_z, added = table[G.FLOW], table[G.FLOW + 2], table[G.ADDED]
        if table[G.FLOW + 3] > 0.0:
            impulse[i, 0] += impulse_from_fluid(d_x, l_x, added, fluid[i, A_X], v_x, a_x, dt)
            impulse[i, 1] += impulse_from_fluid(d_y, l_y, added, 0.0, v_y, a_y, dt)
            impulse[i, 2] += impulse_from_fluid(d_z, l_z, added, 0.0, v_z, a_z, dt)
        done, pending = work_of_force(half, after, l_x, l_y, l_z, v_x, v_y, v_z, a_x, a_y, a_z)
        account[B_LIFT] += done
        stats[S.PENDING_LIFT] += pending
        done, pending = work_of_force_in_plane(half, after, e_x, e_z, v_x, v_z, a_x, a_z)
        account[B_FLOW] += done
        stats[S.PENDING_FLOW] += pending
    if variant.film:
        h_x, h_y, h_z = film[i, 0], film[i, 1], film[i, 2]
        done, pending = work_of_force(half, after, h_x, h_y, h_z, v_x, v_y, v_z, a_x, a_y, a_z)
        account[B_FILM] -= done
        stats[S.PENDING_FILM] += pending
        fill4(film, 4 * i, 0.0)
    k_t = table[G.LIFT + 3]
    if variant.rotation and k_t > 0.0:  # the torque is k_t times the spin against the water
        o_x, o_y, o_z = table[G.W], table[G.W + 1], table[G.W + 2]
        b_x, b_y, b_z = table[G.W_NEW], table[G.W_NEW + 1], table[G.W_NEW + 2]
        o_rel = o_y - table[G.FLOW + 1]
        done, pending = work_of_force(half * k_t, after * k_t, o_x, o_rel, o_z, o_x, o_y, o_z, b_x, b_y, b_z)
        account[B_TORQUE] -= done
        stats[S.PENDING_TORQUE] -= pending
