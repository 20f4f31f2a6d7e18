"""How long water needs from rest, by the formula of `ryusa check` and by stepping the column."""

import math
from dataclasses import replace

import numpy as np
import pytest

from ryusa.casefile.column.spin_up import FIRST_MODE, REACHED
from ryusa.laws.families import BedKind, Mixing
from ryusa.laws.spin_up import spin_up_laminar, spin_up_turbulent
from ryusa.laws.turbulence import speed_mean_rough
from ryusa.laws.water import log_law_smooth
from ryusa.model.column import Column, WaterState
from ryusa.water import advance, discharge, steady

BAND = (0.75, 1.33)  # estimate over measured time, chosen before the first comparison
U_STAR = 0.0985


def measured(c: Column, step: float) -> float:
    """Time at which the discharge of water from rest passes 95 % of that of steady flow [s]."""
    goal = REACHED * discharge(steady(c)[0])
    phi = np.zeros(c.n)
    state, before, t = WaterState.at_rest(c, phi), 0.0, 0.0
    while True:
        state, _ = advance(c, state, phi, np.zeros(c.n), step)
        now, t = discharge(state), t + step
        if now >= goal:
            return t - step * (now - goal) / (now - before)
        before = now


def estimate(speed: float, depth: float) -> float:
    return math.atanh(REACHED) * spin_up_turbulent(speed, depth, U_STAR)


@pytest.mark.parametrize("depths", [5, 10, 50, 250])
@pytest.mark.parametrize("mixing", [Mixing.PARABOLIC, Mixing.PRANDTL, Mixing.LI_SAWAMOTO])
def test_turbulent_water_over_a_rough_bed_takes_as_long_as_estimated(
    river: Column, depths: int, mixing: Mixing
) -> None:
    """Depths of 5 to 250 times the roughness."""
    c = replace(river, k_rough=river.depth / depths, mixing=mixing)
    guess = estimate(speed_mean_rough(c.depth, U_STAR, c.k_rough), c.depth)
    assert BAND[0] < guess / measured(c, guess / 400) < BAND[1]


@pytest.mark.parametrize("depth", [0.02, 0.2])
def test_turbulent_water_over_a_smooth_bed_takes_as_long_as_estimated(river: Column, depth: float) -> None:
    c = replace(river, bed=BedKind.SMOOTH, depth=depth, dz=depth / 40, g_x=U_STAR**2 / depth)
    guess = estimate(log_law_smooth(depth / math.e, U_STAR, c.nu), depth)
    assert BAND[0] < guess / measured(c, guess / 400) < BAND[1]


def test_viscous_water_takes_as_long_as_its_slowest_mode_says(laminar: Column) -> None:
    guess = math.log(FIRST_MODE / (1.0 - REACHED)) * spin_up_laminar(laminar.depth, laminar.nu)
    assert measured(laminar, guess / 2000) == pytest.approx(guess, rel=0.01)
