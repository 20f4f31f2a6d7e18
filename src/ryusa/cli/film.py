"""`ryusa film`: a run in motion, as a file for a browser, a player or slides."""

import re
from pathlib import Path
from typing import Annotated, Any, cast

import typer

from ryusa.cli.options import Begin, End, Quiet, RunFolder, open_run, times_of


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(film)


def film(
    run: RunFolder,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", metavar="FILE",
            help="A .webp, .avif, .gif or .mp4 file (MP4 needs PyAV, which ryusa's extra `film` installs); "
            "default RUN/film.webp.",
        ),
    ] = None,
    view: Annotated[
        str | None,
        typer.Option(
            metavar="VIEW",
            help="oblique, side or top, or long_section or flow_field of a row of columns; default oblique, "
            "for a plane scene side, for water alone long_section.",
        ),
    ] = None,
    colour: Annotated[
        str | None,
        typer.Option(metavar="WORD", help="Colour of grains: speed (default), height, spin, size, contacts."),
    ] = None,
    begin: Begin = None,
    end: End = None,
    speed: Annotated[
        float | None,
        typer.Option(
            metavar="FACTOR",
            help="Time of the run over that of the film: 0.1 is ten times slower than it was. Default a "
            "round number at which the film lasts about 10 s.",
        ),
    ] = None,
    frames: Annotated[
        int | None,
        typer.Option(metavar="N", help="Number of pictures, evenly spaced in time; instead of --speed."),
    ] = None,
    fps: Annotated[float, typer.Option(metavar="N", help="Pictures a second, 1 to 60.")] = 25.0,
    size: Annotated[
        str, typer.Option(metavar="WxH", help="Width and height in pixels; even numbers for MP4.")
    ] = "1280x720",
    follow: Annotated[
        int | None, typer.Option(metavar="GRAIN", help="Keep this free grain in the middle, in a ring.")
    ] = None,
    bed: Annotated[
        str | None,
        typer.Option(metavar="WORD", help="What ends the bed of a long section: packed (default) or rest."),
    ] = None,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Write a film of the grains of a run, or of its water along a row; needs no display, no graphics card.

    Scale, box and colours are the same in all pictures; the time and the speed of the film are written in
    each. Between two recorded frames grains are drawn on straight lines. A run that is still being written is
    shown as far as it has come.
    """
    from ryusa.errors import CaseError
    from ryusa.results import schema

    path = run / schema.FILM if output is None else output
    numbers = re.fullmatch(r"(\d{1,5})x(\d{1,5})", size.strip())
    if numbers is None:
        raise CaseError("--size", size, "must be width and height in pixels, such as 1280x720")
    window = times_of(begin=begin, end=end)
    results = open_run(run)
    from ryusa.cli.progress import shown_progress
    from ryusa.view.film import film as write_film

    try:
        with shown_progress("pictures", quiet=quiet) as progress:
            made = write_film(
                results, path, view=view, colour=colour, frames=frames, speed=speed, fps=fps,
                size=(int(numbers[1]), int(numbers[2])), follow=follow, bed=cast(Any, bed),
                progress=progress, **window,
            )  # fmt: skip
    except CaseError as error:  # of a parameter, which is the option of the same name
        raise CaseError(f"--{error.key}", error.value, error.allowed, error.nearest) from None
    typer.echo(
        f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB): {len(made.times)} pictures of {made.frames} "
        f"recorded frames, {made.seconds:.3g} s, {made.speed:.3g} x real time"
    )
