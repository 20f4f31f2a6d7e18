"""`ryusa sweep` on a real Slurm of one node, which `slurm_here.sh` starts where Slurm is installed."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ryusa.results import Results

sys.path.insert(0, str(Path(__file__).parent))
from sweeping import (
    OUT,
    continued,
    finish,
    harmed,
    new_place,
    start,
    states,
    table,
    under_way,
    wait_until,
    words,
)  # fmt: skip

PAGE = (Path(__file__).parents[3] / "docs" / "many-runs.md").read_text(encoding="utf-8")
(SCRIPT,) = re.findall(r"```bash\n(.*?)```", PAGE, flags=re.DOTALL)
HERE = Path(__file__).with_name("slurm_here.sh")
MISSING = [one for one in ("sbatch", "slurmctld", "slurmd", "munged") if shutil.which(one) is None]
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        bool(MISSING),
        reason=f"Slurm is not installed, there is no {', '.join(MISSING)}: apt install slurm-wlm munge",
    ),
    pytest.mark.skipif(getattr(os, "geteuid", int)() != 0, reason="only root can start slurmd"),
]


@pytest.fixture(scope="module")
def slurm(tmp_path_factory):
    folder = tmp_path_factory.mktemp("slurm")
    subprocess.run(["bash", HERE, "start", folder], check=True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SLURM_CONF", str(folder / "slurm.conf"))
        yield
        subprocess.run(["bash", HERE, "stop", folder], check=True)


@pytest.fixture(scope="module")
def by_processes(tmp_path_factory):
    """The sweep as one process of this machine makes it."""
    place = new_place(tmp_path_factory.mktemp("processes"))
    code, said = finish(start(place, "-j", "1", "-q"))
    assert code == 0, said
    return place


def asked(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def jobs():
    """Jobs that run, by their name in Slurm."""
    return asked("squeue", "--noheader", "--states=RUNNING", "--format=%i").split()


def assert_the_same(place, other):
    """All runs ended in the same grains, bit for bit, and gave the same table, byte for byte."""
    runs = sorted(one.name for one in (place / OUT / "runs").glob("slope*"))
    assert len(runs) == 4
    for run in runs:
        one, two = (Results.open(folder / OUT / "runs" / run).frames for folder in (place, other))
        for name in ("x", "v", "omega"):
            assert np.array_equal(getattr(one, name)[-1], getattr(two, name)[-1])
    assert table(place) == table(other)


def test_a_job_array_gives_the_same_bits_though_requeued_and_at_its_time_limit(slurm, by_processes, tmp_path):
    place = new_place(tmp_path)
    code, said = finish(start(place, "--emit", "slurm"))
    assert code == 0, said
    submit = re.search(r"To submit:\n(.*)", said, re.DOTALL)
    assert submit is not None
    subprocess.run(["bash", "-c", submit.group(1)], cwd=place, check=True)
    wait_until(lambda: len(under_way(place)) == 2)
    preempted, late = jobs()[:2]
    asked("scontrol", "requeue", preempted)  # as preemption does
    # as before the time limit; scancel waits for the job, and its exit code says that this was requeued
    subprocess.run(["scancel", "--batch", "--signal=USR1", late], check=False)
    wait_until((place / OUT / "sweep.csv").is_file)
    wait_until(lambda: not jobs())
    assert states(place) == ["complete"] * 4
    assert continued(place) == 2
    assert_the_same(place, by_processes)
    assert not harmed(tmp_path)


def test_workers_in_one_job_give_the_same_bits_though_the_job_is_ended(slurm, by_processes, tmp_path):
    pytest.importorskip("distributed")
    place = new_place(tmp_path)
    (place / "dask.sh").write_text(SCRIPT.replace("--ntasks=64", "--ntasks=2"))
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"

    def submit():
        command = ["sbatch", "--parsable", f"--export=ALL,PATH={path}", "dask.sh"]
        ryusa = [sys.executable, "-c", "from ryusa.cli import main; main()", *words(OUT)]
        return subprocess.run([*command, *ryusa], cwd=place, check=True, capture_output=True, text=True)

    first = submit().stdout.strip()
    wait_until(lambda: len(under_way(place)) == 2)
    assert [one.stat().st_mode & 0o777 for one in place.glob(".keys-*")] == [0o700]
    asked("scancel", "--full", "--signal=TERM", first)  # as at its time limit
    wait_until(lambda: not jobs())
    submit()
    wait_until((place / OUT / "sweep.csv").is_file)
    wait_until(lambda: not jobs())
    assert states(place) == ["complete"] * 4
    assert continued(place) >= 1
    assert_the_same(place, by_processes)
    assert not list(place.glob(".keys-*"))
    assert not harmed(tmp_path)
