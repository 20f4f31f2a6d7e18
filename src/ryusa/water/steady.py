"""Steady water for one-way studies: the column's balance solved at once, without marching."""

import math
from dataclasses import replace

import numpy as np

from ryusa.model.column import Bed, Budget, Column, Drive, WaterState
from ryusa.model.scene import Floats
from ryusa.water._kernel import numbers
from ryusa.water.drive import gradient_asked
from ryusa.water.solve import _march


def steady(
    column: Column,
    phi: Floats | None = None,
    force: Floats | None = None,
    *,
    slope: Floats | None = None,
    carried: Floats | None = None,
    guess: Floats | None = None,
) -> tuple[WaterState, Budget]:
    """Water that no longer changes, and its momentum budget.

    Parameters
    ----------
    column : what holds still; a volume is kept at the value the depth and phi give it.
    phi : concentration of grains [-], shape (n,); None: clear water.
    force, slope : force of the water on the grains at rest speed of `guess`, and how it grows with the
        water's speed [N/m3], [N s/m4], shape (n,); None: no grains.
    carried : share of d tau/dz that the grains take, as in `advance`.
    guess : speeds to start from [m/s], shape (n,), to which `force` refers; None: zero for `force`.

    Notes
    -----
    The system of `advance` with 1/dt = 0 and the same result as marching for ever, whatever the guess.
    """
    concentration = np.zeros(column.n) if phi is None else np.asarray(phi, dtype=np.float64)
    rest = WaterState.at_rest(column, concentration)
    start = rest.u if guess is None else np.asarray(guess, dtype=np.float64)
    # `force` refers to the speeds in the state; Newton's method starts elsewhere when those are zero.
    state = replace(rest, u=start)
    first = _first_guess(column, rest) if not start.any() else start
    return _march(column, state, concentration, force, slope, carried, None, 0.0, first, 0.0)


def _first_guess(column: Column, rest: WaterState) -> Floats:
    """Speeds of the right size for the driver [m/s]: a log law, or the mean speed of the discharge."""
    over = np.maximum(column.z - column.z_low, 0.25 * column.dz)
    if column.drive is Drive.DISCHARGE:
        scale = column.discharge / max(rest.volume, 1e-300) / 20.0
    else:
        p = numbers(column)
        gradient = gradient_asked(p, rest.content, rest.z_surface)
        stress = column.g_x * rest.volume + gradient * (rest.z_surface - column.z_low) / column.rho_w
        scale = math.copysign(math.sqrt(abs(stress)), stress)
    rough = column.k_rough if column.bed is Bed.ROUGH else column.dz
    return scale * np.maximum(8.5 + 5.75 * np.log10(over / rough), 1.0)
