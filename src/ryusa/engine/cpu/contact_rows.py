"""Memory rows and springs of candidate pairs: emptied at first touch, copied from list to list.

In a plane the tangential vectors have one component, and without rolling friction and records the memory of a
pair is four numbers: a short row of SHORT columns, half a cache line.
"""
# ruff: noqa: E741  (l is a lane)

from functools import cache
from typing import Any

import numpy as np

from ryusa.engine.cpu import batch_layout as B
from ryusa.engine.cpu.simd.vec4 import component, copy4, read4, vec4_of, write4
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared.contact_memory import ContactMemory
from ryusa.engine.shared.dashpots import make_set_springs
from ryusa.engine.shared.kernel import FAST, inner
from ryusa.engine.shared.variant import KernelVariant

SHORT = (M.SPRING_S, M.DASH_S, M.DASH_N, M.F_N)  # columns of a whole row that a short one has


def has_short_rows(variant: KernelVariant) -> bool:
    """Whether the memory of a pair fits into a short row."""
    return bool(variant.plane_case) and not variant.rolling and not variant.events


def shortened(memory: ContactMemory) -> ContactMemory:
    """The same memory in short rows."""
    return memory._replace(rows=memory.rows[:, SHORT].copy())


def lengthened(memory: ContactMemory) -> ContactMemory:
    """The same memory in whole rows."""
    rows = np.zeros((len(memory.i), M.WIDTH))
    rows[:, SHORT] = memory.rows
    return memory._replace(rows=rows)


@cache
def make_row_to_lane(short: bool) -> Any:
    """Build row_to_lane(l, k, rows, batch) for short rows or whole ones."""

    @inner(fastmath=FAST)
    def row_to_lane(l: int, k: int, rows: Any, batch: Any) -> None:
        """Copy the memory of candidate k to lane l of a batch."""
        if short:
            row = read4(rows, 4 * k)
            write4(batch, B.SPRING + 4 * l, vec4_of(component(row, 0), 0.0, 0.0, component(row, 3)))
            write4(batch, B.DASH + 4 * l, vec4_of(component(row, 1), 0.0, 0.0, component(row, 2)))
        else:
            width = rows.shape[1]
            copy4(batch, B.SPRING + 4 * l, rows, width * k)
            copy4(batch, B.DASH + 4 * l, rows, width * k + M.DASH_S)

    return row_to_lane


@cache
def make_lane_to_row(short: bool) -> Any:
    """Build lane_to_row(l, k, rows, batch) for short rows or whole ones."""

    @inner(fastmath=FAST)
    def lane_to_row(l: int, k: int, rows: Any, batch: Any) -> None:
        """Copy the memory of lane l of a batch back to candidate k."""
        if short:
            spring, dash = read4(batch, B.SPRING + 4 * l), read4(batch, B.DASH + 4 * l)
            write4(
                rows, 4 * k,
                vec4_of(component(spring, 0), component(dash, 0), component(dash, 3), component(spring, 3)),
            )  # fmt: skip
        else:
            width = rows.shape[1]
            copy4(rows, width * k, batch, B.SPRING + 4 * l)
            copy4(rows, width * k + M.DASH_S, batch, B.DASH + 4 * l)

    return lane_to_row


@inner(fastmath=FAST)
def springs_of_row(k: int, rows: Any) -> tuple[float, float, float, float]:
    """Force of the normal spring, and of the tangential one, of candidate k [N]."""
    if rows.shape[1] == len(SHORT):
        return rows[k, 3] - rows[k, 2], rows[k, 0], 0.0, 0.0
    s = M.SPRING_S
    return rows[k, M.F_N] - rows[k, M.DASH_N], rows[k, s], rows[k, s + 1], rows[k, s + 2]


@inner(fastmath=FAST)
def dashpot_row(k: int, eta: Any) -> int:
    """Row of the dashpots of candidate k."""
    return k if len(eta) > 1 else 0


@cache
def make_begin_row(kind: int) -> Any:
    """Build begin_row for one kind of springs (memory_rows.py)."""
    set_springs = make_set_springs(kind)

    @inner(fastmath=FAST)
    def begin_row(
        k: int, i: int, j: int, rotation: int, c: Any, m: Any, x: Any, inertia: Any, eta: Any, rows: Any
    ) -> None:
        """Clear the row of candidate k, which may touch now and did not before, and set its springs.

        Where all are alike every thread writes the same numbers to the same place.
        """
        for a in range(rows.shape[1]):
            rows[k, a] = 0.0
        set_springs(dashpot_row(k, eta), i, j, rotation, c, m, x, inertia, eta)

    return begin_row


@inner(fastmath=FAST)
def copy_row(at: int, to_eta: Any, to_rows: Any, of: int, eta: Any, rows: Any) -> None:
    """Copy dashpots and memory of pair `of` of one list to pair `at` of another, by whole vectors."""
    width = rows.shape[1]
    a, e = dashpot_row(at, to_eta), dashpot_row(of, eta)
    for k in range(eta.shape[1]):
        to_eta[a, k] = eta[e, k]
    for k in range(0, width - 3, 4):
        copy4(to_rows, width * at + k, rows, width * of + k)
    for k in range(width // 4 * 4, width):
        to_rows[at, k] = rows[of, k]
