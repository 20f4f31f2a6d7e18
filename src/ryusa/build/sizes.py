"""Random grain sizes."""

import math

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.grains import CUT, spread_of
from ryusa.model.scene import Floats


def draw(case: Case, n: int, rng: np.random.Generator) -> Floats:
    """Diameters [m] of n grains, distributed as `grains.spread`."""
    d, (kind, ratio) = case.grains.diameter, spread_of(case.grains)
    if ratio == 0.0:
        return np.full(n, d)
    if kind == "uniform":
        return np.asarray(d * rng.uniform(1.0 - ratio, 1.0 + ratio, n))
    deviates = rng.standard_normal(n)
    while np.any(outside := np.abs(deviates) > CUT):
        deviates[outside] = rng.standard_normal(int(outside.sum()))
    if kind == "normal":
        return np.asarray(d * np.maximum(1.0 + ratio * deviates, 0.05))
    width = math.sqrt(math.log1p(ratio * ratio))
    return np.asarray(d * np.exp(width * deviates - 0.5 * width * width))
