"""Options of `ryusa measure` and `ryusa draw`: those that were typed, checked, as keywords of a function."""

from collections.abc import Callable
from difflib import get_close_matches
from inspect import cleandoc
from typing import TYPE_CHECKING, Any, TypeVar

import typer

from ryusa.catalogue import OPTION_NAMES, MeasureEntry, PictureEntry, option
from ryusa.cli.options import grains_of, known, metres, need_settled, seconds, within
from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.results import Results

Entry = TypeVar("Entry", MeasureEntry, PictureEntry)

ALWAYS = {"run", "what", "csv", "output"}  # arguments, and options that every measure or every picture takes
COLOURS = ("speed", "spin", "none")
SIDES = ("right", "left")


def entry_of(what: str, entries: tuple[Entry, ...], key: str) -> Entry:
    """The entry of that name, or an error that names the nearest."""
    known(what, tuple(one.name for one in entries), key)
    return next(one for one in entries if one.name == what)


def taking(keyword: str, entries: tuple[Entry, ...]) -> str:
    """Names of the entries that take an option, for its help."""
    return ", ".join(one.name for one in entries if option(keyword) in one.given_as)


def listed(text: str, entries: tuple[Entry, ...]) -> str:
    """The help of a command, with a line for each entry."""
    lines = [f"{one.name:<12} {one.doc}" for one in entries]
    return "\n\n".join([cleandoc(text), "\b\n" + "\n".join(lines)])


def keywords(
    context: typer.Context, entry: MeasureEntry | PictureEntry, results: "Results"
) -> dict[str, Any]:
    """Keywords for the function of an entry, from the options that were typed.

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
            raise CaseError(name, value, _taken(entry), _nearest(name, entry))
    given = {name: _checked(name, value, results) for name, value in typed.items()}
    settle = given.get("--settle")
    if settle is not None and "settle" not in entry.options:
        del given["--settle"]
        given.setdefault("--begin", settle)
    if entry.settled and settle is None and "--begin" not in given:
        remedy = next((name for name in ("--begin", "--settle") if name in entry.given_as), None)
        need_settled(results, f"{remedy} 0s shows what is there" if remedy else "all of it lies after that")
    short = {name: keyword for keyword, name in OPTION_NAMES.items()}
    return {short.get(name, name.removeprefix("--")): value for name, value in given.items()}


def _was_typed(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _taken(entry: MeasureEntry | PictureEntry) -> str:
    options = ", ".join(entry.given_as)
    return (
        f"{entry.name} does not take it; it takes {options}" if options else f"{entry.name} takes no options"
    )


def _nearest(name: str, entry: MeasureEntry | PictureEntry) -> str | None:
    near = get_close_matches(name, entry.given_as, 1, cutoff=0.8)
    return near[0] if near else None


def _checked(name: str, value: Any, results: "Results") -> Any:
    """The value of an option in SI units, within its range."""
    check = _CHECKS[name]
    return check(name, value, results)


def _within(low: float, high: float) -> Callable[[str, Any, "Results"], float]:
    def check(name: str, value: Any, _results: "Results") -> float:
        within(name, value, low, high)
        return float(value)

    return check


def _one_of(words: tuple[str, ...]) -> Callable[[str, Any, "Results"], str]:
    return lambda name, value, _results: known(value, words, name)


def _window(name: str, value: Any, _results: "Results") -> float:
    found = seconds(value) or 0.0
    within(name, found, 1.0e-9, 1.0e9)
    return found


def _length(name: str, value: Any, results: "Results") -> float:
    found = metres(value) or 0.0
    within(name, found, float(results.scene.d[0]), 1.0e6)
    return found


def _seconds(_name: str, value: Any, _results: "Results") -> Any:
    return seconds(value)


def _metres(_name: str, value: Any, _results: "Results") -> Any:
    return metres(value)


_CHECKS: dict[str, Callable[[str, Any, "Results"], Any]] = {
    "--at": _seconds,
    "--begin": _seconds,
    "--colour": _one_of(COLOURS),
    "--end": _seconds,
    "--exaggeration": _within(0.1, 100.0),
    "--grain": lambda _name, value, results: grains_of(value, results),
    "--lane": lambda _name, value, _results: value,
    "--layer": _within(0.01, 100.0),
    "--length": _length,
    "--rise": _within(0.0, 100.0),
    "--settle": _seconds,
    "--side": _one_of(SIDES),
    "--threshold": _metres,
    "--window": _window,
}
