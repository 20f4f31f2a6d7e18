"""The folder of a sweep: what it holds of earlier calls, and whether that is the same sweep."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from ryusa.campaigns.sweep.part import SweepRun
from ryusa.campaigns.sweep.plan import SweepPlan
from ryusa.casefile.resolved import resolved
from ryusa.errors import ResultsError
from ryusa.results import schema
from ryusa.running.folder import as_read_back, refuse_if_not_writable, write_json
from ryusa.running.resume import changes_of

PLAN = "plan.json"
RUNS = "runs"
FORMAT = 1
_NAMED = 4  # changes that are named


def refuse_folder(plan: SweepPlan, folder: Path, *, again: bool = False) -> None:
    """Refuse a folder that holds something else, another sweep, or runs of the case as it was before.

    A folder of the same case and keys is continued: levels, seeds and measures may differ.

    Parameters
    ----------
    plan : the sweep.
    folder : its folder, which need not exist.
    again : whether all runs are made anew, so that those of a changed case do not matter.

    Raises
    ------
    ResultsError : names what is in the folder, or what of the case has changed.
    """
    refuse_other_plan(folder / PLAN, "sweep", FORMAT, plain_plan(plan), _identity)
    if not again:
        refuse_changed(plan.runs, folder, "the case")


def refuse_other_plan(
    path: Path,
    what: str,
    version: int,
    plain: Mapping[str, Any],
    identity: Callable[[Mapping[str, Any]], Mapping[str, str]],
) -> None:
    """Refuse a folder that holds something else than an earlier call of the same sweep or calibration.

    Parameters
    ----------
    path : file of the plan; its folder need not exist.
    what : "sweep" or "calibration".
    version, plain : format and content that the file is to have.
    identity : what of the content, in words, makes it another one.

    Raises
    ------
    ResultsError : names what is in the folder.
    """
    folder = path.parent
    refuse_if_not_writable(folder)
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return
    kept = _read(path)
    if kept is None or kept.get("format") != version:
        raise ResultsError(
            f"{folder}: exists and holds no {what} of ryusa, so it is not changed. Choose another with -o"
        )
    was, now = identity(kept), identity(plain)
    differ = [f"{name} {was[name]}, now {now[name]}" for name in now if was[name] != now[name]]
    if differ:
        raise ResultsError(
            f"{folder}: holds another {what}: {'; '.join(differ)}. Choose another folder with -o"
        )


def refuse_changed(runs: Sequence[SweepRun], folder: Path, case: str) -> None:
    """Refuse runs of a case as it was before; `case` is its name.

    Raises
    ------
    ResultsError : names what of the case has changed.
    """
    changed = _changed(runs, folder)
    if changed:
        every = list(dict.fromkeys(one for held in changed.values() for one in held))
        more = f" and {len(every) - _NAMED} more" if len(every) > _NAMED else ""
        n = len(changed)
        raise ResultsError(
            f"{folder}: {case} has changed since {n} of its runs {'was' if n == 1 else 'were'} made: "
            f"{'; '.join(every[:_NAMED])}{more}. Choose another folder with -o for the changed case, "
            "change it back, or make all runs anew with --again"
        )


def _changed(runs: Sequence[SweepRun], folder: Path) -> dict[SweepRun, list[str]]:
    """Runs in a folder that are of another case than they would be now, with the keys that differ."""
    found: dict[SweepRun, list[str]] = {}
    for run in runs:
        was = _read(folder / RUNS / run.folder / schema.CASE_JSON)
        if was is None:
            continue
        now = as_read_back(resolved(run.read()))
        if changes := changes_of(was, now):
            found[run] = changes
    return found


def keep_plan(plan: SweepPlan, folder: Path) -> None:
    """Write what is to be run, before the first run."""
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / PLAN, plain_plan(plan))


def plain_plan(plan: SweepPlan) -> dict[str, Any]:
    """What is to be run, for a JSON file."""
    return {
        "format": FORMAT,
        "case": plan.case.name,
        "keys": list(plan.design.keys),
        "design": plan.design.kind,
        "settings": [dict(one) for one in plan.design.settings],
        "set": dict(plan.overrides),
        "seeds": list(plan.seeds),
        "measures": list(plan.measures),
        "runs": [f"{RUNS}/{one.folder}" for one in plan.runs],
    }


def _identity(plain: Mapping[str, Any]) -> dict[str, str]:
    """What makes a sweep another one: its case, and the keys that vary."""
    keys = plain.get("keys")
    named = ", ".join(sorted(str(one) for one in keys)) if isinstance(keys, list) else ""
    return {"case": str(plain.get("case")), "over": named or "nothing but the seed"}


def _read(path: Path) -> dict[str, Any] | None:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None
