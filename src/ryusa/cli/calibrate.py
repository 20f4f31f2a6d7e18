"""`ryusa calibrate`: parameters from observations."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.cli.options import Quiet
from ryusa.cli.study import (
    DEFAULT,
    Again,
    Jobs,
    On,
    Show,
    console,
    executor_at,
    interrupted,
    report_failures,
)

if TYPE_CHECKING:
    from ryusa.studies.calibrate import Calibration, CalibrationAsked


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(calibrate)


def calibrate(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="TOML file with parameters and observations.")
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", metavar="FOLDER",
            help="Table, page, pictures and runs; default runs/calibration-STUDY.",
        ),
    ] = None,
    coverage: Annotated[
        int,
        typer.Option(
            "--coverage", metavar="N", min=0,
            help="Check the intervals on N made-up truths, which are run too; 5 or more.",
        ),
    ] = 0,
    on: On = DEFAULT,
    jobs: Jobs = None,
    again: Again = False,
    show: Show = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Find the parameters of cases that agree with observations, and say which are not determined.

    STUDY names parameters with their priors, observations with their errors, and
    the cases that show them. The cases are run at points that fill the priors,
    with several seeds; an emulator through these runs gives the posterior, and
    further runs are made where it needs them. The same command continues an
    interrupted calibration. Needs the extra calibrate.
    """
    from ryusa.errors import ResultsError
    from ryusa.studies.calibrate import (
        carry_out_calibration,
        read_calibration,
        refuse_truths,
        write_calibration,
    )
    from ryusa.studies.calibrate.page import LOG
    from ryusa.studies.sweep.table import UNMOVED, unmoved_by_seeds
    from ryusa.study import ProgressLines

    asked = read_calibration(study)
    refuse_truths(coverage)
    folder = Path("runs") / f"calibration-{asked.name}" if out is None else out
    where = executor_at(on, jobs)
    if show:
        _list(asked, folder, where.jobs, coverage)
        return
    words = ["ryusa", "calibrate", study.name, *(["--coverage", str(coverage)] if coverage else [])]
    try:
        made = carry_out_calibration(
            asked, folder, where, again=again, truths=coverage,
            progress=None if quiet else ProgressLines(),
        )  # fmt: skip
        files = write_calibration(made, shlex.join(words))
    except KeyboardInterrupt:
        interrupted(folder)
    except OSError as error:
        raise ResultsError(f"{folder}: cannot be written ({error.strerror or error})") from None
    _print(made)
    for path in files:
        typer.echo(f"wrote {path}")
    same, n = unmoved_by_seeds(made.runs.found)
    if same:
        typer.echo(f"warning: {len(same)} of {n} points: {UNMOVED}", err=True)
    report_failures(made.runs.problems, {}, made.runs.traces, folder / LOG)


def _list(asked: "CalibrationAsked", folder: Path, jobs: int, truths: int) -> None:
    """Parameters, quantities, and the cost of all runs."""
    from ryusa.running.folder import format_bytes
    from ryusa.studies.calibrate.design import filling_points
    from ryusa.studies.calibrate.runs import RUNS, CaseRuns
    from ryusa.study import duration
    from ryusa.study.cost import by_cores
    from ryusa.study.executors import executor_of

    for prior in asked.priors:
        typer.echo(f"{prior.key}: {prior.words}")
    for one in asked.observations:
        typer.echo(f"observed: {one.target.words} {one.value} ± {one.error}")
    for target in asked.predictions:
        typer.echo(f"predicted: {target.words}")
    runs = CaseRuns(asked, folder, executor_of("processes", 1))
    first = filling_points(len(asked.priors), asked.points, asked.design_seed)
    plans = runs.plans(first, tuple(range(1, asked.seeds + 1)))
    n = asked.seeds * (asked.points + asked.rounds * asked.more + truths)
    cost = longest = disk = 0.0
    for case, plan in plans.items():
        costs = [one.cost() for one in plan.first_runs]
        each = sum(costs) / len(costs)
        typer.echo(f"{case.name}: {n} runs of {duration(each)} on average")
        cost, longest = cost + n * each, max(longest, *costs)
        disk += n * sum(one.disk() for one in plan.first_runs) / len(costs)
    total = n * len(plans)
    at_once = "one at a time" if jobs == 1 else f"{jobs} at a time"
    typer.echo(
        f"{total} runs in all: about {duration(max(cost / jobs, longest))} {at_once}, "
        f"{format_bytes(round(disk))} on the disk, in {folder / RUNS}"
    )
    typer.echo(f"by number of cores: {by_cores(cost, longest, total)}")


def _print(made: "Calibration") -> None:
    """Every parameter with its uncertainty, and every quantity over the posterior."""
    from rich import box
    from rich.markup import escape
    from rich.table import Table

    from ryusa.studies.calibrate.carry import UNDETERMINED
    from ryusa.studies.calibrate.pictures import shown

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("parameter")
    for heading in ("mean", "± s.d.", "unit", "95 %", "of prior"):
        table.add_column(heading, justify="right")
    table.add_column("")
    for row in made.rows:
        table.add_row(
            escape(str(row["parameter"])), f"{row['mean']:.4g}", f"{row['standard_deviation']:.2g}",
            escape(str(row["unit"])), f"{row['low_95']:.4g} to {row['high_95']:.4g}",
            f"{row['over_prior']:.2f}", "" if row["determined"] else UNDETERMINED,
        )  # fmt: skip
    console().print(table)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("quantity")
    for heading in ("observed", "posterior", "± s.d.", "95 %", "unit"):
        table.add_column(heading, justify="right")
    for one in made.predicted:
        unit, factor = shown(one.unit)
        seen = (
            "predicted"
            if one.observed is None
            else f"{factor * one.observed[0]:.4g} ± {factor * one.observed[1]:.2g}"
        )
        table.add_row(
            escape(one.target.words), seen, f"{factor * one.mean:.4g}", f"{factor * one.sd:.2g}",
            f"{factor * one.low:.4g} to {factor * one.high:.4g}", unit,
        )  # fmt: skip
    console().print(table)
    if made.coverage is not None:
        table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
        for heading in ("made-up truths: parameter", "interval", "hold the truth", "by chance"):
            table.add_column(heading)
        for row in made.coverage.rows(tuple(one.key for one in made.asked.priors)):
            table.add_row(
                escape(str(row["parameter"])), str(row["interval"]), f"{row['inside']} of {row['truths']}",
                f"{row['expected_low']} to {row['expected_high']}",
            )  # fmt: skip
        console().print(table)
