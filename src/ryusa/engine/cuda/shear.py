"""The second half of a step with exact timing (design/0014), and the kernels that close its two halves.

After the kicks (step.py) every grain gathers what its pairs do until the next step, and moves. Kicks leave
positions as they were and write velocities to the other half of the arrays; the shear reads both there and
writes the half before: no grain reads what another writes.
"""

import math
from functools import cache
from typing import Any

from numba import float64

from ryusa.engine.cuda import run_status as F
from ryusa.engine.cuda import step_totals as T
from ryusa.engine.cuda.arrays import (
    DeviceGrainArrays,
    DevicePairArrays,
    DeviceWallArrays,
    LaunchShape,
    RecordedGrains,
)
from ryusa.engine.cuda.device import cuda, device, on_device
from ryusa.engine.cuda.exact_pair import make_middle
from ryusa.engine.cuda.pair import separation
from ryusa.engine.cuda.pair_records import make_record_between
from ryusa.engine.cuda.step import enter_totals, find_fault, reduce_blocks
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import AHEAD, APART, REACH, bending, is_held
from ryusa.engine.shared.dashpots import springs_immersed
from ryusa.engine.shared.status import (
    FAULT_NONE,
    STOP_DONE,
    STOP_EVENTS,
    STOP_FAULT,
    STOP_LIST,
    STOP_UNSAFE,
)
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.contact_step import contact_kinematics
from ryusa.model.fluid import SUBMERGED

Vector = tuple[float, float, float]
_is_held, _bending, _springs_immersed = on_device(is_held), on_device(bending), on_device(springs_immersed)


@cache
def make_shear(variant: KernelVariant, choice: LawChoice, shape: LaunchShape) -> Any:
    """Build the kernel of one variant, for blocks of one shape."""
    plane_case, events, rebound = variant.plane_case != 0, variant.events, choice.rebound > 0
    record_at, threads, n_total = variant.event_column, shape.threads, T.N_OF_SHEAR
    middle, advance = make_middle(variant, choice), make_advance(variant)
    record_between = make_record_between(variant, choice)

    @cuda.jit
    def shear(
        n: int, n_solid: int, c: Any, status: Any, motion: Any, bodies: DeviceGrainArrays,
        walls: DeviceWallArrays, pairs: DevicePairArrays, partial: Any,
    ) -> None:  # fmt: skip
        """Let the pairs of every grain go on to the next step, and move it."""
        # One function: sums of a grain stay in registers from pair to pair
        if status[F.STOP] != STOP_DONE or status[F.KICKED] == 0:
            return
        totals = cuda.local.array(n_total, float64)
        for k in range(T.N_OF_SHEAR):
            totals[k] = 0.0
        half, dt, l_x, l_y = status[F.CURRENT], c[P.DT], c[P.PERIOD_X], c[P.PERIOD_Y]
        t, ahead = c[P.T_ZERO] + status[F.STEP] * dt, REACH * motion[F.FASTEST] * dt
        x, v, w, m, ids = bodies.x[half], bodies.v[half], bodies.w[half], bodies.m, bodies.ids
        start, partners, lives, rows = pairs.start, pairs.partners, pairs.touching, pairs.rows

        for i in range(cuda.grid(1), n, cuda.gridsize(1)):
            r_i, id_i = x[i, 3], ids[i]
            f_x = f_y = f_z = t_x = t_y = t_z = s_x = s_y = s_z = 0.0
            for k in range(start[i], start[i + 1]):
                j = partners[k]
                own = j >= n or ids[j] > id_i  # this side keeps account and records
                sign = 1.0 if own else -1.0
                d_x, d_y, d_z, r_j = separation(i, j, sign, n_solid, l_x, l_y, x, walls)
                square = d_x * d_x + d_z * d_z
                if not plane_case:
                    square += d_y * d_y
                reach = r_i + r_j + ahead
                was = lives[k]
                if was == APART and not square < reach * reach:
                    continue

                # seen from the grain with the lower id, whichever side this is: both get the same bits
                u_x, u_y, u_z = (
                    sign * (v[i, 0] - v[j, 0]), sign * (v[i, 1] - v[j, 1]), sign * (v[i, 2] - v[j, 2]),
                )  # fmt: skip
                a, b = (i, j) if own else (j, i)
                n_x, n_y, n_z, overlap, arm_a, arm_b, closing, q_x, q_y, q_z, _ = contact_kinematics(
                    plane_case, d_x, d_y, d_z, r_i + r_j, r_i if own else r_j, u_x, u_y, u_z,
                    w[a, 0], w[a, 1], w[a, 2], w[b, 0], w[b, 1], w[b, 2], dt,
                )  # fmt: skip
                distance = 0.0
                if j < n_solid:
                    distance = d_x * n_x + d_z * n_z
                    if not plane_case:
                        distance += d_y * n_y
                bend = _bending(u_x * u_x + u_y * u_y + u_z * u_z, closing, distance)
                if was == APART:
                    if not (closing > 0.0 and overlap + (closing - 0.5 * bend * dt) * dt > 0.0):
                        continue
                    if rebound:
                        _springs_immersed(k, choice, closing, a, b, c, m, w, pairs.eta)
                normal, slip = (n_x, n_y, n_z), (q_x, q_y, q_z)
                now, when, slid, change, moved, (p_x, p_y, p_z), turned = middle(
                    1.0 if own else 0.0, was, c, normal, distance, overlap, closing, bend,
                    (u_x, u_y, u_z), slip, pairs.eta[k], rows[k], totals,
                )  # fmt: skip
                lives[k] = now
                arm_i = arm_a if own else arm_b
                f_x, f_y, f_z = f_x + sign * p_x, f_y + sign * p_y, f_z + sign * p_z
                t_x, t_y, t_z = t_x + arm_i * turned[0], t_y + arm_i * turned[1], t_z + arm_i * turned[2]
                along = sign * moved
                s_x, s_y, s_z = s_x + along * n_x, s_y + along * n_y, s_z + along * n_z
                if events and own and (_is_held(was) or when < math.inf):
                    record_between(
                        i, j, n, was, when, slid, t, dt, overlap, closing, bend,
                        -pairs.eta[k, M.MASS] * change / dt, normal, slip, (p_x, p_y, p_z),
                        RecordedGrains(x, v, w, ids, bodies.image, bodies.tracked), l_x, l_y,
                        rows[k, record_at:],
                    )  # fmt: skip
            bodies.n_touching[1 - half, i] = bodies.n_touching[half, i]
            advance(i, half, c, bodies, (f_x, f_y, f_z), (t_x, t_y, t_z), (s_x, s_y, s_z), totals)

        shared_sums = cuda.shared.array(0, float64)  # a row for each column
        me = cuda.threadIdx.x
        for k in range(T.N_OF_SHEAR):
            shared_sums[k * threads + me] = totals[k]
        cuda.syncthreads()
        for column in range(me, T.N_OF_SHEAR, threads):
            total = 0.0
            for k in range(threads):
                one = shared_sums[column * threads + k]
                total = total + one if column < T.N_OF_SUM else max(total, one)
            partial[cuda.blockIdx.x * T.N_OF_SHEAR + column] = total

    return shear


@cache
def make_advance(variant: KernelVariant) -> Any:
    """Build the motion of one grain after the shear of its pairs, for one variant."""
    plane_case, rotation, column = variant.plane_case, variant.rotation, variant.column

    @device
    def advance(
        i: int, half: int, c: Any, bodies: DeviceGrainArrays, force: Vector, torque: Vector, shift: Vector,
        totals: Any,
    ) -> None:  # fmt: skip
        """Move the grain at place i from `half` of its arrays to the other.

        Parameters
        ----------
        force, torque : of the impulses of its pairs over the step [N], [N m].
        shift : displacement by its pairs, beside its flight, times mass [kg m].
        """
        x, v, w = bodies.x[half], bodies.v[half], bodies.w[half]
        to_x, to_v, to_w = bodies.x[1 - half], bodies.v[1 - half], bodies.w[1 - half]
        dt, m = c[P.DT], bodies.m_bare[i]
        added = bodies.m[i] - m
        if column:
            added *= bodies.fluid[i, SUBMERGED]
        inverse = 1.0 / (m + added)
        work = raised = speed_2 = pace_2 = spin_2 = 0.0
        for k in range(3):
            before, turn = v[i, k], w[i, k]
            after, whirl, way = before, turn, 0.0
            if not (plane_case and k == 1):
                after = before + dt * inverse * force[k]
                way = dt * after + inverse * shift[k]
                work += force[k] * (before + after)
                # beyond what the weight does with the velocities after one kick and before the next
                raised += c[P.G_X + k] * (inverse * shift[k] + 0.5 * dt * (after - before))
            if rotation and (k == 1 or not plane_case):
                whirl = turn + dt * (1.0 / bodies.inertia[i]) * torque[k]
                work += torque[k] * (turn + whirl)
            to_x[i, k], to_v[i, k], to_w[i, k] = x[i, k] + way, after, whirl
            if column:  # what moves along with the grain is taken from the water
                bodies.impulse[i, k] -= added * (after - before)
            pace = way / dt
            speed_2, pace_2, spin_2 = speed_2 + after * after, pace_2 + pace * pace, spin_2 + whirl * whirl
        totals[T.OF_STEP] += 0.5 * dt * work - bodies.m_weight[i] * raised
        totals[T.OF_SPEED_2] = max(totals[T.OF_SPEED_2], speed_2)
        totals[T.OF_SPEED_2] = max(totals[T.OF_SPEED_2], pace_2)  # of the way that it goes
        if rotation:
            totals[T.OF_SPIN_2] = max(totals[T.OF_SPIN_2], spin_2)

    return advance


@cache
def make_close_kicks(shape: LaunchShape) -> Any:
    """Build the kernel that closes the kicks; one block of `closers`."""
    closers, segments = shape.closers, shape.segments

    @cuda.jit
    def close_kicks(
        n_block: int, room: int, c: Any, partial: Any, status: Any, motion: Any, terms: Any, stats: Any
    ) -> None:
        """Account and faults of the kicks of a step, and whether the list reaches as far as its shear."""
        shared_sums = cuda.shared.array(0, float64)  # a row of columns for each segment
        me = cuda.threadIdx.x
        if status[F.STOP] != STOP_DONE or status[F.KICKED] != 0:
            return
        reduce_blocks(closers, segments, n_block, partial, shared_sums)
        if me == 0:
            enter_totals(shared_sums, status, terms[0], stats[0])
            find_fault(room, c, shared_sums, status, stats[0])
            fastest = math.sqrt(shared_sums[T.KICKED_2])
            motion[F.FASTEST] = fastest
            status[F.KICKED], status[F.CURRENT] = 1, 1 - status[F.CURRENT]
            goes = fastest * c[P.DT]
            if stats[0, S.FAULT] != FAULT_NONE:
                status[F.STOP] = STOP_FAULT
                status[F.STEP] += 1
            elif goes <= c[P.DISPLACEMENT_LIMIT] and (
                2.0 * (motion[F.TRAVEL] + AHEAD * goes) > motion[F.SKIN]
            ):
                status[F.STOP] = STOP_LIST

    return close_kicks


@cache
def make_close_shear(shape: LaunchShape) -> Any:
    """Build the kernel that closes a step after its shear; one block of `closers`."""
    closers, segments = shape.closers, shape.segments

    @cuda.jit
    def close_shear(
        n_block: int, room: int, c: Any, partial: Any, status: Any, motion: Any, stats: Any
    ) -> None:
        """What a shear leaves to book with the next step, how far grains went, and whether to stop."""
        shared_sums = cuda.shared.array(0, float64)  # a row of columns for each segment
        me = cuda.threadIdx.x
        if status[F.STOP] != STOP_DONE or status[F.KICKED] == 0:
            return
        for task in range(me, T.N_OF_SHEAR * segments, closers):
            _add_up(task % T.N_OF_SHEAR, task // T.N_OF_SHEAR, n_block, segments, partial, shared_sums)
        cuda.syncthreads()
        if me == 0:
            for column in range(T.N_OF_SHEAR):
                _add_up(column, 0, segments, 1, shared_sums, shared_sums)
            stats[0, S.PENDING_STEP] += shared_sums[T.OF_STEP]
            stats[0, S.PENDING_DASH_N] += shared_sums[T.OF_DASH_N]
            stats[0, S.PENDING_DASH_S] += shared_sums[T.OF_DASH_S]
            stats[0, S.PENDING_SLIDE] += shared_sums[T.OF_SLIDE]
            fastest = math.sqrt(shared_sums[T.OF_SPEED_2])
            stats[0, S.SPEED_MAX], stats[0, S.SPIN_MAX] = fastest, math.sqrt(shared_sums[T.OF_SPIN_2])
            motion[F.TRAVEL] += fastest * c[P.DT]
            motion[F.FASTEST] = fastest
            if fastest * c[P.DT] > c[P.DISPLACEMENT_LIMIT]:
                status[F.STOP] = STOP_UNSAFE
            elif 2 * status[F.ENDED] > room:
                status[F.STOP] = STOP_EVENTS
            status[F.KICKED], status[F.CURRENT] = 0, 1 - status[F.CURRENT]
            status[F.STEP] += 1

    return close_shear


@device
def _add_up(column: int, first: int, end: int, every: int, rows: Any, sums: Any) -> None:
    """Add up one column of every so many rows, or find its largest, into row `first` of `sums`."""
    total = 0.0
    for k in range(first * T.N_OF_SHEAR + column, end * T.N_OF_SHEAR, every * T.N_OF_SHEAR):
        total = total + rows[k] if column < T.N_OF_SUM else max(total, rows[k])
    sums[first * T.N_OF_SHEAR + column] = total
