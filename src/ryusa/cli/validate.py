"""`ryusa validate`: set ours against every reference, with the error as a number."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.cli.study import console, cores, interrupted, tell_failures

if TYPE_CHECKING:
    from ryusa.studies.validation.ledger import Validation
    from ryusa.study import Level

MISSED = 4  # exit code where all was computed and something lies outside its tolerance


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(validate)


def validate(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Checks, such as water_alone; all if none.")
    ] = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FOLDER", help="Page, pictures and runs go here.")
    ] = Path("runs/validation"),
    quick: Annotated[bool, typer.Option("--quick", help="What takes seconds; for every change.")] = False,
    json: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the numbers here too.")
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option("--jobs", "-j", metavar="N", min=1, help="Runs at a time; default: all cores."),
    ] = None,
    again: Annotated[
        bool, typer.Option("--again", help="Compute anew what was finished; else it is opened.")
    ] = False,
    show: Annotated[bool, typer.Option("--list", help="List checks, time and disk; run nothing.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress while running.")] = False,
) -> None:
    """Set ours against closed forms and measurements, and write one page with every error as a number.

    An interrupted validation goes on where it stopped when the same command is
    given again. Leaves with 4 where something lies outside its tolerance.
    """
    from ryusa.errors import ResultsError
    from ryusa.study import Level, ProgressLines

    level = Level.QUICK if quick else Level.FULL
    chosen = None if not names else [_known(name) for name in names]
    if show:
        _list(level, chosen, out, jobs, again)
        return
    from ryusa.studies.validation import Word
    from ryusa.studies.validation.ledger import make, write

    try:
        made = make(
            chosen, level, out, jobs=jobs or cores(), again=again, say=None if quiet else ProgressLines()
        )
        files = write(made, json)
    except KeyboardInterrupt:
        interrupted(out)
    except OSError as error:
        raise ResultsError(f"{out}: cannot be written ({error.strerror or error})") from None
    _print(made)
    for path in files:
        typer.echo(f"wrote {path}")
    tell_failures(made.problems, made.faults, made.traces, out / made.log)
    missed = [one.id for one in made.rows if one.word is Word.MISSED]
    if missed:
        typer.echo(f"{len(missed)} outside the tolerance: {', '.join(missed)}", err=True)
        raise typer.Exit(MISSED)


def _known(word: str) -> str:
    """Name of a check; hyphens as on the page are understood."""
    from ryusa.cli.options import known
    from ryusa.studies.validation import NAMES

    return known(word.replace("-", "_").split("/", 1)[0], NAMES, "check")


def _list(level: "Level", chosen: Sequence[str] | None, out: Path, jobs: int | None, again: bool) -> None:
    from rich import box
    from rich.table import Table

    from ryusa.studies.validation import NAMES, load
    from ryusa.study import Task, estimate_cost

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("name", "what it checks"):
        table.add_column(heading, no_wrap=heading == "name")
    for heading in ("runs", "core minutes"):
        table.add_column(heading, justify="right")
    every: list[Task] = []
    for name in chosen or NAMES:
        runs = list(dict.fromkeys(load(name).runs(level)))
        minutes = sum(one.cost() for one in runs) / 60.0
        table.add_row(name, load(name).TITLE, str(len(runs)), f"{minutes:.1f}")
        every += runs
    console().print(table)
    typer.echo(f"{level}: {estimate_cost(every, out / 'runs', jobs=jobs or cores(), again=again)}")


def _print(made: "Validation") -> None:
    from collections import Counter

    from rich.markup import escape
    from rich.table import Table

    from ryusa.studies.validation import Word
    from ryusa.studies.validation.ledger import error_in_words, tolerance_in_words

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column(ratio=1, overflow="fold")
    for row in made.rows:
        plain = row.plain(made.folder)
        said = "; ".join(
            f"{each['name']} {error_in_words(each)} ({tolerance_in_words(each)})" for each in plain["errors"]
        )
        table.add_row(row.id, str(row.word), escape(said or "see below"))
    console().print(table)
    counts = Counter(row.word for row in made.rows)
    typer.echo("; ".join(f"{counts[word]} {word}" for word in Word if counts[word]))
