"""The implicit step: balances to round-off, stability at any length, driving forces, a moving surface."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.errors import WaterError
from ryusa.laws.families import BedKind, Drive, Mixing, SideWalls, SurfaceRule
from ryusa.model.column import Budget, Column, Top, WaterState
from ryusa.water import advance, discharge, driving_stress, steady


def tight(budget: Budget, momentum: float, dt: float) -> None:
    terms = [abs(x) for x in vars(budget).values()]
    assert abs(budget.residual) <= 2e-13 * (sum(terms) + momentum / dt)


def momentum(column: Column, state: WaterState) -> float:
    return column.rho_w * float(state.content @ state.u)


COLUMNS = {
    "moving bed": {},
    "volume": {"surface": SurfaceRule.VOLUME},
    "side walls": {"side": SideWalls.BLASIUS, "width": 0.0065},
    "discharge": {"drive": Drive.DISCHARGE, "discharge": 0.02, "g_x": 0.0},
    "tau": {"drive": Drive.TAU, "tau": 15.0},
    "lid": {"top": Top.LID, "u_lid": 1.0},
    "pores": {"k_f": 0.16, "d": 0.002},
}


@pytest.mark.parametrize("name", COLUMNS)
def test_the_momentum_budget_of_the_water_closes_to_round_off(bedload, phi, name):
    c = replace(bedload, **COLUMNS[name])
    rng = np.random.default_rng(5)
    state = WaterState.at_rest(c, phi)
    for _ in range(60):
        shift = 1e-4 * rng.standard_normal()
        now = 0.6 / (1.0 + np.exp((c.z - 0.02 - shift) / 1e-3))
        force = 2000.0 * now * (state.u - 0.3 * (c.z > 0.019)) * (1.0 + 0.2 * rng.standard_normal(c.n))
        before = momentum(c, state)
        dt = 10.0 ** rng.uniform(-5, -3)
        state, budget = advance(c, state, now, force, dt)
        tight(budget, abs(before), dt)
        assert budget.change == pytest.approx((momentum(c, state) - before) / dt, rel=1e-9, abs=1e-9)


def test_the_share_of_stress_on_grains_is_in_the_budget(bedload, phi):
    state, budget = steady(bedload, phi, np.zeros(bedload.n), slope=2000.0 * phi, carried=phi)
    assert budget.carried == pytest.approx(-float(phi @ np.diff(state.tau)), rel=1e-9)
    assert abs(budget.residual) < 1e-12 * budget.gravity


@pytest.mark.parametrize("dt", [1e-6, 1e-3, 1.0, 1e3, 1e9])
@pytest.mark.parametrize("bed", [BedKind.ROUGH, BedKind.SMOOTH])
def test_the_steady_state_stays_and_does_not_depend_on_the_step(river, dt, bed):
    c = replace(river, bed=bed)
    rest = steady(c)[0]
    state = rest
    for _ in range(5):
        state, _ = advance(c, state, np.zeros(c.n), None, dt)
    assert state.u == pytest.approx(rest.u, rel=1e-10)


@pytest.mark.parametrize("dt", [1e-4, 1e-1, 1e2, 1e6])
def test_a_step_of_any_length_from_rest_is_stable_and_never_overshoots(river, dt):
    rest = steady(river)[0]
    state = WaterState.at_rest(river, np.zeros(river.n))
    for _ in range(20):
        before = state.u
        state, _ = advance(river, state, np.zeros(river.n), None, dt)
        assert (state.u >= before - 1e-12).all()
        assert (state.u <= rest.u * (1.0 + 1e-9)).all()
    if dt > 1.0:
        assert state.u == pytest.approx(rest.u, rel=1e-9)


@pytest.mark.parametrize("mixing", list(Mixing))
def test_time_stepping_ends_at_the_steady_flow_with_every_mixing_length(bedload, phi, mixing):
    bed = BedKind.SMOOTH if mixing is Mixing.VAN_DRIEST else BedKind.MOVING
    c = replace(bedload, mixing=mixing, bed=bed, nu=1e-6 if mixing else 1e-4)
    slope = 1e4 * phi
    rest = steady(c, phi, np.zeros(c.n), slope=slope)[0]
    state = WaterState.at_rest(c, phi)
    for _ in range(60):
        state, _ = advance(c, state, phi, slope * state.u, 10.0, slope=slope)
    assert state.u == pytest.approx(rest.u, rel=1e-8, abs=1e-12)


@pytest.mark.parametrize("phi_bed", [0.3, 0.6])
def test_the_share_of_the_stress_on_grains_may_lag_a_step_behind(bedload, phi_bed):
    """The form `stress`: grains took phi d tau/dz of the last step; stable, same steady flow."""
    c = bedload
    phi = phi_bed / (1.0 + np.exp((c.z - 0.02) / 1e-3))
    slope = 1e4 * phi
    rest = steady(c, phi, np.zeros(c.n), slope=slope, carried=phi)[0]
    state = WaterState.at_rest(c, phi)
    for _ in range(400):
        state, _ = advance(c, state, phi, slope * state.u + phi * state.dtau_dz, 10.0, slope=slope)
    assert state.u == pytest.approx(rest.u, rel=1e-6, abs=1e-9)


def test_the_discharge_is_kept_in_every_step(bedload, phi):
    c = replace(bedload, drive=Drive.DISCHARGE, discharge=0.013, g_x=0.0)
    state = WaterState.at_rest(c, phi)
    for k in range(30):
        now = 0.6 / (1.0 + np.exp((c.z - 0.02 - 1e-4 * np.sin(k)) / 1e-3))
        state, _ = advance(c, state, now, 1e4 * now * state.u, 1e-3)
        assert discharge(state) == pytest.approx(0.013, rel=1e-12)


def test_the_driving_stress_is_the_one_of_the_case_for_any_slope(bedload, phi):
    for g_x in (0.0, 0.1, 1.0):
        c = replace(bedload, g_x=g_x, drive=Drive.TAU, tau=9.7)
        state, _ = advance(c, WaterState.at_rest(c, phi), phi, None, 1e-3)
        assert driving_stress(c, state) == pytest.approx(9.7, rel=1e-12)


def test_a_volume_of_water_is_kept_while_its_surface_moves(bedload):
    c = replace(bedload, surface=SurfaceRule.VOLUME, n=100)
    state = WaterState.at_rest(c, 0.6 / (1.0 + np.exp((c.z - 0.02) / 1e-3)))
    volume = state.volume
    heights = []
    for k in range(200):
        lift = 2e-3 * np.sin(0.1 * k)  # the bed swells by whole cells and sinks again
        now = np.minimum(0.6 / (1.0 + np.exp((c.z - 0.02 - lift) / 1e-3)), 0.6)
        before = momentum(c, state)
        state, budget = advance(c, state, now, np.zeros(c.n), 1e-3)
        tight(budget, abs(before), 1e-3)
        assert state.content.sum() == pytest.approx(volume, rel=1e-12)
        assert abs(budget.surface) <= 1e-9 * (abs(budget.gravity) + abs(before) / 1e-3)
        heights.append(state.z_surface)
    assert np.ptp(heights) == pytest.approx(0.6 * 4e-3, rel=0.05)


def test_a_plug_of_water_keeps_its_speed_while_grains_and_surface_move(bedload):
    """No stress, no force: water that is pushed up or down carries its own speed along."""
    c = replace(bedload, surface=SurfaceRule.VOLUME, n=100, g_x=0.0, mixing=Mixing.LAMINAR, nu=1e-30)
    state = replace(WaterState.at_rest(c, np.zeros(c.n)), u=np.full(c.n, 0.7))
    for k in range(100):
        now = 0.05 / (1.0 + np.exp((c.z - 0.02 - 2e-3 * np.sin(0.3 * k)) / 1e-3))
        state, _ = advance(c, state, now, None, 1e-3)
        assert state.u == pytest.approx(np.full(c.n, 0.7), rel=1e-9)


def test_settling_grains_displace_the_water_upwards():
    c = Column(z_low=0.0, dz=1e-3, n=20, depth=0.02)
    phi = np.full(c.n, 0.2)
    state, _ = advance(c, WaterState.at_rest(c, phi), phi, None, 1e-3, phi_w=-0.2 * 0.01 * np.ones(c.n))
    assert (1.0 - phi) * state.w + phi * -0.01 == pytest.approx(0.0, abs=1e-18)


def test_a_resume_gives_the_same_bits(bedload, phi):
    force = 1000.0 * phi
    state = WaterState.at_rest(bedload, phi)
    for _ in range(5):
        state, _ = advance(bedload, state, phi, force, 1e-3)
    copy = WaterState(**{k: v.copy() if isinstance(v, np.ndarray) else v for k, v in vars(state).items()})
    for _ in range(5):
        state, _ = advance(bedload, state, phi, force, 1e-3)
        copy, _ = advance(bedload, copy, phi, force, 1e-3)
    for name, value in vars(state).items():
        assert np.array_equal(value, getattr(copy, name)), name
    assert (state.step, copy.t) == (10, pytest.approx(0.01))


def test_arrays_of_a_state_are_read_only(river):
    state, _ = steady(river)
    for value in [*vars(state).values(), *vars(WaterState.at_rest(river, np.zeros(river.n))).values()]:
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable


def test_water_that_outgrows_the_column_is_an_error(bedload):
    c = replace(bedload, surface=SurfaceRule.VOLUME)
    state = WaterState.at_rest(c, np.zeros(c.n))
    with pytest.raises(WaterError, match="above the top of the column"):
        advance(c, state, np.full(c.n, 0.5), None, 1e-3)


def test_a_force_that_is_not_a_number_is_an_error(bedload, phi):
    force = np.zeros(bedload.n)
    force[3] = np.nan
    with pytest.raises(WaterError, match="is not finite"):
        advance(bedload, WaterState.at_rest(bedload, phi), phi, force, 1e-3)


@pytest.mark.parametrize("wrong", [1.0, 1.2, -0.1, np.nan])
def test_a_concentration_that_leaves_no_water_is_an_error(bedload, phi, wrong):
    state = WaterState.at_rest(bedload, phi)
    now = phi.copy()
    now[5] = wrong
    with pytest.raises(WaterError, match="not between 0 and 1"):
        advance(bedload, state, now, None, 1e-3)
