"""What the exchange between grains and water costs, on one thread, with the machine it was taken on.

    python benchmarks/exchange.py              # 20,000 grains, cells of d/5, d/10 and d/15
    python benchmarks/exchange.py --save       # and keep the table in benchmarks/results/

One exchange: slices, concentration, two sums from grains to cells, three means from cells to grains. Grains
lie at random in a bed 12 diameters deep, in random order in memory.
"""

import argparse
import datetime
import json
import os
import platform
import statistics
import time
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from ryusa.running.provenance import processor
from ryusa.water import exchange
from ryusa.water.exchange import Cells

REPEATS = 200
D, DEPTH = 0.002, 12.0  # diameter [m]; depth of the bed in diameters


def measure(n_grain: int, per_d: float, spread: float) -> dict[str, Any]:
    """Median time of every part of one exchange."""
    rng = np.random.default_rng(1)
    d = D * rng.uniform(1.0 - spread, 1.0 + spread, n_grain)
    z = rng.uniform(0.5, DEPTH, n_grain) * D
    cells = Cells(0.0, D / per_d, int(2 * DEPTH * per_d), (40 * D) ** 2)
    amounts, speeds = rng.normal(size=(n_grain, 2)), rng.normal(size=(cells.n, 3))
    ids = rng.permutation(n_grain)
    found = exchange.slices(z, d, cells, ids)
    parts: dict[str, Callable[[], Any]] = {
        "slices": lambda: exchange.slices(z, d, cells, ids, reuse=found),
        "concentration": lambda: exchange.concentration(found),
        "two to cells": lambda: exchange.to_cells(found, amounts),
        "three to grains": lambda: exchange.to_grains(found, speeds),
    }
    taken: dict[str, list[float]] = {name: [] for name in parts}
    for k in range(REPEATS + 3):
        for name, part in parts.items():
            begin = time.perf_counter()
            part()
            if k >= 3:
                taken[name].append(1e3 * (time.perf_counter() - begin))
    whole = [sum(one) for one in zip(*taken.values(), strict=True)]
    row: dict[str, Any] = {"grains": n_grain, "cells a diameter": per_d, "spread": spread}
    row |= {f"{name} [ms]": round(statistics.median(times), 3) for name, times in taken.items()}
    row |= {"all [ms]": round(statistics.median(whole), 3), "least [ms]": round(min(whole), 3)}
    return row


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grains", type=int, default=20_000)
    parser.add_argument("--save", action="store_true", help="keep the table in benchmarks/results/")
    options = parser.parse_args()
    table: dict[str, Any] = {
        "date": datetime.date.today().isoformat(),
        "machine": {"cpu": processor(), "system": platform.platform(), "python": platform.python_version()},
        "versions": {name: version(name) for name in ("ryusa", "numba", "llvmlite", "numpy")},
        "load average before": [round(a, 2) for a in os.getloadavg()],
        "rows": [],
    }
    for per_d, spread in ((5.0, 0.0), (10.0, 0.0), (15.0, 0.0), (10.0, 0.5)):
        row = measure(options.grains, per_d, spread)
        table["rows"].append(row)
        print(", ".join(f"{key} {value}" for key, value in row.items()), flush=True)
    if options.save:
        file = Path(__file__).parent / "results" / f"exchange-{table['date']}.json"
        file.parent.mkdir(exist_ok=True)
        file.write_text(json.dumps(table, indent=1) + "\n")
        print(f"kept in {file.relative_to(Path(__file__).parent.parent)}")


if __name__ == "__main__":
    main()
