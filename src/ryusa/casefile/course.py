"""Keys that give a quantity over time: points of the case, or a CSV file."""

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, partial
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any

from pydantic import Discriminator, Field, Tag

from ryusa.casefile.files import RelativePath, contents, inside
from ryusa.errors import CaseError
from ryusa.formats.series import read_series

MOST_POINTS = 10_000


def file_or_points(value: Any) -> str:
    """Which of the two a key with a course was given."""
    return "<file>" if isinstance(value, str) else "<points>"


FILE_OR_POINTS = Discriminator(file_or_points)
CourseFile = Annotated[RelativePath, Tag("<file>")]
AtPoints = Field(min_length=2, max_length=MOST_POINTS)
Points = Sequence[tuple[float, Any]]


def points_of(
    folder: Path, key: str, given: Points | str, column: str, read: Callable[[str], Any], example: str
) -> Points:
    """Points of a course as given, or as its file holds them; `column` and `example` as of `read_series`.

    Raises
    ------
    CaseError : its file cannot be read.
    """
    if not isinstance(given, str):
        return given

    reader = partial(_read, column=column, read=read, example=example)
    return contents(folder, key, given, inside(folder, key, given), reader)


@lru_cache(maxsize=16)
def _read(
    path: Path, name: str, _changed: int, _size: int, *, column: str, read: Callable[[str], Any], example: str
) -> Points:
    return read_series(path, name, column, read, example)


def faults_of_course(key: str, points: Points) -> Iterator[CaseError]:
    """Find times before the start, or out of order; twice the same is a jump."""
    times = [one[0] for one in points]
    if min(times) < 0.0:
        yield CaseError(key, f"{min(times):g} s", "has a time before the start of the run, 0 s")
    for k, (a, b) in enumerate(pairwise(times)):
        if b < a:
            allowed = f"is the time of point {k + 2}, and the one before is at {a:g} s: order them by time"
            yield CaseError(key, f"{b:g} s", allowed)
            return
    if times[-1] == times[0]:
        yield CaseError(key, f"{times[0]:g} s", "has no duration: all points are at the same time")
