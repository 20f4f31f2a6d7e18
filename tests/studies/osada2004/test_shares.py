import pytest

from ryusa.study import Band
from ryusa_studies.osada2004._shares import share_interval, share_trial

MOST = Band(0.5, float("inf"), "-", "most runs")


@pytest.mark.parametrize("hits", [[0.0] * 4, [1.0] * 4, [0.0, 1.0, 0.0, 0.0]])
def test_an_interval_of_a_share_contains_it_and_stays_between_0_and_1(hits):
    found = share_interval(hits, 1)
    assert 0.0 <= found.low <= found.value <= found.high <= 1.0
    assert found.low < found.high


def test_four_runs_that_agree_decide_what_most_runs_do_and_three_do_not():
    assert share_trial("flows", {}, [1.0] * 4, 1, MOST).holds is True
    assert share_trial("flows", {}, [0.0] * 4, 1, MOST).holds is False
    assert share_trial("flows", {}, [1.0, 1.0, 1.0, 0.0], 1, MOST).holds is None
    assert share_trial("flows", {}, [1.0] * 3, 1, MOST).holds is None


def test_grains_that_go_together_count_as_few():
    alone = share_interval([21.0, 20.0, 22.0, 21.0], 42)
    together = share_interval([42.0, 42.0, 0.0, 0.0], 42)
    assert alone.value == together.value == 0.5
    assert together.high - together.low > 4.0 * (alone.high - alone.low)
    assert alone.high - alone.low == pytest.approx(2 * 1.96 * 0.5 / 168**0.5, rel=0.02)


def test_halves_are_the_seeds_at_even_and_at_odd_places():
    assert share_trial("flows", {}, [1.0, 0.0, 1.0, 0.0], 1, MOST).halves == (True, False)
    assert share_trial("flows", {}, [1.0], 1, MOST).halves == (True, None)
