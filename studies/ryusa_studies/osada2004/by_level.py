"""In how many settings each claim holds, by the level of the free choices that several claims share."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ryusa.study.verdict import Count, Key, counted, first_reading, held_of
from ryusa_studies.osada2004._parts import DRAG, PARTING, PHI, RATIO, ROTATION, SLIP

SHARED = (PHI, SLIP, PARTING, RATIO, ROTATION, DRAG)  # levels of the others differ between parts


@dataclass(frozen=True)
class LevelCell(Count):
    """One claim at one level: settings in which it holds, of all that were run with the level."""

    @property
    def look(self) -> str:
        """Class of its colour on the page."""
        if self.of == self.undecided:
            return "open" if self.undecided else "waits"
        return "yes" if self.holds == self.of else "partly" if self.holds else "no"


@dataclass(frozen=True)
class LevelRow:
    """One claim at every level; `decides` if this choice decides it beyond chance."""

    claim: str
    cells: tuple[LevelCell, ...]
    decides: bool


@dataclass(frozen=True)
class ChoiceTable:
    """One free choice, its levels, the one as shipped first, and every claim that it was varied for."""

    choice: str
    levels: tuple[str, ...]
    rows: tuple[LevelRow, ...]


def tables(findings: Sequence[Mapping[str, Any]]) -> list[ChoiceTable]:
    """Return a table for each shared choice that was varied.

    Parameters
    ----------
    findings : entries as the JSON file holds them.
    """
    held = {one["id"]: first_reading(held_of(one["trials"]), one["readings"]) for one in findings}
    found: list[ChoiceTable] = []
    for choice in SHARED:
        values = {
            claim: list(dict.fromkeys(value for key in sets if (value := dict(key).get(choice)) is not None))
            for claim, sets in held.items()
        }
        varied = {claim: levels for claim, levels in values.items() if len(levels) > 1}
        if not varied:
            continue
        levels = tuple(dict.fromkeys(value for tried in varied.values() for value in tried))
        rows = [
            LevelRow(
                one["id"],
                tuple(_cell(held[one["id"]], choice, level) for level in levels),
                bool(one["deciding_factor"]) and one["deciding_factor"]["choice"] == choice,
            )
            for one in findings
            if one["id"] in varied
        ]
        found.append(ChoiceTable(choice, levels, tuple(rows)))
    return found


def _cell(held: Mapping[Key, bool | None], choice: str, level: str) -> LevelCell:
    count = counted([one for key, one in held.items() if dict(key).get(choice) == level])
    return LevelCell(count.holds, count.of, count.undecided)
