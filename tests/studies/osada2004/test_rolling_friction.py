import math
from pathlib import Path

import numpy as np
import pytest
from tests.studies.osada2004.test_heaps import heap

from ryusa.study import Level, Outcome, Plan
from ryusa.study.registration import Registration
from ryusa_studies import osada2004
from ryusa_studies.osada2004 import rolling_friction as part
from ryusa_studies.osada2004._rolling_fit import SlopeFit, SpinFit, best_pair, limits
from ryusa_studies.osada2004.rolling_friction import NONE, PAIR, MeasuredFlow

QUICK = Plan(Level.QUICK, (1,))
STANDARD = Plan(Level.STANDARD, (1, 2, 3, 4))
TRIED, ANGLES = (0.25, 0.5, 1.0), (25.0, 40.0)


def fits(slope, spin):
    """Fits to numbers that a coefficient and an angle give."""
    pairs = [(mu_r, angle) for mu_r in TRIED for angle in ANGLES]
    return (
        SlopeFit.of({one: [slope(*one) + 0.1 * k for k in (-1, 1)] for one in pairs}),
        SpinFit({one: [spin(*one)] * 2 for one in pairs}),
    )


def test_the_fit_returns_the_surface_that_made_the_numbers():
    slope, spin = fits(
        lambda mu_r, angle: 30.0 + 4.0 * math.log(mu_r) + 0.1 * (angle - 30.0), lambda mu_r, _: 400.0 / mu_r
    )
    assert slope.at(0.7, 33.0) == pytest.approx(30.0 + 4.0 * math.log(0.7) + 0.3)
    assert spin.at(0.7, 33.0) == pytest.approx(400.0 / 0.7)  # a straight line in logarithms
    assert slope.coefficient(29.0, 30.0) == pytest.approx(math.exp(-0.25))
    assert spin.coefficient(500.0, 40.0) == pytest.approx(0.8)
    assert math.isnan(slope.coefficient(60.0, 30.0))
    assert math.isnan(spin.coefficient(100.0, 30.0))


def test_of_all_pairs_with_the_slope_the_one_with_the_smallest_spin_is_taken():
    slope, spin = fits(
        lambda mu_r, angle: 40.0 + 4.0 * math.log(mu_r) - 0.1 * (angle - 25.0),
        lambda mu_r, angle: 400.0 / mu_r + 40.0 * angle,
    )
    best = best_pair(slope, spin, 38.0)
    assert best.slope == pytest.approx(38.0)
    assert best.angle == 25.0
    assert best.mu_r == pytest.approx(math.exp(-0.5))


def test_without_a_pair_that_gives_the_slope_the_nearest_is_taken():
    slope, spin = fits(
        lambda mu_r, angle: 25.0 + 4.0 * math.log(mu_r) - 0.1 * (angle - 25.0), lambda *_: 400.0
    )
    best = best_pair(slope, spin, 38.0)
    assert (best.mu_r, best.angle) == pytest.approx((1.0, 25.0))
    assert best.slope == pytest.approx(25.0)


def test_resamples_of_a_fit_scatter_as_the_mean_of_the_runs_does():
    random = np.random.default_rng(0)
    pairs = [(mu_r, angle) for mu_r in TRIED for angle in ANGLES]
    slope = SlopeFit.of({one: [float(x) for x in 30.0 + 3.0 * random.standard_normal(40)] for one in pairs})
    low, high = limits([one.at(0.5, 30.0) for one in slope.resamples(400)])
    assert low < slope.at(0.5, 30.0) < high
    assert high - low == pytest.approx(2 * 1.96 * 3.0 / math.sqrt(240) * math.sqrt(2.2), rel=0.3)


def found(plan, slope=38.0, spin=300.0, fast=1.2, flux=1.0, load=1.0):
    """What a campaign finds if every run with rolling friction gives these numbers."""
    result = {}
    for one in part.tasks(plan):
        seed = int(one.get("seed"))
        plain = not one.get("rolling.model")
        if one.case == "fig19":
            result[one] = heap(slope + 0.2 * seed)
        elif one.case == "saltation":
            result[one] = spin + seed
        elif one.case == "fig17" and one.get("motion.rotation") != "free":
            result[one] = MeasuredFlow(1.0, 1.0, math.nan, math.nan)
        elif one.case == "fig17":
            result[one] = MeasuredFlow(
                1.5 if plain else flux, 2.0 if plain else fast + 0.01 * seed, math.nan, math.nan
            )
        else:
            result[one] = MeasuredFlow(1e-4, 0.1, load, 0.3)
    return result


@pytest.mark.full
@pytest.mark.parametrize(
    "missed", [{}, {"slope": 31.0}, {"spin": 900.0}, {"fast": 2.0}, {"flux": 1.3}, {"load": 4.0}]
)
def test_one_coefficient_serves_if_every_part_holds(missed):
    (finding,) = part.judge(found(STANDARD, **missed), STANDARD)
    assert finding.outcome is (Outcome.FAILS if missed else Outcome.HOLDS)
    assert sum(one.holds is False for one in finding.trials) == (3 if "load" in missed else len(missed))
    assert {one.choices[part.CHOICE] for one in finding.beside} == {NONE}
    assert not any(one.judged for one in finding.beside)
    assert any(line.startswith("fit of these seeds") for line in finding.also)


def test_the_quick_level_needs_no_fit():
    (finding,) = part.judge(found(QUICK), QUICK)
    assert {one.part for one in finding.trials} == set(part.BANDS)
    assert len(part.tasks(QUICK)) == 7


def test_every_band_and_the_pair_are_registered():
    registered = Registration.read(Path(osada2004.__file__).parent / "registration")
    (finding,) = part.judge(found(STANDARD), STANDARD)
    registered.check(finding)
    text = registered.paths["rolling-friction"].read_text(encoding="utf-8")
    assert f"mu_r {PAIR[0]} and {PAIR[1]}" in text
