"""Moments of touch and parting in the records of contacts."""

import numpy as np
import pytest

from ryusa.engine.shared import block_statistics as S
from ryusa.engine.shared import record_fields as R
from ryusa.engine.shared.contact_records import end_record
from ryusa.model.contacts import N_EVENT

STEP, NOW = 1.0e-5, 1.0  # [s]


@pytest.mark.parametrize(
    "gap, opening, begun, parted",
    [
        (1.0e-9, 1.0e-3, 0.9, 1.0e-6),  # parted a microsecond ago
        (1.0e-7, 1.0e-9, 0.9, STEP),  # slowed down by others since: 100 s ago by its speed of now
        (0.0, 1.0e-3, 0.9, 0.0),
        (1.0e-9, -1.0e-3, 0.9, 0.0),  # pushed together again since
        (1.0e-7, 1.0e-9, NOW - 0.4 * STEP, 0.4 * STEP),  # touched and parted within the step
    ],
)
def test_a_pair_parts_within_its_last_step_and_after_its_touch(gap, opening, begun, parted):
    record, ended, stats = np.zeros(N_EVENT), np.zeros((1, N_EVENT)), np.zeros(S.N_STATISTIC)
    record[R.T_BEGIN] = begun
    none, grains = (0.0, 0.0, 0.0), np.zeros((1, 3))
    end_record(0, 1, record, 0.0, NOW, STEP, -gap, -opening, none, none, 0, grains, grains, ended, stats)
    assert ended[0, R.T_END] == pytest.approx(NOW - parted, abs=1e-12)
    assert ended[0, R.T_END] >= begun
