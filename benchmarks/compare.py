"""Two trees of ryusa stepping the same grains in turn: did a change cost speed?

    python benchmarks/compare.py OLD [NEW] [--only W1-2k W2-20k] [--threads 1 2] [--rounds 14] [--exact 5]

OLD and NEW are checkouts (`git worktree add --detach ../old COMMIT`); NEW is this one unless given. Each is
stepped by a process of its own, both are kept alive, and in every round each does the same steps, the order
turning round. The ratio is taken within a round: a machine that slows down slows both. One thread is timed
by the processor's time on a core of its own, several by the clock. A ratio of 1.00 is as fast as before,
1.03 takes 3 % longer. With --exact contacts begin and end within steps, as many to a contact as it says.
"""

import argparse
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import machine
import workloads

HERE = Path(__file__).parent
STEPS = {"2k": 3000, "20k": 300, "200k": 30}  # a round
ONLY = ("W1-2k", "W2-2k", "W3-2k", "W1-20k", "W2-20k", "W3-20k")
CHILD = "--child"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("old", type=_tree)
    parser.add_argument("new", type=_tree, nargs="?", default=HERE.parent)
    parser.add_argument("--only", nargs="+", type=_workload, default=[_workload(key) for key in ONLY])
    parser.add_argument("--threads", nargs="+", type=int, default=[1])
    parser.add_argument("--rounds", type=int, default=14)
    parser.add_argument("--exact", type=float, default=0.0, help="steps per contact")
    parser.add_argument("--work", type=Path, default=Path("build/benchmarks"))
    options = parser.parse_args()
    from prepare import grains

    cores = sorted(os.sched_getaffinity(0))
    if max(options.threads) > len(cores):
        parser.error(f"--threads {max(options.threads)}: this machine has {len(cores)} cores")
    print("workload threads: old, new [ns a particle-step, medians]; new over old within a round (quartiles)")
    for load in options.only:
        path = grains(load, options.work.resolve() / "grains", len(cores))
        for threads in options.threads:
            watch = machine.Watch()
            watch.begin()
            with (
                _stepper(options.old, load, path, threads, cores[:threads], options) as old,
                _stepper(options.new, load, path, threads, cores[:threads], options) as new,
            ):
                rounds = _rounds(old, new, STEPS[load.size], options.rounds)
            seen = watch.end()
            below, middle, above = statistics.quantiles([b / a for a, b in rounds], n=4, method="inclusive")
            before, after = (statistics.median(times) for times in zip(*rounds, strict=True))
            busy = "" if seen["steal"] <= machine.STEAL else f"; the host took {seen['steal']:.2f} cores"
            print(
                f"{load.key} x{threads}: {before:.1f}, {after:.1f}; {middle:.3f} ({below:.3f}-{above:.3f})"
                f" in {len(rounds)} rounds{busy}",
                flush=True,
            )


def _rounds(
    old: subprocess.Popen[str], new: subprocess.Popen[str], steps: int, n: int
) -> list[tuple[float, float]]:
    """Times of both a particle-step [ns], round by round."""
    for one in (old, new):
        _line(one)  # ready
    found = []
    for k in range(n):
        if k % 2:
            after, before = _timed(new, steps), _timed(old, steps)
        else:
            before, after = _timed(old, steps), _timed(new, steps)
        found.append((before, after))
    return found


def _timed(child: subprocess.Popen[str], steps: int) -> float:
    assert child.stdin is not None
    child.stdin.write(f"{steps}\n")
    child.stdin.flush()
    return float(_line(child))


def _line(child: subprocess.Popen[str]) -> str:
    assert child.stdout is not None
    line = child.stdout.readline()
    if not line:
        raise SystemExit("one of the two processes ended; its message stands above")
    return line


def _stepper(
    tree: Path, load: workloads.Workload, path: Path, threads: int, cores: list[int], options: Any
) -> subprocess.Popen[str]:
    """Process that steps the grains of a workload with the sources of a tree."""
    cache = (options.work / "compiled" / tree.name).resolve()
    return subprocess.Popen(
        [
            *("taskset", "-c", ",".join(str(core) for core in cores), sys.executable, __file__),
            *(CHILD, str(tree), load.key, str(path), str(threads), str(options.exact)),
        ],
        env={**os.environ, "PYTHONPATH": str(tree / "src"), "NUMBA_CACHE_DIR": str(cache)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def child(tree: str, key: str, path: str, threads: int, exact: float) -> None:
    """Step as often as each line of the input says, and answer with ns a particle-step."""
    sys.path.insert(0, str(Path(tree) / "benchmarks"))  # each tree builds the scene and makes its engine
    import accuracy
    import prepare

    import ryusa

    if not Path(ryusa.__file__).is_relative_to(tree):
        raise SystemExit(f"{ryusa.__file__} was imported, which is not of {tree}")
    load = workloads.named(key)
    more = {"dt": accuracy.contact()[0] / exact, "timing": "exact"} if exact else {}
    scene, state = prepare.free_scene(
        workloads.Grains.load(path), workloads.TOTAL, load.slope, plane=load.plane, **more
    )
    engine = prepare.CpuEngine(threads=threads)
    engine.load(scene, state)
    engine.advance(STEPS[load.size]).raise_if_any()
    print("ready", flush=True)
    clock = time.process_time if threads == 1 else time.perf_counter
    for line in sys.stdin:
        begun = clock()
        engine.advance(int(line)).raise_if_any()
        print(1e9 * (clock() - begun) / int(line) / scene.n_grain, flush=True)


def _tree(word: str) -> Path:
    path = Path(word).resolve()
    if not (path / "src" / "ryusa").is_dir():
        raise argparse.ArgumentTypeError(f"{word} is no checkout of ryusa: it has no src/ryusa")
    return path


def _workload(key: str) -> workloads.Workload:
    try:
        load = workloads.named(key)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if load.size not in STEPS or load.column:
        raise argparse.ArgumentTypeError(f"{key} is not compared: dry, of size {', '.join(STEPS)}")
    return load


if __name__ == "__main__":
    if sys.argv[1:2] == [CHILD]:
        _, _, its_tree, its_key, its_path, its_threads, its_exact = sys.argv
        child(its_tree, its_key, its_path, int(its_threads), float(its_exact))
    else:
        main()
