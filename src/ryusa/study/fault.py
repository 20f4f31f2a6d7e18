"""Errors in a run or in the judgement of a part: one line for the page, a traceback for the log."""

import sysconfig
import traceback
from collections.abc import Generator, MutableMapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ryusa.errors import RyusaError

_PACKAGE = Path(__file__).resolve().parent.parent
_FOREIGN = tuple(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib"))


@dataclass(frozen=True)
class Fault:
    """The reason why a run or a part has no results.

    Attributes
    ----------
    words : one line, without absolute paths.
    trace : traceback of an error in the program; empty for errors that ryusa raises itself.
    """

    words: str
    trace: str = ""


def fault_of(error: BaseException) -> Fault:
    """Describe an error; any exception other than `RyusaError` is an error in the program.

    >>> fault_of(RyusaError("no hop at all"))
    Fault(words='no hop at all', trace='')
    >>> fault_of(ValueError("no such column")).words
    'error in the program: ValueError: no such column'
    """
    if isinstance(error, RyusaError):
        return Fault(str(error))
    words = f"error in the program: {type(error).__name__}: {error}".strip().rstrip(":")
    place = _place(error)
    trace = "".join(traceback.format_exception(error))
    return Fault(" ".join(f"{words} ({place})".split()) if place else " ".join(words.split()), trace)


def _place(error: BaseException) -> str:
    """The innermost line of ryusa or of a study, rather than that of a library called from it."""
    frames = traceback.extract_tb(error.__traceback__)
    ours = [one for one in frames if not _foreign(one.filename)]
    if not frames:
        return ""
    last = (ours or frames)[-1]
    path = Path(last.filename)
    name = path.relative_to(_PACKAGE).as_posix() if path.is_relative_to(_PACKAGE) else path.name
    return f"{name}, line {last.lineno}, in {last.name}"


def _foreign(file: str) -> bool:
    path = Path(file)
    return not path.is_relative_to(_PACKAGE) and any(path.is_relative_to(place) for place in _FOREIGN)


@contextmanager
def noted(
    faults: MutableMapping[str, Fault], what: str, passing: tuple[type[Exception], ...] = ()
) -> Generator[None]:
    """Record an error raised in the block under `what`, and leave the block; interrupts are not caught.

    Parameters
    ----------
    faults : receives the error.
    what : its key.
    passing : errors that are not caught, such as OSError if a full disk would affect everything after it.
    """
    try:
        yield
    except passing:
        raise
    except Exception as error:  # one part must not end the others
        faults[what] = fault_of(error)
