"""`ryusa paper`: rebuild figures of the paper and set its sentences against what comes out."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from ryusa.casefile.schema import Case
    from ryusa.experiments import Experiment, Outcome, Verdict

_INTERRUPTED = 130  # exit code after Ctrl-C
_WIDE = 160  # columns of a table that goes to a file or pipe
_SETTINGS = ("phi", "k_s/k_n", "slip rule", "rotation")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(paper)


def paper(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[NAME]...", help="Experiments, such as fig07 or fig7; without any, a list."),
    ] = None,
    out: Annotated[
        Path,
        typer.Option("-o", "--out", metavar="FOLDER", help="Each experiment gets its own folder in here."),
    ] = Path("runs/paper"),
    threads: Annotated[
        int, typer.Option("--threads", metavar="N", min=1, help="Threads; the numbers do not depend on it.")
    ] = 1,
    again: Annotated[
        bool, typer.Option("--again", help="Run anew what was finished there; else it is opened.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="No progress while running.")] = False,
) -> None:
    """Rebuild figures of the paper; say where it agrees and where it does not."""
    if not names:
        _list()
        return
    chosen = [_known(name) for name in names]  # all of them before anything runs
    from ryusa.errors import ResultsError
    from ryusa.experiments import load, run_experiment

    for name in dict.fromkeys(chosen):
        experiment = load(name)
        typer.echo(f"{name}: {_sentence(experiment)}")
        for setting, values in settings(experiment).items():
            typer.echo(f"  {setting}: {values}")
        try:
            outcome = run_experiment(name, out / name, threads, progress=not quiet, again=again)
        except KeyboardInterrupt:
            typer.echo(
                f"interrupted; {out / name} holds what was finished, and is taken up from there", err=True
            )
            raise typer.Exit(_INTERRUPTED) from None
        except OSError as error:
            raise ResultsError(f"{out / name}: cannot be written ({error.strerror or error})") from None
        _print_table(outcome.table.rows(), experiment.SHOWN)
        _print_verdicts(outcome.verdicts)
        _print_files(outcome)


def settings(experiment: "Experiment") -> Mapping[str, str]:
    """Settings on which the verdicts hang, with all values that the runs of an experiment give them."""
    from ryusa.casefile.read import read
    from ryusa.experiments import case_path

    cases = [read(case_path(one.case), dict(one.overrides)) for one in experiment.cases()]
    if not cases:
        return {}
    rows = [_settings_of(case) for case in cases]
    said = {name: ", ".join(dict.fromkeys(row[k] for row in rows)) for k, name in enumerate(_SETTINGS)}
    stiffness = sorted({case.derived.k_n for case in cases})
    said["k_n"] = ", ".join(f"{k / 100.0:g}" for k in stiffness) + " N/cm"
    return said


def _settings_of(case: "Case") -> tuple[str, str, str, str]:
    import math

    found = case.derived
    phi = f"{math.degrees(math.atan(found.mu)):.3g} deg"
    ratio = found.k_s / found.k_n if found.k_n else 0.0
    slip = case.contact.slip if case.contact.cap is None else f"{case.contact.slip} by {case.contact.cap}"
    return phi, f"{ratio:.3g}", slip, case.motion.rotation


def _list() -> None:
    from rich import box
    from rich.table import Table

    from ryusa.experiments import NAMES, load

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in ("name", "figure", "what it answers", "needs"):
        table.add_column(heading, no_wrap=heading != "what it answers", justify="left")
    for name in NAMES:
        experiment = load(name)
        runs = len(experiment.cases())
        needs = f"{runs} run{'s' if runs > 1 else ''}" if runs else "nothing: a chart"
        table.add_row(name, experiment.FIGURE, _sentence(experiment), needs)
    _console().print(table)
    typer.echo("next: ryusa paper NAME")


def _sentence(experiment: "Experiment") -> str:
    """First line of what the module says about itself, without the number of the figure."""
    first = (experiment.__doc__ or experiment.TITLE).strip().splitlines()[0]
    text = re.sub(r"^Fig\. \d+: ", "", first)
    return text[0].upper() + text[1:]


def _known(word: str) -> str:
    """Name of an experiment from the paper's way of writing it: fig6, "Fig. 6", free-choices."""
    from ryusa.casefile.faults import nearest_word
    from ryusa.errors import CaseError
    from ryusa.experiments import NAMES

    plain = re.sub(r"[\s.]+", "", word.lower()).replace("-", "_")
    figure = re.fullmatch(r"(?:figure|fig)?0*(\d+)", plain)
    name = f"fig{int(figure[1]):02d}" if figure else plain
    if name in NAMES:
        return name
    raise CaseError("experiment", word, f"must be one of {', '.join(NAMES)}", nearest_word(name, list(NAMES)))


def _print_table(rows: Sequence[Mapping[str, Any]], shown: Sequence[str]) -> None:
    from rich import box
    from rich.table import Table

    if not rows or not shown:
        return
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for key in shown:
        # names of columns break at their underscores, numbers never
        heading = key.replace("_", " ")
        table.add_column(heading, justify="right" if isinstance(rows[0][key], float) else "left")
    for row in rows:
        table.add_row(*(_cell(row[key]) for key in shown))
    _console().print(table)


def _cell(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _print_verdicts(verdicts: Sequence["Verdict"]) -> None:
    """What was found, below the paper's own sentence."""
    from ryusa.paper import CLAIMS

    said = None
    for one in verdicts:
        claim = CLAIMS.get(one.claim)
        if claim is not None and claim is not said:
            typer.echo(f"  the paper, {claim.id}: {claim.says}")
            if claim.caution:
                typer.echo(f"    caution: {claim.caution}")
            said = claim
        typer.echo(f"    {one.row()['verdict']}: {one.says}")
        typer.echo(f"      found: {one.found}")


def _print_files(outcome: "Outcome") -> None:
    for path in outcome.files:
        if path.suffix in {".csv", ".png"}:
            typer.echo(f"wrote {path}")


def _console() -> Any:
    from rich.console import Console

    console = Console(highlight=False)
    return console if console.is_terminal else Console(width=_WIDE, highlight=False)
