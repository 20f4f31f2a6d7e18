"""Does a result depend on the time step? Averages of the packaged cases at few and at many steps per contact.

    python benchmarks/steps.py [--only heap saltation] [--seeds 3] [--jobs 2] [--out FILE]

Every case runs with contacts that begin and end at steps, 50 steps to the shortest contact, and with exact
timing at 12, 10 and 8, each with the same seeds. A number is the mean over seeds; its standard error is the
larger of the scatter between the seeds and the pooled errors of the averages themselves.

Asked, written down before the first run: of all differences to 50 steps, at most one in ten is larger than
twice its standard error, and none larger than four times.
"""

import argparse
import json
import math
import shutil
import statistics
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import machine
import numpy as np

import ryusa
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.results import Results

Numbers = dict[str, tuple[float, float]]  # by name: value and standard error (0 where unknown)
REFERENCE = "50 at steps"
SETTINGS = {
    REFERENCE: {"contact.timing": "at steps", "time.steps_per_contact": "50"},
    "12 exact": {"contact.timing": "exact", "time.steps_per_contact": "12"},
    "10 exact": {"contact.timing": "exact", "time.steps_per_contact": "10"},
    "8 exact": {"contact.timing": "exact", "time.steps_per_contact": "8"},
}
# Standard errors, and the share of differences that may be beyond the first.
LIMIT, FAR, SHARE = 2.0, 4.0, 0.1


@dataclass(frozen=True)
class Sample:
    """A packaged case, the measures whose averages are compared, and keys that make it shorter."""

    measures: tuple[str, ...] = ()
    keys: tuple[tuple[str, str], ...] = ()


CASES = {
    "saltation": Sample(("saltation",)),
    "heap": Sample(("surface",)),
    "dense_plane": Sample(),
    "dense_3d": Sample((), (("build.columns", "8"), ("build.rows", "8"))),
    "settling_column": Sample((), (("stop.time", "0.3 s"),)),
    "movable_bed": Sample(("transport", "entrainment")),
    "bedload_3d": Sample(("transport", "entrainment")),
    "sheet_flow": Sample(("transport",)),
    "debris_equilibrium": Sample(("transport",)),
}


def numbers(run: Results, sample: Sample) -> Numbers:
    """Averages of the measures, and of all grains over the second half of the frames."""
    late = np.arange(len(run.frames)) >= len(run.frames) // 2  # by number: times differ by up to a step
    speed = [float(np.sqrt((v**2).sum(axis=1)).mean()) for v in run.frames.v[late]]
    found: Numbers = {
        "mean speed": (statistics.mean(speed), 0.0),
        "mean height": (float(np.mean([x[:, 2].mean() for x in run.frames.x[late]])), 0.0),
        "contacts": (float(np.mean(run.tally["n_contact"][late])), 0.0),
    }
    for name in sample.measures:
        measured = run.measure(name)
        if name == "surface":
            found["slope"] = (float(measured.angle), 0.0)
        else:
            found |= {one.name: (float(one.value), float(one.error)) for one in measured.averages.items}
    return found


def one_run(name: str, setting: str, seed: int, folder: Path) -> Numbers:
    """Numbers of one run; kept, so that an interrupted comparison goes on."""
    kept = folder / f"{name}, {setting}, {seed}.json"
    if kept.exists():
        return {key: (value, error) for key, (value, error) in json.loads(kept.read_text()).items()}
    sample = CASES[name]
    keys = dict(sample.keys) | SETTINGS[setting] | {"seed": str(seed)}
    run = ryusa.run(read(case_path(f"{name}.toml"), keys), folder / kept.stem, progress=False, overwrite=True)
    found = numbers(run, sample)
    kept.write_text(json.dumps(found))
    shutil.rmtree(folder / kept.stem)
    return found


def pooled(runs: list[Numbers], name: str) -> tuple[float, float]:
    """Mean over seeds and its standard error."""
    values, errors = zip(*(one[name] for one in runs), strict=True)
    scatter = statistics.stdev(values) / math.sqrt(len(values)) if len(values) > 1 else math.inf
    own = math.sqrt(sum(error**2 for error in errors)) / len(errors)
    return statistics.mean(values), max(scatter, own)


def table(found: dict[tuple[str, str], list[Numbers]], names: list[str]) -> tuple[list[str], list[float]]:
    """Lines of Markdown, and every difference in standard errors."""
    others = [one for one in SETTINGS if one != REFERENCE]
    lines = [f"| case | number | {REFERENCE} | {' | '.join(others)} |", "|---" * (3 + len(others)) + "|"]
    apart: list[float] = []
    for name in names:
        for number in found[name, REFERENCE][0]:
            middle, error = pooled(found[name, REFERENCE], number)
            cells: list[str] = []
            for setting in others:
                value, other = pooled(found[name, setting], number)
                both = math.hypot(error, other)
                z = (value - middle) / both if both > 0.0 else 0.0
                apart.append(abs(z))
                cells.append(f"{value:.4g} ± {other:.2g} ({z:+.1f})")
            lines.append(f"| {name} | {number} | {middle:.4g} ± {error:.2g} | {' | '.join(cells)} |")
    return lines, apart


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--work", type=Path, default=Path("build/benchmarks/steps"))
    parser.add_argument("--out", type=Path, default=Path("build/benchmarks/steps.md"))
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    jobs = [
        (name, setting, seed)
        for name in options.only
        for setting in SETTINGS
        for seed in range(1, options.seeds + 1)
    ]
    with ProcessPoolExecutor(options.jobs) as pool:
        runs = list(pool.map(one_run, *zip(*jobs, strict=True), [options.work] * len(jobs)))
    found: dict[tuple[str, str], list[Numbers]] = {}
    for (name, setting, _), one in zip(jobs, runs, strict=True):
        found.setdefault((name, setting), []).append(one)
    lines, apart = table(found, options.only)
    beyond, farthest = sum(z > LIMIT for z in apart), max(apart)
    verdict = "kept" if beyond <= SHARE * len(apart) and farthest <= FAR else "not kept"
    lines += [
        "",
        f"{beyond} of {len(apart)} differences are beyond {LIMIT:g} standard errors, the largest is "
        f"{farthest:.1f}; asked: at most {SHARE:.0%}, none beyond {FAR:g}: {verdict}. {options.seeds} seeds.",
    ]
    options.out.write_text(f"{machine.describe()}\n\n" + "\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
