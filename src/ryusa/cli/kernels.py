"""`ryusa kernels` and `ryusa warm`: what is kept of compiled code, and compiling ahead."""

import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.cases import FOLDERS, case_files
from ryusa.cli.run import Threads
from ryusa.spelling import known_word

if TYPE_CHECKING:
    from ryusa.compiled.store import Kept, Store

_WIDE = 160  # columns of a table that is written to a file or pipe
_MB = 2**20  # bytes
_OTHER = "functions built into these"


def register(app: typer.Typer) -> None:
    """Put the commands of this module on the app."""
    for command in (kernels, warm):
        app.command()(command)


def kernels(
    action: Annotated[
        str | None,
        typer.Argument(metavar="ACTION", help="clear: remove all code that is kept for this user."),
    ] = None,
) -> None:
    """List the code that is kept of compiled functions: what it does, its size, what it took to compile.

    A run compiles each function that it needs once for this processor, and keeps it for all that follow.
    Code that was not used for 90 days is removed, and beyond 512 MiB what was not used for longest.
    """
    from ryusa.compiled import store, tiers

    if action is not None:
        known_word(action, ("clear",), "ACTION")
        typer.echo(_cleared(store.own()))
        return
    for k, tier in enumerate(tiers.in_order()):
        if k:
            typer.echo()
        _print(tier)


def warm(
    cases: Annotated[
        list[str],
        typer.Argument(
            metavar="CASE...",
            help="Case files, or names of packaged cases as `ryusa new` lists them.",
            show_default=False,
        ),
    ],
    threads: Threads = 1,
    native: Annotated[
        bool,
        typer.Option(
            "--native",
            help="Compile for this very processor even where code that comes with the package would do.",
        ),
    ] = False,
) -> None:
    """Compile ahead what runs of these cases compile, so that they start at once.

    Each case is begun in a temporary folder and left after a few steps; no run folder stays.
    """
    if native:
        os.environ["RYUSA_KERNELS"] = "native"
    paths = [_path_of(one) for one in cases]
    from ryusa.running.warm import warm as compile_ahead

    for name, path in zip(cases, paths, strict=True):
        done = compile_ahead(path, threads=threads)
        said = (
            f"compiled {done.functions} functions in {done.wall:.1f} s"
            if done.functions
            else ("already compiled")
        )
        typer.echo(f"{name}: {said}")


def _cleared(own: "Store") -> str:
    """Remove all that a store holds; what was removed."""
    files, size = own.size()
    gone = own.clear()
    if gone < files:
        from ryusa.errors import RyusaError

        raise RyusaError(f"{own.folder}: {files - gone} of {files} files cannot be removed; the others are")
    return f"{own.folder}: {gone} files removed, {size / _MB:.1f} MiB"


def _path_of(case: str) -> Path:
    """The case file of a path, or of the name of a packaged case."""
    if Path(case).suffix or Path(case).is_file():
        return Path(case)
    known = {name: path for folder in FOLDERS for name, path in case_files(folder).items()}
    if case not in known:
        from ryusa.errors import CaseError
        from ryusa.spelling import nearest_word

        raise CaseError(
            "CASE", case, "must be a case file or a packaged case, as `ryusa new` lists them",
            nearest_word(case, list(known)),
        )  # fmt: skip
    return known[case]


def _print(tier: "Store") -> None:
    """Print what one store holds, by function that is not built into another."""
    from rich import box
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from ryusa.running.compiling import words_of

    groups: dict[tuple[str, str], list[Kept]] = {}
    for one in tier.listed():
        name = _OTHER if one.about["kind"] == "inner" else one.about["name"]
        groups.setdefault((one.about["processor"], name), []).append(one)
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("what", "function", "types", "kB", "seconds", "last used", "processor"):
        right = heading in {"types", "kB", "seconds"}
        table.add_column(heading, justify="right" if right else "left", overflow="fold")
    order = sorted(groups, key=lambda one: (one[0], one[1] == _OTHER, -_seconds(groups[one])))
    for processor, name in order:
        some = groups[processor, name]
        table.add_row(
            *((name, "") if name == _OTHER else (words_of(name), escape(name.removeprefix("ryusa.")))),
            str(len(some)), f"{_size(some) * _MB / 1e3:.0f}", f"{_seconds(some):.1f}",
            time.strftime("%Y-%m-%d", time.localtime(max(one.used for one in some))), processor,
        )  # fmt: skip
    console = Console()
    if not console.is_terminal:
        console = Console(width=_WIDE)
    if groups:
        console.print(table)
    every = [one for some in groups.values() for one in some]
    kind = "" if tier.writable else ", only read"
    typer.echo(f"{tier.folder}{kind}: {len(every)} functions, {_size(every):.1f} MiB, ", nl=False)
    typer.echo(f"compiled in {_seconds(every):.0f} s of processor time")
    if tier.trouble:
        typer.echo(f"warning: {tier.trouble}")


def _size(some: list["Kept"]) -> float:
    return sum(one.size for one in some) / _MB


def _seconds(some: list["Kept"]) -> float:
    return sum(one.about["seconds"] for one in some)
