"""Work carried out once, several pieces at a time, kept, and opened next time."""

from ryusa.campaign.ahead import Outlook, code_in_words, duration, outlook
from ryusa.campaign.carry import Campaign, carry_out
from ryusa.campaign.fault import Fault, spared
from ryusa.campaign.plan import Level, Plan
from ryusa.campaign.say import Lines, Say
from ryusa.campaign.work import Calculation, Numbers, Variant, Work, calculation, case_path

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
    "case_path",
    "code_in_words",
    "duration",
    "outlook",
    "spared",
]
