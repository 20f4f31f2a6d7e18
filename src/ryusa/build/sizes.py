"""Random grain sizes, and sizes by quota of a sieve curve."""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ryusa.casefile.case import Case
from ryusa.casefile.grading import grading_of, reference_diameter
from ryusa.casefile.grains.schema import spread_of
from ryusa.casefile.grains.values import CUT, has_own_sizes, sized_as
from ryusa.model.scene import Floats

_STREAM = 0x4D415445  # tells the materials of grains from their sizes


def laid_materials(mixture: Mapping[str, float], seed: int, n: int) -> list[tuple[str, NDArray[np.int64]]]:
    """Which of the n grains that the builder lays are of each material of `grains.mixture`."""
    drawn = np.random.default_rng([seed, _STREAM]).permutation(n)
    found: list[tuple[str, NDArray[np.int64]]] = []
    begin = 0.0
    for name, share in mixture.items():
        end = begin + share * n
        found.append((name, drawn[round(begin) : round(end)]))
        begin = end
    return found


def draw_laid(case: Case, n: int, rng: np.random.Generator) -> Floats:
    """Diameters [m] of the n grains that the builder lays, each by its material."""
    if not any(has_own_sizes(case.materials, name) for name in case.grains.mixture):
        return draw(case, n, rng)
    d, rest = np.zeros(n), np.ones(n, np.bool_)
    for name, which in laid_materials(case.grains.mixture, case.seed, n):
        d[which], rest[which] = draw(sized_as(case, name), len(which), rng), False
    d[rest] = draw(case, int(rest.sum()), rng)
    return d


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
