"""Text files from strangers, line by line: sizes are bounded, and every error names line and column."""

import gzip
import io
import math
import re
import zlib
from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol, TextIO, TypeVar

import numpy as np
from numpy.typing import NDArray

from ryusa.errors import ParseError
from ryusa.formats.grains import UNITS, GrainTable
from ryusa.model.arrays import Bools, Floats
from ryusa.units import plain_signs

LONGEST = 1 << 16  # characters of a line
LARGEST = 1.0e12  # of any number in SI
D_LOW, D_HIGH = 1.0e-7, 1.0e3  # diameters [m], as for `grains.diameter`
_INTEGER = re.compile(r"[+-]?[0-9]{1,18}")
_SHOWN = 40  # characters of a word in a message
_NO_TEXT = "expected text in UTF-8, in UTF-16 with its mark, or as Windows writes it in Japan or in the West"
_SAMPLE = 1 << 20  # bytes from which an encoding is found
Head = TypeVar("Head", bound="FrameHead")


def word_column(text: str, k: int) -> int:
    """Column of word k, from 1; behind the end where there are fewer.

    >>> word_column("ab  cd", 1)
    5
    """
    for count, found in enumerate(re.finditer(r"\S+", text)):
        if count == k:
            return found.start() + 1
    return len(text) + 1


def shown(text: str) -> str:
    """Text from a file for a message, shortened and printable."""
    return repr(text if len(text) <= _SHOWN else text[:_SHOWN] + "...")


@dataclass
class Lines:
    """A file and the line that was read last."""

    name: str
    file: TextIO
    number: int = 0
    text: str = ""
    notes: tuple[str, ...] = ()  # what a reader of the case should know about the file

    def advance(self) -> bool:
        """Read the next line; False at the end of the file. Full-width signs become plain ones."""
        self.number += 1
        self.text = ""
        try:
            text = self.file.readline(LONGEST + 1)
        except UnicodeDecodeError:
            raise ParseError(self.name, self.number, 1, _NO_TEXT) from None
        if len(text) > LONGEST:
            raise ParseError(self.name, self.number, LONGEST, f"a line is longer than {LONGEST} characters")
        self.text = plain_signs(text.rstrip("\n"))
        return bool(text)

    def need(self, what: str) -> str:
        """Read the next line, or raise an error that names what it should have been."""
        if not self.advance():
            raise self.error(f"the file ends; expected {what}")
        return self.text

    def error(self, message: str, word: int = 0) -> ParseError:
        """An error at a word of this line."""
        return ParseError(self.name, self.number, word_column(self.text, word) if word else 1, message)

    def integer(self, word: int, what: str, least: int = 0) -> int:
        """Word of this line as a whole number."""
        words = self.text.split()
        found = words[word] if word < len(words) else ""
        if not _INTEGER.fullmatch(found) or int(found) < least:
            raise self.error(
                f"expected {what}, a whole number of at least {least}, found {shown(found)}", word
            )
        return int(found)

    def floats(self, first: int, count: int, what: str) -> list[float]:
        """Words first to first + count - 1 of this line as finite numbers."""
        rows = Rows(self.name, [(self.number, self.text)])
        return [float(one[0]) for one in rows.columns(range(first, first + count), [what] * count)]

    def block(self, n: int) -> "Rows":
        """Read the n lines of a frame.

        Raises
        ------
        ParseError : the file ends before.
        """
        where: list[tuple[int, str]] = []
        for k in range(n):
            if not self.advance():
                raise self.error(f"the file ends after {k} of {n} grains")
            where.append((self.number, self.text))
        return Rows(self.name, where)

    def skip(self, n: int) -> None:
        """Pass over the n lines of a frame."""
        for k in range(n):
            if not self.advance():
                raise self.error(f"the file ends after {k} of {n} grains")


@contextmanager
def opened(path: Path, name: str) -> Generator[Lines]:
    """Open a text file, compressed by gzip or not.

    Raises
    ------
    ParseError : it cannot be opened or read.
    """
    try:
        with path.open("rb") as file:
            packed = file.read(2) == b"\x1f\x8b"
            file.seek(0)
            with gzip.open(file) if packed else file as raw:
                encoding, words = _encoding_of(raw.read(_SAMPLE), name)
                raw.seek(0)
                lines = Lines(name, io.TextIOWrapper(raw, encoding=encoding))
                if words:
                    lines.notes = (f"{name} is read as {words}",)
                yield lines
    except (OSError, EOFError, zlib.error) as error:
        why = getattr(error, "strerror", None) or error
        raise ParseError(name, 1, 1, f"cannot be read ({why})") from None


def _encoding_of(sample: bytes, name: str) -> tuple[str, str]:
    """Encoding of a text, and words for it where that is not UTF-8.

    Raises
    ------
    ParseError : it is no text.
    """
    if sample.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16", ""
    try:
        # the last sign may be cut off
        sample[: sample.rfind(b"\n") + 1 or None].decode("utf-8")
        return "utf-8-sig", ""
    except UnicodeDecodeError:
        pass
    for encoding, words, fits in (
        ("cp932", "Shift-JIS", _is_japanese),
        ("cp1252", "Windows-1252, Western Europe", lambda _: True),
    ):
        try:
            if fits(sample[: sample.rfind(b"\n") + 1 or None].decode(encoding)):
                return encoding, words
        except UnicodeDecodeError:
            continue
    raise ParseError(name, 1, 1, _NO_TEXT)


def _is_japanese(text: str) -> bool:
    """Whether what is decoded as Japanese is: no half-width kana, and no sign within a Latin word.

    Letters with accents, decoded so, give both: 'Größe', 'µm', 'diamètre'.
    """
    return not re.search(r"[\uff61-\uff9f\ue000-\uf8ff]|[A-Za-z][\u3040-\u9fff]", text)


@dataclass(frozen=True)
class Rows:
    """Lines of one frame, one grain each, with their numbers in the file."""

    name: str
    where: list[tuple[int, str]]
    column_of: Callable[[str, int], int] = word_column
    split: Callable[[str], list[str]] = str.split
    number: Callable[[str], str] = str.strip  # a cell as Python writes numbers

    def error(self, row: int, word: int, message: str) -> ParseError:
        """An error at a word of a row."""
        number, text = self.where[row]
        return ParseError(self.name, number, self.column_of(text, word), message)

    def columns(self, words: Sequence[int], names: Sequence[str]) -> list[NDArray[np.float64]]:
        """Some words of every row as finite numbers, one array per word."""
        found: list[list[float]] = []
        for row, (_, text) in enumerate(self.where):
            cells = self.split(text)
            try:
                values = [float(cells[k]) for k in words]
            except (ValueError, IndexError):
                values = [math.nan]
            if "_" in text or not all(map(math.isfinite, values)):
                values = self._one_by_one(row, cells, words, names)
            found.append(values)
        return [np.array(one) for one in zip(*found, strict=True)]

    def _one_by_one(
        self, row: int, cells: list[str], words: Sequence[int], names: Sequence[str]
    ) -> list[float]:
        values: list[float] = []
        for k, name in zip(words, names, strict=True):
            cell = cells[k].strip() if k < len(cells) else ""
            try:
                value = float(self.number(cell))
            except ValueError:
                value = math.nan
            if "_" in cell or not math.isfinite(value):
                raise self.error(row, k, f"expected {name}, a finite number, found {shown(cell)}")
            values.append(value)
        return values

    def integers(self, word: int, name: str) -> NDArray[np.int64]:
        """A word of every row as a whole number."""
        found: list[int] = []
        for row, (_, text) in enumerate(self.where):
            cells = self.split(text)
            cell = cells[word].strip() if word < len(cells) else ""
            if not _INTEGER.fullmatch(cell):
                raise self.error(row, word, f"expected {name}, a whole number, found {shown(cell)}")
            found.append(int(cell))
        return np.array(found, dtype=np.int64)


@dataclass(frozen=True)
class ReadOptions:
    """What a file leaves open and the case states.

    Attributes
    ----------
    frame : number of the frame, from 0; None takes the last.
    length, time, mass : units of the file in SI [m], [s], [kg].
    stated : whether the case states the units.
    fixed_types : types of grains that never move.
    """

    frame: int | None = None
    length: float = 1.0
    time: float = 1.0
    mass: float = 1.0
    stated: bool = False
    fixed_types: tuple[int, ...] = ()

    def in_si(self, columns: dict[str, Floats]) -> dict[str, Floats]:
        """Columns of the file in SI."""
        factors = {
            "m": self.length, "m/s": self.length / self.time, "rad/s": 1.0 / self.time,
            "kg": self.mass, "kg/m3": self.mass / self.length**3,
        }  # fmt: skip
        return {name: values * factors[UNITS[name]] for name, values in columns.items()}

    def fixed(self, rows: Rows, word: int | None) -> Bools:
        """Whether each grain is of a type that never moves; the type is this word of a row."""
        types = rows.integers(word, "the type of a grain") if word is not None else np.zeros(0, np.int64)
        for one in self.fixed_types:
            if one not in types:
                there = ", ".join(map(str, np.unique(types)[:20].tolist())) or "none"
                raise rows.error(
                    0, word or 0, f"build.fixed_types: expected grains of type {one}; there are {there}"
                )
        return np.isin(types, self.fixed_types) if len(types) else np.zeros(len(rows.where), dtype=np.bool_)

    def no_such_frame(self, name: str, line: int, n_frame: int) -> ParseError:
        """Error for a file that has not the frame."""
        if n_frame == 0:
            return ParseError(name, line, 1, "expected a frame of grains, found none")
        return ParseError(
            name, line, 1, f"build.frame = {self.frame}: the file has frames 0 to {n_frame - 1}"
        )


def checked(table: GrainTable, rows: Rows, words: dict[str, int]) -> GrainTable:
    """Table in order of the ids, where it has them; `words` are the places of its columns in a row.

    Raises
    ------
    ParseError : a size or a number that cannot be, an id that appears twice, or no free grain.
    """
    for name, values in table.columns.items():
        low, high = (D_LOW, D_HIGH) if name == "d" else (-LARGEST, LARGEST)
        wrong = ~((values >= low) & (values <= high))
        if wrong.any():
            row = int(np.argmax(wrong))
            what = "a diameter" if name == "d" else f"column '{name}'"
            raise rows.error(
                row,
                words.get(name, 0),
                f"expected {what} from {low:g} to {high:g} {UNITS[name]}, found {values[row]:g}",
            )
    if table.fixed.all():
        raise rows.error(
            len(rows.where) - 1, 0, "expected at least one free grain: the file has no free grain"
        )
    if not len(table.ids):
        return table
    order = np.argsort(table.ids, kind="stable")
    twice = np.flatnonzero(np.diff(table.ids[order]) == 0)
    if len(twice):
        row = int(order[twice[0] + 1])
        raise rows.error(row, words.get("id", 0), f"the id {table.ids[row]} appears twice")
    return replace(
        table,
        columns={name: values[order] for name, values in table.columns.items()},
        fixed=table.fixed[order],
        group=tuple(table.group[k] for k in order) if table.group else (),
        labels=tuple(table.labels[k] for k in order),
        ids=table.ids[order],
        image=table.image[order] if len(table.image) else table.image,
    )


class FrameHead(Protocol):
    """What stands before the grains of a frame."""

    @property
    def n(self) -> int:
        """Number of grains."""
        ...


def frame_asked_for(
    lines: Lines, options: ReadOptions, next_head: Callable[[], Head | None]
) -> tuple[Head, Rows]:
    """Head and rows of the frame that the case asks for, the last one with grains where it asks for none.

    Parameters
    ----------
    lines : the file.
    next_head : reads the head of the next frame; None at the end of the file.
    """
    n_frame, kept, empty = 0, None, False
    while (head := next_head()) is not None:
        empty = head.n == 0
        if empty and options.frame == n_frame:
            raise lines.error(f"build.frame = {n_frame}: this frame holds no grain")
        if not empty and options.frame in {None, n_frame}:
            kept = head, lines.block(head.n)
        else:
            lines.skip(head.n)
        n_frame += 1
        if n_frame - 1 == options.frame:
            break
    if kept is None:
        n_held = 0 if options.frame is None else n_frame
        raise options.no_such_frame(lines.name, lines.number, n_held)
    if empty:
        lines.notes += (f"the last frame of {lines.name} holds no grain: the last that does is read",)
    return kept
