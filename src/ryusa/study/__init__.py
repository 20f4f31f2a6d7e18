"""Work carried out once, several pieces at a time, kept, and opened next time."""

from ryusa.study.cost import Outlook, code_in_words, duration, outlook
from ryusa.study.fault import Fault, spared
from ryusa.study.plan import Level, Plan
from ryusa.study.progress import Lines, Say
from ryusa.study.runs import Campaign, carry_out
from ryusa.study.task import Calculation, Numbers, Variant, Work, calculation

__all__ = [
    "Calculation",
    "Campaign",
    "Fault",
    "Level",
    "Lines",
    "Numbers",
    "Outlook",
    "Plan",
    "Say",
    "Variant",
    "Work",
    "calculation",
    "carry_out",
    "code_in_words",
    "duration",
    "outlook",
    "spared",
]
