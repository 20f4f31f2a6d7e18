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
    from collections.abc import Sequence

    from ryusa.campaigns.calibrate import Calibration, CalibrationAsked


UNMOVED = (
    "runs with different seeds gave the same numbers to the last digit; intervals have no scatter between "
    "runs in them. Where that is not meant, the case needs something random, such as grains.spread"
)
UNREACHED = 4  # exit code where all was computed and the model does not reach the observations


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
    extend: Annotated[
        int,
        typer.Option(
            "--extend", metavar="N", min=0, max=10,
            help="Where a posterior lies at an edge of its prior, extend that prior by half its range, as "
            "far as the cases take the parameter, and run there; up to N times.",
        ),
    ] = 0,
    coverage: Annotated[
        int,
        typer.Option(
            "--coverage", metavar="N", min=0,
            help="Check intervals and verdict on N made-up truths, which are run too; 5 or more.",
        ),
    ] = 0,
    on: On = DEFAULT,
    jobs: Jobs = None,
    again: Again = False,
    show: Show = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Find the parameters of cases that agree with observations, or say that none do.

    STUDY names parameters with their priors, observations with their errors, and
    the cases that show them. The cases are run at points that fill the priors,
    with several seeds; an emulator through these runs gives the posterior, and
    further runs are made where it needs them. The verdict comes before the
    numbers; exit code 4 where the model does not reach the observations. The same
    command continues an interrupted calibration. Needs the extra calibrate.
    """
    from ryusa.campaigns.calibrate import (
        carry_out_calibration,
        read_calibration,
        refuse_truths,
        write_calibration,
    )
    from ryusa.campaigns.calibrate.page import LOG
    from ryusa.campaigns.sweep.table import unmoved_by_seeds
    from ryusa.errors import ResultsError
    from ryusa.study import ProgressLines

    asked = read_calibration(study)
    refuse_truths(coverage)
    folder = Path("runs") / f"calibration-{asked.name}" if out is None else out
    where = executor_at(on, jobs)
    if show:
        _list(asked, folder, where.jobs, coverage, extend)
        return
    words = ["ryusa", "calibrate", study.name, *(["--extend", str(extend)] if extend else [])]
    words += ["--coverage", str(coverage)] if coverage else []
    try:
        made = carry_out_calibration(
            asked, folder, where, again=again, extend=extend, truths=coverage,
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
    if not made.verdict.reached:
        raise typer.Exit(UNREACHED)


def _list(asked: "CalibrationAsked", folder: Path, jobs: int, truths: int, extend: int) -> None:
    """Parameters, quantities, and the cost of all runs."""
    from ryusa.campaigns.calibrate.design import filling_points
    from ryusa.campaigns.calibrate.runs import RUNS, CaseRuns
    from ryusa.running.folder import format_bytes
    from ryusa.study import duration
    from ryusa.study.cost import basis_of, by_cores
    from ryusa.study.executors import executor_of

    for prior in asked.priors:
        typer.echo(f"{prior.key}: {prior.words}")
    for one in asked.observations:
        off = "" if one.discrepancy is None else f" ± {one.discrepancy} of the model"
        typer.echo(f"observed: {one.words} {one.value} ± {one.error}{off}")
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
    basis = basis_of(one for plan in plans.values() for one in plan.first_runs)
    at_once = "one at a time" if jobs == 1 else f"{jobs} at a time"
    typer.echo(
        f"{total} runs in all: about {duration(max(cost / jobs, longest))} {at_once}, {basis}, "
        f"compiling apart; {format_bytes(round(disk))} on the disk, in {folder / RUNS}"
    )
    typer.echo(f"by number of cores: {by_cores(cost, longest, total)}")
    if extend:
        each = asked.seeds * (asked.points // 2 + asked.rounds * asked.more) * len(plans)
        typer.echo(f"not in these: about {each} runs for each prior that is extended")


def _print(made: "Calibration") -> None:
    """The verdict, what stands behind it, then observations, parameters and predictions."""
    from rich.markup import escape

    first, *others = made.words
    console().print(f"[bold]{escape(first)}[/bold]")
    for one in others:
        console().print(f"- {escape(one)}")
    typer.echo()
    _print_observations(made)
    _print_parameters(made)
    _print_predictions(made)
    _print_coverage(made)


def _print_observations(made: "Calibration") -> None:
    from ryusa.campaigns.calibrate.sentences import shown
    from ryusa.campaigns.calibrate.tables import printed_interval, printed_number

    rows: list[tuple[str, ...]] = []
    for one, compared, si in zip(
        made.asked.observations, made.verdict.compared, made.observed_units, strict=True
    ):
        unit, factor = shown(si)
        rows.append(
            (
                one.target.words, f"{factor * compared.value:.4g} ± {factor * compared.error:.2g}",
                printed_number(compared.predicted, 4, factor),
                printed_interval(compared.least, compared.most, factor), unit, f"{compared.misfit:+.1f}",
            )
        )  # fmt: skip
    _table(("observation", "observed", "posterior", "all runs", "unit", "misfit, s.d."), rows)


def _print_parameters(made: "Calibration") -> None:
    from ryusa.campaigns.calibrate.tables import printed_interval, printed_number

    rows = [
        (
            str(row["parameter"]), printed_number(row["mean"], 4),
            printed_number(row["standard_deviation"], 2), str(row["unit"]),
            printed_interval(row["low_95"], row["high_95"]), printed_number(row["over_prior"], 2),
            "yes" if row["determined"] else "no",
        )
        for row in made.rows
    ]  # fmt: skip
    _table(("parameter", "mean", "± s.d.", "unit", "95 %", "of prior", "determined"), rows)


def _print_predictions(made: "Calibration") -> None:
    from ryusa.campaigns.calibrate.sentences import shown
    from ryusa.campaigns.calibrate.tables import printed_interval, printed_number

    if not made.verdict.reached:
        return
    rows: list[tuple[str, ...]] = []
    for one in made.predicted:
        unit, factor = shown(one.unit)
        if one.observed is None:
            rows.append(
                (
                    one.target.words, printed_number(one.mean, 4, factor), printed_number(one.sd, 2, factor),
                    printed_interval(one.low, one.high, factor), unit,
                )
            )  # fmt: skip
    if rows:
        _table(("predicted", "posterior", "± s.d.", "95 %", "unit"), rows)


def _print_coverage(made: "Calibration") -> None:
    if made.coverage is None:
        return
    rows = [
        (
            str(row["parameter"]), str(row["interval"]), f"{row['inside']} of {row['truths']}",
            f"{row['expected_low']} to {row['expected_high']}",
        )
        for row in made.coverage.rows(tuple(one.key for one in made.asked.priors))
    ]  # fmt: skip
    _table(("made-up truths: parameter", "interval", "hold the truth", "by chance"), rows)
    rows = [
        (str(row["observations"]), f"{row['wrong']} of {row['of']}", f"at most {row['at_most']}")
        for row in made.coverage.verdict_rows()
    ]
    _table(("made-up observations", "wrong verdicts", "by chance, at 5 %"), rows)


def _table(headings: "Sequence[str]", rows: "Sequence[Sequence[str]]") -> None:
    """Print a table whose first column is text."""
    from rich import box
    from rich.markup import escape
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for k, heading in enumerate(headings):
        table.add_column(heading, justify="left" if k == 0 else "right", no_wrap=k > 0)
    for row in rows:
        table.add_row(*(escape(one) for one in row))
    console().print(table)
