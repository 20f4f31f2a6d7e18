"""Every kept table stands in the list of the evidence, with its command, its page and its age."""

import importlib
import re
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
OF_NO_STATEMENT = {"flows-2026-11-21.json"}  # the first engine's, for comparison in benchmarks/README.md


@pytest.fixture
def ages(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "docs"))
    return importlib.import_module("evidence_ages")


def test_every_kept_table_is_listed(ages: ModuleType) -> None:
    kept = {*(ROOT / "docs" / "ledgers").glob("*.xz"), *(ROOT / "benchmarks" / "results").glob("*.json")}
    listed = [one["kept"] for one in ages.tables()]
    assert len(listed) == len(set(listed))
    left_out = OF_NO_STATEMENT | {Path(one).name for one in listed}
    assert {file.name for file in kept} == left_out


def test_pages_and_programs_are_there(ages: ModuleType) -> None:
    for one in ages.tables():
        assert (ROOT / "docs" / one["page"]).is_file(), one["page"]
        program = re.search(r"benchmarks/\w+\.py", one["command"])
        assert one["command"].split()[0] in {"ryusa", "make"} or (program and (ROOT / program[0]).is_file())


def test_parts_of_a_ledger_that_were_made_later_are_told_apart(ages: ModuleType) -> None:
    paper = ages.made(ROOT / "docs" / "ledgers" / "paper.json.xz")
    assert paper[-1].parts == "the rest"
    assert paper == sorted(paper, key=lambda one: one.day, reverse=True)
    assert len({one.commit for one in paper}) == len(paper)


def test_a_commit_that_is_not_in_the_history_has_no_age(ages: ModuleType) -> None:
    assert ages.since("0" * 40) == "not in this history"
    assert re.fullmatch(r"0 commits in src/ since", ages.since("HEAD"))
