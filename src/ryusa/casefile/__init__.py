"""Case files: TOML to a checked, frozen `Case` in SI, and what follows from it.

Every unit and range is checked here. Each subject (grains, contact, motion, domain, water, films, column,
builders, time, record) has its keys, its checks, its derived values and its rows of `ryusa check` in one
module, or in a package of `schema`, `checks`, `values` and `rows`. `case.py` puts the keys together and
imports nothing else of a subject; `facts.py` holds what follows, frozen. `derive`, `explain`, `estimate`,
`checks` and `read` stand above the subjects, and no subject imports them.

>>> from ryusa import casefile
>>> case = casefile.read("case.toml")  # doctest: +SKIP
>>> casefile.derive(case).dt  # doctest: +SKIP
>>> for row in casefile.explain(case):  # doctest: +SKIP
...     print(row.name, row.shown, row.origin)
"""

from ryusa.casefile.case import Case
from ryusa.casefile.derive import derive
from ryusa.casefile.estimate import disk_needed, frames_expected
from ryusa.casefile.explain import explain
from ryusa.casefile.facts import Derived
from ryusa.casefile.keys import all_keys, described
from ryusa.casefile.read import json_schema, json_schema_text, read, read_text
from ryusa.casefile.record.schema import ChangeSection
from ryusa.casefile.resolved import resolved
from ryusa.casefile.wall_time import steps_expected

__all__ = [
    "Case",
    "ChangeSection",
    "Derived",
    "all_keys",
    "derive",
    "described",
    "disk_needed",
    "explain",
    "frames_expected",
    "json_schema",
    "json_schema_text",
    "read",
    "read_text",
    "resolved",
    "steps_expected",
]
