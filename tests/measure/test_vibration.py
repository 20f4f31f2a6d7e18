import math

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure import rest_time, vibrating_grains, vibrating_share, vibration
from ryusa.model import EVENT

A = 2.0e-6  # amplitude [m]


def shaking(make, t, heights, omega=None):
    """A run of grains whose centres follow `heights`, one function of time each."""
    x = np.zeros((len(t), len(heights), 3))
    for g, height in enumerate(heights):
        x[:, g, 0] = 0.01 * g
        x[:, g, 2] = height(t)
    spin = np.zeros_like(x)
    if omega is not None:
        spin[:, :, 1] = omega
    return make.run_of(t, x, np.zeros_like(x), np.zeros(0, dtype=EVENT), spin)


def test_a_vibration_that_the_paper_s_window_cannot_see_shows_in_the_span(make):
    t = np.linspace(0.0, 0.1, 1001)  # 0.1 ms; five whole periods in each window
    found = vibration(shaking(make, t, [lambda t: A * np.sin(2 * np.pi * 500 * t), lambda t: 0 * t]))
    assert found.net.shape == (10, 2)
    assert np.abs(found.net[:, 0]).max() < 1e-3 * A
    assert found.span_z[:, 0] == pytest.approx(2 * A, rel=0.01)
    assert found.span[:, 0] == pytest.approx(2 * A, rel=0.01)
    assert found.span[:, 1].max() < 1e-15
    busy = vibrating_grains(found, 0.05, 1.0e-6)
    assert busy.grains.tolist() == [0]
    assert busy.share == 0.5
    assert (busy.begin, busy.end) == pytest.approx((0.04, 0.05))
    assert vibrating_grains(found, 0.05, 1.0e-6, by="net").share == 0.0


def test_a_grain_that_sinks_steadily_moves_by_its_speed_times_the_window(make):
    t = np.linspace(0.0, 0.05, 51)
    found = vibration(shaking(make, t, [lambda t: -3.0e-4 * t]))
    assert found.net == pytest.approx(-3.0e-6)
    assert found.span_z == pytest.approx(3.0e-6)
    assert found.n_frame.tolist() == [11] * 5


def test_grains_rest_from_the_end_of_the_last_window_in_which_one_moved(make):
    t = np.linspace(0.0, 0.1, 1001)

    def calmed(t):
        return np.where(t < 0.0655, A * np.sin(2 * np.pi * 730 * t), 0.0)

    found = vibration(shaking(make, t, [calmed, lambda t: 0 * t]))
    assert rest_time(found, A) == pytest.approx(0.07)
    assert rest_time(found, 3 * A) == 0.0
    assert vibrating_share(found, A).tolist() == [0.5] * 7 + [0.0] * 3
    restless = vibration(shaking(make, t, [lambda t: A * np.sin(2 * np.pi * 730 * t)]))
    assert math.isnan(rest_time(restless, A))


def test_a_grain_that_spins_in_place_turns_though_it_does_not_move(make):
    t = np.linspace(0.0, 0.02, 201)
    found = vibration(shaking(make, t, [lambda t: 0 * t], omega=-8.0))
    assert not found.span.any()
    assert found.turn == pytest.approx(8.0 * make.d / 2 * 0.01)


def test_frames_that_come_a_step_early_or_late_change_no_window(make):
    rng = np.random.default_rng(1)
    t = np.arange(51) * 1e-3 + rng.uniform(-4.0e-5, 4.0e-5, 51)
    found = vibration(shaking(make, t, [lambda t: A * np.sin(900 * t)]))
    assert found.n_frame.tolist() == [11] * (len(found.n_frame))
    assert len(found.end) == 5


def test_windows_can_be_chosen_and_thresholds_are_given_in_diameters(make):
    t = np.linspace(0.0, 0.1, 1001)
    found = vibration(shaking(make, t, [lambda t: t] * 3), window=0.02, begin=0.05, end=0.095, grains=[2])
    assert found.begin.tolist() == pytest.approx([0.05, 0.07])
    assert found.grains.tolist() == [2]
    assert found.diameters(1e-3) == pytest.approx(1e-3 * make.d)
    assert len(found.rows()) == 2


@pytest.mark.parametrize(
    ("window", "message"), [(0.009, "10 needed"), (0.2, "no whole window"), (0.01, "first ends at")]
)
def test_windows_too_short_for_their_frames_are_refused(make, window, message):
    run = shaking(make, np.linspace(0.0, 0.1, 101), [lambda t: t])
    with pytest.raises(ResultsError, match=message):
        vibrating_grains(vibration(run, window=window), 0.001, A)
