"""From the schema's complaints to errors that name key path, value, what is allowed and the nearest key."""

import difflib
import types
import typing
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from pydantic import BaseModel, ValidationError

from ryusa.casefile.schema import Case
from ryusa.errors import CaseError

_LONGEST_VALUE = 80
_WORDS = {
    "greater_than": "must be greater than {gt}",
    "greater_than_equal": "must be at least {ge}",
    "less_than": "must be less than {lt}",
    "less_than_equal": "must be at most {le}",
    "float_type": "must be a number, without quotes",
    "int_type": "must be a whole number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be text in quotes",
    "finite_number": "must be finite",
    "tuple_type": "must be a list in [ ]",
    "model_type": "must be a table of keys",
    "model_attributes_type": "must be a table of keys",
    "too_short": "has too few entries",
    "too_long": "has too many entries",
    "string_too_short": "must not be empty",
    "string_too_long": "is too long",
}


def faults(error: ValidationError, data: dict[str, Any]) -> list[CaseError]:
    """One `CaseError` per complaint; `data` is what the file held."""
    return [_fault(dict(one), data) for one in error.errors(include_url=False)]


def _fault(one: dict[str, Any], data: dict[str, Any]) -> CaseError:
    path = _plain(one["loc"])
    kind, context = one["type"], one.get("ctx", {})
    value = _value(data, path)
    if kind == "extra_forbidden":
        path = (*_plain(one["loc"][:-1]), one["loc"][-1])  # a key may look like a branch
        return CaseError(dotted(path), None, "unknown key", nearest_key(path, data))
    if kind == "missing":
        return CaseError(dotted(path), None, _missing(path, data))
    if kind in {"union_tag_invalid", "union_tag_not_found"}:
        names = _kinds()
        value = _value(data, (*path, "kind"))
        allowed = (
            f"missing; must be one of {', '.join(names)}"
            if value is None
            else f"must be one of {', '.join(names)}"
        )
        return CaseError(dotted((*path, "kind")), value, allowed, nearest_word(value, names))
    if kind == "literal_error":
        names = [
            word.strip().strip("'") for word in str(context["expected"]).replace(" or ", ", ").split(", ")
        ]
        return CaseError(
            dotted(path), value, f"must be one of {', '.join(map(repr, names))}", nearest_word(value, names)
        )
    if kind == "value_error":
        return CaseError(dotted(path), value, str(context.get("error", one["msg"])))
    allowed = _WORDS.get(kind, str(one["msg"])).format(**context)
    if kind.startswith(("greater", "less")) and isinstance(value, str):
        allowed += _unit_of_bound(path, data)
    return CaseError(dotted(path), value, allowed)


def dotted(path: Sequence[str | int]) -> str:
    """Write a path as a user would: `timeline.0.at`."""
    return ".".join(str(part) for part in path) or "case"


def nearest_word(value: object, words: Sequence[str]) -> str | None:
    """Find the known word nearest to what was written, or None."""
    if not isinstance(value, str):
        return None
    lowered = {word.lower(): word for word in words}
    found = difflib.get_close_matches(value.lower(), list(lowered), n=1, cutoff=0.6)
    return lowered[found[0]] if found else None


def nearest_key(path: Sequence[str | int], data: dict[str, Any]) -> str | None:
    """Find the known key nearest to an unknown one: in the same name elsewhere, then a like one."""
    name = str(path[-1])
    everywhere = [key for key in all_keys() if key.rsplit(".", 1)[-1] == name]
    if everywhere:
        return everywhere[0]
    found = nearest_word(name, keys_at(path[:-1], data))
    if found is not None:
        return dotted((*path[:-1], found))
    last = nearest_word(name, [key.rsplit(".", 1)[-1] for key in all_keys()])
    return next((key for key in all_keys() if key.rsplit(".", 1)[-1] == last), None) if last else None


def keys_at(path: Sequence[str | int], data: dict[str, Any]) -> list[str]:
    """Keys known at a path of the file."""
    found: list[str] = []
    for model in _models_at(path, data):
        found += [field.alias or name for name, field in model.model_fields.items()]
    return found


def all_keys() -> list[str]:
    """Every key of the case file, dotted; those of a builder appear once as build.<key>."""
    return list(dict.fromkeys(_walk(Case, "")))


def described() -> dict[str, str]:
    """Every key of the case file with its description."""
    return dict(_describe(Case, ""))


def _walk(model: type[BaseModel], before: str) -> Iterator[str]:
    for key, _ in _describe(model, before):
        yield key


def _describe(model: type[BaseModel], before: str) -> Iterator[tuple[str, str]]:
    for name, field in model.model_fields.items():
        key = before + (field.alias or name)
        inner = list(_models_in(field.annotation))
        inner += [one for item in field.metadata for one in _models_in(item)]
        yield key, field.description or (inner[0].__doc__ or "" if inner else "")
        for one in inner:
            yield from _describe(one, key + ".")


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif typing.get_origin(annotation) in {Annotated, typing.Union, types.UnionType, tuple}:
        for part in typing.get_args(annotation):
            yield from _models_in(part)


def _models_at(path: Sequence[str | int], data: dict[str, Any]) -> list[type[BaseModel]]:
    models: list[type[BaseModel]] = [Case]
    here: Any = data
    for part in path:
        here = _step(here, part)
        if isinstance(part, int):
            continue
        inner: list[type[BaseModel]] = []
        for model in models:
            for name, field in model.model_fields.items():
                if part in {name, field.alias}:
                    inner += list(_models_in(field.annotation))
        models = inner
    if path and path[0] == "build" and isinstance(here, dict):
        kind = here.get("kind")
        models = [m for m in models if m.__name__.lower() == kind] or models
    return models


def _kinds() -> list[str]:
    return [model.__name__.lower() for model in _models_at(("build",), {})]


def _plain(loc: Sequence[str | int]) -> tuple[str | int, ...]:
    """Drop the names of union branches, which are no keys."""
    parts = [part for part in loc if not (isinstance(part, str) and part.startswith("<"))]
    if len(parts) > 1 and parts[0] == "build" and parts[1] in _kinds():
        del parts[1]
    return tuple(parts)


def _step(here: Any, part: str | int) -> Any:
    if isinstance(here, dict):
        return here.get(part)
    if isinstance(here, (list, tuple)) and isinstance(part, int) and part < len(here):
        return here[part]
    return None


def _value(data: Any, path: Sequence[str | int]) -> Any:
    for part in path:
        data = _step(data, part)
    try:
        return None if isinstance(data, dict) or len(repr(data)) > _LONGEST_VALUE else data
    except ValueError:  # a whole number of thousands of digits
        return None


def _missing(path: Sequence[str | int], data: dict[str, Any]) -> str:
    about = ""
    for model in _models_at(path[:-1], data):
        for name, field in model.model_fields.items():
            if path[-1] in {name, field.alias}:
                about = field.description or next((m.__doc__ or "" for m in _models_in(field.annotation)), "")
    return f"missing; {about[0].lower()}{about[1:].rstrip('.')}" if about else "missing"


def _unit_of_bound(path: Sequence[str | int], data: dict[str, Any]) -> str:
    return " (in SI)" if keys_at(path[:-1], data) else ""
