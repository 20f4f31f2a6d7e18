"""TOML text to data, and keys set from outside the file."""

import copy
import tomllib
from collections.abc import Mapping
from typing import Any

from ryusa.casefile.checks import RIVALS
from ryusa.errors import CaseError

DEEPEST_KEY = 8


def parsed(text: str) -> dict[str, Any]:
    """Read TOML; -0.0 becomes 0.0, which numpy wants as the length of a range."""
    return tomllib.loads(text, parse_float=lambda number: float(number) + 0.0)


def with_overrides(data: dict[str, Any], overrides: Mapping[str, str]) -> dict[str, Any]:
    """Data of the file with dotted keys set; a key displaces the other way to give the same thing.

    Raises
    ------
    CaseError : both ways are set, no key with dots, or a way through what is no table.
    """
    if not overrides:
        return data
    for section, pairs in RIVALS.items():
        for one, other in pairs:
            if {f"{section}.{one}", f"{section}.{other}"} <= set(overrides):
                text = f"excludes --set {section}.{other}; give only one of the two"
                raise CaseError(f"--set {section}.{one}", None, text)
    data = copy.deepcopy(data)
    for key, text in overrides.items():
        _set(data, key, _toml_value(text))
    return data


def _toml_value(text: str) -> Any:
    try:
        found = parsed(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return found["value"] if set(found) == {"value"} else text


def _set(data: dict[str, Any], key: str, value: Any) -> None:
    parts = key.split(".")
    if not all(parts) or len(parts) > DEEPEST_KEY:
        raise CaseError(f"--set {key}", None, "needs a dotted key such as contact.stiffness")
    here: Any = data
    for part in parts[:-1]:
        if isinstance(here, dict):
            here = here.setdefault(part, {})
        elif isinstance(here, list) and part.isdecimal() and int(part) < len(here):
            here = here[int(part)]
        else:
            raise CaseError(f"--set {key}", None, _no_table(part, here))
    last = parts[-1]
    if isinstance(here, list) and last.isdecimal() and int(last) < len(here):
        here[int(last)] = value
    elif isinstance(here, dict):
        for group in RIVALS.get(parts[0], ()):
            if last in group:
                for rival in group:
                    here.pop(rival, None)
        here[last] = value
    else:
        raise CaseError(f"--set {key}", None, _no_table(last if isinstance(here, list) else parts[-2], here))


def _no_table(part: str, here: Any) -> str:
    if not isinstance(here, list):
        return f"'{part}' is not a table in this case"
    entries: list[Any] = here
    names = [str(one["name"]) for one in entries if isinstance(one, dict) and "name" in one]
    named = f" ({', '.join(names)})" if names else ""
    return f"'{part}' is no entry: they count from 0 to {len(entries) - 1}{named}"
