"""What grains can be coloured by: a word, a label with its unit, a colour map, and the values at a frame."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.model import Scene
from ryusa.results import Results
from ryusa.results.touching import contacts_per_grain

Floats = NDArray[np.float64]

SHARE = 0.99  # of the values that a scale covers: a few fast grains would leave the others in one colour
STILL = 0.05  # smallest top of the scale of speed, in sqrt(g d): below it grains tremble, they do not move


@dataclass(frozen=True)
class Colouring:
    """One quantity that grains can be coloured by.

    Attributes
    ----------
    word : on the command line and in the page.
    label : with its symbol.
    unit : in which it is shown; "" where it is a number.
    scale : of that unit over SI, such as 1000 for mm.
    colours : name of a colour map of matplotlib.
    values : values at frame k of a run, in SI, shape (n_grain,).
    signed : both signs occur; the scale is symmetric about zero.
    steady : the values never change.
    """

    word: str
    label: str
    unit: str
    scale: float
    colours: str
    values: Callable[[Results, int], Floats]
    signed: bool = False
    steady: bool = False


def _speed(results: Results, k: int) -> Floats:
    return np.linalg.norm(results.frames.v[k], axis=1)


def _height(results: Results, k: int) -> Floats:
    return results.frames.x_wrapped[k][:, 2]


def _spin(results: Results, k: int) -> Floats:
    return results.frames.omega[k][:, 1]


def _size(results: Results, _k: int) -> Floats:
    return results.scene.d


def _contacts(results: Results, k: int) -> Floats:
    t = float(results.frames.t[k])
    return contacts_per_grain(results.frames.x_wrapped[k], results.scene_at(t), t).astype(np.float64)


COLOURINGS = (
    Colouring("speed", "speed", "m/s", 1.0, "YlGnBu", _speed),
    Colouring("height", "height z", "cm", 100.0, "viridis", _height),
    Colouring("spin", "spin about y, positive rolls towards +x", "rad/s", 1.0, "RdBu_r", _spin, signed=True),
    Colouring("size", "diameter", "mm", 1000.0, "plasma", _size, steady=True),
    Colouring("contacts", "contacts with grains and planes", "", 1.0, "YlOrBr", _contacts),
)  # fmt: skip


def value_range(one: Colouring, values: Floats, scene: Scene) -> tuple[float, float]:
    """Ends of the colour scale for some values, in SI.

    Parameters
    ----------
    values : of all grains and frames that are shown, any shape.

    Returns
    -------
    low, high : low < high. They cover 99 % of the values; those beyond have the colour of the end. Speed
        begins at 0 and ends at 0.05 sqrt(g d) or above, a signed quantity is symmetric about 0, contacts are
        whole.
    """
    if values.size == 0:
        return (-1.0, 1.0) if one.signed else (0.0, 1.0)
    if one.signed:
        most = float(np.quantile(np.abs(values), SHARE))
        return (-most, most) if most > 0.0 else (-1.0, 1.0)
    if one.word == "contacts":
        return 0.0, max(float(math.ceil(np.quantile(values, SHARE))), 1.0)
    if one.word == "speed":
        still = STILL * math.sqrt(float(np.linalg.norm(scene.gravity)) * float(scene.d.mean()))
        return 0.0, max(float(np.quantile(values, SHARE)), still)
    low, high = (float(end) for end in np.quantile(values, [0.5 - 0.5 * SHARE, 0.5 + 0.5 * SHARE]))
    if high - low > 1.0e-9 * max(abs(low), abs(high)):
        return low, high
    room = 0.05 * abs(low) or 1.0  # all alike: the middle of a scale around them
    return low - room, high + room
