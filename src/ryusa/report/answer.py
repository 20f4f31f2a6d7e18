"""The answer of a brief: sentences with intervals over the seeds, or why there is none."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from ryusa.cases.questions import CaseQuestion
from ryusa.errors import RyusaError
from ryusa.measure.formulae import predicted
from ryusa.measure.pooled import mean_of_runs
from ryusa.measure.statistics import Average
from ryusa.report.headlines import Headline, taken
from ryusa.results import Results
from ryusa.results.label import run_label
from ryusa.study.interval import Interval, not_negative, over_seeds, short

MOST = 5  # sentences
WIDE = 0.5  # half an interval over its value from which a number is called poorly known
SMALL = 0.02  # difference of two halves of a record over their mean that changes no answer


@dataclass(frozen=True)
class Sentence:
    """One sentence of the answer: text before, number with unit, text after, and how sure it is."""

    before: str
    number: str
    after: str
    sure: str


@dataclass(frozen=True)
class BriefAnswer:
    """What the page says first.

    Attributes
    ----------
    verdict : how far the runs support the sentences.
    supported : False where the first number has no interval.
    sentences : the most telling first.
    beside : what published formulae give, in words; empty where there are none.
    """

    verdict: str
    supported: bool
    sentences: tuple[Sentence, ...]
    beside: str


def answer(
    runs: Sequence[Results],
    question: CaseQuestion,
    begin: float | None = None,
    reach: tuple[float, float] | None = None,
) -> BriefAnswer:
    """Answer a question by runs of one case that differ in their seed.

    Parameters
    ----------
    begin : of the window of its averages [s]; default that of each measure.
    reach : of a row, in which a deposit is measured [m]; default that of the measure.
    """
    columns: dict[Headline, list[Average]] = {}
    reasons: list[str] = []
    for measure in question.measures:
        try:
            found = [taken(one, measure, begin, reach) for one in runs]
        except RyusaError as error:
            reasons.append(f"{measure}: {error}")
            continue
        if not all(found):
            reasons.append(f"{measure}: no samples")
        if {one.sentence for one in found[0]} & {one.sentence for one in columns}:
            continue  # the same by another measure, such as the slope of a round heap by its section
        for line in found[0]:
            if all(line in one for one in found):
                columns[line] = [one[line] for one in found]
    chosen = dict(list(columns.items())[:MOST])
    if not chosen:
        why = "; ".join(reasons) or "no measure of ryusa gives it"
        return BriefAnswer(f"None: these runs do not answer the question ({why}).", False, (), "")
    alone = not runs[0].scene.n_grain and runs[0].row is not None
    sentences = tuple(_sentence(line, column, alone) for line, column in chosen.items())
    unsteady = _unsteady(next(iter(chosen.values())))
    every = [one for column in chosen.values() for one in column]
    verdict = _verdict(runs, every, unsteady, alone)
    return BriefAnswer(verdict, not unsteady and (alone or len(runs) > 1), sentences, _beside(runs, chosen))


def _verdict(runs: Sequence[Results], every: Sequence[Average], unsteady: bool, alone: bool) -> str:
    n, seeds = len(runs), ", ".join(str(one.provenance.get("seed")) for one in runs)
    said: list[str] = []
    unfinished = [run_label(one) for one in runs if not one.complete]
    if unfinished:
        said.append(f"Not complete: {', '.join(unfinished)}.")
    if any("--try" in (one.provenance.get("command") or ()) for one in runs):
        said.append("A trial alone: its times are shortened.")
    if unsteady:
        said.append(
            "No answer that the runs support: the first number still changes with time, so it describes this "
            "record and nothing later."
        )
    if alone:
        said.append("Nothing is random in water alone: one run suffices, and no statistical interval exists.")
        last = next((one.window for one in every if one.n_series), None)
        if last is not None and not any(one.changes for one in every):
            said.append(
                f"Means from {last[0]:.4g} to {last[1]:.4g} s, in which they change by less than 1 %."
            )
    elif n == 1:
        said.append(
            f"No interval: one run was made (seed {seeds}), and how much another run of the same case would "
            "differ is not known."
        )
    elif not unsteady:
        said.append(f"Means of {n} runs of one case, which differ in their random seed ({seeds}) alone.")
    if not alone and not unsteady and any(one.short and one.n_series for one in every):
        said.append("Some records are too short to show that they are steady.")
    return " ".join(said)


def _sentence(line: Headline, column: Sequence[Average], alone: bool) -> Sentence:
    before, _, after = line.sentence.partition("{}")
    values = [one.value for one in column]
    found = over_seeds(values, line.unit)
    if min(values) >= 0.0:
        found = not_negative(found)
    unit = "" if line.unit == "-" else "°" if line.unit == "deg" else f" {line.unit}"
    whole = _whole(column)
    change = _change(whole, unit) if any(one.changes for one in column) else ""
    if _unsteady(column):
        sure = "still changing at the end of the run"
        if column[0].n_series:
            sure = f"not steady from {whole.window[0]:.3g} to {whole.window[1]:.4g} s{change}"
        return Sentence(before, f"{short(found.value)}{unit}", after, sure)
    if len(values) == 1:
        counts = alone or not whole.n_series
        sure = "" if counts else f"mean from {whole.window[0]:.3g} to {whole.window[1]:.4g} s{change}"
        return Sentence(before, f"{short(found.value)}{unit}", after, sure)
    value, low, high = _rounded(found)
    sure = f"95 % interval {low} to {high}{unit}{change}"
    if found.high - found.value > WIDE * abs(found.value):
        sure += ": poorly known, more runs would narrow it"
    return Sentence(before, f"{value}{unit}", after, sure)


def _unsteady(column: Sequence[Average]) -> bool:
    """Whether a number changes by more than two hundredths of itself, and than its interval over the runs.

    A long record shows that it changes also where it hardly does; such a number is an answer.
    """
    if not any(one.changes for one in column):
        return False
    whole, found = _whole(column), over_seeds([one.value for one in column], "-")
    if not math.isfinite(whole.drift) or math.isinf(whole.variation):
        return True
    half = found.high - found.value if len(column) > 1 else 0.0
    return abs(whole.drift) > max(SMALL * abs(whole.value), half)


def _whole(column: Sequence[Average]) -> Average:
    return mean_of_runs(column) if len(column) > 1 else column[0]


def _change(one: Average, unit: str) -> str:
    if not math.isfinite(one.drift):
        return ""
    by = " points" if unit == " %" else unit
    return f", second half {'higher' if one.drift > 0.0 else 'lower'} by {short(abs(one.drift))}{by}"


def _rounded(found: Interval) -> tuple[str, str, str]:
    """Value and limits, to two digits of half the interval.

    >>> _rounded(Interval(1.0649, 1.0112, 1.1186, "-", 3, ""))
    ('1.065', '1.011', '1.119')
    """
    half = found.high - found.value
    if not half > 0.0:
        return short(found.value), short(found.low), short(found.high)
    digits = 1 - math.floor(math.log10(half))
    shown = [f"{round(one, digits):.{max(digits, 0)}f}" for one in (found.value, found.low, found.high)]
    return shown[0], shown[1], shown[2]


def _beside(runs: Sequence[Results], chosen: dict[Headline, list[Average]]) -> str:
    """What bed-load formulae give at the Shields number of the runs, in kg/s/m."""
    by_take = {line.take: column for line, column in chosen.items()}
    if "q_mass" not in by_take or "tau_star" not in by_take:
        return ""
    tau = sum(one.value for one in by_take["tau_star"]) / len(runs)
    scene, rho_w = runs[0].scene, float(runs[0].case["water"]["density"])
    rho = float(scene.m.sum() / scene.solid_volume.sum())
    scale = math.sqrt((rho / rho_w - 1.0) * float(runs[0].case["derived"]["g"]) * scene.d_mean**3)
    rates = {name: rate * scale * rho for name, rate in predicted(tau).items()}
    given = ", ".join(f"{name} {short(rate)} kg/s/m" for name, rate in rates.items())
    of_case = float(runs[0].case["derived"].get("tau_star") or math.nan)
    apart = ""
    if abs(tau - of_case) > SMALL * of_case:
        apart = (
            f"By depth and slope the Shields number is {short(of_case)}; the bed takes {short(tau)} while "
            f"the water still {'slows down' if tau > of_case else 'speeds up'}, or grains take part. "
        )
    return (
        f"{apart}For comparison, formulae for a plane bed at the Shields number of the bed: {given}. In the "
        f"picture, q_* = 1 stands for {short(scale * rho)} kg/s/m."
    )
