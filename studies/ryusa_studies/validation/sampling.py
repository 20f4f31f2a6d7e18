"""How often and for how long each comparison with random draws is run, and why: sampling.toml.

Verdicts of single runs do not repeat (design/0015). A number is the mean over independent runs with its 95 %
interval between runs; block means within a run are not enough where the flow stops and starts.
"""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ryusa.study import Level, Plan

STRIDE = 1000  # between the seeds of runs that belong to one seed of the study


@dataclass(frozen=True)
class Sampling:
    """Runs of one comparison.

    Attributes
    ----------
    runs : independent runs for each seed of the study, at the standard and at the full level.
    time : length of a run at the quick, standard and full level, in `unit`; from the case file where None.
    unit : what `time` counts.
    why : reason of both.
    """

    runs: tuple[int, int]
    time: tuple[float, float, float] | None
    unit: str
    why: str

    def length(self, level: Level) -> float:
        """Length of a run; nan for that of the case file."""
        return math.nan if self.time is None else self.time[list(Level).index(level)]

    def seeds(self, plan: Plan) -> tuple[int, ...]:
        """Seeds of all runs; those of disjoint seeds of the study, up to STRIDE, are disjoint.

        >>> SAMPLING["equilibrium"].seeds(Plan(Level.STANDARD, (1, 2)))
        (1, 1001, 2, 1002)
        """
        n = 1 if plan.level is Level.QUICK else self.runs[plan.level is Level.FULL]
        return tuple(seed + STRIDE * k for seed in plan.seeds for k in range(n))


def _sampling(given: Mapping[str, Any]) -> Sampling:
    time = tuple(given["time"]) if "time" in given else None
    return Sampling(tuple(given["runs"]), time, given.get("unit", "s"), given["why"])


_GIVEN = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
SAMPLING = {name: _sampling(one) for name, one in _GIVEN["sampling"].items()}
CLOSED: Mapping[str, str] = _GIVEN["closed"]


def sampling_lines(level: Level) -> list[dict[str, str]]:
    """Runs of each comparison at one level, in words."""
    if level is Level.QUICK:
        return []
    return [
        {
            "name": name,
            "runs": f"{one.runs[level is Level.FULL]}",
            "length": "as in the case file" if one.time is None else f"{one.length(level):g} {one.unit}",
            "why": one.why,
        }
        for name, one in SAMPLING.items()
        if one.runs[level is Level.FULL]
    ]


def sampling_table() -> str:
    """Runs of each comparison at the standard and at the full level, in Markdown."""
    lines = ["| comparison | runs for each seed, length of a run | full level | why |", "|---|---|---|---|"]
    standard = {one["name"]: one for one in sampling_lines(Level.STANDARD)}
    for one in sampling_lines(Level.FULL):
        first = standard.get(one["name"])
        cells = ["none" if each is None else f"{each['runs']}, {each['length']}" for each in (first, one)]
        lines.append("| " + " | ".join([one["name"], *cells, one["why"]]) + " |")
    return "\n".join(lines)
