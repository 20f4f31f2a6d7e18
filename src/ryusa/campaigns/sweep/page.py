"""The page of a sweep, and its numbers as JSON."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ryusa.campaigns.sweep.carry import CSV, LEDGER, LOG, PAGE, Sweep
from ryusa.campaigns.sweep.folder import FORMAT, RUNS
from ryusa.campaigns.sweep.pictures import Quantity, pooled_cells, printed_unit
from ryusa.results import schema
from ryusa.running.disk import write_atomically
from ryusa.running.folder import write_json
from ryusa.study.html import embedded, is_wide, template, write_log
from ryusa.study.origin import origin

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
    write_log(sweep.folder / LOG, sweep.traces)
    write_atomically(sweep.folder / PAGE, render(sweep, ledger, command).encode())
    return tuple(sweep.folder / name for name in (PAGE, CSV, LEDGER))


def _ledger(sweep: Sweep) -> dict[str, Any]:
    plan = sweep.plan
    return {
        "format": FORMAT,
        "case": plan.case.name,
        "design": plan.design.kind,
        "settings": [dict(one) for one in plan.design.settings],
        "set": dict(plan.overrides),
        "seeds": list(plan.seeds),
        "measures": list(plan.measures),
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
    n, seeds = len(plan.design.settings), len(plan.seeds)
    return template(HERE / "sweep.html", printed=printed_unit).render(
        ledger=ledger,
        made=ledger["provenance"],
        command=command,
        title=f"{plan.case.stem}: {', '.join(plan.design.keys) or 'several seeds'}",
        design=DESIGNS[plan.design.kind],
        plan=plan,
        csv=CSV,
        heads=[(one.key, one.unit) for one in plan.columns],
        settings=[[column.written[k] for column in plan.columns] for k in range(n)],
        quantities=quantities,
        cells=[[pooled_cells(one, k, seeds) for one in quantities] for k in range(n)],
        pictures=[
            (path.relative_to(sweep.folder).as_posix(), embedded(path), is_wide(path), name)
            for name, path in sweep.pictures.items()
        ],
        runs=[_run(sweep, k, quantities) for k in range(len(plan.runs))],
        warnings=_warnings(sweep),
        varying=any(not cell["steady"] for k in range(n) for cell in _cells(quantities, k, seeds)),
        fewer=any(0 < len(one.runs[k]) < seeds for one in quantities for k in range(n)),
    )


def _cells(quantities: list[Quantity], k: int, seeds: int) -> list[Mapping[str, object]]:
    return [pooled_cells(one, k, seeds) for one in quantities]


def _run(sweep: Sweep, k: int, quantities: list[Quantity]) -> dict[str, Any]:
    """Line of one run: its folder, its page, and its quantities with their errors."""
    one = sweep.plan.runs[k]
    found = sweep.found[one]
    place = f"{RUNS}/{one.folder}"
    page = f"{place}/{schema.REPORT}"
    held = {(name, each.name): each for name, every in found.averages.items() for each in every}
    cells: list[dict[str, Any]] = []
    for each in quantities:
        mine = held.get((each.measure, each.name))
        if mine is None:
            cells.append({"text": "–", "steady": True, "verdict": ""})
            continue
        text = f"{mine.value:.4g} ± {mine.error_text}" if mine.n > 1 else f"{mine.value:.4g}"
        cells.append({"text": text, "steady": not mine.changes, "verdict": mine.verdict})
    return {
        "setting": one.setting + 1,
        "label": one.label,
        "page": page if (sweep.folder / page).is_file() else "",
        "folder": place,
        "cells": cells,
        "problems": [
            reason if what == "run" else f"{what}: {reason}" for what, reason in found.problems.items()
        ],
    }


def _warnings(sweep: Sweep) -> list[tuple[str, str]]:
    """Warnings of the cases with their settings, and of the physics with their runs."""
    n = len(sweep.plan.design.settings)
    found = [
        (text, "all settings" if len(which) == n else f"setting {', '.join(str(one) for one in which)}")
        for text, which in sweep.plan.warnings.items()
    ]
    found += [sweep.unmoved] if sweep.unmoved else []
    by_text: dict[str, list[str]] = {}
    for run, held in sweep.found.items():
        for text in held.warnings:
            by_text.setdefault(text, []).append(run.label)
    return [*found, *((text, "; ".join(labels)) for text, labels in by_text.items())]
