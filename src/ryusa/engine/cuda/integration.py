"""One grain, one step: water, weight, and the scheme; as engine/motion.py, whose laws these are."""

import math
from functools import cache
from typing import Any

from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.arrays import DeviceGrainArrays
from ryusa.engine.cuda.device import device, on_device
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.fluid import column_forces, water_speed
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.motion import acceleration, acceleration_spin, semi_implicit
from ryusa.laws.torque import torque_dennis, torque_stokes
from ryusa.model.enums import Above, WaterTorque
from ryusa.model.fluid import A_X, DRAG, EXTRA_X, EXTRA_Z, SHEAR, SUBMERGED
from ryusa.model.resistance import drag_of
from ryusa.model.tally import Book

DRY = int(Above.DRY)
STOKES = int(WaterTorque.STOKES)
B_DRAG, B_TORQUE, B_LIFT, B_FLOW = int(Book.DRAG), int(Book.TORQUE), int(Book.LIFT), int(Book.FLOW)
B_FILM = int(Book.FILM)

Vector = tuple[float, float, float]
_column_forces, _water_speed, _drag_of = on_device(column_forces), on_device(water_speed), on_device(drag_of)


@cache
def make_integrate(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build the motion of one grain for one variant."""
    plane_case, rotation, column, film = variant.plane_case, variant.rotation, variant.column, variant.film
    profile, above, drag, torque_law = choice.profile, choice.above, choice.drag, choice.torque

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

        Parameters
        ----------
        first, last : whether this is the first step of the run, and the last of a call.
        force, torque : of its contacts [N], [N m].
        from_film : force of films of water [N].
        """
        other = 1 - half
        x, v, w, image, fluid, impulse = (
            bodies.x[half], bodies.v[half], bodies.w[half], bodies.image, bodies.fluid, bodies.impulse,
        )  # fmt: skip
        dt, g_x, g_y, g_z = c[P.DT], c[P.G_X], c[P.G_Y], c[P.G_Z]
        halved = 0.0 if first else 0.5 * dt
        f_x, f_y, f_z = force
        t_x, t_y, t_z = torque
        h_x, h_y, h_z = from_film
        y_x, y_y, y_z = x[i, 0], x[i, 1], x[i, 2]
        v_x, v_y, v_z = v[i, 0], v[i, 1], v[i, 2]
        o_x, o_y, o_z, r = w[i, 0], w[i, 1], w[i, 2], w[i, 3]
        d_x = d_y = d_z = l_x = l_y = l_z = e_x = e_z = turn = 0.0
        submerged = 1.0
        m_b, m_w = bodies.m_bare[i], bodies.m_weight[i]
        added = bodies.m[i] - m_b
        if column:
            submerged = fluid[i, SUBMERGED]
            dry = submerged == 0.0
            added *= submerged  # water moves along with what of a grain is in it
            e_x, e_z = fluid[i, EXTRA_X] + added * fluid[i, A_X], fluid[i, EXTRA_Z]
            turn = 0.5 * fluid[i, SHEAR]
            if not dry:
                k_d, d_x, d_y, d_z, l_x, l_y, l_z = _column_forces(choice, c, r, fluid[i], v[i], w[i])
                impulse[i, DRAG] = k_d
        else:
            z = y_z - c[P.Z_ZERO]
            dry = profile == 0 or (above == DRY and z > c[P.DEPTH])
            if drag and not dry:
                u_x, u_y, u_z = _water_speed(profile, above, z, c) - v_x, -v_y, -v_z
                slip = math.sqrt(u_x * u_x + u_y * u_y + u_z * u_z)
                k_d = _drag_of(drag, slip, 2.0 * r, c[P.NU], c[P.RHO_W], c[P.A_2], c[P.C_D])
                d_x, d_y, d_z = k_d * u_x, k_d * u_y, k_d * u_z
        if column:
            f_x, f_y, f_z = f_x + l_x + e_x, f_y + l_y, f_z + l_z + e_z
        if film:
            f_x, f_y, f_z = f_x + h_x, f_y + h_y, f_z + h_z

        per_m = 1.0 / (m_b + added)
        new_x, a_x = semi_implicit(y_x, v_x, acceleration(f_x, d_x, m_w * g_x, per_m), dt)
        new_z, a_z = semi_implicit(y_z, v_z, acceleration(f_z, d_z, m_w * g_z, per_m), dt)
        new_y, a_y = y_y, v_y
        if not plane_case:
            new_y, a_y = semi_implicit(y_y, v_y, acceleration(f_y, d_y, m_w * g_y, per_m), dt)
        to_x, to_v = bodies.x[other], bodies.v[other]
        to_x[i, 0], to_x[i, 1], to_x[i, 2] = new_x, new_y, new_z
        to_v[i, 0], to_v[i, 1], to_v[i, 2] = a_x, a_y, a_z
        square = a_x * a_x + a_y * a_y + a_z * a_z
        bad = not square < math.inf
        totals[T.SPEED_2] = max(totals[T.SPEED_2], square)

        if drag:
            totals[B_DRAG] += halved * (d_x * v_x + d_y * v_y + d_z * v_z)
            totals[T.PENDING_DRAG] += 0.5 * dt * (d_x * a_x + d_y * a_y + d_z * a_z)
        if column:
            if not dry:
                impulse[i, 0] += dt * (d_x + l_x + added * fluid[i, A_X]) - added * (a_x - v_x)
                impulse[i, 1] += dt * (d_y + l_y) - added * (a_y - v_y)
                impulse[i, 2] += dt * (d_z + l_z) - added * (a_z - v_z)
            totals[B_LIFT] += halved * (l_x * v_x + l_y * v_y + l_z * v_z)
            totals[T.PENDING_LIFT] += 0.5 * dt * (l_x * a_x + l_y * a_y + l_z * a_z)
            totals[B_FLOW] += halved * (e_x * v_x + e_z * v_z)
            totals[T.PENDING_FLOW] += 0.5 * dt * (e_x * a_x + e_z * a_z)
        if film:
            totals[B_FILM] -= halved * (h_x * v_x + h_y * v_y + h_z * v_z)
            totals[T.PENDING_FILM] += 0.5 * dt * (h_x * a_x + h_y * a_y + h_z * a_z)

        b_x, b_y, b_z = o_x, o_y, o_z
        if rotation:
            k_t = 0.0
            if torque_law and not dry:
                o_rel = o_y - turn
                size = math.sqrt(o_x * o_x + o_rel * o_rel + o_z * o_z)
                if torque_law == STOKES:
                    k_t = torque_stokes(size, 2.0 * r, c[P.NU], c[P.RHO_W])
                else:
                    k_t = torque_dennis(size, 2.0 * r, c[P.NU], c[P.RHO_W])
                k_t *= submerged
            i_i = bodies.inertia[i]
            per_i = 1.0 / i_i
            b_y = o_y + dt * acceleration_spin(t_y - k_t * (o_y - turn), per_i)
            if not plane_case:
                b_x = o_x + dt * acceleration_spin(t_x - k_t * o_x, per_i)
                b_z = o_z + dt * acceleration_spin(t_z - k_t * o_z, per_i)
            whirl = b_x * b_x + b_y * b_y + b_z * b_z
            bad = bad or not whirl < math.inf
            totals[T.SPIN_2] = max(totals[T.SPIN_2], whirl)
            if torque_law:
                totals[B_TORQUE] -= halved * k_t * (o_x * o_x + (o_y - turn) * o_y + o_z * o_z)
                totals[T.PENDING_TORQUE] -= 0.5 * dt * k_t * (o_x * b_x + (o_y - turn) * b_y + o_z * b_z)
            if last:
                totals[T.SPIN] += 0.5 * i_i * (o_x * b_x + o_y * b_y + o_z * b_z)
        to_w = bodies.w[other]
        to_w[i, 0], to_w[i, 1], to_w[i, 2] = b_x, b_y, b_z
        if bad:
            totals[T.NOT_FINITE] = min(totals[T.NOT_FINITE], float(bodies.ids[i]))
        if last:
            m_i = m_b + added if column else bodies.m[i]
            totals[T.KINETIC] += 0.5 * m_i * (v_x * a_x + v_y * a_y + v_z * a_z)
            if image[i, 0] != 0:
                y_x += image[i, 0] * c[P.PERIOD_X]
            if image[i, 1] != 0:
                y_y += image[i, 1] * c[P.PERIOD_Y]
            totals[T.POTENTIAL] -= m_w * (g_x * y_x + g_y * y_y + g_z * y_z)

    return integrate
