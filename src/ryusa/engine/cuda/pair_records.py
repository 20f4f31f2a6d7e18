"""The record of one contact: begun, kept, and put with those that ended."""

import math
from functools import cache
from typing import Any

from numba import float64

from ryusa.engine.cuda import run_status as F
from ryusa.engine.cuda.arrays import RecordedGrains
from ryusa.engine.cuda.device import cuda, device, on_device
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import memory_rows as M
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.contact_instants import APART, dashes, is_held
from ryusa.engine.shared.contact_records import (
    add_impulses,
    begin_record,
    end_record,
    is_before_its_touch,
    keep_record,
    touch_as_they_pass,
)
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.model.contacts import N_EVENT

Vector = tuple[float, float, float]
_begin_record, _keep_record = on_device(begin_record), on_device(keep_record)
_end_record, _is_before_its_touch = on_device(end_record), on_device(is_before_its_touch)
_touch_as_they_pass, _add_impulses = on_device(touch_as_they_pass), on_device(add_impulses)
_is_held, _dashes = on_device(is_held), on_device(dashes)


@cache
def make_record(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build what a step does with the record of one pair."""
    plane_case, exact = variant.plane_case, variant.exact
    tension, rule, n_stat = choice.tension, choice.events, S.N_STATISTIC

    @device
    def record_pair(
        i: int, j: int, n: int, was: int, now: int, t: float, dt: float, overlap: float, closing: float,
        f_n: float, raw: float, slides: bool, others: bool, eta: Any, normal: Vector, slip: Vector,
        force: Vector, grains: RecordedGrains, l_x: float, l_y: float, record: Any, status: Any, ended: Any,
    ) -> None:  # fmt: skip
        """Carry the record of a pair that touches, or did in the last step, through a step.

        Parameters
        ----------
        was, now, f_n, raw : states and forces of the pair, as from the contact.
        others : whether either grain touches another one.
        ended : records that wait to be fetched; `status` counts them.
        """
        touching = overlap > 0.0
        if touching and was == 0:
            for e in range(N_EVENT):
                record[e] = 0.0
            _begin_record(
                plane_case, rule, record, t, dt, overlap, closing, slip, normal, i, j, n, grains, l_x, l_y
            )
        pulls, f_last, t_end = tension, record[R.T_PART], record[R.T_END]
        if exact:  # the end of the force is known, but where others pushed the grains apart
            pulls, f_last = 0, 1.0 if _dashes(float(was)) else 0.0
            f_n, raw = raw, f_n  # impulses are those of the kicks
            if was != 0 and not touching:  # half of a dashpot may still act
                _add_impulses(record, f_n, force, dt)
                closing -= f_n * dt / eta[M.MASS]
                if _is_before_its_touch(record, eta[M.MASS]):
                    record[R.PARTNER] = -1.0
        if touching:
            _keep_record(record, t, dt, overlap, f_n, raw, force, slides, others)
            if exact and not _is_held(now):
                record[R.T_END] = t_end
        elif was != 0 and record[R.PARTNER] >= 0.0:
            slot = cuda.atomic.add(status, F.ENDED, 1)  # they are put in order later
            if slot < ended.shape[0]:
                record_stats = cuda.local.array(n_stat, float64)
                record_stats[S.N_ENDED] = record_stats[S.FAULT] = 0.0
                _end_record(
                    plane_case, pulls, record, f_last, t, dt, overlap, closing, slip, normal, i, grains.v,
                    grains.w, ended[slot : slot + 1], record_stats,
                )  # fmt: skip
            else:
                cuda.atomic.min(status, F.OVERFLOWED, grains.ids[i])

    return record_pair


@cache
def make_record_between(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build what happens to the record of one pair between two kicks."""
    plane_case, rule = variant.plane_case, choice.events

    @device
    def record_between(
        i: int, j: int, n: int, was: int, when: float, slid: float, t: float, dt: float, overlap: float,
        closing: float, bend: float, f_n: float, normal: Vector, slip: Vector, force: Vector,
        grains: RecordedGrains, l_x: float, l_y: float, record: Any,
    ) -> None:  # fmt: skip
        """Begin the record of a pair that touches, add its impulse, and keep the end of its force.

        Parameters
        ----------
        was : state after the kick.
        bend : of `bending` [m/s2].
        when, slid : time of touch or release after t, and whether it slid, from the pair.
        f_n, force : of its impulses over the step, normal and on the grain at place i [N].
        """
        touches = not _is_held(was)
        if was == APART:
            for e in range(N_EVENT):
                record[e] = 0.0
            _begin_record(
                plane_case, rule, record, t, dt, overlap, closing, slip, normal, i, j, n, grains, l_x, l_y
            )
            _touch_as_they_pass(record, t, dt, -overlap, closing, bend)
        if record[R.PARTNER] >= 0.0:
            _add_impulses(record, f_n, force, dt)
            if when < math.inf:
                if not touches:
                    record[R.T_END] = t + when
                if slid > 0.0:
                    record[R.T_SLIDE] += dt - when if touches else when

    return record_between
