"""How a table separates its columns and writes its numbers: spreadsheets do it as their country does."""

import csv
import re
from dataclasses import dataclass

_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+")


@dataclass(frozen=True)
class Dialect:
    """Separator of columns: a comma, a semicolon or a tab."""

    separator: str = ","

    def split(self, text: str) -> list[str]:
        """Cells of one line."""
        if '"' in text:
            return next(csv.reader([text], delimiter=self.separator))
        return text.split(self.separator)

    def heads(self, header: str) -> list[str]:
        """Cells of the header, without the empty ones at its end."""
        cells = self.split(header)
        while len(cells) > 1 and not cells[-1].strip():
            cells.pop()
        return cells

    def cells(self, text: str, n: int) -> list[str]:
        """Cells of one line, without the empty ones that stand behind the n columns of the header."""
        cells = self.split(text)
        return cells[:n] if not any(one.strip() for one in cells[n:]) else cells

    def column(self, text: str, k: int) -> int:
        """Column of the first character of cell k, from 1.

        >>> Dialect().column("a,bc,d", 2)
        6
        """
        at, quoted = 0, False
        for place, sign in enumerate(text):
            if at == k:
                return place + 1 + len(text[place:]) - len(text[place:].lstrip(" "))
            quoted = quoted != (sign == '"')
            at += sign == self.separator and not quoted
        return len(text) + 1

    def blank(self, text: str) -> bool:
        """Whether a line has no cell that says anything, or is a comment."""
        bare = text.strip(self.separator + " \t")
        return not bare or bare.startswith("#")

    def number(self, cell: str) -> str:
        r"""A cell with a decimal point, where its comma has one meaning.

        Between semicolons a comma is a decimal one. Elsewhere '1,234' may stand for a thousand, and stays.

        >>> Dialect(";").number("2,5"), Dialect(";").number("1,234"), Dialect("\t").number("1,234")
        ('2.5', '1.234', '1,234')
        """
        cell = cell.strip()
        if _DECIMAL_COMMA.fullmatch(cell) and (self.separator == ";" or not _THOUSANDS.fullmatch(cell)):
            return cell.replace(",", ".")
        return cell


def dialect_of(header: str) -> Dialect:
    """Dialect of a table, from its header: names of columns hold neither tabs nor semicolons.

    >>> dialect_of("x [mm];z [mm]").separator
    ';'
    """
    bare = re.sub(r'"[^"]*"', "", header)
    return Dialect(next((one for one in "\t;" if one in bare), ","))
