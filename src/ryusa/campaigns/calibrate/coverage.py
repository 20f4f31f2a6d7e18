"""Whether the intervals hold the truth as often as they say, and whether the verdict is right.

The truths are drawn from the prior, and their runs have seeds that no emulator has seen. Each is calibrated
twice: as it is, and with one observation moved so far beyond all runs that the model cannot reach it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from ryusa.campaigns.calibrate.definition import ObservedValue, Target
from ryusa.campaigns.calibrate.emulator import Emulator
from ryusa.campaigns.calibrate.posterior import LEAST, ONE_SIGMA, TWO_SIGMA, Seen, sample_posterior
from ryusa.campaigns.calibrate.prior import Prior, in_cube
from ryusa.campaigns.calibrate.runs import CaseRuns
from ryusa.campaigns.calibrate.verdict import judge
from ryusa.errors import ResultsError

Floats = NDArray[np.float64]

FIRST_SEED = 1001  # of the runs of the truths
BEYOND = 4.0  # standard deviations beyond all runs of an observation that cannot be reached
WRONG = 0.05  # share of wrong verdicts that is allowed


@dataclass(frozen=True)
class Coverage:
    """Made-up truths and the intervals and verdicts found for them.

    Attributes
    ----------
    truths : values of the parameters that were given an interval, shape (n, n_parameters), in the units of
        their priors.
    means, sds : found for them, the same shape.
    inside : by share of the interval, whether it holds the truth, shape (n, n_parameters).
    lost : truths of which a run failed, with the reason.
    unreached : number of truths of which the verdict said wrongly that the model does not reach them.
    beyond : number of observations out of reach.
    admitted : those of them of which the verdict said that the model reaches them.
    determined : those of them for which a parameter was called determined.
    """

    truths: Floats
    means: Floats
    sds: Floats
    inside: Mapping[float, NDArray[np.bool_]]
    lost: tuple[str, ...] = ()
    unreached: int = 0
    beyond: int = 0
    admitted: int = 0
    determined: int = 0

    def rows(self, keys: tuple[str, ...]) -> list[dict[str, object]]:
        """A line for each parameter and share: how many truths lie inside, and how many must by chance."""
        n = len(self.truths)
        found: list[dict[str, object]] = []
        for k, key in enumerate(keys):
            for share, held in self.inside.items():
                count = int(held[:, k].sum())
                low, high = chance(n, share)
                found.append(
                    {
                        "parameter": key, "interval": f"{100 * share:.0f} %", "inside": count, "truths": n,
                        "expected_low": low, "expected_high": high, "as_expected": low <= count <= high,
                    }
                )  # fmt: skip
        return found

    def verdict_rows(self) -> list[dict[str, object]]:
        """A line for each way in which a verdict can be wrong: how often it was, and how often it may be."""
        truths = len(self.truths) + self.unreached
        found: list[dict[str, object]] = []
        for words, count, n in (
            ("within reach, called out of reach", self.unreached, truths),
            ("out of reach, called within reach", self.admitted, self.beyond),
            ("out of reach, a parameter called determined", self.determined, self.beyond),
        ):
            most = int(binom.ppf(0.975, n, WRONG))
            found.append(
                {
                    "observations": words,
                    "wrong": count,
                    "of": n,
                    "at_most": most,
                    "as_expected": count <= most,
                }
            )
        return found


def chance(n: int, share: float) -> tuple[int, int]:
    """Numbers of n truths inside an interval of a share that chance gives with 95 %, if the share is right.

    >>> chance(20, 0.6827)
    (9, 17)
    """
    low, high = binom.ppf((0.025, 0.975), n, share)
    return int(low), int(high)


def cover(
    runs: CaseRuns,
    held: Mapping[Target, ObservedValue],
    emulators: Mapping[Target, Emulator],
    values: Mapping[Target, Floats],
    n: int,
) -> Coverage:
    """Calibrate made-up observations with the errors of the real ones; see which intervals hold the truth.

    Parameters
    ----------
    runs : carries out the runs of the truths.
    held : observations by target; of the values only the errors are used.
    emulators : by target.
    values : what all runs gave, by target.
    n : number of truths.

    Notes
    -----
    A made-up observation is the mean over the seeds of its runs plus a normal error; its variance is that of
    the error and of the scatter of the runs over their number.
    """
    asked = runs.asked
    rng = np.random.default_rng(asked.design_seed + 1)
    u = rng.random((n, len(asked.priors)))
    made = runs.make(u, tuple(range(FIRST_SEED, FIRST_SEED + asked.seeds)))
    counted = Counted(asked.priors, [values[one] for one in held], asked.seeds, asked.design_seed)
    lost: list[str] = []
    for k in range(n):
        mine = [one for one in made if one.setting == k]
        seen: list[Seen] = []
        for target, one in held.items():
            _, found = runs.of(target, mine)
            if not len(found):
                lost.append(f"truth {k + 1}: no run gave {target.words}")
                continue
            width = float(np.hypot(one.error, emulators[target].noise / np.sqrt(len(found))))
            value = float(found.mean()) + one.error * float(rng.standard_normal())
            seen.append(Seen(emulators[target], value, width, one.discrepancy))
        if len(seen) == len(held):
            counted.add(runs.u[mine[0]], seen, rng)
    if not counted.truths:
        reason = lost[0] if lost else "the verdict calls all of them out of reach"
        raise ResultsError(f"none of {n} made-up truths could be calibrated: {reason}")
    return counted.coverage(tuple(lost))


@dataclass
class Counted:
    """Made-up observations calibrated one after the other, and what came out right.

    Attributes
    ----------
    priors : of the parameters.
    values : what all runs gave of each observed quantity, shape (n_runs,).
    seeds : number of seeds of each point.
    design_seed : of the sampling.
    """

    priors: tuple[Prior, ...]
    values: Sequence[Floats]
    seeds: int
    design_seed: int = 0
    truths: list[Floats] = field(default_factory=list[Floats])
    means: list[Floats] = field(default_factory=list[Floats])
    sds: list[Floats] = field(default_factory=list[Floats])
    inside: dict[float, list[list[bool]]] = field(default_factory=lambda: {ONE_SIGMA: [], TWO_SIGMA: []})
    unreached: int = 0
    beyond: int = 0
    admitted: int = 0
    determined: int = 0

    def add(self, place: Floats, seen: Sequence[Seen], rng: np.random.Generator) -> None:
        """Calibrate a truth at a point of the unit cube, as it was observed and out of reach."""
        k = len(self.truths) + self.unreached
        posterior = sample_posterior(self.priors, seen, self.design_seed)
        if posterior.worth < LEAST or not judge(posterior, seen, self.values, self.seeds).reached:
            self.unreached += 1
        else:
            truth = in_cube(self.priors, place[None, :])[0]
            self.truths.append(truth)
            self.means.append(posterior.mean())
            self.sds.append(posterior.sd())
            for share, kept in self.inside.items():
                ends = [posterior.interval(j, share) for j in range(len(truth))]
                kept.append([low <= one <= high for one, (low, high) in zip(truth, ends, strict=True)])
        far = self._moved(seen, k, rng)
        verdict = judge(sample_posterior(self.priors, far, self.design_seed), far, self.values, self.seeds)
        self.beyond += 1
        self.admitted += verdict.reached
        self.determined += any(verdict.determined)

    def _moved(self, seen: Sequence[Seen], k: int, rng: np.random.Generator) -> list[Seen]:
        """The observations of truth k, one of them beyond all runs: above and below in turn."""
        j = k % len(seen)
        one, held = seen[j], self.values[j]
        width = BEYOND * float(np.hypot(one.width, one.emulator.noise))
        end = held.max() + width if (k // len(seen)) % 2 == 0 else held.min() - width
        moved = replace(one, value=float(end + one.error * rng.standard_normal()))
        return [*seen[:j], moved, *seen[j + 1 :]]

    def coverage(self, lost: tuple[str, ...] = ()) -> Coverage:
        """What came out."""
        return Coverage(
            np.array(self.truths), np.array(self.means), np.array(self.sds),
            {share: np.array(kept) for share, kept in self.inside.items()}, lost, self.unreached, self.beyond,
            self.admitted, self.determined,
        )  # fmt: skip
