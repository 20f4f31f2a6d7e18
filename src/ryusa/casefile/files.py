"""Files that a case names: inside the folder of the case file, and nowhere else."""

from collections.abc import Callable
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field

from ryusa.errors import CaseError, ParseError
from ryusa.spelling import nearest_word

T = TypeVar("T")
MOST_NAMES = 1000  # files among which a misspelt one is sought


def toml_text(path: Path) -> str:
    """Text of a TOML file: in UTF-8, or as Windows writes it, with a mark in front or in UTF-16.

    Raises
    ------
    OSError, UnicodeDecodeError : it cannot be read, or is neither.
    """
    raw = path.read_bytes()
    return raw.decode("utf-16" if raw.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig")


def relative(path: str) -> str:
    """Check a path as written in a case file.

    Raises
    ------
    ValueError : it is absolute or leads out of its folder.
    """
    parts = PurePosixPath(path.replace("\\", "/"))
    if parts.is_absolute() or ".." in parts.parts or ":" in path or "\0" in path:
        raise ValueError("needs a path inside the folder of the case file, such as 'grains.csv'")
    return str(parts)


RelativePath = Annotated[str, Field(min_length=1, max_length=400), AfterValidator(relative)]


def inside(folder: Path, key: str, name: str) -> Path:
    """Path of a file or folder that the case of a folder names.

    Raises
    ------
    CaseError : a link leads out of the folder of the case.
    """
    path = (folder / name).resolve()
    if not path.is_relative_to(folder):
        raise CaseError(key, name, "points outside the folder of the case file")
    return path


def contents(folder: Path, key: str, name: str, path: Path, read: Callable[[Path, str, int, int], T]) -> T:
    """What is in a file that a case names.

    Parameters
    ----------
    folder : of the case.
    key, name : of the file in the case.
    path : where it is, as `inside` gives it.
    read : reads path and name; its further arguments, the time of the last change and the size, are for the
        cache that it keeps.

    Raises
    ------
    CaseError : there is no such file, or it cannot be read.
    """
    if not path.is_file():
        there = sorted(one.name for one in islice(path.parent.glob(f"*{path.suffix}"), MOST_NAMES))
        allowed = f"no such file in the folder of the case, {folder}"
        raise CaseError(key, name, allowed, nearest_word(path.name, there))
    try:
        stamp = path.stat()
        return read(path, name, stamp.st_mtime_ns, stamp.st_size)
    except OSError as error:
        raise CaseError(key, name, f"cannot be read: {error.strerror or error}") from None
    except ParseError as error:
        raise CaseError(key, None, str(error)) from error
