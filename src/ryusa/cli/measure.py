"""`ryusa measure` and `ryusa draw`: numbers and pictures from a run folder."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ryusa.measure import Averages
    from ryusa.results import Results

MEASURES = ("saltation", "collisions", "spin", "energy", "tracks")
PICTURES = ("tracks", "spin", "energy", "contacts", "hops")


def register(app: typer.Typer) -> None:
    """Add both commands."""
    app.command("measure")(measure)
    app.command("draw")(draw)


def measure(
    run: Annotated[Path, typer.Argument(help="A run folder.")],
    what: Annotated[str, typer.Argument(help=f"One of {', '.join(MEASURES)}.")],
    csv: Annotated[Path | None, typer.Option("--csv", help="Write the table here.")] = None,
    settle: Annotated[str | None, typer.Option(help="Look away before; default as in the case.")] = None,
    rise: Annotated[
        float, typer.Option(help="saltation: flights that rise less, in diameters, join two bounces.")
    ] = 0.1,
) -> None:
    """Print averages with standard error, window and steadiness; --csv keeps the numbers."""
    _within("--rise", rise, 0.0, 100.0)
    results, begin = _open(run), _seconds(settle)
    _known(what, MEASURES, "measure")
    if begin is None and what in {"saltation", "collisions", "spin"}:
        _need_settled(results, "say --settle 0s to see what is there")
    found = _measured(results, what, begin, rise)
    averages = getattr(found, "averages", None)
    if averages is not None:
        _print(averages)
    elif what == "energy":
        _print_energy(found)
    elif csv is None:
        typer.echo(f"{len(found.t)} frames of {len(found.grains)} grains; --csv FILE writes them")
    if csv is not None:
        typer.echo(f"wrote {_csv(csv, found.rows())}")


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
        str | None, typer.Option(help="tracks: from this time on; default after settling.")
    ] = None,
    end: Annotated[str | None, typer.Option(help="tracks: up to this time.")] = None,
    length: Annotated[str | None, typer.Option(help="tracks: way shown, such as 20cm.")] = None,
    exaggeration: Annotated[float, typer.Option(help="tracks: heights drawn this many times larger.")] = 1.0,
) -> None:
    """Draw a picture of a run, and write the numbers in it as CSV beside it."""
    results = _open(run)
    _known(what, PICTURES, "draw")
    _within("--exaggeration", exaggeration, 0.1, 100.0)
    shown = _metres(length)
    if shown is not None:
        _within("--length", shown, float(results.scene.d[0]), 1.0e6)
    grains = _grains(grain, results)
    window = _seconds(begin), _seconds(end)
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
    typer.echo(f"wrote {_csv(targets[0].with_suffix('.csv'), rows)}")


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
            _need_settled(results, "say --begin 0s to see what is there")
        _need(len(paths.t) > 1, results, f"two frames from t = {begin:g} s to {_last(results, end):.3g} s")
        return figures.tracks(paths, exaggeration=exaggeration, length=length), paths.rows()
    if what == "spin":
        spins = measure.spin(results)
        _need(len(spins.t) > 1, results, "two frames")
        return figures.spin(spins, grains, length), spins.samples()
    if what == "energy":
        account = measure.energy(results)
        _need(len(account.t) > 1, results, "two frames")
        return figures.energy(account), account.rows()
    _need_settled(results, "hops are measured after it")
    hops = measure.saltation(results)
    _need(len(hops.hops) > 0, results, "hops over fixed grains after the settling time")
    if what == "hops":
        return figures.hops({results.folder.name: hops}, float(results.scene.d[0])), measure.rows_of(
            hops.hops
        )
    return figures.contact_times(hops), [{"contact_time_s": float(t)} for t in hops.contact_time]


def _measured(results: "Results", what: str, settle: float | None, rise: float) -> Any:
    from ryusa import measure

    if what == "saltation":
        return measure.saltation(results, settle=settle, rise=rise)
    if what == "collisions":
        return measure.collisions(results, settle=settle)
    if what == "spin":
        return measure.spin(results, settle=settle)
    return measure.energy(results) if what == "energy" else measure.tracks(results)


def _open(folder: Path) -> "Results":
    from ryusa.results import Results

    return Results.open(folder)


def _known(word: str, words: tuple[str, ...], key: str) -> str:
    if word in words:
        return word
    from difflib import get_close_matches

    from ryusa.errors import CaseError

    near = get_close_matches(word, words, 1)
    raise CaseError(key, word, f"must be one of {', '.join(words)}", near[0] if near else None)


def _grains(grains: list[int] | None, results: "Results") -> list[int] | None:
    if not grains:
        return None
    from ryusa.errors import CaseError

    for one in grains:
        if not 0 <= one < results.scene.n_grain:
            raise CaseError("--grain", one, f"must be 0 to {results.scene.n_grain - 1}")
    return grains


def _within(key: str, value: float, low: float, high: float) -> None:
    if not low <= value <= high:
        from ryusa.errors import CaseError

        raise CaseError(key, value, f"must be {low:g} to {high:g}")


def _seconds(text: str | None) -> float | None:
    return None if text is None else _quantity(text, "s")


def _metres(text: str | None) -> float | None:
    return None if text is None else _quantity(text, "m")


def _quantity(text: str, unit: str) -> float:
    from ryusa.errors import CaseError
    from ryusa.units import UnitError, quantity

    try:
        return quantity(text, unit)
    except UnitError as error:
        raise CaseError("option", text, str(error)) from None


def _need(there: bool, results: "Results", what: str) -> None:
    if not there:
        from ryusa.errors import ResultsError

        raise ResultsError(f"{results.folder}: does not hold {what}")


def _need_settled(results: "Results", what_to_do: str) -> None:
    from ryusa.measure._run import settle_time

    settle, last = settle_time(results), _last(results)
    if last <= settle and settle > 0.0:
        from ryusa.errors import ResultsError

        raise ResultsError(
            f"{results.folder}: {results.status}, ends at t = {last:.3g} s, before its settling time is over "
            f"(record.settle = {settle:g} s); {what_to_do}"
        )


def _last(results: "Results", end: float = float("inf")) -> float:
    """End of a window [s]: `end`, or the last frame where that comes before."""
    return min(end, float(results.frames.t[-1])) if len(results.frames) else 0.0


def _csv(path: Path, rows: list[dict[str, object]]) -> Path:
    from ryusa.errors import ResultsError
    from ryusa.measure import write_csv

    try:
        return write_csv(path, rows)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None


def _print(averages: "Averages") -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column("quantity")
    for name in ("value", "± s.e.", "unit", "n", "window [s]", "steady?"):
        table.add_column(name, justify="left" if name in {"unit", "steady?"} else "right")
    for one in averages.items:
        if one.n == 0:
            table.add_row(one.name, "-", "-", one.unit, "0", "-", "-")
            continue
        steady = "yes" if one.steady else f"no, drift {one.drift:.1f} s.e."
        steady += "" if one.plateau else " (short record)"
        window = f"{one.window[0]:.3g} .. {one.window[1]:.4g}"
        table.add_row(one.name, f"{one.value:.5g}", f"{one.error:.2g}", one.unit, str(one.n), window, steady)
    console = Console(width=None if sys.stdout.isatty() else 120)
    console.print(table)
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
