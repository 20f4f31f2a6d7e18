"""Every key of the case file where a case could have it, values for it, and all that follows from a case."""

import copy
import dataclasses
import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from ryusa.build import build
from ryusa.casefile import Case, resolved
from ryusa.casefile.checks import RIVALS, check
from ryusa.casefile.explain import explain
from ryusa.casefile.faults import faults
from ryusa.casefile.read import json_schema
from ryusa.errors import CaseError
from ryusa.laws.families import Drag, Lift, Profile
from ryusa.model.scene import EventRule
from ryusa.model.walls import PHASE, SWING

SCHEMA = json_schema()
Data = dict[str, Any]
Key = tuple[str | int, ...]
MORE = {  # values of a quantity beside the examples of the schema
    "length": ("0.3 mm", "1 mm", "3 mm", "2.2 cm", "6 cm", "1 m"),
    "time": ("1 us", "1 ms", "11 ms", "50 ms", "0.3 s"),
}
_QUANTITY = re.compile(r"([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)(\s*\S.*)")


def _whole(schema: Data) -> Data:
    while "$ref" in schema:
        schema = {
            **SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]],
            **{name: one for name, one in schema.items() if name != "$ref"},
        }
    return schema


def branches(schema: Data) -> Iterator[Data]:
    """The kinds of value that a key may have."""
    schema = _whole(schema)
    several = schema.get("anyOf") or schema.get("oneOf")
    if several is None or "examples" in schema:
        if schema.get("type") != "null":
            yield schema
        return
    for one in several:
        yield from branches(one)


def keys(schema: Data = SCHEMA, here: Any = None, path: Key = ()) -> Iterator[tuple[Key, Data]]:
    """Each key of each table that a case has or may have, with its schema."""
    for one in branches(schema):
        kind = one.get("properties", {}).get("kind", {}).get("const")
        if "properties" not in one or (here is not None and kind not in {None, here.get("kind")}):
            continue
        if here is not None and not set(here) <= set(one["properties"]):
            continue
        for name, below in one["properties"].items():
            at, value = (*path, name), (here or {}).get(name)
            yield at, below
            for part in branches(below):
                if isinstance(value, list) and "items" in part:
                    for k, entry in enumerate(value):
                        if isinstance(entry, dict):
                            yield from keys(part["items"], entry, (*at, k))
                elif isinstance(value, dict) and isinstance(part.get("additionalProperties"), dict):
                    for word, entry in value.items():
                        if isinstance(entry, dict):
                            yield from keys(part["additionalProperties"], entry, (*at, word))
                elif "properties" in part and (isinstance(value, dict) or (value is None and len(path) < 2)):
                    yield from keys(part, value, at)


def general(path: Key, data: Data) -> str:
    """Name of a key in the whole schema: NAME for what a user names, the kind of a builder in brackets."""
    parts = ["N" if isinstance(one, int) else one for one in path]
    if len(parts) > 1 and parts[0] in {"materials", "shapes"}:
        parts[1] = "NAME"
    if parts[0] == "build" and len(parts) > 1:
        parts[0] = f"build({data['build']['kind']})"
    return ".".join(parts)


def every_key() -> set[str]:
    """Every key of the schema, as `general` names them."""
    found: set[str] = set()

    def below(schema: Data, before: str) -> None:
        for one in branches(schema):
            for name, inner in one.get("properties", {}).items():
                kind = one["properties"].get("kind", {}).get("const")
                at = f"build({kind}).{name}" if kind and before == "build." else f"{before}{name}"
                found.add(at)
                below(inner, f"{at}.")
            if "items" in one:
                below(one["items"], f"{before}N.")
            if isinstance(one.get("additionalProperties"), dict):
                below(one["additionalProperties"], f"{before}NAME.")

    below(SCHEMA, "")
    return found


def value_at(data: Any, path: Key) -> Any:
    """Value of a key in the data of a case; None where it is left out."""
    for part in path:
        if isinstance(data, dict):
            data = data.get(part)
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
        else:
            return None
    return data


def with_value(data: Data, path: Key, value: Any) -> Data:
    """The same data with a key set, or left out where the value is None; rivals of the key give way."""
    data = copy.deepcopy(data)
    here: Any = data
    for part in path[:-1]:
        if isinstance(here, dict):
            here.setdefault(part, {})
        here = here[part]
    for group in RIVALS.get(str(path[0]), ()):
        if len(path) == 2 and path[-1] in group and value is not None:
            for rival in group:
                here.pop(rival, None)
    if value is None:
        here.pop(path[-1], None)
    else:
        here[path[-1]] = value
    return data


def _like(now: Any) -> Iterator[Any]:
    """Values near the one that a case has."""
    if isinstance(now, bool):
        yield not now
    elif isinstance(now, int):
        yield from (now + 1, now - 1, 2 * now)
    elif isinstance(now, float):
        yield from (1.1 * now, 0.9 * now, now + 0.01)
    elif isinstance(now, str) and (found := _QUANTITY.fullmatch(now)):
        for factor in (1.1, 0.9, 2.0):
            yield f"{float(found[1]) * factor:.12g}{found[2]}"
        yield f"{float(found[1]) + 0.01:.12g}{found[2]}"
    elif isinstance(now, list):
        for k in reversed(range(len(now))):
            for other in _like(now[k]):
                yield [*now[:k], other, *now[k + 1 :]]
    elif isinstance(now, dict):
        for name, one in now.items():
            for other in _like(one):
                yield now | {name: other}


def _of_schema(schema: Data, words: list[str], depth: int = 0) -> Iterator[Any]:
    """Values that a schema allows."""
    for one in branches(schema):
        kind = one.get("type")
        if "const" in one or "enum" in one:
            yield from one.get("enum", [one.get("const")])
        elif kind == "boolean":
            yield from (True, False)
        elif "examples" in one:
            yield from (*one["examples"], *MORE.get(one.get("title", ""), ()))
        elif kind in {"number", "integer"}:
            low = one.get("minimum", one.get("exclusiveMinimum", -1))
            high = one.get("maximum", one.get("exclusiveMaximum", 100))
            for value in (0.5, 0.25, 0.05, 1, 2, 3, 15, 0):
                if low <= value <= high and (kind == "number" or value == int(value)):
                    yield float(value) if kind == "number" else int(value)
        elif kind == "string":
            yield from words
        elif kind == "array" and "prefixItems" in one:
            columns = [list(_of_schema(part, words, depth + 1))[:2] for part in one["prefixItems"]]
            yield from map(list, itertools.islice(itertools.product(*columns), 4))
        elif kind == "array" and "items" in one and depth < 2:
            yield from ([value] for value in itertools.islice(_of_schema(one["items"], words, depth + 1), 3))
        elif "properties" in one and depth < 2 and one.get("required"):
            columns = [
                list(_of_schema(one["properties"][name], words, depth + 1))[:3] for name in one["required"]
            ]
            for values in itertools.islice(itertools.product(*columns), 9):
                yield dict(zip(one["required"], values, strict=True))


def values_for(schema: Data, now: Any, words: list[str]) -> list[Any]:
    """Values to try for a key: near the one it has, none, and those of its schema; each once."""
    found: list[Any] = []
    for one in (*_like(now), *([None] if now is not None else []), *_of_schema(schema, words)):
        if one not in found and one != now:
            found.append(one)
    return found


def words_in(data: Any) -> list[str]:
    """Names that a case gives to walls, feeds, materials and shapes."""
    found: list[str] = []
    if isinstance(data, dict):
        for name, one in data.items():
            if name == "name":
                found.append(one)
            if name in {"materials", "shapes"}:
                found += list(one)
            found += words_in(one)
    elif isinstance(data, list):
        found += [word for one in data for word in words_in(one)]
    return list(dict.fromkeys(found))


def read_data(data: Data, folder: Path) -> Case:
    """Read a case given as data; its files are in the folder."""
    data = copy.deepcopy(data)
    try:
        case = Case.model_validate(data)
    except ValidationError as error:
        raise CaseError.together(faults(error, data), None) from None
    case._path = folder / "case.toml"
    if found := check(case, data):
        raise CaseError.together(found, None)
    return case


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What follows from a case: what acts in a run, and what `ryusa check` and the log say."""

    acts: str
    filled_in: str  # the case with its defaults
    rows: dict[tuple[str, str], str]
    said: tuple[str, ...]


def outcome(case: Case) -> Outcome:
    """Build a case, and take what acts of it."""
    built, rows = build(case), explain(case)
    scene, wet = built.scene, built.scene.water
    parts = _plain({"scene": scene, "state": built.state})
    if scene.walls is not None:  # a phase is of an oscillation
        motion = scene.walls.motion.copy()
        motion[(motion[:, SWING : SWING + 3] == 0.0).all(axis=1), PHASE] = 0.0
        parts["scene"]["walls"]["motion"] = _plain(motion)
    unread: list[str] = []
    if scene.events is not EventRule.TRACKED and case.stop.saltations is None:
        unread.append("tracked")
    if not scene.n_grain and scene.row is not None:  # water alone
        kept = ("flow", "dt", "gravity")
        unread += [name for name in parts["scene"] if name not in kept]
        parts["scene"]["flow"]["column"].pop("seed")
        parts["scene"]["flow"]["column"].pop("phi_max")
    for name in unread:
        parts["scene"].pop(name, None)
    water = parts["scene"].get("water", {})
    if wet.drag is Drag.NONE and wet.lift is Lift.NONE:
        water.pop("a_2", None)
    if wet.profile in {Profile.NONE, Profile.UNIFORM, Profile.STILL} and np.isinf(wet.depth):
        water.pop("z_zero", None)
    control = [case.stop.model_dump(), [one.model_dump() for one in case.timeline]]
    control += [case.record.model_dump(include={"frames", "settle"})]
    return Outcome(
        json.dumps([parts, _plain(control)], sort_keys=True),
        json.dumps(resolved(case), sort_keys=True),
        {(one.section, one.name): f"{one.shown} {one.flag}" for one in rows},
        (*(one.origin for one in rows if one.flag), *built.notes),
    )


def _plain(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        return {one.name: _plain(getattr(value, one.name)) for one in dataclasses.fields(value)}
    if isinstance(value, np.ndarray):
        return f"{value.shape} {hash(value.tobytes())}"
    if isinstance(value, dict):
        return {str(name): _plain(one) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return repr(value)
