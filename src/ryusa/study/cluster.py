"""Workers of a dask scheduler as an executor (`ryusa[cluster]`).

Every run is carried out by `remote.in_process` on a worker. Nothing of a run passes through the scheduler but
its case by name and its measurements: run folders are on a disk that all see.
"""

import pickle
import secrets
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import Any, TypeVar

from ryusa.errors import CaseError
from ryusa.study import remote
from ryusa.study.executors import RunExecutor
from ryusa.study.remote import ClusterLost, Site, WorkerError
from ryusa.study.task import CaseRun, Task

Value = TypeVar("Value")

ANSWER = 20.0  # s within which a scheduler and its workers answer
_END = 3.0 * remote.PATIENCE  # s within which all runs that were asked to end have ended


class DaskWorkers(RunExecutor):
    """Workers of a scheduler that is there already.

    A run whose worker is lost goes on at another from its checkpoint.

    Parameters
    ----------
    address : of the scheduler, such as "tcp://node1:8786", "tls://node1:8786" or "node1:8786".
    jobs : number of runs at a time; all threads of its workers if not given.

    Raises
    ------
    CaseError : dask is not installed, no scheduler answers there, or it has no workers.
    """

    def __init__(self, address: str, jobs: int | None = None) -> None:
        self.address = address
        if find_spec("distributed") is None:
            raise CaseError("on", f"dask:{address}", "needs distributed: pip install 'ryusa[cluster]'")
        from distributed import KilledWorker

        self.lost = (BrokenExecutor, KilledWorker)
        with self._client() as client:
            threads = sum(client.nthreads().values())
        if not threads:
            raise CaseError(
                "on",
                f"dask:{address}",
                "the scheduler there has no workers; `dask worker ADDRESS` starts one",
            )
        self.jobs = jobs or threads

    def here(self, n: int, made: int) -> bool:
        """Workers make runs; finished ones are opened by the calling process."""
        del n
        return made == 0

    def open(self, folder: Path, tasks: Sequence[Task]) -> Executor:
        """Return an executor whose workers of now have been compared with this process.

        Raises
        ------
        WorkerError : a worker has another version, or does not see the folder.
        CaseError : no worker can be reached.
        """
        folder.mkdir(parents=True, exist_ok=True)
        probe = _written_probe(folder)
        client = None
        try:
            client = self._client()
            token = probe.read_text(encoding="utf-8")
            site = Site(str(Path.cwd()), str(probe), token, _read_by(tasks), remote.versions())
            _refuse_workers(client, site)
            return DaskPool(client, site)
        except BaseException:
            _close(client, probe)
            raise

    def stop(self, pool: Executor) -> None:
        """End all runs by SIGTERM; each closes its folder."""
        assert isinstance(pool, DaskPool)
        pool.end()

    def _client(self) -> Any:
        from distributed import Client

        if not self.address:
            raise CaseError(
                "on", "dask:", "must hold the address of a scheduler, such as dask:tcp://node1:8786"
            )
        try:
            return Client(self.address, timeout=ANSWER, set_as_default=False)
        except (OSError, ValueError, RuntimeError, TypeError) as error:
            why = " ".join(str(error).split()) or type(error).__name__
            raise CaseError(
                "on", f"dask:{self.address}", f"no scheduler of dask answers there ({why[:200]})"
            ) from None


class DaskPool(Executor):
    """Executor that hands each call to a worker of dask, where it has a process of its own.

    Parameters
    ----------
    client : a client of dask, closed with the pool.
    site : what workers must share with this process.
    """

    def __init__(self, client: Any, site: Site) -> None:
        self._client, self._probe = client, Path(site.probe)
        self._site, self._token = remote.packed_site(site), site.token
        self._executor = client.get_executor(pure=False)

    def submit(self, fn: Callable[..., Value], /, *args: Any, **kwargs: Any) -> Future[Value]:
        """Hand over a call."""
        del kwargs
        found: Future[Value] = Future()
        inner = self._executor.submit(remote.in_process, self._site, pickle.dumps((fn, args)))
        inner.add_done_callback(lambda done: _pass_on(done, found))
        return found

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for all runs, or end them; then let the workers go."""
        if not wait or cancel_futures:
            self.end()
            return
        self._executor.shutdown(wait=True)
        _close(self._client, self._probe)

    def end(self) -> None:
        """End all runs, wait until their folders are closed, and let the workers go."""
        with suppress(Exception):  # a scheduler that is gone has no runs
            self._executor.shutdown(wait=False)
            self._client.run(remote.ended, self._token, on_error="ignore", timeout=_END)
        _close(self._client, self._probe)


def _pass_on(done: "Future[bytes]", found: "Future[Any]") -> None:
    """Give the result of a call, or what it raised, to the future that stands for it."""
    if done.cancelled():
        found.set_exception(
            ClusterLost("the scheduler of dask has ended, or dropped a run. The same command continues")
        )
        return
    try:
        found.set_result(remote.unpacked(done.result()))
    except BaseException as error:
        found.set_exception(error)


def _refuse_workers(client: Any, site: Site) -> None:
    """Compare every worker that is there with this process."""
    answers: Mapping[str, Any] = client.run(remote.checked, remote.packed_site(site), on_error="return")
    for worker, answer in answers.items():
        if isinstance(answer, (ModuleNotFoundError, AttributeError)):
            raise WorkerError(f"worker {worker}: it has no ryusa, or another version ({answer})")
        if isinstance(answer, BaseException):
            raise WorkerError(
                f"worker {worker}: it cannot start a process ({type(answer).__name__}: {answer})"
            )
        remote.unpacked(answer)


def _read_by(tasks: Sequence[Task]) -> dict[str, str]:
    """Case files of the runs, with the SHA-256 of their content."""
    files = {one.cases / f"{one.case}.toml" for one in tasks if isinstance(one, CaseRun)}
    return {str(one): remote.digest_of(one) for one in sorted(files)}


def _written_probe(folder: Path) -> Path:
    """A new file in the folder of the runs that holds a token."""
    token = secrets.token_hex(8)
    path = folder / f".study-{token}"
    path.write_text(token, encoding="utf-8")
    return path.resolve()


def _close(client: Any, probe: Path) -> None:
    """Close a client, if any, and remove what was written for it."""
    if client is not None:
        with suppress(Exception):  # the other end may have gone
            client.close()
    probe.unlink(missing_ok=True)
