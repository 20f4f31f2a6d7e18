"""Loops over the grains of one rank: forces of the water by the laws of ryusa, and velocities of half a step.

LAMMPS stores velocities of whole steps between its runs, ryusa those half a step before the positions. Both
use the same scheme: a force at x(n) sees v(n - 1/2).
"""

from typing import Any

from ryusa.compiled.function import FAST, compiled
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import column_forces, profile_drag, torque_over_spin
from ryusa.engine.shared.variant import LawChoice
from ryusa.laws.grain_step import flow_force, impulse_from_fluid, resisted_torque
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, SHEAR, SUBMERGED

# columns of `last`: drag, lift and force of the accelerating water on its added mass in the last force
# evaluation [N]; drag over slip there [N s/m]; velocity when the impulse was counted anew [m/s]
FORCE, K_D, V_BEGIN = 0, 3, 4
SOLID = 0.4  # moment of inertia of a sphere over m R^2, with which LAMMPS turns grains


@compiled(fastmath=FAST)
def complete_forces(
    choice: LawChoice, plane: bool, column: bool, c: Any, own: Any, tag: Any, x: Any, v: Any, w: Any, r: Any,
    mass: Any, contact: Any, f: Any, torque: Any, sampled: Any, last: Any,
) -> None:  # fmt: skip
    """Complete forces and torques of contacts: water, weight, and the inertia of a grain without added mass.

    Parameters
    ----------
    choice, plane, column, c : laws and parameters of the scene, and whether the water is a column.
    own : m, m_added, m_weight [kg] and moment of inertia [kg m2] by id, shape (n_grain, 4).
    tag, x, v, w, r, mass : of the atoms of this rank; velocities are those of half a step before.
    contact : forces and torques of contacts, shape (n, 6).
    f, torque : receive what LAMMPS divides by `mass` and by the inertia of a solid sphere of that mass.
    sampled, last : columns of `model.fluid` and of this module; of a column of water.
    """
    # One function: as `integrate` of the CUDA engine, which it follows line by line
    for i in range(len(tag)):
        grain = tag[i] - 1
        if grain >= len(own):
            continue
        m_bare, added, m_weight, inertia = own[grain, 0], own[grain, 1], own[grain, 2], own[grain, 3]
        f_x, f_y, f_z = contact[i, 0], contact[i, 1], contact[i, 2]
        t_x, t_y, t_z = contact[i, 3], contact[i, 4], contact[i, 5]
        turn, submerged = 0.0, 1.0
        if column:
            submerged = sampled[i, SUBMERGED]
            dry = submerged == 0.0
            added *= submerged
            turn = 0.5 * sampled[i, SHEAR]
            a_x = sampled[i, A_X]
            e_x, e_z = flow_force(sampled[i, EXTRA_X], added, a_x), sampled[i, EXTRA_Z]
            k_d = d_x = d_y = d_z = l_x = l_y = l_z = 0.0
            if not dry:
                k_d, d_x, d_y, d_z, l_x, l_y, l_z = column_forces(choice, c, r[i], sampled[i], v[i], w[i])
                if plane:
                    d_y = l_y = 0.0
            last[i, K_D] = k_d
            last[i, FORCE], last[i, FORCE + 1], last[i, FORCE + 2] = d_x + l_x, d_y + l_y, d_z + l_z
            if not dry:
                last[i, FORCE] += added * a_x
            f_x, f_y, f_z = f_x + l_x + e_x, f_y + l_y, f_z + l_z + e_z
        else:
            dry, d_x, d_y, d_z = profile_drag(choice, c, r[i], x[i, 2], v[i, 0], v[i, 1], v[i, 2])
        scale = mass[i] / (m_bare + added)
        f[i, 0] = scale * (f_x + d_x + m_weight * c[P.G_X])
        f[i, 1] = 0.0 if plane else scale * (f_y + d_y + m_weight * c[P.G_Y])
        f[i, 2] = scale * (f_z + d_z + m_weight * c[P.G_Z])
        o_y = w[i, 1] - turn
        if choice.torque and not dry:
            k_t = torque_over_spin(choice, c, submerged, r[i], w[i, 0], o_y, w[i, 2])
            t_x, t_z = resisted_torque(t_x, k_t, w[i, 0]), resisted_torque(t_z, k_t, w[i, 2])
            t_y = resisted_torque(t_y, k_t, o_y)
        scale = SOLID * mass[i] * r[i] * r[i] / inertia
        torque[i, 0] = 0.0 if plane else scale * t_x
        torque[i, 1] = scale * t_y
        torque[i, 2] = 0.0 if plane else scale * t_z


@compiled()
def count_impulse(tag: Any, n_grain: int, dt: float, last: Any, impulse: Any) -> None:
    """Add the impulse of the forces of the last evaluation, which have acted for a step now."""
    for i in range(len(tag)):
        if tag[i] <= n_grain:
            for k in range(3):
                impulse[i, k] += dt * last[i, FORCE + k]
            impulse[i, DRAG] = last[i, K_D]


@compiled()
def taken_from_water(
    tag: Any, own: Any, v_half: Any, sampled: Any, impulse: Any, last: Any, out: Any
) -> None:
    """Impulse on each grain since it was counted anew, less that of its added mass (model.fluid)."""
    for i in range(len(tag)):
        grain = tag[i] - 1
        if grain >= len(own):
            continue
        added = own[grain, 1] * sampled[i, SUBMERGED]
        for k in range(3):
            out[i, k] = impulse[i, k] + impulse_from_fluid(
                0.0, 0.0, added, 0.0, last[i, V_BEGIN + k], v_half[i, k], 0.0
            )
        out[i, DRAG] = impulse[i, DRAG]


@compiled()
def shift_velocities(
    tag: Any, n_grain: int, turns: bool, dt: float, mass: Any, r: Any, f: Any, torque: Any, v: Any, w: Any
) -> None:
    """Move velocities and spins of free grains by dt [s] under the present forces."""
    for i in range(len(tag)):
        if tag[i] <= n_grain:
            for k in range(3):
                v[i, k] += dt * f[i, k] / mass[i]
                if turns:
                    w[i, k] += dt * torque[i, k] / (SOLID * mass[i] * r[i] * r[i])
