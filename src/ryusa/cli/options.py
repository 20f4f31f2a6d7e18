"""Checks of words and quantities on the command line, and of the run folder that a command reads."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ryusa.results import Results


def open_run(folder: Path) -> "Results":
    """Open a run folder."""
    from ryusa.results import Results

    return Results.open(folder)


def known(word: str, words: tuple[str, ...], key: str) -> str:
    """Return `word`, or raise an error that names the nearest of `words`."""
    if word in words:
        return word
    from difflib import get_close_matches

    from ryusa.errors import CaseError

    near = get_close_matches(word, words, 1)
    raise CaseError(key, word, f"must be one of {', '.join(words)}", near[0] if near else None)


def grains_of(grains: list[int] | None, results: "Results") -> list[int] | None:
    """Ids of the free grains given; None if none was given."""
    if not grains:
        return None
    from ryusa.errors import CaseError

    for one in grains:
        if not 0 <= one < results.scene.n_grain:
            raise CaseError("--grain", one, f"must be 0 to {results.scene.n_grain - 1}")
    return grains


def within(key: str, value: float, low: float, high: float) -> None:
    """Raise an error for an option outside its range."""
    if not low <= value <= high:
        from ryusa.errors import CaseError

        raise CaseError(key, value, f"must be {low:g} to {high:g}")


def in_unit(text: str, unit: str, key: str) -> float:
    """The number of an option that is a quantity, in an SI unit; an error names the option `key`."""
    from ryusa.errors import CaseError
    from ryusa.units import UnitError, quantity

    try:
        return quantity(text, unit)
    except UnitError as error:
        raise CaseError(key, text, str(error)) from None


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
