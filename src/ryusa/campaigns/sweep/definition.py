"""What a sweep is asked to vary, as a command, a TOML file or a script says it."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ryusa.campaigns.sweep.design import (
    GRID,
    LIST,
    SAMPLED,
    Span,
    SweepAxis,
    SweepDesign,
    design_of,
    span_of,
)
from ryusa.casefile.files import toml_text
from ryusa.errors import CaseError
from ryusa.spelling import nearest_word

TABLE = "sweep"  # of a TOML file
_FIELDS = ("case", "design", "over", "points", "design_seed", "seeds", "measure", "set")
_RANGE = ("low", "high", "scale")
_OPEN, _CLOSE = "[{(", ")}]"

Over = Mapping[str, Any] | Sequence[Mapping[str, Any]]


@dataclass(frozen=True)
class SweepFile:
    """A TOML file with a table `[sweep]`.

    Attributes
    ----------
    case : case file.
    design : settings.
    overrides : keys set in all runs.
    seeds : number of seeds, or the seeds; None if not given.
    measures : names of measures; empty if not given.
    """

    case: Path
    design: SweepDesign
    overrides: Mapping[str, str] = field(default_factory=dict[str, str])
    seeds: int | tuple[int, ...] | None = None
    measures: tuple[str, ...] = ()


def axes_of_words(words: Sequence[str]) -> list[SweepAxis]:
    """Axes from the words of a command: "KEY=A,B" each; "KEY=A,B; OTHER=C,D" for keys that change together.

    Raises
    ------
    CaseError : a word is not of this form.

    >>> axes_of_words(["grains.diameter=2 mm, 4 mm; build.layers=10,5"])[0].choices["grains.diameter"]
    ('2 mm', '4 mm')
    """
    axes: list[SweepAxis] = []
    for word in words:
        choices: dict[str, tuple[str, ...] | Span] = {}
        for part in _split(word, ";"):
            key, equals, values = part.partition("=")
            key = key.strip()
            if not equals or not key or not values.strip():
                raise CaseError("--over", word, "needs KEY=VALUE,VALUE.. such as 'motion.slope=0.01,0.02'")
            if key in choices:
                raise CaseError(f"over {key}", None, "varies twice; each key belongs to one axis")
            levels = tuple(_unquoted(one) for one in _split(values, ","))
            choices[key] = levels
            if not all(levels):
                raise CaseError(f"over {key}", values, "a value is empty")
        axes.append(SweepAxis(choices))
    return axes


def _split(text: str, mark: str) -> list[str]:
    """Parts of a text between marks that stand outside quotes and brackets.

    >>> _split("1, [2, 3], 'a,b'", ",")
    ['1', '[2, 3]', "'a,b'"]
    """
    parts, deep, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"":
            quote = letter
        elif letter in _OPEN:
            deep += 1
        elif letter in _CLOSE:
            deep -= 1
        elif letter == mark and deep == 0:
            parts.append("")
            continue
        parts[-1] += letter
    return [one.strip() for one in parts]


def _unquoted(text: str) -> str:
    return text[1:-1] if len(text) > 1 and text[0] == text[-1] and text[0] in "'\"" else text


def axes_of(over: Over) -> list[SweepAxis]:
    """Axes from a mapping of keys to values, one axis each; or from several, whose keys change together.

    A value is a list of levels, or a mapping with `low`, `high` and, if wished, `scale`.

    Raises
    ------
    CaseError : a value is of another kind.

    >>> [len(one.choices) for one in axes_of([{"a": [1, 2], "b": [3, 4]}, {"c": [5]}])]
    [2, 1]
    """
    groups = [{key: one} for key, one in _flat(over).items()] if isinstance(over, Mapping) else [
        _flat(one) for one in over
    ]  # fmt: skip
    return [SweepAxis({key: _choice(key, one) for key, one in group.items()}) for group in groups]


def _flat(tables: Any, before: str = "") -> dict[str, Any]:
    """Keys with dots from tables in tables, as TOML reads a dotted key without quotes."""
    if not isinstance(tables, Mapping):
        raise CaseError("over", tables, "must be tables of keys with their values")
    found: dict[str, Any] = {}
    held: Mapping[str, Any] = tables
    for name, value in held.items():
        inner = isinstance(value, Mapping) and not set(value) & set(_RANGE)
        found |= _flat(value, f"{before}{name}.") if inner else {f"{before}{name}": value}
    return found


def _choice(key: str, value: Any) -> tuple[str, ...] | Span:
    if isinstance(value, Mapping):
        for name in value:
            if name not in _RANGE:
                raise CaseError(
                    f"over {key}", name, f"a range has {', '.join(_RANGE)}", nearest_word(name, _RANGE)
                )
        if not {"low", "high"} <= set(value):
            raise CaseError(f"over {key}", None, "a range needs low and high")
        return span_of(key, value["low"], value["high"], str(value.get("scale", "linear")))
    if isinstance(value, str) or not isinstance(value, Sequence):
        raise CaseError(f"over {key}", value, "must be a list of values, or a range { low = .., high = .. }")
    return tuple(text_of(key, one) for one in value)


def text_of(key: str, value: object) -> str:
    """A value as `ryusa run --set` takes it.

    >>> text_of("motion.slope", 0.01), text_of("motion.plane", True), text_of("grains.diameter", "2 mm")
    ('0.01', 'true', '2 mm')
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return value
    if hasattr(value, "item"):  # of numpy
        value = value.item()  # pyright: ignore[reportAttributeAccessIssue]
    if isinstance(value, (int, float)):
        return repr(value)
    raise CaseError(f"over {key}", value, "a value must be a number, a word or a quantity such as '2 mm'")


def is_sweep_file(path: Path) -> bool:
    """Whether a file holds a table `[sweep]`; what cannot be read is left to the reader of cases."""
    try:
        return TABLE in tomllib.loads(toml_text(path))
    except (OSError, ValueError, RecursionError):
        return False


def read_sweep(path: Path) -> SweepFile:
    """Read a TOML file with a table `[sweep]`.

    Raises
    ------
    CaseError : names the key, its value and what is allowed.
    """
    data = tomllib.loads(toml_text(path))
    for name in data:
        if name != TABLE:
            raise CaseError(
                name, None, f"a sweep file has the table [{TABLE}] alone; a case stands in a file of its own"
            )
    if not isinstance(data[TABLE], dict):
        raise CaseError(TABLE, data[TABLE], "must be a table")
    table: dict[str, Any] = data[TABLE]
    for name in table:
        if name not in _FIELDS:
            raise CaseError(
                f"{TABLE}.{name}", None, f"unknown key; must be one of {', '.join(_FIELDS)}",
                nearest_word(name, _FIELDS),
            )  # fmt: skip
    if not isinstance(table.get("case"), str):
        raise CaseError(f"{TABLE}.case", table.get("case"), "must name a case file, beside this one")
    kind = _word(table, "design", GRID)
    over = table.get("over", [])
    if not isinstance(over, (list, dict)):
        raise CaseError(f"{TABLE}.over", over, f"must be tables [[{TABLE}.over]]")
    axes = listed(over) if kind == LIST else axes_of(over)
    points, seed = _whole(table, "points"), _whole(table, "design_seed")
    if seed is not None and kind not in SAMPLED:
        raise CaseError(f"{TABLE}.design_seed", seed, f"is for a sampled design; this is '{kind}'")
    try:
        design = design_of(kind, axes, points=points, seed=1 if seed is None else seed)
    except CaseError as error:
        raise CaseError(f"{TABLE}.{error.key}", error.value, error.allowed, error.nearest) from None
    measure = table.get("measure", [])
    return SweepFile(
        path.parent / table["case"], design,
        {key: text_of(key, one) for key, one in _flat(table.get("set", {})).items()},
        _seeds(table.get("seeds")),
        tuple(str(one) for one in ([measure] if isinstance(measure, str) else measure)),
    )  # fmt: skip


def listed(over: Any) -> list[SweepAxis]:
    """Axis of a list of settings, which all have the same keys.

    Raises
    ------
    CaseError : two settings have different keys.

    >>> listed([{"a": 1, "b": 2}, {"a": 3, "b": 2}])[0].levels
    [{'a': '1', 'b': '2'}, {'a': '3', 'b': '2'}]
    """
    settings = [_flat(one) for one in ([over] if isinstance(over, dict) else over)]
    if not settings:
        return []
    keys = list(settings[0])
    for k, one in enumerate(settings):
        if set(one) != set(keys):
            raise CaseError(
                f"{TABLE}.over", None,
                f"every setting of a list has the same keys: number 1 has {', '.join(keys)}, "
                f"number {k + 1} has {', '.join(one)}",
            )  # fmt: skip
    return [SweepAxis({key: tuple(text_of(key, one[key]) for one in settings) for key in keys})]


def _word(table: Mapping[str, Any], name: str, default: str) -> str:
    value = table.get(name, default)
    if not isinstance(value, str):
        raise CaseError(f"{TABLE}.{name}", value, "must be a word")
    return value


def _whole(table: Mapping[str, Any], name: str) -> int | None:
    value = table.get(name)
    if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
        raise CaseError(f"{TABLE}.{name}", value, "must be a whole number")
    return value


def _seeds(value: Any) -> int | tuple[int, ...] | None:
    whole = [value] if not isinstance(value, list) else value
    if value is not None and not all(isinstance(one, int) and not isinstance(one, bool) for one in whole):
        raise CaseError(f"{TABLE}.seeds", value, "must be a number of seeds, or a list of seeds")
    return tuple(value) if isinstance(value, list) else value
