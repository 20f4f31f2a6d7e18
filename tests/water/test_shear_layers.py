"""The mixing length of shear layers: its bound, what it leaves alone, how a jet widens, an eddy ends."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import erf

from ryusa.laws.families import BedKind, Mixing, Pressure
from ryusa.laws.turbulence import length_jet, length_mixing_layer, length_pore_egashira
from ryusa.model.row import ColumnRow
from ryusa.water._kernel import parameters_of
from ryusa.water.closures import bound_by_layers
from ryusa.water.row import advance_row, row_at_rest
from ryusa_studies.validation.river_pressure import G, water
from ryusa_studies.validation.river_shear_layers import eddy, widening

DZ, N = 0.002, 40
Z = (np.arange(N) + 0.5) * DZ
LONG = 0.02  # mixing length at all faces [m]


def bounded(u: np.ndarray, mixing: Mixing = Mixing.SHEAR_LAYER, phi: float = 0.0, **more) -> np.ndarray:
    """Mixing lengths [m] after the bound, all LONG before it, for the speeds of a column."""
    p = parameters_of(replace(water(DZ, N, N * DZ, nu=1e-6), mixing=mixing, **more))
    square = np.full(N + 1, (1.0 - phi) * LONG**2)
    bound_by_layers(p, N - 1, np.full(N, phi), Z, u, square)
    return np.sqrt(square)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_above_a_jet_below_still_water_the_length_goes_with_its_thickness(way):
    width, at = 0.01, 5
    jet = np.where(np.arange(N) < at, 0.8, np.cosh(0.881374 * (Z - Z[at]) / width) ** -2.0)
    found = bounded(way * jet)
    steepest = np.abs(np.diff(jet)[at:]).max() / DZ
    assert found[at + 1 : -1] == pytest.approx(length_jet(1.0 / steepest), rel=5e-3)
    assert found[at + 1] ** 2 * steepest == pytest.approx(0.0235 * width, rel=0.06)  # 0.073/(4 0.881**2)


@pytest.mark.parametrize("depth", [0.04, 0.06])  # of the middle of the layer: what lies above it counts not
def test_below_a_stream_over_still_water_too(depth):
    wide = 0.012 * 11.0 / np.sqrt(np.pi)  # way from the edge, of a layer 1.2 cm thick
    layer = 0.5 * (1.0 + erf(11.0 * (Z + depth - N * DZ) / wide))
    steepest = np.diff(layer).max() / DZ
    assert 1.0 / steepest == pytest.approx(0.012, rel=0.02)
    found = bounded(layer)
    assert found[1 : int(layer.argmax())] == pytest.approx(length_mixing_layer(0.012), rel=0.03)
    at = int(np.diff(layer).argmax()) + 1
    assert found[at] ** 2 * steepest == pytest.approx(wide / (4.0 * 11.0**2), rel=0.06)


def test_along_a_wall_the_length_is_that_of_the_wall():
    """At most half of the speed is lost above the lowest cell, or above a bed of grains."""
    stream = 0.5 + 0.5 * (np.arange(N) / (N - 1.0)) ** 0.3
    assert (bounded(stream) == LONG).all()
    p = parameters_of(replace(water(DZ, N, N * DZ, nu=1e-6), mixing=Mixing.SHEAR_LAYER))
    phi, square = np.where(np.arange(N) < 10, 0.6, 0.0), np.full(N + 1, LONG**2)
    bound_by_layers(p, N - 1, phi, Z, np.where(phi > 0.0, 0.0, stream), square)
    assert (square == LONG**2).all()


def test_grains_take_their_share_of_it_and_the_length_of_the_pores_stays():
    jet = np.cosh(100.0 * (Z - Z[5])) ** -2.0
    clear, laden = bounded(jet), bounded(jet, phi=0.3)
    assert laden[6:-1] ** 2 == pytest.approx(0.7 * clear[6:-1] ** 2)
    pores = bounded(jet, phi=0.3, k_f=0.16, d=0.01)[6:-1]
    assert pores == pytest.approx(length_pore_egashira(0.3, 0.01, 0.16)) and (pores > laden[6:-1]).all()


def test_even_flow_and_other_lengths_keep_theirs():
    for u in (np.zeros(N), np.full(N, -0.3)):
        assert (bounded(u) == LONG).all()
    assert (bounded(np.cos(20.0 * Z), Mixing.LI_SAWAMOTO) == LONG).all()


def test_the_bound_comes_in_with_the_speed_that_is_lost():
    jet = np.cosh(100.0 * (Z - Z[5])) ** -2.0
    found = [bounded(1.0 - share * (1.0 - jet))[20] for share in (0.0, 0.25, 0.5, 1.0)]
    whole = LONG - found[-1]
    assert [(LONG - one) / whole for one in found] == pytest.approx([0.0, 0.25, 0.5, 1.0], abs=0.01)


def test_a_length_that_is_shorter_stays():
    p = parameters_of(replace(water(DZ, N, N * DZ, nu=1e-6), mixing=Mixing.SHEAR_LAYER))
    square = np.full(N + 1, 1e-8)
    bound_by_layers(p, N - 1, np.zeros(N), Z, np.cos(20.0 * Z), square)
    assert (square == 1e-8).all()


def test_a_uniform_stream_lies_between_those_of_li_and_sawamoto_and_nezu():
    """A level row of one period, driven by its slope."""
    found = []
    for mixing in (Mixing.LI_SAWAMOTO, Mixing.SHEAR_LAYER, Mixing.PARABOLIC):
        c = replace(
            water(0.005, 30, 0.1, nu=1e-6), bed=BedKind.ROUGH, k_rough=0.004, g_x=0.01 * G, mixing=mixing
        )
        row = ColumnRow(c, 0.05, np.zeros(4), G, pressure=Pressure.FULL)
        found.append(advance_row(row, row_at_rest(row, np.full(4, 0.1)), 30.0).u[1, :20].mean())
    assert found[0] < found[1] < found[2] < 1.1 * found[0]


def test_a_jet_along_the_bed_widens_as_wall_jets_do():
    """In cells half as large again as those of the gate; Li & Sawamoto's length takes more of its speed."""
    own, other = (widening(word, cell=0.0075, time=6.0) for word in ("shear layer", "Li-Sawamoto"))
    assert float(own["rate"]) == pytest.approx(0.073, rel=0.2)
    assert own["speed"][-1] > 1.2 * other["speed"][-1]


def test_the_eddy_behind_a_step_is_longer():
    """In cells twice as large as those of the gate."""
    own, other = (eddy(word, cells=5, time=12.0)["length"] for word in ("shear layer", "Li-Sawamoto"))
    assert own > 1.2 * other > 2.0
