"""`ryusa draw`: pictures of a run folder, the numbers of each beside it."""

from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ryusa.catalogue import BEDS, MEASURES, PICTURES, QUANTITIES, SIDES, PictureEntry, called, load
from ryusa.cli import measure_options
from ryusa.cli.measure_options import entry_of, keywords, listed, naming, of_row, refuse_swapped, taking
from ryusa.cli.options import grains_of, in_unit, open_run, within, write_rows
from ryusa.errors import CaseError, ResultsError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ryusa.results import Results


def _length(name: str, value: str, results: "Results") -> float:
    found = in_unit(value, "m", name)
    within(name, found, float(results.scene.d[0]), 1.0e6, value)
    return found


MOST = 1.0e6  # bytes of a CSV that is written unasked
SUFFIXES = (".png", ".svg", ".pdf")
SAMPLE = 500  # rows from which its size is estimated
COLOURS = ("speed", "spin", "none")
CHECKS: dict[str, measure_options.Check] = {
    "--at": measure_options.time,
    "--bed": measure_options.one_of(BEDS),
    "--begin": measure_options.time,
    "--colour": measure_options.one_of(COLOURS),
    "--dam": lambda _name, value, _results: value,
    "--end": measure_options.time,
    "--exaggeration": measure_options.in_range(0.1, 100.0),
    "--grain": lambda _name, value, results: grains_of(value, results),
    "--lane": lambda _name, value, _results: value,
    "--length": _length,
    "--quantity": measure_options.one_of(QUANTITIES),
    "--reach": measure_options.reach,
    "--side": measure_options.one_of(SIDES),
    "--window": measure_options.window,
    "--wall": lambda _name, value, _results: value,
}


Output = Annotated[
    Path | None,
    typer.Option(
        "--output",
        "-o",
        metavar="PATH",
        help="A PNG, SVG or PDF file; for several pictures a folder, which gets a PNG of each. Default "
        "RUN/pictures/WHAT.png.",
    ),
]
Csv = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Write the numbers in the picture, whatever their size; default beside the picture, if they "
        "take less than 1 MB. Those of several pictures always go there.",
    ),
]
Bed = Annotated[str, of_row("bed", PICTURES)]
Dam = Annotated[str | None, of_row("dam", PICTURES)]
Reach = Annotated[str | None, of_row("reach", PICTURES)]
Quantity = Annotated[
    str | None,
    typer.Option(
        help=f"{taking('quantity', PICTURES)}: only one of {', '.join(QUANTITIES)}; default all that "
        "the run has."
    ),
]
Wall = Annotated[
    list[str] | None,
    typer.Option(
        help=f"{taking('wall', PICTURES)}: only the wall or dam of this name; may be repeated. Default all "
        "that are pushed, of more than eight, for loads four, those with the largest forces."
    ),
]
Window = Annotated[
    str | None,
    typer.Option(
        help=f"{taking('window', PICTURES)}: time over which the largest load is averaged; default that "
        "between two frames."
    ),
]


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("draw", help=listed(draw.__doc__ or "", PICTURES))(draw)


def draw(
    context: typer.Context,
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    what: Annotated[
        list[str], typer.Argument(help=f"One or more of {', '.join(one.name for one in PICTURES)}.")
    ],
    output: Output = None,
    csv: Csv = None,
    grain: Annotated[
        list[int] | None,
        typer.Option(
            help=f"{taking('grains', PICTURES)}: only this grain; may be repeated. Default for tracks the "
            "first grain, in a bed the one that goes farthest; for spin the three that "
            "travelled farthest; for vibration the two that move "
            "most."
        ),
    ] = None,
    begin: Annotated[
        str | None,
        typer.Option(
            help=f"{taking('begin', PICTURES)}: begin of the window; default the end of settling, for "
            "vibration the first frame, and for long_section one moment."
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
    bed: Bed = "packed",
    dam: Dam = None,
    reach: Reach = None,
    quantity: Quantity = None,
    wall: Wall = None,
    window: Window = None,
) -> None:
    """Draw pictures of a run, and write the numbers in each as CSV beside it.

    An option that one of them does not take is an error, and nothing is drawn.
    """
    refuse_swapped("draw", run, what, PICTURES)
    results = open_run(run)
    entries = [entry_of(one, PICTURES, "draw") for one in dict.fromkeys(what)]
    if csv is not None and len(entries) > 1:
        raise CaseError("--csv", str(csv), "names one file, for the numbers of one picture")
    paths = [_place(run, entry.name, output, alone=len(entries) == 1) for entry in entries]
    given = [keywords(context, entry, results, CHECKS) for entry in entries]
    for entry, path, options in zip(entries, paths, given, strict=True):
        with naming(results, entry.name):
            figure, rows = _drawn(entry, results, options)
        _write(figure, rows, path, csv)


def _place(run: Path, what: str, output: Path | None, alone: bool) -> Path:
    """File of a picture: `output` where it is drawn alone, else within that folder or that of the run."""
    if output is None:
        return _beside(run, what)
    if not alone:
        if output.suffix in SUFFIXES or output.is_file():
            raise CaseError("--output", str(output), "must be a folder, for several pictures are drawn")
        return output / f"{what}.png"
    if output.suffix not in SUFFIXES:
        raise CaseError("--output", str(output), "must end in .png, .svg or .pdf")
    return output


def _write(figure: "Figure", rows: list[dict[str, object]], path: Path, csv: Path | None) -> None:
    """Write a picture, and its numbers if a file was given for them or they are few."""
    from ryusa.figures import save
    from ryusa.figures.style import notes

    try:
        typer.echo(f"wrote {save(figure, path)}")
    except OSError as error:
        raise ResultsError(
            f"{path}: cannot be written ({error.strerror or error}); choose another with -o"
        ) from None
    for one in notes(figure):
        typer.echo(one)
    size = _csv_size(rows)
    if csv is None and size > MOST:
        typer.echo(f"the numbers in it take about {size / 1e6:.2g} MB: --csv FILE writes them")
    else:
        typer.echo(f"wrote {write_rows(csv or path.with_suffix('.csv'), rows)}")


def _beside(run: Path, what: str) -> Path:
    """Where the picture goes within the run folder; one from a stranger may hold links to other places."""
    from ryusa.results import schema

    path = run / schema.PICTURES / f"{what}.png"
    for one in (path.parent, path, path.with_suffix(".csv")):
        if one.is_symlink():
            raise ResultsError(f"{one}: is a link; links are not followed. Choose another file with -o")
    return path


def _csv_size(rows: list[dict[str, object]]) -> float:
    """Bytes that a table takes as CSV, from its first rows."""
    lengths = [sum(len(str(value)) + 1 for value in row.values()) for row in islice(rows, SAMPLE)]
    return sum(lengths) / max(len(lengths), 1) * len(rows)


def _drawn(
    entry: PictureEntry, results: "Results", given: dict[str, Any]
) -> "tuple[Figure, list[dict[str, object]]]":
    """The figure and its numbers: of the measure it names, or what its own function gives."""
    if not entry.measure:
        return called(entry)(results, **given)
    of_measure, own = entry.parted(given)
    found = called(entry_of(entry.measure, MEASURES, "measure"))(results, **of_measure)
    return load(entry.function)(found, **own), found.rows()
