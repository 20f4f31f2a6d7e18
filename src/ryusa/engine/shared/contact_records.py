"""Open records of contacts: what is written at first touch, while touching, and at parting."""
# ruff: noqa: F403, F405  (the columns of rows.py, all of them plain integers)

from typing import Any

from ryusa.engine.cpu.arrays import Grains
from ryusa.engine.shared.kernel import kernel
from ryusa.engine.shared.rows import *
from ryusa.model.enums import EventRule

Vector = tuple[float, float, float]
ONLY_TRACKED = int(EventRule.TRACKED)


@kernel()
def _put(record: Any, column: int, plane_case: int, s: Vector, n: Vector) -> None:
    # a plane scene hands over one component along the tangent (n_z, 0, -n_x)
    if plane_case:
        record[column], record[column + 1], record[column + 2] = s[0] * n[2], 0.0, -s[0] * n[0]
    else:
        record[column], record[column + 1], record[column + 2] = s


@kernel()
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
    grains: Grains,
    l_x: float,
    l_y: float,
) -> None:
    """Open the record of a pair in its first step of touch; the moment of touch is interpolated."""
    x, v, w, ids, image, tracked = grains.x, grains.v, grains.w, grains.ids, grains.image, grains.tracked
    if rule == ONLY_TRACKED and not (tracked[ids[i]] or (j < n and tracked[ids[j]])):
        record[E_J] = -1.0  # nobody asked for this one
        return
    record[E_I] = ids[i]
    record[E_J] = ids[j] if j < n else j
    record[E_T_BEGIN] = t - min(overlap / closing, dt) if closing > 0.0 else t
    record[E_T_END] = t
    record[E_CLOSING_BEGIN] = closing
    _put(record, E_SLIP_BEGIN, plane_case, slip, normal)
    record[E_ALONE] = 1.0
    record[E_X_BEGIN] = x[i, 0] + (image[i, 0] * l_x if image[i, 0] != 0 else 0.0)
    record[E_X_BEGIN + 1] = x[i, 1] + (image[i, 1] * l_y if image[i, 1] != 0 else 0.0)
    record[E_X_BEGIN + 2] = x[i, 2]
    for k in range(3):
        record[E_V_BEGIN + k] = v[i, k]
        record[E_OMEGA_BEGIN + k] = w[i, k]


@kernel()
def keep_record(
    record: Any,
    t: float,
    dt: float,
    overlap: float,
    f_n: float,
    f_raw: float,
    force: Vector,
    sliding: bool,
    company: bool,
) -> None:
    """Carry an open record through a step of touch; until the pair parts T_PART holds the last f_n."""
    if record[E_J] < 0.0:
        return
    record[E_OVERLAP_MAX] = max(record[E_OVERLAP_MAX], overlap)
    record[E_IMPULSE_N] += f_n * dt
    for k in range(3):
        record[E_IMPULSE + k] += force[k] * dt
    if sliding and f_n != 0.0:
        record[E_T_SLIDE] += dt
    if company:
        record[E_ALONE] = 0.0
    if f_n != 0.0:
        record[E_T_END] = t
    elif record[E_T_PART] > 0.0:  # the force ended within this step
        record[E_T_END] = t - dt * f_raw / (f_raw - record[E_T_PART])
    record[E_T_PART] = f_n


@kernel()
def end_record(
    plane_case: int,
    tension: int,
    record: Any,
    f_n: float,
    t: float,
    overlap: float,
    closing: float,
    slip: Vector,
    normal: Vector,
    i: int,
    v: Any,
    w: Any,
    ended: Any,
    now: Any,
) -> None:
    """Close a record in the first step without overlap and put it with the ended ones of the block."""
    record[E_T_PART] = t + overlap / abs(closing) if closing < 0.0 else t
    if tension or f_n > 0.0:
        record[E_T_END] = record[E_T_PART]
    record[E_CLOSING_END] = closing
    _put(record, E_SLIP_END, plane_case, slip, normal)
    for k in range(3):
        record[E_V_END + k] = v[i, k]
        record[E_OMEGA_END + k] = w[i, k]
    slot = int(now[N_N_ENDED])
    if slot < len(ended):
        for k in range(N_EVENT):
            ended[slot, k] = record[k]
        now[N_N_ENDED] = slot + 1
    elif now[N_FAULT] == FAULT_NONE:
        now[N_FAULT], now[N_FAULT_GRAIN], now[N_FAULT_PARTNER] = FAULT_EVENTS_FULL, record[E_I], record[E_J]
