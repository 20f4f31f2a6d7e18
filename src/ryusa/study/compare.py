"""Ours beside a reference: errors as numbers, curves on curves, one finding."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.figures.comparison import Axis, Curve
from ryusa.study.interval import exact
from ryusa.study.judge import Band, Finding, ReferenceChart, Source, Trial


def misfit(name: str, value: float, unit: str = "-", tolerance: Band | None = None) -> Trial:
    """Give one number that says how far ours is from a reference; without a tolerance it decides nothing.

    Parameters
    ----------
    name : of the number, such as "largest relative difference".
    value : the number; one that is not finite lies outside every tolerance.
    unit : of the number.
    tolerance : what is asked of it, with the reason.

    >>> misfit("largest difference", 0.01, "m/s", Band(0.0, 0.02, "m/s", "half a cell")).holds
    True
    """
    if tolerance is None:
        return Trial(name, {}, exact(value, unit), None)
    outside = None if math.isfinite(value) else False
    return Trial(name, {}, exact(value, unit), replace(tolerance, unit=unit), outside)


def comparison(
    id: str,
    title: str,
    source: Source,
    x: Axis,
    y: Axis,
    ours: Sequence[Curve],
    references: Sequence[Curve],
    errors: Sequence[Trial],
    settings: Mapping[str, str] | None = None,
    said: str = "",
    beside: Sequence[Curve] = (),
) -> Finding:
    """Give the finding of a comparison with one reference.

    Parameters
    ----------
    id : short, of lower-case words and hyphens; unique within its part.
    title : what is compared.
    source : of the reference.
    x, y : axes of the chart.
    ours, references : curves that the errors compare; a reference named as one of ours belongs to it.
    errors : numbers (`misfit`), the most telling first.
    settings : what ours was made with, in words.
    said : what decides it, in one or two sentences; where it misses, why.
    beside : further curves, shown and not compared.
    """
    chart = ReferenceChart(x, y, ours, references, beside)
    return Finding(id, tuple(errors), said, settings or {}, title=title, source=source, chart=chart)


def relative(ours: Any, reference: Any) -> float:
    """Largest difference over the largest reference [-]; nan where there is none.

    >>> relative([1.0, 2.2], [1.0, 2.0])
    0.1
    """
    a, b = np.asarray(ours, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    return round(float(np.abs(a - b).max() / np.abs(b).max()), 15) if a.size and np.any(b) else math.nan
