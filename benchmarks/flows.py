"""Whole workloads on one and more threads: particle-steps per second, with the machine they were taken on.

    python benchmarks/flows.py                       # all workloads, 1 and 2 threads
    python benchmarks/flows.py plane --threads 1     # one of them
    python benchmarks/flows.py --save                # and keep the table in benchmarks/results/

A dense workload is a packaged case: grains settle on a level bed, the bed tilts to 26 degrees, and once they
flow the engine is timed, thread counts in turn on the same grains, so that a drift of the machine's speed
meets all. The engine is the one users run: energy account and guards on. Steps are timed in the engine alone
(no frames).
"""

import argparse
import datetime
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from importlib.metadata import version
from importlib.resources import files
from pathlib import Path
from typing import Any

from ryusa.build import build, change
from ryusa.casefile import read
from ryusa.engine.cpu import CpuEngine
from ryusa.model import Scene, State
from ryusa.running.provenance import processor

REPEATS = 7
WORKLOADS = {  # name: case, steps to settle, steps to flow, steps timed in one go
    "plane": ("dense_plane.toml", 60_000, 40_000, 5_000),
    "3d": ("dense_3d.toml", 60_000, 30_000, 500),
    "lone": ("saltation.toml", 0, 100_000, 200_000),
    "dropped": ("drop.toml", 0, 1_000, 200_000),
}


def case_of(name: str) -> Any:
    """The packaged case of a workload; the lone grain is the saltation case with one start."""
    path = Path(str(files("ryusa").joinpath("cases", WORKLOADS[name][0])))
    return read(path, {"build.starts": "1"} if name == "lone" else None)


def measure(name: str, threads: list[int]) -> list[dict[str, Any]]:
    """Rates of one workload for each number of threads: at rest, where there is a rest, and in motion."""
    _, settle, flow, steps = WORKLOADS[name]
    case = case_of(name)
    scene, state = (built := build(case)).scene, built.state
    engine = CpuEngine(threads=max(threads))
    engine.load(scene, state)
    rows = []
    if settle:
        engine.advance(settle).raise_if_any()
        rows += timed(f"{name}, settled", scene, engine.state(), threads, steps)
        scene = change(case, scene, case.timeline[0])
        engine.load(scene, engine.state())
    engine.advance(flow).raise_if_any()
    return [*rows, *timed(f"{name}, moving", scene, engine.state(), threads, steps)]


def timed(name: str, scene: Scene, state: State, threads: list[int], steps: int) -> list[dict[str, Any]]:
    """Step one state with each number of threads in turn."""
    engines = {n: CpuEngine(threads=n) for n in threads}
    for one in engines.values():
        one.load(scene, state)
        one.advance(min(steps, 200)).raise_if_any()
    taken: dict[int, list[float]] = {n: [] for n in threads}
    for _ in range(REPEATS):
        for n, one in engines.items():
            begin = time.perf_counter()
            one.advance(steps).raise_if_any()
            taken[n].append((time.perf_counter() - begin) / steps)
            one.events()
    rows = []
    for n, times in taken.items():
        account = engines[n].tally()
        rates = sorted(1e-6 * scene.n_grain / t for t in times)
        gains = [a / b for a, b in zip(taken[threads[0]], times, strict=True)]
        rows.append(
            {
                "workload": name, "grains": scene.n_grain, "threads": n,
                "M particle-steps/s": round(statistics.median(rates), 2),
                "lower quartile": round(statistics.quantiles(rates, n=4)[0], 2),
                "us a step": round(1e6 * statistics.median(times), 3),
                "contacts a grain": round(account.n_contact / scene.n_grain, 2),
                "speed-up": round(statistics.median(gains), 2),
                "account residual": float(f"{account.residual:.1e}"),
            }
        )  # fmt: skip
    return rows


def peak_memory(columns: int) -> tuple[int, int]:
    """Grains and peak memory [B] of a process that steps the 3D flow with columns x columns x 12 grains."""
    code = (
        "import sys\n"
        "sys.path.insert(0, 'benchmarks')\n"
        "from flows import CpuEngine, Path, build, files, read\n"
        f"over = {{'build.columns': '{columns}', 'build.rows': '{columns}'}}\n"
        "case = read(Path(str(files('ryusa').joinpath('cases', 'dense_3d.toml'))), over)\n"
        "built = build(case)\n"
        "engine = CpuEngine()\n"
        "engine.load(built.scene, built.state)\n"
        "engine.advance(20_000 if built.scene.n_grain < 30_000 else 4_000).raise_if_any()\n"
        # the peak of this process alone: getrusage would pass on the peak of the process it was forked from
        "peak = next(l for l in open('/proc/self/status') if l.startswith('VmHWM')).split()[1]\n"
        "print(built.scene.n_grain, int(peak) * 1024)\n"
    )
    out = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    return int(out[0]), int(out[1])


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "workloads", nargs="*", choices=[[], *WORKLOADS, "memory"], help="all when none is named"
    )
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--save", action="store_true", help="keep the table in benchmarks/results/")
    options = parser.parse_args()
    names = options.workloads or [*WORKLOADS, "memory"]
    table: dict[str, Any] = {
        "date": datetime.date.today().isoformat(),
        "machine": {"cpu": processor(), "system": platform.platform(), "python": platform.python_version()},
        "versions": {name: version(name) for name in ("ryusa", "numba", "llvmlite", "numpy")},
        "load average before": [round(a, 2) for a in os.getloadavg()],
        "rows": [],
    }
    for name in names:
        if name == "memory":
            small, large = peak_memory(10), peak_memory(91)
            table["bytes a grain"] = round((large[1] - small[1]) / (large[0] - small[0]))
            sizes = f"{large[0]} grains less {small[0]}"
            print(f"memory: {table['bytes a grain']} B a grain ({sizes})", flush=True)
            continue
        for row in measure(name, options.threads if name in ("plane", "3d") else [1]):
            table["rows"].append(row)
            print(", ".join(f"{key} {value}" for key, value in row.items()), flush=True)
    if options.save:
        file = Path(__file__).parent / "results" / f"flows-{table['date']}.json"
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(table, indent=1) + "\n")
        print(f"kept in {file.relative_to(Path(__file__).parent.parent)}")


if __name__ == "__main__":
    main()
