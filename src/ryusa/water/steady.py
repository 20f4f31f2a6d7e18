"""Steady flow of the column for one-way studies, solved directly instead of by time stepping."""

import math
from dataclasses import replace

import numpy as np

from ryusa.laws.families import BedKind, Drive
from ryusa.model.column import Budget, Column, WaterState
from ryusa.model.scene import Floats
from ryusa.water._kernel import parameters_of
from ryusa.water.drive import imposed_gradient
from ryusa.water.solve import solve_step


def steady(
    column: Column,
    phi: Floats | None = None,
    force: Floats | None = None,
    *,
    slope: Floats | None = None,
    carried: Floats | None = None,
    guess: Floats | None = None,
) -> tuple[WaterState, Budget]:
    """Steady flow, and its momentum budget.

    Parameters
    ----------
    column : fixed parameters; a constant volume of water is the one that depth and phi give.
    phi : concentration of grains [-], shape (n,); None: clear water.
    force, slope : force of the water on the grains [N/m3] at the speeds `guess`, and its derivative with
        respect to the speed of the water [N s/m4], shape (n,); None: no grains.
    carried : share of d tau/dz that the grains take, as in `advance`.
    guess : speeds [m/s] at which the iteration starts and to which `force` refers, shape (n,); None: `force`
        refers to water at rest.

    Notes
    -----
    The system of `advance` with 1/dt = 0: the limit of time stepping, independent of the guess.
    """
    concentration = np.zeros(column.n) if phi is None else np.asarray(phi, dtype=np.float64)
    rest = WaterState.at_rest(column, concentration)
    start = rest.u if guess is None else np.asarray(guess, dtype=np.float64)
    # `force` refers to the speeds in the state; if they are zero, Newton's method starts from other speeds
    state = replace(rest, u=start)
    first = _first_guess(column, rest) if not start.any() else start
    return solve_step(column, state, concentration, force, slope, carried, None, 0.0, first, 0.0)


def _first_guess(column: Column, rest: WaterState) -> Floats:
    """Speeds of the right magnitude [m/s]: a log law, or the mean speed of the discharge."""
    over = np.maximum(column.z - column.z_low, 0.25 * column.dz)
    if column.drive is Drive.DISCHARGE:
        scale = column.discharge / max(rest.volume, 1e-300) / 20.0
    else:
        p = parameters_of(column)
        gradient = imposed_gradient(p, rest.content, rest.z_surface)
        stress = column.g_x * rest.volume + gradient * (rest.z_surface - column.z_low) / column.rho_w
        scale = math.copysign(math.sqrt(abs(stress)), stress)
    rough = column.k_rough if column.bed is BedKind.ROUGH else column.dz
    return scale * np.maximum(8.5 + 5.75 * np.log10(over / rough), 1.0)
