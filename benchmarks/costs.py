"""Memory for a grain, start-up, and cost against the number of grains."""

import statistics
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from peer import Job, PeerError, peak_memory
from peer_ryusa import Ryusa
from speed import rate, run
from workloads import workload

SMALL = "1k"  # what memory is held against
STARTS = 3  # runs of which the median start-up is taken
REPEATS = 3  # runs at each number of grains
LINEAR = 2000  # grains from which the exponent is taken; fewer do not fill a step


def memory(
    files: dict[str, Path], counts: dict[str, int], peers: dict[str, list[Any]], steps: int, work: Path
) -> list[dict[str, Any]]:
    """Peak memory of one core at every size, less that of the same command at the smallest."""
    rows: list[dict[str, Any]] = []
    for name, code in [("ryusa", Ryusa()), *((name, builds[0]) for name, builds in peers.items())]:
        peaks: dict[str, int] = {}
        for size, path in files.items():
            if name != "ryusa" and counts[size] > 300_000:
                continue
            job = Job(workload("W2", size), path, 1, 0 if name == "ryusa" else 1, steps, skin=0.1)
            with tempfile.TemporaryDirectory(dir=work) as folder:
                try:
                    peaks[size] = peak_memory(code, job, Path(folder))
                except PeerError as error:
                    print(f"    {error}", flush=True)
                    continue
            if size == SMALL or SMALL not in peaks:
                continue
            more = (peaks[size] - peaks[SMALL]) / (counts[size] - counts[SMALL])
            rows.append(
                {
                    "code": name,
                    "grains": counts[size],
                    "less": counts[SMALL],
                    "B a grain": round(more),
                    "peak [MiB]": round(peaks[size] / 2**20),
                }
            )
            print(f"    {rows[-1]}", flush=True)
    return rows


def start(path: Path, peers: dict[str, list[Any]], work: Path) -> list[dict[str, Any]]:
    """Time before the first step of 2k grains, and of ryusa with an empty cache: everything but the loop."""
    job = Job(workload("W1", "2k"), path, 1, 1, 10, skin=0.2)
    rows: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory(dir=work) as cache:
        cold = run(Ryusa(cache=Path(cache)), job, work)
        rows.append(_started("ryusa, nothing compiled yet", [cold]))
    codes = [("ryusa, kernels cached", Ryusa()), *((name, builds[0]) for name, builds in peers.items())]
    for name, code in codes:
        try:
            rows.append(_started(name, [run(code, job, work) for _ in range(STARTS)]))
        except PeerError as error:
            print(f"    {error}", flush=True)
    return rows


def _started(name: str, runs: list[Any]) -> dict[str, Any]:
    row: dict[str, Any] = {
        "code": name,
        "start-up [s]": round(statistics.median(one.whole - one.loop for one in runs), 2),
    }
    for part in ("imports", "build", "until warm"):
        if part in runs[0].own:
            row[f"{part} [s]"] = round(statistics.median(one.own[part] for one in runs), 2)
    return row


def scaling(
    files: dict[str, Path], counts: dict[str, int], threads: list[int], scale: float, work: Path
) -> dict[str, Any]:
    """Time of a step against the number of grains in W1, ryusa alone, and the exponent of it."""
    rows: list[dict[str, Any]] = []
    exponents: dict[str, float] = {}
    for n_threads in threads:
        for size, path in files.items():
            grid = workload("W1", size).grid
            job = Job(workload("W1", size), path, n_threads, grid.warm, grid.steps).times(scale)
            loops = [run(Ryusa(), replace(job), work).loop for _ in range(REPEATS)]
            loop = statistics.median(loops)
            rows.append(
                {
                    "threads": n_threads,
                    "grains": counts[size],
                    "us a step": round(1e6 * loop / job.steps, 2),
                    "M/s": round(rate(counts[size], job, loop), 2),
                }
            )
            print(f"    {rows[-1]}", flush=True)
        line = [
            (row["grains"], row["us a step"])
            for row in rows
            if row["threads"] == n_threads and row["grains"] > LINEAR
        ]
        if len(line) > 1:
            slope, _ = np.polyfit(*np.log(np.array(line)).T, 1)
            exponents[str(n_threads)] = round(float(slope), 3)
    return {"rows": rows, "exponents": exponents}
