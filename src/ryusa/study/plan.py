"""How much a study covers."""

from dataclasses import dataclass
from enum import StrEnum
from typing import TypeVar

Value = TypeVar("Value")


class Level(StrEnum):
    """How much is run."""

    QUICK = "quick"  # the case files as they are, one seed: indicative
    STANDARD = "standard"  # three seeds and the sweeps that decide a verdict
    FULL = "full"  # every sweep


@dataclass(frozen=True)
class Plan:
    """Level and seeds of a study."""

    level: Level = Level.STANDARD
    seeds: tuple[int, ...] = (1, 2, 3)

    def pick(self, quick: Value, standard: Value, full: Value | None = None) -> Value:
        """Give the value of this level; the full one takes the standard one where it has none."""
        if self.level is Level.QUICK:
            return quick
        return full if self.level is Level.FULL and full is not None else standard
