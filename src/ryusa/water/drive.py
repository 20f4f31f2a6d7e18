"""Driving force of the water: gravity, a pressure gradient, a bed stress or a discharge."""

import math

from ryusa.laws._family import numbers
from ryusa.laws.families import Drive
from ryusa.model.column import Column, WaterState
from ryusa.model.scene import Floats
from ryusa.water._kernel import ColumnParameters, kernel

GRAVITY, GRADIENT, TAU, DISCHARGE = numbers(
    __name__, Drive.GRAVITY, Drive.GRADIENT, Drive.TAU, Drive.DISCHARGE
)


@kernel
def water_above(content: Floats, z_low: float, dz: float, z_bed: float, z_surface: float) -> float:
    """Water above the bed per area [m]; a cell cut by the bed counts with the part above it."""
    total = 0.0
    for k in range(len(content)):
        low = z_low + k * dz
        high = min(low + dz, z_surface)
        if high > z_bed and high > low:
            total += content[k] * min((high - z_bed) / (high - low), 1.0)
    return total


@kernel
def imposed_gradient(p: ColumnParameters, content: Floats, z_surface: float) -> float:
    """Imposed pressure gradient -dp/dx [Pa/m]; 0 for DISCHARGE, where the time step solves for it.

    Notes
    -----
    TAU: the part that gravity along the slope does not supply, spread evenly over the depth, so that the
    water above the bed is driven with the stress of the case. In steady flow the bed carries that stress
    minus what side walls and grains take.
    """
    if p.drive == GRADIENT:
        return p.gradient
    if p.drive == TAU:
        weight = p.rho_w * p.g_x * water_above(content, p.z_low, p.dz, p.z_bed, z_surface)
        return (p.tau - weight) / (z_surface - p.z_bed)
    return 0.0


def driving_stress(column: Column, state: WaterState) -> float:
    """Stress by which slope and pressure gradient drive the water above the bed [Pa]."""
    content = water_above(state.content, column.z_low, column.dz, column.origin, state.z_surface)
    return column.rho_w * column.g_x * content + state.gradient * (state.z_surface - column.origin)


def discharge(state: WaterState) -> float:
    """Discharge of water per unit width [m2/s]."""
    return float(state.content @ state.u)


def friction_velocity(column: Column, state: WaterState) -> float:
    """Friction velocity of the water at the bottom of the column [m/s]."""
    return math.sqrt(abs(float(state.tau[0])) / column.rho_w)
