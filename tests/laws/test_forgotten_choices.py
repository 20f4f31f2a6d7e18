"""A choice added to a family is either dispatched by its law or an error by name: none is passed over."""

import ast
import inspect
import json
import subprocess
import sys

import pytest

from ryusa.laws import families
from ryusa.laws.families import FAMILIES, Cap, Slip

# A law and one line in families.py are enough; in all others a new choice needs code of its own.
BY_LAW_ALONE = {
    "Adhesion", "Arm", "Profile", "Drag", "Hindrance", "Lift", "Magnus", "WaterTorque", "Rebound", "Mixing",
    "SideWalls",
}  # fmt: skip
IMPORT_ALL = """
import importlib, json, sys, types
from ryusa.laws import families
from ryusa.laws._family import Family

for room in ("build", "water.coupling", "engine.cpu.engine"):
    importlib.import_module("ryusa." + room)

def of_families(thing):
    kind = thing if isinstance(thing, type) else type(thing)
    return thing is families or issubclass(kind, Family) and kind is not Family

# Modules that hold a family, a choice or the table of families; the others cannot ask for any of them.
holders = [
    name for name, module in sys.modules.items()
    if name.partition(".")[0] == "ryusa" and module is not families
    and any(of_families(thing) for thing in list(vars(module).values()))
]
answers = {}
for name, source in json.load(sys.stdin).items():
    answers[name] = ""
    try:
        table = sys.modules["ryusa.laws.families"] = types.ModuleType("ryusa.laws.families")
        sys.modules["ryusa.laws"].families = table
        exec(compile(source, "families.py", "exec"), vars(table))
        for holder in holders:
            sys.modules.pop(holder, None)
        for holder in holders:
            importlib.import_module(holder)
    except TypeError as error:
        answers[name] = str(error)
print(json.dumps(answers))
"""


def with_one_more(name: str, law: bool) -> str:
    """Text of families.py with a further choice at the end of one family, with the law of another or none."""
    text = inspect.getsource(families)
    (family,) = (
        node for node in ast.parse(text).body if isinstance(node, ast.ClassDef) and node.name == name
    )
    members = [node.targets[0].id for node in family.body if isinstance(node, ast.Assign)]  # type: ignore[attr-defined]
    found = [choice.name for one in FAMILIES if one.__name__ == name for choice in one if choice.function]
    function = f"{found[-1]}[2]" if law and found else "None"
    line = f'    FORGOTTEN = ({len(members)}, "forgotten", {function}, "a choice that no code knows")'
    lines = text.splitlines()
    return "\n".join([*lines[: family.end_lineno], line, *lines[family.end_lineno :]])


@pytest.fixture(scope="module")
def errors() -> dict[str, str]:
    """What importing ryusa with one more choice says, by family, with a law and without one."""
    names = [family.__name__ for family in FAMILIES]
    texts = {f"{name} {law}": with_one_more(name, law) for name in names for law in (True, False)}
    done = subprocess.run(
        [sys.executable, "-c", IMPORT_ALL], input=json.dumps({"": inspect.getsource(families), **texts}),
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    return json.loads(done.stdout)


def test_all_families_import_without_an_error(errors):
    assert errors[""] == ""


@pytest.mark.parametrize("name", [family.__name__ for family in FAMILIES])
def test_a_choice_without_a_law_that_no_code_knows_is_an_error_by_name(name, errors):
    assert f"{name}.FORGOTTEN ('forgotten')" in errors[f"{name} False"]


@pytest.mark.parametrize("name", [family.__name__ for family in FAMILIES])
def test_a_choice_with_a_law_is_dispatched_or_an_error_by_name(name, errors):
    expected = "" if name in BY_LAW_ALONE else f"{name}.FORGOTTEN ('forgotten')"
    assert expected in errors[f"{name} True"]
    assert bool(errors[f"{name} True"]) == bool(expected)


def test_choices_without_a_law_of_their_own_differ_by_their_marks():
    for family in (Slip, Cap):
        assert len({choice.marks for choice in family}) == len(family)
