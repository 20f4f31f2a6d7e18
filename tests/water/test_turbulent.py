"""Turbulent water against the log laws."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ryusa.laws.families import BedKind, Drive, Mixing
from ryusa.laws.turbulence import length_van_driest, speed_mean_rough
from ryusa.laws.water import log_law_rough, log_law_smooth
from ryusa.model.column import Column
from ryusa.water import discharge, friction_velocity, steady
from ryusa.water.closures import averaged

U_STAR = 0.0985


def rough(z, k):
    return np.array([log_law_rough(float(x), U_STAR, k) for x in z])


@pytest.mark.parametrize("n", [10, 20, 40, 80])
def test_an_open_channel_follows_eq_9_on_any_grid(river, n):
    c = replace(river, n=n, dz=river.depth / n, nu=1e-12)
    state, _ = steady(c)
    assert state.u == pytest.approx(rough(c.z, c.k_rough), rel=1e-7)


def test_viscosity_and_the_usual_kappa_change_the_log_law_by_less_than_three_percent(river):
    law = rough(river.z, river.k_rough)
    assert np.abs(steady(river)[0].u / law - 1.0).max() < 0.014
    assert np.abs(steady(replace(river, kappa=0.41))[0].u / law - 1.0).max() < 0.03


def test_the_wall_carries_exactly_the_weight_of_the_water(river):
    for kappa in (0.40, 0.41):
        state, budget = steady(replace(river, kappa=kappa))
        assert state.tau[0] == pytest.approx(river.rho_w * U_STAR**2, rel=1e-12)
        assert friction_velocity(river, state) == pytest.approx(U_STAR, rel=1e-12)
        assert abs(budget.residual) < 1e-12 * budget.gravity


def test_the_discharge_of_the_log_law_is_met_and_the_better_the_finer_the_grid(river):
    exact = river.depth * speed_mean_rough(river.depth, U_STAR, river.k_rough)
    found = []
    for n in (10, 20, 40, 80):
        state, _ = steady(replace(river, n=n, dz=river.depth / n, nu=1e-12))
        found.append(abs(discharge(state) / exact - 1.0))
    assert found[0] < 7e-3
    assert found[2] < 1.2e-3
    assert all(fine < 0.5 * coarse for coarse, fine in pairwise(found))


def test_prandtls_length_under_a_linear_stress_has_its_own_closed_form(river):
    """kappa U/u_star = 2 r + ln((1 - r)/(1 + r)) + const, r = sqrt(1 - z/h)."""
    found = []
    for n in (20, 40, 80):
        c = replace(river, n=n, dz=river.depth / n, nu=1e-12, mixing=Mixing.PRANDTL)
        u = steady(c)[0].u
        r = np.sqrt(1.0 - c.z / c.depth)
        law = U_STAR / c.kappa * (2.0 * r + np.log((1.0 - r) / (1.0 + r)))
        found.append(np.abs((u - u[0]) - (law - law[0])).max() / u[-1])
    assert found[1] < 1e-3
    assert found[2] < 0.6 * found[1] < 0.36 * found[0]


def test_the_length_of_li_and_sawamoto_is_prandtls_in_clear_water(river):
    c = replace(river, mixing=Mixing.LI_SAWAMOTO)
    assert steady(c)[0].u == pytest.approx(steady(replace(river, mixing=Mixing.PRANDTL))[0].u, rel=1e-9)


def smooth(n: int, mixing: Mixing, bed: BedKind) -> Column:
    """A smooth channel with u_star h/nu = 1000."""
    depth, nu = 0.02, 1e-6
    return Column(
        z_low=0.0,
        dz=depth / n,
        n=n,
        depth=depth,
        nu=nu,
        bed=bed,
        mixing=mixing,
        g_x=(1000.0 * nu / depth) ** 2 / depth,
    )


def test_van_driest_gives_the_viscous_layer_and_the_log_layer():
    c = smooth(1000, Mixing.VAN_DRIEST, BedKind.NO_SLIP)
    state, _ = steady(c)
    u_star = friction_velocity(c, state)
    assert u_star == pytest.approx(0.05, rel=1e-12)
    z_plus, u_plus = c.z * u_star / c.nu, state.u / u_star
    low = z_plus < 3.0
    assert u_plus[low] == pytest.approx(z_plus[low], rel=5e-3)
    log = (z_plus > 50.0) & (z_plus < 100.0)
    assert u_plus[log] == pytest.approx(np.log(z_plus[log]) / 0.41 + 5.25, rel=0.015)


def test_van_driest_is_of_second_order():
    fine = 400_000
    depth, nu, u_star = 0.02, 1e-6, 0.05
    z = (np.arange(fine) + 0.5) / fine * depth
    square = np.array([length_van_driest(float(x), u_star, nu, 0.41) ** 2 for x in z[::20]])
    square = np.interp(z, z[::20], square)
    shear = 2.0 * u_star**2 * (1.0 - z / depth)
    shear /= nu + np.sqrt(nu**2 + 4.0 * square * u_star**2 * (1.0 - z / depth))
    speed = np.cumsum(shear) * depth / fine
    found = []
    for n in (500, 1000, 2000):
        c = smooth(n, Mixing.VAN_DRIEST, BedKind.NO_SLIP)
        u = steady(c)[0].u
        found.append(np.abs(u - np.interp(c.z, z + 0.5 * depth / fine, speed)).max() / u[-1])
    assert found[1] < 6e-4
    assert np.log2(found[1] / found[2]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("n", [5, 10, 20])
def test_a_coarse_grid_over_a_smooth_wall_follows_the_two_layer_law(n):
    c = smooth(n, Mixing.PARABOLIC, BedKind.SMOOTH)
    state, _ = steady(c)
    law = np.array([log_law_smooth(float(x), 0.05, c.nu) for x in c.z])
    assert state.tau[0] == pytest.approx(c.rho_w * 0.05**2, rel=1e-12)
    assert state.u == pytest.approx(law, rel=0.01)


def test_the_prescribed_stress_is_the_stress_of_the_bed(river):
    c = replace(river, g_x=0.0, drive=Drive.TAU, tau=river.rho_w * U_STAR**2)
    state, _ = steady(c)
    assert state.tau[0] == pytest.approx(c.tau, rel=1e-12)
    assert state.u == pytest.approx(steady(river)[0].u, rel=1e-9)


def test_the_eddies_of_the_pores_carry_a_debris_flow_with_the_profile_of_bagnold():
    """Uniform c and linear stress: U = (2/3) sqrt(g_x/f_f)/d (h**1.5 - (h - z)**1.5)."""
    c = Column(z_low=0.0, dz=1e-3, n=100, depth=0.1, nu=1e-12, g_x=2.0, bed=BedKind.MOVING, k_f=0.16, d=0.005)
    phi = np.full(c.n, 0.4)
    f_f = 0.16 * 0.6 ** (5 / 3) * 0.4 ** (-2 / 3)
    u = steady(c, phi)[0].u
    law = 2 / 3 * np.sqrt(c.g_x * 0.6 / f_f) / c.d * (c.depth**1.5 - (c.depth - c.z) ** 1.5)
    assert u == pytest.approx(law, rel=2e-3)


def test_drag_of_a_resting_bed_stops_the_water_in_it(bedload, phi):
    slope = 5e5 * phi
    state, budget = steady(bedload, phi, np.zeros(bedload.n), slope=slope)
    deep = (bedload.z > 0.002) & (bedload.z < 0.01)
    pores = bedload.rho_w * bedload.g_x * (1.0 - phi) / slope  # drag carries the weight of the water
    assert state.u[deep] == pytest.approx(pores[deep], rel=1e-3)
    assert state.u[deep].max() < 0.005 * state.u.max()
    assert -budget.grains > 0.99 * budget.gravity


def test_no_eddies_grow_in_gaps_below_the_highest_packed_cell(bedload, phi):
    packed = np.where(bedload.z < 0.02, 0.7, phi)
    loose = packed.copy()
    loose[[5, 17, 33]] = 0.3  # gaps between layers of the bed, whose crest stays packed
    whole, gaps = (steady(bedload, one)[0] for one in (packed, loose))
    under = bedload.faces < 0.0201
    over = ~under & (bedload.faces < bedload.z_surface - 0.1 * bedload.dz)
    assert (whole.nu_t[under] == 0.0).all()
    assert np.array_equal(gaps.nu_t[under], whole.nu_t[under])
    assert (gaps.nu_t[over] > 0.0).all()


def test_a_bed_that_is_nowhere_packed_lets_eddies_grow_in_it(bedload, phi):
    assert phi.max() < bedload.phi_max
    wet = (bedload.faces > 0.0) & (bedload.faces < bedload.z_surface - 0.1 * bedload.dz)
    assert (steady(bedload, phi)[0].nu_t[wet] > 0.0).all()


def test_the_layering_of_a_bed_vanishes_in_the_mean_over_a_grain():
    k = np.arange(200)
    layers = 0.5 + 0.2 * np.cos(2.0 * np.pi * k / 10.0)
    mean = averaged(0.1, 1.0, 199, layers)
    assert mean[5:-5] == pytest.approx(np.full(190, 0.5), abs=2e-3)
    assert averaged(0.1, np.nan, 199, layers) == pytest.approx(layers)
    assert averaged(2.0, 1.0, 199, layers) == pytest.approx(layers)
    assert averaged(0.1, 1.0, 99, np.ones(200))[:100] == pytest.approx(np.ones(100))
