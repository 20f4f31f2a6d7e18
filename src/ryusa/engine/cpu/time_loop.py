"""The loop over steps that threads run together, block by block."""

from functools import cached_property
from typing import Any, NamedTuple

import numba

from ryusa.compiled.beside import Beside, Wanted
from ryusa.compiled.borrow import borrow
from ryusa.compiled.piece import LentType, Piece, call, lend
from ryusa.engine.cpu import prune_schedule as K
from ryusa.engine.cpu.advance import make_advance
from ryusa.engine.cpu.arrays import StepArrays, Workspace
from ryusa.engine.cpu.barrier import wait
from ryusa.engine.cpu.block_forces import make_block_forces
from ryusa.engine.cpu.contact_shear import make_contact_shear
from ryusa.engine.cpu.integration import make_integrate, post
from ryusa.engine.cpu.prune import make_prune
from ryusa.engine.cpu.prune_schedule import COST_GRAIN, COST_TEST, ROUNDED_UP, plan_prune, steps_ahead
from ryusa.engine.cpu.rigid_bodies import make_move_bodies
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.contact_instants import AHEAD, REACH
from ryusa.engine.shared.kernel import FAST, kernel
from ryusa.engine.shared.status import (
    FAULT_NONE,
    STOP_DONE,
    STOP_EVENTS,
    STOP_FAULT,
    STOP_LIST,
    STOP_PAIR,
    STOP_UNSAFE,
)
from ryusa.engine.shared.variant import KernelVariant, LawChoice, forces_kind, motion_kind
from ryusa.engine.shared.wall_pose import set_poses


class StepPieces(NamedTuple):
    """What a step calls by address (compiled/piece.py): compiled by kind, the loop over steps is not."""

    prune: Any
    forces: Any
    move: Any
    move_bodies: Any  # None where there are none


class PiecesOfStep:
    """The pieces for a scene, for arrays of these types.

    Forces and motion are half of all that is compiled; another process begins with them (compiled/beside.py),
    while this one compiles what lists and prunes pairs.

    Attributes
    ----------
    forces, shear : what the forces of contacts, and their shear, are compiled from and for.
    """

    def __init__(self, variant: KernelVariant, choice: LawChoice, held: StepArrays, work: Workspace) -> None:
        integer, number, flag = numba.types.int64, numba.types.float64, numba.types.boolean
        lent = LentType(numba.typeof(work)), LentType(numba.typeof(held))
        self._moves, moving = (integer, integer, flag, flag, integer, *lent), motion_kind(variant, choice)
        self._prunes = integer, number, number, integer, *lent
        # all are made before the first is compiled, so that it is known what is left (compiled/waiting.py)
        self._prune = make_prune(bool(variant.walls))
        self._move_bodies = make_move_bodies(moving) if variant.bodies else None
        takes = (integer, integer, integer, number, number, flag, number, *lent)
        kind = forces_kind(variant, choice)
        self.forces = Wanted(make_block_forces, (kind,), takes)
        wanted = [self.forces, Wanted(make_integrate, (moving,), self._moves)]
        self.shear = None
        if variant.exact:
            self.shear = Wanted(make_contact_shear, (kind,), (integer, integer, number, number, *lent))
            wanted += [self.shear, Wanted(make_advance, (moving,), (integer, integer, integer, lent[1]))]
        self._beside = Beside(wanted)

    @cached_property
    def prune(self) -> Piece:
        """The piece that prunes the list of a block."""
        return self._prune.pieces.piece(*self._prunes)

    @cached_property
    def of_step(self) -> StepPieces:
        """All pieces of a step."""
        forces, move, *_ = self._beside.pieces()
        bodies = None if self._move_bodies is None else self._move_bodies.pieces.piece(*self._moves)
        return StepPieces(self.prune, forces, move, bodies)

    @cached_property
    def between_kicks(self) -> tuple[Piece | None, Piece | None]:
        """Shear of contacts and motion of grains; None where contacts begin and end at steps."""
        _, _, *between = self._beside.pieces()
        return (between[0], between[1]) if between else (None, None)


@kernel(nogil=True, fastmath=FAST)
def run(
    thread: int,
    n_threads: int,
    n_steps: int,
    step: int,
    kicked: bool,
    travel: float,
    film_reach: float,
    count: Any,
    pieces: StepPieces,
    shear: Any,
    advance: Any,
    held: StepArrays,
    faces: Any,
    bodies: Any,
    work: Workspace,
    schedule: Any,
) -> tuple[int, float, int, bool]:
    """Do up to n_steps steps; all threads return the same (steps done, travel, stop, kicked).

    `film_reach` is that of films [m], 0 without. `held` is the same for all threads but for its `spare`; its
    `faces` and `bodies` are arguments too, as `shear` and `advance` are, so that what a scene goes without is
    not compiled. With exact timing a step has two halves, kicks and shears, and a list of pairs that is
    renewed is so between them: `kicked` tells whether the first half is done.
    """
    # One function: split into four, W1 and W2 at 2,000 grains took 1 % longer (design/lab/0005)
    held, work, moving = borrow(held), borrow(work), borrow(faces)
    lent, lent_work = lend(held), lend(work)
    c, candidates, block_start = held.c, held.candidates, held.block_start
    stats, pairs, plane = held.accounts.stats, held.pairs, held.plane_case
    n_block, most_ended = len(block_start) - 1, 0.5 * held.accounts.ended.shape[1]
    b_0, b_1 = thread * n_block // n_threads, (thread + 1) * n_block // n_threads
    dt, t_zero, skin, step_limit = c[P.DT], c[P.T_ZERO], c[P.SKIN], c[P.DISPLACEMENT_LIMIT]
    own, span = work.schedule, pairs.span
    for k in range(K.N_SCHEDULE):
        own[k] = schedule[k]
    listing_cost = COST_TEST * pairs.start[held.n] + COST_GRAIN * held.n
    target = done = 0
    stop = STOP_DONE
    while done < n_steps:
        last, begins = done == n_steps - 1, step == 0
        t, hdt = t_zero + step * dt, 0.0 if begins else 0.5 * dt
        ahead = 0.0  # of a displacement, by which grains go on before the list is looked at again
        fastest = change = reach = 0.0
        for b in range(n_block):
            fastest = max(fastest, stats[b, S.SPEED_MAX])
        if shear is not None:
            reach = REACH * fastest * dt
            if faces is not None:
                reach += REACH * moving.speed * dt
            if not kicked:
                if faces is not None:
                    set_poses(t, dt, moving.motion, moving.poses)
                for after in range(2):
                    for b in range(b_0, b_1):
                        if not after:
                            call(pieces.forces, (b, b_0, step, t, hdt, last, reach, lent_work, lent))
                        q = b if after else b - span
                        soon = b_0 + span <= q < b_1 - span
                        if soon != (after == 1):
                            call(
                                pieces.move,
                                (block_start[q], block_start[q + 1], begins, last, q, lent_work, lent),
                            )
                        if after:
                            post(stats[b])
                    target = wait(count, n_threads, target)
                kicked = True
            fastest = 0.0
            for b in range(n_block):
                fastest, change = (
                    max(fastest, stats[b, S.SPEED_MAX]),
                    max(change, stats[b, S.VELOCITY_CHANGE_MAX]),
                )
                if stats[b, S.FAULT_POSTED] != FAULT_NONE:
                    stop = STOP_FAULT
            if stop != STOP_DONE:
                break
            ahead = AHEAD * fastest * dt
            reach = 2.0 * ahead  # after the kicks, which may have set grains going that were at rest
            if faces is not None:
                reach += REACH * moving.speed * dt
        if 2.0 * (travel + ahead) > skin:
            stop = STOP_LIST
            break
        if faces is not None:
            set_poses(t, dt, moving.motion, moving.poses)
        soonest = own[K.APPROACH] + (2.0 * change * dt + 0.1 * ahead)
        if soonest > own[K.SKIN] or own[K.SINCE] >= own[K.LASTS]:
            plan_prune(own, listing_cost)
            own[K.LASTS] = steps_ahead(own, fastest * dt)
            reach_on = ROUNDED_UP * own[K.SKIN] + film_reach
            for b in range(b_0, b_1):
                stats[b, S.N_TOUCHING] = call(
                    pieces.prune, (b, reach_on, own[K.LASTS] * dt, plane, lent_work, lent)
                )
            target = wait(count, n_threads, target)
            own[K.APPROACH] = own[K.SINCE] = own[K.CANDIDATES] = own[K.TOUCHING] = 0.0
            for b in range(n_block):
                own[K.CANDIDATES] += candidates.count[b]
                own[K.TOUCHING] += stats[b, S.N_TOUCHING]
                if stats[b, S.N_TOUCHING] < 0.0:
                    stop = STOP_PAIR
            if stop != STOP_DONE:
                break
        # A block moves as soon as the blocks within `span` have their forces, while its grains are still in
        # the cache. Those that share pairs with blocks of other threads move after the barrier.
        for after in range(2):
            for b in range(b_0, b_1):
                q = b if after else b - span
                soon = b_0 + span <= q < b_1 - span
                if shear is not None:
                    if not after:
                        call(shear, (b, b_0, t, reach, lent_work, lent))
                    if soon != (after == 1):
                        call(advance, (block_start[q], block_start[q + 1], q, lent))
                else:
                    if not after:
                        call(pieces.forces, (b, b_0, step, t, hdt, last, 0.0, lent_work, lent))
                    if soon != (after == 1):
                        call(
                            pieces.move,
                            (block_start[q], block_start[q + 1], begins, last, q, lent_work, lent),
                        )
                if after and bodies is None:
                    post(stats[b])
            target = wait(count, n_threads, target)
        kicked = False
        if bodies is not None:
            n_body = len(bodies.order)
            for b in range(b_0, b_1):
                first, end = b * n_body // n_block, (b + 1) * n_body // n_block
                call(pieces.move_bodies, (first, end, begins, last, b, lent_work, lent))
                post(stats[b])
            target = wait(count, n_threads, target)
        fastest = velocity_change = 0.0
        full = False
        for b in range(n_block):
            fastest, velocity_change = (
                max(fastest, stats[b, S.SPEED_MAX]),
                max(velocity_change, stats[b, S.VELOCITY_CHANGE_MAX]),
            )
            full = full or stats[b, S.N_ENDED_POSTED] > most_ended
            if stats[b, S.FAULT_POSTED] != FAULT_NONE:
                stop = STOP_FAULT
        if faces is not None:
            travel += max(fastest, moving.speed) * dt
        else:
            travel += fastest * dt
        own[K.APPROACH] += 2.0 * velocity_change * dt
        own[K.SINCE] += 1.0
        step += 1
        done += 1
        if fastest * dt > step_limit and stop == STOP_DONE:
            stop = STOP_UNSAFE
        if stop != STOP_DONE:
            break
        if full:
            stop = STOP_EVENTS
            break
    wait(count, n_threads, target)
    if thread == 0:
        for k in range(K.N_SCHEDULE):
            schedule[k] = own[k]
    return done, travel, stop, kicked
