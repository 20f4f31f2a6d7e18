"""Findings of a study without judgement: the mean of every number over the seeds, by setting."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from ryusa.errors import ResultsError
from ryusa.figures.comparison import Axis, Curve
from ryusa.study.interval import over_seeds, pool
from ryusa.study.judge import Finding, ReferenceChart, Trial
from ryusa.study.task import CaseRun

SEED = "seed"
_UNIT = re.compile(r"^(?P<name>.*?)\s*\[(?P<unit>[^\]]+)\]$")
Setting = tuple[tuple[str, str], ...]


def means(found: Mapping[CaseRun, Mapping[str, float]], title: str) -> list[Finding]:
    """One finding per number: its mean over seeds with the 95 % interval, for every setting.

    Parameters
    ----------
    found : numbers by name for each run. A name may end in a unit: "hop length [m]".
    title : title of the study, for its page.

    Notes
    -----
    These numbers are shown, not judged. The spread between seeds is pooled over the settings.

    Raises
    ------
    ResultsError : `measure` did not return numbers by name.
    """
    rows = [(task, _checked(task, numbers)) for task, numbers in found.items()]
    names = list(dict.fromkeys(name for _, numbers in rows for name in numbers))
    varied = _varied([task for task, _ in rows])
    findings: list[Finding] = []
    for name in names:
        groups: dict[Setting, list[float]] = {}
        for task, numbers in rows:
            if name in numbers:
                groups.setdefault(_setting(task, varied), []).append(numbers[name])
        label, unit = _split(name)
        spread = pool(list(groups.values()))
        trials = tuple(
            Trial(label, dict(setting), over_seeds(values, unit, spread), None)
            for setting, values in groups.items()
        )
        findings.append(
            Finding(
                re.sub(r"[^a-z0-9]+", "-", label.lower()).strip("-"), trials,
                settings=_fixed([task for task, _ in rows], varied), title=f"{title}: {label}",
                chart=_chart(label, unit, trials),
            )
        )  # fmt: skip
    return findings


def rows_of(found: Mapping[CaseRun, Mapping[str, float]]) -> list[dict[str, object]]:
    """One line per run: changes of its case, and the numbers measured."""
    return [{"case": task.case, **dict(task.overrides), **numbers} for task, numbers in found.items()]


def _checked(task: CaseRun, numbers: object) -> dict[str, float]:
    if not isinstance(numbers, Mapping) or not all(
        isinstance(name, str) and isinstance(value, int | float | np.floating | np.integer)
        for name, value in numbers.items()
    ):
        raise ResultsError(
            f"{task.label}: measure gave {type(numbers).__name__} {numbers!r}. A study without `judge` needs "
            "numbers by name, such as {'hop length [m]': 0.012}"
        )
    return {name: float(value) for name, value in numbers.items()}


def _split(name: str) -> tuple[str, str]:
    """Name and unit of a number.

    >>> _split("hop length [m]"), _split("number of hops")
    (('hop length', 'm'), ('number of hops', '-'))
    """
    found = _UNIT.match(name)
    return (found["name"], found["unit"]) if found else (name, "-")


def _keys(task: CaseRun) -> dict[str, str]:
    return {"case": task.case, **{key: value for key, value in task.overrides if key != SEED}}


def _varied(tasks: Sequence[CaseRun]) -> list[str]:
    """Case keys whose values differ between the runs."""
    keys = list(dict.fromkeys(key for task in tasks for key in _keys(task)))
    return [key for key in keys if len({_keys(task).get(key) for task in tasks}) > 1]


def _setting(task: CaseRun, varied: Sequence[str]) -> Setting:
    return tuple((key, _keys(task).get(key, "as in the case file")) for key in varied)


def _fixed(tasks: Sequence[CaseRun], varied: Sequence[str]) -> dict[str, str]:
    return {key: value for key, value in (_keys(tasks[0]) if tasks else {}).items() if key not in varied}


def _chart(label: str, unit: str, trials: Sequence[Trial]) -> ReferenceChart | None:
    """Mean and interval over the varied key, if there is only one and its values are numbers in one unit."""
    keys = list(trials[0].choices) if trials else []
    if len(keys) != 1 or len(trials) < 2:
        return None
    values = [one.choices[keys[0]].split(maxsplit=1) for one in trials]
    try:
        x = np.array([float(value[0]) for value in values])
    except ValueError:
        return None
    units = {value[1] if len(value) > 1 else "-" for value in values}
    if len(units) > 1:
        return None
    order = np.argsort(x)
    mean, low, high = (
        np.array([getattr(one.found, end) for one in trials])[order] for end in ("value", "low", "high")
    )
    ends = [Curve("95 % interval", x[order], low), Curve("", x[order], high)]
    axis = Axis(keys[0], units.pop())
    return ReferenceChart(axis, Axis(label, unit), [Curve("mean over seeds", x[order], mean)], [], ends)
