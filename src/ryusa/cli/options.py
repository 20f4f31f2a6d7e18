"""Options that several commands take, and checks of words, quantities and run folders on the command line."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from ryusa.results import Results

RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")]
Begin = Annotated[
    str | None,
    typer.Option(metavar="TIME", help="Begin of the time shown, such as 0.5s; default the first frame."),
]
End = Annotated[
    str | None, typer.Option(metavar="TIME", help="End of the time shown; default the last frame.")
]
Browser = Annotated[bool, typer.Option("--open", help="Open the page in the browser.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")]


def open_run(folder: Path) -> "Results":
    """Open a run folder."""
    from ryusa.results import Results

    return Results.open(folder)


def grains_of(grains: list[int] | None, results: "Results") -> list[int] | None:
    """Ids of the free grains given; None if none was given."""
    if not grains:
        return None
    from ryusa.errors import CaseError

    for one in grains:
        if not 0 <= one < results.scene.n_grain:
            raise CaseError("--grain", one, f"must be 0 to {results.scene.n_grain - 1}")
    return grains


def within(key: str, value: float, low: float, high: float, typed: str = "", unit: str = "") -> None:
    """Raise an error for an option outside its range, in the words of what was `typed` with a unit."""
    if not low <= value <= high:
        from ryusa.errors import CaseError
        from ryusa.units import limit_as_typed

        least = limit_as_typed(typed, low, least=True, unit=unit)
        most = limit_as_typed(typed, high, least=False, unit=unit)
        raise CaseError(key, typed or value, f"must be {least} to {most}")


def in_unit(text: str, unit: str, key: str) -> float:
    """The number of an option that is a quantity, in an SI unit; an error names the option `key`."""
    from ryusa.errors import CaseError
    from ryusa.units import UnitError, quantity

    try:
        return quantity(text, unit)
    except UnitError as error:
        raise CaseError(key, text, str(error)) from None


def times_of(**typed: str | None) -> dict[str, float]:
    """Times [s] of those options that were typed, by the name of the option."""
    return {name: in_unit(text, "s", f"--{name}") for name, text in typed.items() if text is not None}


def page_file(path: Path) -> Path:
    """Return the path of a page, or raise an error where it is no HTML file."""
    if path.suffix not in {".html", ".htm"}:
        from ryusa.errors import CaseError

        raise CaseError("--output", str(path), "must end in .html")
    return path


def page_size(size: str, runs: int = 1) -> float:
    """Largest size of the grains in motion of some runs on one page [B]."""
    from ryusa.view.page import LEAST_SIZE

    largest = in_unit(size, "byte", "--size")
    within("--size", largest, 2.0 * LEAST_SIZE * runs, 2.0e9, size, "byte")
    return largest


def write_page(text: str, path: Path, browser: bool) -> None:
    """Write a page, name its file, and open it if asked to."""
    from ryusa.results.presentation import Page

    Page(text).save(path)
    typer.echo(f"wrote {path} ({path.stat().st_size / 1e6:.1f} MB): open it in a browser")
    if browser:
        typer.launch(str(path.resolve()))


def need(there: bool, results: "Results", what: str) -> None:
    """Raise an error for a run without the data that a measure needs."""
    if not there:
        from ryusa.errors import ResultsError

        raise ResultsError(f"{results.folder}: does not contain {what}")


def need_settled(results: "Results", what_to_do: str) -> None:
    """Raise an error for a run that ended before its settling time."""
    from ryusa.measure._run import settle_time

    settle, last = settle_time(results), end_of(results)
    if last <= settle and settle > 0.0:
        from ryusa.errors import ResultsError

        raise ResultsError(
            f"{results.folder}: {results.status}, ends at t = {last:.3g} s, before its settling time is over "
            f"(record.settle = {settle:g} s); {what_to_do}"
        )


def end_of(results: "Results", end: float = float("inf")) -> float:
    """End of a time window [s]: `end` or the last frame, whichever is earlier."""
    return min(end, float(results.frames.t[-1])) if len(results.frames) else 0.0


def write_rows(path: Path, rows: list[dict[str, object]]) -> Path:
    """Write a table as CSV."""
    from ryusa.errors import ResultsError
    from ryusa.measure import write_csv

    try:
        return write_csv(path, rows)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None
