"""One row per claim of the paper, from runs to verdicts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from ryusa.figures import save
from ryusa.measure import write_csv
from ryusa.running import provenance
from ryusa.running.folder import refuse_if_not_writable
from ryusa.studies.osada2004 import (
    NAMES,
    Fault,
    Finding,
    Interval,
    Level,
    Plan,
    StudyProgress,
    TaskResults,
    Trial,
    Word,
    carry_out,
    load,
    noted,
)
from ryusa.studies.osada2004.common import Common, common
from ryusa.studies.osada2004.paper import CITATION, CLAIMS, Claim
from ryusa.study.origin import counted, json_number, missing_runs, origin, traces_of

FORMAT = 1  # of the JSON file


@dataclass(frozen=True)
class Row:
    """One claim and what became of it."""

    claim: Claim
    word: Word
    finding: Finding | None  # None where nothing could be run or judged
    experiment: str = ""
    pictures: tuple[Path, ...] = ()
    problem: str = ""  # why it could not be judged, or what is missing beside the verdict

    def plain(self, folder: Path) -> dict[str, Any]:
        """Give the row as the JSON file holds it; pictures relative to `folder`."""
        found = self.finding
        base = found.base if found is not None else ()
        return {
            "id": self.claim.id,
            "figure": self.claim.figure,
            "verdict": str(self.word),
            "condition": found.condition if found is not None else "",
            "counts": found.counts if found is not None else {},
            "statement": self.claim.says,
            "setup": self.claim.setup,
            "left_open": self.claim.free,
            "caution": self.claim.caution,
            "ours": "; ".join(f"{one.part}: {one.note or one.found}" for one in base),
            "spread": [_spread(one.found) for one in base],
            "asked": list(dict.fromkeys(one.band.says for one in base)),
            "settings": {
                **(found.settings if found is not None else {}),
                **(base[0].choices if base else {}),
            },
            "decided_by": found.decided_by if found is not None else "",
            "contradiction": found.contradiction if found is not None else "",
            "also": list(found.also) if found is not None else [],
            "sweep": [_trial(one) for one in found.trials] if found is not None else [],
            "beside": [_trial(one) for one in found.beside] if found is not None else [],
            "problem": self.problem,
            "experiment": self.experiment,
            "pictures": [str(one.relative_to(folder)) for one in self.pictures],
        }


@dataclass(frozen=True)
class Ledger:
    """All rows, how they were made, and where."""

    rows: tuple[Row, ...]
    plan: Plan
    folder: Path
    common: tuple[Common, ...]  # sets of free choices, best first
    problems: Mapping[str, str]  # runs that could not be carried out or measured
    counts: Mapping[str, Any]  # runs made, runs opened, wall seconds, processes
    tables: Mapping[str, list[dict[str, object]]]  # experiment -> lines of its CSV
    stem: str = "ledger"  # of its files: another level or a part never replaces the whole
    faults: Mapping[str, str] = field(default_factory=dict[str, str])  # what went wrong after the runs
    traces: Mapping[str, str] = field(default_factory=dict[str, str])  # of errors in the program, for the log

    @property
    def log(self) -> str:
        """Name of the file that holds the tracebacks; empty where there are none."""
        return f"{self.stem}-errors.log" if self.traces else ""

    def plain(self) -> dict[str, Any]:
        """Give the ledger as the JSON file holds it."""
        return {
            "format": FORMAT,
            "paper": CITATION,
            "level": str(self.plan.level),
            "indicative": self.plan.level is Level.QUICK or len(self.plan.seeds) == 1,
            "seeds": list(self.plan.seeds),
            "claims": [one.plain(self.folder) for one in self.rows],
            "common_choices": [one.plain() for one in self.common],
            "problems": dict(self.problems),
            "faults": dict(self.faults),
            "errors_in": list(self.traces),
            "log": self.log,
            "provenance": origin(self.counts),
        }


def make(
    names: Sequence[str] | None,
    plan: Plan,
    folder: Path,
    *,
    jobs: int = 1,
    again: bool = False,
    say: StudyProgress | None = None,
) -> Ledger:
    """Run what is needed, judge every claim, and write tables and pictures.

    Parameters
    ----------
    names : experiments, of `NAMES`; None takes all.
    plan : level and seeds.
    folder : runs go into `folder/runs`, each experiment's tables and pictures into `folder/<name>`.
    jobs, again, say : as in `experiments.carry_out`.

    Raises
    ------
    KeyboardInterrupt : Ctrl-C; finished runs stay and are opened next time.
    """
    chosen = NAMES if names is None else tuple(dict.fromkeys(names))
    refuse_if_not_writable(folder)
    provenance.commit()  # read now: code that changes meanwhile is not what is running
    campaign = carry_out(chosen, plan, folder / "runs", jobs=jobs, again=again, say=say)
    rows: dict[str, Row] = {}
    tables: dict[str, list[dict[str, object]]] = {}
    faults: dict[str, Fault] = {}
    for name in chosen:
        rows |= _judged(name, campaign, plan, folder, tables, faults)
    ordered = tuple(rows[one] for one in CLAIMS if one in rows)
    counts = counted(campaign, jobs)
    findings = [(one.experiment, one.finding) for one in ordered if one.finding is not None]
    level = "" if plan.level is Level.STANDARD else f"-{plan.level}"
    stem = f"ledger{level}{'' if names is None else '-part'}"
    traces = traces_of(campaign, faults)
    said = {what: one.words for what, one in faults.items()}
    sets = common(findings)
    return Ledger(ordered, plan, folder, sets, campaign.problems, counts, tables, stem, said, traces)


def _judged(
    name: str,
    campaign: TaskResults,
    plan: Plan,
    folder: Path,
    tables: dict[str, list[dict[str, object]]],
    faults: dict[str, Fault],
) -> dict[str, Row]:
    """Rows of one experiment; its tables and pictures are written on the way.

    Where a run of it failed, or judging it ends in an error, nothing of it is judged: its rows say why, and
    the other experiments stand. Without its table or pictures it keeps its verdict, and its rows say so.
    """
    experiment, found = load(name), campaign.found[name]
    missing = campaign.missing.get(name, {})
    if missing:
        problem = missing_runs(missing, len(found) + len(missing))
        return _unjudged(name, problem)
    judging, table, drawing = f"{name}: judging", f"{name}: its table", f"{name}: its pictures"
    tables[name] = []
    with noted(faults, table):
        tables[name] = experiment.rows(found, plan)
    home = folder / name
    with noted(faults, table, passing=(OSError,)):
        write_csv(home / f"{name}.csv", tables[name])
    figures: Mapping[str, Figure] = {}
    with noted(faults, drawing):
        figures = experiment.draw(found, plan)
    pictures: list[Path] = []
    with noted(faults, drawing, passing=(OSError,)):
        for picture, figure in figures.items():
            save(figure, home / f"{picture}.svg")
            pictures.append(save(figure, home / f"{picture}.png"))
    shared = _share_out(pictures, experiment.CLAIMS)
    said = [
        f"{what.removeprefix(f'{name}: ')} could not be made: {faults[what].words}"
        for what in (table, drawing)
        if what in faults
    ]
    rows: dict[str, Row] = {}
    with noted(faults, judging):
        findings = {one.claim: one for one in experiment.judge(found, plan)}
        if set(findings) != set(experiment.CLAIMS):
            raise ValueError(f"{name} judged {', '.join(findings)}, not {', '.join(experiment.CLAIMS)}")
        for one, finding in findings.items():
            row = Row(CLAIMS[one], finding.word, finding, name, shared[one], "; ".join(said))
            row.plain(folder)  # an error in a condition or a count shows here, and not while writing
            rows[one] = row
    if judging in faults:
        return _unjudged(name, f"it could not be judged: {faults[judging].words}", shared)
    return rows


def _unjudged(
    name: str, problem: str, pictures: Mapping[str, tuple[Path, ...]] | None = None
) -> dict[str, Row]:
    shown = pictures or {}
    return {
        one: Row(CLAIMS[one], Word.UNDECIDED, None, name, shown.get(one, ()), problem)
        for one in load(name).CLAIMS
    }


def _share_out(pictures: Sequence[Path], claims: Sequence[str]) -> dict[str, tuple[Path, ...]]:
    """Give each picture to the claim that its name begins with, else to the first claim."""
    shared: dict[str, list[Path]] = {one: [] for one in claims}
    for picture in pictures:
        fits = [one for one in claims if picture.stem == one or picture.stem.startswith(f"{one}-")]
        shared[max(fits, key=len, default=claims[0])].append(picture)
    return {one: tuple(found) for one, found in shared.items()}


def _spread(found: Interval) -> dict[str, Any]:
    return {
        **{name: json_number(getattr(found, name)) for name in ("value", "low", "high")},
        "unit": found.unit, "n": found.n, "how": found.how,
    }  # fmt: skip


def _trial(one: Trial) -> dict[str, Any]:
    held = {True: "holds", False: "fails", None: "undecided"}[one.holds]
    low, high = json_number(one.band.low), json_number(one.band.high)
    asked = {"low": low, "high": high, "unit": one.band.unit, "says": one.band.says}
    return {
        "part": one.part, "choices": dict(one.choices), **_spread(one.found), "asked": asked, "outcome": held,
        "note": one.note,
    }  # fmt: skip
