"""`ryusa calibrate`: parameters from observations."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.cli.many_runs import (
    DEFAULT,
    Again,
    Jobs,
    On,
    Show,
    console,
    executor_at,
    print_table,
    report_failures,
    writing,
)
from ryusa.cli.options import Quiet

if TYPE_CHECKING:
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
    with writing(folder):
        made = carry_out_calibration(
            asked, folder, where, again=again, extend=extend, truths=coverage,
            progress=None if quiet else ProgressLines(),
        )  # fmt: skip
        files = write_calibration(made, shlex.join(words))
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

    from ryusa.campaigns.calibrate.printed import (
        coverage_tables,
        observations_table,
        parameters_table,
        quantities_table,
    )

    first, *others = made.words
    console().print(f"[bold]{escape(first)}[/bold]")
    for one in others:
        console().print(f"- {escape(one)}")
    typer.echo()
    heads = ("observation", "observed ± s.e.", "posterior", "all runs", "unit", "misfit, in s.d.")
    print_table(observations_table(made).only(*heads))
    heads = ("parameter", "mean", "s.d.", "unit", "95 %", "s.d. over prior's", "determined")
    print_table(parameters_table(made, brief=True).only(*heads))
    predicted = quantities_table(made, predicted=True)
    if made.verdict.reached and predicted.rows:
        print_table(predicted.only("quantity", "posterior", "s.d.", "95 %", "unit"), "predicted")
    if made.coverage is not None:
        keys = tuple(one.key for one in made.asked.priors)
        for one in coverage_tables(made.coverage, keys):
            print_table(one, "made-up truths")
