"""The page of a calibration, its tables, and its numbers as JSON."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.figures import save
from ryusa.measure import write_csv
from ryusa.running.disk import write_atomically
from ryusa.running.folder import write_json
from ryusa.studies.calibrate.carry import FORMAT, UNDETERMINED, Calibration, Predicted
from ryusa.studies.calibrate.pictures import drawn_calibration, shown
from ryusa.studies.calibrate.runs import RUNS
from ryusa.studies.sweep.pictures import printed_unit
from ryusa.study.html import embedded, is_wide, template, write_log
from ryusa.study.origin import origin

HERE = Path(__file__).parent
PAGE, LEDGER, LOG = "calibration.html", "calibration.json", "calibration-errors.log"
PARAMETERS, TABLE, COVERAGE = "parameters.csv", "runs.csv", "coverage.csv"
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
    write_csv(folder / TABLE, _runs(made))
    if made.coverage is not None:
        write_csv(folder / COVERAGE, made.coverage.rows(_keys(made)))
    pictures: dict[str, Path] = {}
    for name, figure in drawn_calibration(made).items():
        save(figure, folder / PICTURES / f"{name}.svg")
        pictures[name] = save(figure, folder / PICTURES / f"{name}.png")
    write_log(folder / LOG, made.runs.traces)
    ledger = _ledger(made)
    write_json(folder / LEDGER, ledger)
    write_atomically(folder / PAGE, _render(made, ledger, command, pictures).encode())
    return tuple(folder / name for name in (PAGE, PARAMETERS, TABLE, LEDGER))


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
    counts = {
        "runs_made": sum(one.n_run for one in made.runs.counts),
        "runs_opened": len(made.runs.found) - sum(one.n_run for one in made.runs.counts),
        "wall_s": round(sum(one.seconds for one in made.runs.counts), 1),
        "jobs": made.runs.where.jobs,
    }
    coverage = made.coverage
    return {
        "format": FORMAT,
        "parameters": made.rows,
        "correlation": made.posterior.correlation().tolist(),
        "worth": made.posterior.worth,
        "quantities": [_plain(one) for one in made.predicted],
        "coverage": None if coverage is None else coverage.rows(_keys(made)),
        "lost": [] if coverage is None else list(coverage.lost),
        "problems": made.runs.problems,
        "log": LOG if made.runs.traces else "",
        "provenance": origin(counts),
    }


def _plain(one: Predicted) -> dict[str, Any]:
    return {
        "quantity": one.target.words, "unit": one.unit, "mean": one.mean, "standard_deviation": one.sd,
        "run_standard_deviation": one.run_sd, "low_95": one.low, "high_95": one.high,
        "prior_mean": one.prior_mean, "prior_standard_deviation": one.prior_sd,
        "observed": None if one.observed is None else one.observed[0],
        "error": None if one.observed is None else one.observed[1],
    }  # fmt: skip


def _render(made: Calibration, ledger: Mapping[str, Any], command: str, pictures: Mapping[str, Path]) -> str:
    correlation = made.posterior.correlation()
    return template(HERE / "calibration.html", printed=printed_unit).render(
        ledger=ledger,
        made=ledger["provenance"],
        command=command,
        asked=made.asked,
        rows=made.rows,
        undetermined=UNDETERMINED,
        keys=_keys(made),
        correlation=[[f"{value:+.2f}" for value in row] for row in correlation],
        quantities=[_shown(one) for one in made.predicted],
        emulators=[_quality(made, one) for one in made.predicted],
        pictures=[
            (name, path.relative_to(made.folder).as_posix(), embedded(path), is_wide(path))
            for name, path in pictures.items()
        ],
        parameters_csv=PARAMETERS,
        runs_csv=TABLE,
    )


def _shown(one: Predicted) -> dict[str, Any]:
    """A quantity in the unit of the page."""
    unit, factor = shown(one.unit)
    seen = "" if one.observed is None else f"{factor * one.observed[0]:.4g} ± {factor * one.observed[1]:.2g}"
    return {
        "words": one.target.words,
        "unit": unit,
        "observed": seen,
        "posterior": f"{factor * one.mean:.4g} ± {factor * one.sd:.2g}",
        "interval": f"{factor * one.low:.4g} to {factor * one.high:.4g}",
        "run": f"{factor * one.run_sd:.2g}",
        "prior": f"{factor * one.prior_mean:.4g} ± {factor * one.prior_sd:.2g}",
        "away": "" if np.isnan(one.away) else f"{one.away:+.1f}",
        "far": abs(one.away) > 2.0 if not np.isnan(one.away) else False,
    }


def _quality(made: Calibration, one: Predicted) -> dict[str, Any]:
    """How well the emulator of a quantity predicts runs that are left out."""
    emulator = made.emulators[one.target]
    away, sd = emulator.left_out()
    unit, factor = shown(one.unit)
    inside = float(np.mean(np.abs(away) <= sd))
    return {
        "words": one.target.words,
        "unit": unit,
        "noise": f"{factor * emulator.noise:.2g}",
        "missed": f"{factor * float(np.sqrt(np.mean(away**2))):.2g}",
        "scatter": f"{factor * emulator.scale:.2g}",
        "inside": f"{100 * inside:.0f} %",
        "runs": len(away),
    }
