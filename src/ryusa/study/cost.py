"""Cost of a study before it starts: runs, seconds, bytes."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ryusa.errors import CaseError
from ryusa.running.folder import format_bytes, free_bytes, nearest_existing
from ryusa.study.task import CaseRun, Task
from ryusa.version import __version__, commit

LATE = 3.0  # time limit of a job over the time estimated
SHORTEST = 30  # time limit of a job at least [min]
_MEMORY = 1.2  # memory limit of a job over the memory estimated
_COMPILING = 400_000_000  # on top while a first run compiles its laws [B]


@dataclass(frozen=True)
class CostEstimate:
    """Estimated cost of the runs of a study.

    Attributes
    ----------
    costs : runs to be made, with the estimated core seconds of each.
    there : finished runs of the same case, which will be opened.
    disk : size of the runs to be made [bytes].
    jobs : number of runs at a time.
    others : number of finished runs made by other states of the code, by state.
    basis : what the costs follow from, in words.
    """

    costs: Mapping[Task, float]
    there: tuple[Task, ...]
    disk: int
    jobs: int
    others: Mapping[str, int] = field(default_factory=dict[str, int])
    basis: str = "by rule of thumb"

    @property
    def core_seconds(self) -> float:
        """Time for all runs one after the other [s]."""
        return sum(self.costs.values())

    @property
    def seconds(self) -> float:
        """Wall time [s]; at least that of the longest run."""
        return max(self.core_seconds / self.jobs, max(self.costs.values(), default=0.0))

    def __str__(self) -> str:
        if not self.costs:
            return f"nothing to run; {_runs(len(self.there), 'finished ')} will be opened{self._old()}"
        there = f" ({len(self.there)} more are there and will be opened)" if self.there else ""
        at_once = "one at a time" if self.jobs == 1 else f"{self.jobs} at a time"
        return (
            f"{_runs(len(self.costs))} to make{there}: about {duration(self.seconds)} {at_once} "
            f"({self.core_seconds / 60:.0f} core minutes {self.basis}, compiling apart), "
            f"{format_bytes(self.disk)} on the disk"
            f"{self._old()}"
        )

    def _old(self) -> str:
        if not self.others:
            return ""
        made = ", ".join(f"{n} by {code_in_words(code)}" for code, n in self.others.items())
        vague = "; changes that no commit holds count as another state" if "+" in "".join(self.others) else ""
        return (
            f"\nOther states of the code than the present {code_in_words(present())} made "
            f"{sum(self.others.values())} of the {len(self.there)} that are there ({made}{vague}); "
            "--again makes all anew"
        )


def _runs(n: int, how: str = "") -> str:
    return f"{n} {how}{'run' if n == 1 else 'runs'}"


def code_of(origin: Mapping[str, Any]) -> str:
    """State of the code that made a run, from its provenance: the commit if known, else the version."""
    return str(origin.get("commit") or f"ryusa {origin.get('ryusa') or 'of unknown version'}")


def present() -> str:
    """State of the code that is running."""
    return code_of({"commit": commit(), "ryusa": __version__})


def is_other(code: str, opened: bool) -> bool:
    """Whether a run was made, or may have been made, by a state of the code other than the present one.

    A commit with uncommitted changes does not identify one state, so an opened run may be of another.
    """
    return code != present() or (opened and code.endswith("+"))


def code_in_words(code: str) -> str:
    """State of the code in short form.

    >>> code_in_words("0123456789abcdef+"), code_in_words("ryusa 0.1.0")
    ('0123456789ab with changes', 'ryusa 0.1.0')
    """
    if code.startswith("ryusa"):
        return code
    return code.removesuffix("+")[:12] + (" with changes" if code.endswith("+") else "")


def estimate_cost(wanted: Iterable[Task], folder: Path, *, jobs: int, again: bool = False) -> CostEstimate:
    """Estimate the cost of the runs that are not yet in `folder`; every case is read and checked.

    Raises
    ------
    CaseError : a case cannot be run.
    """
    wanted = list(dict.fromkeys(wanted))
    origins = {} if again else {one: one.origin(folder / one.folder) for one in wanted}
    there = {one: code_of(found) for one, found in origins.items() if found is not None}
    costs = {one: one.cost() for one in wanted if one not in there}
    others = Counter(code for code in there.values() if is_other(code, opened=True))
    disk = sum(one.disk() for one in costs)
    return CostEstimate(costs, tuple(there), disk, jobs, dict(others.most_common()), basis_of(costs))


def basis_of(tasks: Iterable[Task]) -> str:
    """What the costs of tasks follow from, in words."""
    known = [one.wall_time().runs > 0 for one in tasks if isinstance(one, CaseRun)]
    if not any(known):
        return "by rule of thumb"
    if all(known):
        return "as runs of the same kinds took on this machine"
    return (
        f"as runs of the same kinds took on this machine, {len(known) - sum(known)} of {len(known)} by rule "
        "of thumb"
    )


def refuse_if_too_big(ahead: CostEstimate, folder: Path) -> None:
    """Compare the size of the runs with the free space on the disk.

    Raises
    ------
    CaseError : the runs would not fit.
    """
    place = nearest_existing(folder)
    free = free_bytes(place)
    if ahead.disk > free:
        raise CaseError(
            "disk",
            None,
            f"{len(ahead.costs)} runs need {format_bytes(ahead.disk)}, but only {format_bytes(free)} are "
            f"free at {place}. "
            "Choose another disk with -o, or run fewer parts at a time",
        )


def memory_of(tasks: Iterable[Task]) -> int:
    """Memory that the largest of some runs needs, with a margin and room to compile its laws [B]."""
    from ryusa.casefile.derive import derive
    from ryusa.casefile.estimate import memory_needed

    cases = (one.read() for one in tasks if isinstance(one, CaseRun))
    return (
        math.ceil(_MEMORY * max((memory_needed(case, derive(case)) for case in cases), default=0.0))
        + _COMPILING
    )


def by_cores(core_seconds: float, longest: float, n: int) -> str:
    """Wall time of n runs by number of cores, in words.

    Parameters
    ----------
    core_seconds : of all runs [s].
    longest : time of the longest run [s], below which no number of cores brings it.
    n : number of runs.

    >>> by_cores(1200.0, 200.0, 6)
    '1 in 20 min, 2 in 10 min, 4 in 5 min, 8 in 3 min'
    """
    cores = (one for one in (1, 2, 4, 8, 16, 32, 64) if one == 1 or one <= 2 * n)
    return ", ".join(f"{one} in {duration(max(core_seconds / one, longest))}" for one in cores)


def duration(seconds: float) -> str:
    """A time in words, with the digits of an estimate.

    >>> duration(42.0), duration(600.0), duration(9000.0)
    ('42 s', '10 min', '2.5 h')
    """
    if seconds < 90.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400.0 else f"{seconds / 3600:.1f} h"
