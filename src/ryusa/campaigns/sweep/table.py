"""The table of a sweep: every quantity of every run, and pooled over the seeds of a setting."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ryusa.campaigns.sweep.design import SEED
from ryusa.campaigns.sweep.part import Measured, SweepRun
from ryusa.casefile.keys import item
from ryusa.measure.pooled import mean_of_runs
from ryusa.measure.statistics import Average
from ryusa.units import si_unit

RUN, SEEDS = "run", "seeds"  # what a row is about: one run, or all runs of a setting
UNMOVED = (
    "the seeds change nothing: runs with different seeds gave the same numbers to the last digit, so that "
    "the error between them, 0, says nothing. One seed is enough, or the case needs something random, such "
    "as grains.spread"
)
Cell = float | int | str | bool | None


@dataclass(frozen=True)
class SweepColumn:
    """A key that varies, as a column of the table.

    Attributes
    ----------
    key : key of the case.
    unit : SI unit of the values; "" for words, and numbers without one.
    values : by setting, in SI.
    written : by setting, as written.
    """

    key: str
    unit: str
    values: tuple[Cell, ...]
    written: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name of the column, with its unit.

        >>> SweepColumn("contact.stiffness", "N/m", (), ()).name
        'contact.stiffness_N_per_m'
        """
        unit = self.unit.replace("/", "_per_").replace(" ", "_")
        return f"{self.key}_{unit}" if unit else self.key


def column_of(key: str, written: Sequence[str], cases: Sequence[Mapping[str, Any]]) -> SweepColumn:
    """Column of a key.

    Parameters
    ----------
    key : key of the case, with dots.
    written : its value in every setting as written.
    cases : the case of every setting as plain data in SI.
    """
    found: list[Cell] = []
    for case in cases:
        here: Any = case
        for part in key.split("."):
            here = item(here, int(part) if part.isdecimal() and isinstance(here, (list, tuple)) else part)
        found.append(here)
    if any(isinstance(one, bool) or not isinstance(one, (int, float)) for one in found):
        return SweepColumn(key, "", tuple(written), tuple(written))
    units = {si_unit(one) for one in written}
    return SweepColumn(key, units.pop() if len(units) == 1 else "", tuple(found), tuple(written))


def pooled_over_seeds(measures: Sequence[str], runs: Sequence[Measured]) -> dict[tuple[str, str], Average]:
    """Mean of the runs of one setting by measure and quantity, with the error between them.

    Parameters
    ----------
    measures : names of the measures.
    runs : what was measured of each run; those without a quantity are left out of its mean.

    Returns
    -------
    averages : of quantities that two runs or more have; `n_series` is the number of runs.

    Notes
    -----
    Every run counts once. The error is the standard error of the mean of n runs from their scatter, widened
    by Student's t with n - 1 degrees of freedom so that it covers 68.3 % (`statistics.standard_error`).
    """
    found: dict[tuple[str, str], Average] = {}
    for measure in measures:
        every = [one.averages.get(measure, ()) for one in runs]
        names = dict.fromkeys(one.name for run in every for one in run)
        for name in names:
            column = [one for run in every for one in run if one.name == name]
            if len(column) > 1:
                found[measure, name] = mean_of_runs(column)
    return found


def unmoved_by_seeds(found: Mapping[SweepRun, Measured]) -> tuple[list[SweepRun], int]:
    """Points whose runs with different seeds all gave the same numbers, to the last digit.

    Returns
    -------
    unmoved : the first run of each such point.
    n : points with numbers of two seeds or more.
    """
    points: dict[tuple[object, ...], list[SweepRun]] = {}
    for run, held in found.items():
        if any(held.averages.values()):
            varied = tuple(one for one in run.varied if one[0] != SEED)
            points.setdefault((run.cases, run.case, varied), []).append(run)
    several = [runs for runs in points.values() if len(runs) > 1]
    same = [runs[0] for runs in several if len({_digits_of(found[one]) for one in runs}) == 1]
    return same, len(several)


def _digits_of(held: Measured) -> str:
    """All numbers of a run as text: equal where they are the same, nan included."""
    return repr([(name, [(one.name, one.value) for one in each]) for name, each in held.averages.items()])


def rows_of_sweep(
    columns: Sequence[SweepColumn],
    runs: Sequence[SweepRun],
    measures: Sequence[str],
    found: Mapping[SweepRun, Measured],
) -> list[dict[str, Cell]]:
    """Lines of the table, setting by setting: its runs, then the quantities pooled over them.

    Parameters
    ----------
    columns : keys that vary.
    runs : all runs, in the order of the table.
    measures : names of the measures, in the order of the table.
    found : what was measured of each run.
    """
    rows: list[dict[str, Cell]] = []
    settings = list(dict.fromkeys(one.setting for one in runs))
    for k in settings:
        mine = [one for one in runs if one.setting == k]
        for run in mine:
            rows += _of_run(columns, run, measures, found[run])
        pooled = pooled_over_seeds(measures, [found[one] for one in mine])
        for (measure, _), average in pooled.items():
            rows.append(
                {**_head(columns, k, SEEDS, None, measure), **_numbers(average), "problem": "", "run": ""}
            )
    return rows


def _of_run(
    columns: Sequence[SweepColumn], run: SweepRun, measures: Sequence[str], found: Measured
) -> list[dict[str, Cell]]:
    """Lines of one run; a measure that could not be had has one line with the reason."""
    rows: list[dict[str, Cell]] = []
    place = f"runs/{run.folder}"
    for measure in measures:
        head = _head(columns, run.setting, RUN, run.seed, measure)
        averages = found.averages.get(measure, ())
        for one in averages:
            rows.append({**head, **_numbers(one), "problem": "", "run": place})
        if not averages:
            problem = found.problems.get("run") or found.problems.get(measure, "")
            rows.append({**head, **dict.fromkeys(_numbers(_NOTHING)), "problem": problem, "run": place})
    return rows


def _head(
    columns: Sequence[SweepColumn], k: int, over: str, seed: int | None, measure: str
) -> dict[str, Cell]:
    varied = {one.name: one.values[k] for one in columns}
    return {"setting": k + 1, **varied, "over": over, "seed": seed, "measure": measure}


def _numbers(one: Average) -> dict[str, Cell]:
    """Cells of one quantity; numbers that do not exist are None."""
    cells: dict[str, Any] = one.row()
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value
        for name, value in cells.items()
    }


_NOTHING = Average("", "", math.nan, math.nan, 0, 0, 0.0, (math.nan, math.nan), math.nan, math.nan, math.nan)
