"""The page of a calibration, its CSV tables, and its numbers as JSON."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ryusa.campaigns.calibrate.execution import FORMAT, Calibration, Predicted
from ryusa.campaigns.calibrate.pictures import PARTS, drawn_calibration
from ryusa.campaigns.calibrate.printed import (
    correlation_table,
    coverage_tables,
    emulators_table,
    observations_table,
    parameters_table,
    quantities_table,
)
from ryusa.campaigns.calibrate.runs import RUNS
from ryusa.figures.style import save_both
from ryusa.measure import write_csv
from ryusa.running.folder import write_json
from ryusa.study.html import shown_pictures, template, write_page
from ryusa.study.origin import counted, origin

HERE = Path(__file__).parent
PAGE, LEDGER, LOG = "calibration.html", "calibration.json", "calibration-errors.log"
PARAMETERS, OBSERVATIONS, TABLE = "parameters.csv", "observations.csv", "runs.csv"
COVERAGE, VERDICTS = "coverage.csv", "coverage-verdicts.csv"
PICTURES = "pictures"


def write_calibration(made: Calibration, command: str) -> tuple[Path, ...]:
    """Write tables, pictures, page and JSON of a calibration; each file appears complete or not at all.

    Parameters
    ----------
    made : the calibration.
    command : command that makes it, for the page.

    Raises
    ------
    OSError : a file cannot be written.
    """
    folder = made.folder
    write_csv(folder / PARAMETERS, made.rows)
    write_csv(folder / OBSERVATIONS, made.observation_rows)
    write_csv(folder / TABLE, _runs(made))
    if made.coverage is not None:
        write_csv(folder / COVERAGE, made.coverage.rows(_keys(made)))
        write_csv(folder / VERDICTS, made.coverage.verdict_rows())
    for name in PARTS:  # one of an earlier verdict would contradict this one
        for kind in ("svg", "png"):
            (folder / PICTURES / f"{name}.{kind}").unlink(missing_ok=True)
    pictures = {
        name: save_both(figure, folder / PICTURES / name) for name, figure in drawn_calibration(made).items()
    }
    ledger = _ledger(made)
    write_json(folder / LEDGER, ledger)
    write_page(folder / PAGE, _render(made, ledger, command, pictures), made.runs.traces)
    return tuple(folder / name for name in (PAGE, PARAMETERS, OBSERVATIONS, TABLE, LEDGER))


def _keys(made: Calibration) -> tuple[str, ...]:
    return tuple(one.key for one in made.asked.priors)


def _runs(made: Calibration) -> list[dict[str, object]]:
    """A line for every run: its parameters in the units of the study, and what it gave in SI."""
    rows: list[dict[str, object]] = []
    for run in made.training:
        varied = dict(run.varied)
        row: dict[str, object] = {"case": run.case, "seed": run.seed}
        row |= {key: varied[key] for key in _keys(made)}
        for one in made.predicted:
            mine = one.target.case.stem == run.case
            name = f"{one.target.words} [{one.unit}]"
            row[name] = made.runs.value(one.target, run) if mine else None
        rows.append({**row, "folder": f"{RUNS}/{run.folder}"})
    return rows


def _ledger(made: Calibration) -> dict[str, Any]:
    runs = made.runs
    counts = {  # a run that several calls opened counts once
        **counted(runs.results, runs.where.jobs), "runs_opened": len(runs.found) - runs.results.n_run,
    }  # fmt: skip
    coverage = made.coverage
    return {
        "format": FORMAT,
        "verdict": made.words[0],
        "reached": made.verdict.reached,
        "remarks": made.words[1:],
        "observations": made.observation_rows,
        "parameters": made.rows,
        "correlation": made.posterior.correlation().tolist() if made.verdict.has_intervals else None,
        "worth": made.posterior.worth,
        "quantities": [_plain(one) for one in made.predicted],
        "coverage": None if coverage is None else coverage.rows(_keys(made)),
        "coverage_of_verdicts": None if coverage is None else coverage.verdict_rows(),
        "lost": [] if coverage is None else list(coverage.lost),
        "problems": runs.problems,
        "log": LOG if runs.traces else "",
        "provenance": origin(counts),
    }


def _plain(one: Predicted) -> dict[str, Any]:
    numbers = {
        "mean": one.mean, "standard_deviation": one.sd, "run_standard_deviation": one.run_sd,
        "low_95": one.low, "high_95": one.high, "prior_mean": one.prior_mean,
        "prior_standard_deviation": one.prior_sd,
    }  # fmt: skip
    return {
        "quantity": one.target.words,
        "unit": one.unit,
        **{name: None if math.isnan(number) else number for name, number in numbers.items()},
        "observed": None if one.observed is None else one.observed[0],
        "error": None if one.observed is None else one.observed[1],
    }


def _render(made: Calibration, ledger: Mapping[str, Any], command: str, pictures: Mapping[str, Path]) -> str:
    covered = () if made.coverage is None else coverage_tables(made.coverage, _keys(made))
    return template(HERE / "calibration.html").render(
        ledger=ledger,
        command=command,
        title=f"Calibration {made.asked.name}",
        asked=made.asked,
        words=made.words,
        verdict=made.verdict,
        observations=observations_table(made),
        parameters=parameters_table(made),
        correlation=correlation_table(made),
        quantities=quantities_table(made),
        coverage=covered,
        emulators=emulators_table(made),
        pictures=shown_pictures(pictures, made.folder),
        parameters_csv=PARAMETERS,
        observations_csv=OBSERVATIONS,
        runs_csv=TABLE,
    )
