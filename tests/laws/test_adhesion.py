"""Adhesion in closed form, against a fine integration and the limits of little damping."""

import math

import pytest
from scipy.integrate import solve_ivp
from scipy.special import beta

from ryusa.laws import adhesion as A
from ryusa.laws.collision import overlap_max


def parts(speed, zeta, tension, elastic, by_area):
    """Whether an impact in units of mass, stiffness and attraction parts, by a fine integration."""
    alpha = (math.sqrt(5.0) if elastic else 2.0) * zeta

    def rates(t, state):
        x, u = max(state[0], 0.0), state[1]
        push = x**1.5 + alpha * x**0.25 * u if elastic else x + alpha * u
        return [u, (x if by_area else 1.0) - (push if tension else max(push, 0.0))]

    def end(t, state):
        return state[0]

    end.terminal, end.direction = True, -1
    found = solve_ivp(
        rates, (0.0, 60.0), [1e-14, speed], events=end, rtol=1e-9, atol=1e-12, max_step=0.1
    )  # fmt: skip
    return len(found.t_events[0]) > 0


@pytest.mark.parametrize("tension", [True, False])
@pytest.mark.parametrize("zeta", [0.05, 0.3, 0.8])
def test_an_impact_sticks_below_the_sticking_speed_and_parts_above(zeta, tension):
    for elastic, by_area in ((False, False), (True, False), (True, True)):
        if elastic:
            speed = A.sticking_factor_hertz(zeta, tension, by_area)
        else:
            speed = A.sticking_speed(1.0, 1.0, 1.0, zeta, tension)
        assert not parts(0.998 * speed, zeta, tension, elastic, by_area)
        assert parts(1.002 * speed, zeta, tension, elastic, by_area)


def test_without_tension_even_a_strongly_damped_impact_parts_if_it_is_fast_enough():
    for zeta in (1.0, 1.5):
        assert A.sticking_speed(1.0, 1.0, 1.0, zeta, True) == math.inf
        assert math.isfinite(A.sticking_speed(1.0, 1.0, 1.0, zeta, False))
        assert A.sticking_factor_hertz(zeta, True, False) == math.inf


def test_little_damping_takes_what_an_undamped_contact_loses_in_one_round():
    zeta = 1e-5  # m v**2/2 = loss by the dashpot along the undamped way out and back
    assert A.sticking_speed(2.0, 3.0, 5.0, zeta, True) == pytest.approx(
        2.0 * math.sqrt(math.pi * zeta) * 2.0 / math.sqrt(15.0), rel=1e-4
    )
    # x'**2/2 = x - 0.4 x**2.5, and = x**2/2 - 0.4 x**2.5: integrals of sqrt(5) zeta x**0.25 x'
    constant = 2.0 * math.sqrt(10.0) * 2.5 ** (7.0 / 6.0) * 2.0 / 3.0 * beta(7.0 / 6.0, 1.5)
    by_area = 2.0 * math.sqrt(5.0) * 2.0 * 1.25**4.5 * beta(4.5, 1.5)
    for loss, area in ((constant, False), (by_area, True)):
        for tension in (True, False):
            found = A.sticking_factor_hertz(zeta, tension, area)
            assert found == pytest.approx(math.sqrt(2.0 * loss * zeta), rel=1e-3)
    assert A.sticking_speed(1.0, 1.0, 1.0, 0.0, False) == A.sticking_factor_hertz(0.0, True, False) == 0.0


def test_the_largest_force_against_an_attraction_by_area_is_that_of_its_curve():
    slope, stiff = 3.0, 7.0
    pulls = [slope * x - stiff * x**1.5 for x in [k * 1e-4 for k in range(4000)]]
    assert A.pull_off_area(slope, stiff) == pytest.approx(max(pulls), rel=1e-6)


@pytest.mark.parametrize(("load", "slope"), [(0.0, 2.0), (3.0, 0.0), (3.0, 2.0), (1e-9, 5.0), (1e9, 1e-9)])
def test_at_rest_the_springs_carry_load_and_attraction(load, slope):
    x = A.overlap_at_rest_hertz(load, slope, 4.0)
    assert 4.0 * x**1.5 == pytest.approx(load + slope * x, rel=1e-12)


@pytest.mark.parametrize(("pull", "slope"), [(0.0, 0.0), (2.0, 0.0), (0.0, 3.0), (2.0, 3.0)])
def test_the_largest_overlap_of_elastic_spheres_conserves_energy(pull, slope):
    x = A.overlap_max_adhesive_hertz(0.7, pull, slope, 4.0)
    assert 0.7 + pull * x + 0.5 * slope * x * x == pytest.approx(1.6 * x**2.5, rel=1e-12)


def damped(speed, zeta, pull):
    """Motion of a unit mass on a spring of stiffness 4 under a constant attraction."""
    return solve_ivp(
        lambda t, s: [s[1], pull - 4.0 * s[0] - 4.0 * zeta * s[1]],
        (0.0, 20.0), [0.0, speed], rtol=1e-10, atol=1e-12, max_step=0.01,
    )  # fmt: skip


@pytest.mark.parametrize("zeta", [0.0, 0.1, 0.7, 1.0, 1.8])
def test_the_largest_overlap_on_a_linear_spring_is_that_of_an_integration(zeta):
    for speed, pull in ((2.0, 0.0), (2.0, 1.5), (0.1, 3.0)):
        way = damped(speed, zeta, 1.5 * pull)
        largest = A.overlap_max_adhesive(speed, 1.0, 4.0, zeta, 1.5 * pull)
        assert largest == pytest.approx(max(way.y[0]), rel=5e-5)
    assert A.overlap_max_adhesive(2.0, 3.0, 5.0, zeta, 0.0) == pytest.approx(overlap_max(2.0, 3.0, 5.0, zeta))
