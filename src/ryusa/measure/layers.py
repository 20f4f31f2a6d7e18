"""Quantities over height, with the standard errors of their means over time."""

from dataclasses import dataclass

import numpy as np

from ryusa.measure._run import Floats
from ryusa.measure.statistics import standard_errors
from ryusa.printed import ByShape


@dataclass(frozen=True, repr=False)
class Layers(ByShape):
    """One quantity over height, with the standard error of its mean over time.

    Attributes
    ----------
    name, unit : what it is.
    value : one number per layer, shape (n_layer,); nan where no grain ever was.
    error : standard error from block averages over the frames, the same shape; nan for a single frame.
    """

    name: str
    unit: str
    value: Floats
    error: Floats


def layers_mean(name: str, unit: str, series: Floats) -> Layers:
    """Mean over the frames of a series, shape (n_frame, n_layer)."""
    return Layers(name, unit, series.mean(axis=0), standard_errors(series))


def layers_quotient(name: str, unit: str, above: Floats, below: Floats) -> Layers:
    """Sum over sum; to first order its error is that of the mean of above - value below over mean below."""
    with np.errstate(invalid="ignore", divide="ignore"):
        value = above.sum(axis=0) / below.sum(axis=0)
        error = standard_errors((above - value * below) / below.mean(axis=0))
    return Layers(name, unit, value, error)


def layers_variance(name: str, square: Floats, once: Floats, below: Floats) -> Layers:
    """Mean of the square less square of the mean, never below zero."""
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = once.sum(axis=0) / below.sum(axis=0)
        value = np.maximum(square.sum(axis=0) / below.sum(axis=0) - mean**2, 0.0)
        rest = square - 2.0 * mean * once + (mean**2 - value) * below
        error = standard_errors(rest / below.mean(axis=0))
    return Layers(name, "m2/s2", value, error)


def plain_unit(unit: str) -> str:
    """A unit as part of a column's name."""
    return "" if unit == "-" else unit.replace("/", "_per_").replace(" ", "_")
