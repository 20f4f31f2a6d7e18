"""`ryusa report`: one page about one run or several."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.measure_options import reach as reach_of
from ryusa.cli.options import Browser, Quiet, in_unit, open_run, page_file, page_size, write_page
from ryusa.errors import CaseError


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
            help="An .html file, of a brief also a .pdf, which needs Chromium, Chrome or Edge; default "
            "RUN/report.html or brief.html, for several runs here.",
        ),
    ] = None,
    size: Annotated[
        str,
        typer.Option(
            metavar="SIZE",
            help="Largest size of the grains in motion, of all runs together; thinned as by `view`.",
        ),
    ] = "10 MB",
    brief: Annotated[
        bool,
        typer.Option(
            "--brief",
            help="One sheet of A4 for a client: the answer with its interval over the runs, which differ in "
            "their seed alone, one picture, the conditions, what it rests on and what it does not cover.",
        ),
    ] = False,
    like: Annotated[
        str | None,
        typer.Option(
            metavar="CASE",
            help="--brief: packaged case whose question is answered, as `ryusa new` lists them; default the "
            "one that the case of the run resembles most.",
        ),
    ] = None,
    begin: Annotated[
        str | None,
        typer.Option(
            metavar="TIME",
            help="--brief: begin of the window of its averages; default record.settle of the case, of water "
            "alone the last fifth of the record.",
        ),
    ] = None,
    reach: Annotated[
        str | None,
        typer.Option(
            metavar="BEGIN to END",
            help="--brief: reach of a row in which a deposit is measured, such as '0.9 m to 1.3 m'; default "
            "from its upper end to its first dam.",
        ),
    ] = None,
    browser: Browser = False,
    quiet: Quiet = False,
) -> None:
    """Write one page about a run: its case, state, energy account, measures, pictures and grains in motion.

    Several runs are put side by side, with a table of what differs between their cases. With --brief the
    page is one sheet for a client instead.
    """  # fmt: skip
    from ryusa.cli.progress import shown_progress
    from ryusa.report.page import report_page
    from ryusa.results import schema

    name = schema.BRIEF if brief else schema.REPORT
    path = output or (runs[0] / name if len(runs) == 1 else Path(name))
    if brief:
        _brief(runs, path, like, begin, reach, browser)
        return
    for option, given in (("--like", like), ("--begin", begin), ("--reach", reach)):
        if given is not None:
            raise CaseError(option, given, "is an option of --brief")
    page_file(path)
    largest = page_size(size, len(runs))
    opened = [open_run(one) for one in runs]
    with shown_progress("report", quiet=quiet) as progress:
        page = report_page(opened, size=largest, progress=progress)
    write_page(page, path, browser)


def _brief(
    runs: list[Path], path: Path, like: str | None, begin: str | None, reach: str | None, browser: bool
) -> None:
    from ryusa.report.brief import brief_page, write_pdf

    opened = [open_run(one) for one in runs]
    since = None if begin is None else in_unit(begin, "s", "--begin")
    within = None if reach is None else reach_of("--reach", reach, opened[0])
    pdf = path.suffix == ".pdf"
    if not pdf:
        page_file(path)
    page = brief_page(opened, like=like, begin=since, reach=within)
    if not pdf:
        write_page(page, path, browser)
        return
    pages = write_pdf(page, path)
    typer.echo(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB, {pages} page{'s' * (pages != 1)})")
    if browser:
        typer.launch(str(path.resolve()))
