"""A sweep checked as a whole, before anything runs: every case read, explained and built."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ryusa.campaigns.sweep.design import MOST, SweepDesign
from ryusa.campaigns.sweep.measures import AtHeight, measures_of, refuse_measure
from ryusa.campaigns.sweep.part import SweepPart, SweepRun, runs_of, short_names
from ryusa.campaigns.sweep.table import SweepColumn, column_of
from ryusa.casefile.derive import derive
from ryusa.casefile.explain import explain
from ryusa.casefile.resolved import resolved
from ryusa.errors import CaseError
from ryusa.study import case_run

MOST_PLACED = 200_000  # grains of all settings together up to which the first grains are placed as a check
LARGEST_SEED = 2**63
_NAMED = 3  # settings that a fault names


@dataclass(frozen=True)
class SweepPlan:
    """What a sweep will run; every case of it has been checked.

    Attributes
    ----------
    case : case file.
    overrides : keys set in all runs.
    design : settings.
    seeds : seeds of every setting.
    part : runs and measures.
    columns : keys that vary, with their values in SI.
    explained : names of values that differ between settings, as `ryusa check` prints them, and their text in
        every setting.
    warnings : what `ryusa check` warns of, with the numbers of the settings from 1.
    """

    case: Path
    overrides: Mapping[str, str]
    design: SweepDesign
    seeds: tuple[int, ...]
    part: SweepPart
    columns: tuple[SweepColumn, ...]
    explained: tuple[tuple[str, tuple[str, ...]], ...]
    warnings: Mapping[str, tuple[int, ...]]

    @property
    def measures(self) -> tuple[str, ...]:
        """Names of the measures."""
        return tuple(one.name for one in self.part.measures)

    @property
    def runs(self) -> tuple[SweepRun, ...]:
        """All runs, setting by setting."""
        return self.part.runs

    @property
    def first_runs(self) -> list[SweepRun]:
        """Run of every setting with the first seed."""
        return list(self.runs[:: len(self.seeds)])

    def named(self, which: Sequence[int]) -> str:
        """Settings by their numbers from 1."""
        every = len(which) == len(self.design.settings)
        return "all settings" if every else f"setting {', '.join(map(str, which))}"

    def setting_in_words(self, k: int) -> str:
        """Setting number k from 0 in words."""
        return _words(self.design, k)


def plan_sweep(
    case: Path,
    design: SweepDesign,
    seeds: Sequence[int],
    measures: Sequence[str],
    *,
    overrides: Mapping[str, str] | None = None,
    pages: bool = True,
    heights: Sequence[AtHeight] = (),
) -> SweepPlan:
    """Check a sweep as a whole.

    Parameters
    ----------
    case : case file.
    design : settings.
    seeds : seeds of every setting.
    measures : names of measures.
    overrides : keys set in all runs, as `ryusa run --set` takes them.
    pages : whether each run gets its page.
    heights : quantities over height that are wanted at one height, of these measures.

    Raises
    ------
    CaseError : the faults of all settings together, a measure that a case cannot give, two settings alike.
    """
    given = dict(overrides or {})
    _refuse_seeds(seeds)
    entries = measures_of(measures)
    case_run(case)  # the file is there
    for key in design.keys:
        if key in given:
            raise CaseError(f"over {key}", None, "is set to one value as well; leave out one of the two")
    if "seed" in given:
        raise CaseError("set seed", given["seed"], "is given by the seeds of the sweep")
    if len(design.settings) * len(seeds) > MOST:
        raise CaseError(
            "seeds", len(seeds), f"give {len(design.settings) * len(seeds):,} runs; at most {MOST:,}"
        )
    runs = runs_of(case, given, design.settings, seeds, page=pages)
    part = SweepPart(runs, entries, tuple(heights))
    first = runs[:: len(seeds)]
    _refuse_faults(part, design, runs)
    plain = [resolved(one.read()) for one in first]
    _refuse_alike(design, plain)
    columns = tuple(column_of(key, [one[key] for one in design.settings], plain) for key in design.keys)
    explained, warnings = _explained(first)
    return SweepPlan(case, given, design, tuple(seeds), part, columns, explained, warnings)


def _refuse_seeds(seeds: Sequence[int]) -> None:
    if not seeds:
        raise CaseError("seeds", 0, "must be one seed or more")
    for k, seed in enumerate(seeds):
        if not 0 <= seed < LARGEST_SEED:
            raise CaseError("seeds", seed, "a seed must be 0 or more")
        if seed in seeds[:k]:
            raise CaseError("seeds", seed, "stands there twice")


def _refuse_faults(part: SweepPart, design: SweepDesign, runs: Sequence[SweepRun]) -> None:
    """Read, check and build every case, and report the faults of all of them together."""
    from ryusa.build import build

    faults: dict[str, CaseError] = {}
    where: dict[str, list[int]] = {}
    left = MOST_PLACED
    for run in runs:
        try:
            case = run.read()
            for entry in part.measures:
                refuse_measure(entry, case)
            derived = derive(case)
            if run.seed == runs[0].seed:  # the first grains of other seeds differ by chance alone
                left -= derived.n_sphere + derived.n_fixed
                if left >= 0:
                    build(case, derived)
        except CaseError as error:
            for one in (error, *error.others):
                faults.setdefault(one.line, one)
                held = where.setdefault(one.line, [])
                if run.setting not in held:
                    held.append(run.setting)
    if faults:
        n = len(design.settings)
        found = [_placed(faults[line], design, where[line], n) for line in faults]
        raise CaseError.together(found, runs[0].case + ".toml")


def _placed(fault: CaseError, design: SweepDesign, settings: Sequence[int], n: int) -> CaseError:
    """A fault with the settings that have it; nothing is added where all have it."""
    if len(settings) == n:
        return fault
    named = "; ".join(_words(design, k) for k in settings[:_NAMED])
    more = f"; and {len(settings) - _NAMED} more" if len(settings) > _NAMED else ""
    which = "setting" if len(settings) == 1 else "settings"
    allowed = f"{fault.allowed} (in {len(settings)} {which} of {n}: {named}{more})"
    return CaseError(fault.key, fault.value, allowed, fault.nearest)


def _refuse_alike(design: SweepDesign, plain: Sequence[Mapping[str, Any]]) -> None:
    """Refuse settings that are the same case although written differently, such as 2 mm and 0.2 cm."""
    seen: dict[str, int] = {}
    for k, one in enumerate(plain):
        text = json.dumps({**one, "seed": 0}, sort_keys=True)
        if text in seen:
            raise CaseError(
                "over", None, f"settings {seen[text] + 1} and {k + 1} are the same case: "
                f"{_words(design, seen[text])}; and {_words(design, k)}",
            )  # fmt: skip
        seen[text] = k


def _words(design: SweepDesign, k: int) -> str:
    setting = design.settings[k]
    names = short_names(list(setting))
    return (
        ", ".join(f"{name} {value}" for name, value in zip(names, setting.values(), strict=True))
        or "as it is"
    )


def _explained(
    first: Sequence[SweepRun],
) -> tuple[tuple[tuple[str, tuple[str, ...]], ...], dict[str, tuple[int, ...]]]:
    """Values that differ between the settings, and warnings."""
    tables: list[dict[str, str]] = []
    warnings: dict[str, list[int]] = {}
    for k, run in enumerate(first):
        rows = explain(run.read())
        tables.append({f"{one.section}: {one.name}": one.shown for one in rows})
        for one in rows:
            if one.flag == "warning":
                warnings.setdefault(f"{one.section}: {one.name} {one.shown}: {one.origin}", []).append(k + 1)
    names = dict.fromkeys(name for table in tables for name in table)
    rows = ((name, tuple(table.get(name, "–") for table in tables)) for name in names)
    differing = tuple((name, held) for name, held in rows if len(set(held)) > 1)
    return differing, {text: tuple(held) for text, held in warnings.items()}
