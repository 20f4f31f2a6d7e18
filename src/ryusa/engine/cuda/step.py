"""One step: a kernel in which every grain gathers its forces and moves, and one that adds up what is left."""
# ruff: noqa: F403, F405  (the columns of rows.py, all of them plain integers)

import math
from functools import cache
from typing import Any

from numba import float64

from ryusa.engine.cpu.fluid_forces import close_interval
from ryusa.engine.cuda.arrays import *
from ryusa.engine.cuda.device import cuda, device, same
from ryusa.engine.cuda.integration import make_move
from ryusa.engine.cuda.pair import guard, make_touch, meet
from ryusa.engine.shared.contact_records import begin_record, end_record, keep_record
from ryusa.engine.shared.pair import ROLL_PRINTED, roll, roll_out
from ryusa.engine.shared.rows import *
from ryusa.laws.geometry import wrap
from ryusa.laws.immersed import lubrication_force
from ryusa.laws.rolling import reduced_radius
from ryusa.model.contacts import N_EVENT
from ryusa.model.tally import N_BOOK, Book

B_ROLL, B_RELEASED_R = int(Book.ROLL), int(Book.RELEASED_R)

_roll, _roll_out, _close_interval = same(roll), same(roll_out), same(close_interval)
_begin_record, _keep_record, _end_record = same(begin_record), same(keep_record), same(end_record)


@cache
def make_step(kind: Variant, choice: Choice, shape: Shape) -> Any:
    """Build the kernel of one variant, for blocks of one shape."""
    plane_case, rolling, events, film = kind.plane_case, kind.rolling, kind.events, kind.film
    model, arms, tension, rule = choice.rolling, choice.arm, choice.tension, choice.events
    record_at, threads, group, parts = kind.event_column, shape.threads, shape.group, shape.parts
    run = threads // parts
    both_ways = 1.0 if model == ROLL_PRINTED else -1.0  # Eq. (13) as printed turns both grains one way
    touch, move = make_touch(kind, choice), make_move(kind, choice)

    @cuda.jit
    def step(
        target: int,
        n: int,
        n_solid: int,
        c: Any,
        flow: Any,
        bodies: Bodies,
        walls: Walls,
        pairs: Pairs,
        ended: Any,
        partial: Any,
    ) -> None:
        """Do one step, unless something waits for the host; step `target` - 1 is the last of a call."""
        if flow[F_STOP] != STOP_DONE:
            return
        account = cuda.local.array(N_COLUMN, float64)
        for k in range(N_COLUMN):
            account[k] = 0.0
        account[A_OVERLAP], account[A_OVERLAP_GRAIN] = -1.0, NOBODY
        account[A_OVERLAP_PARTNER], account[A_BAD] = NOBODY, NOBODY
        book = cuda.local.array(N_BOOK, float64)
        last_words = cuda.local.array(N_NOW, float64)
        half, at = flow[F_PARITY], flow[F_STEP]
        first, last = at == 0, at == target - 1
        dt, k_n, k_s = c[C_DT], c[C_K_N], c[C_K_S]
        l_x, l_y = c[C_PERIOD_X], c[C_PERIOD_Y]
        t, hdt = c[C_T_ZERO] + at * dt, 0.0 if first else 0.5 * dt
        film_reach = c[C_FILM_REACH] if film else 0.0
        x, v, w, m, inertia, ids = (
            bodies.x[half],
            bodies.v[half],
            bodies.w[half],
            bodies.m,
            bodies.inertia,
            bodies.ids,
        )
        touched = bodies.touched[half]
        start, partners, lives, rows = pairs.start, pairs.partners, pairs.live, pairs.rows

        for i in range(cuda.grid(1), n, cuda.gridsize(1)):
            x_i, y_i, z_i, r_i = x[i, 0], x[i, 1], x[i, 2], x[i, 3]
            id_i = ids[i]
            f_x = f_y = f_z = t_x = t_y = t_z = h_x = h_y = h_z = 0.0
            hits = 0
            for k in range(start[i], start[i + 1]):
                j = partners[k]
                plane = j >= n_solid
                own = j >= n or ids[j] > id_i  # this side keeps books and records
                sign = 1.0 if own else -1.0
                r_j = r_i
                if plane:  # met as a grain of the same size that touches it from behind
                    gap = 0.0
                    for a in range(3):
                        gap += (x[i, a] - walls.points[j - n_solid, a]) * walls.normals[j - n_solid, a]
                    away = -(gap + r_i)
                    d_x = away * walls.normals[j - n_solid, 0]
                    d_y = away * walls.normals[j - n_solid, 1]
                    d_z = away * walls.normals[j - n_solid, 2]
                else:
                    d_x, d_y, d_z = sign * (x[j, 0] - x_i), sign * (x[j, 1] - y_i), sign * (x[j, 2] - z_i)
                    r_j = x[j, 3]
                d_x, d_y = wrap(d_x, l_x), wrap(d_y, l_y)
                square = d_x * d_x + d_z * d_z
                if not plane_case:
                    square += d_y * d_y
                reach = r_i + r_j + film_reach
                was = lives[k] != 0
                if not (was or square < reach * reach):
                    continue

                # seen from the grain with the lower id, whichever side this is: both get the same bits
                u = (sign * (v[i, 0] - v[j, 0]), sign * (v[i, 1] - v[j, 1]), sign * (v[i, 2] - v[j, 2]))
                a, b = (i, j) if own else (j, i)
                r_a, r_b = (r_i, r_j) if own else (r_j, r_i)
                w_a, w_b = (w[a, 0], w[a, 1], w[a, 2]), (w[b, 0], w[b, 1], w[b, 2])
                met = meet(plane_case, (d_x, d_y, d_z), r_a, r_b, u, w_a, w_b, dt)
                normal, overlap, arm_a, arm_b, closing, slip, _ = met
                arm_i = arm_a if own else arm_b
                weight = 1.0 if own else 0.0
                if was or overlap > 0.0:
                    row = rows[k]
                    live, f_n, raw, slides, along, turned = touch(
                        a, b, weight, was, hdt, c, m, w, met, pairs.eta[k], row, account
                    )
                    lives[k] = 1 if live else 0
                    p_x, p_y, p_z = (
                        along[0] - f_n * normal[0], along[1] - f_n * normal[1], along[2] - f_n * normal[2],
                    )  # fmt: skip
                    f_x, f_y, f_z = f_x + sign * p_x, f_y + sign * p_y, f_z + sign * p_z
                    t_x, t_y, t_z = t_x + arm_i * turned[0], t_y + arm_i * turned[1], t_z + arm_i * turned[2]
                    if live:
                        hits += 1
                        if own:
                            guard(
                                overlap / (2.0 * min(r_i, r_j)),
                                float(id_i),
                                float(ids[j] if j < n else j),
                                account,
                            )
                    if rolling:
                        for a_book in range(N_BOOK):
                            book[a_book] = 0.0
                        r_wall = math.inf if plane else r_j  # of a plane
                        if live:
                            share_i, share_j = float(max(touched[i], 1)), 1.0
                            if j < n:
                                share_j = float(max(touched[j], 1))
                            side_i = (r_i, m[i], inertia[i], share_i)
                            side_j = (r_wall, m[j], inertia[j], share_j)
                            q_x, q_y, q_z, held = _roll(
                                model, arms, row, c, f_n, overlap, hdt,
                                side_i if own else side_j, side_j if own else side_i,
                                normal, (
                                    normal[1] * p_z - normal[2] * p_y,
                                    normal[2] * p_x - normal[0] * p_z,
                                    normal[0] * p_y - normal[1] * p_x,
                                ), w_a, w_b, book,
                            )  # fmt: skip
                            turn_i = 1.0 if own else both_ways
                            t_x, t_y, t_z = t_x + turn_i * q_x, t_y + turn_i * q_y, t_z + turn_i * q_z
                            if last:
                                account[A_SPRING_R] += weight * held
                        elif was:
                            _roll_out(model, row, c, hdt, w_a, w_b, reduced_radius(r_i, r_wall), book)
                        account[B_ROLL] += weight * book[B_ROLL]
                        account[B_RELEASED_R] += weight * book[B_RELEASED_R]
                    if events and own:
                        record = row[record_at:]
                        if live and not was:
                            for e in range(N_EVENT):
                                record[e] = 0.0
                            seen: Any = Placed(x, v, w, ids, bodies.image, bodies.tracked)
                            _begin_record(
                                plane_case, rule, record, t, dt, overlap, closing, slip, normal, i, j, n,
                                seen, l_x, l_y,
                            )  # fmt: skip
                        if live:
                            company = touched[i] > 1 or (j < n and touched[j] > 1)
                            _keep_record(record, t, dt, overlap, f_n, raw, (p_x, p_y, p_z), slides, company)
                        elif was and record[E_J] >= 0.0:
                            slot = cuda.atomic.add(flow, F_ENDED, 1)  # they are put in order later
                            if slot < ended.shape[0]:
                                last_words[N_N_ENDED] = last_words[N_FAULT] = 0.0
                                _end_record(
                                    plane_case, tension, record, record[E_T_PART], t, overlap, closing, slip,
                                    normal, i, v, w, ended[slot : slot + 1], last_words,
                                )  # fmt: skip
                            else:
                                cuda.atomic.min(flow, F_SPILT, id_i)
                    if last and live and own:
                        e_n = f_n - row[R_DASH_N]
                        if k_n > 0.0:
                            account[A_SPRING_N] += 0.5 * e_n * e_n / k_n
                        if k_s > 0.0:
                            for s in range(3):
                                account[A_SPRING_S] += 0.5 * row[R_SPRING_S + s] ** 2 / k_s
                        account[A_N_CONTACT] += 1.0
                if film and overlap <= 0.0 and overlap > -film_reach:
                    radius = reduced_radius(r_i, math.inf if plane else r_j)
                    push = sign * lubrication_force(
                        -overlap, closing, radius, c[C_ASPERITY], film_reach, c[C_RHO_W], c[C_NU]
                    )
                    h_x, h_y, h_z = h_x - push * normal[0], h_y - push * normal[1], h_z - push * normal[2]
            bodies.touched[1 - half, i] = hits
            move(i, half, first, last, c, bodies, (f_x, f_y, f_z), (t_x, t_y, t_z), (h_x, h_y, h_z), account)

        # what the threads of a block have in their accounts, added in a fixed order
        desk = cuda.shared.array(0, float64)  # `Shape.desk` doubles: a row a column, then sums of parts
        sums, me, row = group * threads, cuda.threadIdx.x, cuda.blockIdx.x * N_COLUMN
        for lead in range(0, N_COLUMN, group):
            cuda.syncthreads()
            for k in range(group):
                desk[k * threads + me] = account[lead + k]
            cuda.syncthreads()
            for task in range(me, group * parts, threads):
                column, part = task % group, task // group
                total = 0.0
                for k in range(part * run, (part + 1) * run):
                    total += desk[column * threads + k]
                desk[sums + task] = total
            cuda.syncthreads()
            for column in range(me, group, threads):
                if lead + column < N_SUM:
                    total = 0.0
                    for part in range(parts):
                        total += desk[sums + part * group + column]
                    partial[row + lead + column] = total
            if me == 0 and lead + group > N_SUM:
                for k in range(1, threads):
                    at_k = k - lead * threads
                    account[A_SPEED_2] = max(account[A_SPEED_2], desk[A_SPEED_2 * threads + at_k])
                    account[A_SPIN_2] = max(account[A_SPIN_2], desk[A_SPIN_2 * threads + at_k])
                    account[A_BAD] = min(account[A_BAD], desk[A_BAD * threads + at_k])
                    guard(
                        desk[A_OVERLAP * threads + at_k], desk[A_OVERLAP_GRAIN * threads + at_k],
                        desk[A_OVERLAP_PARTNER * threads + at_k], account,
                    )  # fmt: skip
                for k in range(N_SUM, N_COLUMN):
                    partial[row + k] = account[k]

    return step


@cache
def make_close(shape: Shape) -> Any:
    """Build the kernel that adds up the blocks and decides whether to go on; one block of `closers`."""
    closers, segments = shape.closers, shape.segments

    @cuda.jit
    def close(
        target: int, n_block: int, room: int, c: Any, partial: Any, flow: Any, pace: Any, books: Any, now: Any
    ) -> None:
        """Close a step: books, extremes, faults, how far the fastest grain went, and whether to stop.

        `room` is that for records of ended contacts.
        """
        desk = cuda.shared.array(0, float64)  # a row of columns for each segment
        me = cuda.threadIdx.x
        if flow[F_STOP] != STOP_DONE:
            return
        for task in range(me, N_COLUMN * segments, closers):
            part = task // N_COLUMN
            _add_up(task % N_COLUMN, part, part, n_block, segments, partial, desk)
        cuda.syncthreads()
        for column in range(me, N_COLUMN, closers):
            _add_up(column, 0, 0, segments, 1, desk, desk)
        cuda.syncthreads()
        if me == 0:
            _enter(target, desk, flow, books[0], now[0])
            _decide(room, c, desk, flow, pace, now[0])

    return close


@device
def _add_up(column: int, to: int, begin: int, end: int, every: int, rows: Any, desk: Any) -> None:
    """Add up one column over some rows, or find its extreme; the pair of the largest overlap goes along."""
    if column == A_OVERLAP:
        best, grain, partner = -1.0, float(NOBODY), float(NOBODY)
        for k in range(begin * N_COLUMN, end * N_COLUMN, every * N_COLUMN):
            ratio, one, other = rows[k + A_OVERLAP], rows[k + A_OVERLAP_GRAIN], rows[k + A_OVERLAP_PARTNER]
            if ratio > best or (ratio == best and (one < grain or (one == grain and other < partner))):
                best, grain, partner = ratio, one, other
        at = to * N_COLUMN
        desk[at + A_OVERLAP], desk[at + A_OVERLAP_GRAIN], desk[at + A_OVERLAP_PARTNER] = best, grain, partner
        return
    if column in (A_OVERLAP_GRAIN, A_OVERLAP_PARTNER):
        return
    total = float(NOBODY) if column == A_BAD else 0.0
    for k in range(begin * N_COLUMN + column, end * N_COLUMN, every * N_COLUMN):
        if column < N_SUM:
            total += rows[k]
        elif column == A_BAD:
            total = min(total, rows[k])
        else:
            total = max(total, rows[k])
    desk[to * N_COLUMN + column] = total


@device
def _enter(target: int, sums: Any, flow: Any, books: Any, now: Any) -> None:
    """Enter what a step did: the half interval of water that waited, then its own works; and extremes."""
    _close_interval(books, now)
    for k in range(N_BOOK):
        books[k] += sums[k]
    now[N_PEND_DRAG], now[N_PEND_TORQUE] = sums[A_PEND_DRAG], sums[A_PEND_TORQUE]
    now[N_PEND_LIFT], now[N_PEND_FLOW], now[N_PEND_FILM] = (
        sums[A_PEND_LIFT], sums[A_PEND_FLOW], sums[A_PEND_FILM],
    )  # fmt: skip
    if flow[F_STEP] == target - 1:
        now[N_KINETIC], now[N_SPIN], now[N_POTENTIAL] = sums[A_KINETIC], sums[A_SPIN], sums[A_POTENTIAL]
        now[N_SPRING_N], now[N_SPRING_S] = sums[A_SPRING_N], sums[A_SPRING_S]
        now[N_SPRING_R], now[N_N_CONTACT] = sums[A_SPRING_R], sums[A_N_CONTACT]
    now[N_SPEED_MAX], now[N_SPIN_MAX] = math.sqrt(sums[A_SPEED_2]), math.sqrt(sums[A_SPIN_2])
    if sums[A_OVERLAP] > now[N_OVERLAP_MAX]:
        now[N_OVERLAP_MAX], now[N_OVERLAP_GRAIN] = sums[A_OVERLAP], sums[A_OVERLAP_GRAIN]
        now[N_OVERLAP_STEP] = flow[F_STEP]


@device
def _decide(room: int, c: Any, sums: Any, flow: Any, pace: Any, now: Any) -> None:
    """Find the first fault, count the step, and stop for the host where it has something to do."""
    if now[N_OVERLAP_STEP] == flow[F_STEP] and now[N_OVERLAP_MAX] > c[C_OVERLAP_LIMIT]:
        now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = (
            FAULT_OVERLAP, sums[A_OVERLAP_GRAIN], sums[A_OVERLAP_PARTNER],
        )  # fmt: skip
    elif sums[A_BAD] < NOBODY:
        now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_NOT_A_NUMBER, sums[A_BAD], -1.0
    elif flow[F_ENDED] > room:
        now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_EVENTS_FULL, flow[F_SPILT], -1.0
    fastest = now[N_SPEED_MAX]
    travel = pace[P_TRAVEL] + fastest * c[C_DT]
    pace[P_TRAVEL], pace[P_FASTEST] = travel, fastest
    if now[N_FAULT] != FAULT_NONE:
        flow[F_STOP] = STOP_FAULT
    elif fastest * c[C_DT] > c[C_STEP_LIMIT]:
        flow[F_STOP] = STOP_UNSAFE
    elif 2.0 * travel > pace[P_SKIN]:
        flow[F_STOP] = STOP_LIST
    elif 2 * flow[F_ENDED] > room:
        flow[F_STOP] = STOP_EVENTS
    flow[F_PARITY] = 1 - flow[F_PARITY]
    flow[F_STEP] += 1
