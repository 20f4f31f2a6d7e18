"""Averages of several runs that differ in their seed: the mean of the runs, with the error between them."""

import math
from collections.abc import Sequence
from dataclasses import replace

from ryusa.errors import ResultsError
from ryusa.measure.statistics import Average, standard_error
from ryusa.measure.table import Averages


def pooled(runs: Sequence[Averages]) -> Averages:
    """Average over runs.

    Parameters
    ----------
    runs : what one measure found in each of two or more runs.

    Returns
    -------
    averages : of every quantity that all runs have samples of: the mean of the runs, each counted once, and
        the standard error of that mean from their scatter, widened by Student's t. A quantity is steady where
        it is so in every run, its `variation` is the largest of theirs and its `drift` their mean; `n_series`
        is the number of runs.

    Raises
    ------
    ResultsError : fewer than two runs, or no quantity that all of them have.
    """
    if len(runs) < 2:
        raise ResultsError("an error between runs needs two runs or more")
    names = [one.name for one in runs[0].items]
    columns = [[_named(run, name) for run in runs] for name in names]
    items = tuple(
        mean_of_runs([one for one in column if one is not None]) for column in columns if all(column)
    )
    if not items:
        raise ResultsError("the runs have no quantity in common that all of them have samples of")
    left = [name for name, column in zip(names, columns, strict=True) if not all(column)]
    notes = [f"mean of {len(runs)} runs, with the standard error between them"]
    notes += [f"left out, since a run has no samples: {', '.join(left)}"] if left else []
    return Averages(runs[0].title, items, (*notes, *runs[0].notes))


def _named(run: Averages, name: str) -> Average | None:
    return next((one for one in run.items if one.name == name and one.n > 0), None)


def mean_of_runs(column: Sequence[Average]) -> Average:
    """Mean of one quantity over two runs or more, each counted once, with the error between them."""
    values = [one.value for one in column]
    least = max(column, key=lambda one: -math.inf if math.isnan(one.variation) else one.variation)
    begins = [one.steady_from for one in column]
    return replace(
        least,
        value=math.fsum(values) / len(values),
        error=standard_error([[value] for value in values]).error,
        n=sum(one.n for one in column),
        n_series=len(column),
        independent=min(one.independent for one in column),
        window=(min(one.window[0] for one in column), max(one.window[1] for one in column)),
        drift=math.fsum(one.drift for one in column) / len(column),
        steady_from=math.nan if any(math.isnan(one) for one in begins) else max(begins),
    )
