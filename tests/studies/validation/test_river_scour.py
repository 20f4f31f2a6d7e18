"""Verdicts on what a jet digs and on how it widens, from numbers that are known."""

import numpy as np
import pytest

from ryusa.study import Outcome
from ryusa_studies.validation import river_scour as scour
from ryusa_studies.validation import river_shear_layers as layers


@pytest.mark.parametrize(("ratio", "outcome"), [(0.49, Outcome.FAILS), (0.6, Outcome.HOLDS)])
def test_the_mean_depth_of_the_last_seconds_is_judged(ratio, outcome):
    t = np.arange(1.0, 16.1, 0.25)
    depth = np.where(t > 11.0, 0.1 * ratio, 0.0)
    depth[-1] += 0.2 * 0.01  # one frame of twenty
    found = {
        "t": t, "depth": depth, "expected": np.array(0.1), "q": np.array(0.016), "head": np.array(0.12),
        "tail": np.array(0.06),
    }  # fmt: skip
    (finding,) = scour.judge({scour.jet(): found})
    assert finding.outcome is outcome
    (trial,) = (one for one in finding.trials if one.judged)
    assert trial.found.value == pytest.approx(ratio + 0.001, abs=1e-9)


@pytest.mark.parametrize(("rate", "jet"), [(0.07, Outcome.HOLDS), (0.1, Outcome.FAILS)])
@pytest.mark.parametrize(
    ("length", "eddy"), [(4.6, Outcome.FAILS), (4.8, Outcome.HOLDS), (7.9, Outcome.FAILS)]
)
def test_jet_and_eddy_are_judged_by_the_length_of_shear_layers(rate, jet, length, eddy):
    x = np.linspace(0.3, 1.0, 8)
    own = {"x": x, "width": 0.02 + rate * x, "speed": 1.0 - 0.4 * x, "rate": np.array(rate)}
    lengths = ({"length": np.array(one)} for one in (length, 6.28, 6.28, 6.28))
    found = dict(zip(layers.tasks(), (own, {**own, "rate": np.array(9.0)}, *lengths), strict=True))
    assert [one.outcome for one in layers.judge(found)] == [jet, eddy]
