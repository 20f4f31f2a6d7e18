"""Carry out a calibration: runs, emulators, posterior, further runs, verdict, predictions."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ryusa.campaigns.calibrate.coverage import Coverage, cover
from ryusa.campaigns.calibrate.definition import CalibrationAsked, ObservedValue, Target
from ryusa.campaigns.calibrate.design import filling_points, next_points
from ryusa.campaigns.calibrate.emulator import Emulator, emulate, need_sklearn
from ryusa.campaigns.calibrate.extend import PriorExtension, extended_prior, mark_limits, points_beyond
from ryusa.campaigns.calibrate.posterior import LEAST, TWO_SIGMA, Posterior, Seen, sample_posterior
from ryusa.campaigns.calibrate.prior import Prior
from ryusa.campaigns.calibrate.runs import CaseRuns
from ryusa.campaigns.calibrate.sentences import headline, remarks
from ryusa.campaigns.calibrate.tables import observation_rows, parameter_rows, printed_number
from ryusa.campaigns.calibrate.verdict import CalibrationVerdict, judge
from ryusa.campaigns.sweep.folder import refuse_other_plan
from ryusa.campaigns.sweep.part import SweepRun
from ryusa.errors import CaseError, ResultsError
from ryusa.notebook import html_table
from ryusa.results.presentation import needed
from ryusa.running.folder import write_json
from ryusa.study.executors import RunExecutor
from ryusa.study.progress import StudyProgress
from ryusa.version import commit

if TYPE_CHECKING:
    from pandas import DataFrame

Floats = NDArray[np.float64]

PLAN, FORMAT = "calibration-plan.json", 1


@dataclass(frozen=True)
class Predicted:
    """A quantity over the posterior, in its SI unit.

    Attributes
    ----------
    target : the quantity.
    unit : its SI unit.
    mean, sd : of its mean over seeds. All but the mean is nan where no interval is given, and the mean of
        what was not observed, too, where the model does not reach the observations.
    run_sd : standard deviation of a single run, with the scatter between seeds.
    low, high : ends of the central interval of 95 % of the mean.
    prior_mean, prior_sd : the same over the prior.
    observed : observed value and error; None for a prediction.
    """

    target: Target
    unit: str
    mean: float
    sd: float
    run_sd: float
    low: float
    high: float
    prior_mean: float
    prior_sd: float
    observed: tuple[float, float] | None = None


@dataclass(frozen=True)
class Calibration:
    """A calibration that was carried out.

    Attributes
    ----------
    asked : what was asked, with the priors as they were extended.
    folder : holds table, page, pictures and runs.
    runs : all runs with what they gave.
    training : the runs through which the emulators go.
    emulators : by target.
    posterior : of the parameters.
    verdict : whether the model reaches the observations, and which parameters they determine.
    predicted : observations and predictions over the posterior.
    extensions : of priors, in the order in which they were made.
    coverage : of made-up truths; None unless asked for.
    """

    asked: CalibrationAsked
    folder: Path
    runs: CaseRuns
    training: tuple[SweepRun, ...]
    emulators: Mapping[Target, Emulator]
    posterior: Posterior
    verdict: CalibrationVerdict
    predicted: tuple[Predicted, ...]
    extensions: tuple[PriorExtension, ...] = ()
    coverage: Coverage | None = None

    @property
    def rows(self) -> list[dict[str, object]]:
        """A line for each parameter, in the unit in which the study writes it; None for what is not given."""
        return parameter_rows(self.verdict, self.posterior)

    @property
    def observation_rows(self) -> list[dict[str, object]]:
        """A line for each observation, in SI: what was observed, the posterior, all runs, and the misfit."""
        observations, units = self.asked.observations, self.observed_units
        return observation_rows(self.verdict, observations, units, self.asked.priors)

    @property
    def observed_units(self) -> list[str]:
        """SI unit of each observation."""
        units = {one.target: one.unit for one in self.predicted}
        return [units[one.target] for one in self.asked.observations]

    @property
    def words(self) -> list[str]:
        """The verdict in sentences; the first is the verdict itself."""
        asked = self.asked
        said = remarks(self.verdict, asked.priors, asked.observations, self.observed_units, self.extensions)
        return [headline(self.verdict, asked.priors), *said]

    def to_pandas(self) -> "DataFrame":
        """The lines of `rows` as a pandas DataFrame.

        Raises
        ------
        ResultsError : pandas is not installed.
        """
        return needed("pandas").DataFrame(self.rows)

    def _repr_html_(self) -> str:
        heads = ("parameter", "verdict", "mean", "± s.d.", "unit", "of the prior's s.d.")
        cells = [
            (
                str(one["parameter"]), str(one["verdict"]), printed_number(one["mean"], 4),
                printed_number(one["standard_deviation"], 2), str(one["unit"]),
                printed_number(one["over_prior"], 2),
            )
            for one in self.rows
        ]  # fmt: skip
        return "".join(f"<p>{escape(one)}</p>" for one in self.words) + html_table(heads, cells)


def carry_out_calibration(
    asked: CalibrationAsked,
    folder: Path,
    where: RunExecutor,
    *,
    again: bool = False,
    extend: int = 0,
    truths: int = 0,
    progress: StudyProgress | None = None,
) -> Calibration:
    """Run the cases, fit the emulators, find the posterior of the parameters, and judge it.

    Parameters
    ----------
    asked : the calibration.
    folder : its folder; finished runs in it are opened, interrupted ones go on.
    where : where runs are carried out; the results do not depend on it.
    again : make all runs anew.
    extend : how many times priors may be extended where a posterior lies at their edge.
    truths : number of made-up truths on which intervals and verdict are checked; 0 for none.
    progress : receives the progress.

    Raises
    ------
    CaseError : a case cannot be run at a point, shows another test than was observed, an unknown quantity, or
        a unit that does not fit.
    ResultsError : scikit-learn is missing, the folder holds something else, too few runs gave a quantity, or
        the posterior could not be sampled.
    KeyboardInterrupt : Ctrl-C or SIGTERM; what is finished is kept, and the next call goes on.
    """
    need_sklearn()
    refuse_other_plan(folder / PLAN, "calibration", FORMAT, _plain(asked), _identity)
    runs = CaseRuns(asked, folder, where, again, progress)
    first = filling_points(len(asked.priors), asked.points, asked.design_seed)
    seeds = tuple(range(1, asked.seeds + 1))
    runs.plans(first, seeds)  # every point of every case is checked before anything is written or run
    commit()  # read now: later changes of the files are not part of the running code
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / PLAN, _plain(asked))
    runs.make(first[:1], seeds[:1])  # one run shows whether the quantities are there and in which unit
    units = {one: runs.unit(one) for one in asked.targets}
    held = {one.target: one.in_si(units[one.target]) for one in asked.observations}
    fit, extensions = _extended(runs, _fitted(runs, runs.make(first, seeds), held), held, extend)
    verdict, posterior = _possible(runs, fit.verdict), fit.posterior
    if verdict.reached and posterior.worth < LEAST:
        raise ResultsError(
            f"the observations single out so little of the priors that {len(posterior.u):,} points hold only "
            f"{posterior.worth:.0f} that count: choose narrower priors about what they single out"
        )
    predicted = tuple(
        _predicted(one, units[one], fit.emulators[one], posterior, held.get(one), verdict)
        for one in asked.targets
    )
    coverage = cover(runs, held, fit.emulators, fit.values, truths) if truths else None
    return Calibration(
        runs.asked, folder, runs, tuple(fit.training), fit.emulators, posterior, verdict, predicted,
        extensions, coverage,
    )  # fmt: skip


@dataclass(frozen=True)
class _Fit:
    """Emulators through runs, and what follows from them."""

    training: list[SweepRun]
    emulators: Mapping[Target, Emulator]
    values: Mapping[Target, Floats]
    posterior: Posterior
    verdict: CalibrationVerdict


def _fitted(runs: CaseRuns, training: list[SweepRun], held: Mapping[Target, ObservedValue]) -> _Fit:
    """Fit emulators, sample the posterior, and make the rounds of further runs that it needs."""
    asked = runs.asked
    seeds = tuple(range(1, asked.seeds + 1))
    emulators, seen, posterior = _sampled(runs, training, held)
    for k in range(asked.rounds):
        more = next_points(posterior, seen, asked.more, asked.seeds, asked.design_seed + k)
        training = [*training, *(one for one in runs.make(more, seeds) if one not in training)]
        emulators, seen, posterior = _sampled(runs, training, held)
    values = {one: runs.of(one, training)[1] for one in asked.targets}
    verdict = judge(posterior, seen, [values[one] for one in held], asked.seeds)
    edges = mark_limits(asked.priors, verdict.edges, runs.takes)
    return _Fit(training, emulators, values, posterior, replace(verdict, edges=edges))


def _extended(
    runs: CaseRuns, fit: _Fit, held: Mapping[Target, ObservedValue], extend: int
) -> tuple[_Fit, tuple[PriorExtension, ...]]:
    """Extend priors at whose edges the posterior lies, at most so many times, and fit anew each time."""
    asked, extensions = runs.asked, list[PriorExtension]()
    seeds = tuple(range(1, asked.seeds + 1))
    for k in range(extend):
        wider = _wider(runs, fit.verdict)
        if not wider:
            break
        runs.widen(_replaced(runs.asked.priors, wider))
        extensions += wider
        more = points_beyond(wider, runs.asked.priors, asked.points // 2, asked.design_seed + k)
        fit = _fitted(runs, [*fit.training, *runs.make(more, seeds)], held)
    return fit, tuple(extensions)


def _sampled(
    runs: CaseRuns, training: list[SweepRun], held: Mapping[Target, ObservedValue]
) -> tuple[Mapping[Target, Emulator], list[Seen], Posterior]:
    """Emulators through runs, observations with them, and the posterior."""
    emulators = _emulators(runs, training)
    seen = [Seen(emulators[one], value.value, value.error, value.discrepancy) for one, value in held.items()]
    return emulators, seen, sample_posterior(runs.asked.priors, seen, runs.asked.design_seed)


def _wider(runs: CaseRuns, verdict: CalibrationVerdict) -> list[PriorExtension]:
    """Priors at whose edges the posterior lies, extended as far as the cases take the parameter."""
    found: list[PriorExtension] = []
    for prior, edge in zip(runs.asked.priors, verdict.edges, strict=True):
        if edge is None or edge.limit:
            continue
        wider = extended_prior(prior, edge.end, lambda value, key=prior.key: runs.takes(key, value))
        if wider is not None:
            found.append(PriorExtension(prior, wider, edge.end))
    return found


def _replaced(priors: Sequence[Prior], wider: Sequence[PriorExtension]) -> tuple[Prior, ...]:
    new = {one.after.key: one.after for one in wider}
    return tuple(new.get(one.key, one) for one in priors)


def _possible(runs: CaseRuns, verdict: CalibrationVerdict) -> CalibrationVerdict:
    """The verdict, with every move marked that the cases do not take."""
    priors = runs.asked.priors
    compared = tuple(
        one
        if one.move is None
        else replace(
            one,
            move=replace(one.move, possible=runs.takes(priors[one.move.parameter].key, one.move.to)),
        )
        for one in verdict.compared
    )
    return replace(verdict, compared=compared)


def _identity(plain: Mapping[str, Any]) -> dict[str, str]:
    """What makes a calibration another one: its cases and parameters."""
    return {name: str(plain.get(name)) for name in ("cases", "parameters")}


def _plain(asked: CalibrationAsked) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "cases": [one.name for one in asked.cases],
        "parameters": [one.key for one in asked.priors],
        "priors": {one.key: one.words for one in asked.priors},
        "set": dict(asked.overrides),
    }


def _emulators(runs: CaseRuns, training: list[SweepRun]) -> dict[Target, Emulator]:
    """An emulator for every target.

    Raises
    ------
    ResultsError : more than a quarter of the runs of a target did not give it.
    """
    found: dict[Target, Emulator] = {}
    for target in runs.asked.targets:
        u, values = runs.of(target, training)
        runs.refuse_if_few(target, training)
        found[target] = emulate(u, values, runs.asked.design_seed)
    return found


def _predicted(
    target: Target,
    unit: str,
    emulator: Emulator,
    posterior: Posterior,
    observed: ObservedValue | None,
    verdict: CalibrationVerdict,
) -> Predicted:
    mean, sd, sample = posterior.of(emulator)
    _, run_sd, _ = posterior.of(emulator, noise=True)
    low, high = np.quantile(sample, (0.5 - TWO_SIGMA / 2, 0.5 + TWO_SIGMA / 2))
    if not verdict.has_intervals:
        sd = run_sd = low = high = math.nan
    if observed is None and not verdict.reached:
        mean = math.nan
    prior, _ = emulator.at(filling_points(len(posterior.priors), 2048, 0))
    return Predicted(
        target, unit, mean, sd, run_sd, float(low), float(high), float(prior.mean()), float(prior.std()),
        None if observed is None else (observed.value, observed.error),
    )  # fmt: skip


def refuse_truths(truths: int) -> None:
    """Refuse a number of made-up truths that says nothing.

    Raises
    ------
    CaseError : one to four; with so few no interval can be told from another.
    """
    least = 5
    if truths < 0 or 0 < truths < least:
        raise CaseError("coverage", truths, f"must be 0, or {least} or more made-up truths")
