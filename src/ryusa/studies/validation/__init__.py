"""One short file per reference: what ours is set against, its error as a number, and how large it may be."""

from ryusa.studies.validation._check import (
    NAMES,
    Check,
    Comparison,
    Error,
    Found,
    Known,
    Source,
    Tolerance,
    Word,
    at_most,
    case_run,
    load,
    relative,
)

__all__ = [
    "NAMES",
    "Check",
    "Comparison",
    "Error",
    "Found",
    "Known",
    "Source",
    "Tolerance",
    "Word",
    "at_most",
    "case_run",
    "load",
    "relative",
]
