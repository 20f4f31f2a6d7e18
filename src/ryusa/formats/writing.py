"""Writing of large files in pieces: complete under their name, or not there."""

import os
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path

from ryusa.errors import ResultsError


@contextmanager
def written(path: Path) -> Generator[Path]:
    """Path of a temporary file beside `path`, which takes its place at the end of the block.

    Raises
    ------
    ResultsError : the disk refuses; `path` is unchanged and the temporary file removed.
    """
    temporary = path.with_name(f".{path.name}.new")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        with temporary.open("rb+") as file:
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as error:
        raise ResultsError(f"{path}: cannot be written ({error.strerror or error})") from None
    finally:
        temporary.unlink(missing_ok=True)
