"""What a simulated second costs at equal accuracy: of the restitution, at the worst phase of the first step.

    python benchmarks/accuracy.py [--only W1-2k W2-2k] [--errors 0.01] [--threads 1] [--rounds 5] [--out FILE]

How large a step may be is decided by the scatter of a restitution with the instant of first touch within a
step. First every code lets forty pairs of grains collide head-on, each at another phase, with more and more
steps in the contact: the fewest steps from which on the worst error of e stays below 1 % and below 0.1 %.
Then every code steps the same grains with its own step for the same simulated time, and at least 2000 steps,
in turn, round after round, each at its best skin. Law, grains, frames and log are those of the table
(README.md).
"""

import argparse
import json
import math
import os
import statistics
from dataclasses import replace
from pathlib import Path
from typing import Any

import machine
import numpy as np
import workloads
from peer import Job, PeerError
from peer_lammps import found_lammps, found_liggghts
from peer_ryusa import EXACT, Ryusa
from peer_yade import found_yade
from prepare import grains
from speed import run
from workloads import DROP, ETA_N, K_N, TOTAL, D, Grains, Workload

from ryusa.laws import collision

PHASES = 40
SPEED = 0.1  # of approach [m/s]
LADDER = (5, 6, 8, 10, 12, 15, 20, 25, 30, 40, 50, 70, 100, 150, 200, 300, 400, 600)
ASKED = (0.01, 0.001)  # worst error of e
SIMULATED = 50.0e-3  # [s] at 2k grains, less where there are more
FEWEST = 2000  # steps, so that stepping is timed and not the end of the run folder
SKINS = (0.025, 0.05, 0.1, 0.2, 0.3)
ONLY = ("W1-2k", "W2-2k", "W3-2k", "W1-20k", "W2-20k", "W3-20k")


def contact() -> tuple[float, float]:
    """Duration of a contact of two free grains [s], and its restitution, both in closed form."""
    m = 0.5 * workloads.DENSITY * math.pi / 6.0 * D**3
    zeta = collision.damping_ratio(ETA_N, K_N, m)
    return (
        collision.contact_time_no_tension(zeta, collision.omega_natural(K_N, m)),
        collision.restitution_no_tension(zeta),
    )


def pairs(dt: float) -> Grains:
    """Pairs far apart that meet head-on after three steps and a fraction, each pair another."""
    gap = (3.0 + (np.arange(PHASES) + 0.5) / PHASES) * SPEED * dt
    first = np.zeros((PHASES, 3))
    first[:, 1] = 20.0 * D * np.arange(PHASES)
    second = first + np.array([1.0, 0.0, 0.0]) * (D + gap)[:, None]
    v = np.zeros((2 * PHASES, 3))
    v[:PHASES, 0], v[PHASES:, 0] = 0.5 * SPEED, -0.5 * SPEED
    # a fixed grain far away: a code may want one
    away = np.array([[0.0, -40.0 * D, 0.0]])
    still, inf = np.zeros((2 * PHASES, 3)), math.inf
    return Grains(
        np.vstack([first, second]), v, still, np.full(2 * PHASES, D), away, np.full(1, D), (inf, inf)
    )


def worst_error(code: Any, steps: float, work: Path) -> float:
    """Largest error of e over all phases, with so many steps in a contact."""
    t_col, e = contact()
    dt = t_col / steps
    path, final = work / "pairs.npz", work / "final.npz"
    pairs(dt).save(str(path))
    job = Job(
        workloads.workload("W2", "1k"), path, 1, 1, math.ceil(2.0 * steps) + 8, skin=0.5, final=final, dt=dt
    )
    run(code, job, work)
    with np.load(final) as kept:
        v = kept["v"][:, 0]
    return float(np.abs((v[PHASES:] - v[:PHASES]) / SPEED - e).max())


def fewest_steps(code: Any, work: Path) -> dict[str, Any]:
    """Worst errors along the ladder, and the fewest steps from which on each error asked is kept."""
    errors = {steps: worst_error(code, steps, work) for steps in LADDER}
    found: dict[str, Any] = {}
    for asked in ASKED:
        good = [steps for k, steps in enumerate(LADDER) if max(errors[n] for n in LADDER[k:]) <= asked]
        if good and good[0] > LADDER[0]:  # between two rungs the error falls
            below = LADDER[LADDER.index(good[0]) - 1]
            while good[0] - below > 1:
                middle = (good[0] + below) // 2
                errors[middle] = worst_error(code, middle, work)
                good[0], below = (middle, below) if errors[middle] <= asked else (good[0], middle)
        found[f"{asked:g}"] = good[0] if good else None
    return found | {"errors": {str(steps): float(f"{errors[steps]:.2e}") for steps in sorted(errors)}}


def cost(code: Any, job: Job, work: Path) -> float:
    """Wall time of a simulated second [s]."""
    return float(run(code, job, work).loop) / (job.steps * job.dt)


def tuned(builds: list[Any], job: Job, work: Path) -> tuple[Any, Job]:
    """Fastest build, and its best skin."""
    if not builds[0].skins:  # ryusa finds its own
        return builds[0], job
    short = replace(job, steps=max(job.steps // 4, 20))
    build = min(builds, key=lambda one: cost(one, replace(short, skin=SKINS[2]), work))
    skin = min(SKINS, key=lambda one: cost(build, replace(short, skin=one), work))
    return build, replace(job, skin=skin)


def row(
    load: Workload, asked: float, steps: dict[str, Any], codes: dict[str, list[Any]], options: Any
) -> dict[str, Any]:
    """Costs of a simulated second of every code, round by round, and ratios within a round."""
    work = options.work
    path = grains(load, work / "grains", len(os.sched_getaffinity(0)))
    n, t_col = len(Grains.load(str(path)).x), contact()[0]
    simulated = SIMULATED * min(1.0, 2000 / n)
    jobs: dict[str, tuple[Any, Job]] = {}
    for name, builds in codes.items():
        per_contact = steps[name][f"{asked:g}"]
        if per_contact is None:
            continue
        dt = t_col / per_contact
        share = builds[0].share
        count = max(math.ceil(share * simulated / dt), FEWEST)
        job = Job(load, path, options.threads, max(count // 5, 2), count, dt=dt)
        try:
            jobs[name] = tuned(builds, job, work)
        except PeerError as error:
            print(f"    {error}", flush=True)
    rounds: list[dict[str, float]] = []
    watch = machine.Watch()
    watch.begin()
    names = list(jobs)
    for k in range(options.rounds):
        turn = k % len(names)
        rounds.append({name: cost(*jobs[name], work) for name in [*names[turn:], *names[:turn]]})
    seen = watch.end()
    ours = {slip: Ryusa(slip, EXACT).name for slip in (TOTAL, DROP)}
    found: dict[str, Any] = {
        "workload": load.key, "grains": n, "threads": options.threads, "error of e": asked, **seen,
        "steps per contact": {name: steps[name][f"{asked:g}"] for name in names},
        "build": {name: jobs[name][0].label for name in names},
        "skin": {name: jobs[name][1].skin for name in names if jobs[name][0].skins},
        "s per simulated s": {name: statistics.median(one[name] for one in rounds) for name in names},
        "ratio": {
            name: statistics.median(one[name] / one[ours[jobs[name][0].slip]] for one in rounds)
            for name in names
        },
    }  # fmt: skip
    figures = ", ".join(
        f"{name} {found['s per simulated s'][name]:.1f} s ({found['ratio'][name]:.2f})" for name in names
    )
    noise = "" if machine.quiet(seen) else f"  not quiet: {seen}"
    print(f"{load.key} x{options.threads}, {asked:.1%}: {figures}{noise}", flush=True)
    return found


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", nargs="+", default=list(ONLY))
    parser.add_argument("--errors", nargs="+", type=float, choices=ASKED, default=list(ASKED))
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--peers", nargs="+", help="names of codes, all that are found when not given")
    parser.add_argument("--work", type=Path, default=Path("build/benchmarks"))
    parser.add_argument("--out", type=Path, default=Path("build/benchmarks/accuracy.json"))
    options = parser.parse_args()
    options.work = options.work.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    loads = [workloads.named(key) for key in options.only]
    found: dict[str, list[Any]] = {}
    for build in [*found_lammps(options.work.parent / "peers"), *found_liggghts(), *found_yade()]:
        if options.peers is None or build.name in options.peers:
            found.setdefault(build.name, []).append(build)
    codes: dict[str, list[Any]] = {}
    for slip in (TOTAL, DROP):
        for one in (Ryusa(slip, EXACT), Ryusa(slip)):
            if slip == TOTAL or any(builds[0].slip == slip for builds in found.values()):
                codes[one.name] = [one]
    codes |= found
    _, e = contact()
    print(f"restitution {e:.4f}; fewest steps per contact, and worst errors of e:")
    steps: dict[str, Any] = {}
    for name, builds in codes.items():
        steps[name] = fewest_steps(builds[0], options.work)
        print(f"    {name}: {steps[name]}", flush=True)
    rows = [row(load, asked, steps, codes, options) for asked in options.errors for load in loads]
    versions = {name: builds[0].version() for name, builds in codes.items()}
    report = {
        "machine": machine.describe(), "versions": versions, "restitution": e, "steps": steps, "rows": rows
    }  # fmt: skip
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(report, indent=1) + "\n")
    print(f"wrote {options.out}")


if __name__ == "__main__":
    main()
