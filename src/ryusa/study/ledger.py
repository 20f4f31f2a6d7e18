"""The ledger of a study: carry out its tasks, judge every part, keep the findings."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from ryusa.errors import RyusaError
from ryusa.figures.comparison import compared
from ryusa.figures.style import save_both
from ryusa.measure import write_csv
from ryusa.running.folder import refuse_if_not_writable
from ryusa.study.entry import LedgerEntry, plain_entry
from ryusa.study.executors import Processes, RunExecutor
from ryusa.study.fault import Fault, noted
from ryusa.study.judge import Finding, Outcome
from ryusa.study.means import means, rows_of
from ryusa.study.origin import counted, missing_runs, origin, traces_of
from ryusa.study.plan import Level, Plan
from ryusa.study.progress import StudyProgress
from ryusa.study.runs import TaskResults, carry_out
from ryusa.study.study import Study
from ryusa.study.task import Task
from ryusa.study.verdicts import against
from ryusa.version import commit

FORMAT = 3  # of the JSON file


@dataclass(frozen=True)
class Ledger:
    """The findings of a study, with their plan and provenance.

    Attributes
    ----------
    entries : one per claim or comparison.
    problems : runs that could not be carried out or measured, with the reason.
    counts : runs made, runs opened, wall time [s], processes.
    tables : lines of the CSV table, by part.
    stem : stem of its file names; other levels and single parts have their own and never replace the whole.
    faults : errors after the runs.
    traces : tracebacks of errors in the program, for the log.
    earlier : ledger of the same study to compare the verdicts with.
    seeds : of the parts that were given more than the plan has, by part.
    too_long : parts that were given no more, since their runs would take longer than allowed [s], by part.
    whole : of all parts of the study, not of those alone that were named.
    """

    study: Study
    entries: tuple[LedgerEntry, ...]
    plan: Plan
    folder: Path
    problems: Mapping[str, str]
    counts: Mapping[str, Any]
    tables: Mapping[str, list[dict[str, object]]]
    stem: str = "ledger"
    faults: Mapping[str, str] = field(default_factory=dict[str, str])
    traces: Mapping[str, str] = field(default_factory=dict[str, str])
    earlier: Mapping[str, Any] | None = None
    seeds: Mapping[str, tuple[int, ...]] = field(default_factory=dict[str, tuple[int, ...]])
    too_long: Mapping[str, float] = field(default_factory=dict[str, float])
    whole: bool = True

    @property
    def log(self) -> str:
        """Name of the file with the tracebacks; empty if there are none."""
        return f"{self.stem}-errors.log" if self.traces else ""

    def plain(self) -> dict[str, Any]:
        """Return the ledger as written to the JSON file."""
        findings = [one.finding for one in self.entries if one.finding is not None]
        plain = {
            "format": FORMAT,
            "study": self.study.name,
            "level": str(self.plan.level),
            "indicative": self.plan.level is Level.QUICK or len(self.plan.seeds) == 1,
            "seeds": list(self.plan.seeds),
            "more_seeds": {name: list(own) for name, own in self.seeds.items()},
            "too_long_minutes": {name: round(seconds / 60.0) for name, seconds in self.too_long.items()},
            **self.study.head(findings),
            "findings": [plain_entry(self.study, one, self.folder) for one in self.entries],
            "problems": dict(self.problems),
            "faults": dict(self.faults),
            "errors_in": list(self.traces),
            "log": self.log,
            "provenance": origin(self.counts),
        }
        return plain if self.earlier is None else {**plain, "against": against(self.earlier, plain)}


def make(
    study: Study,
    names: Sequence[str] | None,
    plan: Plan,
    folder: Path,
    *,
    where: RunExecutor | None = None,
    again: bool = False,
    progress: StudyProgress | None = None,
    most_seeds: int = 0,
    longest: float = math.inf,
) -> Ledger:
    """Carry out the tasks, judge every part, and write tables and pictures.

    Parameters
    ----------
    study : the study.
    names : names of its parts; None for all.
    plan : level and seeds.
    folder : runs go into `folder/runs`, tables and pictures of each part into `folder/<part>`.
    where : where runs are carried out, one at a time in this process if not given; no number depends on it.
    again, progress : as in `carry_out`.
    most_seeds : while an interval over seeds leaves a finding undecided as shipped, its part gets as many
        seeds again, as long as that makes no more than these.
    longest : time that the runs of a part may take with the seeds it is given, by rule of thumb [core s].

    Raises
    ------
    KeyboardInterrupt : Ctrl-C; finished runs are kept and opened by the next call.
    RyusaError : a case cannot be run; or the only part requested cannot list its tasks.
    """
    chosen = study.parts if names is None else tuple(dict.fromkeys(names))
    refuse_if_not_writable(folder)
    commit()  # read now: later changes of the files are not part of the running code
    faults: dict[str, Fault] = {}
    where = where or Processes(1)
    tables: dict[str, list[dict[str, object]]] = {}
    entries: dict[str, LedgerEntry] = {}
    results, own, left = TaskResults({}), plan, list(chosen)
    seeds: dict[str, tuple[int, ...]] = {}
    too_long: dict[str, float] = {}
    while left:
        tasks: dict[str, Sequence[Task]] = {name: () for name in left}
        for name in left:
            done = results.found.get(name, {})
            with noted(faults, _naming(name), passing=(RyusaError,) if len(chosen) == 1 else ()):
                wanted = study.part(name).tasks(own)
                if own is not plan and (seconds := sum(one.cost_by_rule() for one in wanted)) > longest:
                    too_long[name] = seconds
                tasks[name] = [one for one in wanted if one not in done]
        left = [name for name in left if name not in too_long]
        tasks = {name: tasks[name] for name in left}
        results.add(
            carry_out(tasks, study.part, folder / "runs", again=again, progress=progress, where=where)
        )
        for name in left:
            for one in _judged(study, name, results, own, folder, tables, faults):
                entries[one.id] = one
        if own is not plan:
            seeds |= dict.fromkeys(left, own.seeds)
        left = _undecided(entries.values(), left) if 0 < 2 * len(own.seeds) <= most_seeds else []
        own = own.doubled() if left else own
    level = "" if plan.level is study.level else f"-{plan.level}"
    return Ledger(
        study, tuple(entries[one] for one in study.order(list(entries))), plan, folder, results.problems,
        counted(results, where.jobs), tables, f"{study.stem}{level}{'' if names is None else '-part'}",
        {what: one.words for what, one in faults.items()}, traces_of(results, faults), seeds=seeds,
        too_long=too_long, whole=names is None,
    )  # fmt: skip


def _undecided(entries: Iterable[LedgerEntry], names: Sequence[str]) -> list[str]:
    """Parts of which an interval over seeds leaves a finding undecided as shipped."""
    open_ = {
        one.part for one in entries
        if one.finding is not None and one.finding.base_outcome is Outcome.UNDECIDED
        and any(trial.found.n > 1 for trial in one.finding.base)
    }  # fmt: skip
    return [name for name in names if name in open_]


def _naming(name: str) -> str:
    return f"{name}: its tasks"


def _judged(
    study: Study,
    name: str,
    results: TaskResults,
    plan: Plan,
    folder: Path,
    tables: dict[str, list[dict[str, object]]],
    faults: dict[str, Fault],
) -> list[LedgerEntry]:
    """Entries of one part; its table and pictures are written too.

    If one of its runs failed, or its judgement raises an error, the part is not judged and its entries give
    the reason; other parts are not affected. If only its table or pictures fail, it keeps its verdict, and
    its entries mention the error.
    """
    if _naming(name) in faults:
        return _unjudged(study, name, f"its tasks could not be named: {faults[_naming(name)].words}")
    part, found = study.part(name), results.found[name]
    missing = results.missing.get(name, {})
    if missing:
        return _unjudged(study, name, missing_runs(missing, len(found) + len(missing)))
    pictures = _drawn(part, name, found, plan, folder, tables, faults)
    judging = f"{name}: judging"
    entries: list[LedgerEntry] = []
    with noted(faults, judging):
        for finding in _findings(study, name, found, plan):
            one = LedgerEntry(study.entry_id(name, finding), name, finding)
            plain_entry(study, one, folder)  # an error in a condition is raised here, not while writing
            entries.append(one)
    if judging in faults:
        entries = _unjudged(study, name, f"it could not be judged: {faults[judging].words}")
    shared = share_out(pictures, [one.id for one in entries])
    whole: list[LedgerEntry] = []
    for one in entries:
        shown = (*_charted(one, folder / name, faults), *shared[one.id])
        said = [
            f"{what.removeprefix(f'{name}: ')} could not be made: {faults[what].words}"
            for what in (f"{name}: its table", f"{name}: its pictures", f"{name}: chart of {one.id}")
            if what in faults
        ]
        problem = "; ".join([one.problem, *said] if one.problem else said)
        whole.append(LedgerEntry(one.id, name, one.finding, shown, problem))
    return whole


def _findings(study: Study, name: str, found: Mapping[Any, Any], plan: Plan) -> list[Finding]:
    """Findings of the part, or the means of its measurements if it does not judge."""
    part: Any = study.part(name)
    if getattr(part, "judge", None) is None:
        return means(found, part.TITLE)
    findings: list[Finding] = list(part.judge(found, plan))
    claims = study.claims(name)
    ids = [one.id for one in findings]
    if claims and set(ids) != set(claims):
        raise ValueError(f"{name} judged {', '.join(ids)}, not {', '.join(claims)}")
    if study.registration is not None:
        for one in findings:
            study.registration.check(one, study.entry_id(name, one))
    return findings


def _drawn(
    part: Any,
    name: str,
    found: Mapping[Any, Any],
    plan: Plan,
    folder: Path,
    tables: dict[str, list[dict[str, object]]],
    faults: dict[str, Fault],
) -> list[Path]:
    """Write the table of a part and draw its pictures; a write error ends the study."""
    table, drawing = f"{name}: its table", f"{name}: its pictures"
    rows: list[dict[str, object]] = []
    with noted(faults, table):
        if hasattr(part, "rows"):
            rows = part.rows(found, plan)
        elif not hasattr(part, "judge"):
            rows = rows_of(found)
    tables[name] = rows
    if rows:
        with noted(faults, table, passing=(OSError,)):
            write_csv(folder / name / f"{name}.csv", rows)
    figures: Mapping[str, Figure] = {}
    with noted(faults, drawing):
        if hasattr(part, "draw"):
            figures = part.draw(found, plan)
    pictures: list[Path] = []
    with noted(faults, drawing, passing=(OSError,)):
        for picture, figure in figures.items():
            pictures.append(save_both(figure, folder / name / picture))
    return pictures


def _charted(one: LedgerEntry, folder: Path, faults: dict[str, Fault]) -> tuple[Path, ...]:
    """Draw the curves of a finding with those of its reference."""
    if one.finding is None or one.finding.chart is None:
        return ()
    chart = one.finding.chart
    drawn: tuple[Path, ...] = ()
    with noted(faults, f"{one.part}: chart of {one.id}", passing=(OSError,)):
        figure = compared(chart.x, chart.y, chart.ours, chart.references, chart.beside)
        drawn = (save_both(figure, folder / one.finding.id),)
    return drawn


def _unjudged(study: Study, name: str, problem: str) -> list[LedgerEntry]:
    ids = study.claims(name) or (study.entry_id(name, None),)
    return [LedgerEntry(one, name, None, problem=problem) for one in ids]


def share_out(pictures: Sequence[Path], entries: Sequence[str]) -> dict[str, tuple[Path, ...]]:
    """Assign each picture to the entry whose id begins its name, else to the first entry."""
    shared: dict[str, list[Path]] = {one: [] for one in entries}
    for picture in pictures:
        fits = [one for one in entries if picture.stem == one or picture.stem.startswith(f"{one}-")]
        if entries:
            shared[max(fits, key=len, default=entries[0])].append(picture)
    return {one: tuple(found) for one, found in shared.items()}
