"""Grading curves against numbers known in closed form, and the grains that lay them."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ryusa.model.grading import Grading, GradingFault, laid

EVEN = Grading.of([(0.001, 0.0), (0.004, 1.0)])  # even in log d from 1 to 4 mm
GRAVEL = Grading.of([(0.001, 0.0), (0.002, 0.1), (0.004, 0.55), (0.006, 0.55), (0.016, 1.0)])  # with a gap


def worst(curve: Grading, d: np.ndarray) -> float:
    """Largest difference between the steps laid by spheres and the curve."""
    share = np.cumsum(np.sort(d) ** 3) / np.sum(d**3)
    asked = np.array([curve.share_below(one) for one in np.sort(d)])
    return float(max(np.abs(share - asked).max(), np.abs(np.concatenate([[0.0], share[:-1]]) - asked).max()))


def test_a_curve_even_in_log_d_has_the_number_mean_of_its_integral() -> None:
    # dN ~ d^-4 dd: mean = (int d^-3)/(int d^-4) = 3/2 (d1^-2 - d2^-2)/(d1^-3 - d2^-3)
    low, high = 0.001, 0.004
    mean = 1.5 * (low**-2 - high**-2) / (low**-3 - high**-3)
    assert EVEN.mean_diameter == pytest.approx(mean, rel=1e-12)
    assert EVEN.mean_cube == pytest.approx(3.0 * math.log(4.0) / (low**-3 - high**-3), rel=1e-12)
    assert EVEN.diameter(0.5) == pytest.approx(0.002, rel=1e-12)
    assert EVEN.sorting == pytest.approx(math.sqrt(4.0**0.68), rel=1e-12)
    d = EVEN.quotas(200_000)
    assert d.mean() == pytest.approx(mean, rel=1e-4)
    assert np.mean(d**3) == pytest.approx(EVEN.mean_cube, rel=1e-9)


def test_the_integrals_of_a_curve_of_many_points_are_those_of_its_grains_by_mass() -> None:
    # by mass at random: 1/<d^3>_N is the mean of d^-3 over mass
    d = np.array([GRAVEL.diameter(share) for share in (np.arange(200_000) + 0.5) / 200_000])
    assert 1.0 / GRAVEL.mean_cube == pytest.approx(np.mean(d**-3), rel=1e-5)
    assert GRAVEL.mean_diameter == pytest.approx(np.mean(d**-2) / np.mean(d**-3), rel=1e-5)


@pytest.mark.parametrize("curve", [EVEN, GRAVEL], ids=["even", "with a gap"])
@pytest.mark.parametrize("n", [1, 2, 7, 100, 5_000])
def test_the_curve_laid_leaves_the_one_asked_by_less_than_its_largest_grain(curve: Grading, n: int) -> None:
    d = curve.quotas(n)
    assert len(d) == n
    assert np.all(np.diff(d) >= 0.0)
    assert curve.d[0] <= d[0] <= d[-1] <= curve.d[-1]
    assert np.mean(d**3) == pytest.approx(curve.mean_cube, rel=1e-9)
    largest = d[-1] ** 3 / np.sum(d**3)
    assert largest == pytest.approx(curve.largest_share(n), rel=1e-6)
    assert worst(curve, d) <= largest * (1.0 + 1e-9)


def test_the_number_drawn_at_random_instead_leaves_the_curve_further() -> None:
    """The control: independent draws from the same numbers scatter more than the quotas allow."""
    rng = np.random.default_rng(1)
    fine = EVEN.quotas(1_000_000)
    wrong = [worst(EVEN, rng.choice(fine, 500)) for _ in range(20)]
    assert np.mean(wrong) > 3.0 * worst(EVEN, EVEN.quotas(500))


def test_a_gap_in_the_curve_holds_no_grain() -> None:
    d = GRAVEL.quotas(3_000)
    inside = (d > 0.00401) & (d < 0.00599)
    assert inside.sum() <= 1  # the one grain whose part spans the gap
    assert (d > 0.006).any()


def test_a_cut_keeps_the_shape_between_and_is_closed() -> None:
    cut = GRAVEL.cut(0.002, 0.010)
    assert cut.closed
    kept = GRAVEL.share_below(0.010) - 0.1
    for d in (0.003, 0.005, 0.008):
        assert cut.share_below(d) == pytest.approx((GRAVEL.share_below(d) - 0.1) / kept, rel=1e-12)
    assert (cut.d[0], cut.d[-1]) == (0.002, 0.010)
    inside = GRAVEL.cut(0.0045, math.inf)  # begins in the gap: no grain before its end
    assert inside.d[0] == 0.006
    with pytest.raises(GradingFault, match="no mass"):
        GRAVEL.cut(0.0041, 0.0059)
    with pytest.raises(GradingFault, match="no mass"):
        GRAVEL.cut(0.02)


@pytest.mark.parametrize(
    ("points", "at", "part"),
    [
        ([(0.001, 0.0)], 0, "at least two points"),
        ([(0.001, 0.0), (0.001, 1.0)], 1, "appears twice"),
        ([(0.001, 0.0), (0.003, 0.5), (0.002, 1.0)], 2, "diameters must rise"),
        ([(0.003, 1.0), (0.001, 0.5), (0.002, 0.0)], 2, "diameters must fall"),
        ([(0.001, 0.0), (0.002, 0.6), (0.003, 0.5), (0.004, 1.0)], 2, "must not fall towards larger"),
        ([(0.004, 1.0), (0.003, 0.5), (0.002, 0.6), (0.001, 0.0)], 2, "must not fall towards larger"),
        ([(0.001, -0.1), (0.002, 1.0)], 0, "from 0 to 100"),
        ([(0.001, 0.0), (0.002, math.nan)], 1, "from 0 to 100"),
    ],
)
def test_a_curve_that_cannot_be_names_its_point(points: list, at: int, part: str) -> None:
    with pytest.raises(GradingFault, match=part) as caught:
        Grading.of(points)
    assert caught.value.point == at


def test_single_grains_give_the_diameters_of_their_mass() -> None:
    d = np.array([1.0, 2.0, 4.0])
    m = np.array([1.0, 2.0, 1.0])
    assert laid(d, m).diameter(0.5) == pytest.approx(2.0)
    assert laid(np.full(3, 0.5), np.ones(3)).diameter(0.1) == pytest.approx(0.5)


shares = st.lists(st.floats(0.0, 1.0), min_size=1, max_size=6).map(sorted)


@settings(max_examples=200, deadline=None)
@given(shares=shares, ratios=st.lists(st.floats(1.001, 30.0), min_size=7, max_size=7), n=st.integers(1, 400))
def test_every_closed_curve_is_laid_within_a_grain(shares: list[float], ratios: list[float], n: int) -> None:
    finer = [0.0, *shares, 1.0]
    d = (1.0e-4 * np.cumprod([1.0, *ratios[: len(finer) - 1]])).tolist()
    curve = Grading.of(list(zip(d, finer, strict=True))).cut()
    found = curve.quotas(n)
    assert np.isfinite(found).all()
    assert worst(curve, found) <= found[-1] ** 3 / np.sum(found**3) * (1.0 + 1e-6) + 1e-9


def test_no_grain_has_no_size() -> None:
    """A stream without a bed lays none of its sieve curve; nothing is divided by zero."""
    with np.errstate(all="raise"):
        assert EVEN.quotas(0).shape == (0,)
