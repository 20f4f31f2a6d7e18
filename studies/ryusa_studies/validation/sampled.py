"""Runs of a case in several settings, with the seeds of its line of SAMPLING, at the full level alone."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ryusa.cases import case_path
from ryusa.model.arrays import Floats
from ryusa.study import CaseRun, Finding, Found, Level, Plan, case_run
from ryusa_studies.validation.sampling import SAMPLING


@dataclass(frozen=True)
class SeedNumbers:
    """What was measured of every run, by setting, one for each seed."""

    of: Mapping[Any, Sequence[Mapping[str, Any]]]

    def __call__(self, key: str, setting: object) -> Floats:
        """One number of a setting, shape (n_seed,)."""
        return np.array([float(one[key]) for one in self.of[setting]])

    def means(self, key: str, settings: Sequence[object]) -> Floats:
        """Its mean over the seeds, by setting."""
        return np.array([float(self(key, one).mean()) for one in settings])


@dataclass(frozen=True)
class SampledRuns:
    """The runs of a comparison; the other levels have an hour on two cores, so they have none of them.

    Attributes
    ----------
    name : of the line of SAMPLING.
    case : file of the case.
    settings : keys of the case that each setting changes, with their values.
    """

    name: str
    case: str
    settings: Mapping[Any, Mapping[str, str]]

    def _runs(self, plan: Plan) -> dict[Any, list[CaseRun]]:
        seeds = SAMPLING[self.name].seeds(plan) if plan.level is Level.FULL else ()
        return {
            one: [case_run(case_path(self.case), keys, seed=seed) for seed in seeds]
            for one, keys in self.settings.items()
        }

    def tasks(self, plan: Plan) -> Sequence[CaseRun]:
        """Every setting with every seed, at the full level."""
        return [one for of_seed in zip(*self._runs(plan).values(), strict=True) for one in of_seed]

    def judge(
        self, judged: Callable[[SeedNumbers], Sequence[Finding]]
    ) -> Callable[[Found, Plan], Sequence[Finding]]:
        """The judgement of a part from one of the numbers of all seeds."""

        def judge(found: Found, plan: Plan) -> Sequence[Finding]:
            runs = {setting: [found[one] for one in runs] for setting, runs in self._runs(plan).items()}
            return judged(SeedNumbers(runs)) if plan.level is Level.FULL else []

        return judge
