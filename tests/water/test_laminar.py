"""Viscous water against Poiseuille's and Couette's flows: second order in space."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from ryusa.laws.families import Drive, Mixing, SideWalls
from ryusa.model.column import Column, Top, WaterState
from ryusa.water import advance, discharge, steady


def errors(column: Column, exact) -> list[float]:
    """Largest errors of the speed on three grids, relative to the largest speed."""
    found = []
    for n in (10, 20, 40):
        c = replace(column, n=n, dz=column.depth / n)
        u = steady(c)[0].u
        found.append(np.abs(u - exact(c.z)).max() / np.abs(exact(c.z)).max())
    return found


def orders(found: list[float]) -> list[float]:
    return [float(np.log2(a / b)) for a, b in pairwise(found)]


def test_a_film_under_gravity_is_half_a_poiseuille_flow_of_second_order(laminar):
    c = laminar
    found = errors(c, lambda z: c.g_x / (2.0 * c.nu) * z * (2.0 * c.depth - z))
    assert found[-1] < 2e-4
    assert orders(found) == pytest.approx([2.0, 2.0], abs=0.05)


def test_water_between_two_plates_is_poiseuilles_of_second_order(laminar):
    c = replace(laminar, top=Top.LID, drive=Drive.GRADIENT, gradient=5.0, g_x=0.0)
    found = errors(c, lambda z: 5.0 / (2.0 * c.rho_w * c.nu) * z * (c.depth - z))
    assert found[-1] < 7e-4
    assert orders(found) == pytest.approx([2.0, 2.0], abs=0.05)


def test_water_under_a_moving_lid_is_couettes_without_error(laminar):
    c = replace(laminar, top=Top.LID, u_lid=0.3, g_x=0.0)
    assert max(errors(c, lambda z: 0.3 * z / c.depth)) < 1e-12


def test_couette_flow_with_a_gradient_is_of_second_order(laminar):
    c = replace(laminar, top=Top.LID, u_lid=0.3, g_x=0.0, drive=Drive.GRADIENT, gradient=-50.0)
    found = errors(c, lambda z: 0.3 * z / c.depth - 50.0 / (2 * c.rho_w * c.nu) * z * (c.depth - z))
    assert orders(found) == pytest.approx([2.0, 2.0], abs=0.1)


def test_viscosity_that_eddies_add_in_a_stress_layer_is_of_second_order():
    """Length of the pores everywhere d: (nu + d**2 |S|) S = tau/rho has a root in closed form."""
    c = Column(z_low=0.0, dz=1e-3, n=10, depth=0.01, nu=2e-4, g_x=0.5, k_f=0.16, d=0.001)
    n = 200_000
    z = (np.arange(n) + 0.5) / n * c.depth
    stress = c.g_x * (c.depth - z)
    shear = (np.sqrt(c.nu**2 + 4.0 * c.d**2 * stress) - c.nu) / (2.0 * c.d**2)
    speed = np.cumsum(shear) * c.depth / n
    found = errors(c, lambda at: np.interp(at, z + 0.5 * c.depth / n, speed))
    assert orders(found) == pytest.approx([2.0, 2.0], abs=0.1)


def test_a_surface_inside_a_cell_costs_no_order(laminar):
    c = laminar
    found = []
    for n in (10, 20, 40):
        depth = c.depth * (1.0 - 0.4 / n)  # the highest cell is 0.6 full
        short = replace(c, n=n, dz=c.depth / n, depth=depth)
        u = steady(short)[0].u[:-1]
        exact = (c.g_x / (2.0 * c.nu) * short.z * (2.0 * depth - short.z))[:-1]
        found.append(np.abs(u - exact).max() / exact.max())
    assert orders(found) == pytest.approx([2.0, 2.0], abs=0.25)


def test_deep_slow_water_between_side_walls_is_poiseuille_flow():
    c = Column(z_low=0.0, dz=0.01, n=20, depth=0.2, g_x=0.01, side=SideWalls.BLASIUS, width=0.004)
    u = steady(c)[0].u
    assert u[-1] == pytest.approx(c.g_x * c.width**2 / (12.0 * c.nu), rel=1e-9)


@pytest.mark.parametrize(("side", "f"), [(SideWalls.BLASIUS, 0.3164), (SideWalls.KARMAN_PRANDTL, None)])
def test_the_weight_of_fast_water_is_balanced_by_the_side_walls(side, f):
    c = Column(z_low=0.0, dz=0.01, n=20, depth=0.2, g_x=1.0, side=side, width=0.0065, mixing=Mixing.LAMINAR)
    u = steady(c)[0].u[-1]
    re = 2.0 * u * c.width / c.nu
    factor = c.g_x * 4.0 * c.width / u**2
    if f is None:
        assert 1.0 / np.sqrt(factor) == pytest.approx(2.0 * np.log10(re * np.sqrt(factor)) - 0.8, rel=1e-6)
    else:
        assert factor == pytest.approx(f / re**0.25, rel=1e-6)


def test_water_set_free_from_rest_first_falls_freely_and_ends_as_the_steady_flow(laminar):
    still = WaterState.at_rest(laminar, np.zeros(laminar.n))
    soon, _ = advance(laminar, still, np.zeros(laminar.n), None, 1e-3)
    assert soon.u[-1] == pytest.approx(laminar.g_x * 1e-3, rel=1e-6)
    assert soon.du_dt[-1] == pytest.approx(laminar.g_x, rel=1e-6)
    late = still
    for _ in range(200):
        late, _ = advance(laminar, late, np.zeros(laminar.n), None, 1.0)
    assert late.u == pytest.approx(steady(laminar)[0].u, rel=1e-12)
    assert discharge(late) == pytest.approx(laminar.g_x * laminar.depth**3 / (3.0 * laminar.nu), rel=2e-3)


def test_time_is_of_first_order(laminar):
    """The slowest mode of the film decays as exp(-nu (pi/2h)**2 t)."""
    c = replace(laminar, g_x=0.0, n=100, dz=1e-4)
    rate = c.nu * (np.pi / (2.0 * c.depth)) ** 2
    start = WaterState.at_rest(c, np.zeros(c.n))
    start = replace(start, u=np.sin(np.pi * c.z / (2.0 * c.depth)))
    found = []
    for steps in (10, 20, 40):
        state = start
        for _ in range(steps):
            state, _ = advance(c, state, np.zeros(c.n), None, 1.0 / rate / steps)
        found.append(abs(state.u[-1] / start.u[-1] - np.exp(-1.0)))
    assert orders(found) == pytest.approx([1.0, 1.0], abs=0.1)
