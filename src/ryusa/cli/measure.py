"""`ryusa measure`: numbers from a run folder."""

import sys
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ryusa.cli.options import known, metres, need, need_settled, open_run, seconds, within, write_rows
from ryusa.cli.packing import print_stress, print_surface, print_vibration

if TYPE_CHECKING:
    from ryusa.measure import Averages, HeapSurface, Vibration
    from ryusa.results import Results

MEASURES = (
    "saltation",
    "collisions",
    "spin",
    "energy",
    "tracks",
    "profile",
    "paths",
    "rods",
    "water",
    "transport",
    "entrainment",
    "stress",
    "vibration",
    "surface",
)
FLOWS = ("profile", "paths", "rods", "water", "transport", "entrainment", "stress")


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("measure")(measure)


def measure(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    what: Annotated[str, typer.Argument(help=f"One of {', '.join(MEASURES)}.")],
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table here.")] = None,
    settle: Annotated[str | None, typer.Option(help="Look away before; default as in the case.")] = None,
    rise: Annotated[
        float, typer.Option(help="saltation: flights that rise less, in diameters, join two bounces.")
    ] = 0.1,
    begin: Annotated[
        str | None,
        typer.Option(help=f"{', '.join(FLOWS)}, vibration: from this time on; default after settling."),
    ] = None,
    end: Annotated[str | None, typer.Option(help="As for --begin: up to this time.")] = None,
    layer: Annotated[float, typer.Option(help="profile, stress: thickness of a layer, in diameters.")] = 0.5,
    window: Annotated[
        str | None,
        typer.Option(
            help="paths, vibration: time over which a way is looked at; 1 s, 0.01 s. rods: how long one "
            "must last; 5 sqrt(d/g)."
        ),
    ] = None,
    threshold: Annotated[
        str | None,
        typer.Option(help="vibration: beyond this a grain trembles; default 0.001 mean d."),
    ] = None,
    at: Annotated[str | None, typer.Option(help="surface: the moment; default the last frame.")] = None,
    side: Annotated[str, typer.Option(help="surface: right or left slope of a heap.")] = "right",
) -> None:
    """Print averages with standard error, window and steadiness; --csv keeps the numbers."""
    within("--rise", rise, 0.0, 100.0)
    within("--layer", layer, 0.01, 100.0)
    results, after = open_run(run), seconds(settle)
    known(what, MEASURES, "measure")
    if after is None and what in {"saltation", "collisions", "spin"}:
        need_settled(results, "say --settle 0s to see what is there")
    found: Any
    if what == "vibration":
        found = _vibration(results, seconds(begin), seconds(end), seconds(window))
        print_vibration(found, metres(threshold))
    elif what == "surface":
        found = _surface(results, seconds(at), known(side, ("right", "left"), "--side"))
        print_surface(found)
    elif what in FLOWS:
        found = _flow(results, what, seconds(begin) if begin else after, seconds(end), layer, seconds(window))
    else:
        found = _measured(results, what, after, rise)
    averages = getattr(found, "averages", None)
    if averages is not None:
        _print(averages)
    elif what == "energy":
        _print_energy(found)
    elif what == "stress":
        print_stress(found)
    elif what == "tracks" and csv is None:
        typer.echo(f"{len(found.t)} frames of {len(found.grains)} grains; --csv FILE writes them")
    if csv is not None:
        typer.echo(f"wrote {write_rows(csv, found.rows())}")


def _measured(results: "Results", what: str, settle: float | None, rise: float) -> Any:
    from ryusa import measure

    if what == "saltation":
        hops = measure.saltation(results, settle=settle, rise=rise)
        need(
            len(hops.hops) > 0,
            results,
            f"hops over fixed grains after t = {hops.averages.items[0].window[0]:g} s",
        )
        return hops
    if what == "collisions":
        return measure.collisions(results, settle=settle)
    if what == "spin":
        return measure.spin(results, settle=settle)
    return measure.energy(results) if what == "energy" else measure.tracks(results)


def _vibration(
    results: "Results", begin: float | None, end: float | None, window: float | None
) -> "Vibration":
    from ryusa import measure
    from ryusa.measure.vibration import WINDOW

    if window is not None:
        within("--window", window, 1.0e-9, 1.0e9)
    return measure.vibration(
        results,
        window=WINDOW if window is None else window,
        begin=float("-inf") if begin is None else begin,
        end=float("inf") if end is None else end,
    )


def _surface(results: "Results", at: float | None, side: str) -> "HeapSurface":
    from ryusa import measure

    return measure.surface(results, at, "right" if side == "right" else "left")


def _flow(
    results: "Results", what: str, begin: float | None, end: float | None, layer: float, window: float | None
) -> Any:
    from ryusa import measure

    if begin is None:
        need_settled(results, "say --begin 0s to see what is there")
    last = float("inf") if end is None else end
    if what == "profile":
        return measure.profiles(results, begin, last, layer=layer)
    if what == "stress":
        return measure.kinetic_stress(results, begin, last, layer=layer)
    if what in {"water", "transport", "entrainment"}:
        return getattr(measure, what)(results, begin, last)
    if what == "rods":
        return measure.rods(results, begin, last, window)
    return measure.paths(results, begin, last, window=1.0 if window is None else window)


def _print(averages: "Averages") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("quantity")
    for name in ("value", "± s.e.", "unit", "n", "window \\[s]", "steady?"):
        table.add_column(name, justify="left" if name in {"unit", "steady?"} else "right")
    doubtful = False
    for one in averages.items:
        if one.n == 0:
            table.add_row(one.name, "-", "-", one.unit, "0", "-", "-")
            continue
        steady = "yes" if one.steady else f"no, drift {one.drift:.1f} s.e."
        steady = "-" if isnan(one.drift) else steady
        doubt = "" if one.plateau or isnan(one.error) else "*"
        doubtful = doubtful or bool(doubt)
        window = f"{one.window[0]:.3g} .. {one.window[1]:.4g}"
        table.add_row(
            one.name, f"{one.value:.5g}", f"{one.error:.2g}{doubt}", one.unit, str(one.n), window, steady
        )
    console = Console(width=None if sys.stdout.isatty() else 120)
    console.print(table)
    if doubtful:
        console.print(
            "* the record is too short for this error to have settled: it may be larger", highlight=False
        )
    for line in averages.notes:
        console.print(line, highlight=False, soft_wrap=True)


def _print_energy(found: Any) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("term at the end of the run")
    table.add_column("energy [J]", justify="right")
    groups = (("held", found.held), ("lost to", found.lost), ("given by", found.given))
    for word, terms in groups:
        for name, values in terms.items():
            table.add_row(f"{word} {name}", f"{values[-1]:.6g}" if len(values) else "-")
    table.add_row("unexplained", f"{found.imbalance[-1]:.3g}" if len(found.imbalance) else "-")
    console = Console()
    console.print(table)
    console.print(f"largest imbalance over largest term: {found.residual:.2g}", highlight=False)
