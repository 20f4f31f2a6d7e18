"""Case files: TOML to a checked, frozen `Case` in SI. Every unit and range is checked here."""

from ryusa.casefile.estimate import disk_needed, frames_expected, steps_expected
from ryusa.casefile.faults import all_keys, described
from ryusa.casefile.read import json_schema, json_schema_text, read, read_text
from ryusa.casefile.schema import Case, Change

__all__ = [
    "Case",
    "Change",
    "all_keys",
    "described",
    "disk_needed",
    "frames_expected",
    "json_schema",
    "json_schema_text",
    "read",
    "read_text",
    "steps_expected",
]
