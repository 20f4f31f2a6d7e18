"""The bore that a wall reflects, against its balances of volume and momentum."""

import math

import pytest

from ryusa.laws.bore import reflected_bore


@pytest.mark.parametrize(("r", "froude_2"), [(2.0, 0.75), (3.0, 8.0 / 3.0), (5.0, 9.6)])
def test_known_depths_behind_the_bore(r, froude_2):
    h, g = 0.02, 9.8
    depth, a = reflected_bore(math.sqrt(froude_2 * g * h), h, g)
    assert depth == pytest.approx(r * h, rel=1e-10)
    assert a == pytest.approx(math.sqrt(froude_2 * g * h) / (r - 1.0), rel=1e-10)


@pytest.mark.parametrize("u", [0.1, 1.0, 12.0])
def test_it_keeps_volume_and_momentum(u):
    h, g = 0.1, 9.8
    depth, a = reflected_bore(u, h, g)
    assert h * (u + a) == pytest.approx(a * depth, rel=1e-9)
    assert 0.5 * g * (depth**2 - h**2) == pytest.approx(h * u * (u + a), rel=1e-9)


def test_still_water_stays_as_deep_and_its_waves_go_at_their_own_speed():
    assert reflected_bore(0.0, 0.1, 9.8) == pytest.approx((0.1, math.sqrt(0.98)), rel=1e-7)
