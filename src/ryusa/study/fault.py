"""What went wrong in one run or in judging one experiment: a line for its row, a traceback for the log."""

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
    """Why something has no numbers.

    Attributes
    ----------
    words : one line, without a path of the machine.
    trace : traceback where it is an error in the program, empty where `words` say all.
    """

    words: str
    trace: str = ""


def fault_of(error: BaseException) -> Fault:
    """Put an error into words; anything but a named error of ours is a fault of the program.

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
    """The innermost line that is ours, not that of a library which was called from it."""
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
    """Within the block an error is noted under `what` and ends the block alone; an interrupt ends all.

    Parameters
    ----------
    faults : takes what went wrong.
    what : the key it is noted under.
    passing : errors that are not caught, such as OSError where a full disk would spoil all that follows.
    """
    try:
        yield
    except passing:
        raise
    except Exception as error:  # the point of it: one experiment must not cost the others their hours
        faults[what] = fault_of(error)
