"""`ryusa draw`: pictures of a run folder, their numbers beside them."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

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

PICTURES = ("tracks", "spin", "energy", "contacts", "hops", "profile")


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
        list[int] | None, typer.Option(help="tracks, spin: only this grain; may be repeated.")
    ] = None,
    begin: Annotated[
        str | None, typer.Option(help="tracks, profile: from this time on; default after settling.")
    ] = None,
    end: Annotated[str | None, typer.Option(help="tracks, profile: up to this time.")] = None,
    length: Annotated[str | None, typer.Option(help="tracks: way shown, such as 20cm.")] = None,
    exaggeration: Annotated[float, typer.Option(help="tracks: heights drawn this many times larger.")] = 1.0,
) -> None:
    """Draw a picture of a run, and write the numbers in it as CSV beside it."""
    results = open_run(run)
    known(what, PICTURES, "draw")
    within("--exaggeration", exaggeration, 0.1, 100.0)
    shown = metres(length)
    if shown is not None:
        within("--length", shown, float(results.scene.d[0]), 1.0e6)
    grains = grains_of(grain, results)
    window = seconds(begin), seconds(end)
    figure, rows = _picture(what, results, grains, window, shown, exaggeration)
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


def _picture(
    what: str,
    results: "Results",
    grains: list[int] | None,
    window: tuple[float | None, float | None],
    length: float | None,
    exaggeration: float,
) -> "tuple[Figure, list[dict[str, object]]]":
    from ryusa import figures, measure
    from ryusa.measure._run import settle_time

    if what == "tracks":
        begin = settle_time(results) if window[0] is None else window[0]
        end = float("inf") if window[1] is None else window[1]
        paths = measure.tracks(results, grains if grains is not None else [0], begin, end)
        if len(paths.t) < 2 and window[0] is None:
            need_settled(results, "say --begin 0s to see what is there")
        need(len(paths.t) > 1, results, f"two frames from t = {begin:g} s to {end_of(results, end):.3g} s")
        return figures.tracks(paths, exaggeration=exaggeration, length=length), paths.rows()
    if what == "profile":
        if window[0] is None:
            need_settled(results, "say --begin 0s to see what is there")
        layers = measure.profiles(
            results, window[0], end_of(results) if window[1] is None else window[1], bed=True
        )
        return figures.profiles({results.folder.name: layers}), layers.rows()
    if what == "spin":
        spins = measure.spin(results)
        need(len(spins.t) > 1, results, "two frames")
        return figures.spin(spins, grains, length), spins.samples()
    if what == "energy":
        account = measure.energy(results)
        need(len(account.t) > 1, results, "two frames")
        return figures.energy(account), account.rows()
    need_settled(results, "hops are measured after it")
    hops = measure.saltation(results)
    need(len(hops.hops) > 0, results, "hops over fixed grains after the settling time")
    if what == "hops":
        return figures.hops({results.folder.name: hops}, float(results.scene.d[0])), measure.rows_of(
            hops.hops
        )
    return figures.contact_times(hops), [{"contact_time_s": float(t)} for t in hops.contact_time]
