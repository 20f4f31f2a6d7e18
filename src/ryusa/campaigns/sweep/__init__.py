"""Many runs of one case over settings and seeds, with one table and one page: `ryusa sweep`."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ryusa.campaigns.sweep.definition import Over, axes_of, is_sweep_file, listed, read_sweep
from ryusa.campaigns.sweep.design import GRID, LIST, SweepDesign, design_of
from ryusa.campaigns.sweep.execution import Sweep, carry_out_sweep
from ryusa.campaigns.sweep.page import write_sweep
from ryusa.campaigns.sweep.plan import SweepPlan, plan_sweep
from ryusa.errors import CaseError
from ryusa.study import ProgressLines
from ryusa.study.executors import DEFAULT, executor_of

__all__ = [
    "Sweep",
    "SweepDesign",
    "SweepPlan",
    "carry_out_sweep",
    "plan_sweep",
    "planned",
    "seeds_of",
    "sweep",
    "write_sweep",
]

SEEDS = 3


def sweep(
    case: Path | str,
    over: Over = (),
    measure: str | Sequence[str] = (),
    *,
    design: str = GRID,
    points: int | None = None,
    design_seed: int = 1,
    seeds: int | Sequence[int] | None = None,
    overrides: Mapping[str, str] | None = None,
    folder: Path | str | None = None,
    jobs: int | None = None,
    on: str = DEFAULT,
    again: bool = False,
    pages: bool = True,
    parquet: bool = False,
    progress: bool = True,
) -> Sweep:
    """Run a case at several settings with several seeds, and return the table of its measures.

    Parameters
    ----------
    case : case file; or a TOML file with a table `[sweep]`, which holds `over` and `design`.
    over : values by key, such as `{"motion.slope": [0.01, 0.02], "grains.diameter": ["2 mm", "4 mm"]}`; for
        keys that change together several mappings in a list, each one axis; for a design "list" one mapping
        of keys to values for each setting. A sampled design takes ranges, `{"low": 0.01, "high": 0.02}`, with
        `"scale": "log"` if wished.
    measure : name of a measure, or several, as for `ryusa measure`.
    design : "grid", "list", "latin hypercube" or "sobol".
    points : number of points of a Latin hypercube or a Sobol sequence.
    design_seed : seed of those points.
    seeds : number of seeds of each setting, or the seeds; default 3.
    overrides : keys set in all runs, as `ryusa run --set` takes them.
    folder : for table, page, pictures and runs; default runs/sweep-CASE. Finished runs in it are opened, and
        interrupted ones go on.
    jobs : number of runs at a time; if not given one, or as many as dask has threads.
    on : where runs are carried out: "processes" or "dask:ADDRESS".
    again : make all runs anew.
    pages : write a page for each run.
    parquet : write the table as Parquet too; needs pyarrow.
    progress : whether to print cost and progress on stderr.

    Raises
    ------
    CaseError : a case cannot be run, or an argument is not allowed; nothing was run.
    ResultsError : the folder holds another sweep, or runs of the case as it was before.
    """
    names = (measure,) if isinstance(measure, str) else tuple(measure)
    settings = None
    if over or design != GRID or points is not None:
        axes = listed(over) if design == LIST else axes_of(over)
        settings = design_of(design, axes, points=points, seed=design_seed)
    plan = planned(Path(case), settings, seeds, names, overrides or {}, pages=pages)
    out = Path("runs") / f"sweep-{Path(case).stem}" if folder is None else Path(folder)
    made = carry_out_sweep(
        plan, out, executor_of(on, jobs), again=again, parquet=parquet,
        progress=ProgressLines() if progress else None,
    )  # fmt: skip
    write_sweep(made, "ryusa.sweep")
    return made


def planned(
    case: Path,
    design: SweepDesign | None,
    seeds: int | Sequence[int] | None,
    measures: Sequence[str],
    overrides: Mapping[str, str],
    *,
    pages: bool,
) -> SweepPlan:
    """Check a sweep of a case, or of a file with a table `[sweep]`.

    Parameters
    ----------
    case : either file.
    design : settings; None for those of the file, or of seeds alone.
    seeds, measures, overrides : go before those of the file.
    pages : as in `plan_sweep`.

    Raises
    ------
    CaseError : as `plan_sweep`, or the file has settings and so has the call.
    """
    if is_sweep_file(case):
        if design is not None:
            raise CaseError("over", None, f"stands in {case.name}, which has a table [sweep]")
        file = read_sweep(case)
        case, design, overrides = file.case, file.design, {**file.overrides, **overrides}
        measures, seeds = measures or file.measures, file.seeds if seeds is None else seeds
    settings = design_of(GRID, []) if design is None else design
    return plan_sweep(case, settings, seeds_of(seeds), measures, overrides=overrides, pages=pages)


def seeds_of(seeds: int | Sequence[int] | None) -> tuple[int, ...]:
    """Seeds from their number, or as they are.

    Raises
    ------
    CaseError : less than one.

    >>> seeds_of(2), seeds_of([7, 9])
    ((1, 2), (7, 9))
    """
    if seeds is None:
        seeds = SEEDS
    if not isinstance(seeds, int):
        return tuple(seeds)
    if seeds < 1:
        raise CaseError("seeds", seeds, "must be one seed or more")
    return tuple(range(1, seeds + 1))
