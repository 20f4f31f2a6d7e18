"""`ryusa draw`: pictures of a run folder, their numbers beside them."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, cast

import typer

from ryusa.cli.options import (
    end_of,
    grains_of,
    known,
    metres,
    need,
    need_settled,
    open_run,
    seconds,
    within,
    write_rows,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ryusa.results import Results

    Drawn = tuple[Figure, list[dict[str, object]]]

PICTURES = (
    "grains",
    "tracks",
    "spin",
    "energy",
    "contacts",
    "hops",
    "profile",
    "water",
    "transport",
    "surface",
    "vibration",
)
COLOURS = ("speed", "spin", "none")
SIDES = ("right", "left")


@dataclass(frozen=True)
class Wanted:
    """What the options ask for, checked; None where the picture chooses."""

    grains: list[int] | None
    begin: float | None  # [s]
    end: float | None  # [s]
    length: float | None  # [m]
    exaggeration: float
    at: float | None  # [s]
    colour: Literal["speed", "spin", "none"]
    lane: int | None
    side: Literal["right", "left"]


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("draw")(draw)


def draw(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    what: Annotated[str, typer.Argument(help=f"One of {', '.join(PICTURES)}.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="PNG, SVG or PDF; default WHAT.png here, with SVG and CSV."),
    ] = None,
    grain: Annotated[
        list[int] | None,
        typer.Option(
            help="tracks, spin, vibration: only this grain; may be repeated. tracks: default the first, of "
            "many the one that goes farthest."
        ),
    ] = None,
    begin: Annotated[
        str | None,
        typer.Option(
            help="tracks, profile, water, transport, vibration: from this time on; default after settling."
        ),
    ] = None,
    end: Annotated[
        str | None, typer.Option(help="tracks, profile, water, transport, vibration: up to this time.")
    ] = None,
    length: Annotated[str | None, typer.Option(help="tracks: way shown, such as 20cm.")] = None,
    exaggeration: Annotated[float, typer.Option(help="tracks: heights drawn this many times larger.")] = 1.0,
    at: Annotated[str | None, typer.Option(help="grains, surface: the moment; default the last.")] = None,
    colour: Annotated[str, typer.Option(help=f"grains: by {', '.join(COLOURS)}.")] = "speed",
    lane: Annotated[
        int | None,
        typer.Option(help="grains, surface: copy of a plane scene; default grain 0's."),
    ] = None,
    side: Annotated[str, typer.Option(help="surface: right or left slope of a heap.")] = "right",
) -> None:
    """Draw a picture of a run, and write the numbers in it as CSV beside it."""
    results = open_run(run)
    known(what, PICTURES, "draw")
    within("--exaggeration", exaggeration, 0.1, 100.0)
    shown = metres(length)
    if shown is not None:
        within("--length", shown, float(results.scene.d[0]), 1.0e6)
    wanted = Wanted(
        grains=grains_of(grain, results),
        begin=seconds(begin),
        end=seconds(end),
        length=shown,
        exaggeration=exaggeration,
        at=seconds(at),
        colour=cast(Literal["speed", "spin", "none"], known(colour, COLOURS, "--colour")),
        lane=lane,
        side=cast(Literal["right", "left"], known(side, SIDES, "--side")),
    )
    figure, rows = _picture(what, results, wanted)
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


def _picture(what: str, results: "Results", wanted: Wanted) -> "Drawn":
    draws = {
        "grains": _grains,
        "surface": _surface,
        "vibration": _vibration,
        "tracks": _tracks,
        "profile": _profile,
        "water": _water,
        "transport": _transport,
        "hops": _hops,
        "contacts": _contacts,
    }
    if what in draws:
        return draws[what](results, wanted)
    from ryusa import figures, measure

    if what == "spin":
        spins = measure.spin(results)
        need(len(spins.t) > 1, results, "two frames")
        return figures.spin(spins, wanted.grains, wanted.length), spins.samples()
    account = measure.energy(results)
    need(len(account.t) > 1, results, "two frames")
    return figures.energy(account), account.rows()


def _grains(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    seen = measure.snapshot(results, wanted.at, wanted.lane)
    return figures.snapshot(seen, wanted.colour), seen.rows()


def _surface(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    found = measure.surface(results, wanted.at, wanted.side, lane=wanted.lane)
    return figures.surface(measure.snapshot(results, wanted.at, wanted.lane), found), found.samples()


def _vibration(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    begin = float("-inf") if wanted.begin is None else wanted.begin
    end = float("inf") if wanted.end is None else wanted.end
    found = measure.vibration(results, begin=begin, end=end)
    return figures.vibration(found, wanted.grains or found.most_restless(2)), found.rows()


def _tracks(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure
    from ryusa.measure._run import settle_time

    begin = settle_time(results) if wanted.begin is None else wanted.begin
    end = float("inf") if wanted.end is None else wanted.end
    chosen = wanted.grains
    if chosen is None:
        chosen = [measure.farthest(results, begin, end) if _many(results) else 0]
    paths = measure.tracks(results, chosen, begin, end)
    if len(paths.t) < 2 and wanted.begin is None:
        need_settled(results, "say --begin 0s to see what is there")
    need(len(paths.t) > 1, results, f"two frames from t = {begin:g} s to {end_of(results, end):.3g} s")
    figure = figures.tracks(
        paths,
        exaggeration=wanted.exaggeration,
        length=wanted.length,
        around=measure.snapshot(results, float(paths.t[-1])),
    )
    return figure, paths.rows()


def _many(results: "Results") -> bool:
    """Whether grains lie on each other, so that the first of them says little."""
    return results.case.get("build", {}).get("kind") not in {"saltation", "drop"}


def _profile(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    if wanted.begin is None:
        need_settled(results, "say --begin 0s to see what is there")
    end = end_of(results) if wanted.end is None else wanted.end
    layers = measure.profiles(results, wanted.begin, end, bed=True)
    return figures.profiles({results.folder.name: layers}), layers.rows()


def _water(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    if wanted.begin is None:
        need_settled(results, "say --begin 0s to see what is there")
    found = measure.water(results, wanted.begin, end_of(results) if wanted.end is None else wanted.end)
    return figures.water(found), found.rows()


def _transport(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    if wanted.begin is None:
        need_settled(results, "say --begin 0s to see what is there")
    found = measure.transport(results, wanted.begin, end_of(results) if wanted.end is None else wanted.end)
    lines = [figures.Formula(*one) for one in measure.classical(results, found)]
    return figures.transport_of_run(found, lines, results.folder.name), found.rows()


def _hops(results: "Results", wanted: Wanted) -> "Drawn":
    from ryusa import figures, measure

    need_settled(results, "hops are measured after it")
    hops = measure.saltation(results)
    need(len(hops.hops) > 0, results, "hops over fixed grains after the settling time")
    drawn = figures.hops({results.folder.name: hops}, float(results.scene.d[0]))
    return drawn, measure.rows_of(hops.hops)


def _contacts(results: "Results", wanted: Wanted) -> "Drawn":
    """Contact times of hops over the bed, or else of all contacts."""
    from ryusa import figures, measure

    need_settled(results, "contacts are measured after it")
    hops = measure.saltation(results)
    if len(hops.hops):
        return figures.contact_times(hops), [{"contact_time_s": float(t)} for t in hops.contact_time]
    found = measure.collisions(results)
    need(len(found.events) > 0, results, "contacts that ended after the settling time (record.events)")
    return figures.collision_times(found, results.scene), measure.rows_of(found.events)
