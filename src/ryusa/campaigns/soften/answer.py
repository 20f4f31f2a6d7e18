"""Which stiffness is soft enough: errors of the runs at some stiffnesses, and what can be said of them."""

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from ryusa.campaigns.soften.extrapolate import EXPONENT, Bracket, Extrapolation, extrapolation
from ryusa.casefile.precision import ErrorLimit
from ryusa.study.interval import short

UNEQUAL = 0.01  # level of Bartlett's test that seeds scatter alike at all stiffnesses [-]
MOST_SEEDS = 1000  # seeds that are proposed at most
GROWTH = 1.1  # of the number of seeds between two that are tried


class Answer(StrEnum):
    """What can be said of the softest stiffness within the tolerance."""

    ALL = "all within"
    SOME = "some within"
    NONE = "none within"
    UNKNOWN = "cannot be said"


@dataclass(frozen=True)
class Question:
    """What is asked.

    Attributes
    ----------
    measure, number : a measure, and the name of one of its numbers.
    unit : SI unit of the number.
    tolerance : largest error, as a share of the number or in its unit.
    against_hard : whether errors refer to hard grains, the limit of infinite stiffness, or to the case's own.
    """

    measure: str
    number: str
    unit: str
    tolerance: ErrorLimit
    against_hard: bool = False

    @property
    def name(self) -> str:
        """Measure and number in words."""
        return f"{self.measure} {self.number}"

    @property
    def error_unit(self) -> str:
        """Unit in which errors are given."""
        return self.tolerance.unit or "%"

    def in_unit(self, error: float) -> float:
        """An error in `error_unit`."""
        return error if self.tolerance.unit else 100.0 * error

    def words(self, error: float) -> str:
        """An error with its unit."""
        return f"{_plain(self.in_unit(error))} {self.error_unit}"

    def interval(self, error: Bracket) -> str:
        """An error with its interval, without the unit."""
        middle, low, high = (_plain(self.in_unit(one)) for one in (error.value, error.low, error.high))
        return f"{middle} ({low} to {high})"

    def number_in_words(self, found: Bracket) -> str:
        """The number asked for, with its bracket and unit."""
        unit = "" if self.unit == "-" else f" {self.unit}"
        return f"{short(found.value)}{unit} ({_plain(found.low)} to {_plain(found.high)})"


def _plain(value: float) -> str:
    return short(value) if math.isfinite(value) else "no limit"


@dataclass(frozen=True)
class SofterRuns:
    """Runs of one stiffness.

    Attributes
    ----------
    factor : stiffness of the case over this one [-].
    k_n : stiffness [N/m].
    longer : time step over that of the case [-]: so many times fewer steps.
    values : the number, one per seed; nan where a run has none.
    overlap : largest overlap over d in any of the runs [-]; nan if unknown.
    warnings : what `ryusa check` warns of at this stiffness and not at that of the case.
    problem : why a run has no number.
    """

    factor: float
    k_n: float
    longer: float
    values: tuple[float, ...]
    overlap: float = math.nan
    warnings: tuple[str, ...] = ()
    problem: str = ""

    @property
    def good(self) -> bool:
        """Whether every run has a number."""
        return all(math.isfinite(one) for one in self.values)

    @property
    def mean(self) -> float:
        """Mean over the seeds."""
        return float(np.mean(self.values))


@dataclass(frozen=True)
class SofterError:
    """Error of one stiffness: with its 95 % interval, and whether all of that is within the tolerance."""

    runs: SofterRuns
    error: Bracket
    within: bool | None  # False if all of it is outside, None if it cannot be said


@dataclass(frozen=True)
class Softening:
    """The answer of `ryusa soften`.

    Attributes
    ----------
    question : what was asked.
    k_n : stiffness of the case [N/m].
    runs : what was run, the stiffest first.
    fit : the extrapolation over stiffness; None if there is none.
    errors : of the stiffnesses that have numbers, the stiffest first; empty without an extrapolation.
    answer : the answer.
    says : the same in words.
    remarks : what to be careful of.
    seeds : number of seeds that would decide at this scatter; 0 if unknown.
    """

    question: Question
    k_n: float
    runs: tuple[SofterRuns, ...]
    fit: Extrapolation | None
    errors: tuple[SofterError, ...]
    answer: Answer
    says: str
    remarks: tuple[str, ...] = ()
    seeds: int = 0

    @property
    def softest(self) -> SofterError | None:
        """The softest stiffness within the tolerance; None if there is none, or it cannot be said."""
        return next((one for one in reversed(self.errors) if one.within), None)

    @property
    def reference(self) -> float:
        """Stiffness that errors refer to [N/m]; infinite for hard grains."""
        return math.inf if self.question.against_hard else self.k_n

    def __str__(self) -> str:
        return self.says


def answered(question: Question, k_n: float, runs: Sequence[SofterRuns]) -> Softening:
    """Answer the question from runs at some stiffnesses.

    Parameters
    ----------
    question : what is asked.
    k_n : stiffness of the case [N/m].
    runs : runs at each stiffness, with two seeds or more.

    Notes
    -----
    A stiffness is within the tolerance if all of the 95 % interval of its error is, and the mean over the
    seeds is known to the tolerance. Errors grow at every exponent as the stiffness falls, so that
    testing from the stiffest down to the first that fails needs no correction for their number.
    """
    runs = sorted(runs, key=lambda one: -one.k_n)
    good = [one for one in runs if one.good]

    def unknown(why: str, fit: Extrapolation | None = None) -> Softening:
        return _with_remarks(
            Softening(question, k_n, tuple(runs), fit, (), Answer.UNKNOWN, f"Cannot be said: {why}.")
        )

    if len(good) < 3:
        lost = "; ".join(f"{_stiffness(one)}: {one.problem or 'no number'}" for one in runs if not one.good)
        return unknown(
            f"{len(good)} of {len(runs)} stiffnesses gave a number in every run, and three are needed "
            f"({lost}). A stiffer ladder (--softer 2,4,8) may give all of them"
        )
    if all(len(set(one.values)) == 1 for one in good):
        same = good[0].mean
        every = f"{question.name} is {same:g} in every run" if {one.mean for one in good} == {same} else (
            f"all seeds give the same {question.name} at every stiffness"
        )  # fmt: skip
        return unknown(f"{every}, so that it is not known how far it scatters by chance")
    fit = extrapolation([one.k_n for one in good], [one.values for one in good])
    if not fit.follows:
        low, high = EXPONENT
        return unknown(
            f"the means do not follow y_inf + a k^-p at any p from {low:g} to {high:g}; in this range of the "
            "stiffness the motion itself may change. Take a stiffer ladder (--softer 2,4,8)",
            fit,
        )
    return _judged(question, k_n, tuple(runs), good, fit)


def _judged(
    question: Question,
    k_n: float,
    runs: tuple[SofterRuns, ...],
    good: Sequence[SofterRuns],
    fit: Extrapolation,
) -> Softening:
    against = math.inf if question.against_hard else k_n
    errors = tuple(_error(question, one, fit, against) for one in good)
    held = [one.within for one in errors]
    answer, says, seeds = Answer.UNKNOWN, "", 0
    if all(held):
        answer, one = Answer.ALL, errors[-1]
        most = max(abs(one.error.low), abs(one.error.high))
        says = (
            f"{_stiffness(one.runs)} is the softest of these and within {question.tolerance}: the stiffness "
            f"makes no difference larger than {question.words(most)}. {_saved(one)}. Softer ones may do "
            "(--softer)"
        )
    elif True in held:
        answer = Answer.SOME
        one = next(each for each in reversed(errors) if each.within)
        rest = [f"{_stiffness(each.runs)} {_verdict(each)}" for each in errors if not each.within]
        says = (
            f"The softest within {question.tolerance} is {_stiffness(one.runs)}: error "
            f"{_interval(question, one)}. {_saved(one)}. {'; '.join(rest)}"
        )
    elif None not in held:
        answer, one = Answer.NONE, errors[0]
        says = (
            f"None of these is within {question.tolerance}: the error of the stiffest, "
            f"{_stiffness(one.runs)}, is {_interval(question, one)}"
        )
    else:
        seeds = _seeds_needed(question, good, fit, against)
        says = f"Cannot be said: {_why(question, errors, fit, against, seeds)}"
    return _with_remarks(Softening(question, k_n, runs, fit, errors, answer, f"{says}.", seeds=seeds))


def _error(question: Question, one: SofterRuns, fit: Extrapolation, against: float) -> SofterError:
    relative = not question.tolerance.unit
    error, allowed = fit.error(one.k_n, against, relative), question.tolerance.amount
    within = None
    if error.low > allowed or error.high < -allowed:
        within = False
    elif -allowed <= error.low and error.high <= allowed and scatter(question, fit, against) <= allowed:
        within = True
    return SofterError(one, error, within)


def scatter(question: Question, fit: Extrapolation, against: float) -> float:
    """Half of the 95 % interval of a mean over the seeds, in the terms of the tolerance."""
    half = float(fit.scatter.max())
    if question.tolerance.unit:
        return half
    size = abs(fit.value(against).value)
    return half / size if size > 0.0 else math.inf


def _seeds_needed(question: Question, good: Sequence[SofterRuns], fit: Extrapolation, against: float) -> int:
    """Seeds at each stiffness that would decide the stiffest, did mean and scatter stay; 0 if unknown."""
    seeds = float(fit.count.min())
    now = seeds
    while seeds <= MOST_SEEDS:
        seeds = max(seeds * GROWTH, math.floor(seeds) + 1.0)
        more = fit.with_seeds(math.floor(seeds) / now)
        if more.follows and _error(question, good[0], more, against).within is not None:
            return math.floor(seeds)
    return 0


def _why(
    question: Question, errors: Sequence[SofterError], fit: Extrapolation, against: float, seeds: int
) -> str:
    now, p = int(fit.count.min()), fit.exponents
    chance = scatter(question, fit, against)
    words = (
        f"the mean of {now} seeds is known to {question.words(chance)} (95 %), the exponent as "
        f"{p.low:.2f} to {p.high:.2f}, and the error of the stiffest, {_stiffness(errors[0].runs)}, as "
        f"{_interval(question, errors[0])}, where {question.tolerance} is asked for"
    )
    if chance > question.tolerance.amount:
        words = f"seeds scatter by more than the tolerance: {words}"
    if seeds:
        longer = f"about {seeds} seeds, or in a steady flow runs {seeds / now:.2g} times as long,"
        return f"{words}. At this scatter {longer} would decide"
    return f"{words}. More seeds alone would hardly decide; a stiffer ladder (--softer 2,4,8) may"


def _with_remarks(found: Softening) -> Softening:
    """Add what to be careful of: contacts beyond the stable band, and scatter that depends on stiffness."""
    remarks = [f"{_stiffness(one)}: {text}" for one in found.runs for text in one.warnings]
    remarks += [
        f"{_stiffness(one)}: left out, {one.problem or 'a run has no number'}"
        for one in found.runs
        if not one.good
    ]
    values = [one.values for one in found.runs if one.good]
    if found.fit is not None:
        from scipy import stats

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # no scatter at all at one of the stiffnesses
            chance = float(stats.bartlett(*values).pvalue)
        if not chance > UNEQUAL:
            remarks.append(
                "seeds scatter differently at different stiffnesses (Bartlett's test, 1 %); intervals assume "
                "that they scatter alike"
            )
    return replace(found, remarks=tuple(remarks))


def _stiffness(one: SofterRuns) -> str:
    return f"k_n = {short(one.k_n)} N/m (1/{one.factor:g})"


def _interval(question: Question, one: SofterError) -> str:
    return f"{question.interval(one.error)} {question.error_unit}"


def _verdict(one: SofterError) -> str:
    return "is outside" if one.within is False else "cannot be said"


def _saved(one: SofterError) -> str:
    return f"It takes {one.runs.longer:.3g} times fewer steps than the case"
