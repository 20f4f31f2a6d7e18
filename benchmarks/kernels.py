"""What the parts of a step cost, seen from outside: the engine on grains that need one part more each time.

    python benchmarks/kernels.py [--grains 20000]

Only the seam of an engine is used (`load`, `advance`, `tally`), so that the figures go on when an engine is
built anew. Grains stand on a cubic lattice, periodic along x and y, without weight: far apart (motion alone),
almost in touch (and distances of listed pairs), in touch between two fixed layers (and forces of three pairs
a grain); then far apart again, every other layer moving the other way, so fast that lists are made often.
"""

import argparse
import json
import statistics
import time
from dataclasses import replace
from typing import Any

import numpy as np
import workloads
from prepare import free_scene
from workloads import DT, D, Grains

from ryusa.engine.cpu.engine import CpuEngine

REPEATS = 7
FAST = 0.01 * D / DT  # m/s: a hundredth of a diameter a step


def lattice(n: int, pitch: float, speed: float) -> Grains:
    """About n grains on a cubic lattice of that pitch [D]; layers move to and fro, the outer two stay."""
    side = max(4, round(n ** (1 / 3)))
    x = (np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3) + 0.5) * pitch * D
    layer = np.tile(np.arange(side), side * side)
    free = (layer > 0) & (layer < side - 1)
    v = np.zeros_like(x[free])
    v[:, 0] = np.where(layer[free] % 2, speed, -speed)
    period = (side * pitch * D, side * pitch * D)
    return Grains(
        x[free], v, np.zeros_like(v), np.full(len(v), D), x[~free], np.full(len(x) - len(v), D), period
    )


def measure(n: int) -> list[dict[str, Any]]:
    """Time of a step for each grain [ns], and what each part adds."""
    kinds = {
        "motion (grains far apart)": lattice(n, 2.0, 0.0),
        "and distances (gaps of 2 % of a diameter)": lattice(n, 1.02, 0.0),
        "and forces (three touching pairs a grain)": lattice(n, 0.9995, 0.0),
        "motion and lists (far apart, fast)": lattice(n, 2.0, FAST),
    }
    rows: list[dict[str, Any]] = []
    for name, grains in kinds.items():
        scene, state = weightless(grains)
        engine = CpuEngine()
        engine.load(scene, state)
        engine.advance(200).raise_if_any()
        taken: list[float] = []
        for _ in range(REPEATS):
            begun = time.perf_counter()
            engine.advance(100).raise_if_any()
            taken.append((time.perf_counter() - begun) / 100)
        ns = 1e9 * statistics.median(taken) / scene.n_grain
        pairs = engine.tally().n_contact / scene.n_grain
        rows.append(
            {
                "part": name,
                "grains": scene.n_grain,
                "touching pairs a grain": round(pairs, 2),
                "ns a grain and step": round(ns, 1),
            }
        )
    return rows


def weightless(grains: Grains) -> Any:
    """Scene and state of grains that nothing pulls."""
    scene, state = free_scene(grains, workloads.TOTAL, 0.0, plane=False)
    return replace(scene, gravity=np.zeros(3)), state


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--grains", type=int, default=20_000)
    for row in measure(parser.parse_args().grains):
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
