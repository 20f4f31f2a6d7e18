"""The wide bed of Maurin et al.: profiles are read right, and one like the published one is within."""

import numpy as np
import pytest

from ryusa.casefile.derive import derive
from ryusa.study import Level, Plan
from ryusa_studies.validation import maurin


def test_the_published_profiles_hold_the_grains_of_the_case() -> None:
    """0.61 over 10 d, and half of the base."""
    z, phi, u = maurin.published()
    assert np.trapezoid(phi, z) == pytest.approx(6.1 + 0.5 * 0.6, abs=0.05)
    assert maurin.rate(z, phi, u) == pytest.approx(1.82, abs=0.01)
    assert 10.0 < maurin.top(z, phi) < 10.5


def test_a_run_like_the_published_one_is_within_and_a_faster_one_is_not() -> None:
    z, phi, u = maurin.published()
    plan = Plan(Level.STANDARD, (1, 2, 3))
    for factor, held in ((1.0, True), (1.3, False)):
        q = factor * maurin.rate(z, phi, u)
        shifted = {  # over a base that lies half a bead lower
            "z": z + 0.5, "phi": phi, "u": factor * u, "time": 30.0,
            "depth": maurin.SURFACE - maurin.top(z, phi) - 0.5,
        }  # fmt: skip
        found = {
            one: {**shifted, "q_star": q * (1.0 + 0.001 * k)} for k, one in enumerate(maurin.tasks(plan))
        }
        judged = [trial for one in maurin.judge(found, plan) for trial in one.trials if trial.judged]
        assert {one.part: one.holds for one in judged} == {
            "q_star over that published": held, "rms of phi": True, "rms of u": held,
        }  # fmt: skip


def test_its_case_is_the_published_one() -> None:
    assert maurin.tasks(Plan(Level.QUICK, (1,))) == []
    case = maurin.tasks(Plan(Level.STANDARD, (1, 2, 3)))[0].read()
    assert case.water is not None
    assert case.water.depth == pytest.approx(maurin.SURFACE * maurin.D)
    assert derive(case).n_grain == pytest.approx(6.1 * 144.0 / (np.pi / 6.0), rel=0.01)
    assert case.stop.time == pytest.approx(45.0)
    assert case.record.settle == pytest.approx(15.0)
