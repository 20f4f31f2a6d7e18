"""What is not a run folder, and where the run may be that was meant."""

from itertools import chain, islice
from pathlib import Path

from ryusa.errors import ResultsError
from ryusa.results import schema

MOST = 1000  # folders looked into
SHOWN = 5  # runs that a message names


def refuse_other(path: Path) -> None:
    """Refuse what is not a run folder.

    Raises
    ------
    ResultsError : says what it is, and where its runs are, if any.
    """
    if schema.is_run_folder(path):
        return
    if path.is_file() and path.suffix == ".toml":
        own = Path("runs") / path.stem
        there = (
            f"its run is {own}" if schema.is_run_folder(own) else f"`ryusa run {path}` makes its run, {own}"
        )
        raise ResultsError(f"{path}: a case, not a run folder; {there} unless -o says otherwise")
    if path.is_file():
        raise ResultsError(f"{path}: a file, not a run folder")
    if not path.is_dir():
        raise ResultsError(f"{path}: no such run folder")
    below = islice(chain(path.glob(f"*/{schema.PROVENANCE}"), path.glob(f"*/*/{schema.PROVENANCE}")), MOST)
    runs = sorted(str(one.parent) for one in below if schema.is_run_folder(one.parent))
    if runs:
        more = f" and {len(runs) - SHOWN} more" if len(runs) > SHOWN else ""
        raise ResultsError(
            f"{path}: not a run folder of ryusa, but it holds runs: {', '.join(runs[:SHOWN])}{more}"
        )
    raise ResultsError(
        f"{path}: not a run folder of ryusa ({schema.PROVENANCE} or {schema.PARTS}/ is missing)"
    )
