"""The rise of an overloaded bed by linear theory, against a closed form and a march in time."""

import math

import numpy as np
import pytest
from scipy.special import erfc
from tests.measure.made_rows import BALL, WIDTH, row_of, run_of

from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.study import Level, Plan
from ryusa_studies.validation import river_overload as overload

X = np.linspace(0.0, 3.0, 31)
EXTRA, CORE, DIFFUSION, STEEP = 3.6e-4, 0.6, 0.03, 5.4


@pytest.mark.parametrize("t", [0.5, 5.0, 20.0])
def test_at_a_froude_number_of_1_it_is_the_integral_of_the_error_function(t):
    y = X / (2.0 * math.sqrt(DIFFUSION * t))
    known = 2.0 * EXTRA / CORE * math.sqrt(t / DIFFUSION)
    known = known * (np.exp(-y * y) / math.sqrt(math.pi) - y * erfc(y))
    found = overload.rise(X, t, EXTRA, CORE, DIFFUSION, STEEP, 0.0)
    assert found == pytest.approx(known, abs=1e-6 * known[0])


@pytest.mark.parametrize("f", [0.0, -1.0, -3.0])
def test_its_volume_is_that_of_the_feed(f):
    x, t = np.linspace(0.0, 40.0, 40_001), 9.0
    found = overload.rise(x, t, EXTRA, CORE, DIFFUSION, STEEP, f)
    assert np.trapezoid(found, x) == pytest.approx(EXTRA * t / CORE, rel=1e-5)


def test_above_a_froude_number_of_1_it_is_what_a_march_in_time_gives():
    f, t, n, dx = -1.86, 6.0, 1500, 0.004
    bed, dt = np.zeros(n), 0.002  # cells; their transport is at the stations between them
    decay = 1.0 / (1.0 + STEEP * dx / -f)
    for _ in range(round(t / dt)):
        depth = np.empty(n + 1)  # of stations; q_s' = - (3 S/h_0) (dq_s/dS) h'
        depth[0] = -EXTRA / (STEEP * DIFFUSION * CORE)
        change = np.diff(bed, append=0.0) / -f
        for k in range(n):
            depth[k + 1] = decay * (depth[k] + change[k])
        bed += dt * STEEP * DIFFUSION * np.diff(depth) / dx
    x = (np.arange(n) + 0.5) * dx
    there = x < 2.0
    found = overload.rise(x[there], t, EXTRA, CORE, DIFFUSION, STEEP, f)
    assert bed[there] == pytest.approx(found, abs=0.02 * found[0])


def test_the_runs_differ_by_the_extra_feed_alone():
    runs = overload.tasks(Plan(Level.FULL, (1,)))
    assert [len(one.read().feeds) for one in runs] == [2, 1, 2, 1]
    case = read(case_path("validation/overload.toml"))
    fed, bare = (one.read() for one in runs[:2])
    assert fed.feeds == case.feeds
    assert fed.seed == bare.seed == 1
    assert bare.feeds[0] == case.feeds[0]
    assert case.feeds[1].rate[0] / (2650.0 * 0.032) == pytest.approx(overload.EXTRA)
    assert overload.tasks(Plan(Level.STANDARD, (1,))) == []


def test_grains_on_the_apron_count_and_those_beyond_the_sill_have_passed():
    t = np.arange(0.0, 3.05, 0.1)
    x = np.tile([[0.15, 0.0, 0.01], [1.0, 0.0, 0.01], [2.5, 0.0, 0.01], [2.95, 0.0, 0.01]], (len(t), 1, 1))
    x[:, 2, 0] += 0.15 * t  # comes to 2.95 m
    run = run_of(row_of(300, ends=True), t, x, np.gradient(x, t, axis=0))
    found = overload.measure(run, overload.tasks(Plan(Level.FULL, (1,)))[0])
    assert found["there"] == pytest.approx(2.0 * BALL / WIDTH)
    assert found["passed"] == pytest.approx(BALL / WIDTH)
    assert found["end"] == pytest.approx(3.0)
