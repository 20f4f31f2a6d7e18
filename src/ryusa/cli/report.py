"""`ryusa report`: one page about one run or several."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.options import in_unit, open_run, within


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(report)


def report(
    runs: Annotated[list[Path], typer.Argument(metavar="RUN", help="One or more run folders.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="PAGE",
            help="An .html file; default RUN/report.html, for several runs report.html here.",
        ),
    ] = None,
    size: Annotated[
        str,
        typer.Option(
            metavar="SIZE",
            help="Largest size of the grains in motion, of all runs together; thinned as by `view`.",
        ),
    ] = "10 MB",
    browser: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")] = False,
) -> None:
    """Write one page about a run: its case, state, energy account, measures, pictures and grains in motion.

    Several runs are put side by side, with a table of what differs between their cases.
    """  # fmt: skip
    from ryusa.cli.progress import shown_progress
    from ryusa.errors import CaseError, ResultsError
    from ryusa.report.page import report_page
    from ryusa.results import schema
    from ryusa.view.page import LEAST_SIZE

    path = output or (runs[0] / schema.REPORT if len(runs) == 1 else Path(schema.REPORT))
    if path.suffix not in {".html", ".htm"}:
        raise CaseError("--output", str(path), "must end in .html")
    largest = in_unit(size, "byte", "--size")
    within("--size", largest, 2.0 * LEAST_SIZE * len(runs), 2.0e9)
    opened = [open_run(one) for one in runs]
    with shown_progress("report", quiet=quiet) as progress:
        page = report_page(opened, size=largest, progress=progress)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None
    typer.echo(f"wrote {path} ({len(page) / 1e6:.1f} MB): open it in a browser")
    if browser:
        typer.launch(str(path.resolve()))
