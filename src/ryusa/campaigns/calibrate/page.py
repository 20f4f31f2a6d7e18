"""The page of a calibration, its tables, and its numbers as JSON."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ryusa.campaigns.calibrate.asked import Observation
from ryusa.campaigns.calibrate.carry import FORMAT, Calibration, Predicted
from ryusa.campaigns.calibrate.pictures import PARTS, drawn_calibration
from ryusa.campaigns.calibrate.runs import RUNS
from ryusa.campaigns.calibrate.sentences import move_words, shown
from ryusa.campaigns.calibrate.tables import printed_interval, printed_number
from ryusa.campaigns.calibrate.verdict import ComparedObservation
from ryusa.campaigns.sweep.pictures import printed_unit
from ryusa.figures import save
from ryusa.measure import write_csv
from ryusa.running.disk import write_atomically
from ryusa.running.folder import write_json
from ryusa.study.html import embedded, is_wide, template, write_log
from ryusa.study.origin import origin

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
    pictures: dict[str, Path] = {}
    for name in PARTS:  # one of an earlier verdict would contradict this one
        for kind in ("svg", "png"):
            (folder / PICTURES / f"{name}.{kind}").unlink(missing_ok=True)
    for name, figure in drawn_calibration(made).items():
        save(figure, folder / PICTURES / f"{name}.svg")
        pictures[name] = save(figure, folder / PICTURES / f"{name}.png")
    write_log(folder / LOG, made.runs.traces)
    ledger = _ledger(made)
    write_json(folder / LEDGER, ledger)
    write_atomically(folder / PAGE, _render(made, ledger, command, pictures).encode())
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
    counts = {
        "runs_made": sum(one.n_run for one in made.runs.counts),
        "runs_opened": len(made.runs.found) - sum(one.n_run for one in made.runs.counts),
        "wall_s": round(sum(one.seconds for one in made.runs.counts), 1),
        "jobs": made.runs.where.jobs,
    }
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
        "problems": made.runs.problems,
        "log": LOG if made.runs.traces else "",
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
    correlation = made.posterior.correlation()
    return template(HERE / "calibration.html", printed=printed_unit).render(
        ledger=ledger,
        made=ledger["provenance"],
        command=command,
        asked=made.asked,
        words=made.words,
        rows=[_row(one) for one in made.rows],
        verdict=made.verdict,
        keys=_keys(made),
        correlation=[[f"{value:+.2f}" for value in row] for row in correlation],
        observations=[
            _compared(made, *one)
            for one in zip(made.asked.observations, made.verdict.compared, made.observed_units, strict=True)
        ],
        quantities=[_shown(one) for one in made.predicted],
        emulators=[_quality(made, one) for one in made.predicted],
        pictures=[
            (name, path.relative_to(made.folder).as_posix(), embedded(path), is_wide(path))
            for name, path in pictures.items()
        ],
        parameters_csv=PARAMETERS,
        observations_csv=OBSERVATIONS,
        runs_csv=TABLE,
    )


def _row(row: Mapping[str, object]) -> dict[str, object]:
    """A parameter in the digits of the page."""
    return {
        **row,
        "unit": "" if row["unit"] == "-" else row["unit"],
        "mean": printed_number(row["mean"], 4),
        "sd": printed_number(row["standard_deviation"], 2),
        "interval_68": printed_interval(row["low_68"], row["high_68"]),
        "interval_95": printed_interval(row["low_95"], row["high_95"]),
        "over_prior": printed_number(row["over_prior"], 2),
    }


def _compared(made: Calibration, asked: Observation, one: ComparedObservation, unit: str) -> dict[str, Any]:
    """An observation beside the model, in the unit of the page."""
    unit, factor = shown(unit)
    error = f"{factor * one.value:.4g} ± {factor * one.error:.2g}"
    return {
        "words": asked.words,
        "unit": unit,
        "observed": f"{error} ± {factor * one.discrepancy:.2g}" if one.discrepancy else error,
        "posterior": printed_number(one.predicted, 4, factor),
        "runs": printed_interval(one.least, one.most, factor),
        "misfit": f"{one.misfit:+.1f}",
        "reached": one.reached,
        "move": move_words(one.move, made.asked.priors),
    }


def _shown(one: Predicted) -> dict[str, Any]:
    """A quantity in the unit of the page."""
    unit, factor = shown(one.unit)
    return {
        "words": one.target.words,
        "unit": unit,
        "seen": one.observed is not None,
        "posterior": printed_number(one.mean, 4, factor),
        "sd": printed_number(one.sd, 2, factor),
        "interval": printed_interval(one.low, one.high, factor),
        "run": printed_number(one.run_sd, 2, factor),
        "prior": f"{factor * one.prior_mean:.4g} ± {factor * one.prior_sd:.2g}",
    }


def _quality(made: Calibration, one: Predicted) -> dict[str, Any]:
    """How well the emulator of a quantity predicts runs that are left out."""
    emulator = made.emulators[one.target]
    away, sd = emulator.left_out()
    unit, factor = shown(one.unit)
    inside = float((abs(away) <= sd).mean())
    return {
        "words": one.target.words,
        "unit": unit,
        "noise": f"{factor * emulator.noise:.2g}",
        "missed": f"{factor * math.sqrt((away**2).mean()):.2g}",
        "scatter": f"{factor * emulator.scale:.2g}",
        "inside": f"{100 * inside:.0f} %",
        "runs": len(away),
    }
