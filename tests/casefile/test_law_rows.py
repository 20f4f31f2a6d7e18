"""`ryusa check` says what each word chooses: what it means, and where it comes from."""

from typing import Any

import pytest

from ryusa.casefile.case import Case
from ryusa.casefile.laws import law_rows
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.laws._family import Family
from ryusa.laws.families import FAMILIES, Above, Arm, DampingLaw, DragOfForm, Pressure, SideWalls, Unloading

CHOICES = [choice for family in FAMILIES for choice in family if choice.word]


def with_word(choice: Family) -> Case:
    """A case that makes this choice, its other keys unchanged and unchecked."""
    beside: dict[type[Family], dict[str, Any]] = {
        DampingLaw: {"law": "Hertz-Mindlin"}, Unloading: {"law": "Hertz-Mindlin"},
        Arm: {"model": "constant"}, SideWalls: {"side_walls": 0.1}, Above: {"profile": "uniform"},
    }  # fmt: skip
    case = read(case_path("weir.toml" if isinstance(choice, Pressure) else "movable_bed.toml"))
    if isinstance(choice, DragOfForm):
        case = case.model_copy(update={"grains": case.grains.model_copy(update={"shape": "rod"})})
    *sections, leaf = choice.key.split(".")
    parents: list[Any] = [case]
    for name in sections:
        parents.append(getattr(parents[-1], name))
    changed = parents[-1].model_copy(update={leaf: choice.word, **beside.get(type(choice), {})})
    for name, parent in zip(reversed(sections), reversed(parents[:-1]), strict=True):
        changed = parent.model_copy(update={name: changed})
    return changed


@pytest.mark.parametrize("choice", CHOICES, ids=lambda one: f"{one.key} = {one.word}")
def test_every_choice_is_printed_with_what_it_means_and_its_source(choice: Family) -> None:
    (row,) = [row for row in law_rows(with_word(choice)) if row.name == choice.key]
    assert row.shown == choice.word
    assert choice.about in row.origin
    assert choice.source in row.origin


def test_keys_of_a_column_are_not_printed_without_one() -> None:
    case = read(case_path("saltation.toml"))
    names = {row.name for row in law_rows(case)}
    assert {"contact.slip", "water.drag"} <= names
    assert "water.drag_of_form" not in names  # of spheres
    assert not names & {
        "water.lift",
        "water.hindrance",
        "water.column.bed",
        "rolling.arm",
        "water.column.side_friction",
    }


@pytest.mark.parametrize(("slip", "cap"), [("spring", "spring"), ("total", "total")])
def test_a_choice_that_the_case_leaves_open_is_printed_with_its_default(slip: str, cap: str) -> None:
    case = read(case_path("saltation.toml"), {"contact.slip": slip})
    rows = {row.name: row for row in law_rows(case)}
    assert rows["contact.cap"].shown == cap
    assert rows["contact.cap"].origin.endswith("(contact.cap not given)")
    assert not rows["contact.slip"].origin.endswith("not given)")


def test_a_dry_case_names_no_law_of_water() -> None:
    case = read(case_path("heap.toml"))
    assert {row.name.split(".")[0] for row in law_rows(case)} == {"contact", "rolling"}
