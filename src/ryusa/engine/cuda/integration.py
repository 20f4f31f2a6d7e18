"""One grain: numbers gathered for its step (laws/grain_step.py), and put back."""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.arrays import DeviceGrainArrays
from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import column_forces, profile_drag, torque_over_spin
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.grain_step import (
    flow_force,
    impulse_from_fluid,
    kinetic_energy,
    potential_energy,
    resisted_torque,
    rotation_step,
    translation_step,
    unwrapped,
    work_of_force,
)
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, SHEAR, SUBMERGED
from ryusa.model.tally import Term

B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Term.DRAG), int(Term.TORQUE), int(Term.LIFT), int(Term.FLOW)
B_FILM, B_STEP = int(Term.FILM), int(Term.STEP)

Vector = tuple[float, float, float]
_column_forces, _profile_drag = on_device(column_forces), on_device(profile_drag)
_torque_over_spin = on_device(torque_over_spin)


@device
def _work(before: float, after: float, f: Vector, v: Vector, v_new: Vector) -> tuple[float, float]:
    """Work of a force over both half intervals [J], `work_of_force` of all components."""
    x, x_next = work_of_force(before, after, f[0], v[0], v_new[0])
    y, y_next = work_of_force(before, after, f[1], v[1], v_new[1])
    z, z_next = work_of_force(before, after, f[2], v[2], v_new[2])
    return x + y + z, x_next + y_next + z_next


@cache
def make_integrate(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the motion of one grain for one variant."""
    plane_case, rotation, column, film = variant.plane_case, variant.rotation, variant.column, variant.film
    drag, torque_law, exact = choice.drag, choice.torque, variant.exact

    @device
    def integrate(
        i: int,
        half: int,
        first: bool,
        last: bool,
        c: Any,
        bodies: DeviceGrainArrays,
        force: Vector,
        torque: Vector,
        from_film: Vector,
        totals: Any,
    ) -> None:
        """Move the grain at place i by one step, from `half` of its arrays to the other.

        With exact timing it gets its velocities alone: it moves after the shear of its contacts.

        Parameters
        ----------
        first, last : whether this is the first step of the run, and the last of a call.
        force, torque : of its contacts [N], [N m].
        from_film : force of films of water [N].
        """
        # One function: forces stay in the 209 to 255 registers of `step` (design/0009) until booked
        other = 1 - half
        x, v, w, image, fluid, impulse = (
            bodies.x[half], bodies.v[half], bodies.w[half], bodies.image, bodies.fluid, bodies.impulse,
        )  # fmt: skip
        dt = c[P.DT]
        before, after = 0.0 if first else 0.5 * dt, 0.5 * dt
        f_x, f_y, f_z = force
        t_x, t_y, t_z = torque
        h_x, h_y, h_z = from_film
        x_i, y_i, z_i = x[i, 0], x[i, 1], x[i, 2]
        v_x, v_y, v_z = v[i, 0], v[i, 1], v[i, 2]
        o_x, o_y, o_z, r = w[i, 0], w[i, 1], w[i, 2], w[i, 3]
        l_x = l_y = l_z = e_x = e_z = turn = 0.0
        submerged = 1.0
        m_bare, m_weight = bodies.m_bare[i], bodies.m_weight[i]
        added = bodies.m[i] - m_bare
        if column:
            submerged = fluid[i, SUBMERGED]
            dry = submerged == 0.0
            added *= submerged  # water moves along with what of a grain is in it
            e_x, e_z = flow_force(fluid[i, EXTRA_X], added, fluid[i, A_X]), fluid[i, EXTRA_Z]
            turn = 0.5 * fluid[i, SHEAR]
            d_x = d_y = d_z = 0.0
            if not dry:
                k_d, d_x, d_y, d_z, l_x, l_y, l_z = _column_forces(choice, c, r, fluid[i], v[i], w[i])
                impulse[i, DRAG] = k_d
        else:
            dry, d_x, d_y, d_z = _profile_drag(choice, c, r, z_i, v_x, v_y, v_z)
        if plane_case:
            d_y = l_y = 0.0
        if column:
            f_x, f_y, f_z = f_x + (l_x + e_x), f_y + l_y, f_z + (l_z + e_z)
        if film:
            f_x, f_y, f_z = f_x + h_x, f_y + h_y, f_z + h_z

        inverse_m = 1.0 / (m_bare + added)
        x_new, u_x = translation_step(x_i, v_x, f_x, d_x, m_weight * c[P.G_X], inverse_m, dt)
        z_new, u_z = translation_step(z_i, v_z, f_z, d_z, m_weight * c[P.G_Z], inverse_m, dt)
        y_new, u_y = y_i, v_y
        if not plane_case:
            y_new, u_y = translation_step(y_i, v_y, f_y, d_y, m_weight * c[P.G_Y], inverse_m, dt)
        to_x, to_v = bodies.x[other], bodies.v[other]
        if exact:
            to_x[i, 0], to_x[i, 1], to_x[i, 2] = x_i, y_i, z_i
        else:
            to_x[i, 0], to_x[i, 1], to_x[i, 2] = x_new, y_new, z_new
        to_v[i, 0], to_v[i, 1], to_v[i, 2] = u_x, u_y, u_z
        square = u_x * u_x + u_y * u_y + u_z * u_z
        bad = not square < math.inf
        if exact:
            totals[T.KICKED_2] = max(totals[T.KICKED_2], square)
            done, pending = _work(before, after, force, (v_x, v_y, v_z), (u_x, u_y, u_z))
            totals[B_STEP] += done
            totals[T.PENDING_STEP] += pending
        else:
            totals[T.SPEED_2] = max(totals[T.SPEED_2], square)

        if drag:
            done, pending = _work(before, after, (d_x, d_y, d_z), (v_x, v_y, v_z), (u_x, u_y, u_z))
            totals[B_DRAG] += done
            totals[T.PENDING_DRAG] += pending
        if column:
            if not dry:
                impulse[i, 0] += impulse_from_fluid(d_x, l_x, added, fluid[i, A_X], v_x, u_x, dt)
                impulse[i, 1] += impulse_from_fluid(d_y, l_y, added, 0.0, v_y, u_y, dt)
                impulse[i, 2] += impulse_from_fluid(d_z, l_z, added, 0.0, v_z, u_z, dt)
            done, pending = _work(before, after, (l_x, l_y, l_z), (v_x, v_y, v_z), (u_x, u_y, u_z))
            totals[B_LIFT] += done
            totals[T.PENDING_LIFT] += pending
            done, pending = _work(before, after, (e_x, 0.0, e_z), (v_x, v_y, v_z), (u_x, u_y, u_z))
            totals[B_FLOW] += done
            totals[T.PENDING_FLOW] += pending
        if film:
            done, pending = _work(before, after, (h_x, h_y, h_z), (v_x, v_y, v_z), (u_x, u_y, u_z))
            totals[B_FILM] -= done
            totals[T.PENDING_FILM] += pending

        b_x, b_y, b_z = o_x, o_y, o_z
        if rotation:
            o_rel, k_t = o_y - turn, 0.0
            if torque_law and not dry:
                k_t = _torque_over_spin(choice, c, submerged, r, o_x, o_rel, o_z)
                t_x, t_z = resisted_torque(t_x, k_t, o_x), resisted_torque(t_z, k_t, o_z)
                t_y = resisted_torque(t_y, k_t, o_rel)
            inertia = bodies.inertia[i]
            b_y = rotation_step(o_y, t_y, 1.0 / inertia, dt)
            if not plane_case:
                b_x, b_z = (
                    rotation_step(o_x, t_x, 1.0 / inertia, dt),
                    rotation_step(o_z, t_z, 1.0 / inertia, dt),
                )
            spin_2 = b_x * b_x + b_y * b_y + b_z * b_z
            bad = bad or not spin_2 < math.inf
            totals[T.SPIN_2] = max(totals[T.SPIN_2], spin_2)
            if torque_law and not dry:  # the torque is k_t times the spin against the water
                done, pending = _work(
                    before * k_t, after * k_t, (o_x, o_rel, o_z), (o_x, o_y, o_z), (b_x, b_y, b_z)
                )
                totals[B_TORQUE] -= done
                totals[T.PENDING_TORQUE] -= pending
            if last:
                totals[T.SPIN] += kinetic_energy(inertia, o_x, o_y, o_z, b_x, b_y, b_z)
        if exact:
            done, pending = _work(before, after, torque, (o_x, o_y, o_z), (b_x, b_y, b_z))
            totals[B_STEP] += done
            totals[T.PENDING_STEP] += pending
        to_w = bodies.w[other]
        to_w[i, 0], to_w[i, 1], to_w[i, 2] = b_x, b_y, b_z
        if bad:
            totals[T.NOT_FINITE] = min(totals[T.NOT_FINITE], float(bodies.ids[i]))
        if last:
            totals[T.KINETIC] += kinetic_energy(1.0 / inverse_m, v_x, v_y, v_z, u_x, u_y, u_z)
            totals[T.POTENTIAL] += potential_energy(
                m_weight, c[P.G_X], c[P.G_Y], c[P.G_Z], unwrapped(x_i, image[i, 0], c[P.PERIOD_X]),
                unwrapped(y_i, image[i, 1], c[P.PERIOD_Y]), z_i,
            )  # fmt: skip

    return integrate
