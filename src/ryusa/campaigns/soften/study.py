"""The runs of `ryusa soften` as a study: three softer stiffnesses with several seeds each."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ryusa.campaigns.soften.answer import Answer, Question, Softening, SofterError, SofterRuns, answered
from ryusa.campaigns.soften.extrapolate import Bracket
from ryusa.campaigns.soften.scaling import refuse_if_not_softenable, softened
from ryusa.casefile.contact.impact import impact_rows
from ryusa.casefile.derive import derive
from ryusa.catalogue import MEASURES, called
from ryusa.errors import RunError
from ryusa.figures.softening import StiffnessRun, softening
from ryusa.results import Results
from ryusa.study import Band, CaseRun, Finding, Found, Interval, Outcome, Plan, Study, Trial
from ryusa.study.origin import json_number

KEY = "contact.stiffness"
BEYOND = 4.0  # times the stiffness of the case that the picture shows
POINTS = 60  # of the bracket in the picture


class SoftenPart:
    """The one part of the study.

    Parameters
    ----------
    run : run of the case with its own stiffness.
    question : what is asked.
    factors : stiffness of the case over those that are run [-].
    """

    def __init__(self, run: CaseRun, question: Question, factors: Sequence[float]) -> None:
        case = run.read()
        refuse_if_not_softenable(case)
        self.TITLE = f"{question.name} of {run.case}"
        self.question, self._run = question, run
        self._soft = {factor: softened(run, factor) for factor in sorted(factors)}
        self.answer: Softening | None = None  # of the runs judged last

    def tasks(self, plan: Plan) -> Sequence[CaseRun]:
        """Every stiffness with every seed."""
        return [one for runs in self._seeded(plan).values() for one in runs]

    def _seeded(self, plan: Plan) -> dict[float, list[CaseRun]]:
        """Runs by the factor of their stiffness."""
        return {
            factor: [
                CaseRun(
                    one.case, tuple(sorted({**dict(one.overrides), "seed": str(seed)}.items())), one.cases
                )
                for seed in plan.seeds
            ]
            for factor, one in self._soft.items()
        }

    def measure(self, results: Results, task: CaseRun) -> dict[str, Any]:
        """The number asked for, and the largest overlap."""
        del task
        entry = next(one for one in MEASURES if one.name == self.question.measure)
        found: Any = called(entry)(results)
        rows = (found.averages if hasattr(found, "averages") else found).rows()
        values = {row["quantity"]: float(row["value"]) for row in rows}
        overlap = results.tally["overlap_max"]
        return {
            "value": values.get(self.question.number, math.nan),
            "overlap": float(overlap[-1]) if len(overlap) else math.nan,
        }

    def failed(self, error: RunError) -> dict[str, Any]:
        """A run that ended with an error has no number; contacts may be too soft for it."""
        return {"value": math.nan, "overlap": math.nan, "problem": str(error)}

    def softening(self, found: Found, plan: Plan) -> Softening:
        """The answer from what was measured."""
        own = self._run.read()
        warned = {row.name for row in impact_rows(own, derive(own)) if row.flag == "warning"}
        runs: list[SofterRuns] = []
        for factor, tasks in self._seeded(plan).items():
            case = tasks[0].read()
            derived, every = derive(case), [found[one] for one in tasks]
            runs.append(
                SofterRuns(
                    factor=factor,
                    k_n=derived.k_n,
                    longer=derived.dt / derive(own).dt,
                    values=tuple(one["value"] for one in every),
                    overlap=float(np.max([one["overlap"] for one in every])),
                    warnings=tuple(
                        f"{row.name} {row.shown}, beyond what `ryusa check` finds safe"
                        for row in impact_rows(case, derived)
                        if row.flag == "warning" and row.name not in warned
                    ),
                    problem=next((one["problem"] for one in every if "problem" in one), ""),
                )
            )
        return answered(self.question, derive(own).k_n, runs)

    def judge(self, found: Found, plan: Plan) -> Sequence[Finding]:
        """The error of every stiffness beside the tolerance; undecided where nothing can be said."""
        self.answer = answer = self.softening(found, plan)
        trials = tuple(_trial(self.question, one, len(plan.seeds)) for one in answer.errors)
        known = answer.answer is not Answer.UNKNOWN
        return [
            Finding(
                "error", trials if known else (), answer.says, _settings(answer), also=answer.remarks,
                beside=() if known else trials, title=self.TITLE,
            )
        ]  # fmt: skip

    def rows(self, found: Found, plan: Plan) -> list[dict[str, object]]:
        """One line for each stiffness, the stiffest first, with the numbers of its seeds."""
        answer = self.softening(found, plan)
        errors = {one.runs.factor: one for one in answer.errors}
        nothing = Bracket(math.nan, math.nan, math.nan)
        rows: list[dict[str, object]] = []
        for one in answer.runs:
            error = errors[one.factor].error if one.factor in errors else nothing
            within = errors[one.factor].within if one.factor in errors else None
            row: dict[str, object] = {
                    "k_n_N_per_m": one.k_n, "softer": one.factor, "fewer_steps": one.longer, "mean": one.mean,
                    "unit": self.question.unit, "error": error.value, "error_low": error.low,
                    "error_high": error.high, "error_unit": self.question.tolerance.unit or "-",
                    "within": {True: "yes", False: "no", None: "cannot be said"}[within],
                    "overlap_over_d": one.overlap,
            }  # fmt: skip
            row |= {f"seed {seed}": value for seed, value in zip(plan.seeds, one.values, strict=True)}
            rows.append(row)
        return rows

    def draw(self, found: Found, plan: Plan) -> Mapping[str, Figure]:
        """The measure over the stiffness, with bracket and tolerance."""
        answer = self.softening(found, plan)
        good = [one for one in answer.runs if one.good]
        if not good:
            return {}
        half = [0.0] * len(good) if answer.fit is None else [float(one) for one in answer.fit.scatter]
        runs = [
            StiffnessRun(one.k_n, one.values, one.mean, each) for one, each in zip(good, half, strict=True)
        ]
        unit = "–" if self.question.unit == "-" else self.question.unit
        bracket = reference = None
        if answer.fit is not None and answer.fit.follows:
            k = np.geomspace(min(one.k_n for one in good) / 2.0, BEYOND * answer.k_n, POINTS)
            ends = [answer.fit.value(float(one)) for one in k]
            bracket = k, np.array([one.low for one in ends]), np.array([one.high for one in ends])
            middle = answer.fit.value(answer.reference).value
            room = self.question.tolerance.of(middle)
            reference = middle, middle - room, middle + room
        return {"error": softening(runs, bracket, reference, answer.k_n, f"{self.question.name}  ({unit})")}


class SoftenStudy(Study):
    """The study of one case, one measure and one tolerance."""

    name = "soften"
    stem = "soften"
    parts = ("soften",)
    words: Mapping[Outcome, str] = {
        Outcome.HOLDS: "within",
        Outcome.FAILS: "outside",
        Outcome.EXCLUDED: "outside",
        Outcome.SHOWN: "cannot be said",
        Outcome.UNDECIDED: "cannot be said",
    }
    template = Path(__file__).with_name("soften.html")

    def __init__(self, part: SoftenPart, command: str) -> None:
        self._part, self.command = part, command
        self.title = f"How soft may it be? {part.TITLE}"

    def part(self, name: str) -> SoftenPart:
        """Return the one part."""
        del name
        return self._part

    @property
    def answer(self) -> Softening | None:
        """The answer; None before the runs are judged, and where runs failed."""
        return self._part.answer

    def head(self, findings: Sequence[Finding]) -> dict[str, Any]:
        """The answer for programs: its kind, the softest stiffness, the exponent and the hard limit."""
        answer = self.answer
        if answer is None or not findings:
            return {}
        fit, softest = answer.fit, answer.softest
        known = fit is not None and fit.follows
        return {
            "softening": {
                "answer": str(answer.answer),
                "softest_k_n": None if softest is None else softest.runs.k_n,
                "fewer_steps": None if softest is None else softest.runs.longer,
                "case_k_n": answer.k_n,
                "tolerance": str(answer.question.tolerance),
                "against": "hard" if answer.question.against_hard else "case",
                "exponent": _plain(fit.exponents) if fit is not None and known else None,
                "hard": _plain(fit.value(math.inf)) if fit is not None and known else None,
                "case": _plain(fit.value(answer.k_n)) if fit is not None and known else None,
                "seeds_needed": answer.seeds or None,
            }
        }


def _plain(found: Bracket) -> dict[str, float | None]:
    return {name: json_number(getattr(found, name)) for name in ("value", "low", "high")}


def _trial(question: Question, one: SofterError, seeds: int) -> Trial:
    error, unit = one.error, question.error_unit
    low, value, high = (question.in_unit(each) for each in (error.low, error.value, error.high))
    how = f"95 % over {seeds} seeds and every exponent that agrees with them"
    allowed = question.in_unit(question.tolerance.amount)
    against = "hard grains" if question.against_hard else "the stiffness of the case"
    return Trial(
        f"error of {question.name}",
        {KEY: f"{one.runs.k_n:.4g} N/m"},
        Interval(value, low, high, unit, seeds, how),
        Band(-allowed, allowed, unit, f"tolerance, against {against}"),
        note=f"{one.runs.longer:.3g} times fewer steps",
    )


def _settings(answer: Softening) -> dict[str, str]:
    """Exponent, hard limit and the number at the stiffness of the case, in words."""
    found = {"stiffness of the case": f"{answer.k_n:.4g} N/m"}
    fit, question = answer.fit, answer.question
    if fit is None or not fit.follows:
        return found
    p = fit.exponents
    return found | {
        "exponent p": f"{p.value:.2f} ({p.low:.2f} to {p.high:.2f})",
        "extrapolated to the stiffness of the case": question.number_in_words(fit.value(answer.k_n)),
        "extrapolated to hard grains": question.number_in_words(fit.value(math.inf)),
    }
