"""The paper as data, paper.toml: its equations and symbols, and how we settled what it leaves open.

Osada K., Shimizu Y., Wakai A. (2004), "Study on some problems in applying the distinct element method to the
analysis of sediment-mixture flows".
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class Equation:
    """One numbered equation and the law or room that carries it."""

    number: str
    formula: str
    says: str
    code: str  # dotted name below ryusa


@dataclass(frozen=True)
class Reading:
    """One doubt and how it was settled."""

    id: str
    where: str
    choice: str
    why: str


_GIVEN = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
CITATION: str = _GIVEN["citation"]
EQUATIONS = {number: Equation(number, **one) for number, one in _GIVEN["equations"].items()}
QUESTIONS: list[dict[str, Any]] = _GIVEN["questions"]  # title, anchor, about, claims
READINGS = {id: Reading(id, **one) for id, one in _GIVEN["readings"].items()}
