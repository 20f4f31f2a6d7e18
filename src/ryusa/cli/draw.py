"""`ryusa draw`: pictures of a run folder, their numbers beside them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ryusa.catalogue import MEASURES, PICTURES, PictureEntry, load
from ryusa.cli import chosen
from ryusa.cli.chosen import SIDES, entry_of, keywords, listed, taking
from ryusa.cli.options import grains_of, in_unit, open_run, within, write_rows

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ryusa.results import Results


def _length(name: str, value: str, results: "Results") -> float:
    found = in_unit(value, "m", name)
    within(name, found, float(results.scene.d[0]), 1.0e6)
    return found


COLOURS = ("speed", "spin", "none")
CHECKS: dict[str, chosen.Check] = {
    "--at": chosen.time,
    "--begin": chosen.time,
    "--colour": chosen.one_of(COLOURS),
    "--end": chosen.time,
    "--exaggeration": chosen.in_range(0.1, 100.0),
    "--grain": lambda _name, value, results: grains_of(value, results),
    "--lane": lambda _name, value, _results: value,
    "--length": _length,
    "--side": chosen.one_of(SIDES),
}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("draw", help=listed(draw.__doc__ or "", PICTURES))(draw)


def draw(
    context: typer.Context,
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    what: Annotated[str, typer.Argument(help=f"One of {', '.join(one.name for one in PICTURES)}.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="PNG, SVG or PDF; default WHAT.png here, with SVG and CSV."),
    ] = None,
    grain: Annotated[
        list[int] | None,
        typer.Option(
            help=f"{taking('grains', PICTURES)}: only this grain; may be repeated. Default for tracks the "
            "first grain, in a bed the one that goes farthest; for spin all; for vibration the two that move "
            "most."
        ),
    ] = None,
    begin: Annotated[
        str | None,
        typer.Option(
            help=f"{taking('begin', PICTURES)}: begin of the window; default the end of settling, for "
            "vibration the first frame."
        ),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option(help=f"{taking('end', PICTURES)}: end of the window; default the last frame."),
    ] = None,
    length: Annotated[
        str | None,
        typer.Option(help=f"{taking('length', PICTURES)}: distance shown, such as 20cm; default all."),
    ] = None,
    exaggeration: Annotated[
        float, typer.Option(help=f"{taking('exaggeration', PICTURES)}: vertical over horizontal scale.")
    ] = 1.0,
    at: Annotated[
        str | None, typer.Option(help=f"{taking('t', PICTURES)}: time of the frame; default the last frame.")
    ] = None,
    colour: Annotated[
        str, typer.Option(help=f"{taking('colour', PICTURES)}: colour grains by {', '.join(COLOURS)}.")
    ] = "speed",
    lane: Annotated[
        int | None,
        typer.Option(
            help=f"{taking('lane', PICTURES)}: lane of a plane scene, default that of grain 0; forces in 3D: "
            "slice across y, default the middle one."
        ),
    ] = None,
    side: Annotated[
        str, typer.Option(help=f"{taking('side', PICTURES)}: slope of a heap, {' or '.join(SIDES)}.")
    ] = "right",
) -> None:
    """Draw a picture of a run, and write the numbers in it as CSV beside it.

    An option that a picture does not take is an error.
    """
    results = open_run(run)
    entry = entry_of(what, PICTURES, "draw")
    figure, rows = _drawn(entry, results, keywords(context, entry, results, CHECKS))
    from ryusa.errors import CaseError, ResultsError
    from ryusa.figures import save

    targets = [Path(f"{what}.png"), Path(f"{what}.svg")] if output is None else [output]
    for path in targets:
        if path.suffix not in {".png", ".svg", ".pdf"}:
            raise CaseError("--output", str(path), "must end in .png, .svg or .pdf")
    try:
        for path in targets:
            typer.echo(f"wrote {save(figure, path)}")
    except OSError as error:
        raise ResultsError(f"{targets[0]}: cannot be written ({error.strerror or error})") from None
    typer.echo(f"wrote {write_rows(targets[0].with_suffix('.csv'), rows)}")


def _drawn(
    entry: PictureEntry, results: "Results", given: dict[str, Any]
) -> "tuple[Figure, list[dict[str, object]]]":
    """The figure and its numbers: of the measure it names, or what its own function gives."""
    if not entry.measure:
        return load(entry.function)(results, **given)
    found = load(entry_of(entry.measure, MEASURES, "measure").function)(results, **given)
    return load(entry.function)(found), found.rows()
