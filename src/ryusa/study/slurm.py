"""Jobs of Slurm as an executor: a dask scheduler in this process, a worker in each job (`ryusa[cluster]`)."""

import math
import shlex
import shutil
import socket
import subprocess
import tempfile
import time
import warnings
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any

from ryusa.errors import CaseError
from ryusa.study import remote
from ryusa.study.cluster import ANSWER, DaskPool, Workers, close, need_dask
from ryusa.study.cost import LATE, SHORTEST, memory_of
from ryusa.study.remote import ClusterLost
from ryusa.study.task import Task

_LOOPBACK = "127.0.0.1"
_JOBS_EVERY = 10.0  # s between two looks at the jobs
_NO_PAGES = "http.routes"  # pages of dask in plain HTTP, which anybody on the machine could read


class SlurmJobs(Workers):
    """Jobs of Slurm with one core each, submitted and ended by this process, in which their scheduler runs.

    Connections are encrypted and need keys that are made for the sweep, in a folder that its owner alone can
    read. Partition, account and what else a site asks for come from the variables of `sbatch`
    (SBATCH_PARTITION ..) or from dask's own `jobqueue.yaml`.

    Parameters
    ----------
    listen : interface or address on which the scheduler listens; the loopback if "", which serves workers on
        this machine alone.
    jobs : number of jobs at a time.

    Raises
    ------
    CaseError : `jobs` is missing; dask or Slurm are not installed; there is no such interface or address.
    """

    def __init__(self, listen: str = "", jobs: int | None = None) -> None:
        name = f"slurm:{listen}" if listen else "slurm"
        need_dask(name)
        if shutil.which("sbatch") is None:
            raise CaseError("on", name, "needs Slurm: there is no command sbatch")
        if jobs is None:
            raise CaseError(
                "jobs", None, f"must be given with --on {name}: the number of jobs, of one core each"
            )
        self._listen = _listening(listen, name)
        self._logs = Path()
        self._seen: set[str] = set()  # names of workers that have come
        self._looked = 0.0
        super().__init__(jobs)

    def _connect(self, folder: Path, tasks: Sequence[Task]) -> tuple[Any, Any]:
        from distributed import Client

        keys = Path(tempfile.mkdtemp(prefix=".keys-", dir=folder))  # mode 0700
        self._logs = folder.parent / "slurm"
        self._logs.mkdir(exist_ok=True)
        self._seen.clear()
        cluster = None
        try:
            cluster = _slurm_cluster(keys, self._logs, self._listen, self.jobs, tasks)
            _refused_by_slurm(cluster.job_script())
            client = Client(cluster, timeout=ANSWER, set_as_default=False)
            cluster.scale(jobs=self.jobs)
        except BaseException:
            close(None, cluster, keys)
            raise
        return client, _ClusterWithKeys(cluster, keys)

    def look(self, pool: Executor) -> None:
        """Replace jobs that have ended.

        Raises
        ------
        ClusterLost : a job has ended before its worker came.
        """
        assert isinstance(pool, DaskPool)
        cluster = pool.cluster.cluster
        self._seen.update(str(one["name"]) for one in cluster.scheduler_info["workers"].values())
        if time.monotonic() - self._looked < _JOBS_EVERY:
            return
        self._looked = time.monotonic()
        ids = {name: str(one.job_id) for name, one in dict(cluster.workers).items() if one.job_id}
        there = _jobs_there(list(ids.values()))
        gone = [name for name, job in ids.items() if job not in there]
        for name in gone:
            if str(name) not in self._seen:
                log = self._logs / f"{ids[name]}.log"
                raise ClusterLost(f"job {ids[name]} of Slurm has ended before its worker came; see {log}")
            cluster.workers.pop(name, None)
        if gone:
            cluster.scale(jobs=self.jobs)


class _ClusterWithKeys:
    """A cluster of dask and the folder of its keys, which ends with it."""

    def __init__(self, cluster: Any, keys: Path) -> None:
        self.cluster, self._keys = cluster, keys

    def close(self) -> None:
        """End all jobs and remove the keys."""
        close(None, self.cluster, self._keys)


def _listening(listen: str, name: str) -> dict[str, str]:
    """Options of dask's scheduler for an interface or an address."""
    if not listen:
        return {"host": _LOOPBACK}
    interfaces = [one for _, one in socket.if_nameindex()]
    if listen in interfaces:
        return {"interface": listen}
    try:
        socket.getaddrinfo(listen, None)
    except OSError:
        allowed = (
            f"{listen} must be an interface, one of {', '.join(interfaces)}, or an address of this machine"
        )
        raise CaseError("on", name, allowed) from None
    return {"host": listen}


def _slurm_cluster(
    keys: Path, logs: Path, listen: Mapping[str, str], jobs: int, tasks: Sequence[Task]
) -> Any:
    """A scheduler of dask in this process, which submits workers as jobs of Slurm."""
    from dask import config
    from dask_jobqueue.slurm import SLURMCluster

    costs = [one.cost_by_rule() for one in tasks]  # the nodes are other machines
    seconds = max(max(costs, default=0.0), sum(costs) / jobs)
    minutes = max(SHORTEST, math.ceil(LATE * seconds / 60.0))
    memory = memory_of(tasks)
    secured = _keys_of_dask(keys)
    silenced = {f"distributed.{one}.{_NO_PAGES}": list[str]() for one in ("scheduler", "worker")}
    exports = [
        f"export DASK_{key.upper().replace('.', '__').replace('-', '_')}={shlex.quote(value)}"
        for key, value in {**secured, **dict.fromkeys(silenced, "[]")}.items()
    ]
    log = f'exec >> {shlex.quote(str(logs.resolve()))}/"$SLURM_JOB_ID".log 2>&1'
    jobqueue = config.get("jobqueue.slurm", {})
    prologue = [*(jobqueue.get("job-script-prologue") or ()), log, *exports]
    directives = [*(jobqueue.get("job-extra-directives") or ()), "--output=/dev/null"]
    near = ["--host", _LOOPBACK] if listen.get("host") == _LOOPBACK else []
    with config.set({**secured, **silenced}), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of ports and dashboards
        return SLURMCluster(
            cores=1, processes=1, memory=f"{memory}B", walltime=f"{minutes // 60}:{minutes % 60:02d}:00",
            nanny=False, job_name="ryusa-worker", python=shlex.quote(remote.PYTHON), protocol="tls://",
            job_extra_directives=directives, job_script_prologue=prologue,
            scheduler_options={**listen, "dashboard": False, "dashboard_address": f"{_LOOPBACK}:0"},
            worker_extra_args=["--no-dashboard", "--dashboard-address", f"{_LOOPBACK}:0", *near],
        )  # fmt: skip


def _keys_of_dask(folder: Path) -> dict[str, str]:
    """Write keys and a certificate for this sweep; return the settings of dask that name them."""
    from distributed.security import Security

    made: Any = Security.temporary()
    written = {"cert": str(made.tls_scheduler_cert), "key": str(made.tls_scheduler_key)}
    paths: dict[str, str] = {}
    for name, text in written.items():
        path = folder / f"{name}.pem"
        path.touch(mode=0o600)
        path.write_text(text, encoding="ascii")
        paths[name] = str(path.resolve())
    roles = {
        f"distributed.comm.tls.{role}.{name}": path
        for role in ("scheduler", "worker", "client")
        for name, path in paths.items()
    }
    return {
        "distributed.comm.tls.ca-file": paths["cert"],
        **roles,
        "distributed.comm.require-encryption": "true",
    }


def _refused_by_slurm(script: str) -> None:
    """Ask Slurm whether it would take the job."""
    with tempfile.NamedTemporaryFile("w", suffix=".sh") as file:
        file.write(script)
        file.flush()
        done = subprocess.run(
            ["sbatch", "--test-only", file.name], capture_output=True, text=True, check=False
        )
    if done.returncode:
        raise CaseError("on", "slurm", f"Slurm does not take the jobs: {' '.join(done.stderr.split())}")


def _jobs_there(jobs: Sequence[str]) -> set[str]:
    """Those of some jobs that wait or run; all of them if Slurm does not answer."""
    command = ["squeue", "--noheader", "--format=%A", f"--jobs={','.join(jobs)}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        return set() if "Invalid job id" in done.stderr else set(jobs)
    return set(done.stdout.split())
