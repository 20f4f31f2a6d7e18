"""What `print` and a Python prompt show of an object: a few lines, arrays by their shape."""

import dataclasses
import enum
import reprlib
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

WIDTH = 110
_FEW = 4  # numbers of an array that are shown themselves


class ByShape:
    """A dataclass, decorated with repr=False, whose arrays are printed by type and shape."""

    def __repr__(self) -> str:
        fields = [(one.name, getattr(self, one.name)) for one in dataclasses.fields(self) if one.repr]  # type: ignore[arg-type]
        said = ", ".join(f"{name}={short(value)}" for name, value in fields if value is not None)
        return textwrap.fill(
            f"{type(self).__name__}({said})", WIDTH, subsequent_indent="    ", break_long_words=False,
            break_on_hyphens=False,
        )  # fmt: skip


def short(value: Any) -> str:
    """One value in a word or a few.

    >>> short(np.zeros((3, 2))), short(np.arange(3)), short(0.1 + 0.2), short((1.0, 2.0))
    ('float64 (3, 2)', '[0 1 2]', '0.3', '(1, 2)')
    """
    if isinstance(value, np.ndarray):
        few = value.ndim == 1 and value.size <= _FEW and value.dtype.names is None
        return np.array2string(value, precision=6) if few else f"{_type_of(value)} {value.shape}"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, enum.Enum):
        return f"{type(value).__name__}.{value.name}"
    if dataclasses.is_dataclass(value):
        return f"{type(value).__name__}(...)"
    if isinstance(value, tuple):
        items: tuple[Any, ...] = value
        return f"({', '.join(map(short, items))})" if len(items) <= _FEW else f"({len(items)} items)"
    if isinstance(value, Mapping):
        return f"{{{len(value)} keys}}"
    return reprlib.repr(value)


def _type_of(array: np.ndarray) -> str:
    names = array.dtype.names
    return str(array.dtype) if names is None else f"records of {len(names)} fields"


def text_table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Lines of a table whose columns are aligned, the first to the left, the others to the right.

    >>> print(text_table(("name", "value"), [("speed", "1.5"), ("jump length", "0.25")]))
    name         value
    speed          1.5
    jump length   0.25
    """
    lines = [heads, *rows]
    wide = [max(len(line[k]) for line in lines) for k in range(len(heads))]
    made: list[str] = []
    for first, *others in lines:
        right = [one.rjust(w) for one, w in zip(others, wide[1:], strict=True)]
        made.append("  ".join([first.ljust(wide[0]), *right]).rstrip())
    return "\n".join(made)
