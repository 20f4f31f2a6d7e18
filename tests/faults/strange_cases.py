"""Case files that nobody should write, made by hypothesis: nearly right, odd, or broken."""

import datetime
import json
import tomllib
from collections.abc import Mapping
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import Any

from hypothesis import strategies as st
from kinds import KINDS, MESHES

from ryusa.casefile import json_schema_text
from ryusa.cases import FOLDERS, case_files

UNITS = (
    "m", "cm", "mm", "um", "km", "s", "ms", "min", "h", "m/s", "cm/s", "m/s2", "m s^-2", "N/m", "N/cm",
    "kN/m", "N s/m", "N s/cm", "kg/m3", "g/cm3", "m2/s", "mm2/s", "deg", "rad", "°", "%", "N", "Pa", "",
    "Pa/m", "m^9", "Ylightyear^9", "degC", "furlong", "m//s", "m*", "/s", "m^-0", "µm", "cm cm^-1", "1",
)  # fmt: skip
NUMBERS = (
    "0", "-0", "1", "-1", "0.5", "1e-30", "1e30", "1e308", "1e-320", "1e400", "1e-400", "9" * 40, "0x10",
    "1_000", "nan", "inf", "-inf", ".5", "5.", "+3", "1e", "1,5", "\u0661", "\uff11", "1e0999",
)  # fmt: skip
HEX = " 0x" + 5_000 * "f"  # a whole number too long to be written in tens
TABLE = """
title = "Grains from a table"
[grains]
density = "2650 kg/m3"
[contact]
stiffness = "100 N/cm"
restitution = 0.7
friction_angle = "30 deg"
[motion]
rotation = "free"
plane = true
[build]
kind = "table"
file = "grains.csv"
[[planes]]
name = "floor"
point = ["0 m", "0 m", "0 m"]
normal = [0, 0, 1]
[stop]
time = "1 ms"
"""
ROWS = "x [cm], z [cm], d [cm], vx [m/s], fixed, group\n0, 0.2, 0.2, 0.1, 0,\n1, 0.2, 0.3, 0, 1, stones\n"
CLUMPS = KINDS["clumps"].replace("{ rod = 0.4, tetrahedron = 0.4 }", '"stones.csv"')
ATTACHED = KINDS["servo-feeds"].replace("[[feeds]]\n", '[[feeds]]\nmoves_with = "lid"\n')
ATTACHED = ATTACHED.replace("[[exits]]\n", '[[exits]]\nmoves_with = "lid"\n')
STONES = "x [mm], y [mm], z [mm], d [mm]\n0, 0, 0, 2\n1, 0, 0, 2\n0, 1.2, 0.1, 1.5\n"
FILES = {"grains.csv": ROWS, "stones.csv": STONES, **MESHES}  # beside each case
PARTS = ("walls", "feeds", "exits", "materials", "pairs", "shape", "servo", "mixture")
CARRIED = ("walls", "feeds", "exits", "materials", "pairs", "planes", "timeline")


@cache
def bases() -> tuple[dict[str, Any], ...]:
    """Every case of ryusa and of the fault campaign, with a table, with clumps, with feeds on a wall."""
    texts = [*KINDS.values(), TABLE, CLUMPS, ATTACHED]
    for folder in FOLDERS:
        texts += [one.read_text(encoding="utf-8") for one in case_files(folder).values()]
    return tuple(tomllib.loads(text) for text in texts)


@cache
def rich() -> tuple[dict[str, Any], ...]:
    """Those bases that have walls, feeds, exits, materials or clumps."""
    return tuple(base for base in bases() if any(f"{part}" in str(base) for part in PARTS))


def merged(draw: st.DrawFn, case: dict[str, Any]) -> None:
    """Take a section of walls, feeds, exits or materials from another base, beside what is there."""
    other = draw(st.sampled_from(rich()))
    for key in CARRIED:
        if key in other and draw(st.booleans()):
            more = deepcopy(other[key])
            case[key] = case.get(key, []) + more if isinstance(more, list) else case.get(key, {}) | more


@cache
def known() -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Every key and every word that the schema knows."""
    keys, words = set[str](), set[str]()

    def walk(value: Any) -> None:
        if isinstance(value, dict):
            if isinstance(value.get("properties"), dict):
                keys.update(value["properties"])
            for one in [*value.get("enum", ()), value.get("const")]:
                words.update([one] if isinstance(one, str) else [])
            for one in value.values():
                walk(one)
        elif isinstance(value, list):
            for one in value:
                walk(one)

    walk(json.loads(json_schema_text()))
    return tuple(sorted(keys)), tuple(sorted(words))


@cache
def values_of() -> dict[str, list[Any]]:
    """Values that the known cases give each key."""
    found: dict[str, list[Any]] = {}

    def walk(value: Any) -> None:
        if isinstance(value, list):
            for one in value:
                walk(one)
        for key, one in value.items() if isinstance(value, dict) else ():
            if one not in found.setdefault(key, []):
                found[key].append(one)
            walk(one)

    for base in bases():
        walk(base)
    return found


numbers = (
    st.sampled_from(NUMBERS) | st.floats(allow_nan=False, width=32).map(str) | st.integers(-9, 99).map(str)
)
quantities = st.builds(
    "{}{}{}".format, numbers, st.sampled_from(["", " ", "  ", "\t", "e"]), st.sampled_from(UNITS)
)
dates = st.dates() | st.datetimes(timezones=st.just(datetime.UTC)) | st.times()
plain = (
    st.booleans() | st.integers() | st.integers(-3, 12) | st.floats() | st.floats(0.0, 2.0)
    | st.text(max_size=8) | quantities | dates
    | st.sampled_from([10**30, -(10**400), 1e308, -0.0, 5e-324, "x" * 5000])
    | st.deferred(lambda: st.sampled_from(known()[1]))
)  # fmt: skip
anything = st.recursive(
    plain,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=4), inner, max_size=3),
    max_leaves=5,
)


def ways(value: Any, way: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Ways to everything within a case."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return ([way] if way else []) + [one for key, child in inner for one in ways(child, (*way, key))]


def near(draw: st.DrawFn, value: Any) -> Any:
    """Another value of the same kind."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return draw(anything)
    if isinstance(value, str):
        number, _, unit = value.partition(" ")
        try:
            size = float(number)
        except ValueError:
            return draw(st.sampled_from(known()[1]))
        factor = draw(st.sampled_from([0.0, 1e-6, 1e-3, 0.1, 0.5, 0.9, 1.1, 2.0, 10.0, 1e3, 1e6, -1.0]))
        return f"{size * factor:.6g} {unit}"
    factor = draw(st.sampled_from([0, -1, 1, 2, 3, 10, 1000]))
    return value * factor + draw(st.sampled_from([0, 1, -1])) if abs(value) < 1e100 else 1


def mutated(draw: st.DrawFn, case: dict[str, Any]) -> None:
    """Change one thing in a case."""
    there = ways(case)
    if not there:
        case[draw(st.sampled_from(known()[0]))] = draw(anything)
        return
    *way, last = draw(st.sampled_from(there))
    here: Any = case
    for key in way:
        here = here[key]
    how = draw(st.sampled_from(["near", "near", "other", "odd", "away", "key", "twin", "swap"]))
    if how == "near":
        here[last] = near(draw, here[last])
    elif how == "other" and values_of().get(last):
        here[last] = deepcopy(draw(st.sampled_from(values_of()[last])))
    elif how == "away":
        del here[last]
    elif how == "key" and isinstance(here, dict):
        name = draw(st.sampled_from(known()[0]) | st.text(max_size=6))
        here[name] = deepcopy(draw(st.sampled_from(values_of().get(name, [1])) | anything))
    elif how == "twin" and isinstance(here, list):
        here.append(deepcopy(here[last]))
    elif how == "swap" and isinstance(last, str):
        others = [base[last] for base in bases() if last in base]
        here[last] = deepcopy(draw(st.sampled_from(others))) if others else draw(anything)
    else:
        here[last] = draw(anything)


def text_of(value: Any) -> str:
    """A value as TOML writes it; tables inline."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        body = "".join(c if c.isprintable() and c not in '"\\' else f"\\U{ord(c):08X}" for c in value)
        return f'"{body}"'
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{text_of(str(key))} = {text_of(one)}" for key, one in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(text_of(one) for one in value) + "]"
    return value.isoformat() if isinstance(value, datetime.date | datetime.time) else repr(value)


def toml_of(case: dict[str, Any]) -> str:
    """A case as a file, one table a section."""
    plain = {key: one for key, one in case.items() if not isinstance(one, dict)}
    lines = [f"{text_of(key)} = {text_of(one)}" for key, one in plain.items()]
    for name in (one for one in case if one not in plain):
        lines += [
            f"[{text_of(name)}]",
            *(f"{text_of(key)} = {text_of(one)}" for key, one in case[name].items()),
        ]
    return "\n".join(lines) + "\n"


def broken(draw: st.DrawFn, text: str) -> str:
    """Change the text itself."""
    if not text:
        return draw(st.text(max_size=50))
    a = draw(st.integers(0, len(text) - 1))
    b = min(len(text), a + draw(st.integers(0, 40)))
    between = draw(
        st.sampled_from(["", text[a:b] * 2, "\x00", "[", "]]", '"""', "=", "\n", "\ud7ff", "#", "''", HEX])
    )
    return text[:a] + draw(st.just(between) | st.text(max_size=12)) + text[b:]


@st.composite
def strange_cases(draw: st.DrawFn) -> str:
    """The text of a case file."""
    case = deepcopy(draw(st.sampled_from(draw(st.sampled_from([bases(), rich()])))))
    if draw(st.integers(0, 3)) == 0:
        merged(draw, case)
    for _ in range(draw(st.sampled_from([0, 1, 1, 1, 2, 2, 3, 5]))):
        mutated(draw, case)
    text = toml_of(case)
    return broken(draw, text) if draw(st.integers(0, 4)) == 0 else text


@st.composite
def strange_files(draw: st.DrawFn) -> dict[str, str]:
    """The texts of the files that cases name: first grains, a clump, a mesh."""
    files = dict(FILES)
    for _ in range(draw(st.sampled_from([0, 0, 0, 1, 2]))):
        name = draw(st.sampled_from(sorted(files)))
        files[name] = broken(draw, files[name])
    return files


def lay(folder: Path, text: str, files: Mapping[str, str]) -> Path:
    """Write a case and what it names; the path of the case."""
    for name, content in files.items():
        (folder / name).write_text(content, encoding="utf-8", errors="replace")
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return folder / "case.toml"
