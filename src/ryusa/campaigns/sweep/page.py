"""The page of a sweep, and its numbers as JSON."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from markupsafe import Markup, escape

from ryusa.campaigns.sweep.execution import CSV, LEDGER, LOG, PAGE, Sweep
from ryusa.campaigns.sweep.folder import RUNS, plain_plan
from ryusa.campaigns.sweep.pictures import Quantity, printed_unit
from ryusa.measure.statistics import Average
from ryusa.results import schema
from ryusa.running.folder import write_json
from ryusa.study.html import shown_pictures, template, write_page
from ryusa.study.origin import origin
from ryusa.study.printed_table import PrintedCell, PrintedTable

HERE = Path(__file__).parent
DESIGNS = {
    "grid": "every combination",
    "list": "a list of settings",
    "latin hypercube": "a Latin hypercube",
    "sobol": "a scrambled Sobol sequence",
}


def write_sweep(sweep: Sweep, command: str) -> tuple[Path, ...]:
    """Write page and JSON of a sweep; the table is there already. Each file appears complete or not at all.

    Parameters
    ----------
    sweep : the sweep.
    command : command that makes it, for the page.

    Raises
    ------
    OSError : a file cannot be written.
    """
    ledger = _ledger(sweep)
    write_json(sweep.folder / LEDGER, ledger)
    write_page(sweep.folder / PAGE, render(sweep, ledger, command), sweep.traces)
    return tuple(sweep.folder / name for name in (PAGE, CSV, LEDGER))


def _ledger(sweep: Sweep) -> dict[str, Any]:
    return {
        **plain_plan(sweep.plan),
        "rows": [dict(one) for one in sweep.rows],
        "problems": dict(sweep.problems),
        "faults": dict(sweep.faults),
        "log": LOG if sweep.traces else "",
        "provenance": origin(sweep.counts),
    }


def render(sweep: Sweep, ledger: Mapping[str, Any], command: str) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    sweep : the sweep.
    ledger : its numbers as in the JSON file.
    command : command that makes it.
    """
    plan = sweep.plan
    quantities = sweep.quantities
    settings = range(len(plan.design.settings))
    numbers = tuple(str(k + 1) for k in settings)
    return template(HERE / "sweep.html").render(
        ledger=ledger,
        command=command,
        title=f"Sweep of {plan.case.stem}: {', '.join(plan.design.keys) or 'several seeds'}",
        design=DESIGNS[plan.design.kind],
        plan=plan,
        csv=CSV,
        means=_means(sweep, quantities),
        runs=_runs(sweep, quantities),
        explained=PrintedTable(
            ("value", *numbers), [(name, *held) for name, held in plan.explained], frozenset({"value"})
        ),
        pictures=shown_pictures(sweep.pictures, sweep.folder),
        warnings=_warnings(sweep),
        varying=any(mean is not None and mean.changes for one in quantities for mean in one.pooled),
        fewer=any(0 < len(one.runs[k]) < len(plan.seeds) for one in quantities for k in settings),
    )


def _means(sweep: Sweep, quantities: Sequence[Quantity]) -> PrintedTable:
    """A line for each setting: what varies, and every quantity pooled over the seeds."""
    columns, seeds = sweep.plan.columns, len(sweep.plan.seeds)
    heads = ("no.", *(one.key for one in columns), *map(_head, quantities))
    return PrintedTable(
        heads,
        [
            (str(k + 1), *(one.written[k] for one in columns), *(_mean(one, k, seeds) for one in quantities))
            for k in range(len(sweep.plan.design.settings))
        ],
    )


def _head(one: Quantity) -> str:
    return f"{one.measure}\n{one.name}\n({printed_unit(one.unit)})"


def _mean(one: Quantity, k: int, seeds: int) -> PrintedCell:
    """Mean and error of one setting; the number of runs where some lack the number."""
    mean, n = one.pooled[k], len(one.runs[k])
    if mean is None:
        return PrintedCell("–")
    cell = _of_average(mean, f"{mean.value:.4g} ± {mean.error_text.rstrip('*')}")
    return cell._replace(text=f"{cell.text} ({n} of {seeds})") if 0 < n < seeds else cell


def _of_average(one: Average, text: str) -> PrintedCell:
    tip = f"steady: {one.verdict}" if one.verdict else ""
    return PrintedCell(f"{text} †", "partly", tip) if one.changes else PrintedCell(text, tip=tip)


def _runs(sweep: Sweep, quantities: Sequence[Quantity]) -> PrintedTable:
    """A line for each run: its page, why it has no numbers, and its quantities with their errors."""
    rows: list[Sequence[str | PrintedCell]] = []
    for one in sweep.plan.runs:
        found = sweep.found[one]
        page = f"{RUNS}/{one.folder}/{schema.REPORT}"
        label = Markup('<a href="{}">{}</a>').format(quote(page), one.label)
        name = label if (sweep.folder / page).is_file() else escape(one.label)
        for what, reason in found.problems.items():
            why = reason if what == "run" else f"{what}: {reason}"
            name += Markup('<br><small class="no reason">{}</small>').format(why)
        held = {(measure, each.name): each for measure, every in found.averages.items() for each in every}
        cells = [_of_run(held.get((each.measure, each.name))) for each in quantities]
        rows.append((str(one.setting + 1), PrintedCell(name, "id"), *cells))
    return PrintedTable(("no.", "run", *map(_head, quantities)), rows, frozenset({"run"}))


def _of_run(one: Average | None) -> PrintedCell:
    if one is None:
        return PrintedCell("–")
    return _of_average(one, f"{one.value:.4g} ± {one.error_text}" if one.n > 1 else f"{one.value:.4g}")


def _warnings(sweep: Sweep) -> list[tuple[str, str]]:
    """Warnings of the cases with their settings, and of the physics with their runs."""
    found = [(text, sweep.plan.named(which)) for text, which in sweep.plan.warnings.items()]
    found += [sweep.unmoved] if sweep.unmoved else []
    by_text: dict[str, list[str]] = {}
    for run, held in sweep.found.items():
        for text in held.warnings:
            by_text.setdefault(text, []).append(run.label)
    return [*found, *((text, "; ".join(labels)) for text, labels in by_text.items())]
