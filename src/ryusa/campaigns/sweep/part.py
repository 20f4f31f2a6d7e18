"""The runs of a sweep, and what is measured of each."""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ryusa.campaigns.sweep.design import SEED
from ryusa.campaigns.sweep.measures import AtHeight, averages_of
from ryusa.catalogue import MeasureEntry
from ryusa.errors import RyusaError
from ryusa.measure.statistics import Average
from ryusa.report.page import report_page
from ryusa.results import Results, schema
from ryusa.running.disk import write_atomically
from ryusa.study import CaseRun, Plan, TaskResults

PAGE_SIZE = 2.0e6  # of the grains in motion on the page of one run [B]
PAGE_SECONDS = 4.0  # to measure a run and write its page
_LONGEST = 60  # letters of a folder's name before its digest


@dataclass(frozen=True)
class SweepRun(CaseRun):
    """One run of a sweep; its folder follows from what varies, so that a changed case is noticed in it.

    Attributes
    ----------
    setting : number of its setting, from 0.
    varied : keys that vary with their values, and the seed.
    page : whether it gets its page.
    """

    setting: int = 0
    varied: tuple[tuple[str, str], ...] = ()
    page: bool = True

    @property
    def folder(self) -> str:
        """Folder of the run, relative to that of all runs."""
        names = short_names([key for key, _ in self.varied])
        said = "_".join(
            f"{name}-{re.sub(r'[^A-Za-z0-9.+-]+', '', value)}"
            for name, (_, value) in zip(names, self.varied, strict=True)
        )
        digest = hashlib.sha256(repr((self.case, sorted(self.varied))).encode()).hexdigest()[:8]
        return f"{said[:_LONGEST]}-{digest}"

    @property
    def label(self) -> str:
        """Words for the progress line.

        >>> SweepRun("bed", varied=(("motion.slope", "0.01"), ("seed", "2"))).label
        'slope 0.01 seed 2'
        """
        names = short_names([key for key, _ in self.varied])
        return " ".join(f"{name} {value}" for name, (_, value) in zip(names, self.varied, strict=True))

    def cost(self) -> float:
        """Estimated core seconds of the run, with its page."""
        return super().cost() + self.page_cost

    def cost_by_rule(self) -> float:
        """Estimated core seconds by the rule of thumb, with its page."""
        return super().cost_by_rule() + self.page_cost

    @property
    def page_cost(self) -> float:
        """Estimated core seconds to measure it and write its page."""
        return PAGE_SECONDS * (1 + self.page) / 2

    def disk(self) -> int:
        """Estimated size of the run with its page [bytes]."""
        return super().disk() + int(PAGE_SIZE) * self.page

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return int(dict(self.varied)[SEED])


def short_names(keys: Sequence[str]) -> list[str]:
    """Last words of dotted keys; whole keys where two end alike.

    >>> short_names(["motion.slope", "grains.density", "water.density"])
    ['slope', 'grains.density', 'water.density']
    """
    last = [key.rsplit(".", 1)[-1] for key in keys]
    return [key if last.count(one) > 1 else one for key, one in zip(keys, last, strict=True)]


@dataclass(frozen=True)
class Measured:
    """What is known of one run.

    Attributes
    ----------
    averages : by measure, its quantities that have samples.
    problems : by measure that could not be had, and "run" or "page", the reason.
    warnings : of the physics, as the run states them.
    """

    averages: Mapping[str, tuple[Average, ...]] = field(default_factory=dict[str, tuple[Average, ...]])
    problems: Mapping[str, str] = field(default_factory=dict[str, str])
    warnings: tuple[str, ...] = ()


def measured(run: SweepRun, part: str, results: TaskResults) -> Measured:
    """What is known of a run of a part, one that failed included."""
    found = results.found[part].get(run)
    if found is not None:
        return found
    fault = results.missing.get(part, {}).get(run)
    return Measured(problems={"run": fault.words if fault is not None else "was not carried out"})


def problems_of(found: Mapping[SweepRun, Measured]) -> dict[str, str]:
    """Runs or measures without numbers, with the reason."""
    return {
        one.label if what == "run" else f"{one.label}: {what}": reason
        for one, held in found.items()
        for what, reason in held.problems.items()
    }


@dataclass(frozen=True)
class SweepPart:
    """The one part of a sweep, for `carry_out`; small enough to be sent between processes.

    Attributes
    ----------
    runs : all runs, setting by setting.
    measures : what is measured of each.
    heights : quantities over height that are wanted at one height.
    """

    runs: tuple[SweepRun, ...]
    measures: tuple[MeasureEntry, ...]
    heights: tuple[AtHeight, ...] = ()
    TITLE = "sweep"

    def tasks(self, plan: Plan) -> Sequence[SweepRun]:
        """All runs; their seeds are in them."""
        del plan
        return self.runs

    def measure(self, results: Results, task: CaseRun) -> Measured:
        """Every measure of a run, and its page; what cannot be had gives its reason."""
        averages: dict[str, tuple[Average, ...]] = {}
        problems: dict[str, str] = {}
        for entry in self.measures:
            try:
                heights = [one for one in self.heights if one.measure == entry.name]
                averages[entry.name] = averages_of(entry, results, heights)
            except RyusaError as error:
                problems[entry.name] = str(error)
            else:
                if not averages[entry.name]:
                    problems[entry.name] = "no samples in the window"
        if isinstance(task, SweepRun) and task.page and (problem := write_page(results)):
            problems["page"] = problem
        warnings: Any = results.summary.get("warnings", ())
        return Measured(averages, problems, tuple(str(one) for one in warnings))


def write_page(results: Results) -> str:
    """Write the page of a run into its folder unless it is there; return why it could not be made, or ""."""
    path = results.folder / schema.REPORT
    if path.is_file():
        return ""
    try:
        write_atomically(path, report_page([results], size=PAGE_SIZE).encode())
    except RyusaError as error:
        return str(error)
    return ""


def runs_of(
    case: Path,
    overrides: Mapping[str, str],
    settings: Sequence[Mapping[str, str]],
    seeds: Sequence[int],
    *,
    page: bool = True,
) -> tuple[SweepRun, ...]:
    """Every setting with every seed, setting by setting; `page` says whether each run gets its page."""
    found: list[SweepRun] = []
    for k, setting in enumerate(settings):
        for seed in seeds:
            varied = {**setting, SEED: str(seed)}
            found.append(
                SweepRun(
                    case.stem, tuple(sorted({**overrides, **varied}.items())), case.parent,
                    setting=k, varied=tuple(varied.items()), page=page,
                )
            )  # fmt: skip
    return tuple(found)
