"""Are averages of a flow the same with LAMMPS as with the CPU engine? Three packaged cases.

    python benchmarks/averages.py [--only dense_3d] [--seeds 12] [--cpu-seeds 12] [--first-seed 1] [--ranks 2]

Single paths part after some collisions, so that only averages can be compared. Every case runs with the
settings that LAMMPS carries, the CPU engine with the same: `mpirun -np 2 ryusa run CASE --engine lammps
--set ..` and `ryusa run CASE --set ..`. Cases are smaller, softer and shorter than packaged, as `CASES` says,
so that many seeds can be run: both engines see the same flow, not the developed one. What is done is kept in
the work folder `--work`, and not done again.

Asked, written down before the seeds are run. Of every number the means over seeds are compared:

- *same*: of all ways to divide the runs among the engines, the share that sets the means as far apart as
  they are, the `chance`, is above 0.05 over the number of numbers. If the flows are equal the division means
  nothing, so that all numbers together pass in 95 of 100 comparisons, however the seeds scatter;
- *resolved*: half the 95 % interval of the difference, by Student with the scatter of both engines taken as
  one, is smaller than the share of the mean that is written beside the number. A number that is not says
  nothing either way, and is reported as not resolved.

The first comparison, with 6 and 3 seeds, took Student's limit for *same* as well. It is still shown, and
decides nothing: it supposes a normal scatter, and seven degrees of freedom do not tell how wide it is.
"""

import argparse
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import machine
import numpy as np
from scipy.stats import permutation_test
from scipy.stats import t as student

from ryusa.cases import case_path
from ryusa.measure import profiles, transport
from ryusa.results import Results
from ryusa_studies.validation.equilibrium import flowing

Numbers = dict[str, float]
CARRIED = {"contact.timing": "at steps", "contact.slip": "total", "contact.cap": "total"}
FAMILY = 0.05  # chance that equal flows show any difference beyond the limit


@dataclass(frozen=True)
class Sample:
    """A packaged case, keys that make it smaller, and what is measured.

    Attributes
    ----------
    keys : on top of `CARRIED`.
    measure : numbers of a run folder.
    resolved : of each number, the share of its mean within which a difference is asked to be known.
    """

    keys: dict[str, str]
    measure: Callable[[Results], Numbers]
    resolved: Numbers


def dense(run: Results) -> Numbers:
    """Profile of a dense dry flow: speed and concentration below and above, and fluctuations.

    The flow still speeds up. A variance about the mean of the whole time holds the speeding up, so the
    temperature is also taken about the profile of each frame.
    """
    found = profiles(run, layer=1.0, above="bed crest")
    each = [profiles(run, t, t, layer=1.0, above="bed crest") for t in found.t.tolist()]
    late = np.asarray(run.frames.t) >= found.t[0]
    heights = [float(np.mean(x[:, 2])) for x, there in zip(run.frames.x, late, strict=True) if there]
    return {
        "speed": float(np.mean(found.speed)),
        "speed 3 d above the bed": _at(found.z, found.v_x.value, 3.0 * found.d),
        "speed 7 d above the bed": _at(found.z, found.v_x.value, 7.0 * found.d),
        "concentration 3 d above the bed": _at(found.z, found.phi.value, 3.0 * found.d),
        "concentration 7 d above the bed": _at(found.z, found.phi.value, 7.0 * found.d),
        "temperature 5 d above the bed": _at(found.z, found.temperature_x.value, 5.0 * found.d),
        "temperature in a frame 5 d above the bed": float(
            np.mean([_at(one.z, one.temperature_x.value, 5.0 * one.d) for one in each])
        ),
        "mean height": float(np.mean(heights)),
    }


def bedload(run: Results) -> Numbers:
    """Transport rate, the layer that carries it, and the water above."""
    found, water = transport(run), run.water
    assert water is not None
    late = water.t >= found.t[0]
    surface, u = float(water.z_surface[late].mean()), water.u[late].mean(axis=0)
    return {
        "q_star": float(found.averages["q_star"].value),
        "layer_thickness": float(found.averages["layer_thickness"].value),
        "layer_high": float(found.averages["layer_high"].value),
        "tau_star": float(found.tau_star),
        "speed of the water at half depth": _at(water.z, u, 0.5 * (surface + float(water.faces[0]))),
        "speed of grains": float(np.mean(profiles(run).speed)),
    }


def debris(run: Results) -> Numbers:
    """Concentration, depth and speed of what flows, and the friction at its bed."""
    found, flux = flowing(run), profiles(run)
    return {
        "concentration": found["c"],
        "depth over d": found["depth"],
        "speed of the surface": found["speed"],
        "stress of grains over weight": found["mu"],
        "flux": float(np.mean(flux.q)),
        "speed of grains": float(np.mean(flux.speed)),
    }


def _at(z: np.ndarray, values: np.ndarray, height: float) -> float:
    return float(np.interp(height, z, values))


CASES = {
    "dense_3d": Sample(
        {
            "build.columns": "8", "build.rows": "8", "contact.stiffness": "20 N/cm",
            "contact.shear_stiffness": "1.5 N/cm", "contact.damping": "0.00032 N s/cm",
            "contact.shear_damping": "0.000032 N s/cm", "timeline.0.at": "0.1 s", "record.settle": "0.3 s",
            "stop.time": "0.5 s", "record.frames": "10 ms",
        },
        dense,
        {
            "speed": 0.2, "speed 3 d above the bed": 0.3, "speed 7 d above the bed": 0.2,
            "concentration 3 d above the bed": 0.05, "concentration 7 d above the bed": 0.05,
            "temperature 5 d above the bed": 0.3, "temperature in a frame 5 d above the bed": 0.2,
            "mean height": 0.02,
        },
    ),
    "bedload_3d": Sample(
        {
            "contact.stiffness": "15 N/cm", "record.settle": "0.8 s", "stop.time": "2 s",
            "record.frames": "20 ms",
        },
        bedload,
        {
            "q_star": 0.3, "layer_thickness": 0.15, "layer_high": 0.05, "tau_star": 0.1,
            "speed of the water at half depth": 0.05, "speed of grains": 0.3,
        },
    ),
    "debris_equilibrium": Sample(
        {
            "contact.stiffness": "10 N/cm", "record.settle": "1.25 s", "stop.time": "2.5 s",
            "record.frames": "20 ms",
        },
        debris,
        {
            "concentration": 0.1, "depth over d": 0.1, "speed of the surface": 0.15,
            "stress of grains over weight": 0.1, "flux": 0.25, "speed of grains": 0.25,
        },
    ),
}  # fmt: skip


def one_run(name: str, ranks: int, seed: int, work: Path) -> Numbers:
    """Numbers of one run, with 0 ranks for the CPU engine; and the time it took."""
    kept, sample = work / f"{name}-{ranks}-{seed}.json", CASES[name]
    if kept.exists():
        return json.loads(kept.read_text())
    folder = kept.with_suffix("")
    engine = ["--engine", "lammps"] if ranks else []
    settings = [word for key, one in (CARRIED | sample.keys).items() for word in ("--set", f"{key}={one}")]
    words = ["run", str(case_path(f"{name}.toml")), *engine, *settings, "--seed", str(seed)]
    mpirun = shutil.which("mpirun", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if ranks and mpirun is None:
        sys.exit("there is no mpirun beside Python or on the path: pip install 'ryusa[mpi]'")
    begin = [mpirun, "-np", str(ranks)] if ranks and mpirun else []
    options = ["-o", str(folder), "--overwrite", "--quiet", "--checkpoint", "never"]
    subprocess.run([*begin, sys.executable, "-m", "ryusa", *words, *options], check=True)
    run = Results.open(folder)
    found = {**sample.measure(run), "wall": float(run.summary["wall"])}
    kept.write_text(json.dumps(found))
    return found


@dataclass(frozen=True)
class Difference:
    """Means of one number with both engines, and what their difference says."""

    cpu: float
    lammps: float
    error: float  # standard error of the difference
    limit: float  # of the difference over its error, by Student
    half: float  # half the 95 % interval of the difference
    chance: float  # share of the divisions of all runs that set the means as far apart
    least: float  # of the chance

    @property
    def over_error(self) -> float:
        """The difference over its standard error."""
        apart = self.lammps - self.cpu
        return (
            0.0
            if apart == 0.0
            else math.copysign(math.inf, apart)
            if self.error == 0.0
            else apart / self.error
        )

    def verdict(self, resolved: float) -> str:
        """Same, not the same, or not known well enough."""
        if self.chance <= self.least:
            return "**differs**"
        return "same" if self.half <= resolved * abs(self.cpu) else "not resolved"


def difference(cpu: list[float], lammps: list[float], n_number: int) -> Difference:
    """Compare the means of two samples of seeds.

    Parameters
    ----------
    n_number : numbers that are compared in all.
    """
    n = len(cpu), len(lammps)
    free = sum(n) - 2
    scatter = math.sqrt(sum(statistics.variance(one) * (len(one) - 1) for one in (cpu, lammps)) / free)
    error = scatter * math.sqrt(1.0 / n[0] + 1.0 / n[1])
    return Difference(
        statistics.mean(cpu), statistics.mean(lammps), error,
        float(student.ppf(1.0 - FAMILY / (2.0 * n_number), free)), float(student.ppf(0.975, free)) * error,
        _chance(cpu, lammps), FAMILY / n_number,
    )  # fmt: skip


def _chance(one: list[float], other: list[float]) -> float:
    """Share of the divisions of two samples that set their means as far apart: all, or 100,000 of them."""

    def apart(x: np.ndarray, y: np.ndarray, axis: int) -> np.ndarray:
        return x.mean(axis=axis) - y.mean(axis=axis)

    found = permutation_test((one, other), apart, vectorized=True, n_resamples=99_999, rng=1)
    return float(found.pvalue)


def refuse_too_few(n_cpu: int, n_lammps: int, n_number: int) -> None:
    """End the program where no difference, however large, could be told."""
    if 2.0 / math.comb(n_cpu + n_lammps, n_cpu) > FAMILY / n_number:
        sys.exit(
            f"--seeds {n_lammps} and --cpu-seeds {n_cpu} cannot show that any of {n_number} numbers differs: "
            "6 of each can show it of up to 23"
        )


def table(found: dict[str, tuple[list[Numbers], list[Numbers]]]) -> list[str]:
    """Lines of Markdown, and the verdict."""
    n_number = sum(len(CASES[name].resolved) for name in found)
    lines = [
        "| case | mean over seeds | CPU engine | LAMMPS | difference over its error | chance | least "
        "| known within | asked | verdict |",
        "|---" * 10 + "|",
    ]
    verdicts: list[str] = []
    for name, (cpu, lammps) in found.items():
        for number, resolved in CASES[name].resolved.items():
            one = difference([run[number] for run in cpu], [run[number] for run in lammps], n_number)
            verdicts.append(one.verdict(resolved))
            apart, half = f"{one.over_error:+.1f} of {one.limit:.1f}", 100.0 * one.half / abs(one.cpu)
            lines.append(
                f"| {name} | {number} | {one.cpu:.4g} | {one.lammps:.4g} | {apart} | {one.chance:.2g} "
                f"| {one.least:.2g} | {half:.1f} % "
                f"| {100.0 * resolved:g} % | {verdicts[-1]} |"
            )
    said = ", ".join(f"{verdicts.count(word)} {word}" for word in ("same", "not resolved", "**differs**"))
    return [*lines, "", f"Of {n_number} numbers: {said}."]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--seeds", type=int, default=12, help="of LAMMPS")
    parser.add_argument("--cpu-seeds", type=int, default=12)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--work", type=Path, default=Path("build/benchmarks/averages"))
    options = parser.parse_args()
    refuse_too_few(options.cpu_seeds, options.seeds, sum(len(CASES[name].resolved) for name in options.only))
    options.work.mkdir(parents=True, exist_ok=True)
    found: dict[str, tuple[list[Numbers], list[Numbers]]] = {name: ([], []) for name in options.only}
    for k in range(max(options.seeds, options.cpu_seeds)):
        seed = options.first_seed + k
        for name, (cpu, lammps) in found.items():
            if k < options.cpu_seeds:
                cpu.append(one_run(name, 0, seed, options.work))
            if k < options.seeds:
                lammps.append(one_run(name, options.ranks, seed, options.work))
    about = (
        f"{machine.describe()}; ranks: {options.ranks}; {options.seeds} seeds of LAMMPS and "
        f"{options.cpu_seeds} of the CPU engine, from {options.first_seed} on; load average "
        f"{os.getloadavg()[2]:.1f} in the last 15 minutes"
    )
    wall = {name: [sum(one["wall"] for one in runs) for runs in both] for name, both in found.items()}
    lines = [about, "", f"Wall time of the CPU engine and of LAMMPS in all [s]: {wall}", "", *table(found)]
    (options.work / "averages.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
