"""Whether the model reaches the observations, and which parameters they determine."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ryusa.campaigns.calibrate.emulator import Emulator
from ryusa.campaigns.calibrate.posterior import Posterior, Seen
from ryusa.campaigns.calibrate.prior import LOG, Prior

Floats = NDArray[np.float64]

FAR = 2.0  # standard deviations of observation and model beyond which an observation is not reached
AT_EDGE = 0.25  # posterior over prior at an end, over its largest value, from which it lies at that edge
REACHES = (0.25, 0.5, 1.0)  # shares of the prior on either side over which a slope is taken
LOW, HIGH = "low", "high"
UNREACHED = "the model does not reach these observations"
UNTOLD = "these runs do not tell whether the model reaches these observations"
FOLLOWS = 0.9  # error of a run that is left out, over the scatter of all runs, from which none is foreseen
ONE_SEED = "one seed, which says nothing of the scatter between runs"
UNDETERMINED = "these data say too little"


@dataclass(frozen=True)
class ParameterMove:
    """What one parameter would have to be for the emulator to give an observation.

    Attributes
    ----------
    parameter : its number.
    to : value, along the emulator's slope [unit of its prior].
    possible : whether the cases take this value.
    """

    parameter: int
    to: float
    possible: bool = True


@dataclass(frozen=True)
class PriorEdge:
    """An end of a prior at which a posterior lies.

    Attributes
    ----------
    end : "low" or "high".
    value : of the parameter there [unit of its prior].
    limit : whether no case takes a value beyond it.
    """

    end: str
    value: float
    limit: bool = False


@dataclass(frozen=True)
class ComparedObservation:
    """An observation beside the model, in SI.

    Attributes
    ----------
    value, error, discrepancy : as in `Seen`.
    predicted : mean of the emulator over the posterior.
    unknown : standard deviation of the emulator there, for want of runs and by the scatter between seeds.
    least, most : of all runs.
    noise : standard deviation between seeds.
    move : the parameter that would have to move least; None where none moves the quantity.
    follows : whether the runs follow the parameters by more than their scatter, so that those left out are
        foreseen.
    """

    value: float
    error: float
    discrepancy: float
    predicted: float
    unknown: float
    least: float
    most: float
    noise: float
    move: ParameterMove | None = None
    follows: bool = True

    @property
    def misfit(self) -> float:
        """Observed less predicted, in standard deviations of observation, discrepancy and emulator [-]."""
        return (self.value - self.predicted) / math.hypot(self.error, self.discrepancy, self.unknown)

    @property
    def strict_misfit(self) -> float:
        """The same without the discrepancy [-]."""
        return (self.value - self.predicted) / math.hypot(self.error, self.unknown)

    @property
    def beyond(self) -> float:
        """How far it lies outside all runs, in standard deviations of observation and of one run [-]."""
        outside = max(self.least - self.value, self.value - self.most, 0.0)
        return outside / math.hypot(self.error, self.discrepancy, self.noise)

    @property
    def reached(self) -> bool:
        """Whether it lies within 2 standard deviations of the posterior, and of the runs."""
        return abs(self.misfit) <= FAR and self.beyond <= FAR

    @property
    def untold(self) -> bool:
        """Whether it is not reached by an emulator that foresees no run, but lies within the runs."""
        return not (self.reached or self.follows) and self.least <= self.value <= self.most


@dataclass(frozen=True)
class CalibrationVerdict:
    """What the numbers of a calibration are good for.

    Attributes
    ----------
    compared : observations.
    edges : by parameter, the end of its prior at which its posterior lies; None where it lies at none.
    learnt : by parameter, whether its posterior is narrower than its prior.
    seeds : number of seeds of each point.
    """

    compared: tuple[ComparedObservation, ...]
    edges: tuple[PriorEdge | None, ...]
    learnt: tuple[bool, ...]
    seeds: int

    @property
    def reached(self) -> bool:
        """Whether the model reaches all observations."""
        return all(one.reached for one in self.compared)

    @property
    def has_intervals(self) -> bool:
        """Whether standard deviations and intervals of the parameters are given."""
        return self.reached and self.seeds > 1

    @property
    def determined(self) -> tuple[bool, ...]:
        """By parameter, whether the observations determine it."""
        return tuple(not self.reason(k) for k in range(len(self.learnt)))

    @property
    def refusal(self) -> str:
        """Why there is no answer at all; "" where there is one."""
        missed = [one for one in self.compared if not one.reached]
        return "" if not missed else UNTOLD if all(one.untold for one in missed) else UNREACHED

    def reason(self, k: int) -> str:
        """Why parameter k is not determined; "" where it is."""
        if self.refusal:
            return self.refusal
        if self.seeds < 2:
            return ONE_SEED
        if not self.learnt[k]:
            return UNDETERMINED
        edge = self.edges[k]
        return "" if edge is None else f"at the {edge.end} edge of its prior"


def judge(
    posterior: Posterior, seen: Sequence[Seen], values: Sequence[Floats], seeds: int
) -> CalibrationVerdict:
    """Compare observations with posterior and runs, and say which parameters are determined.

    Parameters
    ----------
    posterior : of the parameters.
    seen : observations.
    values : what all runs gave of each, shape (n_runs,).
    seeds : number of seeds of each point.
    """
    u = posterior.resampled()
    middle = posterior.weights @ posterior.u
    compared: list[ComparedObservation] = []
    for one, held in zip(seen, values, strict=True):
        mean, sd = one.emulator.at(u)
        predicted, unknown = float(mean.mean()), float(np.sqrt(np.mean(sd**2)))
        away, _ = one.emulator.left_out()
        compared.append(
            ComparedObservation(
                one.value, one.error, one.discrepancy, predicted, unknown, float(held.min()),
                float(held.max()), one.emulator.noise,
                _least_move(posterior.priors, one.emulator, middle, one.value - predicted),
                float(np.sqrt(np.mean(away**2))) < FOLLOWS * float(held.std()),
            )
        )  # fmt: skip
    learnt: list[bool] = []
    edges: list[PriorEdge | None] = []
    for k, prior in enumerate(posterior.priors):
        low, high = (one >= AT_EDGE for one in posterior.at_ends(k))
        known = bool(posterior.learnt()[k]) and not (low and high)  # at both ends: nothing is shut out
        edge = PriorEdge(LOW, prior.low) if low else PriorEdge(HIGH, prior.high)
        learnt.append(known)
        edges.append(edge if known and (low or high) else None)
    return CalibrationVerdict(tuple(compared), tuple(edges), tuple(learnt), seeds)


def _least_move(
    priors: Sequence[Prior], emulator: Emulator, middle: Floats, lacking: float
) -> ParameterMove | None:
    """The parameter whose change by the fewest ranges of its prior makes up for what is lacking.

    A slope is that of the line through the emulator on either side of the middle of the posterior, taken over
    the shortest reach at which it is more than two standard deviations of itself; one that never is says
    nothing.
    """
    found: list[tuple[float, ParameterMove]] = []
    for k, prior in enumerate(priors):
        for reach in REACHES:
            ends = np.array([middle, middle])
            ends[:, k] = max(middle[k] - reach, 0.0), min(middle[k] + reach, 1.0)
            mean, _ = emulator.at(ends)
            unsure = emulator.covariance(ends)
            rise = float(mean[1] - mean[0])
            if abs(rise) > FAR * math.sqrt(max(float(unsure[0, 0] + unsure[1, 1] - 2.0 * unsure[0, 1]), 0.0)):
                found.append(_move(k, prior, ends[:, k], float(middle[k]), lacking / rise))
                break
    return min(found, key=lambda one: one[0])[1] if found else None


def _move(k: int, prior: Prior, ends: Floats, middle: float, times: float) -> tuple[float, ParameterMove]:
    """A move of parameter k by so many times the way between two shares, and its ranges of the prior."""
    low, high = (_along(prior, float(one)) for one in prior.at(ends))
    change = float(times * (high - low))
    to = _along(prior, float(prior.at(middle))) + change
    if prior.kind == LOG:
        to = math.exp(min(max(to, -700.0), 700.0))
    return abs(change) / (_along(prior, prior.high) - _along(prior, prior.low)), ParameterMove(k, to)


def _along(prior: Prior, value: float) -> float:
    """Coordinate in which a line through the emulator is drawn: the value, or its logarithm."""
    return math.log(value) if prior.kind == LOG else value
