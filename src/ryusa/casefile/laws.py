"""Rows of `ryusa check` about laws: what each word of the case chooses, and its source."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ryusa.casefile.resolved import resolved
from ryusa.casefile.rows import ExplainRow, word
from ryusa.laws.families import FAMILIES, Rolling

if TYPE_CHECKING:
    from ryusa.casefile.case import Case
    from ryusa.casefile.derive import Derived

# Keys that mean something only beside another key of their section.
_ONLY_WITH = {"water.above": "depth", "water.column.side_friction": "side_walls"}


def law_rows(case: "Case", derived: "Derived") -> list[ExplainRow]:
    """One row for each family of laws that the case makes a choice in."""
    data = resolved(case, derived)
    rows: list[ExplainRow] = []
    for family in FAMILIES:
        *sections, leaf = family.key.split(".")
        section = _section(data, sections)
        if section.get(leaf) is None or section.get(_ONLY_WITH.get(str(family.key), leaf)) is None:
            continue
        if family.key == "rolling.arm" and "arm" not in Rolling.of(section["model"]).takes:
            continue
        choice = family.of(section[leaf])
        source = f"; {choice.source}" if choice.source else ""
        rows.append(word("laws", family.key, choice.word, f"{choice.about}{source}"))
    return rows


def _section(data: Mapping[str, Any], path: list[str]) -> Mapping[str, Any]:
    """A section of a resolved case; empty where the case has none."""
    for name in path:
        data = data.get(name) or {}
    return data
