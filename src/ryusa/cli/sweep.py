"""`ryusa sweep`: a case at many settings, with several seeds each."""

import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.catalogue import MEASURES
from ryusa.cli.many_runs import (
    DEFAULT,
    Again,
    Jobs,
    On,
    Show,
    executor_at,
    plan_of,
    print_table,
    report_failures,
    writing,
)
from ryusa.cli.options import Quiet
from ryusa.cli.run import CaseFile, Settings, overrides_of

if TYPE_CHECKING:
    from ryusa.campaigns.sweep import SweepPlan
    from ryusa.campaigns.sweep.execution import Sweep

MOST_LISTED = 50  # settings
MOST_BESIDE = 2  # keys that stand beside a quantity; of more, the number of the setting does

Over = Annotated[
    list[str] | None,
    typer.Option(
        "--over", metavar="KEY=A,B,..", show_default=False,
        help="Values of a key of the case, such as --over motion.slope=0.01,0.02; repeated for every "
        "combination with another key. 'KEY=A,B; OTHER=C,D' changes both together.",
    ),
]  # fmt: skip
Measures = Annotated[
    list[str] | None,
    typer.Option(
        "--measure", "-m", metavar="NAME", show_default=False,
        help=f"Measure; may be repeated: {', '.join(one.name for one in MEASURES if not one.table)}.",
    ),
]  # fmt: skip


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(sweep)


def sweep(
    case: CaseFile,
    over: Over = None,
    measure: Measures = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            metavar="FOLDER",
            help="Table, page, pictures and runs; default runs/sweep-CASE.",
        ),
    ] = None,
    seeds: Annotated[
        str | None,
        typer.Option(
            "--seeds", metavar="N|A,B,..", help="Number of seeds of each setting, or the seeds; default 3."
        ),
    ] = None,
    settings: Settings = None,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="Write the table as Parquet too; needs the extra parquet.")
    ] = False,
    pages: Annotated[
        bool, typer.Option("--pages/--no-pages", help="Write a page for each run, with its grains in motion.")
    ] = True,
    on: On = DEFAULT,
    emit: Annotated[
        str | None,
        typer.Option(
            "--emit",
            metavar="slurm",
            show_default=False,
            help="Run nothing; write the scripts of a job array of Slurm into FOLDER/slurm.",
        ),
    ] = None,
    jobs: Jobs = None,
    again: Again = False,
    show: Show = False,
    quiet: Quiet = False,
) -> None:
    """Run a case at many settings with several seeds, and write one table and one page.

    Everything is checked before the first run. The table has every quantity of
    every run with its error and steadiness, and pooled over the seeds with the
    error between runs. CASE may be a TOML file with a table `sweep` instead:
    grids, lists, Latin hypercubes, Sobol sequences. The same command continues
    an interrupted sweep: finished runs are opened, others go on where they were.
    """  # fmt: skip
    # One function: two thirds of it are the options of the command, which typer reads from its signature.
    from ryusa.campaigns.sweep import carry_out_sweep, planned, write_sweep
    from ryusa.campaigns.sweep.definition import axes_of_words
    from ryusa.campaigns.sweep.design import GRID, design_of
    from ryusa.campaigns.sweep.folder import refuse_folder
    from ryusa.study import ProgressLines

    where = executor_at(on, jobs)
    design = design_of(GRID, axes_of_words(over)) if over else None
    given = None if seeds is None else plan_of(False, False, seeds).seeds
    plan = planned(case, design, given, measure or (), overrides_of(settings), pages=pages)
    folder = Path("runs") / f"sweep-{case.stem}" if out is None else out
    if show:
        refuse_folder(plan, folder, again=again)
        _list(plan, folder, where.jobs, again)
        return
    if not quiet:
        _warn(plan)
    words = _words(over or [], measure or [], seeds, settings or [])
    if emit is not None:
        more = [*(["--parquet"] if parquet else []), *([] if pages else ["--no-pages"])]
        _emit(emit, plan, folder, ["sweep", str(case), *words, *more], again)
        return
    with writing(folder):
        made = carry_out_sweep(
            plan, folder, where, again=again, parquet=parquet, progress=None if quiet else ProgressLines()
        )
        files = write_sweep(made, shlex.join(["ryusa", "sweep", case.name, *words]))
    _print(made)
    for path in files:
        typer.echo(f"wrote {path}")
    if made.unmoved:
        text, which = made.unmoved
        typer.echo(f"warning: {which}: {text}", err=True)
    report_failures(made.problems, made.faults, made.traces, folder / "sweep-errors.log")


def _words(
    over: Sequence[str], measures: Sequence[str], seeds: str | None, settings: Sequence[str]
) -> list[str]:
    """Arguments of the command that say what the sweep is, without its files."""
    words: list[str] = []
    for option, every in (("--over", over), ("--measure", measures), ("--set", settings)):
        words += [word for one in every for word in (option, one)]
    return [*words, *(() if seeds is None else ("--seeds", seeds))]


def _emit(what: str, plan: "SweepPlan", folder: Path, words: Sequence[str], again: bool) -> None:
    """Write the scripts of another scheduler, and say how to submit them."""
    from ryusa.campaigns.sweep.slurm import emit_slurm, submission
    from ryusa.errors import CaseError
    from ryusa.spelling import known_word

    known_word(what, ("slurm",), "--emit")
    if again:
        raise CaseError(
            "--again", None, "cannot be combined with --emit: a requeued run goes on. Choose another -o"
        )
    with writing(folder):
        scripts, n = emit_slurm(plan, folder, words)
    for path in scripts:
        typer.echo(f"wrote {path}")
    typer.echo(f"{n} {'run' if n == 1 else 'runs'} to make. To submit:")
    for line in submission(scripts, n):
        typer.echo(f"  {line}")


def _list(plan: "SweepPlan", folder: Path, jobs: int, again: bool) -> None:
    """Every setting with its cost, what differs between the cases, and the cost of all by number of cores."""
    from ryusa.campaigns.sweep.folder import RUNS
    from ryusa.study import estimate_cost
    from ryusa.study.cost import by_cores
    from ryusa.study.printed_table import PrintedTable

    n = len(plan.seeds)
    first = plan.first_runs
    rows = [
        (str(k + 1), *plan.design.settings[k].values(), str(n), f"{n * run.cost() / 60.0:.1f}")
        for k, run in enumerate(first[:MOST_LISTED])
    ]
    print_table(PrintedTable(("no.", *plan.design.keys, "runs", "core minutes"), rows))
    if len(first) > MOST_LISTED:
        typer.echo(f"and {len(first) - MOST_LISTED} more settings")
    if plan.design.dropped:
        typer.echo(f"{plan.design.dropped} points of the design give settings that are there already")
    _explain(plan)
    _warn(plan)
    ahead = estimate_cost(plan.runs, folder / RUNS, jobs=jobs, again=again)
    typer.echo(str(ahead))
    if ahead.costs:
        longest = max(ahead.costs.values())
        typer.echo(f"by number of cores: {by_cores(ahead.core_seconds, longest, len(ahead.costs))}")


def _explain(plan: "SweepPlan") -> None:
    """Values that differ between the settings, as `ryusa check` prints them."""
    from ryusa.study.printed_table import PrintedTable

    if not plan.explained or len(plan.design.settings) > MOST_LISTED:
        return
    heads = ("value", *(str(k + 1) for k in range(min(len(plan.design.settings), 8))))
    rows = [(name, *held[:8]) for name, held in plan.explained]
    print_table(PrintedTable(heads, rows, frozenset({"value"})), "what differs")


def _warn(plan: "SweepPlan") -> None:
    """What `ryusa check` warns of, on stderr."""
    for text, which in plan.warnings.items():
        typer.echo(f"warning: {plan.named(which)}: {text}", err=True)


def _print(made: "Sweep") -> None:
    """Every quantity of every setting: the mean over the seeds with the error between them."""
    from ryusa.campaigns.sweep.part import short_names
    from ryusa.study.printed_table import PrintedTable

    plan, quantities = made.plan, made.quantities
    keys = tuple(short_names(plan.design.keys))
    settings = [tuple(one.values()) for one in plan.design.settings[:MOST_LISTED]]
    if len(keys) > MOST_BESIDE:  # the settings have a table of their own, and are named by number below
        rows = [(str(k + 1), *values) for k, values in enumerate(settings)]
        print_table(PrintedTable(("no.", *keys), rows, frozenset({"no.", *keys})))
        keys, settings = ("no.",), [(str(k + 1),) for k in range(len(settings))]
    rows: list[tuple[str, ...]] = []
    for one in quantities:
        for k, values in enumerate(settings):
            mean = one.pooled[k]
            name = one.title if k == 0 else ""
            if mean is None:
                rows.append((name, *values, "–", "–", one.unit, "0", "-"))
                continue
            rows.append(
                (
                    name, *values, f"{mean.value:.4g}", mean.error_text.rstrip("*"), one.unit,
                    str(len(one.runs[k])), "no" if mean.changes else mean.verdict,
                )
            )  # fmt: skip
    heads = ("quantity", *keys, "value", "± s.e.", "unit", "runs", "steady")
    if quantities:
        print_table(PrintedTable(heads, rows, frozenset({"quantity", *keys, "steady"})))
