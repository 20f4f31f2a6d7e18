"""`ryusa view`: one HTML page with the grains of a run in motion."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.cli.options import in_unit, open_run, within


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(view)


def view(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="PAGE", help="An .html file; default RUN/view.html."),
    ] = None,
    begin: Annotated[
        str | None,
        typer.Option(metavar="TIME", help="Begin of what is shown, such as 0.5s; default the first frame."),
    ] = None,
    end: Annotated[
        str | None, typer.Option(metavar="TIME", help="End of what is shown; default the last frame.")
    ] = None,
    size: Annotated[
        str,
        typer.Option(
            metavar="SIZE",
            help="Largest size of the page. What does not fit is thinned: frames first, then grains; the "
            "page says how many it shows.",
        ),
    ] = "10 MB",
    browser: Annotated[bool, typer.Option("--open", help="Open the page in the browser.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")] = False,
) -> None:
    """Write one page that shows the grains of a run in motion: open it by a double click.

    The page holds everything itself: it needs no server, no network and no ryusa. Turn, shift and zoom with
    the mouse; colour by speed, height, spin, size or contacts; follow a grain. "?" lists the keys.
    """
    from ryusa.errors import CaseError, ResultsError
    from ryusa.results import schema
    from ryusa.view.page import LEAST_SIZE, view_page

    path = run / schema.VIEW if output is None else output
    if path.suffix not in {".html", ".htm"}:
        raise CaseError("--output", str(path), "must end in .html")
    largest = in_unit(size, "byte", "--size")
    within("--size", largest, 2.0 * LEAST_SIZE, 2.0e9)
    window = {
        name: in_unit(text, "s", f"--{name}")
        for name, text in (("begin", begin), ("end", end))
        if text is not None
    }
    results = open_run(run)
    from ryusa.cli.progress import shown_progress

    with shown_progress("frames", quiet=quiet) as progress:
        page = view_page(results, size=largest, progress=progress, **window)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None
    typer.echo(f"wrote {path} ({len(page) / 1e6:.1f} MB): open it in a browser")
    if browser:
        typer.launch(str(path.resolve()))
