"""Motion of rigid bodies: forces on their members summed, the body moved, and its members with it.

After the forces on all grains are complete and before the next step. A body is the work of one thread, and
its members are taken in the order of ids: sums do not depend on the number of threads.
"""
# ruff: noqa: E741  (l is a lane)

import math
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ryusa.compiled.function import compiled
from ryusa.compiled.piece import taken
from ryusa.engine.cpu import fluid_layout as W
from ryusa.engine.cpu.bodies_in_water import make_forces_on_bodies, share_impulse
from ryusa.engine.cpu.fluid_work import (
    begin_fluid_work,
    end_fluid_work,
    make_add_fluid,
    make_book_fluid_work,
)
from ryusa.engine.cpu.simd.vec4 import component, vec4_of
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.array_memory import zeros
from ryusa.engine.shared.kernel import FAST
from ryusa.engine.shared.status import FAULT_NONE, FAULT_NOT_A_NUMBER
from ryusa.engine.shared.variant import MotionKind
from ryusa.laws.grain_step import kinetic_energy, potential_energy, translation_step, unwrapped
from ryusa.laws.rigid_body import rotate, rotor_step, spin
from ryusa.model import Scene
from ryusa.model.arrays import Floats
from ryusa.model.rigid_bodies import N_DRAG_FORM, BodyState, RigidBodies


class BodyArrays(NamedTuple):
    """Bodies by number, their members in rows start[b] to start[b + 1]."""

    order: Any  # bodies in the order of the places of their first members, (n_body,)
    start: Any  # (n_body + 1,)
    place: Any  # place of each member among the grains, (n_member,)
    arm: Any  # centre of each member in the body frame [m], and 0, (n_member, 4)
    share: Any  # of each member in the volume of its body [-], (n_member,)
    added_of_member: Any  # added mass of each member [kg], (n_member,)
    member: Any  # 1 for grains that are members, by id, (n,)
    x: Any  # centres of mass [m], and 0, (n_body, 4)
    v: Any  # velocities [m/s], and 0, (n_body, 4)
    q: Any  # orientations, (n_body, 4)
    momentum: Any  # angular momenta in space [N m s], and 0, (n_body, 4)
    image: Any  # periods crossed, (n_body, 2)
    m: Any  # [kg], (n_body,)
    m_weight: Any  # [kg], (n_body,)
    m_added: Any  # added mass [kg], (n_body,)
    over: Any  # 1 over the principal moments of inertia [1/(kg m2)], and 0, (n_body, 4)
    r: Any  # radius of the sphere of the same volume [m], (n_body,)
    drag_form: Any  # columns of `RigidBodies.drag_form`, (n_body, N_DRAG_FORM)


def body_arrays(scene: Scene, bodies: RigidBodies, state: BodyState) -> BodyArrays:
    """Arrays of the bodies of a scene; `place_members` has to follow."""
    k = bodies.n
    start = np.concatenate([[0], np.cumsum(bodies.count)]).astype(np.int64)
    added = scene.m_added[bodies.members]
    member = np.zeros(scene.n_grain, np.uint8)
    member[bodies.members] = 1
    return BodyArrays(
        order=np.arange(k),
        start=start,
        place=np.zeros(start[-1], np.int64),
        arm=_rows_of_four(bodies.arm),
        share=scene.m[bodies.members] / np.repeat(bodies.m, bodies.count),
        added_of_member=added,
        member=member,
        x=_rows_of_four(state.x),
        v=_rows_of_four(state.v),
        q=_rows_of_four(state.q),
        momentum=_rows_of_four(state.momentum),
        image=np.array(state.image, np.int32),
        m=np.array(bodies.m),
        m_weight=np.array(bodies.m_weight),
        m_added=bodies.sums(added),
        over=_rows_of_four(1.0 / bodies.inertia),
        r=0.5 * bodies.d,
        drag_form=np.array(bodies.drag_form) if len(bodies.drag_form) else np.ones((k, N_DRAG_FORM)),
    )


def _rows_of_four(given: Floats) -> Floats:
    rows = zeros(np.float64, len(given), 4)
    rows[:, : given.shape[1]] = given
    return rows


def place_members(arrays: BodyArrays, members: np.ndarray, ids: np.ndarray) -> BodyArrays:
    """The same bodies once grains have new places; `ids` are those of free grains by place."""
    place = np.argsort(ids)[members]
    return arrays._replace(place=place, order=np.argsort(place[arrays.start[:-1]], kind="stable"))


def wrap_bodies(arrays: BodyArrays, period: np.ndarray) -> None:
    """Bring centres of mass back into the period, and count it."""
    for k in range(2):
        if period[k] < math.inf:
            shift = np.floor(arrays.x[:, k] / period[k])
            arrays.x[:, k] -= shift * period[k]
            arrays.image[:, k] += shift.astype(np.int32)


def body_shares(arrays: BodyArrays, added: Floats, v: Floats) -> None:
    """Set the added mass of members [kg] and, in place of their own, the velocity of their body [m/s].

    Parameters
    ----------
    added, v : of free grains by place, of shape (n,) and (n, 3).
    """
    added[arrays.place] = arrays.added_of_member
    v[arrays.place] = np.repeat(arrays.v[:, :3], np.diff(arrays.start), axis=0)


def body_state(arrays: BodyArrays) -> BodyState:
    """Copy of the motion of bodies."""
    return BodyState(
        arrays.x[:, :3].copy(), arrays.v[:, :3].copy(), arrays.q.copy(), arrays.momentum[:, :3].copy(),
        arrays.image.copy(),
    )  # fmt: skip


@cache
def make_move_bodies(kind: MotionKind) -> Any:
    """Build the piece that moves rigid bodies: move_bodies(begin, end, begins, last, b, work, held)."""
    water, column = bool(kind.water), bool(kind.column)
    forces_on_bodies: Any = make_forces_on_bodies(column, kind.laws) if water else None
    add_fluid = make_add_fluid(column, bool(kind.film), kind.laws.torque != 0)
    book_fluid_work = make_book_fluid_work(column, bool(kind.film), kind.laws.torque != 0)

    @compiled(fastmath=FAST)
    def move_bodies(begin: int, end: int, begins: bool, last: bool, b_: int, work: Any, held: Any) -> None:
        """Move bodies begin..end-1, in `BodyArrays.order`, and their members, by one step.

        Energy is that of the scheme: 1/2 L(n-1/2) w(n+1/2) at the orientation of step n changes by the work
        of torques over the velocity intervals, as 1/2 m v(n-1/2) v(n+1/2) does by that of forces. A member
        takes its displacement over the step as velocity, and the mean of the spins at both ends as spin
        (design/0022).
        """
        held, work = taken(held), taken(work)
        c, grains, pairs, bodies, lanes, batch = (
            held.c, held.grains, held.pairs, held.bodies, work.bodies, work.water,
        )  # fmt: skip
        account, stats = held.accounts.terms[b_], held.accounts.stats[b_]
        # One function: sums over members and the motion of members share all that lies between them
        x, v, w, f, image = grains.x, grains.v, grains.w, pairs.f, grains.image
        dt, l_x, l_y, v_pruned = c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y], grains.v_pruned
        g = (c[P.G_X], c[P.G_Y], c[P.G_Z])
        speed_2 = spin_2 = velocity_change_2 = 0.0
        half = 0.0 if begins else 0.5 * dt
        if water:
            begin_fluid_work(batch)
        for k in range(begin, end):
            b, l = bodies.order[k], (k - begin) % W.LANES
            if water and l == 0:
                forces_on_bodies(k, min(k + W.LANES, end), c, grains.fluid, bodies, lanes, batch)
            q_w, q_x, q_y, q_z = bodies.q[b, 0], bodies.q[b, 1], bodies.q[b, 2], bodies.q[b, 3]
            f_x = f_y = f_z = t_x = t_y = t_z = 0.0
            for s in range(bodies.start[b], bodies.start[b + 1]):
                i = bodies.place[s]
                a_x, a_y, a_z = rotate(
                    bodies.arm[s, 0], bodies.arm[s, 1], bodies.arm[s, 2], q_w, q_x, q_y, q_z
                )
                p_x, p_y, p_z = f[i, 0], f[i, 1], f[i, 2]
                f_x, f_y, f_z = f_x + p_x, f_y + p_y, f_z + p_z
                t_x += f[i, 4] + (a_y * p_z - a_z * p_y)
                t_y += f[i, 5] + (a_z * p_x - a_x * p_z)
                t_z += f[i, 6] + (a_x * p_y - a_y * p_x)
                for a in range(8):
                    f[i, a] = 0.0
            m, weight = bodies.m[b], bodies.m_weight[b]
            r_x = r_y = r_z = 0.0  # drag
            if water:
                push, turn, drag = add_fluid(
                    l, l, vec4_of(f_x, f_y, f_z, 0.0), vec4_of(t_x, t_y, t_z, 0.0),
                    lanes.film, batch,
                )  # fmt: skip
                f_x, f_y, f_z = component(push, 0), component(push, 1), component(push, 2)
                t_x, t_y, t_z = component(turn, 0), component(turn, 1), component(turn, 2)
                r_x, r_y, r_z = component(drag, 0), component(drag, 1), component(drag, 2)
                m += bodies.m_added[b] if not column else batch[W.ADDED + l]
            per_m = 1.0 / m
            over_1, over_2, over_3 = bodies.over[b, 0], bodies.over[b, 1], bodies.over[b, 2]
            u_x, u_y, u_z = bodies.v[b, 0], bodies.v[b, 1], bodies.v[b, 2]
            x_b, v_x = translation_step(bodies.x[b, 0], u_x, f_x, r_x, weight * g[0], per_m, dt)
            y_b, v_y = translation_step(bodies.x[b, 1], u_y, f_y, r_y, weight * g[1], per_m, dt)
            z_b, v_z = translation_step(bodies.x[b, 2], u_z, f_z, r_z, weight * g[2], per_m, dt)
            b_x, b_y, b_z = bodies.momentum[b, 0], bodies.momentum[b, 1], bodies.momentum[b, 2]
            m_x, m_y, m_z = b_x + dt * t_x, b_y + dt * t_y, b_z + dt * t_z
            w_x, w_y, w_z = spin(q_w, q_x, q_y, q_z, m_x, m_y, m_z, over_1, over_2, over_3)
            if water:
                w_0, w_1, w_2 = lanes.w[l, 0], lanes.w[l, 1], lanes.w[l, 2]
                book_fluid_work(
                    l, l, half, dt, vec4_of(u_x, u_y, u_z, 0.0),
                    vec4_of(v_x, v_y, v_z, 0.0), vec4_of(w_0, w_1, w_2, 0.0), vec4_of(w_x, w_y, w_z, 0.0),
                    lanes.impulse, lanes.film, batch,
                )  # fmt: skip
                if column:
                    share_impulse(l, b, bodies, lanes, grains.fluid, grains.impulse)
            if last:
                stats[S.KINETIC] += kinetic_energy(m, u_x, u_y, u_z, v_x, v_y, v_z)
                stats[S.SPIN] += kinetic_energy(1.0, b_x, b_y, b_z, w_x, w_y, w_z)
                stats[S.POTENTIAL] += potential_energy(
                    weight, g[0], g[1], g[2], unwrapped(bodies.x[b, 0], bodies.image[b, 0], l_x),
                    unwrapped(bodies.x[b, 1], bodies.image[b, 1], l_y), bodies.x[b, 2],
                )  # fmt: skip
            p_w, p_x, p_y, p_z, l_1, l_2, l_3 = rotor_step(
                q_w, q_x, q_y, q_z, m_x, m_y, m_z, over_1, over_2, over_3, dt
            )
            s_x, s_y, s_z = rotate(over_1 * l_1, over_2 * l_2, over_3 * l_3, p_w, p_x, p_y, p_z)
            s_x, s_y, s_z = 0.5 * (w_x + s_x), 0.5 * (w_y + s_y), 0.5 * (w_z + s_z)
            bodies.x[b, 0], bodies.x[b, 1], bodies.x[b, 2] = x_b, y_b, z_b
            bodies.v[b, 0], bodies.v[b, 1], bodies.v[b, 2] = v_x, v_y, v_z
            bodies.q[b, 0], bodies.q[b, 1], bodies.q[b, 2], bodies.q[b, 3] = p_w, p_x, p_y, p_z
            bodies.momentum[b, 0], bodies.momentum[b, 1], bodies.momentum[b, 2] = m_x, m_y, m_z
            per_dt = 1.0 / dt
            for s in range(bodies.start[b], bodies.start[b + 1]):
                i = bodies.place[s]
                arm_1, arm_2, arm_3 = bodies.arm[s, 0], bodies.arm[s, 1], bodies.arm[s, 2]
                a_x, a_y, a_z = rotate(arm_1, arm_2, arm_3, q_w, q_x, q_y, q_z)
                c_x, c_y, c_z = rotate(arm_1, arm_2, arm_3, p_w, p_x, p_y, p_z)
                x[i, 0] = unwrapped(x_b + c_x, bodies.image[b, 0] - image[i, 0], l_x)
                x[i, 1] = unwrapped(y_b + c_y, bodies.image[b, 1] - image[i, 1], l_y)
                x[i, 2] = z_b + c_z
                e_x, e_y, e_z = (
                    v_x + (c_x - a_x) * per_dt,
                    v_y + (c_y - a_y) * per_dt,
                    v_z + (c_z - a_z) * per_dt,
                )
                v[i, 0], v[i, 1], v[i, 2] = e_x, e_y, e_z
                w[i, 0], w[i, 1], w[i, 2] = s_x, s_y, s_z
                speed_2 = max(speed_2, e_x * e_x + e_y * e_y + e_z * e_z)
                d_x, d_y, d_z = e_x - v_pruned[i, 0], e_y - v_pruned[i, 1], e_z - v_pruned[i, 2]
                velocity_change_2 = max(velocity_change_2, d_x * d_x + d_y * d_y + d_z * d_z)
            fast, fast_spin = v_x * v_x + v_y * v_y + v_z * v_z, s_x * s_x + s_y * s_y + s_z * s_z
            spin_2 = max(spin_2, fast_spin)
            if not fast + fast_spin < math.inf and stats[S.FAULT] == FAULT_NONE:
                stats[S.FAULT], stats[S.FAULT_PARTNER] = FAULT_NOT_A_NUMBER, -1
                stats[S.FAULT_GRAIN] = grains.ids[bodies.place[bodies.start[b]]]
        if water:
            end_fluid_work(batch, account, stats)
        stats[S.SPEED_MOVED] = max(stats[S.SPEED_MOVED], math.sqrt(speed_2))
        stats[S.SPIN_MAX] = max(stats[S.SPIN_MAX], math.sqrt(spin_2))
        stats[S.VELOCITY_CHANGE_MOVED] = max(stats[S.VELOCITY_CHANGE_MOVED], math.sqrt(velocity_change_2))

    return move_bodies
