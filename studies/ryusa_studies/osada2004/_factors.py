"""Free choices that the paper leaves open, designs.toml; a part takes those that touch its claims."""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ryusa.study import Design, Factor, Plan

STANDARD, FULL = 16, 32  # settings beside the one as shipped: whole blocks of the design
Levels = Mapping[str, Mapping[str, str]]  # keys of the case that each level changes, with their values

_GIVEN: Mapping[str, Any] = tomllib.loads(
    Path(__file__).with_name("designs.toml").read_text(encoding="utf-8")
)


def n_settings(plan: Plan) -> int:
    """Settings beside the one as shipped: the same number for every part of the study."""
    return plan.pick(0, STANDARD, FULL)


class OpenChoices(Design):
    """The free choices of a part."""

    def sets(self, plan: Plan) -> list[dict[str, str]]:
        """Settings of a level, the one as shipped first."""
        return self.settings(n_settings(plan))


def design(name: str, own: Mapping[str, Levels] | None = None) -> OpenChoices:
    """Return the design of that name; `own` has levels that follow from an equation, by factor."""
    given = _GIVEN[name]
    levels = _GIVEN["shared"] | _GIVEN.get(given.get("of"), {}) | given | (own or {})
    return OpenChoices(tuple(_factor(one, levels[one]) for one in given["factors"]))


def _factor(name: str, levels: Levels | list[str]) -> Factor:
    return Factor(name, levels if isinstance(levels, Mapping) else {one: {} for one in levels})
