"""Work carried out once, several pieces at a time, kept, and opened next time."""

from ryusa.study.cost import CostEstimate, code_in_words, duration, estimate_cost
from ryusa.study.fault import Fault, noted
from ryusa.study.plan import Level, Plan
from ryusa.study.progress import ProgressLines, StudyProgress
from ryusa.study.runs import TaskResults, carry_out
from ryusa.study.task import Calculation, CaseRun, Numbers, Task, calculation

__all__ = [
    "Calculation",
    "CaseRun",
    "CostEstimate",
    "Fault",
    "Level",
    "Numbers",
    "Plan",
    "ProgressLines",
    "StudyProgress",
    "Task",
    "TaskResults",
    "calculation",
    "carry_out",
    "code_in_words",
    "duration",
    "estimate_cost",
    "noted",
]
