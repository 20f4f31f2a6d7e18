"""Reading, overrides, and the published JSON Schema."""

import json
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from ryusa.casefile import (
    Case,
    all_keys,
    derive,
    described,
    json_schema,
    json_schema_text,
    read,
    read_text,
    resolved,
)
from ryusa.errors import CaseError

CaseOf = Callable[..., Case]
DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize(
    ("path", "named"),
    [
        ("dense_3d", "dense_3d"),
        ("dense_3d.toml", "dense_3d"),
        ("paper/fig19", "paper/fig19"),
        ("none", "saltation"),
        ("runs/dense_3d", "saltation"),
    ],
)
def test_a_missing_file_that_is_a_packaged_case_is_answered_by_how_to_write_it(path: str, named: str) -> None:
    with pytest.raises(CaseError, match=f"file not found; 'ryusa new {named}' writes"):
        read(path)


def test_a_case_is_frozen_and_remembers_where_it_came_from(text: str, tmp_path: Path) -> None:
    (tmp_path / "my.toml").write_text(text, encoding="utf-8")
    case = read(tmp_path / "my.toml", {"seed": "7"})
    assert (case.name, case.seed, case.text, case.overrides) == ("my", 7, text, {"seed": "7"})
    with pytest.raises(ValidationError):
        case.seed = 8  # type: ignore[misc]


def test_an_override_takes_toml_values_and_plain_text(case: CaseOf) -> None:
    assert case(**{"contact.stiffness": "10 N/cm"}).contact.stiffness == 1000.0
    assert case(**{"contact.stiffness": '"10 N/cm"'}).contact.stiffness == 1000.0
    assert (
        case(**{"grains.spread": "0.1"}, build="{kind='packing', columns=5, layers=2}").grains.spread == 0.1
    )
    assert case(**{"title": "1\nseed = 5"}).seed == 1


def test_an_override_replaces_its_alternative(case: CaseOf) -> None:
    assert derive(case(**{"contact.friction": "0.5"})).mu == 0.5
    assert case(**{"contact.damping": "0.001 N s/cm"}).contact.restitution is None
    assert case(**{"motion.slope_angle": "40 deg"}).motion.slope is None


def test_an_override_reaches_into_lists(text: str) -> None:
    more = text + '[[timeline]]\nat = "0.01 s"\nfriction = 0.5\n'
    assert read_text(more, {"timeline.0.at": "0.02 s"}).timeline[0].at == 0.02


def test_alternative_keys_for_slope_and_sizes_agree(case: CaseOf) -> None:
    slopes = [case(**{"motion.slope": value}).motion.slope for value in ("'1/20'", "0.05", "'5 %'")]
    assert slopes == [0.05, 0.05, 0.05]


def test_every_key_has_a_description() -> None:
    assert [key for key, about in described().items() if len(about) < 4] == []
    assert len(all_keys()) > 90


def test_the_schema_describes_every_key_and_forbids_unknown_ones() -> None:
    schema: dict[str, Any] = json_schema()
    for name, one in schema["$defs"].items():
        if one.get("type") == "object":
            assert one["additionalProperties"] is False, name
            for key, about in one["properties"].items():
                assert "description" in about, f"{name}.{key}"


def test_the_published_schema_is_current() -> None:
    published = (DOCS / "case.schema.json").read_text(encoding="utf-8")
    assert json.loads(published) == json.loads(json_schema_text()), "run: python docs/generate.py"


def test_shipped_cases_use_only_known_keys_and_no_path_of_a_machine(packaged: list[Path]) -> None:
    for file in packaged:
        content = file.read_text(encoding="utf-8")
        assert not re.search(r"[\"'](/|[A-Z]:)", content), file.name


@pytest.mark.parametrize(
    ("key", "value", "kept"),
    [
        ("contact.stiffness", "{ overlap = 0.01, speed = '0.6 m/s' }", {"overlap": 0.01, "speed": 0.6}),
        ("contact.stiffness", "{ collision_time = '1e-4 s' }", {"collision_time": 1e-4}),
        ("contact.stiffness", "'100 N/cm'", 1e4),
        ("grains.spread", "{ kind = 'normal', ratio = 0.1 }", {"kind": "normal", "ratio": 0.1}),
        ("grains.spread", "0.1", 0.1),
    ],
)
def test_every_alternative_key_is_serialised_without_a_warning(
    case: CaseOf, key: str, value: str, kept: object
) -> None:
    build = "{ kind = 'packing', columns = 5, layers = 2 }"
    found = case(build=build, **{key: value})
    section, name = key.split(".")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert found.model_dump(mode="json")[section][name] == kept
        assert found.model_dump()[section][name] == kept
        found.model_dump_json()
        assert resolved(found)["contact"]["stiffness"] == derive(found).k_n


def test_every_packaged_case_is_serialised_without_a_warning(packaged: list[Path]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for path in packaged:
            assert resolved(read(path))["contact"]["stiffness"] > 0.0
