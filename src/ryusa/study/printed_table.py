"""Tables of texts, the same for a page and for a terminal."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple


class PrintedCell(NamedTuple):
    """A cell with its look on a page."""

    text: str
    look: str = ""  # classes of `style.html`
    tip: str = ""  # shown where the pointer rests


@dataclass(frozen=True)
class PrintedTable:
    """Heads, and rows of texts.

    Attributes
    ----------
    heads : of the columns, of several lines if need be.
    rows : a cell for each column.
    words : heads of columns that hold words, which begin at the left; the others hold numbers.
    """

    heads: tuple[str, ...]
    rows: Sequence[Sequence[str | PrintedCell]]
    words: frozenset[str] = frozenset()

    def only(self, *heads: str) -> "PrintedTable":
        """The table with these columns alone.

        >>> PrintedTable(("a", "b"), [("x", "1")]).only("b").rows
        [['1']]
        """
        places = [self.heads.index(one) for one in heads]
        return PrintedTable(heads, [[row[k] for k in places] for row in self.rows], self.words)
