"""Whether the intervals hold the truth as often as they say: the calibration of made-up observations.

The truths are drawn from the prior, and their runs have seeds that no emulator has seen.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from ryusa.errors import ResultsError
from ryusa.studies.calibrate.asked import Target
from ryusa.studies.calibrate.emulator import Emulator
from ryusa.studies.calibrate.posterior import ONE_SIGMA, TWO_SIGMA, Seen, sample_posterior
from ryusa.studies.calibrate.prior import in_cube
from ryusa.studies.calibrate.runs import CaseRuns

Floats = NDArray[np.float64]

FIRST_SEED = 1001  # of the runs of the truths


@dataclass(frozen=True)
class Coverage:
    """Made-up truths and the intervals found for them.

    Attributes
    ----------
    truths : values of the parameters, shape (n, n_parameters), in the units of their priors.
    means, sds : found for them, the same shape.
    inside : by share of the interval, whether it holds the truth, shape (n, n_parameters).
    lost : truths of which a run failed, or whose observations were out of reach, with the reason.
    """

    truths: Floats
    means: Floats
    sds: Floats
    inside: Mapping[float, NDArray[np.bool_]]
    lost: tuple[str, ...] = ()

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


def chance(n: int, share: float) -> tuple[int, int]:
    """Numbers of n truths inside an interval of a share that chance gives with 95 %, if the share is right.

    >>> chance(20, 0.6827)
    (9, 17)
    """
    low, high = binom.ppf((0.025, 0.975), n, share)
    return int(low), int(high)


def cover(
    runs: CaseRuns, held: Mapping[Target, tuple[float, float]], emulators: Mapping[Target, Emulator], n: int
) -> Coverage:
    """Calibrate made-up observations with the errors of the real ones; see which intervals hold the truth.

    Parameters
    ----------
    runs : carries out the runs of the truths.
    held : observed value and error, by target, in SI; of the value only the error is used.
    emulators : by target.
    n : number of truths.

    Notes
    -----
    A made-up observation is the mean over the seeds of its runs plus a normal error; its variance is that of
    the error and of the scatter of the runs over their number.
    """
    asked = runs.asked
    rng = np.random.default_rng(asked.design_seed + 1)
    u = rng.random((n, len(asked.priors)))
    seeds = tuple(range(FIRST_SEED, FIRST_SEED + asked.seeds))
    made = runs.make(u, seeds)
    truths: list[Floats] = []
    means: list[Floats] = []
    sds: list[Floats] = []
    inside: dict[float, list[list[bool]]] = {ONE_SIGMA: [], TWO_SIGMA: []}
    lost: list[str] = []
    for k in range(n):
        mine = [one for one in made if one.setting == k]
        place = runs.u[mine[0]]
        seen: list[Seen] = []
        for target, (_, error) in held.items():
            _, values = runs.of(target, mine)
            if not len(values):
                lost.append(f"truth {k + 1}: no run gave {target.words}")
                continue
            width = float(np.hypot(error, emulators[target].noise / np.sqrt(len(values))))
            value = float(values.mean()) + error * float(rng.standard_normal())
            seen.append(Seen(emulators[target], value, width))
        if len(seen) < len(held):
            continue
        try:
            posterior = sample_posterior(asked.priors, seen, asked.design_seed)
        except ResultsError as problem:
            lost.append(f"truth {k + 1}: {problem}")
            continue
        values = in_cube(asked.priors, place[None, :])[0]
        truths.append(values)
        means.append(posterior.mean())
        sds.append(posterior.sd())
        for share, kept in inside.items():
            ends = [posterior.interval(j, share) for j in range(len(values))]
            kept.append([low <= value <= high for value, (low, high) in zip(values, ends, strict=True)])
    if not truths:
        raise ResultsError(f"none of {n} made-up truths could be calibrated: {lost[0]}")
    return Coverage(
        np.array(truths), np.array(means), np.array(sds),
        {share: np.array(kept) for share, kept in inside.items()}, tuple(lost),
    )  # fmt: skip
