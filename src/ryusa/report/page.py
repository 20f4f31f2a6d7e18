"""The page of `ryusa report`: one run, or several side by side."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ryusa.errors import ResultsError
from ryusa.report.contents import RunContents, contents_of
from ryusa.results import Results
from ryusa.study.html import template
from ryusa.version import __version__
from ryusa.view.page import component

HERE = Path(__file__).parent


def report_page(
    runs: Sequence[Results], *, size: float, progress: Callable[[float], None] = lambda share: None
) -> str:
    """Write the page about some runs.

    Parameters
    ----------
    runs : one or more, in the order of the page.
    size : largest size of the grains in motion, of all runs together [B].
    progress : called with the share that is done.

    Raises
    ------
    ResultsError : no run is given.
    """
    if not runs:
        raise ResultsError("a report needs a run folder")
    share = 1.0 / len(runs)
    found = [
        contents_of(one, size=size * share, progress=lambda part, k=k: progress((k + part) * share))
        for k, one in enumerate(runs)
    ]
    viewers = [one.viewer for one in found if one.viewer is not None]
    numbers = iter(range(len(viewers)))
    return template(HERE / "report.html").render(
        runs=found,
        viewers=[next(numbers) if one.viewer is not None else None for one in found],
        differences=differing(found),
        averages=side_by_side(found),
        parts=component(viewers),
        version=__version__,
    )


def differing(runs: Sequence[RunContents]) -> list[tuple[str, list[str]]]:
    """Values of the cases that are not the same in all runs: name, and what each run has."""
    tables = [{f"{one.section}: {one.name}": one.shown for one in run.values} for run in runs]
    names = dict.fromkeys(name for table in tables for name in table)
    rows = [(name, [table.get(name, "–") for table in tables]) for name in names]
    return [(name, values) for name, values in rows if len(set(values)) > 1]


def side_by_side(runs: Sequence[RunContents]) -> list[tuple[str, str, list[dict[str, Any]]]]:
    """Averages that several runs have: name, unit, and the value of each run with its error."""
    if len(runs) < 2:
        return []
    names = dict.fromkeys(name for run in runs for name in run.averages)
    found: list[tuple[str, str, list[dict[str, Any]]]] = []
    for name in names:
        held = [run.averages.get(name) for run in runs]
        unit = next(one.unit for one in held if one is not None)
        found.append((name, unit, [_cell(one) for one in held]))
    return found


def _cell(one: Any) -> dict[str, Any]:
    if one is None:
        return {"text": "–", "steady": True}
    return {"text": f"{one.value:.4g} ± {one.error_text}", "steady": not one.changes}
