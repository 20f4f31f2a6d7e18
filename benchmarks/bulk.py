"""What a simulated second costs at equal error of what a user reads off a flow: averages over many grains.

    python benchmarks/bulk.py errors [--only gas incline] [--seeds 24] [--peer-seeds 8]
    python benchmarks/bulk.py costs [--rounds 5]

Four quantities of 2,000 grains, each from the same first grains in every code:

- gas: kinetic energy left of a dense gas between two walls of fixed grains, without weight, after 5 ms;
- incline: mean speed of a bed of 12 layers that has flowed for 20 ms at 26 deg, 25 ms later;
- settling: kinetic energy left of 12 loose layers that fall on a bed, 60 ms after their release, in which it
  falls by four orders, as the time by which they come to rest too early or too late;
- collapse: by how much a plane column that falls apart has widened 40 ms on.

`errors` steps every code with 5 to 25 steps to the contact of two grains, over seeds, and compares the mean
with that of ryusa with exact timing and 50 steps, each by the slip rule of the peer, seed by seed. The error
of a number of steps is bounded by |mean difference| plus half its 95 % interval. `costs` then times
every code with the fewest steps from which on that bound stays below 3 % and below 1 %, in turn, each at its
best skin, over 20,000 steps at least, so that it is not the end of a run folder that is timed: a gas is a
colder one then. Where seeds do not resolve a bound the step that would do is not known, and the row says so.

No number is asked for: README says what comes out.
"""

import argparse
import json
import math
import statistics
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import machine
import numpy as np
import workloads
from accuracy import FEWEST, contact, cost, tuned
from peer import Job
from peer_lammps import found_lammps, found_liggghts
from peer_ryusa import EXACT, Ryusa
from peer_yade import found_yade
from prepare import free_scene, grains
from scipy.stats import t as student
from speed import run
from workloads import DROP, TOTAL, D, Grains, Workload

from ryusa.engine.cpu.engine import CpuEngine

LADDER = (5, 7, 10, 15, 25)  # steps in the contact of two grains
CONVERGED = 50  # steps of the reference, exact: its error is second order
ASKED = (0.03, 0.01)
NUDGE = 1.0e-3  # of first velocities, by which seeds differ [m/s]
WIDE, LAYERS = 13, 12


@dataclass(frozen=True)
class Quantity:
    """One thing to measure: what is stepped, for how long, and the number that is read off.

    Attributes
    ----------
    time : stepped [s].
    more : after which it is measured again to know how fast it changes [s]; 0 where its size counts.
    """

    load: Workload
    time: float
    more: float = 0.0

    def first(self, seed: int, work: Path) -> Path:
        """File with the first grains of a seed."""
        path = work / "bulk" / f"{self.load.name}-{seed}.npz"
        if not path.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
            rng = np.random.default_rng(seed)
            if self.load.name in ("gas", "settling"):
                found = loose(self.load.name == "gas", rng)
            else:
                found = Grains.load(str(grains(self.load, work / "grains", 1)))
                nudge = rng.normal(0.0, NUDGE, found.v.shape)
                if self.load.plane:
                    nudge[:, 1] = 0.0
                found = replace(found, v=found.v + nudge)
            found.save(str(path))
        return path

    def of(self, first: Grains, x: np.ndarray, v: np.ndarray) -> float:
        """The number, from the first grains, and centres [m] and velocities [m/s] at the end."""
        if self.load.name == "W1":
            return float(v[:, 0].mean())
        wider = float(x[:, 0].std() - first.x[:, 0].std())
        return wider if self.load.plane else float((v**2).sum(axis=1).mean())


def loose(gas: bool, rng: np.random.Generator) -> Grains:
    """Grains on a loose lattice over a floor of fixed ones, and under such a ceiling where they are a gas."""
    pitch = (1.35 if gas else 1.25) * D
    side = np.arange(WIDE)
    i, j, k = (one.ravel() for one in np.meshgrid(side, side, np.arange(LAYERS), indexing="ij"))
    x = pitch * np.column_stack([i + 0.5, j + 0.5, k + 1.0]).astype(float)
    x += rng.uniform(-0.1, 0.1, x.shape) * D
    v = rng.normal(0.0, 0.5 if gas else 0.01, x.shape)
    v -= v.mean(axis=0)
    n = math.floor(WIDE * pitch / D)
    at = WIDE * pitch / n * (np.arange(n) + 0.5)
    a, b = (one.ravel() for one in np.meshgrid(at, at, indexing="ij"))
    floor = np.column_stack([a, b, 0.0 * a])
    floor[:, 2] = rng.uniform(-0.2, 0.0, len(a)) * D
    above = [floor + np.array((0.0, 0.0, pitch * (LAYERS + 1.0) + 0.2 * D))] if gas else []
    fixed = np.vstack([floor, *above])
    period = (WIDE * pitch, WIDE * pitch)
    return Grains(x, v, np.zeros_like(x), np.full(len(x), D), fixed, np.full(len(fixed), D), period)


QUANTITIES = {
    "gas": Quantity(Workload("gas", "dense gas", "2k", 0.0), 5e-3),
    "incline": Quantity(workloads.workload("W1", "2k"), 25e-3),
    "settling": Quantity(Workload("settling", "loose layers fall", "2k", 0.0), 60e-3, 10e-3),
    "collapse": Quantity(workloads.workload("W3", "2k"), 40e-3),
}


def step_of(steps: float, time: float) -> tuple[float, int]:
    """Time step [s] with so many steps in a contact, or a little shorter, and how many of them there are."""
    count = math.ceil(time * steps / contact()[0])
    return time / count, count


def ours(one: Quantity, code: Ryusa, steps: float, seed: int, work: Path, time: float) -> float:
    """The number by ryusa's engine."""
    dt, count = step_of(steps, time)
    kept, load = Grains.load(str(one.first(seed, work))), one.load
    engine = CpuEngine(threads=1)
    engine.load(
        *free_scene(
            kept, code.slip, load.slope, plane=load.plane, dt=dt, timing=code.timing, gravity=load.gravity
        )
    )
    engine.advance(count).raise_if_any()
    x, v, _ = engine.kinematics()
    return one.of(kept, x, v)


def theirs(one: Quantity, code: Any, steps: float, seed: int, work: Path) -> float:
    """The number by another code; what it computes only for the clock is left out."""
    dt, count = step_of(steps, one.time)
    first = one.first(seed, work)
    final = work / "bulk" / f"{code.name}-{one.load.name}-{steps}-{seed}.npz"
    run(code, Job(one.load, first, 1, 1, count - 1, final=final, dt=dt), work)
    with np.load(final) as kept:
        found = one.of(Grains.load(str(first)), kept["x"], kept["v"])
    final.unlink()
    return found


def numbers(name: str, codes: dict[str, Any], options: Any) -> dict[str, Any]:
    """Numbers of every code, number of steps and seed; kept as they come."""
    one, path = QUANTITIES[name], options.work / "bulk" / f"{name}.json"
    found: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    wanted = [
        (f"{slip}, converged{late}", Ryusa(slip, EXACT), CONVERGED, options.seeds, one.time + more)
        for slip in (TOTAL, DROP)
        for late, more in (("", 0.0), (", later", one.more))
        if not late or more
    ]
    for label, code in codes.items():
        seeds = options.seeds if isinstance(code, Ryusa) else options.peer_seeds
        seeds = min(seeds, 3) if label == "YADE" else seeds
        wanted += [(f"{label}, {steps}", code, steps, seeds, one.time) for steps in LADDER]
    path.parent.mkdir(parents=True, exist_ok=True)
    for label, code, steps, seeds, time in wanted:
        known = found.setdefault(label, [])
        left = range(len(known), seeds)

        def number(seed: int, code: Any = code, steps: float = steps, time: float = time) -> float:
            if isinstance(code, Ryusa):
                return ours(one, code, steps, seed, options.work, time)
            return theirs(one, code, steps, seed, options.work)

        with ThreadPoolExecutor(options.jobs) as pool:
            known += pool.map(number, left)
        path.write_text(json.dumps(found))
        print(f"    {name}: {label}: {statistics.mean(known):.5g}", flush=True)
    return found


def bound(one: Quantity, seen: list[float], exact: list[float], later: list[float]) -> tuple[float, float]:
    """Mean error over seeds, and half its 95 % interval; of a settling in parts of its time.

    Seeds are paired: the same first grains give much of what scatters.
    """
    n = min(len(seen), len(exact))
    a, b = np.array(seen[:n]), np.array(exact[:n])
    off = np.log(a / b) if one.more else (a - b) / np.mean(b)
    if one.more:
        off /= np.mean(np.log(np.array(exact) / np.array(later))) / one.more * one.time
    half = float(student.ppf(0.975, n - 1)) * float(np.std(off, ddof=1)) / math.sqrt(n)
    return float(np.mean(off)), half


def judged(name: str, codes: dict[str, Any], found: dict[str, Any]) -> dict[str, Any]:
    """Errors of every code along the ladder, and the fewest steps within each bound."""
    one, rows = QUANTITIES[name], {}
    for label, code in codes.items():
        exact = found[f"{code.slip}, converged"]
        later = found.get(f"{code.slip}, converged, later", [])
        errors = {steps: bound(one, found[f"{label}, {steps}"], exact, later) for steps in LADDER}
        row: dict[str, Any] = {
            "errors": {str(steps): [round(off, 5), round(half, 5)] for steps, (off, half) in errors.items()}
        }
        for asked in ASKED:
            good = [
                steps
                for k, steps in enumerate(LADDER)
                if all(abs(errors[s][0]) + errors[s][1] <= asked for s in LADDER[k:])
            ]
            row[f"{asked:g}"] = good[0] if good else None
        rows[label] = row
    return rows


def found_codes(options: Any) -> dict[str, list[Any]]:
    """ryusa by every rule and timing, and the peers that are installed, by name; their builds."""
    peers: dict[str, list[Any]] = {}
    for build in [*found_lammps(options.work.parent / "peers"), *found_liggghts(), *found_yade()]:
        if options.peers is None or build.name in options.peers:
            peers.setdefault(build.name, []).append(build)
    mine = [Ryusa(slip, timing) for slip in (TOTAL, DROP) for timing in (EXACT, "at steps")]
    return {one.name: [one] for one in mine} | peers


def cost_rows(name: str, judgement: dict[str, Any], codes: dict[str, list[Any]], options: Any) -> list[Any]:
    """Costs of a simulated second at each bound, in turn."""
    one, rows = QUANTITIES[name], []
    for asked in ASKED:
        jobs: dict[str, tuple[Any, Job]] = {}
        for label, builds in codes.items():
            steps = judgement[label][f"{asked:g}"]
            if steps is None:
                continue
            dt, count = step_of(steps, one.time)
            count = max(math.ceil(builds[0].share * count), 10 * FEWEST)
            job = Job(one.load, one.first(0, options.work), 1, max(count // 10, 2), count, dt=dt)
            jobs[label] = tuned(builds, job, options.work)
        watch, names = machine.Watch(), list(jobs)
        watch.begin()
        rounds = []
        for k in range(options.rounds):
            turn = k % max(len(names), 1)
            rounds.append({n: cost(*jobs[n], options.work) for n in [*names[turn:], *names[:turn]]})
        medians = {n: statistics.median(r[n] for r in rounds) for n in names}
        best = {
            n: statistics.median(r[n] / r[Ryusa(codes[n][0].slip, EXACT).name] for r in rounds)
            for n in names
            if Ryusa(codes[n][0].slip, EXACT).name in names
        }
        rows.append(
            {
                "quantity": name,
                "error": asked,
                **watch.end(),
                "s per simulated s": medians,
                "over exact": best,
            }
        )
        print(
            f"{name}, {asked:.0%}: "
            + ", ".join(f"{n} at {judgement[n][f'{asked:g}']}: {medians[n]:.2f} s" for n in names),
            flush=True,
        )
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("errors", "costs"))
    parser.add_argument("--only", nargs="+", choices=QUANTITIES, default=list(QUANTITIES))
    parser.add_argument("--seeds", type=int, default=24, help="of ryusa")
    parser.add_argument("--peer-seeds", type=int, default=8, help="of the others; YADE 3")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time, of errors")
    parser.add_argument("--peers", nargs="+", help="names of codes, all that are found when not given")
    parser.add_argument("--work", type=Path, default=Path("build/benchmarks"))
    parser.add_argument("--out", type=Path, default=Path("build/benchmarks/bulk.json"))
    options = parser.parse_args()
    options.work = options.work.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    builds = found_codes(options)
    codes = {label: one[0] for label, one in builds.items()}
    kept: dict[str, Any] = json.loads(options.out.read_text()) if options.out.exists() else {}
    for name in options.only:
        if options.what == "errors":
            kept.setdefault("errors", {})[name] = judged(name, codes, numbers(name, codes, options))
        elif name not in kept.get("errors", {}):
            sys.exit(f"the errors of {name} are not known: python benchmarks/bulk.py errors --only {name}")
        else:
            kept.setdefault("costs", {})[name] = cost_rows(name, kept["errors"][name], builds, options)
        kept["machine"] = machine.describe()
        kept["versions"] = {label: one.version() for label, one in codes.items()}
        options.out.write_text(json.dumps(kept, indent=1) + "\n")
    print(f"wrote {options.out}")


if __name__ == "__main__":
    main()
