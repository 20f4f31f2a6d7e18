"""`ryusa validate`: compare ours with every reference, with each error as a number."""

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
    carried_out,
    console,
    executor_at,
    find_studies,
    finish,
    numbers_table,
    plan_of,
    print_counts,
    print_listed,
)
from ryusa.cli.options import Quiet

if TYPE_CHECKING:
    from ryusa.study.ledger import Ledger

MISSED = 4  # exit code where all was computed and something lies outside its tolerance


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(validate)


def validate(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME", help="Checks, such as water_alone; default: all."),
    ] = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FOLDER", help="Page, pictures and runs.")
    ] = Path("runs/validation"),
    quick: Annotated[
        bool, typer.Option("--quick", help="Only what takes seconds, one seed; for every change.")
    ] = False,
    full: Annotated[
        bool, typer.Option("--full", help="More and longer runs: hours; see --list. May be interrupted.")
    ] = False,
    seeds: Seeds = None,
    most_seeds: MostSeeds = 0,
    most_minutes: MostMinutes = math.inf,
    against: Annotated[
        Path | None,
        typer.Option(
            "--against", metavar="LEDGER", help="Earlier ledger: list the verdicts that changed since."
        ),
    ] = None,
    json: Json = None,
    on: On = DEFAULT,
    jobs: Jobs = None,
    again: Again = False,
    show: Annotated[
        bool, typer.Option("--list", help="List the checks, with time and disk; run nothing.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Compare ryusa with closed forms and measurements, and write one page with every error as a number.

    A number from random draws is the mean over independent runs with its 95 %
    interval; where the interval includes a limit, the comparison is undecided.
    An interrupted validation continues where it stopped when the same command
    is given again. Exits with 4 where something lies outside its tolerance.
    """
    from ryusa.study import Outcome
    from ryusa.study.ledger_file import as_registered, read_ledger
    from ryusa.study.verdicts import refuse_other_study

    find_studies()
    from ryusa_studies.validation.study import VALIDATION

    plan, where = plan_of(quick, full, seeds), executor_at(on, jobs)
    chosen = None if not names else [_known(name) for name in names]
    if show:
        parts = {name: VALIDATION.part(name) for name in chosen or VALIDATION.parts}
        named = {(name, part.TITLE): part.tasks(plan) for name, part in parts.items()}
        print_listed(("name", "what it checks"), named, plan, out, where.jobs, again)
        return
    earlier = None if against is None else read_ledger(against)  # first: --json may write the same file
    if earlier is not None:
        refuse_other_study(earlier, VALIDATION.name)
        earlier = as_registered(VALIDATION, earlier)  # bands that are newer than it judge both
    ledger, files = carried_out(
        VALIDATION, chosen, plan, out, json, where, again, quiet, earlier, most_seeds, most_minutes
    )
    _print(ledger)
    finish(ledger, files, out)
    missed = [one.id for one in ledger.entries if one.outcome is Outcome.FAILS]
    if missed:
        typer.echo(f"{len(missed)} outside the tolerance: {', '.join(missed)}", err=True)
        raise typer.Exit(MISSED)


def _known(word: str) -> str:
    """Name of a check; hyphens as on the page are understood."""
    from ryusa.spelling import known_word
    from ryusa_studies.validation.study import NAMES

    return known_word(word.replace("-", "_").split("/", 1)[0], NAMES, "check")


def _print(ledger: "Ledger") -> None:
    from rich.markup import escape

    from ryusa.study.entry import plain_entry
    from ryusa.study.page import checks_of, interval
    from ryusa.study.study import limits_in_words

    table = numbers_table()
    for entry in ledger.entries:
        plain = plain_entry(ledger.study, entry, ledger.folder)
        checks = checks_of(plain)
        said = "; ".join(
            f"{each['part']} {interval(each)} ({limits_in_words(each)}"
            f"{', check' if each['part'] in checks else ''})"
            for each in plain["trials"]
        )
        table.add_row(entry.id, plain["verdict"], escape(said or "see below"))
    console().print(table)
    print_counts(ledger)
    if ledger.earlier is not None:
        _print_changes(ledger)


def _print_changes(ledger: "Ledger") -> None:
    """Verdicts that differ from those of an earlier ledger."""
    found = ledger.plain()["against"]
    typer.echo(f"{len(found['changed'])} verdicts differ from those of {found['made'][:16]}:")
    for one in found["changed"]:
        typer.echo(f"  {one['id']}: {one['old']}, now {one['new']}")
    if found["contradictions"]:
        typer.echo(f"decided in both, and contrary: {', '.join(found['contradictions'])}", err=True)
