"""What is asked of a code that is timed, what it gives back, and how its process is run and watched."""

import os
import subprocess
import threading
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from workloads import DT, FRAME, Workload


@dataclass(frozen=True)
class Job:
    """One run: which grains, how long, on how many cores."""

    load: Workload
    grains: Path
    threads: int
    warm: int  # steps before the clock starts
    steps: int  # steps timed
    skin: float = 0.2  # reach of the neighbour list beyond touch, in diameters; ryusa finds its own
    final: Path | None = None  # where the last frame goes, as ryusa's arrays
    dt: float = DT  # [s]

    @property
    def frame(self) -> int:
        """Steps between two frames; at least one falls in the time that is taken."""
        return min(round(FRAME * DT / self.dt), self.steps)

    def times(self, share: float) -> "Job":
        """Return the same with fewer steps, for a code that needs longer for each."""
        warm, steps = max(1, round(share * self.warm)), max(1, round(share * self.steps))
        return replace(self, warm=warm, steps=steps)

    def plain(self) -> dict[str, Any]:
        """Return everything as JSON holds it."""
        return {
            **asdict(self), "frame": self.frame,
            "grains": str(self.grains), "final": None if self.final is None else str(self.final),
        }  # fmt: skip


@dataclass(frozen=True)
class Taken:
    """What a run took."""

    loop: float  # time of the timed steps, frames and log included [s]
    whole: float  # of the process, from its start to its end [s]
    own: dict[str, Any]  # what the code says of itself


class Peer(Protocol):
    """A code that steps the same grains."""

    name: str
    slip: str  # how its sliding ends, by ryusa's name
    skins: dict[str, tuple[float, ...]]  # to try, by workload
    share: float  # of the steps that are timed

    def version(self) -> str:
        """Version as it tells it."""
        ...

    def command(self, job: Job, folder: Path) -> tuple[list[str], dict[str, str]]:
        """Write the input of a job into a folder; the command that runs it there, and its environment."""
        ...

    def read(self, job: Job, folder: Path, said: str) -> tuple[float, dict[str, Any]]:
        """Time of the timed loop [s] and what the code says of itself, from what a run printed and left."""
        ...


class PeerError(Exception):
    """A code did not run through; the text is what it said last."""


def carry_out(peer: Peer, job: Job, folder: Path) -> Taken:
    """Run one job in an empty folder."""
    command, environment = peer.command(job, folder)
    begun = time.perf_counter()
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
        stdin=subprocess.DEVNULL,
    )
    whole = time.perf_counter() - begun
    if done.returncode:
        raise PeerError(f"{peer.name}: {' '.join(command)[:200]}\n{done.stdout[-2000:]}")
    loop, own = peer.read(job, folder, done.stdout)
    return Taken(loop, whole, own)


def peak_memory(peer: Peer, job: Job, folder: Path) -> int:
    """Peak memory of a run on one core [B], looked at every few milliseconds."""
    command, environment = peer.command(job, folder)
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    most = [0]

    def watch() -> None:
        while process.poll() is None:
            most[0] = max(most[0], *(peak_of(pid) for pid in [process.pid, *children_of(process.pid)]))
            time.sleep(0.005)

    watcher = threading.Thread(target=watch)
    watcher.start()
    _, error = process.communicate()
    watcher.join()
    if process.returncode:
        raise PeerError(f"{peer.name}: {error[-2000:]}")
    return most[0]


def peak_of(pid: int) -> int:
    """Peak memory of a process so far [B]; 0 where it has ended."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return 0
    return next((int(line.split()[1]) * 1024 for line in status.splitlines() if line.startswith("VmHWM")), 0)


def children_of(pid: int) -> list[int]:
    """Processes that a process started, and those that they did."""
    try:
        found = [int(one) for one in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except OSError:
        return []
    return [*found, *(one for child in found for one in children_of(child))]


def threads_of_one(threads: int) -> dict[str, str]:
    """Environment of a run: so many OpenMP threads, and Open MPI as whoever runs this."""
    ours = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    if os.geteuid() == 0:
        ours |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return ours


def keep(path: Path, x: np.ndarray, v: np.ndarray, omega: np.ndarray) -> None:
    """Keep a last frame as ryusa's arrays."""
    np.savez(path, x=x, v=v, omega=omega)
