"""The mixing length of shear layers: its bound, what it leaves alone, how a jet widens, an eddy ends."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import erf

from ryusa.laws.families import BedKind, Mixing, Pressure
from ryusa.laws.turbulence import length_pore_egashira, length_shear_layer
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
    assert found[at + 1 : -1] == pytest.approx(length_shear_layer(1.0 / steepest), rel=5e-3)
    assert found[at + 1] == pytest.approx(np.sqrt(0.0235 * width / steepest), rel=0.06)  # 0.073/(4 0.881**2)


@pytest.mark.parametrize("depth", [0.04, 0.06])  # of the middle of the layer: what lies above it counts not
def test_below_a_stream_over_still_water_too(depth):
    wide = 0.012 * 11.0 / np.sqrt(np.pi)  # way from the edge, of a layer 1.2 cm thick
    layer = 0.5 * (1.0 + erf(11.0 * (Z + depth - N * DZ) / wide))
    steepest = np.diff(layer).max() / DZ
    assert 1.0 / steepest == pytest.approx(0.012, rel=0.02)
    found = bounded(layer)
    assert found[1 : int(layer.argmax())] == pytest.approx(length_shear_layer(0.012), rel=0.02)
    at = int(np.diff(layer).argmax()) + 1
    assert found[at] == pytest.approx(np.sqrt(wide / (4.0 * 11.0**2) / steepest), rel=0.07)


@pytest.mark.parametrize("cells", [1.25, 2.0, 4.0])  # of the roughness
def test_along_a_wall_the_length_is_that_of_the_wall(cells):
    """However fine the cells are, of which the lowest ones are slow."""
    dz = 0.004 / cells
    z = (np.arange(round(0.1 / dz)) + 0.5) * dz
    p = parameters_of(replace(water(dz, len(z), 0.1, nu=1e-6), mixing=Mixing.SHEAR_LAYER))
    square, log = np.full(len(z) + 1, LONG**2), np.log(np.maximum(30.0 * z / 0.004, 1.01))
    bound_by_layers(p, len(z) - 1, np.zeros(len(z)), z, log, square)
    assert (square == LONG**2).all()


def test_over_a_bed_of_grains_the_water_in_its_pores_counts_not():
    stream = np.log(1.5 + 20.0 * Z)
    u, phi = np.where(np.arange(N) < 10, 0.0, stream), np.where(np.arange(N) < 10, 0.6, 0.0)
    assert (bounded(u) < LONG).any()  # as it is without the grains
    p = parameters_of(replace(water(DZ, N, N * DZ, nu=1e-6), mixing=Mixing.SHEAR_LAYER))
    square = np.full(N + 1, LONG**2)
    bound_by_layers(p, N - 1, phi, Z, u, square)
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


def test_the_bound_comes_in_with_the_shape_factor():
    """That of two streams beside each other is the faster speed over the slower one."""
    slower = (0.6, 0.5, 0.4, 1.0 / 3.0, 0.2)
    found = [bounded(np.where(np.arange(N) < 5, 1.0, one))[20] for one in slower]
    whole = LONG - length_shear_layer(DZ)
    assert [(LONG - one) / whole for one in found] == pytest.approx([0.0, 0.0, 0.5, 1.0, 1.0])


def test_a_length_that_is_shorter_stays():
    p = parameters_of(replace(water(DZ, N, N * DZ, nu=1e-6), mixing=Mixing.SHEAR_LAYER))
    square = np.full(N + 1, 1e-8)
    bound_by_layers(p, N - 1, np.zeros(N), Z, np.cos(20.0 * Z), square)
    assert (square == 1e-8).all()


@pytest.mark.parametrize("cells", [20, 60])
def test_a_uniform_stream_is_that_of_li_and_sawamoto(cells):
    """A level row of one period, driven by its slope: not a bit is other."""
    found = []
    for mixing in (Mixing.LI_SAWAMOTO, Mixing.SHEAR_LAYER):
        c = replace(
            water(0.1 / cells, 3 * cells // 2, 0.1, nu=1e-6), bed=BedKind.ROUGH, k_rough=0.004, g_x=0.01 * G,
            mixing=mixing,
        )  # fmt: skip
        row = ColumnRow(c, 0.05, np.zeros(4), G, pressure=Pressure.FULL)
        found.append(advance_row(row, row_at_rest(row, np.full(4, 0.1)), 3.0).u)
    assert np.array_equal(*found)
    assert found[0].max() > 0.2


def test_a_jet_along_the_bed_widens_as_wall_jets_do():
    """In cells half as large again as those of the gate; Li & Sawamoto's length takes more of its speed."""
    own, other = (widening(word, cell=0.0075, time=6.0) for word in ("shear layer", "Li-Sawamoto"))
    assert float(own["rate"]) == pytest.approx(0.073, rel=0.2)
    assert own["speed"][-1] > 1.2 * other["speed"][-1]


def test_the_eddy_behind_a_step_is_longer():
    """In cells twice as large as those of the gate."""
    own, other = (
        eddy(word, cells=5, before=5.0, time=6.0)["length"] for word in ("shear layer", "Li-Sawamoto")
    )
    assert own > 1.2 * other > 2.0
