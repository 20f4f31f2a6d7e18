"""What it costs never to lose a run: checkpoints and guards at 20,172 grains in 3D, on one thread.

    python benchmarks/checkpoints.py           # two minutes
    python benchmarks/checkpoints.py --save    # and keep the table in benchmarks/results/

The packaged dense 3D case, as `ryusa run` steps it, contacts recorded or not. A checkpoint is timed whole:
the state taken from the engine, laid into HDF5, digested, written, synced and renamed. Its share is that of
one in every interval; by default 300 s, and never more than 1 % of the time, since a dear checkpoint puts off
the next. Guards of the loop are timed at every frame, where they look, over the steps between two frames;
the look for room on the disk over the least time between two parts. Guards inside a step (is every speed a
number, does an overlap exceed) cannot be taken out of a kernel; they are timed in a loop of their own, over
as many grains and pairs, which is more than they cost where their numbers lie in registers already.
"""

import argparse
import datetime
import json
import os
import platform
import statistics
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit

from ryusa.build import build
from ryusa.casefile import read
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.running.checkpoint_scheduler import CHECKPOINT_INTERVAL, CheckpointScheduler
from ryusa.running.disk import free_bytes
from ryusa.running.guards import energy_created
from ryusa.running.provenance import processor
from ryusa.running.snapshot import engine_block

SOONEST = 2.0  # s between two parts at least
REPEATS = 7
STEPS = 400  # timed together


def median(call: Callable[[], Any], times: int = REPEATS) -> float:
    """Time of a call [s]."""
    taken = []
    for _ in range(times):
        begin = time.perf_counter()
        call()
        taken.append(time.perf_counter() - begin)
    return statistics.median(taken)


@njit(error_model="numpy")
def checks(squares: Any, overlaps: Any, smaller: Any, most: float) -> tuple[bool, bool]:
    """What guards look at in a step: a speed that is no number, an overlap beyond the largest so far."""
    lost = larger = False
    for i in range(len(squares)):
        lost = lost or not squares[i] < np.inf
    for k in range(len(overlaps)):
        larger = larger or overlaps[k] > most * smaller[k]
    return lost, larger


def measure(events: str, columns: int, folder: Path) -> dict[str, Any]:
    path = Path(str(files("ryusa").joinpath("cases", "dense_3d.toml")))
    size = {"build.columns": str(columns), "build.rows": str(columns), "record.events": f"'{events}'"}
    case = read(path, size)
    built = build(case)
    scene, engine = built.scene, CpuEngine()
    engine.load(scene, built.state)
    engine.advance(15_000).raise_if_any()  # grains are in touch by then
    engine.events()
    scheduler = CheckpointScheduler(folder, {}, scene)
    step = median(lambda: engine.advance(STEPS)) / STEPS
    engine.events()
    whole = median(lambda: scheduler.write(engine_block(engine, None), scene, {}))
    state, tally = engine.state(), engine.tally()
    guard = median(lambda: energy_created(scene, state, tally))
    frame = round(case.record.frames / scene.dt)
    n_pair = len(state.contacts)
    seen = np.sum(state.v**2, axis=1), np.full(n_pair, 1e-6), np.full(n_pair, float(scene.d.min())), 1.0
    checks(*seen)
    inside = median(lambda: [checks(*seen) for _ in range(100)]) / 100
    room = median(lambda: free_bytes(folder), 100)
    shares = {
        "share of checkpoints [%]": 100.0 * whole / (CHECKPOINT_INTERVAL + whole),
        "share of guards at frames [%]": 100.0 * guard / (frame * step),
        "share of guards in a step, at most [%]": 100.0 * inside / step,
        "share of looks for room [%]": 100.0 * room / SOONEST,
    }
    return {
        "events": events,
        "grains": scene.n_grain,
        "contacts": n_pair,
        "us a step": round(1e6 * step, 1),
        "checkpoint [ms]": round(1e3 * whole, 1),
        "checkpoint [MB]": round(scheduler.size / 1e6, 2),
        "guard a frame [us]": round(1e6 * guard, 1),
        "steps a frame": frame,
        "guards in a step, at most [us]": round(1e6 * inside, 1),
        "look for room [us]": round(1e6 * room, 1),
        **{name: round(share, 5) for name, share in shares.items()},
        "share in all [%]": round(sum(shares.values()), 3),
    }


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--columns", type=int, default=41, help="grains along x and y: 41 x 41 x 12")
    parser.add_argument("--save", action="store_true", help="keep the table in benchmarks/results/")
    options = parser.parse_args()
    table: dict[str, Any] = {
        "date": datetime.date.today().isoformat(),
        "machine": {"cpu": processor(), "system": platform.platform(), "python": platform.python_version()},
        "versions": {name: version(name) for name in ("ryusa", "numba", "llvmlite", "numpy", "h5py")},
        "load average before": [round(a, 2) for a in os.getloadavg()],
        "rows": [],
    }
    for events in ("none", "all"):
        with tempfile.TemporaryDirectory(dir=".") as folder:
            table["rows"].append(measure(events, options.columns, Path(folder)))
        print(", ".join(f"{key} {value}" for key, value in table["rows"][-1].items()), flush=True)
    if options.save:
        file = Path(__file__).parent / "results" / f"checkpoints-{table['date']}.json"
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(table, indent=1) + "\n")
        print(f"kept in {file.relative_to(Path(__file__).parent.parent)}")


if __name__ == "__main__":
    main()
