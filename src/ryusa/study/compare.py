"""Comparison of results with a reference: errors, curves, and one finding."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.figures.comparison import Axis, Curve
from ryusa.study.interval import Interval, exact
from ryusa.study.judge import Band, Finding, ReferenceChart, Source, Trial


def misfit(name: str, value: float | Interval, unit: str = "-", tolerance: Band | None = None) -> Trial:
    """Return the trial for one error with respect to a reference; without a tolerance it is not judged.

    Parameters
    ----------
    name : name of the error, such as "largest relative difference".
    value : its value, or its interval over seeds; a value that is not finite lies outside every tolerance,
        an interval without a number decides nothing.
    unit : its unit.
    tolerance : permitted range, with the reason.

    >>> misfit("largest difference", 0.01, "m/s", Band(0.0, 0.02, "m/s", "half a cell")).holds
    True
    """
    if isinstance(value, Interval):
        band = None if tolerance is None else replace(tolerance, unit=value.unit)
        return Trial(name, {}, value, band, False if band and math.isinf(value.value) else None)
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
    """Return the finding of a comparison with one reference.

    Parameters
    ----------
    id : short identifier of lower-case words and hyphens, unique within its part.
    title : what is compared.
    source : source of the reference.
    x, y : axes of the chart.
    ours, references : curves that are compared; a reference is matched to our curve of the same name.
    errors : errors (`misfit`), the most important first.
    settings : settings of our runs, in words.
    said : what decides the verdict, in one or two sentences; the reason if a tolerance is missed.
    beside : further curves, shown but not compared.
    """
    chart = ReferenceChart(x, y, ours, references, beside)
    return Finding(id, tuple(errors), said, settings or {}, title=title, source=source, chart=chart)


def relative(ours: Any, reference: Any) -> float:
    """Largest difference over the largest value of the reference [-]; nan without a reference.

    >>> relative([1.0, 2.2], [1.0, 2.0])
    0.1
    """
    a, b = np.asarray(ours, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    return round(float(np.abs(a - b).max() / np.abs(b).max()), 15) if a.size and np.any(b) else math.nan
