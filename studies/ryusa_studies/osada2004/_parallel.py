"""How nearly the paths of grains are parallel: one measure for every flow and frame interval."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ryusa.measure.statistics import Floats

# Ways along the bed, in diameters, over which heights are compared; first judged.
STRETCHES = 10.0, 3.0, 30.0
STEP = 1.0  # way between two places of a path, in diameters


@dataclass(frozen=True)
class Parallel:
    """Paths of all grains of a flow in a window.

    Attributes
    ----------
    change : root mean square of the change of height, in diameters, while a grain goes so many of them along
        the bed, by that way; nan where no grain goes so far.
    steep : sum of the heights gained and lost over that of the ways, from diameter to diameter of way [-].
    """

    change: Mapping[float, float]
    steep: float


def parallel(x: Floats, z: Floats, d: float, stretches: Sequence[float] = STRETCHES) -> Parallel:
    """Compare heights at equal ways along the bed.

    Parameters
    ----------
    x, z : centres of grains [m], x unwrapped, shape (n_frame, n_grain).
    d : diameter [m].
    stretches : ways, in diameters, whole numbers.

    Notes
    -----
    Places are taken where a grain comes to the next whole diameter of its way for the first time, by straight
    lines between frames. So neither the speed of the flow nor the time between frames sets what is seen of a
    path, as they would if heights were compared at equal times. Paths in parallel layers have 0.

    Examples
    --------
    >>> way = np.linspace(0.0, 40.0, 101)[:, None]
    >>> parallel(way, 0.1 * way, 1.0).change[10.0]  # a straight path that rises by a tenth
    1.0
    """
    heights = [one for g in range(x.shape[1]) if len(one := _at_whole_diameters(x[:, g], z[:, g], d)) > 1]
    change = {float(one): _rms([h[round(one) :] - h[: -round(one)] for h in heights]) for one in stretches}
    steps = np.concatenate([np.abs(np.diff(one)) for one in heights]) if heights else np.zeros(0)
    return Parallel(change, float(steps.mean()) / STEP if len(steps) else math.nan)


def _at_whole_diameters(x: Floats, z: Floats, d: float) -> Floats:
    """Heights over d of one grain at every whole diameter of its way, as it gets there first."""
    way = np.maximum.accumulate(x - x[0]) / d
    ahead = np.concatenate([[True], np.diff(way) > 0.0])
    places = np.arange(0.0, math.floor(way[-1] / STEP) * STEP + 0.5 * STEP, STEP)
    return np.interp(places, way[ahead], z[ahead]) / d


def _rms(parts: Sequence[Floats]) -> float:
    values = np.concatenate(parts) if parts else np.zeros(0)
    return round(float(np.sqrt((values**2).mean())), 12) if len(values) else math.nan
