"""What a campaign will cost before it starts: runs, seconds, bytes."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ryusa.errors import CaseError
from ryusa.experiments._experiment import Variant
from ryusa.results import schema
from ryusa.running.folder import existing, free_bytes, size


@dataclass(frozen=True)
class Outlook:
    """What lies ahead.

    Attributes
    ----------
    costs : runs to be made, with the core seconds of each by rule of thumb.
    there : finished runs that will be opened, as far as their folders tell.
    disk : bytes that the runs to be made will take.
    jobs : runs at a time.
    """

    costs: Mapping[Variant, float]
    there: tuple[Variant, ...]
    disk: int
    jobs: int

    @property
    def core_seconds(self) -> float:
        """All runs one after the other [s]."""
        return sum(self.costs.values())

    @property
    def seconds(self) -> float:
        """Wall time [s]: no shorter than the longest run."""
        return max(self.core_seconds / self.jobs, max(self.costs.values(), default=0.0))

    def __str__(self) -> str:
        if not self.costs:
            return f"nothing to run; {len(self.there)} finished runs are opened"
        there = f" ({len(self.there)} more are there)" if self.there else ""
        at_once = "one at a time" if self.jobs == 1 else f"{self.jobs} at a time"
        return (
            f"{len(self.costs)} runs to make{there}: about {duration(self.seconds)} {at_once} "
            f"({self.core_seconds / 60:.0f} core minutes by rule of thumb), {size(self.disk)} on the disk"
        )


def outlook(wanted: Iterable[Variant], folder: Path, *, jobs: int, again: bool = False) -> Outlook:
    """Say what it takes to have these runs in `folder`; every case is read, and so checked.

    Raises
    ------
    CaseError : a case cannot be run.
    """
    from ryusa.casefile.estimate import disk_in_all

    wanted = list(dict.fromkeys(wanted))
    there = () if again else tuple(one for one in wanted if _is_there(folder / one.folder))
    costs = {one: cost(one) for one in wanted if one not in set(there)}
    return Outlook(costs, there, sum(disk_in_all(one.read()) for one in costs), jobs)


def cost(one: Variant) -> float:
    """Core seconds of a run by rule of thumb."""
    from ryusa.casefile.estimate import seconds_needed

    return seconds_needed(one.read())


def _is_there(folder: Path) -> bool:
    """Whether a finished run lies there; whether it is of the very same case shows when it is opened."""
    try:
        found = json.loads((folder / schema.PROVENANCE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(found, dict) and found.get("status") == schema.COMPLETE


def refuse_if_too_big(ahead: Outlook, folder: Path) -> None:
    """Compare what the runs will take with the free space on the disk.

    Raises
    ------
    CaseError : they would not fit.
    """
    place = existing(folder)
    free = free_bytes(place)
    if ahead.disk > free:
        raise CaseError(
            "disk",
            None,
            f"{len(ahead.costs)} runs need {size(ahead.disk)}, but only {size(free)} are free at {place}. "
            "Choose another disk with -o, or run fewer experiments at a time",
        )


def duration(seconds: float) -> str:
    """Say a time so that nobody takes it for exact.

    >>> duration(42.0), duration(600.0), duration(9000.0)
    ('42 s', '10 min', '2.5 h')
    """
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400.0 else f"{seconds / 3600:.1f} h"
