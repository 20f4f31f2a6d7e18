"""Options of `ryusa measure` and `ryusa draw`: those that were typed, checked, as keywords of a function."""

import math
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from inspect import cleandoc
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from ryusa.catalogue import BEDS, OPTION_NAMES, MeasureEntry, PictureEntry, option
from ryusa.cli.options import in_unit, need_settled, within
from ryusa.errors import CaseError, ResultsError
from ryusa.spelling import known_word, nearest_word

if TYPE_CHECKING:
    from ryusa.results import Results

Check = Callable[[str, Any, "Results"], Any]  # option, value as typed and the run -> value in SI units
Entry = TypeVar("Entry", MeasureEntry, PictureEntry)

ALWAYS = {
    "run",
    "runs",
    "what",
    "csv",
    "series",
    "layers",
    "json",
    "output",
}  # arguments, and options that every measure or every picture takes
HELP_WIDTH = 78  # of a terminal of 80 columns
OF_ROW = {  # help of the options that measures and pictures of a row of columns share
    "bed": f"what ends the bed, {' grains or those at '.join(BEDS)}.",
    "dam": "name of the dam behind which grains are stored; default the one farthest "
    "upstream, or the whole row.",
    "reach": "another reach, such as '0.5 m to 2 m', instead of that behind a dam.",
}


def refuse_swapped(
    command: str, run: Path, what: Sequence[str], entries: Sequence[MeasureEntry] | Sequence[PictureEntry]
) -> None:
    """Say that the run comes first, where it was given after what is asked of it.

    Raises
    ------
    CaseError : `run` is the name of an entry and no folder, and one of `what` is a folder.
    """
    folders = [one for one in what if Path(one).is_dir()]
    if folders and str(run) in {one.name for one in entries} and not run.is_dir():
        asked = " ".join([str(run), *(one for one in what if one not in folders)])
        raise CaseError(command, None, f"the run comes first: ryusa {command} {folders[0]} {asked}")


def entry_of(what: str, entries: tuple[Entry, ...], key: str) -> Entry:
    """The entry of that name, or an error that names the nearest."""
    known_word(what, tuple(one.name for one in entries), key)
    return next(one for one in entries if one.name == what)


def taking(keyword: str, entries: tuple[Entry, ...]) -> str:
    """Names of the entries that take an option, for its help."""
    return ", ".join(one.name for one in entries if option(keyword) in one.given_as)


def of_row(keyword: str, entries: tuple[Entry, ...]) -> Any:
    """The option of a keyword of `OF_ROW`, whose help names the entries that take it."""
    return typer.Option(help=f"{taking(keyword, entries)}: {OF_ROW[keyword]}")


def listed(text: str, entries: tuple[Entry, ...]) -> str:
    """The help of a command, with a line or two for each entry."""
    wide = max(len(one.name) for one in entries) + 2
    lines = [
        fill(one.doc, HELP_WIDTH, initial_indent=one.name.ljust(wide), subsequent_indent=" " * wide)
        for one in entries
    ]
    return "\n\n".join([cleandoc(text), "\b\n" + "\n".join(lines)])


def keywords(
    context: typer.Context,
    entry: MeasureEntry | PictureEntry,
    results: "Results",
    checks: Mapping[str, Check],
) -> dict[str, Any]:
    """Keywords for the function of an entry, from the options that were typed; each passes its check.

    An option that the entry does not take is an error, so that none is silently ignored. An entry that covers
    what follows `record.settle` needs a run that lasted longer, unless --settle or --begin say otherwise.
    """
    typed = {
        f"--{name}": value
        for name, value in context.params.items()
        if name not in ALWAYS and _was_typed(context, name)
    }
    for name, value in typed.items():
        if name not in entry.given_as:
            raise CaseError(name, value, _taken(entry), nearest_word(name, entry.given_as))
    given = {name: checks[name](name, value, results) for name, value in typed.items()}
    _refuse_window(typed, given, results)
    settle = given.get("--settle")
    if settle is not None and "settle" not in entry.options:
        del given["--settle"]
        given.setdefault("--begin", settle)
    if entry.settled and settle is None and "--begin" not in given:
        remedy = next((name for name in ("--begin", "--settle") if name in entry.given_as), None)
        need_settled(results, f"{remedy} 0s shows what is there" if remedy else "all of it lies after that")
    short = {name: keyword for keyword, name in OPTION_NAMES.items()}
    return {short.get(name, name.removeprefix("--")): value for name, value in given.items()}


def _refuse_window(typed: Mapping[str, Any], given: Mapping[str, Any], results: "Results") -> None:
    """Refuse a window after the last frame, or one that ends before it begins."""
    t = results.frames.t
    if "--begin" in given and len(t) and given["--begin"] > t[-1]:
        held = f"lies after the last frame; the run holds {t[0]:.3g} .. {t[-1]:.3g} s"
        raise CaseError("--begin", typed["--begin"], held)
    if "--end" in given and given.get("--begin", -math.inf) > given["--end"]:
        raise CaseError("--begin", typed["--begin"], f"must lie before --end, {typed['--end']}")


@contextmanager
def naming(results: "Results", name: str) -> Generator[None]:
    """Within the block an error of a run that cannot be measured or drawn names both."""
    try:
        yield
    except ResultsError as error:
        if str(results.folder) in str(error):
            raise
        raise ResultsError(f"{results.folder}: {name}: {error}") from None


def _was_typed(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _taken(entry: MeasureEntry | PictureEntry) -> str:
    options = ", ".join(entry.given_as)
    return (
        f"{entry.name} does not take it; it takes {options}" if options else f"{entry.name} takes no options"
    )


def in_range(low: float, high: float) -> Check:
    """A number from low to high."""

    def check(name: str, value: Any, _results: "Results") -> float:
        within(name, value, low, high)
        return float(value)

    return check


def one_of(words: tuple[str, ...]) -> Check:
    """One of some words."""
    return lambda name, value, _results: known_word(value, words, name)


def time(name: str, value: Any, _results: "Results") -> float:
    """A time with its unit [s]."""
    return in_unit(value, "s", name)


def window(name: str, value: Any, _results: "Results") -> float:
    """Length of a window or of an average with its unit [s]."""
    found = in_unit(value, "s", name)
    within(name, found, 1.0e-9, 1.0e9, value)
    return found


def length(name: str, value: Any, _results: "Results") -> float:
    """A length with its unit [m]."""
    return in_unit(value, "m", name)


def reach(name: str, value: Any, _results: "Results") -> tuple[float, float]:
    """Two places along x with their units, such as "0.5 m to 2 m" [m]."""
    from ryusa.units import UnitError, span

    try:
        return span(str(value), "m")
    except UnitError as error:
        raise CaseError(name, str(value), str(error)) from None
