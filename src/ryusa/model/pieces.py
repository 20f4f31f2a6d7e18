"""Arrays of which only a piece is in memory at a time."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class RowsInPieces:
    """Arrays of one length, whose rows are made when they are asked for.

    Attributes
    ----------
    names : of the arrays.
    count : rows.
    pieces : consecutive rows of all arrays, by name; at least one piece, which may be empty. Each call begins
        anew; a piece may lie where the one before lay.
    """

    names: tuple[str, ...]
    count: int
    pieces: Callable[[], Iterator[dict[str, np.ndarray]]]

    def within(self, group: str) -> "RowsInPieces":
        """The same arrays under names of a group, as "group/name"."""

        def pieces() -> Iterator[dict[str, np.ndarray]]:
            for piece in self.pieces():
                yield {f"{group}/{name}": one for name, one in piece.items()}

        return RowsInPieces(tuple(f"{group}/{name}" for name in self.names), self.count, pieces)
