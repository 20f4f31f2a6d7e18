"""How benchmarks/averages.py judges the averages of two engines."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def averages():
    sys.path.insert(0, str(FOLDER))
    try:
        spec = importlib.util.spec_from_file_location("averages", FOLDER / "averages.py")
        assert spec is not None and spec.loader is not None
        found = sys.modules["averages"] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(found)
        yield found
    finally:
        sys.path.remove(str(FOLDER))


@pytest.mark.full
def test_equal_flows_rarely_differ_however_their_seeds_scatter_and_a_shift_of_many_errors_does(averages):
    rng = np.random.default_rng(1)
    wrong = 0
    for _ in range(150):
        every = [
            averages.difference([*rng.lognormal(0, 1, 6)], [*rng.lognormal(0, 1, 6)], 5) for _ in "12345"
        ]
        wrong += any(one.verdict(1.0) == "**differs**" for one in every)
    assert 0 < wrong < 0.1 * 150  # of 5 % asked
    far = averages.difference([*rng.normal(1.0, 0.01, 6)], [*rng.normal(1.2, 0.01, 6)], 20)
    assert far.chance == pytest.approx(2.0 / 924.0)
    assert far.verdict(0.1) == "**differs**"


def test_too_few_seeds_to_tell_any_difference_are_refused(averages):
    averages.refuse_too_few(6, 6, 20)
    with pytest.raises(SystemExit, match="--seeds 3 and --cpu-seeds 6 cannot show that any of 20 numbers"):
        averages.refuse_too_few(6, 3, 20)


def test_a_difference_that_is_not_known_well_enough_is_not_called_the_same(averages):
    # four and two seeds leave four degrees of freedom, with a Student factor of 2.776
    found = averages.difference([0.9, 1.1, 0.9 + 0.2 * 0.5, 1.0 + 0.1 * 2**0.5], [1.0, 1.1], 1)
    assert found.half == pytest.approx(2.776 * found.error, rel=1e-3)
    assert found.verdict(0.1 * found.half / abs(found.cpu)) == "not resolved"
    assert found.verdict(1.1 * found.half / abs(found.cpu)) == "same"
    exact = averages.difference([1.0, 1.0], [1.0, 1.0], 1)
    assert exact.over_error == 0.0 and exact.verdict(0.01) == "same"
    apart = averages.difference([1.0] * 4, [1.1] * 4, 1)
    assert apart.verdict(0.5) == "**differs**"
