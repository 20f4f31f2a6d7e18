"""`ryusa view`: one HTML page with the grains of a run in motion."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.options import (
    Begin,
    Browser,
    End,
    Quiet,
    RunFolder,
    open_run,
    page_file,
    page_size,
    times_of,
    write_page,
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(view)


def view(
    run: RunFolder,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="PAGE", help="An .html file; default RUN/view.html."),
    ] = None,
    begin: Begin = None,
    end: End = None,
    size: Annotated[
        str,
        typer.Option(
            metavar="SIZE",
            help="Largest size of the page. What does not fit is thinned: frames first, then grains; the "
            "page says how many it shows.",
        ),
    ] = "10 MB",
    browser: Browser = False,
    quiet: Quiet = False,
) -> None:
    """Write one page that shows the grains of a run in motion: open it by a double click.

    The page holds everything itself: it needs no server, no network and no ryusa. Turn, shift and zoom with
    the mouse or by keys; colour by speed, height, spin, size or contacts; follow a grain. "?" lists the keys.
    """
    from ryusa.results import schema
    from ryusa.view.page import view_page

    path = page_file(output or run / schema.VIEW)
    largest = page_size(size)
    window = times_of(begin=begin, end=end)
    results = open_run(run)
    from ryusa.cli.progress import shown_progress

    with shown_progress("frames", quiet=quiet) as progress:
        page = view_page(results, size=largest, progress=progress, **window)
    write_page(page, path, browser)
