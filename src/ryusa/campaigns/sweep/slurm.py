"""A sweep as a job array of Slurm: two scripts in its folder, which need nothing but ryusa itself."""

import math
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from ryusa.campaigns.sweep.folder import RUNS, keep_plan, refuse_folder
from ryusa.campaigns.sweep.part import SweepRun
from ryusa.campaigns.sweep.plan import SweepPlan
from ryusa.running.disk import write_atomically
from ryusa.study.cost import LATE, SHORTEST, estimate_cost, memory_of, refuse_if_too_big

SCRIPTS = "slurm"
ARRAY, COLLECT = "array.sh", "collect.sh"
MOST = 1000  # elements of an array: MaxArraySize, of a site that says nothing 1001, is above every index
WARNING = 180  # s before the time limit at which a run is asked to end with a checkpoint

_HEAD = """#!/bin/bash
#SBATCH --job-name=ryusa-sweep
#SBATCH --cpus-per-task=1
#SBATCH --mem={memory}M
#SBATCH --time={minutes}
#SBATCH --output=ryusa-%A.out
#SBATCH --open-mode=append
"""
_ARRAY = """#SBATCH --array=0-{last}
#SBATCH --requeue
#SBATCH --signal=B:USR1@{warning}
# One run of a sweep for each element, on one core. Preempted or at its time limit, a run ends with a
# checkpoint; its element is put back into the queue, and goes on there bit for bit.
cd -- {place} || exit 1
mkdir -p -- {logs} || exit 1
number=$((SLURM_ARRAY_TASK_ID + ${{RYUSA_FIRST:-0}}))
exec >> {logs}/"$number".log 2>&1
export NUMBA_NUM_THREADS=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
case "$number" in
{cases}
*) echo "no run has this number"; exit 1 ;;
esac
again=
trap 'again=yes; kill -TERM "$run" 2>/dev/null' USR1
trap 'kill -TERM "$run" 2>/dev/null' TERM
{python} -m ryusa run {case} --resume --overwrite --quiet "$@" &
run=$!
wait "$run"; code=$?
while kill -0 "$run" 2>/dev/null; do wait "$run"; code=$?; done
if [ -n "$again" ] && {{ [ "$code" -eq {stopped} ] || [ "$code" -gt 128 ]; }}; then
    exec scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
"""
_COLLECT = """# Opens the finished runs, goes on with others, and writes table and page.
cd -- {place} || exit 1
mkdir -p -- {logs} || exit 1
exec >> {logs}/collect.log 2>&1
exec {command} -j 1
"""
_STOPPED = 5  # exit code of `ryusa run` that was asked to end


def emit_slurm(plan: SweepPlan, folder: Path, words: Sequence[str]) -> tuple[tuple[Path, ...], int]:
    """Write the scripts of a job array for the runs that are not finished, and of the job that collects them.

    Parameters
    ----------
    plan : the sweep, checked.
    folder : its folder.
    words : arguments of `ryusa` that make the same sweep; of them every word may hold any character.

    Returns
    -------
    scripts : the array and the collecting job; the latter alone if all runs are finished.
    n : number of elements of the array.

    Raises
    ------
    ResultsError : the folder holds another sweep or runs of another case.
    CaseError : the runs do not fit on the disk.
    OSError : a script cannot be written.
    """
    refuse_folder(plan, folder)
    ahead = estimate_cost(plan.runs, folder / RUNS, jobs=1)
    refuse_if_too_big(ahead, folder)
    keep_plan(plan, folder)
    runs = [one for one in plan.runs if one in ahead.costs]
    longest = max((one.cost_by_rule() for one in runs), default=0.0)  # nodes are other machines
    about = {
        "place": shlex.quote(str(Path.cwd())),
        "logs": shlex.quote(str(folder / SCRIPTS)),
        "python": shlex.quote(sys.executable),
    }
    minutes = max(SHORTEST, math.ceil(LATE * longest / 60.0))
    head = {"minutes": minutes, "memory": math.ceil(memory_of(plan.first_runs) / 1.0e6)}
    scripts: list[Path] = []
    if runs:
        cases = "\n".join(_case(k, one, folder) for k, one in enumerate(runs))
        text = (_HEAD + _ARRAY).format(
            **about, **head, last=min(len(runs), MOST) - 1, warning=WARNING, cases=cases, stopped=_STOPPED,
            case=shlex.quote(str(plan.case)),
        )  # fmt: skip
        scripts.append(_write(folder / SCRIPTS / ARRAY, text))
    all_minutes = max(SHORTEST, math.ceil(LATE * sum(one.page_cost for one in plan.runs) / 60.0))
    command = shlex.join([sys.executable, "-m", "ryusa", *words, "-o", str(folder)])
    text = (_HEAD + _COLLECT).format(**about, **{**head, "minutes": all_minutes}, command=command)
    scripts.append(_write(folder / SCRIPTS / COLLECT, text))
    return tuple(scripts), len(runs)


def submission(scripts: Sequence[Path], n: int = 0) -> list[str]:
    """Lines of a shell that submit the scripts, for `n` runs.

    >>> submission([Path("out/slurm/collect.sh")])
    ['sbatch out/slurm/collect.sh']
    """
    *array, collect = (shlex.quote(str(one)) for one in scripts)
    if not array:
        return [f"sbatch {collect}"]
    more = [
        f'job="$job":$(sbatch --parsable --export=ALL,RYUSA_FIRST={first} '
        f"--array=0-{min(n - first, MOST) - 1} {array[0]})"
        for first in range(MOST, n, MOST)
    ]
    return [f"job=$(sbatch --parsable {array[0]})", *more, f'sbatch --dependency=afterany:"$job" {collect}']


def _case(k: int, one: SweepRun, folder: Path) -> str:
    """Branch of the script that sets the arguments of one run."""
    words = ["-o", str(folder / RUNS / one.folder)]
    words += [word for key, value in one.overrides for word in ("--set", f"{key}={value}")]
    return f"{k}) set -- {shlex.join(words)} ;;"


def _write(path: Path, text: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_atomically(path, text.encode())
    return path
