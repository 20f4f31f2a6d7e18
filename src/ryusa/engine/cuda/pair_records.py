"""The record of one contact: begun, kept, and put with those that ended."""

import math
from functools import cache
from typing import Any

from numba import float64

from ryusa.engine.cuda import run_status as F
from ryusa.engine.cuda.arrays import RecordedGrains
from ryusa.engine.cuda.device import cuda, device, on_device
from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.contact_records import begin_record, end_record, keep_record
from ryusa.engine.shared.variant import KernelVariant, LawChoice
from ryusa.model.contacts import N_EVENT

Vector = tuple[float, float, float]
_begin_record, _keep_record, _end_record = (
    on_device(begin_record),
    on_device(keep_record),
    on_device(end_record),
)


@cache
def make_record(variant: KernelVariant, choice: LawChoice) -> Any:
    """Build what a step does with the record of one pair."""
    plane_case, exact = variant.plane_case, variant.exact
    tension, rule, n_stat = choice.tension, choice.events, S.N_STATISTIC

    @device
    def record_pair(
        i: int, j: int, n: int, was: int, now: int, until: float, t: float, dt: float, overlap: float,
        closing: float, f_n: float, raw: float, slides: bool, others: bool, normal: Vector, slip: Vector,
        force: Vector, grains: RecordedGrains, l_x: float, l_y: float, record: Any, status: Any, ended: Any,
    ) -> None:  # fmt: skip
        """Carry the record of a pair that touches, or did in the last step, through a step.

        Parameters
        ----------
        was, now, until : states of the pair and time to the end of its force, from the contact.
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
        goes_on, pulls, f_last = touching, tension, record[R.T_PART]
        if exact:  # a record ends after the last force, which may act after the grains parted
            goes_on, pulls, f_last = now != 0, 0, 1.0 if until == 0.0 else 0.0
        if goes_on:
            t_end = record[R.T_END]
            _keep_record(record, t, dt, overlap, f_n, raw, force, slides, others)
            if exact and until < math.inf:
                record[R.T_END] = t + until if until >= 0.0 else t_end
        elif was != 0 and record[R.PARTNER] >= 0.0:
            slot = cuda.atomic.add(status, F.ENDED, 1)  # they are put in order later
            if slot < ended.shape[0]:
                record_stats = cuda.local.array(n_stat, float64)
                record_stats[S.N_ENDED] = record_stats[S.FAULT] = 0.0
                _end_record(
                    plane_case, pulls, record, f_last, t, overlap, closing, slip, normal, i, grains.v,
                    grains.w, ended[slot : slot + 1], record_stats,
                )  # fmt: skip
            else:
                cuda.atomic.min(status, F.OVERFLOWED, grains.ids[i])

    return record_pair
