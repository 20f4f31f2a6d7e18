"""Grains of one block move after the shear of their contacts, with exact timing (contact_shear.py)."""

import math
from functools import cache
from typing import Any

from ryusa.compiled.function import compiled
from ryusa.compiled.piece import taken
from ryusa.engine.cpu.integration import gather_incoming, inner_product, square_length
from ryusa.engine.cpu.simd.vec4 import fill4, read4, vec4_of, with_fourth, write4
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import parameters as P
from ryusa.engine.shared.kernel import FAST
from ryusa.engine.shared.variant import MotionKind
from ryusa.model.fluid import SUBMERGED


@cache
def make_advance(kind: MotionKind) -> Any:
    """Build the piece that moves the grains of a block: advance(lo, hi, b, held)."""
    rotation, column, plane = bool(kind.rotation), bool(kind.column), bool(kind.plane_case)

    @compiled(fastmath=FAST)
    def advance(lo: int, hi: int, b: int, held: Any) -> None:
        """Give grains lo..hi-1 the impulses of their contacts between two kicks, and move them."""
        held = taken(held)
        c, grains, pairs, stats = held.c, held.grains, held.pairs, held.accounts.stats[b]
        x, v, w, v_pruned, shifts = grains.x, grains.v, grains.w, grains.v_pruned, grains.film
        impulse = grains.impulse
        f, active, incoming, incoming_start = pairs.f, pairs.active, pairs.incoming, pairs.incoming_start
        dt = c[P.DT]
        gravity = vec4_of(c[P.G_X], 0.0 if plane else c[P.G_Y], c[P.G_Z], 0.0)
        speed_2 = spin_2 = velocity_change_2 = work_2 = raised = 0.0
        for i in range(lo, hi):
            gather_incoming(i, active, incoming, incoming_start, f, shifts)
            push, turn, shift = read4(f, 8 * i), with_fourth(read4(f, 8 * i + 4), 0.0), read4(shifts, 4 * i)
            fill4(f, 8 * i, 0.0)
            fill4(f, 8 * i + 4, 0.0)
            fill4(shifts, 4 * i, 0.0)
            before, inverse, added = read4(v, 8 * i), grains.per_m[i], 0.0
            if column:
                added = (grains.m[i] - grains.m_bare[i]) * grains.fluid[i, SUBMERGED]
                inverse = 1.0 / (grains.m_bare[i] + added)
            after = before + (dt * inverse) * push
            if column:  # what moves along with the grain is taken from the water
                gain = with_fourth(added * (after - before), 0.0)
                write4(impulse, 4 * i, read4(impulse, 4 * i) - gain)
            way = dt * after + inverse * shift
            work_2 += inner_product(push, before + after)
            # beyond what the weight does with the velocities after one kick and before the next
            raised += grains.m_weight[i] * inner_product(
                gravity, inverse * shift + (0.5 * dt) * (after - before)
            )
            write4(x, 4 * i, read4(x, 4 * i) + way)
            write4(v, 8 * i, after)
            if rotation:
                spin = read4(w, 8 * i)
                whirl = spin + (dt * grains.per_inertia[i]) * turn
                work_2 += inner_product(turn, spin + whirl)
                write4(w, 8 * i, whirl)
                spin_2 = max(spin_2, square_length(whirl))
            pace = (1.0 / dt) * way  # of the way that it goes
            speed_2 = max(speed_2, square_length(after), square_length(pace))
            velocity_change_2 = max(velocity_change_2, square_length(pace - read4(v_pruned, 4 * i)))
        stats[S.PENDING_STEP] += 0.5 * dt * work_2 - raised
        stats[S.SPEED_MOVED], stats[S.SPIN_MAX] = math.sqrt(speed_2), math.sqrt(spin_2)
        stats[S.VELOCITY_CHANGE_MOVED] = math.sqrt(velocity_change_2)

    return advance
