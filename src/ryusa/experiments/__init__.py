"""One short file per figure of the paper: runs, measure, what the paper says, and how it is drawn."""

from ryusa.experiments._campaign import Campaign, carry_out
from ryusa.experiments._experiment import (
    NAMES,
    PHI,
    RATIO,
    ROTATION,
    SLIP,
    Experiment,
    Found,
    Level,
    Plan,
    Variant,
    case_path,
    load,
    variant,
)
from ryusa.experiments._fault import Fault, spared
from ryusa.experiments._outlook import Outlook, cost, duration, outlook
from ryusa.experiments._say import Lines, Say
from ryusa.experiments._verdict import (
    Band,
    Finding,
    Interval,
    Pooled,
    Trial,
    Word,
    over_range,
    over_seeds,
    pool,
    short,
)

__all__ = [
    "NAMES",
    "PHI",
    "RATIO",
    "ROTATION",
    "SLIP",
    "Band",
    "Campaign",
    "Experiment",
    "Fault",
    "Finding",
    "Found",
    "Interval",
    "Level",
    "Lines",
    "Outlook",
    "Plan",
    "Pooled",
    "Say",
    "Trial",
    "Variant",
    "Word",
    "carry_out",
    "case_path",
    "cost",
    "duration",
    "load",
    "outlook",
    "over_range",
    "over_seeds",
    "pool",
    "short",
    "spared",
    "variant",
]
