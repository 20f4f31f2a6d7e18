"""A call on a worker of a cluster: in a process of its own, after the worker was compared with the client.

Signals end a run with a checkpoint in the main thread of a process alone, and a worker of dask calls from
other threads; so every call has its own process, with one numerical thread. It ends by SIGTERM when its
result is no longer wanted or its worker ends, and closes its folder then.
"""

import asyncio
import hashlib
import json
import os
import pickle
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any, NoReturn

from ryusa.errors import RyusaError

PATIENCE = 5.0  # s until the process of a run that does not close its folder is killed
ONE_THREAD = {name: "1" for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
COMPARED = ("numba", "llvmlite", "numpy", "scipy", "h5py")  # packages that give the bits of a run
STOPPED = 128 + signal.SIGTERM  # exit code of a process whose run was asked to end
SHARED = "All workers must see it under the same path, on a shared disk"
_LOOK = 0.2  # s between two looks whether a result is still wanted
_COMMAND = (sys.executable, "-P", "-c", "from ryusa.study.remote import main; main()")

_under_way: dict[subprocess.Popen[bytes], str] = {}  # processes of this worker, with the token of their study


class WorkerError(RyusaError):
    """A worker that cannot carry out the runs of a study: another version, or another disk."""


class ClusterLost(RyusaError):
    """The scheduler or all workers of a cluster have ended while runs were under way."""

    exit_code = 3


@dataclass(frozen=True)
class Site:
    """What a worker must share with the client.

    Attributes
    ----------
    place : working directory of the client.
    probe : file in the folder of the runs that holds `token`.
    token : tells one study from another.
    files : files that runs read, with the SHA-256 of their content.
    versions : of Python, ryusa and the packages that give the bits of a run.
    """

    place: str
    probe: str
    token: str
    files: Mapping[str, str]
    versions: Mapping[str, str]

    def mismatch(self) -> str:
        """What this process does not share with the client, in words; "" if nothing."""
        there, here = self.versions, versions()
        differ = [
            f"{name} {here.get(name)}, here {there[name]}" for name in there if here.get(name) != there[name]
        ]
        if differ:
            return f"it has {'; '.join(differ)}. Results are the same only with the same versions"
        try:
            seen = Path(self.probe).read_text(encoding="utf-8")
        except OSError:
            return f"it does not see the folder {Path(self.probe).parent}. {SHARED}"
        if seen != self.token:
            return f"it sees another folder as {Path(self.probe).parent}. {SHARED}"
        if not os.access(Path(self.probe).parent, os.W_OK):
            return f"it cannot write to the folder {Path(self.probe).parent}"
        for name, digest in self.files.items():
            if digest_of(Path(name)) != digest:
                return f"it has no file {name}, or another one. {SHARED}"
        return ""


def versions() -> dict[str, str]:
    """Versions of this process: Python, ryusa and the packages that give the bits of a run."""
    from ryusa.study.cost import code_in_words, present

    found = {"Python": ".".join(map(str, sys.version_info[:3])), "ryusa": code_in_words(present())}
    for name in COMPARED:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "none"
    return found


def digest_of(path: Path) -> str:
    """SHA-256 of a file; "" if it cannot be read."""
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()
    except OSError:
        return ""


# ------------------------------------------------------------------------------------- the thread of a worker


def in_process(site: str, packed: bytes, wanted: Callable[[], bool] | None = None) -> bytes:
    """Carry out a call in a process of its own; called on a worker of dask.

    Parameters
    ----------
    site : `Site` as JSON.
    packed : the call and its arguments, pickled.
    wanted : says whether the result is still wanted; by default the task that dask carries out now knows.

    Returns
    -------
    answer : pickled, for `unpacked`.

    Raises
    ------
    BrokenExecutor : the process was ended from outside.
    """
    about = json.loads(site)
    if not os.path.isdir(about["place"]):  # a process cannot start there
        words = f"it does not see the folder {about['place']}, in which the command was given. {SHARED}"
        return pickle.dumps(("refused", _of_host(words)))
    wanted = wanted or _task_of_dask()
    child = subprocess.Popen(
        _COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=about["place"],
        env={**os.environ, **ONE_THREAD},
    )  # fmt: skip
    assert child.stdin is not None and child.stdout is not None
    _under_way[child] = about["token"]
    answer: list[bytes] = []
    reader = threading.Thread(target=lambda out: answer.append(out.read()), args=(child.stdout,), daemon=True)
    try:
        reader.start()
        with suppress(OSError):  # it has ended already
            child.stdin.write(site.encode() + b"\n" + packed)
            child.stdin.flush()
        while reader.is_alive():
            reader.join(_LOOK)
            if not wanted():
                _end(child)
        code = child.wait()
    finally:
        _end(child)
        with suppress(OSError):
            child.stdin.close()  # its process would end with it
        child.stdout.close()
        del _under_way[child]
    if code == 0:
        return answer[0]
    if code in (STOPPED, -signal.SIGTERM):
        _try_elsewhere()
    raise BrokenExecutor(f"the process of the run ended with code {code}")


def _task_of_dask() -> Callable[[], bool]:
    """Say whether the task that this thread carries out is still wanted, and its worker goes on."""
    from distributed import get_worker

    worker: Any = get_worker()
    key = worker.get_current_task()

    def wanted() -> bool:
        task = worker.state.tasks.get(key)
        return task is not None and task.state == "executing" and worker.status.name in ("running", "paused")

    return wanted


def _end(child: subprocess.Popen[bytes]) -> None:
    """End a process: on SIGTERM a run closes its folder; a process that does not end is killed."""
    if child.poll() is not None:
        return
    child.terminate()
    try:
        child.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        child.kill()


def _try_elsewhere() -> NoReturn:
    """Hand the run back to the scheduler: its process was asked to end, by a batch system for example."""
    from distributed import Reschedule

    raise Reschedule


def _of_host(words: str) -> str:
    """What is wrong with this worker, with the name of its machine.

    >>> _of_host("it is full").endswith(": it is full")
    True
    """
    return f"worker on {socket.gethostname()}: {words}"


async def ended(token: str) -> None:
    """Wait until all processes of a study have ended on this worker."""
    while token in _under_way.values():
        await asyncio.sleep(_LOOK)


async def checked(site: str) -> bytes:
    """Compare this worker with the client; the answer is that of a call without a result."""
    return await asyncio.to_thread(in_process, site, pickle.dumps((_nothing, ())), lambda: True)


def _nothing() -> None:
    """A call that does nothing."""


# ------------------------------------------------------------------------------------------------- the client


def packed_site(site: Site) -> str:
    """`Site` as JSON on one line."""
    return json.dumps(asdict(site))


def unpacked(answer: bytes) -> Any:
    """Result of a call from the answer of its process.

    Raises
    ------
    WorkerError : the worker differs from the client.
    Exception : what the call raised.
    """
    kind, value = pickle.loads(answer)
    if kind == "refused":
        raise WorkerError(value)
    if kind == "raised":
        raise value
    return value


# -------------------------------------------------------------------------------------- the process of a call


def main() -> None:
    """Carry out the call that comes through stdin, and give its answer to stdout."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # runs are ended by SIGTERM
    given, answers = sys.stdin.buffer, os.dup(1)
    os.dup2(2, 1)  # what a study prints is no part of the answer
    site = Site(**json.loads(given.readline()))
    if words := site.mismatch():
        answer = ("refused", _of_host(words))
    else:
        call, arguments = pickle.load(given)
        threading.Thread(target=_leave_with_worker, args=(given,), daemon=True).start()
        try:
            answer = ("value", call(*arguments))
        except KeyboardInterrupt:
            os._exit(STOPPED)
        except Exception as error:
            answer = ("raised", error)
    try:
        text = pickle.dumps(answer)
    except Exception as error:  # the measurements cannot be sent between processes
        text = pickle.dumps(("raised", RuntimeError(f"{type(error).__name__}: {error}")))
    with os.fdopen(answers, "wb") as out:
        out.write(text)
    os._exit(0)  # the thread that waits for the worker is not waited for


def _leave_with_worker(given: Any) -> None:
    """End as by SIGTERM when the worker that holds the other end of stdin has ended."""
    with suppress(OSError):
        given.read(1)
    leave()


def leave() -> None:
    """End this process as by SIGTERM: a run closes its folder; after some patience without."""
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(PATIENCE)
    os._exit(1)
