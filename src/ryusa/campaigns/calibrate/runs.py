"""Runs of a calibration: every case at points of the parameters, and what they gave."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ryusa.campaigns.calibrate.definition import CalibrationAsked, Target
from ryusa.campaigns.calibrate.design import settings_of
from ryusa.campaigns.calibrate.heaps import read_test, refuse_other_test
from ryusa.campaigns.calibrate.prior import DIGITS, Prior
from ryusa.campaigns.sweep.folder import RUNS, refuse_changed
from ryusa.campaigns.sweep.part import Measured, SweepRun, measured, problems_of, runs_of
from ryusa.campaigns.sweep.plan import SweepPlan, plan_sweep
from ryusa.casefile.derive import derive
from ryusa.errors import CaseError, ResultsError
from ryusa.spelling import nearest_word
from ryusa.study.executors import RunExecutor
from ryusa.study.origin import traces_of
from ryusa.study.progress import StudyProgress
from ryusa.study.runs import TaskResults, carry_out

Floats = NDArray[np.float64]

SHARE_OF_RUNS = 0.75  # of the runs of a target that must have given it
NAMED = 4  # runs that are named


@dataclass
class CaseRuns:
    """Runs made so far, and what they gave.

    Attributes
    ----------
    asked : the calibration.
    folder : holds the runs.
    where : where they are carried out.
    again : whether finished runs are made anew.
    progress : receives the progress.
    u : points of the unit cube, by run.
    found : what was measured, by run.
    results : of all calls, for the provenance.
    """

    asked: CalibrationAsked
    folder: Path
    where: RunExecutor
    again: bool = False
    progress: StudyProgress | None = None
    u: dict[SweepRun, Floats] = field(default_factory=dict[SweepRun, Floats])
    found: dict[SweepRun, Measured] = field(default_factory=dict[SweepRun, Measured])
    results: TaskResults = field(default_factory=lambda: TaskResults({}))

    def plans(self, u: Floats, seeds: Sequence[int]) -> dict[Path, SweepPlan]:
        """Every case at points, checked as a whole.

        Raises
        ------
        CaseError : the faults of a case at all its points.
        ResultsError : the folder holds runs of the case as it was before.
        """
        design = settings_of(self.asked.priors, u)
        found: dict[Path, SweepPlan] = {}
        for case in self.asked.cases:
            found[case] = plan_sweep(
                case, design, seeds, self.asked.measures(case), overrides=self.asked.overrides, pages=False,
                heights=self.asked.heights(case),
            )  # fmt: skip
            self._refuse_other_tests(case, found[case])
            if not self.again:
                refuse_changed(found[case].runs, self.folder, case.name)
        return found

    def _refuse_other_tests(self, case: Path, plan: SweepPlan) -> None:
        for k, one in enumerate(self.asked.observations):
            if one.target.case == case:
                key = f"observations.{k}.test"
                test = read_test(key, one.test or None, one.target.measure)  # of an `asked` made in Python
                refuse_other_test(key, test, plan.runs[0].read())

    def widen(self, priors: tuple[Prior, ...]) -> None:
        """Take wider priors; every run so far gets its place in them."""
        self.asked = replace(self.asked, priors=priors)
        self.u = {run: _place(self.asked, run) for run in self.u}

    def takes(self, key: str, value: float) -> bool:
        """Whether all cases take a value of a parameter, the others being in the middle of their priors."""
        setting = {
            one.key: f"{value:.{DIGITS}g} {one.unit}".rstrip() if one.key == key else one.text(0.5)
            for one in self.asked.priors
        }
        try:
            for case in self.asked.cases:
                derive(runs_of(case, self.asked.overrides, [setting], (1,))[0].read())
        except CaseError:
            return False
        return True

    def make(self, u: Floats, seeds: Sequence[int]) -> list[SweepRun]:
        """Carry out every case at points with seeds; return the runs."""
        plans = self.plans(u, seeds)
        tasks = {str(case): plan.runs for case, plan in plans.items()}
        done = carry_out(
            tasks, {str(case): plan.part for case, plan in plans.items()}.__getitem__, self.folder / RUNS,
            again=self.again, progress=self.progress, where=self.where,
        )  # fmt: skip
        self.results.add(done)
        made: list[SweepRun] = []
        for case, plan in plans.items():
            for run in plan.runs:
                self.found[run] = measured(run, str(case), done)
                self.u[run] = _place(self.asked, run)
                made.append(run)
        return made

    def of(self, target: Target, runs: Sequence[SweepRun]) -> tuple[Floats, Floats]:
        """Points and values of a target in runs that gave it, shapes (n, n_parameters) and (n,), in SI."""
        held = [
            (self.u[one], value)
            for one in _of_case(target, runs)
            if (value := self.value(target, one)) is not None
        ]
        u = np.array([place for place, _ in held]).reshape(len(held), len(self.asked.priors))
        return u, np.array([value for _, value in held])

    def value(self, target: Target, run: SweepRun) -> float | None:
        """Value of a target in one run; None if it has none."""
        for one in self.found[run].averages.get(target.measure, ()):
            if one.name == target.name and np.isfinite(one.value):
                return one.value
        return None

    def refuse_if_few(self, target: Target, runs: Sequence[SweepRun]) -> None:
        """Refuse an emulator where too few runs gave its target.

        Raises
        ------
        ResultsError : more than a quarter of the runs have no number; names them with the reason.
        """
        mine = _of_case(target, runs)
        lacking = [one for one in mine if self.value(target, one) is None]
        if len(mine) - len(lacking) >= SHARE_OF_RUNS * len(mine):
            return
        named = "; ".join(f"at {one.label}: {self._lack(target, one)}" for one in lacking[:NAMED])
        more = f"; and {len(lacking) - NAMED} more" if len(lacking) > NAMED else ""
        raise ResultsError(
            f"{target.words}: only {len(mine) - len(lacking)} of {len(mine)} runs gave it, and an emulator "
            f"needs three quarters. {named}{more}. Choose priors without such points, let the case run "
            f"longer (stop.time), or observe another quantity; the runs are in {self.folder / RUNS}"
        )

    def _lack(self, target: Target, run: SweepRun) -> str:
        """Why a run has no value of a target."""
        held = self.found[run]
        for one in held.averages.get(target.measure, ()):
            if one.name == target.name:
                return f"its {target.name} is {one.value}, not a number to go by"
        reason = held.problems.get("run") or held.problems.get(target.measure)
        return reason or f"its {target.measure} has no {target.name}"

    def unit(self, target: Target) -> str:
        """SI unit of a target.

        Raises
        ------
        CaseError : no run has such a quantity; names those that there are.
        """
        names: dict[str, str] = {}
        for run, held in self.found.items():
            if run.case == target.case.stem:
                names |= {one.name: one.unit for one in held.averages.get(target.measure, ())}
        if target.name in names:
            return names[target.name]
        if target.at is not None:
            raise CaseError(
                "at", f"{1e3 * target.at:g} mm",
                f"the first run of {target.case.name} has no grains at this height above datum",
            )  # fmt: skip
        reasons = [one for held in self.found.values() for one in held.problems.values()]
        if not names and reasons:
            raise ResultsError(f"{target.words} could not be had of any run: {reasons[0]}")
        raise CaseError(
            "quantity", target.quantity,
            f"{target.measure} of {target.case.name} gives {', '.join(map(repr, names)) or 'nothing'}",
            nearest_word(target.quantity, list(names)),
        )  # fmt: skip

    @property
    def traces(self) -> dict[str, str]:
        """Tracebacks of errors in the program."""
        return traces_of(self.results, {})

    @property
    def problems(self) -> dict[str, str]:
        """Runs or measures without numbers, with the reason."""
        return problems_of(self.found)


def _of_case(target: Target, runs: Sequence[SweepRun]) -> list[SweepRun]:
    """Those runs that are of the case of a target."""
    return [one for one in runs if one.case == target.case.stem and one.cases == target.case.parent]


def _place(asked: CalibrationAsked, run: SweepRun) -> Floats:
    """Point of a run in the unit cube, from the values as they are written in its case."""
    varied = dict(run.varied)
    shares = [
        float(prior.share(float(varied[prior.key].removesuffix(prior.unit).strip())))
        for prior in asked.priors
    ]
    return np.clip(shares, 0.0, 1.0)  # six digits may lie beyond an end by round-off
