"""Records of contacts: opened at first touch, kept while touching, closed at parting."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.kernel import FAST, kernel
from ryusa.engine.shared.status import FAULT_EVENTS_FULL, FAULT_NONE
from ryusa.model import EVENT, State
from ryusa.model.contacts import N_EVENT, in_order_of_parting
from ryusa.model.scene import EventRule, Floats

Vector = tuple[float, float, float]
ONLY_TRACKED = int(EventRule.TRACKED)
ROUND_OFF = 1e-9  # of the momentum along the normal that a contact would turn round


@kernel(fastmath=FAST, forceinline=True)
def _put(record: Any, column: int, plane_case: int, s: Vector, n: Vector) -> None:
    # a plane scene hands over one component along the tangent (n_z, 0, -n_x)
    if plane_case:
        record[column], record[column + 1], record[column + 2] = s[0] * n[2], 0.0, -s[0] * n[0]
    else:
        record[column], record[column + 1], record[column + 2] = s


@kernel(fastmath=FAST, forceinline=True)
def begin_record(
    plane_case: int,
    rule: int,
    record: Any,
    t: float,
    dt: float,
    overlap: float,
    closing: float,
    slip: Vector,
    normal: Vector,
    i: int,
    j: int,
    n: int,
    grains: Any,
    l_x: float,
    l_y: float,
) -> None:
    """Open the record of a pair in its first step of touch; the moment of touch is interpolated."""
    x, v, w, ids, image, tracked = grains.x, grains.v, grains.w, grains.ids, grains.image, grains.tracked
    if rule == ONLY_TRACKED and not (tracked[ids[i]] or (j < n and tracked[ids[j]])):
        record[R.PARTNER] = -1.0  # not recorded
        return
    record[R.GRAIN] = ids[i]
    record[R.PARTNER] = ids[j] if j < n else j
    record[R.T_BEGIN] = t - min(overlap / closing, dt) if closing > 0.0 else t
    record[R.T_END] = t
    record[R.CLOSING_BEGIN] = closing
    _put(record, R.SLIP_BEGIN, plane_case, slip, normal)
    record[R.ALONE] = 1.0
    record[R.X_BEGIN] = x[i, 0] + (image[i, 0] * l_x if image[i, 0] != 0 else 0.0)
    record[R.X_BEGIN + 1] = x[i, 1] + (image[i, 1] * l_y if image[i, 1] != 0 else 0.0)
    record[R.X_BEGIN + 2] = x[i, 2]
    for k in range(3):
        record[R.V_BEGIN + k] = v[i, k]
        record[R.OMEGA_BEGIN + k] = w[i, k]


@kernel(fastmath=FAST, forceinline=True)
def add_impulses(record: Any, f_n: float, force: Vector, dt: float) -> None:
    """Add what a normal force, and all of the force on i [N], give in a time [s]."""
    record[R.IMPULSE_N] += f_n * dt
    for k in range(3):
        record[R.IMPULSE + k] += force[k] * dt


@kernel(fastmath=FAST, forceinline=True)
def touch_as_they_pass(record: Any, t: float, dt: float, gap: float, closing: float, bend: float) -> None:
    """Set moment and closing speed of a touch ahead, where free grains meet on their straight ways.

    Parameters
    ----------
    gap, closing : between their surfaces at t [m], and the speed at which it closes then [m/s].
    bend : of `contact_instants.bending` [m/s2].
    """
    at_touch = math.sqrt(max(closing * closing - 2.0 * bend * gap, 0.0))
    record[R.T_BEGIN] = t + min(2.0 * gap / (closing + at_touch), dt)
    record[R.CLOSING_BEGIN] = at_touch


@kernel(fastmath=FAST, forceinline=True)
def is_before_its_touch(record: Any, m: float) -> bool:
    """Whether round-off alone put the touch of a record before a step: it has no overlap and no impulse.

    The touch comes in the next step, with a record of its own; `m` is the effective mass [kg].
    """
    least = ROUND_OFF * m * record[R.CLOSING_BEGIN]
    return record[R.OVERLAP_MAX] == 0.0 and abs(record[R.IMPULSE_N]) <= least


@kernel(fastmath=FAST, forceinline=True)
def keep_record(
    record: Any,
    t: float,
    dt: float,
    overlap: float,
    f_n: float,
    f_raw: float,
    force: Vector,
    sliding: bool,
    others: bool,
) -> None:
    """Carry an open record through a step of touch; until the pair parts T_PART holds the last f_n."""
    if record[R.PARTNER] < 0.0:
        return
    record[R.OVERLAP_MAX] = max(record[R.OVERLAP_MAX], overlap)
    add_impulses(record, f_n, force, dt)
    if sliding and f_n != 0.0:
        record[R.T_SLIDE] += dt
    if others:
        record[R.ALONE] = 0.0
    if f_n != 0.0:
        record[R.T_END] = t
    elif record[R.T_PART] > 0.0:  # the force ended within this step
        record[R.T_END] = t - dt * f_raw / (f_raw - record[R.T_PART])
    record[R.T_PART] = f_n


@kernel(fastmath=FAST, forceinline=True)
def end_record(
    plane_case: int,
    tension: int,
    record: Any,
    f_n: float,
    t: float,
    dt: float,
    overlap: float,
    closing: float,
    slip: Vector,
    normal: Vector,
    i: int,
    v: Any,
    w: Any,
    ended: Any,
    stats: Any,
) -> None:
    """Close a record in the first step without overlap and put it with the ended ones of the block.

    The moment of parting is interpolated: within the step, as others may have slowed the pair down since, and
    not before the touch, which may lie in the same step.
    """
    back = min(-overlap / abs(closing), dt) if closing < 0.0 else 0.0
    record[R.T_PART] = max(t - back, record[R.T_BEGIN])
    if tension or f_n > 0.0:
        record[R.T_END] = record[R.T_PART]
    record[R.CLOSING_END] = closing
    _put(record, R.SLIP_END, plane_case, slip, normal)
    for k in range(3):
        record[R.V_END + k] = v[i, k]
        record[R.OMEGA_END + k] = w[i, k]
    slot = int(stats[S.N_ENDED])
    if slot < len(ended):
        for k in range(N_EVENT):
            ended[slot, k] = record[k]
        stats[S.N_ENDED] = slot + 1
    elif stats[S.FAULT] == FAULT_NONE:
        stats[S.FAULT], stats[S.FAULT_GRAIN], stats[S.FAULT_PARTNER] = (
            FAULT_EVENTS_FULL,
            record[R.GRAIN],
            record[R.PARTNER],
        )


def closed_records(state: State, places: np.ndarray) -> np.ndarray:
    """Open records of contacts whose partner is taken away, closed now; values at parting stay nan."""
    rows = state.contacts.event[places].copy()
    gave = (rows[:, R.OVERLAP_MAX] > 0.0) | (rows[:, R.IMPULSE_N] != 0.0)
    rows = rows[(rows[:, R.PARTNER] >= 0.0) & gave]
    rows[:, R.T_END] = rows[:, R.T_PART] = state.t
    rows[:, R.CLOSING_END], rows[:, R.ALONE] = np.nan, 0.0
    rows[:, R.SLIP_END : R.SLIP_END + 3] = np.nan
    grains = rows[:, R.GRAIN].astype(np.int64)
    rows[:, R.V_END : R.V_END + 3] = state.v[grains]
    rows[:, R.OMEGA_END : R.OMEGA_END + 3] = state.omega[grains]
    return rows


def sorted_events(drained: Sequence[Floats]) -> np.ndarray:
    """Records of ended contacts, arrays of shape (n, N_EVENT), as a structured array in order of parting."""
    rows = np.concatenate([np.zeros((0, N_EVENT)), *drained])
    ids = rows[:, : R.T_BEGIN].astype(np.int64)
    rows.view(np.int64)[:, : R.T_BEGIN] = ids
    return in_order_of_parting(rows.view(EVENT).reshape(-1))
