"""Provenance of a page: code, machine, runs, and errors."""

import math
import platform
from collections.abc import Mapping
from typing import Any

from ryusa.engine import registry
from ryusa.running import provenance
from ryusa.study import Fault, Task, TaskResults

_NAMED = 3  # largest number of failed runs that are listed


def counted(results: TaskResults, jobs: int) -> dict[str, Any]:
    """Number of runs made and opened, the code that made them, and wall time."""
    return {
        "runs_made": results.n_run,
        "runs_opened": results.n_opened,
        "wall_s": round(results.seconds, 1),
        "jobs": jobs,
        "commits_of_runs": dict(results.commits.most_common()),
        "of_other_code": dict(results.others.most_common()),
    }


def missing_runs(missing: Mapping[Task, Fault], n: int) -> str:
    """The failed runs with their reasons; only the first few of many."""
    lines = [f"{one.label}: {fault.words}" for one, fault in list(missing.items())[:_NAMED]]
    more = f"; and {len(missing) - _NAMED} more" if len(missing) > _NAMED else ""
    return f"{len(missing)} of {n} runs failed, so it was not judged; {'; '.join(lines)}{more}"


def traces_of(results: TaskResults, faults: Mapping[str, Fault]) -> dict[str, str]:
    """Tracebacks of errors in the program, by the run or part concerned."""
    every = [
        (f"{name}: run {one.label}", fault)
        for name, found in results.missing.items()
        for one, fault in found.items()
    ]
    return {what: fault.trace for what, fault in [*every, *faults.items()] if fault.trace}


def json_number(value: float) -> float | None:
    """The value, or None if it is infinite or nan, which JSON cannot represent."""
    return value if math.isfinite(value) else None


def origin(counts: Mapping[str, Any]) -> dict[str, Any]:
    """Versions, commit and machine, with the counts of the runs."""
    found = provenance.begin(threads=1, seed=None, engine=registry.DEFAULT, overrides={})
    kept = ("ryusa", "commit", "packages", "python", "system", "machine")
    return {
        "made": provenance.now(),
        **{key: found[key] for key in kept},
        **counts,
        "node": platform.machine(),
    }
