"""`ryusa new`, `check`, `run`, `schema`: from a case file to a run folder."""

import gc
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ryusa.cases import case_files, case_path
from ryusa.engine import registry
from ryusa.errors import CaseError, RyusaError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.results import Results

CaseFile = Annotated[Path, typer.Argument(metavar="CASE", help="Case file (TOML).", show_default=False)]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Change a key of the case: --set 'contact.stiffness=10 N/cm'. Repeatable.",
    ),
]
Seed = Annotated[int | None, typer.Option("--seed", help="Change the seed of the case.", show_default=False)]

Threads = Annotated[
    int, typer.Option("--threads", metavar="N", help="Threads; the numbers do not depend on it.")
]
Engine = Annotated[
    str,
    typer.Option("--engine", metavar="NAME", help=f"Engine that steps the grains: {registry.summary()}."),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress, no closing lines.")]
Every = Annotated[
    str, typer.Option("--checkpoint", metavar="TIME", help="Wall time between checkpoints; 'never' for none.")
]
Force = Annotated[
    bool,
    typer.Option(
        "--force",
        help="Go on by another version or processor, or with another stop rule: right, not the same.",
    ),
]

_STOPPED = 5  # exit code after Ctrl-C or SIGTERM: `ryusa resume` goes on
_LAID_OUT = 100_000  # grains at most that `check` lays out, in half a second
_WIDE = 160  # columns of a table that goes to a file or pipe


def register(app: typer.Typer) -> None:
    """Put the commands of this module on the app."""
    for command in (new, check, run, resume, inspect, schema):
        app.command()(command)


def new(
    kind: Annotated[
        str | None,
        typer.Argument(metavar="KIND", help="What to start from; without it, the kinds are listed."),
    ] = None,
    path: Annotated[
        Path | None, typer.Argument(metavar="PATH", help="File to write; KIND.toml when not given.")
    ] = None,
) -> None:
    """Write a commented case file to start from."""
    kinds = _kinds()
    if kind is None:
        for name, title in kinds.items():
            typer.echo(f"{name:<24}{title}")
        return
    if kind not in kinds:
        from ryusa.casefile.spelling import nearest_word

        raise CaseError("kind", kind, f"must be one of {', '.join(kinds)}", nearest_word(kind, list(kinds)))
    if path is None:
        path = Path(f"{kind.rpartition('/')[2]}.toml")
    elif path.is_dir():
        path /= f"{kind.rpartition('/')[2]}.toml"
    source = case_path(f"{kind}.toml")
    try:
        with path.open("xb") as file:
            file.write(source.read_bytes())
    except FileExistsError:
        raise RyusaError(f"{path}: is there already and is left alone. Give another path") from None
    except OSError as error:
        raise RyusaError(f"{path}: cannot be written ({error.strerror or error})") from error
    typer.echo(f"{path} written. Next: ryusa check {path}; ryusa run {path}")


def check(case: CaseFile, settings: Settings = None, seed: Seed = None) -> None:
    """Explain a case back, with everything that follows from it, without running it."""
    found = _read(case, settings, seed)
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from ryusa.build import build
    from ryusa.casefile import derive, explain

    derived = derive(found)
    n_grain = derived.n_grain + derived.n_fixed
    built = build(found, derived) if n_grain <= _LAID_OUT else None
    console = Console()
    if not console.is_terminal:
        console = Console(width=_WIDE)
    table = Table(title=escape(found.title) or None, box=None, padding=(0, 2, 0, 0), title_justify="left")
    for heading in ("name", "value", "where it comes from"):
        table.add_column(heading, overflow="fold", justify="left")
    section = None
    for row in explain(found, derived):
        if row.section != section:
            section = row.section
            table.add_row(f"[bold]{escape(section)}[/bold]")
        style = {"warning": "yellow", "note": "cyan"}.get(row.flag)
        mark = "warning: " if row.flag == "warning" else ""
        table.add_row(f"  {escape(row.name)}", escape(row.shown), escape(mark + row.origin), style=style)
    console.print(table)
    console.print("[bold]chosen because the case leaves it open[/bold]")
    notes = (f"not told for more than {_LAID_OUT} grains, which `ryusa run` lays out",)
    for note in built.notes if built is not None else notes:
        console.print(f"  {escape(note)}", highlight=False)


def run(
    case: CaseFile,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", metavar="FOLDER", help="Run folder; runs/CASE when not given."),
    ] = None,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace an earlier run in that folder.")
    ] = False,
    settings: Settings = None,
    threads: Threads = 1,
    engine: Engine = registry.DEFAULT,
    seed: Seed = None,
    quiet: Quiet = False,
    checkpoint: Every = "5min",
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on where this run stopped; begin where there is none.")
    ] = False,
    force: Force = False,
) -> None:
    """Run a case and write a run folder; Ctrl-C stops it with everything readable and a checkpoint.

    SIGUSR1 asks for a checkpoint. A stopped run leaves with 5, and --resume or
    `ryusa resume` goes on with the same bits.
    """
    from ryusa.running.interrupt import listening

    with listening() as heard:  # before anything heavy is loaded
        found = _read(case, settings, seed)
        from ryusa.running.runner import run as run_case

        heard.raise_if_asked("before the first step; no run folder was made")
        results = run_case(
            found, out, threads=threads, progress=not quiet, overwrite=overwrite,
            checkpoint=_every(checkpoint), resume=resume, force=force, engine=engine,
        )  # fmt: skip
    _close(results, quiet)


def resume(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.", show_default=False)],
    threads: Threads = 1,
    quiet: Quiet = False,
    checkpoint: Every = "5min",
    force: Force = False,
) -> None:
    """Go on with a run that was stopped or killed, bit for bit as if it never had been."""
    from ryusa.running.interrupt import listening

    with listening() as heard:
        from ryusa.casefile.read import read
        from ryusa.errors import ResultsError
        from ryusa.results import schema
        from ryusa.results.read import read_json

        if not schema.is_run_folder(folder):
            raise ResultsError(f"{folder}: no run folder of ryusa")
        if not (folder / schema.CASE_TOML).is_file():
            raise ResultsError(f"{folder}: holds no case; ryusa.run_scene(..., resume=True) goes on with it")
        origin = read_json(folder / schema.PROVENANCE)
        overrides, engine = origin.get("overrides"), origin.get("engine")
        said = {str(key): str(one) for key, one in overrides.items()} if isinstance(overrides, dict) else {}
        found = read(folder / schema.CASE_TOML, said)
        from ryusa.running.runner import run as run_case

        heard.raise_if_asked("before the first step; nothing was changed")
        results = run_case(
            found, folder, threads=threads, progress=not quiet, checkpoint=_every(checkpoint), resume=True,
            force=force, engine=engine if engine in registry.names() else None,
        )  # fmt: skip
    _close(results, quiet)


def inspect(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.", show_default=False)],
) -> None:
    """Say what ran, how far, its energy account, what to mind, and whether it is complete."""
    from ryusa.running.inspection import inspection

    for line in inspection(folder):
        typer.echo(line)


def _close(results: "Results", quiet: bool) -> None:
    folder = results.folder
    if not quiet:
        typer.echo(f"{folder}: {results.status}. Open {folder / 'grains.vtkhdf'} in ParaView")
        if results.complete:
            typer.echo(f"next: ryusa measure {folder} WHAT, ryusa draw {folder} WHAT")
        else:
            typer.echo(f"next: ryusa resume {folder}")
    if not results.complete:
        raise typer.Exit(_STOPPED)


def _every(text: str) -> float:
    """Wall time between two checkpoints [s]."""
    if text == "never":
        return float("inf")
    from ryusa.cli.options import seconds

    found = seconds(text) or 0.0
    if not found > 0.0:
        raise CaseError("--checkpoint", text, "must be longer than 0 s, or 'never'")
    return found


def schema() -> None:
    """Print the JSON Schema of case files, for editors."""
    from ryusa.casefile import json_schema_text

    typer.echo(json_schema_text(), nl=False)


def _read(path: Path, settings: list[str] | None, seed: int | None) -> "Case":
    overrides: dict[str, str] = {}
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not equals or not key.strip():
            raise CaseError("--set", setting, "needs KEY=VALUE, such as --set 'contact.stiffness=10 N/cm'")
        overrides[key.strip()] = value.strip()
    if seed is not None:
        overrides["seed"] = str(seed)
    gc.disable()  # modules are loaded here: collections free nothing and cost a quarter of an answer
    try:
        from ryusa.casefile.read import read

        return read(path, overrides)
    finally:
        gc.freeze()
        gc.enable()


def _kinds() -> dict[str, str]:
    """Case files that come with ryusa: name (paper/fig19 for one of the paper's) and title."""
    import tomllib

    return {
        name: str(tomllib.loads(path.read_text(encoding="utf-8")).get("title", ""))
        for name, path in (case_files() | case_files("paper")).items()
    }
