"""The mixing length of shear layers: its bound, what it leaves alone, how a jet widens, an eddy ends."""

from dataclasses import replace

import numpy as np
import pytest

from ryusa.laws.families import BedKind, Mixing, Pressure
from ryusa.laws.turbulence import length_pore_egashira, length_shear_layer
from ryusa.model.row import ColumnRow, EndKind, RowEnd
from ryusa.water._kernel import parameters_of
from ryusa.water.closures import bound_by_layers
from ryusa.water.row import advance_row, row_at_rest
from ryusa_studies.validation.river_pressure import G, water
from ryusa_studies.validation.river_shear_layers import widening

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
def test_above_a_jet_below_still_water_the_length_goes_with_its_half_width(way):
    width, at = 0.01, 5
    jet = np.where(np.arange(N) < at, 0.8, np.cosh(0.881374 * (Z - Z[at]) / width) ** -2.0)
    found = bounded(way * jet)
    assert found[at + 1 : -1] == pytest.approx(length_shear_layer(width), rel=5e-3)
    steepest = np.abs(np.diff(jet)[at:]).max() / DZ
    assert found[at + 1] ** 2 * steepest == pytest.approx(0.0235 * width, rel=0.06)  # 0.073/(4 0.881**2)


def test_below_a_stream_over_still_water_too():
    width, top = 0.015, N - 1
    layer = np.cosh(0.881374 * (Z - Z[top]) / width) ** -2.0
    found = bounded(layer)
    assert found[1:top] == pytest.approx(length_shear_layer(width), rel=0.02)


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


def eddy(mixing: str, step: float = 0.05, cell: float = 0.005) -> float:
    """Length of the eddy behind a step down to twice the depth, in heights of the step."""
    deep, dx = 2.0 * step, 2.0 * cell
    column = replace(
        water(cell, 2 * round(deep / cell), deep, nu=1e-6), bed=BedKind.ROUGH, k_rough=0.005,
        mixing=Mixing.of(mixing),
    )  # fmt: skip
    before = round(0.3 / dx)
    row = ColumnRow(
        column, dx, np.zeros(before + 100), G, RowEnd(EndKind.DISCHARGE, discharge=0.25 * step),
        RowEnd(EndKind.LEVEL, level=deep), pressure=Pressure.FULL,
        solid=np.where(np.arange(before + 100) < before, round(step / cell), 0),
    )  # fmt: skip
    now, mean = row_at_rest(row, np.full(before + 100, deep)), 0.0
    for _ in range(12):
        now = advance_row(row, now, 1.0)
        mean = mean + now.u[:, 0] * (now.t > 6.0)
    back = np.flatnonzero((row.x_station > 0.3 + 0.5 * dx) & (mean < 0.0))
    return float(row.x_station[back[-1]] - 0.3) / step


def test_the_eddy_behind_a_step_is_twice_as_long():
    """That of channels which become 1.2 times as deep has 6.28 heights (Le, Moin & Kim 1997)."""
    own, other = eddy("shear layer"), eddy("Li-Sawamoto")
    assert own > 1.8 * other > 4.0 and own > 5.0
