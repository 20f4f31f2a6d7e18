"""One short file per figure of the paper: cases, measure, what the paper says, and how it is drawn."""

from ryusa.experiments._experiment import (
    NAMES,
    Experiment,
    Outcome,
    Variant,
    Verdict,
    case_path,
    load,
    run_experiment,
    run_variant,
)

__all__ = [
    "NAMES",
    "Experiment",
    "Outcome",
    "Variant",
    "Verdict",
    "case_path",
    "load",
    "run_experiment",
    "run_variant",
]
