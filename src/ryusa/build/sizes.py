"""Random grain sizes, and sizes by quota of a sieve curve."""

import math

import numpy as np

from ryusa.casefile.case import Case
from ryusa.casefile.grading import grading_of, reference_diameter
from ryusa.casefile.grains import CUT, spread_of
from ryusa.model.scene import Floats


def draw(case: Case, n: int, rng: np.random.Generator) -> Floats:
    """Diameters [m] of n grains, distributed as `grains.spread` or `grains.sieve_curve`.

    Those of a curve are its quotas in random order: the same sizes with every seed.
    """
    grading = grading_of(case)
    if grading is not None:
        return rng.permutation(grading.quotas(n))
    d, (kind, ratio) = reference_diameter(case), spread_of(case.grains)
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
