"""Every key of the case file: where it stands, what it means, and which one a misspelt key may be."""

import types
import typing
from collections.abc import Iterator, Sequence
from typing import Annotated, Any

from pydantic import BaseModel

from ryusa.casefile.case import Case
from ryusa.spelling import nearest_word

BY_NAME = ("materials", "shapes")  # tables of tables whose names the user chooses


def dotted(path: Sequence[str | int]) -> str:
    """Write a path as a user would: `timeline.0.at`."""
    return ".".join(str(part) for part in path) or "case"


def all_keys() -> list[str]:
    """Every key of the case file, dotted; those of a builder appear once as build.<key>."""
    return list(dict.fromkeys(key for key, _ in _describe(Case, "")))


def described() -> dict[str, str]:
    """Every key of the case file with its description."""
    return dict(_describe(Case, ""))


def keys_at(path: Sequence[str | int], data: dict[str, Any]) -> list[str]:
    """Keys known at a path of the file."""
    found: list[str] = []
    for model in _models_at(path, data):
        found += [field.alias or name for name, field in model.model_fields.items()]
    return found


def description_at(path: Sequence[str | int], data: dict[str, Any]) -> str:
    """Description of a key; that of its table where the key has none."""
    about = ""
    for model in _models_at(path[:-1], data):
        for name, field in model.model_fields.items():
            if path[-1] in {name, field.alias}:
                about = field.description or next((m.__doc__ or "" for m in _models_in(field.annotation)), "")
    return about


# Names that other programs give to a key, too unlike it to be misspellings.
_OTHER_NAMES = {
    **dict.fromkeys(("dt", "timestep", "time_step"), "time.step"),
    **dict.fromkeys(("radius", "mean_radius", "size"), "grains.diameter"),
    **dict.fromkeys(("d10", "d16", "d50", "d84", "d90"), "grains.sieve_curve"),
}


def nearest_key(path: Sequence[str | int], data: dict[str, Any]) -> str | None:
    """Find the known key nearest to an unknown one: of the same name elsewhere, then of a like name."""
    name, every = str(path[-1]), all_keys()
    if name in _OTHER_NAMES:
        return _OTHER_NAMES[name]
    last = {key: key.rsplit(".", 1)[-1] for key in every}
    same = [key for key in every if last[key] == name and key != dotted(path)]
    if same:
        return same[0]
    near = nearest_word(name, keys_at(path[:-1], data))
    if near is not None:
        return dotted((*path[:-1], near))
    near = nearest_word(name, list(last.values()))
    return next((key for key in every if last[key] == near), None)


def builders() -> dict[str, type[BaseModel]]:
    """Section of each builder by its word."""
    models = _models_in(Case.model_fields["build"].annotation)
    return {typing.get_args(model.model_fields["kind"].annotation)[0]: model for model in models}


def builders_with(key: str) -> list[str]:
    """Builders that have a key."""
    return [kind for kind, model in builders().items() if key in model.model_fields]


def _describe(model: type[BaseModel], before: str) -> Iterator[tuple[str, str]]:
    for name, field in model.model_fields.items():
        key = before + (field.alias or name)
        inner = list(_models_in(field.annotation))
        inner += [one for item in field.metadata for one in _models_in(item)]
        yield key, field.description or (inner[0].__doc__ or "" if inner else "")
        for one in inner:
            yield from _describe(one, f"{key}.NAME." if key in BY_NAME else f"{key}.")


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif typing.get_origin(annotation) in {Annotated, typing.Union, types.UnionType, tuple, dict}:
        for part in typing.get_args(annotation):
            yield from _models_in(part)


def _models_at(path: Sequence[str | int], data: dict[str, Any]) -> list[type[BaseModel]]:
    models: list[type[BaseModel]] = [Case]
    here: Any = data
    for n, part in enumerate(path):
        here = item(here, part)
        if isinstance(part, int) or (n == 1 and path[0] in BY_NAME):
            continue
        inner: list[type[BaseModel]] = []
        for model in models:
            for name, field in model.model_fields.items():
                if part in {name, field.alias}:
                    inner += list(_models_in(field.annotation))
        models = inner
    if path and path[0] == "build" and isinstance(here, dict):
        one = builders().get(str(here.get("kind")))
        models = [one] if one is not None and len(path) == 1 else models
    return models


def item(here: Any, part: str | int) -> Any:
    """Entry of a table or list of the file's data; None where there is none."""
    if isinstance(here, dict):
        return here.get(part)
    if isinstance(here, (list, tuple)) and isinstance(part, int) and part < len(here):
        return here[part]
    return None
