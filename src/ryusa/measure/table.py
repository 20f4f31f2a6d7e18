"""One writer of CSV for everything that is measured."""

import csv
import html
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ryusa.measure.statistics import STAR, Average
from ryusa.notebook import html_table
from ryusa.printed import short, text_table

ROUND_OFF = 1.0e-12  # of the largest number of a column, below which a printed one is 0


_HEADS = ("quantity", "value", "± s.e.", "unit", "n", "window (s)", "steady")


@dataclass(frozen=True, repr=False)
class Averages:
    """A list of averages that can be asked by name, printed and written."""

    title: str
    items: tuple[Average, ...]
    notes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Average:
        for one in self.items:
            if one.name == name:
                return one
        raise KeyError(f"{name!r}; there are: {', '.join(one.name for one in self.items)}")

    def __repr__(self) -> str:
        return "\n".join([self.title, text_table(_HEADS, self._cells()), *self.remarks])

    def _cells(self) -> list[tuple[str, ...]]:
        return [
            (
                one.name, f"{one.value:.4g}", one.error_text, one.unit, str(one.n),
                f"{one.window[0]:.3g} to {one.window[1]:.4g}", one.verdict,
            )
            for one in self.items
            if one.n
        ]  # fmt: skip

    def _repr_html_(self) -> str:
        below = "".join(f"<p>{html.escape(one)}</p>" for one in self.remarks)
        return html_table(_HEADS, self._cells()) + below

    @property
    def remarks(self) -> tuple[str, ...]:
        """What is printed below the averages: errors to be doubted, records that change, and the notes."""
        found: list[str] = []
        if any(one.error_text.endswith("*") for one in self.items):
            found.append(STAR)
        begins = [
            f"{one.name} {'never' if math.isnan(one.steady_from) else f'{one.steady_from:.3g} s'}"
            for one in self.items
            if one.changes
        ]
        if begins:
            found.append(f"not steady over the window; steady from, by MSER: {', '.join(begins)}")
        return (*found, *self.notes)

    def rows(self) -> list[dict[str, object]]:
        """One dictionary per average."""
        return [one.row() for one in self.items]


class Averaged:
    """A record with averages: each is had by its name, and a notebook shows them as a table."""

    averages: Averages

    def __repr__(self) -> str:
        """The averages as a table, and what else the record holds, arrays by their shape."""
        held = {one.name: getattr(self, one.name) for one in fields(self) if one.name != "averages"}  # type: ignore[arg-type]
        beside = ", ".join(f"{name} {short(value)}" for name, value in held.items() if value is not None)
        return f"{self.averages!r}\nbeside them: {beside}" if beside else repr(self.averages)

    def __getitem__(self, name: str) -> Average:
        return self.averages[name]

    def series(self) -> list[dict[str, object]]:
        """Rows of what was averaged: a time series, or single events."""
        rows: list[dict[str, object]] = self.rows()
        return rows

    def rows(self) -> list[dict[str, object]]:
        """Rows of the record."""
        return self.averages.rows()

    def _repr_html_(self) -> str:
        return self.averages._repr_html_()


def lines(columns: Mapping[str, Any]) -> list[dict[str, object]]:
    """Arrays as one dictionary for each of their elements, in order; they are broadcast to one shape."""
    values = [np.ravel(one).tolist() for one in np.broadcast_arrays(*columns.values())]
    return [dict(zip(columns, one, strict=True)) for one in zip(*values, strict=True)]


def rows_of(records: NDArray[Any]) -> list[dict[str, object]]:
    """A structured array as dictionaries; a vector field gives one column per component (x, y, z)."""
    rows: list[dict[str, object]] = []
    names = records.dtype.names or ()
    for record in records:
        row: dict[str, object] = {}
        for name in names:
            value = record[name]
            if np.ndim(value):
                row.update({f"{name}_{axis}": value[k].item() for k, axis in enumerate("xyz"[: len(value)])})
            else:
                row[name] = value.item()
        rows.append(row)
    return rows


def write_csv(path: Path | str, rows: Iterable[Mapping[str, object]]) -> Path:
    """Write rows that share their keys; floats keep all their digits, so reading back loses nothing."""
    path = Path(path)
    rows = list(rows)
    columns = list(dict.fromkeys(key for row in rows for key in row))
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fieldnames=columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return path
