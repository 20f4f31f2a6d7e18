"""`ryusa report`: one page about one run or several."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.options import Browser, Quiet, open_run, page_file, page_size, write_page


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
    browser: Browser = False,
    quiet: Quiet = False,
) -> None:
    """Write one page about a run: its case, state, energy account, measures, pictures and grains in motion.

    Several runs are put side by side, with a table of what differs between their cases.
    """  # fmt: skip
    from ryusa.cli.progress import shown_progress
    from ryusa.report.page import report_page
    from ryusa.results import schema

    path = page_file(output or (runs[0] / schema.REPORT if len(runs) == 1 else Path(schema.REPORT)))
    largest = page_size(size, len(runs))
    opened = [open_run(one) for one in runs]
    with shown_progress("report", quiet=quiet) as progress:
        page = report_page(opened, size=largest, progress=progress)
    write_page(page, path, browser)
