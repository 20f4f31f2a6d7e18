"""What it costs never to lose a run: checkpoints and guards at 20,172 grains in 3D, on one thread.

    python benchmarks/checkpoints.py           # two minutes
    python benchmarks/checkpoints.py --save    # and keep the table in benchmarks/results/

The packaged dense 3D case, as `ryusa run` steps it, contacts recorded or not. A checkpoint is timed whole:
the state taken from the engine, laid into HDF5, digested, written, synced and renamed. Its share is that of
one in every interval; by default 300 s, and never more than 1 % of the time, since a dear checkpoint puts off
the next. Guards of the loop are timed at every frame, where they look, over the steps between two frames.
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

from ryusa.build import build
from ryusa.casefile import read
from ryusa.engine.cpu import CpuEngine
from ryusa.running.guards import energy_created
from ryusa.running.keeper import EVERY, Keeper
from ryusa.running.provenance import processor
from ryusa.running.snapshot import kept_state

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


def measure(events: str, columns: int, folder: Path) -> dict[str, Any]:
    path = Path(str(files("ryusa").joinpath("cases", "dense_3d.toml")))
    size = {"build.columns": str(columns), "build.rows": str(columns), "record.events": f"'{events}'"}
    case = read(path, size)
    built = build(case)
    scene, engine = built.scene, CpuEngine()
    engine.load(scene, built.state)
    engine.advance(15_000).raise_if_any()  # grains are in touch by then
    engine.events()
    keeper = Keeper(folder, {}, scene)
    step = median(lambda: engine.advance(STEPS)) / STEPS
    engine.events()
    whole = median(lambda: keeper.write(kept_state(engine.state()), scene, {}))
    state, tally = engine.state(), engine.tally()
    guard = median(lambda: energy_created(scene, state, tally))
    frame = round(case.record.frames / scene.dt)
    return {
        "events": events,
        "grains": scene.n_grain,
        "contacts": len(state.contacts),
        "us a step": round(1e6 * step, 1),
        "checkpoint [ms]": round(1e3 * whole, 1),
        "checkpoint [MB]": round(keeper.size / 1e6, 2),
        "share of checkpoints [%]": round(100.0 * whole / (EVERY + whole), 4),
        "guard a frame [us]": round(1e6 * guard, 1),
        "steps a frame": frame,
        "share of guards [%]": round(100.0 * guard / (frame * step), 5),
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
