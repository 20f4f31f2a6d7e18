"""One step: a kernel in which every grain gathers its forces and moves, and one that adds up what is left.

With exact timing this is the first half of a step, the kicks; shear.py has the second.
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
from ryusa.engine.cuda.integration import make_integrate
from ryusa.engine.cuda.pair import make_contact, make_spring_energy, separation, track_overlap
from ryusa.engine.cuda.pair_records import make_record
from ryusa.engine.cuda.step_totals import NO_GRAIN
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.dashpots import kicks_of_pair
from ryusa.engine.shared.fluid import close_fluid_interval
from ryusa.engine.shared.rolling import end_rolling, rolling_friction
from ryusa.engine.shared.status import (
    FAULT_EVENTS_FULL,
    FAULT_NONE,
    FAULT_NOT_A_NUMBER,
    FAULT_OVERLAP,
    STOP_DONE,
    STOP_EVENTS,
    STOP_FAULT,
    STOP_LIST,
    STOP_UNSAFE,
)
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.laws.contact_step import contact_kinematics
from ryusa.laws.families import Rolling
from ryusa.laws.immersed import lubrication_force
from ryusa.laws.rolling import reduced_radius
from ryusa.model.tally import N_TERM, Term

Vector = tuple[float, float, float]
B_ROLL, B_RELEASED_R, B_STEP = int(Term.ROLL), int(Term.RELEASED_R), int(Term.STEP)

_kicks_of_pair = on_device(kicks_of_pair)
_rolling_friction = on_device(rolling_friction)
_end_rolling = on_device(end_rolling)
_close_fluid_interval = on_device(close_fluid_interval)


@device
def _rolling_power(row: Any, w_a: Vector, w_b: Vector, sign: float) -> float:
    """Power that the rolling torque of a row takes from spins [W]."""
    power = 0.0
    for k in range(3):
        power -= (row[M.SPRING_R + k] + row[M.DASH_R + k]) * (w_a[k] + sign * w_b[k])
    return power


@cache
def make_step(variant: KernelVariant, choice: LawChoice, shape: LaunchShape) -> Any:
    """Build the kernel of one variant, for blocks of one shape."""
    plane_case = variant.plane_case != 0
    rolling, events, film, exact = variant.rolling, variant.events, variant.film, variant.exact != 0
    dried = exact and choice.rebound > 0  # springs of the last touch may have been those under water
    model, arms = choice.rolling, choice.arm
    record_at, threads, group, parts = variant.event_column, shape.threads, shape.group, shape.parts
    run, rotation = threads // parts, variant.rotation
    n_total = T.N_COLUMN  # the size of a local array has to be a literal
    both_ways = 1.0 if "both alike" in Rolling(model).marks else -1.0  # Eq. (13) as printed: one direction
    contact, integrate = make_contact(variant, choice), make_integrate(variant, choice)
    record_pair, add_spring_energy = make_record(variant, choice), make_spring_energy(variant)

    @cuda.jit
    def step(
        n: int,
        n_solid: int,
        c: Any,
        status: Any,
        bodies: DeviceGrainArrays,
        walls: DeviceWallArrays,
        pairs: DevicePairArrays,
        ended: Any,
        partial: Any,
    ) -> None:
        """Do one step, or the kicks of one with exact timing, unless something waits for the host."""
        # One function: sums of a grain stay in its 209 to 255 registers (design/0009) from pair to pair
        if status[F.STOP] != STOP_DONE or (exact and status[F.KICKED] != 0):
            return
        totals = cuda.local.array(n_total, float64)
        for k in range(T.N_COLUMN):
            totals[k] = 0.0
        totals[T.OVERLAP], totals[T.OVERLAP_GRAIN] = -1.0, NO_GRAIN
        totals[T.OVERLAP_PARTNER], totals[T.NOT_FINITE] = NO_GRAIN, NO_GRAIN
        work = cuda.local.array(N_TERM, float64)
        half, at = status[F.CURRENT], status[F.STEP]
        first, last = at == 0, at == status[F.TARGET] - 1
        dt = c[P.DT]
        l_x, l_y = c[P.PERIOD_X], c[P.PERIOD_Y]
        t, hdt = c[P.T_ZERO] + at * dt, 0.0 if first else 0.5 * dt
        film_reach = c[P.FILM_REACH] if film else 0.0
        x, v, w = bodies.x[half], bodies.v[half], bodies.w[half]
        m, inertia, ids = bodies.m, bodies.inertia, bodies.ids
        n_touching = bodies.n_touching[half]
        start, partners, lives, rows = pairs.start, pairs.partners, pairs.touching, pairs.rows

        for i in range(cuda.grid(1), n, cuda.gridsize(1)):
            r_i, id_i = x[i, 3], ids[i]
            f_x = f_y = f_z = t_x = t_y = t_z = h_x = h_y = h_z = 0.0
            hits = 0
            for k in range(start[i], start[i + 1]):
                j = partners[k]
                plane = j >= n_solid
                own = j >= n or ids[j] > id_i  # this side keeps account and records
                sign = 1.0 if own else -1.0
                d_x, d_y, d_z, r_j = separation(i, j, sign, n_solid, l_x, l_y, x, walls)
                square = d_x * d_x + d_z * d_z
                if not plane_case:
                    square += d_y * d_y
                reach = r_i + r_j + film_reach
                was = lives[k]
                if not (was != 0 or square < reach * reach):
                    continue

                # seen from the grain with the lower id, whichever side this is: both get the same bits
                u_x, u_y, u_z = (
                    sign * (v[i, 0] - v[j, 0]), sign * (v[i, 1] - v[j, 1]), sign * (v[i, 2] - v[j, 2]),
                )  # fmt: skip
                a, b = (i, j) if own else (j, i)
                r_a = r_i if own else r_j
                w_a, w_b = (w[a, 0], w[a, 1], w[a, 2]), (w[b, 0], w[b, 1], w[b, 2])
                n_x, n_y, n_z, overlap, arm_a, arm_b, closing, s_x, s_y, s_z, twist = contact_kinematics(
                    plane_case, d_x, d_y, d_z, r_i + r_j, r_a, u_x, u_y, u_z,
                    w_a[0], w_a[1], w_a[2], w_b[0], w_b[1], w_b[2], dt,
                )  # fmt: skip
                normal, slip = (n_x, n_y, n_z), (s_x, s_y, s_z)
                arm_i = arm_a if own else arm_b
                weight = 1.0 if own else 0.0
                if was != 0 or overlap > 0.0:
                    row, live = rows[k], overlap > 0.0
                    if dried and was == 0:  # found in touch at a step, as where grains were put in touch
                        _kicks_of_pair(k, a, b, rotation, c, m, x, inertia, pairs.eta)
                    now, f_n, raw, slides, (p_x, p_y, p_z), turned = contact(
                        a, b, weight, was, hdt, c, m, inertia, w, normal, overlap, closing, slip, twist,
                        pairs.eta[k], row, totals,
                    )  # fmt: skip
                    lives[k] = now
                    f_x, f_y, f_z = f_x + sign * p_x, f_y + sign * p_y, f_z + sign * p_z
                    t_x, t_y, t_z = t_x + arm_i * turned[0], t_y + arm_i * turned[1], t_z + arm_i * turned[2]
                    if live:
                        hits += 1
                        if own:
                            track_overlap(
                                overlap / (2.0 * min(r_i, r_j)),
                                float(id_i),
                                float(ids[j] if j < n else j),
                                totals,
                            )
                    if rolling:
                        for term in range(N_TERM):
                            work[term] = 0.0
                        r_wall = math.inf if plane else r_j  # of a plane
                        if live:
                            share_i, share_j = float(max(n_touching[i], 1)), 1.0
                            if j < n:
                                share_j = float(max(n_touching[j], 1))
                            side_i = (r_i, m[i], inertia[i], share_i)
                            side_j = (r_wall, m[j], inertia[j], share_j)
                            if exact:
                                totals[B_STEP] += weight * hdt * _rolling_power(row, w_a, w_b, both_ways)
                            q_x, q_y, q_z, held = _rolling_friction(
                                model, arms, row, c, f_n, overlap, hdt,
                                side_i if own else side_j, side_j if own else side_i,
                                normal, (
                                    normal[1] * p_z - normal[2] * p_y,
                                    normal[2] * p_x - normal[0] * p_z,
                                    normal[0] * p_y - normal[1] * p_x,
                                ), w_a, w_b, work,
                            )  # fmt: skip
                            if exact:
                                totals[B_STEP] += weight * hdt * _rolling_power(row, w_a, w_b, both_ways)
                            turn_i = 1.0 if own else both_ways
                            t_x, t_y, t_z = t_x + turn_i * q_x, t_y + turn_i * q_y, t_z + turn_i * q_z
                            if last:
                                totals[T.SPRING_R] += weight * held
                        elif was != 0:
                            if exact:
                                totals[B_STEP] += weight * hdt * _rolling_power(row, w_a, w_b, both_ways)
                            _end_rolling(model, row, c, hdt, w_a, w_b, reduced_radius(r_i, r_wall), work)
                        totals[B_ROLL] += weight * work[B_ROLL]
                        totals[B_RELEASED_R] += weight * work[B_RELEASED_R]
                    if events and own:
                        others = n_touching[i] > 1 or (j < n and n_touching[j] > 1)
                        record_pair(
                            i, j, n, was, now, t, dt, overlap, closing, f_n, raw, slides, others,
                            pairs.eta[k], normal, slip, (p_x, p_y, p_z),
                            RecordedGrains(x, v, w, ids, bodies.image, bodies.tracked), l_x, l_y,
                            row[record_at:], status, ended,
                        )  # fmt: skip
                    if last and now != 0 and own:
                        add_spring_energy(now, c, pairs.eta[k], row, totals)
                if film and overlap <= 0.0 and overlap > -film_reach:
                    radius = reduced_radius(r_i, math.inf if plane else r_j)
                    push = sign * lubrication_force(
                        -overlap, closing, radius, c[P.ASPERITY], film_reach, c[P.RHO_W], c[P.NU]
                    )
                    h_x, h_y, h_z = h_x - push * normal[0], h_y - push * normal[1], h_z - push * normal[2]
            bodies.n_touching[1 - half, i] = hits
            integrate(
                i, half, first, last, c, bodies, (f_x, f_y, f_z), (t_x, t_y, t_z), (h_x, h_y, h_z), totals
            )

        # what the threads of a block have in their accounts, added in a fixed order
        # `LaunchShape.shared_doubles` of them: a row a column, then sums of parts
        shared_sums = cuda.shared.array(0, float64)
        sums, me, row = group * threads, cuda.threadIdx.x, cuda.blockIdx.x * T.N_COLUMN
        for lead in range(0, T.N_COLUMN, group):
            cuda.syncthreads()
            for k in range(group):
                shared_sums[k * threads + me] = totals[lead + k]
            cuda.syncthreads()
            for task in range(me, group * parts, threads):
                column, part = task % group, task // group
                total = 0.0
                for k in range(part * run, (part + 1) * run):
                    total += shared_sums[column * threads + k]
                shared_sums[sums + task] = total
            cuda.syncthreads()
            for column in range(me, group, threads):
                if lead + column < T.N_SUM:
                    total = 0.0
                    for part in range(parts):
                        total += shared_sums[sums + part * group + column]
                    partial[row + lead + column] = total
            if me == 0 and lead + group > T.N_SUM:
                for k in range(1, threads):
                    at_k = k - lead * threads
                    totals[T.SPEED_2] = max(totals[T.SPEED_2], shared_sums[T.SPEED_2 * threads + at_k])
                    totals[T.SPIN_2] = max(totals[T.SPIN_2], shared_sums[T.SPIN_2 * threads + at_k])
                    if exact:
                        totals[T.KICKED_2] = max(totals[T.KICKED_2], shared_sums[T.KICKED_2 * threads + at_k])
                    totals[T.NOT_FINITE] = min(
                        totals[T.NOT_FINITE], shared_sums[T.NOT_FINITE * threads + at_k]
                    )
                    track_overlap(
                        shared_sums[T.OVERLAP * threads + at_k],
                        shared_sums[T.OVERLAP_GRAIN * threads + at_k],
                        shared_sums[T.OVERLAP_PARTNER * threads + at_k], totals,
                    )  # fmt: skip
                for k in range(T.N_SUM, T.N_COLUMN):
                    partial[row + k] = totals[k]

    return step


@cache
def make_close(shape: LaunchShape) -> Any:
    """Build the kernel that adds up the blocks and decides whether to go on; one block of `closers`."""
    closers, segments = shape.closers, shape.segments

    @cuda.jit
    def close(
        n_block: int,
        room: int,
        c: Any,
        partial: Any,
        status: Any,
        motion: Any,
        terms: Any,
        stats: Any,
    ) -> None:
        """Close a step: account, extremes, faults, displacement of the fastest grain, and whether to stop.

        `room` is that for records of ended contacts.
        """
        shared_sums = cuda.shared.array(0, float64)  # a row of columns for each segment
        me = cuda.threadIdx.x
        if status[F.STOP] != STOP_DONE:
            return
        reduce_blocks(closers, segments, n_block, partial, shared_sums)
        if me == 0:
            enter_totals(shared_sums, status, terms[0], stats[0])
            find_fault(room, c, shared_sums, status, stats[0])
            _decide_stop(room, c, status, motion, stats[0])

    return close


@device
def reduce_blocks(closers: int, segments: int, n_block: int, partial: Any, shared_sums: Any) -> None:
    """Add up the columns of all blocks into the first row of `shared_sums`, by all threads of a block."""
    me = cuda.threadIdx.x
    for task in range(me, T.N_COLUMN * segments, closers):
        part = task // T.N_COLUMN
        _reduce_column(task % T.N_COLUMN, part, part, n_block, segments, partial, shared_sums)
    cuda.syncthreads()
    for column in range(me, T.N_COLUMN, closers):
        _reduce_column(column, 0, 0, segments, 1, shared_sums, shared_sums)
    cuda.syncthreads()


@device
def _reduce_column(
    column: int, to: int, begin: int, end: int, every: int, rows: Any, shared_sums: Any
) -> None:
    """Add up one column over some rows, or find its extreme; the pair of the largest overlap goes along."""
    if column == T.OVERLAP:
        best, grain, partner = -1.0, float(NO_GRAIN), float(NO_GRAIN)
        for k in range(begin * T.N_COLUMN, end * T.N_COLUMN, every * T.N_COLUMN):
            ratio, one, other = rows[k + T.OVERLAP], rows[k + T.OVERLAP_GRAIN], rows[k + T.OVERLAP_PARTNER]
            if ratio > best or (ratio == best and (one < grain or (one == grain and other < partner))):
                best, grain, partner = ratio, one, other
        at = to * T.N_COLUMN
        (
            shared_sums[at + T.OVERLAP],
            shared_sums[at + T.OVERLAP_GRAIN],
            shared_sums[at + T.OVERLAP_PARTNER],
        ) = best, grain, partner
        return
    if column in (T.OVERLAP_GRAIN, T.OVERLAP_PARTNER):
        return
    total = float(NO_GRAIN) if column == T.NOT_FINITE else 0.0
    for k in range(begin * T.N_COLUMN + column, end * T.N_COLUMN, every * T.N_COLUMN):
        if column < T.N_SUM:
            total += rows[k]
        elif column == T.NOT_FINITE:
            total = min(total, rows[k])
        else:
            total = max(total, rows[k])
    shared_sums[to * T.N_COLUMN + column] = total


@device
def enter_totals(sums: Any, status: Any, terms: Any, stats: Any) -> None:
    """Enter what a step did: the half interval of water that waited, then its own works; and extremes."""
    _close_fluid_interval(terms, stats)
    stats[S.PENDING_STEP] = sums[T.PENDING_STEP]
    for k in range(N_TERM):
        terms[k] += sums[k]
    stats[S.PENDING_DRAG], stats[S.PENDING_TORQUE] = sums[T.PENDING_DRAG], sums[T.PENDING_TORQUE]
    stats[S.PENDING_LIFT], stats[S.PENDING_FLOW], stats[S.PENDING_FILM] = (
        sums[T.PENDING_LIFT], sums[T.PENDING_FLOW], sums[T.PENDING_FILM],
    )  # fmt: skip
    if status[F.STEP] == status[F.TARGET] - 1:
        stats[S.KINETIC], stats[S.SPIN], stats[S.POTENTIAL] = sums[T.KINETIC], sums[T.SPIN], sums[T.POTENTIAL]
        stats[S.SPRING_N], stats[S.SPRING_S] = sums[T.SPRING_N], sums[T.SPRING_S]
        stats[S.SPRING_R], stats[S.N_CONTACT] = sums[T.SPRING_R], sums[T.N_CONTACT]
    stats[S.SPEED_MAX], stats[S.SPIN_MAX] = math.sqrt(sums[T.SPEED_2]), math.sqrt(sums[T.SPIN_2])
    if sums[T.OVERLAP] > stats[S.OVERLAP_MAX]:
        stats[S.OVERLAP_MAX], stats[S.OVERLAP_GRAIN] = sums[T.OVERLAP], sums[T.OVERLAP_GRAIN]
        stats[S.OVERLAP_STEP] = status[F.STEP]


@device
def find_fault(room: int, c: Any, sums: Any, status: Any, stats: Any) -> None:
    """Find the first fault of a step."""
    if stats[S.OVERLAP_STEP] == status[F.STEP] and stats[S.OVERLAP_MAX] > c[P.OVERLAP_LIMIT]:
        stats[S.FAULT], stats[S.FAULT_GRAIN], stats[S.FAULT_PARTNER] = (
            FAULT_OVERLAP, sums[T.OVERLAP_GRAIN], sums[T.OVERLAP_PARTNER],
        )  # fmt: skip
    elif sums[T.NOT_FINITE] < NO_GRAIN:
        stats[S.FAULT], stats[S.FAULT_GRAIN], stats[S.FAULT_PARTNER] = (
            FAULT_NOT_A_NUMBER, sums[T.NOT_FINITE], -1.0,
        )  # fmt: skip
    elif status[F.ENDED] > room:
        stats[S.FAULT], stats[S.FAULT_GRAIN], stats[S.FAULT_PARTNER] = (
            FAULT_EVENTS_FULL, status[F.OVERFLOWED], -1.0,
        )  # fmt: skip


@device
def _decide_stop(room: int, c: Any, status: Any, motion: Any, stats: Any) -> None:
    """Count the step, and stop for the host where it has something to do."""
    fastest = stats[S.SPEED_MAX]
    travel = motion[F.TRAVEL] + fastest * c[P.DT]
    motion[F.TRAVEL], motion[F.FASTEST] = travel, fastest
    if stats[S.FAULT] != FAULT_NONE:
        status[F.STOP] = STOP_FAULT
    elif fastest * c[P.DT] > c[P.DISPLACEMENT_LIMIT]:
        status[F.STOP] = STOP_UNSAFE
    elif 2.0 * travel > motion[F.SKIN]:
        status[F.STOP] = STOP_LIST
    elif 2 * status[F.ENDED] > room:
        status[F.STOP] = STOP_EVENTS
    status[F.CURRENT] = 1 - status[F.CURRENT]
    status[F.STEP] += 1
