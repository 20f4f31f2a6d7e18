"""One timed run of ryusa, in a process of its own, as a script of a user does it; prints its figures as JSON.

    python benchmarks/ours.py '{"grains": ..., "load": {...}, "slip": "total", "threads": 1, ...}'

The whole of `ryusa.run_scene` is timed: engine with energy account and guards, frames, watch, run folder. The
clock starts when the first `warm` steps are done, and stops when the run folder is whole. What is before
(imports, kernels from the cache, first neighbour list) is start-up.
"""

import json
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import workloads
from prepare import free_scene
from workloads import Grains, Workload

from ryusa.build import build
from ryusa.casefile import read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.model import Scene, State, Tally
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

IMPORTED = time.perf_counter()


def age() -> float:
    """Time since this process began [s]."""
    ticks = int(Path("/proc/self/stat").read_text().rpartition(")")[2].split()[19])
    return time.clock_gettime(time.CLOCK_BOOTTIME) - ticks / os.sysconf("SC_CLK_TCK")


STARTED = age()


class Clocked(CpuEngine):
    """The engine users run; notes when `warm` steps are done."""

    warm = 0
    done = 0
    begun = 0.0  # by the clock, and in the processor's time
    begun_cpu = 0.0
    contacts: list[int]

    def advance(self, n_steps: int) -> Any:
        """Step, in two calls where the clock starts in between; the bits are the same."""
        first = min(max(self.warm - self.done, 0), n_steps)
        flags = super().advance(first)
        self.done += n_steps
        if first == n_steps or flags:
            return flags
        if not self.begun:
            self.begun, self.begun_cpu = time.perf_counter(), time.process_time()
        return super().advance(n_steps - first)

    def tally(self) -> Tally:
        found = super().tally()
        self.contacts = [*getattr(self, "contacts", []), found.n_contact]
        return found


def scene_of(job: dict[str, Any], load: Workload, folder: Path) -> tuple[Scene, State]:
    """Scene and first state: from arrays, or under water from a case file and its table."""
    grains = Grains.load(job["grains"])
    if not load.column:
        return free_scene(
            grains,
            job["slip"],
            load.slope,
            plane=load.plane,
            dt=job["dt"],
            timing=job["timing"],
            gravity=load.gravity,
        )
    rows = [
        np.hstack([grains.x, grains.d[:, None], grains.v, grains.omega, np.zeros((len(grains.x), 1))]),
        np.hstack(
            [
                grains.x_fixed,
                grains.d_fixed[:, None],
                np.zeros((len(grains.x_fixed), 6)),
                np.ones((len(grains.x_fixed), 1)),
            ]
        ),
    ]
    head = "x [m],y [m],z [m],d [m],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],wy [rad/s],wz [rad/s],fixed"
    np.savetxt(
        folder / "grains.csv",
        np.vstack(rows),
        fmt=["%.17g"] * 10 + ["%d"],
        delimiter=",",
        header=head,
        comments="",
    )
    built = build(
        read_text(
            CASE.format(
                w=workloads,
                dt=job["dt"],
                slip=job["slip"],
                slope=load.slope,
                period=grains.period,
                timing=job["timing"],
            ),
            path=folder / "case.toml",
        )
    )
    return built.scene, built.state


CASE = """
[grains]
diameter = "{w.D} m"
density = "{w.DENSITY} kg/m3"
[contact]
stiffness = "{w.K_N} N/m"
shear_stiffness = "{w.K_S} N/m"
damping = "{w.ETA_N} N s/m"
shear_damping = "{w.ETA_S} N s/m"
friction = {w.MU}
slip = "{slip}"
cap = "total"
timing = "{timing}"
[motion]
rotation = "free"
plane = false
gravity = "{w.GRAVITY} m/s2"
slope_angle = "{slope} rad"
[build]
kind = "table"
file = "grains.csv"
allow_overlap = true
[domain]
period_x = "{period[0]} m"
period_y = "{period[1]} m"
[water]
profile = "column"
depth = "4 cm"
hindrance = "Di Felice"
zero = "1 mm"
[time]
step = "{dt} s"
[stop]
time = "1 s"
[record]
events = "none"
"""


def main() -> None:
    job = json.loads(sys.argv[1])
    load = Workload(**job["load"])
    with tempfile.TemporaryDirectory() as work:
        folder = Path(work)
        scene, state = scene_of(job, load, folder)
        built = time.perf_counter()
        engine = Clocked(threads=job["threads"])
        engine.warm = job["warm"]
        last = (job["warm"] + job["steps"]) * scene.dt
        results = run_scene(
            scene, state, folder / "run", frames=job["frame"] * scene.dt, stop=Stop(time=last),
            threads=job["threads"], progress=False, engine=engine,
        )  # fmt: skip
        ended = time.perf_counter()
        frame = results.frames[-1]
        found = {
            "loop": ended - engine.begun,
            "imports": STARTED,
            "build": built - IMPORTED,
            "until warm": engine.begun - built,
            "frames": len(results.frames),
            "contacts": engine.contacts[-1] / scene.n_grain,
            "residual": results.summary["energy"]["residual"],
            "peak": peak(),
        }
        if job.get("final"):
            np.savez(job["final"], x=frame.x, v=frame.v, omega=frame.omega)
    print(json.dumps(found))


def peak() -> int:
    """Peak memory of this process alone [B]; getrusage would pass on that of the process that forked it."""
    line = next(
        line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM")
    )
    return int(line.split()[1]) * 1024


if __name__ == "__main__":
    main()
