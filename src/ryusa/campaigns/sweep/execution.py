"""Carry out a sweep: its runs, its table, its pictures and its page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ryusa.campaigns.sweep.folder import RUNS, keep_plan, refuse_folder
from ryusa.campaigns.sweep.part import Measured, SweepRun, measured, problems_of
from ryusa.campaigns.sweep.pictures import Quantity, drawn_effects, quantities_of
from ryusa.campaigns.sweep.plan import SweepPlan
from ryusa.campaigns.sweep.table import UNMOVED, Cell, rows_of_sweep, unmoved_by_seeds
from ryusa.figures.style import save_both
from ryusa.formats.parquet import need_pyarrow, write_rows_as_parquet
from ryusa.measure import write_csv
from ryusa.notebook import html_table
from ryusa.results import Results
from ryusa.results.presentation import needed
from ryusa.study.cost import estimate_cost, refuse_if_too_big
from ryusa.study.executors import RunExecutor
from ryusa.study.fault import Fault, noted
from ryusa.study.origin import counted, traces_of
from ryusa.study.progress import StudyProgress
from ryusa.study.runs import carry_out
from ryusa.version import commit

if TYPE_CHECKING:
    from pandas import DataFrame

PART = "sweep"
CSV, PARQUET, PAGE, LEDGER, LOG = "sweep.csv", "sweep.parquet", "sweep.html", "sweep.json", "sweep-errors.log"
PICTURES = "pictures"
_SHOWN = 40  # lines that a notebook shows


@dataclass(frozen=True)
class Sweep:
    """A sweep that was carried out.

    Attributes
    ----------
    plan : what was run.
    folder : holds the table, the page, the pictures and the runs.
    found : what is known of each run.
    rows : lines of the table, see `to_pandas`.
    problems : runs or measures without numbers, with the reason.
    counts : runs made and opened, wall time [s], number at a time.
    traces : tracebacks of errors in the program.
    pictures : names of the pictures, by quantity.
    faults : steps after the runs that failed, with the reason.
    """

    plan: SweepPlan
    folder: Path
    found: Mapping[SweepRun, Measured]
    rows: Sequence[Mapping[str, Cell]]
    problems: Mapping[str, str]
    counts: Mapping[str, Any]
    traces: Mapping[str, str] = field(default_factory=dict[str, str])
    pictures: Mapping[str, Path] = field(default_factory=dict[str, Path])
    faults: Mapping[str, str] = field(default_factory=dict[str, str])

    @property
    def by_setting(self) -> list[list[Measured]]:
        """What is known of the runs of each setting."""
        return _by_setting(self.plan, self.found)

    @property
    def unmoved(self) -> tuple[str, str] | None:
        """Warning that seeds change nothing, and the settings where; None where they do."""
        same, n = unmoved_by_seeds(self.found)
        if not same:
            return None
        numbers = ", ".join(str(one.setting + 1) for one in same)
        return UNMOVED, "all settings" if len(same) == n else f"setting {numbers}"

    @property
    def quantities(self) -> list[Quantity]:
        """Every quantity over all settings."""
        return quantities_of(self.plan.measures, self.by_setting)

    @property
    def runs(self) -> list[Results]:
        """All runs that are complete, setting by setting, opened."""
        places = [
            self.folder / RUNS / one.folder for one in self.plan.runs if "run" not in self.found[one].problems
        ]
        return [Results.open(one) for one in places]

    def to_pandas(self) -> "DataFrame":
        """The table as a pandas DataFrame: a line for each quantity of each run, and pooled over the seeds.

        Raises
        ------
        ResultsError : pandas is not installed.
        """
        return needed("pandas").DataFrame(list(self.rows))

    def _repr_html_(self) -> str:
        pooled = [one for one in self.rows if one["over"] == ("seeds" if len(self.plan.seeds) > 1 else "run")]
        heads = ("setting", "quantity", "value", "± s.e.", "unit")
        cells = [
            (
                self.plan.setting_in_words(int(one["setting"] or 1) - 1),
                f"{one['measure']} {one['quantity']}",
                _digits(one["value"], 4), _digits(one["standard_error"], 2), str(one["unit"]),
            )
            for one in pooled[:_SHOWN]
        ]  # fmt: skip
        return html_table(heads, cells)


def _digits(value: Cell, n: int) -> str:
    return "–" if value is None else f"{value:.{n}g}"


def carry_out_sweep(
    plan: SweepPlan,
    folder: Path,
    where: RunExecutor,
    *,
    again: bool = False,
    parquet: bool = False,
    progress: StudyProgress | None = None,
) -> Sweep:
    """Carry out a sweep, and write its table, pictures and page.

    Parameters
    ----------
    plan : the sweep, checked.
    folder : its folder; finished runs in it are opened, interrupted ones go on.
    where : where runs are carried out; the results do not depend on it.
    again : make all runs anew.
    parquet : write the table as Parquet too.
    progress : receives the progress.

    Raises
    ------
    ResultsError : the folder holds another sweep or runs of another case, or pyarrow is missing.
    CaseError : the runs do not fit on the disk.
    KeyboardInterrupt : Ctrl-C or SIGTERM; what is finished is kept, and the next call goes on.
    OSError : a file cannot be written.
    """
    if parquet:
        need_pyarrow("a table as Parquet")
    refuse_folder(plan, folder, again=again)
    ahead = estimate_cost(plan.runs, folder / RUNS, jobs=where.jobs, again=again)
    refuse_if_too_big(ahead, folder)  # before anything is written
    commit()  # read now: later changes of the files are not part of the running code
    keep_plan(plan, folder)
    results = carry_out(
        {PART: plan.runs}, {PART: plan.part}.__getitem__, folder / RUNS,
        again=again, progress=progress, where=where,
    )  # fmt: skip
    found = {one: measured(one, PART, results) for one in plan.runs}
    faults: dict[str, Fault] = {}
    columns = plan.columns
    rows = rows_of_sweep(columns, plan.runs, plan.measures, found)
    write_csv(folder / CSV, rows)
    if parquet:
        write_rows_as_parquet(folder / PARQUET, rows, {one.name: one.unit for one in columns if one.unit})
    pictures: dict[str, Path] = {}
    with noted(faults, "pictures", passing=(OSError,)):
        quantities = quantities_of(plan.measures, _by_setting(plan, found))
        for name, figure in drawn_effects(plan.design, columns, quantities).items():
            pictures[name] = save_both(figure, folder / PICTURES / name)
    return Sweep(
        plan, folder, found, rows, problems_of(found), counted(results, where.jobs),
        traces_of(results, faults), pictures, {what: one.words for what, one in faults.items()},
    )  # fmt: skip


def _by_setting(plan: SweepPlan, found: Mapping[SweepRun, Measured]) -> list[list[Measured]]:
    every: list[list[Measured]] = [[] for _ in plan.design.settings]
    for one in plan.runs:
        every[one.setting].append(found[one])
    return every
