"""What is public stays: `python tests/docs/test_promised.py` adds what is new to promised.txt.

One line for each thing that has names of its own: a module and its names, a function and its parameters, a
class and its public members, a command and its options, a table of the case file and its keys, a key and its
words. docs/promises.md says what the promise is. A name is taken out by hand, with the major version.
"""

import dataclasses
import importlib
import inspect
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
KEPT = Path(__file__).with_name("promised.txt")
PAGE = ROOT / "docs" / "promises.md"
GUIDES = ("README.md", "docs/scenes-in-python.md", "docs/study-of-your-own.md", "docs/run-folder.md")
IMPORT = re.compile(r"^\s*from (ryusa[\w.]*) import ([\w, ]+)$", flags=re.MULTILINE)
TABLES = re.compile(r"^```toml\n(.*?)^```$", flags=re.MULTILINE | re.DOTALL)


def listed() -> dict[str, set[str]]:
    """Everything that is promised now, as promised.txt holds it."""
    found: dict[str, set[str]] = {}
    for place, names in (*python(), *commands(), *keys(), *catalogue()):
        found.setdefault(place, set()).update(names)
    return found


def modules() -> dict[str, list[str]]:
    """Public modules, with their names, as the page has them."""
    found = TABLES.search(PAGE.read_text(encoding="utf-8"))
    assert found is not None
    public: dict[str, list[str]] = tomllib.loads(found[1])["public"]
    return {name: names or importlib.import_module(name).__all__ for name, names in public.items()}


def python() -> Iterator[tuple[str, list[str]]]:
    """Names of modules, parameters of functions, members of classes."""
    for module, names in modules().items():
        yield f"python {module}", names
        for name in names:
            one = getattr(importlib.import_module(module), name)
            if inspect.isclass(one):
                fields = (
                    [field.name for field in dataclasses.fields(one)] if dataclasses.is_dataclass(one) else []
                )
                own = [*dir(one), *fields, *getattr(one, "model_fields", ())]
                inherited = {*dir(object), *dir(Exception)} | {
                    member for base in one.__mro__ if not base.__module__.startswith("ryusa")
                    for member in dir(base)
                }  # fmt: skip
                yield (
                    f"python {module}.{name}",
                    [member for member in own if not member.startswith("_") and member not in inherited],
                )
            elif inspect.isfunction(one):
                yield f"python {module}.{name}", list(inspect.signature(one).parameters)


def commands() -> Iterator[tuple[str, list[str]]]:
    """Commands with their options."""
    import typer

    from ryusa.cli import app

    def walk(command: Any, name: str) -> Iterator[tuple[str, list[str]]]:
        if inner := getattr(command, "commands", None):
            for word, one in inner.items():
                yield from walk(one, f"{name} {word}")
        elif not command.hidden:
            options = [one for one in command.params if one.param_type_name == "option" and not one.hidden]
            yield name, [word for one in options for word in (*one.opts, *one.secondary_opts)]

    yield from walk(typer.main.get_command(app), "ryusa")


def keys() -> Iterator[tuple[str, list[str]]]:
    """Tables of the case file with their keys, and keys with the words that they take."""
    from ryusa.casefile import json_schema

    schema = json_schema()

    def below(about: dict[str, Any], place: str) -> Iterator[tuple[str, list[str]]]:
        if "$ref" in about:
            about = schema["$defs"][about["$ref"].rpartition("/")[2]]
        for part in (*about.get("anyOf", ()), *about.get("oneOf", ()), *about.get("prefixItems", ())):
            yield from below(part, place)
        for inner in ("items", "additionalProperties"):
            if isinstance(about.get(inner), dict):
                yield from below(about[inner], place)
        if "enum" in about:
            yield f"words {place}", about["enum"]
        if "properties" in about:
            kind = about["properties"].get("kind", {}).get("const", "")
            here = f"{place}({kind})" if kind else place
            yield f"keys {here}".rstrip(), list(about["properties"])
            for key, one in about["properties"].items():
                yield from below(one, f"{here}.{key}".lstrip("."))

    yield from below(schema, "")


def catalogue() -> Iterator[tuple[str, list[str]]]:
    """Measures, pictures and packaged cases."""
    from ryusa.cases import FOLDERS, case_files
    from ryusa.catalogue import MEASURES, PICTURES

    yield "measures", [one.name for one in MEASURES]
    yield "pictures", [one.name for one in PICTURES]
    yield "cases", [name for folder in FOLDERS for name in case_files(folder)]


def kept() -> dict[str, set[str]]:
    """What promised.txt holds."""
    lines = KEPT.read_text(encoding="utf-8").splitlines() if KEPT.exists() else []
    parts = [line.partition(": ") for line in lines]
    return {place.removesuffix(":"): set(names.split(" | ")) - {""} for place, _, names in parts}


def main() -> None:
    """Add what is new; nothing is taken out."""
    now, before = listed(), kept()
    for place in sorted(now.keys() | before.keys()):
        now[place] = now.get(place, set()) | before.get(place, set())
    lines = [f"{place}: {' | '.join(sorted(names))}".rstrip() for place, names in sorted(now.items())]
    KEPT.write_text("\n".join([*lines, ""]), encoding="utf-8")


def test_nothing_that_was_promised_is_gone() -> None:
    now = listed()
    gone = {place: lost for place, names in kept().items() if (lost := names - now.get(place, set()))}
    assert not gone, "taken out of what is public; see docs/promises.md"


def test_everything_public_is_in_the_list() -> None:
    before = kept()
    assert len(before) > 250
    new = {place: more for place, names in listed().items() if (more := names - before.get(place, set()))}
    assert not new, "python tests/docs/test_promised.py"


def test_the_guides_import_only_what_is_public() -> None:
    public = modules()
    found = [
        (module, name.split(" as ")[0].strip())
        for page in GUIDES
        for module, names in IMPORT.findall((ROOT / page).read_text(encoding="utf-8"))
        for name in names.split(",")
    ]
    assert len(found) > 8
    assert not [
        one for one in found if one[1] not in public.get(one[0], ()) and f"{one[0]}.{one[1]}" not in public
    ]


def test_the_pythons_and_packages_of_the_page_are_those_of_the_package() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    page = " ".join(PAGE.read_text(encoding="utf-8").split())
    assert f"Python {project['requires-python'].removeprefix('>=')} and later" in page
    numpy = next(one for one in project["dependencies"] if one.startswith("numpy"))
    assert f"numpy {numpy.partition('>=')[2].partition(',')[0]} and later" in page


if __name__ == "__main__":
    main()
