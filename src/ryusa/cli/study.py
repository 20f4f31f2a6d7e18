"""`ryusa study`: a study of your own."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.cli.many_runs import (
    DEFAULT,
    Again,
    Jobs,
    Json,
    MostMinutes,
    MostSeeds,
    On,
    Seeds,
    Show,
    carried_out,
    console,
    executor_at,
    finish,
    list_runs,
    numbers_table,
    plan_of,
    print_counts,
)
from ryusa.cli.options import Quiet

if TYPE_CHECKING:
    from ryusa.study.ledger import Ledger


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(study)


def study(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Holds study.py and its case files.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", metavar="FOLDER", help="Page, table, pictures and runs; default runs/NAME."
        ),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Quick level, one seed.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Full level.")] = False,
    seeds: Seeds = None,
    most_seeds: MostSeeds = 0,
    most_minutes: MostMinutes = math.inf,
    json: Json = None,
    on: On = DEFAULT,
    jobs: Jobs = None,
    again: Again = False,
    show: Show = False,
    quiet: Quiet = False,
) -> None:
    """Run a study of your own, and write one page with its numbers, intervals and pictures.

    FOLDER holds study.py: a docstring, tasks(plan) and measure(results, task);
    see docs/study-of-your-own.md. An interrupted study continues where it
    stopped when the same command is given again: finished runs are opened.
    """
    from ryusa.study.user import open_study

    plan, where = plan_of(quick, full, seeds), executor_at(on, jobs)
    mine = open_study(folder)
    out = Path("runs") / mine.name if out is None else out
    if show:
        list_runs(mine, plan, out, where.jobs, again)
        return
    ledger, files = carried_out(
        mine, None, plan, out, json, where, again, quiet, most_seeds=most_seeds, most_minutes=most_minutes
    )
    _print(ledger)
    finish(ledger, files, out)


def _print(ledger: "Ledger") -> None:
    """Every number of a user's study, with its verdict."""
    from rich.markup import escape

    from ryusa.study.entry import plain_entry
    from ryusa.study.page import interval

    table = numbers_table()
    for entry in ledger.entries:
        plain = plain_entry(ledger.study, entry, ledger.folder)
        first = [entry.id, escape(plain["verdict"])]
        if not plain["trials"]:
            table.add_row(*first, escape(entry.problem or "no number"))
        for one in plain["trials"]:
            choices = "".join(f"{key} {value}, " for key, value in one["choices"].items())
            table.add_row(*first, escape(f"{choices}{one['part']}: {interval(one)}"))
            first = ["", ""]
    console().print(table)
    print_counts(ledger)
