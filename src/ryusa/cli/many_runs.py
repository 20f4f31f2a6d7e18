"""What commands of many runs share: options, where runs are carried out, tables and failures."""

import math
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from ryusa.study import Plan, Study, Task
    from ryusa.study.executors import RunExecutor
    from ryusa.study.ledger import Ledger
    from ryusa.study.printed_table import PrintedTable

INTERRUPTED = 130  # exit code after Ctrl-C
DEFAULT = "processes"  # of --on
FAILED = 3  # exit code where a run could not be carried out, or something could not be judged
BROKEN = 1  # exit code of an error in the program, as Python's own
WIDE = 100  # columns of a table that goes to a file or pipe
MOST_SEEDS = 1000

# Options.

Jobs = Annotated[
    int | None,
    typer.Option(
        "--jobs",
        "-j",
        metavar="N",
        min=1,
        help="Runs at a time; default: all cores, or all threads of dask's workers.",
    ),
]
On = Annotated[
    str,
    typer.Option(
        "--on", metavar="WHERE",
        help="Where runs are carried out: processes of this machine, or dask:ADDRESS for the workers of "
        "a scheduler, which may be jobs of a cluster.",
    ),
]  # fmt: skip
Show = Annotated[bool, typer.Option("--list", help="List the runs, with time and disk; run nothing.")]
Again = Annotated[
    bool, typer.Option("--again", help="Make every run anew; otherwise finished runs are opened.")
]
Seeds = Annotated[
    str | None,
    typer.Option("--seeds", metavar="N|A,B,..", help="Number of seeds, or the seeds; default 3, quick 1."),
]
MostSeeds = Annotated[
    int,
    typer.Option(
        "--most-seeds", metavar="N", min=0, max=MOST_SEEDS,
        help="While an interval leaves something undecided, give its part as many seeds again, up to N in "
        "all; default: none.",
    ),
]  # fmt: skip
MostMinutes = Annotated[
    float,
    typer.Option(
        "--most-minutes", metavar="M", min=0.0,
        help="Give a part more seeds only while all of its runs take no more than M core minutes by rule of "
        "thumb; default: no limit.",
    ),
]  # fmt: skip
Json = Annotated[
    Path | None,
    typer.Option(
        "--json", metavar="FILE",
        help="Write the ledger here too; compressed if FILE ends in .xz. Parts that are named take the place "
        "of their own in a ledger that is there.",
    ),
]  # fmt: skip


def carried_out(
    chosen: "Study",
    names: Sequence[str] | None,
    plan: "Plan",
    out: Path,
    json: Path | None,
    where: "RunExecutor",
    again: bool,
    quiet: bool,
    earlier: Mapping[str, Any] | None = None,
    most_seeds: int = 0,
    most_minutes: float = math.inf,
) -> "tuple[Ledger, tuple[Path, ...]]":
    """Run a study and write its ledger and page; an interrupt leaves with its own exit code.

    With an earlier ledger, the new one says which verdicts changed since.
    """
    from ryusa.study import ProgressLines
    from ryusa.study.ledger import make
    from ryusa.study.ledger_file import kept_at
    from ryusa.study.page import write

    if names is not None and json is not None:
        kept_at(json, chosen, plan.level)  # what cannot be joined is refused before any run
    with writing(out):
        progress = None if quiet else ProgressLines()
        made = make(
            chosen, names, plan, out, where=where, again=again, progress=progress, most_seeds=most_seeds,
            longest=60.0 * most_minutes,
        )  # fmt: skip
        ledger = replace(made, earlier=earlier)
        return ledger, write(ledger, json)


def finish(ledger: "Ledger", files: Sequence[Path], out: Path) -> None:
    """Name the files that were written, and what went wrong; leave where anything did."""
    for path in files:
        typer.echo(f"wrote {path}")
    report_failures(ledger.problems, ledger.faults, ledger.traces, out / ledger.log)


def plan_of(quick: bool, full: bool, seeds: str | None, count: int = 3) -> "Plan":
    """Level and seeds from the options; `count` seeds if none are given."""
    from ryusa.errors import CaseError
    from ryusa.study import Level, Plan

    if quick and full:
        raise CaseError("--quick", None, "cannot be combined with --full")
    level = Level.QUICK if quick else Level.FULL if full else Level.STANDARD
    return Plan(level, tuple(range(1, 2 if quick else count + 1)) if seeds is None else _seeds(seeds))


def _seeds(text: str) -> tuple[int, ...]:
    from ryusa.errors import CaseError

    words = [one.strip() for one in text.split(",")]
    allowed = f"must be a number of seeds, 1 to {MOST_SEEDS}, or different seeds such as 4,5,6"
    if not all(one.isdecimal() for one in words):
        raise CaseError("--seeds", text, allowed)
    numbers = [int(one) for one in words]
    if len(numbers) == 1:
        if not 1 <= numbers[0] <= MOST_SEEDS:
            raise CaseError("--seeds", text, allowed)
        return tuple(range(1, numbers[0] + 1))
    if len(set(numbers)) < len(numbers) or max(numbers) >= 2**63:
        raise CaseError("--seeds", text, allowed)
    return tuple(numbers)


def list_runs(mine: "Study", plan: "Plan", out: Path, jobs: int, again: bool) -> None:
    """Print every run of a study with one part, and what all of them cost."""
    (name,) = mine.parts
    tasks = dict.fromkeys(mine.part(name).tasks(plan))
    print_listed(("name",), {(one.label,): [one] for one in tasks}, plan, out, jobs, again)


def print_listed(
    heads: Sequence[str],
    named: "Mapping[tuple[str, ...], Sequence[Task]]",
    plan: "Plan",
    out: Path,
    jobs: int,
    again: bool,
) -> None:
    """Print how many runs and minutes stand behind some words, and what all runs cost."""
    from ryusa.study import estimate_cost
    from ryusa.study.printed_table import PrintedTable

    each = {words: list(dict.fromkeys(tasks)) for words, tasks in named.items()}
    rows = [
        (*words, str(len(tasks)), f"{sum(one.cost() for one in tasks) / 60.0:.1f}" if tasks else "-")
        for words, tasks in each.items()
    ]
    print_table(PrintedTable((*heads, "runs", "core minutes"), rows, frozenset(heads)))
    every = [one for tasks in each.values() for one in tasks]
    typer.echo(f"{plan.level}: {estimate_cost(every, out / 'runs', jobs=jobs, again=again)}")


def numbers_table() -> Any:
    """Table without a frame for what was found: name, label, words."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column(no_wrap=True)
    table.add_column(max_width=20)  # a verdict with its share or its first entry is a sentence
    table.add_column(ratio=1, overflow="fold")
    return table


def print_counts(ledger: "Ledger") -> None:
    """How many findings have each verdict, and how many of these hold in most settings."""
    from ryusa.study.entry import plain_entry
    from ryusa.study.verdict_words import checks, tally

    entries = [plain_entry(ledger.study, one, ledger.folder) for one in ledger.entries]
    lines = [
        f"{n} {headline} ({settings})" if settings else f"{n} {headline}"
        for _, headline, n, settings in tally(entries, ledger.study.said)
    ]
    typer.echo("; ".join(filter(None, [*lines, checks(entries)])))


def find_studies() -> None:
    """Make `ryusa_studies` importable: as installed, or from the checkout that holds this package.

    Raises
    ------
    ResultsError : it is in neither.
    """
    import sys
    from importlib.util import find_spec

    import ryusa
    from ryusa.errors import ResultsError

    if find_spec("ryusa_studies") is None:
        beside = Path(ryusa.__file__).resolve().parents[2] / "studies"
        if not (beside / "ryusa_studies").is_dir():
            raise ResultsError(
                "the paper and the validation are not installed: pip install ./studies in a checkout of ryusa"
            )
        sys.path.append(str(beside))  # processes that carry out runs are given the same path


def executor_at(on: str, jobs: int | None) -> "RunExecutor":
    """Executor of the options `--on` and `-j`; all cores of this machine if the latter is not given."""
    from ryusa.study.executors import executor_of

    return executor_of(on, jobs or (cores() if on == DEFAULT else None))


def cores() -> int:
    """Cores that this process may use."""
    import os

    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def console() -> Any:
    """A console of fixed width where the output is no terminal."""
    from rich.console import Console

    found = Console(highlight=False)
    return found if found.is_terminal else Console(width=WIDE, highlight=False)


def print_table(table: "PrintedTable", title: str = "") -> None:
    """Print a table; columns of words begin at the left."""
    from rich import box
    from rich.markup import escape
    from rich.table import Table

    shown = Table(box=box.SIMPLE_HEAD, pad_edge=False, title=title or None, title_justify="left")
    for head in table.heads:
        shown.add_column(escape(head), justify="left" if head in table.words else "right", overflow="fold")
    for row in table.rows:
        shown.add_row(*(escape(one if isinstance(one, str) else one.text) for one in row))
    console().print(shown)


@contextmanager
def writing(out: Path) -> Generator[None]:
    """Within the block an interrupt says how to continue and leaves; what cannot be written is an error."""
    from ryusa.errors import ResultsError

    try:
        yield
    except KeyboardInterrupt:
        typer.echo(
            f"interrupted; finished runs are kept in {out}. The same command continues there", err=True
        )
        raise typer.Exit(INTERRUPTED) from None
    except OSError as error:
        raise ResultsError(f"{out}: cannot be written ({error.strerror or error})") from None


def report_failures(
    problems: Mapping[str, str], faults: Mapping[str, str], traces: Mapping[str, str], log: Path
) -> None:
    """Name on stderr what went wrong, and leave where anything did."""
    _report(problems, "run could not be carried out or measured", "runs could not be carried out or measured")
    _report(faults, "step after the runs failed", "steps after the runs failed")
    if traces:
        typer.echo(
            f"errors in the program, not in the case: {log} holds their tracebacks. What was "
            "finished is kept; once the error is repaired, the same command repeats only what failed",
            err=True,
        )
        raise typer.Exit(BROKEN)
    if problems or faults:
        raise typer.Exit(FAILED)


def _report(found: Mapping[str, str], one: str, many: str) -> None:
    """List what went wrong, on stderr."""
    if found:
        typer.echo(f"{len(found)} {one if len(found) == 1 else many}:", err=True)
    for what, reason in found.items():
        typer.echo(f"  {what}: {reason}", err=True)
