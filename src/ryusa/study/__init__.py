"""Studies: a plan of runs, measures on them, judgements, and a page with the results.

A study has parts (`StudyPart`). Each part lists its tasks, measures every run, and judges the measurements.
The framework carries out every task once, keeps the results for later calls, and writes the ledger and the
page.
"""

from ryusa.study.compare import comparison, misfit, relative
from ryusa.study.cost import CostEstimate, code_in_words, duration, estimate_cost
from ryusa.study.design import Design, Factor
from ryusa.study.fault import Fault, noted
from ryusa.study.intermittent import correlation_time, rate_with_rests, share_over_runs
from ryusa.study.interval import (
    CONFIDENCE,
    Interval,
    Pooled,
    exact,
    largest_mean,
    not_negative,
    over_range,
    over_seeds,
    pool,
    pool_alike,
    pseudo_values,
    short,
    transformed,
)
from ryusa.study.judge import (
    Band,
    Finding,
    Known,
    Outcome,
    ReferenceChart,
    Source,
    Trial,
    at_most,
    seeds_trial,
)
from ryusa.study.plan import Level, Plan
from ryusa.study.progress import ProgressLines, StudyProgress
from ryusa.study.runs import TaskResults, carry_out
from ryusa.study.study import Found, Study, StudyPart
from ryusa.study.task import Calculation, CaseRun, Task, calculation, case_run

__all__ = [
    "CONFIDENCE",
    "Band",
    "Calculation",
    "CaseRun",
    "CostEstimate",
    "Design",
    "Factor",
    "Fault",
    "Finding",
    "Found",
    "Interval",
    "Known",
    "Level",
    "Outcome",
    "Plan",
    "Pooled",
    "ProgressLines",
    "ReferenceChart",
    "Source",
    "Study",
    "StudyPart",
    "StudyProgress",
    "Task",
    "TaskResults",
    "Trial",
    "at_most",
    "calculation",
    "carry_out",
    "case_run",
    "code_in_words",
    "comparison",
    "correlation_time",
    "duration",
    "estimate_cost",
    "exact",
    "largest_mean",
    "misfit",
    "not_negative",
    "noted",
    "over_range",
    "over_seeds",
    "pool",
    "pool_alike",
    "pseudo_values",
    "rate_with_rests",
    "relative",
    "seeds_trial",
    "share_over_runs",
    "short",
    "transformed",
]
