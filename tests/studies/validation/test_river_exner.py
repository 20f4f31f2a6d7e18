"""Growth of a bed wave: its limits, and what is read from waves and transport that are known."""

import math

import numpy as np
import pytest

from ryusa.casefile import read
from ryusa.cases import case_path
from ryusa.study import Level, Plan
from ryusa_studies.validation import river_exner as exner

S, H, K = 0.02, 0.025, 0.02


def test_a_long_wave_decays_by_diffusion() -> None:
    k = 1e-3 * 3.0 * S / H
    for froude in (0.5, 2.0):
        assert exner.growth(k, K, S, H, froude).real == pytest.approx(-K * k * k, rel=2e-5)


def test_at_froude_number_one_every_wave_decays_by_diffusion_and_stays() -> None:
    assert exner.growth(7.0, K, S, H, 1.0) == pytest.approx(-K * 49.0)


@pytest.mark.parametrize("froude", [0.5, 0.7, 1.4, 2.0])
def test_a_short_wave_travels_at_the_celerity_of_de_vries(froude: float) -> None:
    k = 1e4 * 3.0 * S / H
    # (u/h)(dq_s/du)/((1 - p)(1 - Fr^2)): at constant q du/u = dS/(3 S) for a friction slope ~ u^3
    expected = 3.0 * S / H * K / (1.0 - froude**2)
    assert -exner.growth(k, K, S, H, froude).imag / k == pytest.approx(expected, rel=1e-6)


def test_no_length_grows_and_the_direction_changes_at_froude_number_one() -> None:
    for k in (0.1, 1.0, 10.0, 100.0):
        assert exner.growth(k, K, S, H, 0.7).real < 0.0
        assert exner.growth(k, K, S, H, 0.7).imag < 0.0  # downstream
        assert exner.growth(k, K, S, H, 1.4).imag > 0.0


def test_growth_solves_the_linear_equations() -> None:
    """Exner, momentum and continuity, each by itself."""
    k, froude, eta = 5.0, 1.4, 1.0
    sigma = exner.growth(k, K, S, H, froude)
    h = -1j * k * eta / (1j * k * (1.0 - froude**2) - 3.0 * S / H)
    assert (1.0 - froude**2) * 1j * k * h + 1j * k * eta == pytest.approx(3.0 * S / H * h)  # friction falls
    q_s = K * (-3.0 * S / H) * h  # over 1 - p, by the friction slope
    assert sigma * eta == pytest.approx(-1j * k * q_s)


def test_decay_and_celerity_are_read_from_a_known_wave() -> None:
    t, sigma = np.linspace(1.5, 8.0, 131), -0.22 + 0.31j
    rng = np.random.default_rng(1)
    wave = (2.4e-3 + 1e-4j) * np.exp(sigma * (t - t[0]))
    first, found = exner.fitted(t, wave)
    assert first == pytest.approx(2.4e-3 + 1e-4j, rel=1e-6)
    assert found == pytest.approx(sigma, rel=1e-6)
    noisy = wave + 1e-4 * (rng.normal(size=t.size) + 1j * rng.normal(size=t.size))
    assert exner.fitted(t, noisy)[1] == pytest.approx(sigma, rel=0.05)


def test_the_slope_of_a_known_transport_is_found() -> None:
    def q_s(slope: float, q: float) -> float:
        return 3.0 * slope**1.7 * q**1.2

    points = [(s, q, q_s(s, q), 0.02) for s, q in ((0.0135, 9.7e-3), (0.0234, 9.4e-3), (0.018, 11e-3))]
    value, derivative, error = exner.transport_slope(points, 0.018, 9.5e-3)
    assert value == pytest.approx(q_s(0.018, 9.5e-3))
    assert derivative == pytest.approx(1.7 * value / 0.018)
    assert 0.02 < error < 0.1


def test_every_case_of_the_full_level_can_be_read() -> None:
    tasks = exner.tasks(Plan(Level.FULL, (1,)))
    assert len(tasks) == 7
    for one in tasks:
        case = read(case_path("validation/bed_wave.toml"), dict(one.overrides))
        assert case.water is not None
        assert case.water.row is not None
        assert case.water.row.segments == round(case.build.length / exner.SEGMENT)  # pyright: ignore
    assert not exner.tasks(Plan(Level.STANDARD, (1,)))
    assert math.isinf(exner.DECLARED["bed-wave-celerity"].band("celerity-rapid").low)  # pyright: ignore
