"""What `ryusa paper` and `ryusa validate` say in the same words."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import typer

INTERRUPTED = 130  # exit code after Ctrl-C
FAILED = 3  # exit code where some runs could not be carried out, or something not judged
BROKEN = 1  # exit code where an error in the program is behind it, as Python's own
WIDE = 100  # columns of a table that goes to a file or pipe


def cores() -> int:
    """Cores that this process may use."""
    import os

    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def console() -> Any:
    """A console of fixed width where the output is no terminal."""
    from rich.console import Console

    found = Console(highlight=False)
    return found if found.is_terminal else Console(width=WIDE, highlight=False)


def interrupted(out: Path) -> NoReturn:
    """Say how to go on, and leave."""
    typer.echo(f"interrupted; {out} holds what was finished, the same command goes on from there", err=True)
    raise typer.Exit(INTERRUPTED) from None


def tell_failures(
    problems: Mapping[str, str], faults: Mapping[str, str], traces: Mapping[str, str], log: Path
) -> None:
    """Say on stderr what went wrong, and leave where anything did."""
    _tell(problems, "run could not be carried out or measured", "runs could not be carried out or measured")
    _tell(faults, "step after the runs failed", "steps after the runs failed")
    if traces:
        typer.echo(
            f"errors in the program, not in the case: {log} holds their tracebacks. What was "
            "finished is kept; after a repair the same command needs to do only what failed",
            err=True,
        )
        raise typer.Exit(BROKEN)
    if problems or faults:
        raise typer.Exit(FAILED)


def _tell(found: Mapping[str, str], one: str, many: str) -> None:
    """List what went wrong, on stderr."""
    if found:
        typer.echo(f"{len(found)} {one if len(found) == 1 else many}:", err=True)
    for what, reason in found.items():
        typer.echo(f"  {what}: {reason}", err=True)
