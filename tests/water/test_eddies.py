"""Random walk of grains from eddy to eddy: fluctuations, lifetimes, and fluid that stays mixed."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.water.test_coupling import D, advance_together, cloud, column_of

from ryusa.laws.families import BedKind, Buoyancy, Fluctuations, Mixing
from ryusa.model.column import WaterState
from ryusa.water import advance, eddies
from ryusa.water.exchange import Cells, slices

N = 40_000
ONE = np.ones(N)


def walk(steps, dt, shear=1.0, seed=3, n=N):
    """Eddies after each of some steps under a constant shear."""
    now = eddies.begin(seed, n)
    yield now
    for _ in range(steps):
        now = eddies.renew(now, seed, dt, np.full(n, shear))
        yield now


@pytest.mark.parametrize("shear", [2.0, -2.0])
def test_the_reynolds_stress_and_the_variances_are_those_prescribed(shear):
    u_tau = 0.3 * ONE
    u = eddies.speeds(eddies.begin(11, N), False, u_tau, 0.0 * ONE, shear * ONE) / 0.3
    error = 4.0 / math.sqrt(N)
    assert np.abs(u.mean(axis=0)).max() < 1.5 * error
    assert u.var(axis=0) == pytest.approx([2.0, 1.0, 1.0], abs=3.0 * error)
    assert np.mean(u[:, 0] * u[:, 2]) == pytest.approx(-math.copysign(1.0, shear), abs=2.5 * error)
    assert np.mean(u[:, 1] * u[:, 2]) == pytest.approx(0.0, abs=error)
    assert np.mean(u[:, 2] ** 4) == pytest.approx(3.0, abs=12.0 * error)  # normal numbers
    assert not eddies.speeds(eddies.begin(11, N), True, u_tau, 0.0 * ONE, shear * ONE)[:, 1].any()


def test_eddies_last_as_long_as_the_shear_implies_and_are_independent():
    dt, shear = 0.02, 5.0  # life 2/5 s: 20 steps
    states = list(walk(60, dt, shear))
    w = np.array([one.r[:, 2] for one in states])
    error = 4.0 / math.sqrt(N)
    for lag in (0, 5, 10, 15, 20, 30):
        expected = max(1.0 - lag / 20.0, 0.0)  # renewed at a random age, each after 20 steps
        assert np.mean(w[7] * w[7 + lag]) == pytest.approx(expected, abs=2.0 * error)
    assert states[-1].count.mean() == pytest.approx(3.0, abs=error)
    assert np.all((states[-1].spent >= 0.0) & (states[-1].spent < 1.0))


def test_fluid_spreads_with_the_eddy_viscosity():
    dt, shear, u_tau = 0.02, 5.0, 0.1
    z, steps = np.zeros(N), 400
    for now in walk(steps, dt, shear):
        z += now.r[:, 2] * u_tau * dt
    spread = np.var(z) / (2.0 * (steps + 1) * dt)
    assert spread == pytest.approx(u_tau**2 / shear, rel=0.06)  # l**2 |dU/dz| with l = u_tau/|dU/dz|


@pytest.mark.parametrize("settling", [0.0, 0.4])
def test_fluid_stays_mixed_and_grains_follow_rouse(settling):
    # parabolic eddy viscosity kappa u_star z (1 - z/h); settling: the Rouse number
    n, kappa, u_star, h = 3000, 0.41, 1.0, 1.0
    low, high = 0.02 * h, 0.999 * h
    z = np.random.default_rng(1).uniform(low, high, n)
    now, dt, steps = eddies.begin(5, n), 0.1 * kappa * low / u_star, 12_000
    count = np.zeros(12)
    for k in range(steps):
        shear = u_star / (kappa * z)
        u = eddies.speeds(
            now, True, u_star * np.sqrt(1.0 - z / h), -0.5 * kappa * u_star * z / h, shear
        )  # fmt: skip
        z = z + (u[:, 2] - settling * kappa * u_star) * dt
        back = (z < low) | (z > high)
        z = np.where(z < low, 2.0 * low - z, np.where(z > high, 2.0 * high - z, z))
        now.r[back, 2] *= -1.0
        now = eddies.renew(now, 5, dt, shear)
        if k > steps / 3 and k % 20 == 0:
            count += np.histogram(z, bins=12, range=(low, high))[0]
    edges = np.linspace(low, high, 13)
    middle = 0.5 * (edges[1:] + edges[:-1])
    rouse = ((h - middle) / middle) ** settling
    ratio = (count / count.sum()) / (rouse / rouse.sum())
    assert ratio[1:10] == pytest.approx(np.ones(9), abs=0.08)
    assert ratio[-1] > 0.5


def test_a_draw_depends_on_seed_grain_and_number_alone():
    whole = list(walk(30, 0.1, 5.0, n=50))[-1]
    first = list(walk(30, 0.1, 5.0, n=20))[-1]
    assert np.array_equal(whole.r[:20], first.r)
    assert not np.array_equal(whole.r, list(walk(30, 0.1, 5.0, seed=4, n=50))[-1].r)
    numbers = [eddies.draw(s, g, c, k) for s in (0, 1) for g in (0, 1) for c in (0, 1) for k in range(5)]
    assert len(set(numbers)) == len(numbers)
    assert all(0.0 < one < 1.0 for one in numbers)


def test_in_still_water_eddies_have_infinite_lifetimes():
    *_, last = walk(5, 1.0, shear=0.0, n=10)
    assert not last.count.any()


def _stirred(area, **more):
    return replace(column_of(area), fluctuations=Fluctuations.RANDOM_WALK, seed=7, **more)


@pytest.mark.parametrize("form", list(Buoyancy))
def test_momentum_is_conserved_with_fluctuations(form):
    from ryusa.water import steady

    made, area = cloud(form)
    column = _stirred(area)
    water, _ = steady(column, np.zeros(column.n), None)
    fixed, dt = made[0], made[0].dt
    for coupling, _, steps, (_, v, seen, _, v_now, _) in advance_together(
        made, column, 12, water_state=water
    ):
        budget, time = coupling.budget, steps * dt
        grains = float(fixed.m @ (v_now[:, 0] - v[:, 0])) / (area * time)
        weight = float(fixed.m.sum()) * fixed.gravity[0] / area
        given = weight + budget.gravity + budget.driver + budget.bed + budget.surface
        carries = 1000.0 * float(np.abs(coupling.state.u) @ coupling.state.content) / time
        assert grains + budget.change == pytest.approx(given, rel=1e-10, abs=4e-15 * carries)
        assert not seen[:, 1].any()  # a plane scene
    assert coupling.eddies.count.any()


def test_grains_feel_the_turbulence_at_their_position():
    from ryusa.water import steady

    n = 4000
    made, area = cloud(Buoyancy.STRESS, n=n)
    column = _stirred(1e6 * area)  # so wide that the grains do not slow the water
    water, _ = steady(column, np.zeros(column.n), None)
    (coupling, *_rest), *_ = advance_together(made, column, 1, water_state=water)
    plain, *_ = advance_together(made, replace(column, fluctuations=Fluctuations.NONE), 1, water_state=water)
    fluctuation = coupling.sampled[:, [0, 2]] - plain[0].sampled[:, [0, 2]]
    z, surface = made[1].x[:, 2], 25.0 * D
    u_star = math.sqrt(9.80665 * math.sin(0.05) * surface)
    share = 1.0 - z / surface  # of u_star**2, linear over the depth
    error = 4.0 / math.sqrt(n)
    assert np.mean(fluctuation[:, 0] * fluctuation[:, 1] / share) == pytest.approx(
        -(u_star**2), rel=4.0 * error
    )
    assert np.mean(fluctuation[:, 1] ** 2 / share) == pytest.approx(u_star**2, rel=4.0 * error)


def test_a_grain_astride_the_crest_of_a_bed_drifts_no_faster_than_its_eddies():
    column = column_of(1.0, bed=BedKind.MOVING, mixing=Mixing.LI_SAWAMOTO, d=D)
    phi = np.where(column.z < 8.0 * D, 0.62, 0.0)
    drag = np.where(phi > 0.0, 1e7, 0.0)  # of grains at rest [N s/m4]
    none = np.zeros(column.n)
    state = WaterState.at_rest(column, phi)
    for _ in range(60):
        state, _ = advance(column, state, phi, none, 0.05, slope=drag)
    z = np.arange(2.0 * D, 24.0 * D, 0.13 * D)
    cut = slices(z, np.full(len(z), D), Cells(column.z_low, column.dz, column.n, 1.0))
    u_tau, drift, _ = eddies.turbulence(column, state, phi, cut)
    assert u_tau.max() > 0.05
    assert u_tau[z < 7.0 * D].max() == 0.0
    near = (z > 6.0 * D) & (z < 12.0 * D)
    assert np.abs(drift[near]).max() < u_tau[near].max()
    assert np.abs(drift).max() < 5.0 * u_tau.max()
