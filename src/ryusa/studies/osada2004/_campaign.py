"""Carry out the runs that experiments ask for."""

from collections.abc import Iterable
from pathlib import Path

from ryusa.studies.osada2004._experiment import load
from ryusa.study import Plan, StudyProgress, TaskResults
from ryusa.study import carry_out as carry_out_works


def carry_out(
    names: Iterable[str],
    plan: Plan,
    folder: Path,
    *,
    jobs: int = 1,
    again: bool = False,
    say: StudyProgress | None = None,
) -> TaskResults:
    """Run every case that the experiments need, and measure each for every experiment that wants it.

    Parameters
    ----------
    names : experiments, of `NAMES`.
    plan : level and seeds.
    folder, jobs, again, say : as in `campaign.carry_out`, with the same errors.
    """
    works = {name: load(name).cases(plan) for name in names}
    return carry_out_works(works, load, folder, jobs=jobs, again=again, say=say)
