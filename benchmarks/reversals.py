"""Ratio of the vertical reversals of Fig. 16 by threshold, frames, window, grains and mean.

    ryusa run avalanche.toml --set 'record.frames="1 ms"' --set 'record.events="all"' -o soft-1      # and
    ryusa run ... --set 'contact.stiffness={ collision_time = "0.0001 s" }' -o stiff-1
    python benchmarks/reversals.py --soft soft-1 soft-2 ... --stiff stiff-1 stiff-2 ...

Prints the ratio of the runs with the short collision time to those with the long one, with the 95 % interval
of its jackknife over the pairs of runs.
"""

import argparse
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import stats

from ryusa.measure import alternating, paths
from ryusa.measure.paths import THRESHOLD
from ryusa.results import Results
from ryusa.study import pseudo_values

TILT = 1.0  # of the case [s]
THRESHOLDS = (0.005, 0.01, 0.02, 0.05, 0.1)
FRAMES_MS = (1, 2, 5, 10, 20)
BETWEEN, ALL = "between bed and movers", "all"


@dataclass(frozen=True)
class Turns:
    """Turns, sum of the advances [m] and number of grains, of one run in one window."""

    n: float
    advance: float
    grains: int


def turns(run: Results, begin: float, frames_ms: float, threshold: float, grains: str) -> Turns:
    """Count them on every frame that comes `frames_ms` after the one before."""
    ids = list(range(run.scene.n_grain))
    if grains == BETWEEN:
        ids = [int(one) for one in alternating(run, begin, begin + 1.0).grains]
    thinned: Any = _Thinned(run, frames_ms)
    found = paths(thinned, begin - 1.5e-3 * frames_ms, begin + 1.0 + 1.5e-3 * frames_ms, 1.0,
                  grains=ids, threshold=threshold)  # fmt: skip
    return Turns(float(found.reversals[0].sum()), float(found.advance[0].sum()), len(ids))


class _Thinned:
    """A run with fewer of its frames."""

    def __init__(self, run: Results, frames_ms: float) -> None:
        t = np.asarray(run.frames.t)
        every = max(round(1e-3 * frames_ms / float(np.median(np.diff(t)))), 1)
        self._run, self.frames = run, _Frames(t[::every], np.asarray(run.frames.x[::every]))

    def __getattr__(self, name: str) -> object:
        return getattr(self._run, name)


@dataclass(frozen=True)
class _Frames:
    t: np.ndarray
    x: np.ndarray


def per_metre(runs: Sequence[Turns]) -> float:
    """Turns over advances, both summed over runs."""
    return sum(one.n for one in runs) / sum(one.advance for one in runs)


def per_metre_by_run(runs: Sequence[Turns]) -> float:
    """Mean over runs of turns over advances."""
    return float(np.mean([one.n / one.advance for one in runs]))


def per_second(runs: Sequence[Turns]) -> float:
    """Mean over runs of the turns of a grain."""
    return float(np.mean([one.n / one.grains for one in runs]))


def said(pairs: Sequence[tuple[Turns, Turns]], number: Callable[[Sequence[Turns]], float]) -> str:
    """Short over long collision time, with its interval."""

    def ratio(some: Sequence[tuple[Turns, Turns]]) -> float:
        return number([one[1] for one in some]) / number([one[0] for one in some])

    values = pseudo_values(ratio, pairs)
    if len(values) < 2:
        return f"{ratio(pairs):.2f}"
    half = float(stats.t.ppf(0.975, len(values) - 1)) * float(np.std(values, ddof=1)) / math.sqrt(len(values))
    return f"{ratio(pairs):.2f} ({np.mean(values) - half:.2f} to {np.mean(values) + half:.2f})"


def main() -> None:
    """Print the tables."""
    ask = argparse.ArgumentParser(description="Ratio of the vertical reversals of Fig. 16.")
    ask.add_argument("--soft", nargs="+", required=True, help="runs of 0.01 s, by seed")
    ask.add_argument("--stiff", nargs="+", required=True, help="runs of 0.0001 s, in the same order")
    given = ask.parse_args()
    runs = [(Results.open(a), Results.open(b)) for a, b in zip(given.soft, given.stiff, strict=True)]
    apart = 1e3 * float(np.median(np.diff(runs[0][0].frames.t)))

    def pairs(begin: float, ms: float, threshold: float, grains: str) -> list[tuple[Turns, Turns]]:
        return [
            (turns(a, TILT + begin, ms, threshold, grains), turns(b, TILT + begin, ms, threshold, grains))
            for a, b in runs
        ]

    print("| window | grains | per metre, sums | per metre, mean of runs | per second |")
    for begin in (1.0, 2.0):
        for grains in (BETWEEN, ALL):
            found = pairs(begin, 10, THRESHOLD, grains)
            cells = [said(found, one) for one in (per_metre, per_metre_by_run, per_second)]
            print(f"| {begin:g} to {begin + 1:g} s | {grains} | {' | '.join(cells)} |")
    for begin in (1.0, 2.0):
        print(f"\nsums, between bed and movers, {begin:g} to {begin + 1:g} s | " + " | ".join(
            f"{one:g} d" for one in THRESHOLDS))  # fmt: skip
        for ms in FRAMES_MS:
            if ms > 0.6 * apart:
                cells = [said(pairs(begin, ms, one, BETWEEN), per_metre) for one in THRESHOLDS]
                print(f"frames of {ms} ms | " + " | ".join(cells))


if __name__ == "__main__":
    main()
