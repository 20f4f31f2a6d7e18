"""Carry out a calibration: runs, emulators, posterior, further runs, predictions."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ryusa.errors import CaseError, ResultsError
from ryusa.notebook import html_table
from ryusa.results.shown import needed
from ryusa.running import provenance
from ryusa.running.folder import refuse_if_not_writable, write_json
from ryusa.studies.calibrate.asked import CalibrationAsked, Target
from ryusa.studies.calibrate.coverage import Coverage, cover
from ryusa.studies.calibrate.design import filling_points, next_points
from ryusa.studies.calibrate.emulator import Emulator, emulate, need_sklearn
from ryusa.studies.calibrate.posterior import ONE_SIGMA, TWO_SIGMA, Posterior, Seen, sample_posterior
from ryusa.studies.calibrate.runs import CaseRuns
from ryusa.studies.sweep.part import SweepRun
from ryusa.study.executors import RunExecutor
from ryusa.study.progress import StudyProgress

if TYPE_CHECKING:
    from pandas import DataFrame

PLAN, FORMAT = "calibration-plan.json", 1
UNDETERMINED = "not determined by these data"


@dataclass(frozen=True)
class Predicted:
    """A quantity over the posterior, in its SI unit.

    Attributes
    ----------
    target : the quantity.
    unit : its SI unit.
    mean, sd : of its mean over seeds.
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

    @property
    def away(self) -> float:
        """Observed value less the mean, over the standard deviation of the difference; nan without one."""
        if self.observed is None:
            return float("nan")
        value, error = self.observed
        return (value - self.mean) / float(np.hypot(error, self.sd))


@dataclass(frozen=True)
class Calibration:
    """A calibration that was carried out.

    Attributes
    ----------
    asked : what was asked.
    folder : holds table, page, pictures and runs.
    runs : all runs with what they gave.
    training : the runs through which the emulators go.
    emulators : by target.
    posterior : of the parameters.
    predicted : observations and predictions over the posterior.
    coverage : of made-up truths; None unless asked for.
    """

    asked: CalibrationAsked
    folder: Path
    runs: CaseRuns
    training: tuple[SweepRun, ...]
    emulators: Mapping[Target, Emulator]
    posterior: Posterior
    predicted: tuple[Predicted, ...]
    coverage: Coverage | None = None

    @property
    def rows(self) -> list[dict[str, object]]:
        """A line for each parameter, in the unit in which the study writes it."""
        found: list[dict[str, object]] = []
        means, sds, narrow = self.posterior.mean(), self.posterior.sd(), self.posterior.narrowing()
        determined = self.posterior.determined()
        for k, prior in enumerate(self.asked.priors):
            (a, b), (c, d) = (self.posterior.interval(k, share) for share in (ONE_SIGMA, TWO_SIGMA))
            found.append(
                {
                    "parameter": prior.key, "unit": prior.unit or "-", "mean": float(means[k]),
                    "standard_deviation": float(sds[k]), "low_68": a, "high_68": b, "low_95": c, "high_95": d,
                    "over_prior": float(narrow[k]), "determined": bool(determined[k]), "prior": prior.words,
                }
            )  # fmt: skip
        return found

    def to_pandas(self) -> "DataFrame":
        """The lines of `rows` as a pandas DataFrame.

        Raises
        ------
        ResultsError : pandas is not installed.
        """
        return needed("pandas").DataFrame(self.rows)

    def _repr_html_(self) -> str:
        heads = ("parameter", "mean", "± s.d.", "unit", "of the prior's s.d.", "")
        cells = [
            (
                str(one["parameter"]), f"{one['mean']:.4g}", f"{one['standard_deviation']:.2g}",
                str(one["unit"]), f"{one['over_prior']:.2f}", "" if one["determined"] else UNDETERMINED,
            )
            for one in self.rows
        ]  # fmt: skip
        return html_table(heads, cells)


def carry_out_calibration(
    asked: CalibrationAsked,
    folder: Path,
    where: RunExecutor,
    *,
    again: bool = False,
    truths: int = 0,
    progress: StudyProgress | None = None,
) -> Calibration:
    """Run the cases, fit the emulators, and find the posterior of the parameters.

    Parameters
    ----------
    asked : the calibration.
    folder : its folder; finished runs in it are opened, interrupted ones go on.
    where : where runs are carried out; the results do not depend on it.
    again : make all runs anew.
    truths : number of made-up truths on which the intervals are checked; 0 for none.
    progress : receives the progress.

    Raises
    ------
    CaseError : a case cannot be run at a point, an unknown quantity, or a unit that does not fit.
    ResultsError : scikit-learn is missing, the folder holds something else, too few runs gave a quantity, or
        the observations are out of reach of the priors.
    KeyboardInterrupt : Ctrl-C or SIGTERM; what is finished is kept, and the next call goes on.
    """
    need_sklearn()
    refuse_folder(asked, folder)
    runs = CaseRuns(asked, folder, where, again, progress)
    first = filling_points(len(asked.priors), asked.points, asked.design_seed)
    seeds = tuple(range(1, asked.seeds + 1))
    runs.plans(first, seeds)  # every point of every case is checked before anything is written or run
    provenance.commit()  # read now: later changes of the files are not part of the running code
    folder.mkdir(parents=True, exist_ok=True)
    write_json(folder / PLAN, _plain(asked))
    runs.make(first[:1], seeds[:1])  # one run shows whether the quantities are there and in which unit
    units = {one: runs.unit(one) for one in asked.targets}
    held = {one.target: one.in_si(units[one.target]) for one in asked.observations}
    training = runs.make(first, seeds)
    emulators = _emulators(runs, training)
    seen = [Seen(emulators[one], *held[one]) for one in held]
    posterior = sample_posterior(asked.priors, seen, asked.design_seed)
    for k in range(asked.rounds):
        more = next_points(posterior, seen, asked.more, asked.seeds, asked.design_seed + k)
        training += [one for one in runs.make(more, seeds) if one not in training]
        emulators = _emulators(runs, training)
        seen = [Seen(emulators[one], *held[one]) for one in held]
        posterior = sample_posterior(asked.priors, seen, asked.design_seed)
    predicted = tuple(
        _predicted(one, units[one], emulators[one], posterior, held.get(one)) for one in asked.targets
    )
    coverage = cover(runs, held, emulators, truths) if truths else None
    return Calibration(asked, folder, runs, tuple(training), emulators, posterior, predicted, coverage)


def refuse_folder(asked: CalibrationAsked, folder: Path) -> None:
    """Refuse a folder that holds something else, or the calibration of other cases or parameters.

    Raises
    ------
    ResultsError : names what is in the folder.
    """
    import json

    refuse_if_not_writable(folder)
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return
    try:
        kept = json.loads((folder / PLAN).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        kept = None
    if not isinstance(kept, dict) or kept.get("format") != FORMAT:
        raise ResultsError(
            f"{folder}: exists and holds no calibration of ryusa: it is not changed. Choose another with -o"
        )
    now = _plain(asked)
    differ = [
        f"{name} {kept.get(name)}, now {now[name]}"
        for name in ("cases", "parameters")
        if kept.get(name) != now[name]
    ]
    if differ:
        raise ResultsError(
            f"{folder}: holds another calibration: {'; '.join(differ)}. Choose another folder with -o"
        )


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
    observed: tuple[float, float] | None,
) -> Predicted:
    mean, sd, sample = posterior.of(emulator)
    _, run_sd, _ = posterior.of(emulator, noise=True)
    low, high = np.quantile(sample, (0.5 - TWO_SIGMA / 2, 0.5 + TWO_SIGMA / 2))
    n = len(posterior.priors)
    prior, _ = emulator.at(filling_points(n, 2048, 0))
    return Predicted(
        target,
        unit,
        mean,
        sd,
        run_sd,
        float(low),
        float(high),
        float(prior.mean()),
        float(prior.std()),
        observed,
    )


def refuse_truths(truths: int) -> None:
    """Refuse a number of made-up truths that says nothing.

    Raises
    ------
    CaseError : one to four; with so few no interval can be told from another.
    """
    least = 5
    if truths < 0 or 0 < truths < least:
        raise CaseError("coverage", truths, f"must be 0, or {least} or more made-up truths")
