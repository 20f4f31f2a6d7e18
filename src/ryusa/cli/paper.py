"""`ryusa paper`: re-do the whole study and say, claim by claim, what holds."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ryusa.cli.study import console, cores, interrupted, tell_failures

if TYPE_CHECKING:
    from ryusa.studies.osada2004 import Plan
    from ryusa.studies.osada2004.ledger import Ledger

_MOST_SEEDS = 1000


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(paper)


def paper(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME", help="Figures, claims or experiments, such as fig19; all if none."),
    ] = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FOLDER", help="Page, tables, pictures and runs go here.")
    ] = Path("runs/paper"),
    quick: Annotated[
        bool, typer.Option("--quick", help="One seed, no sweeps: indicative, 3 minutes.")
    ] = False,
    full: Annotated[
        bool, typer.Option("--full", help="Every sweep: hours; see --list. May be interrupted.")
    ] = False,
    seeds: Annotated[
        str | None,
        typer.Option(
            "--seeds", metavar="N|A,B,..", help="Number of seeds, or the seeds; default 3, quick 1."
        ),
    ] = None,
    json: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Write the ledger here too.")
    ] = None,
    jobs: Annotated[
        int | None,
        typer.Option("--jobs", "-j", metavar="N", min=1, help="Runs at a time; default: all cores."),
    ] = None,
    again: Annotated[
        bool, typer.Option("--again", help="Run anew what was finished; else it is opened.")
    ] = False,
    show: Annotated[
        bool, typer.Option("--list", help="List experiments, claims, time and disk; run nothing.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress while running.")] = False,
) -> None:
    """Re-do the paper's figures, judge every claim, and write one page that says what holds.

    An interrupted campaign goes on where it stopped when the same command is
    given again: finished runs are opened. The numbers depend on the seeds alone.
    """
    plan = _plan(quick, full, seeds)
    chosen = None if not names else [one for name in names for one in _known(name)]
    if show:
        _list(plan, chosen, out, jobs, again)
        return
    from ryusa.errors import ResultsError
    from ryusa.studies.osada2004 import ProgressLines
    from ryusa.studies.osada2004.ledger import make
    from ryusa.studies.osada2004.page import write

    try:
        ledger = make(
            chosen,
            plan,
            out,
            jobs=jobs or cores(),
            again=again,
            say=None if quiet else ProgressLines(),
        )
        files = write(ledger, json)
    except KeyboardInterrupt:
        interrupted(out)
    except OSError as error:
        raise ResultsError(f"{out}: cannot be written ({error.strerror or error})") from None
    _print(ledger)
    for path in files:
        typer.echo(f"wrote {path}")
    tell_failures(ledger.problems, ledger.faults, ledger.traces, out / ledger.log)


def _plan(quick: bool, full: bool, seeds: str | None) -> "Plan":
    from ryusa.errors import CaseError
    from ryusa.studies.osada2004 import Level, Plan

    if quick and full:
        raise CaseError("--quick", None, "goes without --full")
    level = Level.QUICK if quick else Level.FULL if full else Level.STANDARD
    return Plan(level, tuple(range(1, 2 if quick else 4)) if seeds is None else _seeds(seeds))


def _seeds(text: str) -> tuple[int, ...]:
    from ryusa.errors import CaseError

    words = [one.strip() for one in text.split(",")]
    allowed = f"must be a number of seeds, 1 to {_MOST_SEEDS}, or different seeds such as 4,5,6"
    if not all(one.isdecimal() for one in words):
        raise CaseError("--seeds", text, allowed)
    numbers = [int(one) for one in words]
    if len(numbers) == 1:
        if not 1 <= numbers[0] <= _MOST_SEEDS:
            raise CaseError("--seeds", text, allowed)
        return tuple(range(1, numbers[0] + 1))
    if len(set(numbers)) < len(numbers) or max(numbers) >= 2**63:
        raise CaseError("--seeds", text, allowed)
    return tuple(numbers)


def _known(word: str) -> list[str]:
    """Experiments that a word means: their name, the paper's way of writing a figure, or a claim."""
    from ryusa.casefile.spelling import nearest_word
    from ryusa.errors import CaseError
    from ryusa.studies.osada2004 import NAMES, load

    plain = re.sub(r"[\s.]+", "", word.lower())
    figure = re.fullmatch(r"(?:figure|fig)?0*(\d+)(.*)", plain)
    claim = f"fig{figure[1]}{figure[2]}" if figure else plain
    module = (f"fig{int(figure[1]):02d}" if figure and not figure[2] else plain).replace("-", "_")
    if module in NAMES:
        return [module]
    by_claim = [name for name in NAMES if claim in load(name).CLAIMS or claim == load(name).FIGURE]
    if by_claim:
        return by_claim
    words = [*NAMES, *(one for name in NAMES for one in load(name).CLAIMS)]
    allowed = f"must be one of {', '.join(NAMES)}, or a claim of theirs; ryusa paper --list shows both"
    raise CaseError("experiment", word, allowed, nearest_word(claim, words))


def _list(plan: "Plan", chosen: Sequence[str] | None, out: Path, jobs: int | None, again: bool) -> None:
    from rich import box
    from rich.table import Table

    from ryusa.studies.osada2004 import NAMES, estimate_cost, load

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("name", "what it answers", "claims"):
        table.add_column(heading, no_wrap=heading == "name")
    for heading in ("runs", "core minutes"):
        table.add_column(heading, justify="right")
    every: list[Any] = []
    for name in chosen or NAMES:
        experiment, runs = load(name), list(dict.fromkeys(load(name).cases(plan)))
        minutes = sum(one.cost() for one in runs) / 60.0
        claims = ", ".join(experiment.CLAIMS)
        table.add_row(name, experiment.TITLE, claims, str(len(runs)), f"{minutes:.1f}" if runs else "-")
        every += runs
    console().print(table)
    typer.echo("A run that several experiments need is made once.")
    typer.echo(f"{plan.level}: {estimate_cost(every, out / 'runs', jobs=jobs or cores(), again=again)}")


def _print(ledger: "Ledger") -> None:
    from collections import Counter

    from rich.markup import escape
    from rich.table import Table

    from ryusa.studies.osada2004 import Word

    if ledger.plan.level == "quick":
        typer.echo(
            "indicative: one seed, no sweeps; `ryusa paper` without --quick gives intervals and verdicts"
        )
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(no_wrap=True)
    table.add_column(ratio=1, overflow="fold")
    for row in ledger.rows:
        plain = row.plain(ledger.folder)
        parts = plain["ours"].split("; ")
        more = f" (and {len(parts) - 1} more on the page)" if len(parts) > 1 else ""
        ours = (
            "not judged, see below"
            if row.finding is None and row.problem
            else (parts[0] + more if parts[0] else "-")
        )
        table.add_row(row.claim.id, "verdict", f"{row.word} {escape(plain['condition'])}".strip())
        table.add_row("", "paper", escape(row.claim.says))
        table.add_row("", "ours", escape(ours))
    console().print(table)
    counts = Counter(row.word for row in ledger.rows)
    typer.echo("; ".join(f"{counts[word]} {word}" for word in Word if counts[word]))
