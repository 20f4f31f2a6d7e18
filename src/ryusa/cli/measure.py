"""`ryusa measure`: numbers from a run folder."""

from pathlib import Path
from typing import Annotated

import typer

from ryusa.catalogue import MEASURES, load
from ryusa.cli import chosen
from ryusa.cli.chosen import SIDES, entry_of, keywords, listed, taking
from ryusa.cli.options import in_unit, open_run, within, write_rows

CHECKS: dict[str, chosen.Check] = {
    "--at": chosen.time,
    "--begin": chosen.time,
    "--end": chosen.time,
    "--layer": chosen.in_range(0.01, 100.0),
    "--rise": chosen.in_range(0.0, 100.0),
    "--settle": chosen.time,
    "--side": chosen.one_of(SIDES),
    "--threshold": chosen.length,
    "--window": lambda name, value, _results: _window(name, value),
}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("measure", help=listed(measure.__doc__ or "", MEASURES))(measure)


def measure(
    context: typer.Context,
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    what: Annotated[str, typer.Argument(help=f"One of {', '.join(one.name for one in MEASURES)}.")],
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the numbers to this file.")] = None,
    settle: Annotated[
        str | None,
        typer.Option(
            help=f"{taking('settle', MEASURES)}: leave out what happens before this time; default "
            "record.settle of the case."
        ),
    ] = None,
    rise: Annotated[
        float,
        typer.Option(
            help=f"{taking('rise', MEASURES)}: a flight that rises less than this, in diameters, counts as "
            "part of one bounce."
        ),
    ] = 0.1,
    begin: Annotated[
        str | None,
        typer.Option(
            help=f"{taking('begin', MEASURES)}: begin of the window; default the end of settling, "
            "for tracks and vibration the first frame."
        ),
    ] = None,
    end: Annotated[
        str | None,
        typer.Option(help=f"{taking('end', MEASURES)}: end of the window; default the last frame."),
    ] = None,
    layer: Annotated[
        float, typer.Option(help=f"{taking('layer', MEASURES)}: thickness of a layer, in mean diameters.")
    ] = 0.5,
    window: Annotated[
        str | None,
        typer.Option(
            help=f"{taking('window', MEASURES)}: length of the windows that the record is cut into; default "
            "1 s for paths, 0.01 s for vibration, 5 sqrt(d/g) for rods."
        ),
    ] = None,
    threshold: Annotated[
        str | None,
        typer.Option(
            help=f"{taking('threshold', MEASURES)}: a grain vibrates if its height varies by more than this "
            "within a window; default 0.001 mean diameters."
        ),
    ] = None,
    at: Annotated[
        str | None, typer.Option(help=f"{taking('t', MEASURES)}: time of the frame; default the last frame.")
    ] = None,
    side: Annotated[
        str, typer.Option(help=f"{taking('side', MEASURES)}: slope of a heap, {' or '.join(SIDES)}.")
    ] = "right",
) -> None:
    """Measure a run and print averages with standard errors, or a table; --csv writes the numbers.

    An average is printed with its standard error, the number of samples, the
    window in time and whether the record is steady. An option that a measure
    does not take is an error.
    """
    results = open_run(run)
    entry = entry_of(what, MEASURES, "measure")
    given = keywords(context, entry, results, CHECKS)
    printed = {name: given.pop(name) for name in entry.printing if name in given}
    found = load(entry.function)(results, **given)
    from ryusa.cli.printing import print_found

    print_found(entry.name, found, results, **printed)
    if csv is not None:
        typer.echo(f"wrote {write_rows(csv, found.rows())}")


def _window(name: str, value: str) -> float:
    found = in_unit(value, "s", name)
    within(name, found, 1.0e-9, 1.0e9)
    return found
