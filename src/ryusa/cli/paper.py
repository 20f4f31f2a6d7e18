"""`ryusa paper`: repeat the whole study and say, claim by claim, what holds."""

import math
import re
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

SEEDS = 4  # two halves: a condition is predicted on one and confirmed on the other


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(paper)


def paper(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="NAME", help="Figures, claims or experiments, such as fig19; default: all."),
    ] = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FOLDER", help="Page, tables, pictures and runs.")
    ] = Path("runs/paper"),
    quick: Annotated[
        bool, typer.Option("--quick", help="One seed, the cases as they ship: indicative, 5 minutes.")
    ] = False,
    full: Annotated[
        bool,
        typer.Option(
            "--full", help="33 settings instead of 17: about two hours; see --list. May be interrupted."
        ),
    ] = False,
    seeds: Annotated[
        str | None,
        typer.Option(
            "--seeds", metavar="N|A,B,..", help="Number of seeds, or the seeds; default 4, quick 1."
        ),
    ] = None,
    most_seeds: MostSeeds = 0,
    most_minutes: MostMinutes = math.inf,
    json: Json = None,
    on: On = DEFAULT,
    jobs: Jobs = None,
    again: Again = False,
    show: Annotated[
        bool, typer.Option("--list", help="List experiments and claims, with time and disk; run nothing.")
    ] = False,
    quiet: Quiet = False,
) -> None:
    """Repeat the paper's figures, judge every claim, and write one page that says what holds.

    An interrupted study continues where it stopped when the same command is
    given again: finished runs are opened. The numbers depend on the seeds alone.
    """
    find_studies()
    from ryusa_studies.osada2004.study import PAPER

    plan, where = plan_of(quick, full, seeds, SEEDS), executor_at(on, jobs)
    chosen = None if not names else [one for name in names for one in _known(name)]
    if show:
        typer.echo("A run that several experiments need is made once.")
        named = {
            (name, PAPER.part(name).TITLE, ", ".join(PAPER.claims(name))): PAPER.part(name).tasks(plan)
            for name in chosen or PAPER.parts
        }
        print_listed(("name", "what it answers", "claims"), named, plan, out, where.jobs, again)
        return
    ledger, files = carried_out(
        PAPER, chosen, plan, out, json, where, again, quiet, most_seeds=most_seeds, most_minutes=most_minutes
    )
    _print(ledger)
    finish(ledger, files, out)


def _known(word: str) -> list[str]:
    """Experiments that a word means: their name, the paper's way of writing a figure, or a claim."""
    from ryusa.errors import CaseError
    from ryusa.spelling import nearest_word
    from ryusa_studies.osada2004.study import NAMES, PAPER

    plain = re.sub(r"[\s.]+", "", word.lower())
    figure = re.fullmatch(r"(?:figure|fig)?0*(\d+)(.*)", plain)
    claim = f"fig{figure[1]}{figure[2]}" if figure else plain
    module = (f"fig{int(figure[1]):02d}" if figure and not figure[2] else plain).replace("-", "_")
    if module in NAMES:
        return [module]
    by_claim = [name for name in NAMES if claim in (*PAPER.claims(name), PAPER.figure(name))]
    if by_claim:
        return by_claim
    words = [*NAMES, *(one for name in NAMES for one in PAPER.claims(name))]
    allowed = f"must be one of {', '.join(NAMES)}, or a claim of theirs; ryusa paper --list shows both"
    raise CaseError("experiment", word, allowed, nearest_word(claim, words))


def _print(ledger: "Ledger") -> None:
    from rich.markup import escape

    from ryusa.study.entry import ours_in_words, plain_entry

    if ledger.plan.level == "quick":
        typer.echo(
            "indicative: one seed, no sweeps; `ryusa paper` without --quick gives intervals and verdicts"
        )
    table = numbers_table()
    for entry in ledger.entries:
        finding = entry.finding
        parts = [] if finding is None else ours_in_words(finding).split("; ")
        more = f" (and {len(parts) - 1} more on the page)" if len(parts) > 1 else ""
        ours = parts[0] + more if parts and parts[0] else "not judged, see below" if entry.problem else "-"
        verdict = plain_entry(ledger.study, entry, ledger.folder)["verdict"]
        table.add_row(entry.id, "verdict", escape(verdict))
        table.add_row("", "paper", escape(ledger.study.about(entry.id)["statement"]))
        table.add_row("", "ours", escape(ours))
    console().print(table)
    print_counts(ledger)
