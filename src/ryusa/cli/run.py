"""`ryusa new`, `check`, `run`, `resume`, `inspect`, `schema`: from a case file to a run folder."""

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
        help="Override a key of the case, such as --set 'contact.stiffness=10 N/cm'. May be repeated.",
    ),
]
Seed = Annotated[
    int | None, typer.Option("--seed", help="Override the random seed of the case.", show_default=False)
]

Threads = Annotated[
    int, typer.Option("--threads", metavar="N", help="Number of threads; the results do not depend on it.")
]
Engine = Annotated[
    str,
    typer.Option("--engine", metavar="NAME", help=f"Engine that steps the grains: {registry.summary()}."),
]
Quiet = Annotated[
    bool, typer.Option("--quiet", "-q", help="Print neither progress nor summary; warnings go to stderr.")
]
Every = Annotated[
    str, typer.Option("--checkpoint", metavar="TIME", help="Wall time between checkpoints, or 'never'.")
]
Force = Annotated[
    bool,
    typer.Option(
        "--force",
        help="Resume even if the version of ryusa, the processor or the stop rule has changed. The results "
        "are valid, but not bit for bit those of an uninterrupted run.",
    ),
]

_STOPPED = 5  # exit code after Ctrl-C or SIGTERM: `ryusa resume` continues the run
_MOST_PLACED = 100_000  # grains that `check` places at most, in half a second
_WIDE = 160  # columns of a table that is written to a file or pipe


def register(app: typer.Typer) -> None:
    """Put the commands of this module on the app."""
    for command in (new, check, run, resume, inspect, schema):
        app.command()(command)


def new(
    kind: Annotated[
        str | None,
        typer.Argument(metavar="KIND", help="Template to start from; without it, the templates are listed."),
    ] = None,
    path: Annotated[
        Path | None, typer.Argument(metavar="PATH", help="File to write; KIND.toml when not given.")
    ] = None,
) -> None:
    """Write a commented case file to start from."""
    kinds = _kinds()
    if kind is None:
        _list_by_question(kinds)
        return
    if kind not in kinds:
        from ryusa.cases.questions import OTHER_WORDS
        from ryusa.spelling import nearest_word

        near = nearest_word(kind.replace(" ", "_").replace("-", "_"), [*kinds, *OTHER_WORDS]) or ""
        allowed = f"must be one of {', '.join(kinds)}"
        raise CaseError("kind", kind, allowed, OTHER_WORDS.get(near, near) or None)
    if path is None:
        path = Path(f"{kind.rpartition('/')[2]}.toml")
    elif path.is_dir():
        path /= f"{kind.rpartition('/')[2]}.toml"
    source = case_path(f"{kind}.toml")
    try:
        with path.open("xb") as file:
            file.write(source.read_bytes())
    except FileExistsError:
        raise RyusaError(f"{path}: exists already and is not overwritten. Give another path") from None
    except OSError as error:
        raise RyusaError(f"{path}: cannot be written ({error.strerror or error})") from error
    typer.echo(f"{path} written. Next: ryusa check {path}; ryusa run {path}")


def _list_by_question(kinds: dict[str, str]) -> None:
    from ryusa.cases.questions import QUESTIONS

    for one in QUESTIONS:
        typer.echo(one.asked)
        for name in one.cases:
            typer.echo(f"  {name:<22}{kinds[name]}")
        typer.echo(f"  -> {one.answer}")
        for command in one.commands:
            typer.echo(f"     {command}")
        typer.echo()
    typer.echo("Cases of the studies, which repeat a paper or a comparison:")
    for name, title in kinds.items():
        if "/" in name:
            typer.echo(f"  {name:<22}{title}")


def check(case: CaseFile, settings: Settings = None, seed: Seed = None) -> None:
    """Check a case without running it, and print its values with everything that follows from them."""
    found = _read(case, settings, seed)
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from ryusa.build import build
    from ryusa.casefile import derive, explain
    from ryusa.casefile.wall_time import wall_time
    from ryusa.running.compiling import compiling_row
    from ryusa.running.pace import other_engines

    derived = derive(found)
    n_grain = derived.n_grain + derived.n_fixed
    built = build(found, derived) if n_grain <= _MOST_PLACED else None
    console = Console()
    if not console.is_terminal:
        console = Console(width=_WIDE)
    table = Table(title=escape(found.title) or None, box=None, padding=(0, 2, 0, 0), title_justify="left")
    for heading in ("name", "value", "where it comes from"):
        table.add_column(heading, overflow="fold", justify="left")
    section = None
    for row in [*explain(found, derived), compiling_row(found)]:
        if row.section != section:
            section = row.section
            table.add_row(f"[bold]{escape(section)}[/bold]")
        style = {"warning": "yellow", "note": "cyan"}.get(row.flag)
        mark = "warning: " if row.flag == "warning" else ""
        table.add_row(f"  {escape(row.name)}", escape(row.shown), escape(mark + row.origin), style=style)
    console.print(table)
    console.print("[bold]choices made because the case does not state them[/bold]")
    notes = (
        f"not listed for cases of more than {_MOST_PLACED:,} grains; `ryusa run` writes them to log.txt",
    )
    for note in built.notes if built is not None else notes:
        console.print(f"  {escape(note)}", highlight=False)
    if said := other_engines(None, derived.n_sphere, wall_time(found, derived), 1):
        console.print("[bold]a long run[/bold]")
        for note in said:
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
        bool,
        typer.Option("--resume", help="Continue this run where it was stopped; start it if there is none."),
    ] = False,
    force: Force = False,
    shortened: Annotated[
        str | None,
        typer.Option(
            "--try",
            metavar="TIME",
            help="Only try the case: it ends at TIME, such as '20 ms', and its timeline, feeds and settling "
            "shrink with it. The folder is runs/CASE-try, which is replaced.",
        ),
    ] = None,
) -> None:
    """Run a case and write a run folder; Ctrl-C stops the run with a checkpoint and readable data.

    SIGUSR1 requests a checkpoint. A stopped run exits with code 5; --resume or
    `ryusa resume` continues it, bit for bit as if it had not been stopped.

    `mpirun -np N ryusa run CASE --engine lammps` shares the grains among N processes.
    """
    from ryusa.running.interrupt import catch_signals

    # before anything heavy is loaded
    with catch_signals() as signal, registry.leading(engine) as leads:
        if not leads:
            return
        found = _read(case, settings, seed, shortened)
        if shortened is not None and out is None:
            out, overwrite = Path("runs") / f"{case.stem}-try", True
        from ryusa.running.runner import run as run_case

        signal.raise_if_stopped("before the first step; no run folder was created")
        results = run_case(
            found, out, threads=threads, progress=not quiet, overwrite=overwrite,
            checkpoint=_every(checkpoint), resume=resume, force=force, engine=engine,
        )  # fmt: skip
        _close(results, quiet)


def resume(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.", show_default=False)],
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Lengthen the run, such as --set 'stop.time=10 s'."),
    ] = None,
    threads: Threads = 1,
    quiet: Quiet = False,
    checkpoint: Every = "5min",
    force: Force = False,
) -> None:
    """Continue a run that was stopped or killed, bit for bit as if it had not been interrupted.

    A complete run is lengthened with a later end: --set 'stop.time=10 s'. It becomes the same, bit for bit,
    as a run that had this end from the start.
    """
    from ryusa.errors import ResultsError
    from ryusa.results import schema
    from ryusa.results.place import refuse_other
    from ryusa.results.read import read_json
    from ryusa.running.interrupt import catch_signals

    refuse_other(folder)
    origin = read_json(folder / schema.PROVENANCE)
    with catch_signals() as signal, registry.leading(str(origin.get("engine"))) as leads:
        if not leads:
            return
        from ryusa.casefile.read import read

        if not (folder / schema.CASE_TOML).is_file():
            raise ResultsError(
                f"{folder}: holds no case file; resume it in Python with ryusa.run_scene(..., resume=True)"
            )
        overrides, engine = origin.get("overrides"), origin.get("engine")
        given = {str(key): str(one) for key, one in overrides.items()} if isinstance(overrides, dict) else {}
        found = read(folder / schema.CASE_TOML, given | overrides_of(settings))
        from ryusa.running.runner import run as run_case

        signal.raise_if_stopped("before the first step; nothing was changed")
        results = run_case(
            found, folder, threads=threads, progress=not quiet, checkpoint=_every(checkpoint), resume=True,
            force=force, engine=engine if engine in registry.names() else None,
        )  # fmt: skip
        _close(results, quiet)


def inspect(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Run folder.", show_default=False)],
) -> None:
    """Report on a run: case, progress, energy account, warnings, checkpoints and the next command."""
    from ryusa.running.inspection import inspection

    for line in inspection(folder):
        typer.echo(line)


def _close(results: "Results", quiet: bool) -> None:
    folder = results.folder
    if not quiet:
        typer.echo(f"{folder}: {results.status}. To view it, open {folder / 'grains.vtkhdf'} in ParaView")
        if results.complete:
            typer.echo(f"next: ryusa measure {folder} WHAT, ryusa draw {folder} WHAT")
        else:
            typer.echo(f"next: ryusa resume {folder}")
    else:
        for warning in results.summary.get("warnings", ()):  # of the physics: nothing hides them
            typer.echo(f"warning: {warning}", err=True)
    if not results.complete:
        raise typer.Exit(_STOPPED)


def _every(text: str) -> float:
    """Wall time between two checkpoints [s]."""
    if text == "never":
        return float("inf")
    from ryusa.cli.options import in_unit

    found = in_unit(text, "s", "--checkpoint")
    if not found > 0.0:
        raise CaseError("--checkpoint", text, "must be longer than 0 s, or 'never'")
    return found


def schema() -> None:
    """Print the JSON Schema of case files, for editors."""
    from ryusa.casefile import json_schema_text

    typer.echo(json_schema_text(), nl=False)


def overrides_of(settings: list[str] | None) -> dict[str, str]:
    """Keys and values of --set."""
    overrides: dict[str, str] = {}
    for setting in settings or []:
        key, equals, value = setting.partition("=")
        if not equals or not key.strip():
            raise CaseError("--set", setting, "needs KEY=VALUE, such as --set 'contact.stiffness=10 N/cm'")
        overrides[key.strip()] = value.strip()
    return overrides


def _read(path: Path, settings: list[str] | None, seed: int | None, shortened: str | None = None) -> "Case":
    overrides = overrides_of(settings)
    if seed is not None:
        overrides["seed"] = str(seed)
    gc.disable()  # modules are loaded here: a collection frees nothing and takes a quarter of the time
    try:
        if shortened is not None:
            from ryusa.casefile.trial import read_shortened

            return read_shortened(path, overrides, shortened)
        from ryusa.casefile.read import read

        return read(path, overrides)
    finally:
        gc.freeze()
        gc.enable()


def _kinds() -> dict[str, str]:
    """Case files in the package: name (paper/fig19 for one of the paper's) and title."""
    import tomllib

    return {
        name: str(tomllib.loads(path.read_text(encoding="utf-8")).get("title", ""))
        for name, path in (case_files() | case_files("paper")).items()
    }
