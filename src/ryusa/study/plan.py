"""Level and seeds of a study."""

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

Value = TypeVar("Value")


class Level(StrEnum):
    """Extent of a study."""

    QUICK = "quick"  # the case files as they ship, one seed: indicative
    STANDARD = "standard"  # several seeds, and the settings that decide a verdict
    FULL = "full"  # more settings


@dataclass(frozen=True)
class Plan:
    """Level and seeds of a study."""

    level: Level = Level.STANDARD
    seeds: tuple[int, ...] = (1, 2, 3)

    def doubled(self) -> "Plan":
        """The same level with as many seeds again.

        >>> Plan(seeds=(4, 5, 6)).doubled().seeds
        (4, 5, 6, 7, 8, 9)
        """
        after = max(self.seeds) + 1
        return Plan(self.level, (*self.seeds, *range(after, after + len(self.seeds))))

    def pick(self, quick: Value, standard: Value, full: Value | None = None) -> Value:
        """Return the value for this level; the full level uses that of the standard level if it has none."""
        if self.level is Level.QUICK:
            return quick
        return full if self.level is Level.FULL and full is not None else standard
