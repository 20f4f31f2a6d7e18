"""Files that a case names: inside the folder of the case file, and nowhere else."""

from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from ryusa.errors import CaseError

if TYPE_CHECKING:
    from ryusa.casefile.case import Case


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


def folder_of(case: "Case") -> Path:
    """Folder of the case file; the current one for a case given as text."""
    return (case.path.parent if case.path is not None else Path()).resolve()


def inside(case: "Case", key: str, name: str) -> Path:
    """Path of a file or folder that a case names.

    Raises
    ------
    CaseError : a link leads out of the folder of the case.
    """
    folder = folder_of(case)
    path = (folder / name).resolve()
    if not path.is_relative_to(folder):
        raise CaseError(key, name, "points outside the folder of the case file")
    return path
