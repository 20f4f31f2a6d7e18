"""What a boulder among many grains costs: a step of 27,000 grains of 2 mm, alone and with one on top.

The grains lie on a lattice, 0.02 d apart, and fall on to a floor. Rounds are in turn, so that a machine that
changes its speed changes it for all.
"""

import argparse
import statistics
import time

import numpy as np

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine

D = 2.0e-3


def engine_of(ratio: float, threads: int) -> CpuEngine:
    """An engine that holds the grains, and a boulder of `ratio` diameters where that is above 0."""
    places = np.stack(np.meshgrid(*[np.arange(30)] * 3, indexing="ij"), axis=-1).reshape(-1, 3) * 1.02 * D
    places[:, 2] += 0.6 * D
    d = np.full(len(places), D)
    if ratio > 0.0:
        places = np.vstack([places, [15 * D, 15 * D, 31.2 * D + 0.5 * ratio * D]])
        d = np.append(d, ratio * D)
    engine = CpuEngine(threads)
    engine.load(
        *scene(places, d, planes=[("floor", (0, 0, 0), (0, 0, 1))], friction=0.5, restitution=0.5, dt=5e-6)
    )
    return engine


def main() -> None:
    """Print milliseconds of a step and their ratio to that of the small grains alone."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ratios", type=float, nargs="+", default=[0.0, 10.0, 15.0, 40.0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--threads", type=int, default=1)
    args = parser.parse_args()
    engines = {ratio: engine_of(ratio, args.threads) for ratio in args.ratios}
    for engine in engines.values():
        engine.advance(1000).raise_if_any()
    found: dict[float, list[float]] = {ratio: [] for ratio in engines}
    for _ in range(args.rounds):
        for ratio, engine in engines.items():
            began = time.process_time()
            engine.advance(args.steps).raise_if_any()
            found[ratio].append(1e3 * (time.process_time() - began) / args.steps)
    first = statistics.median(found[args.ratios[0]])
    for ratio, times in found.items():
        middle = statistics.median(times)
        print(f"boulder of {ratio:g} d: {middle:.3f} ms a step, {middle / first:.2f} of the first")


if __name__ == "__main__":
    main()
