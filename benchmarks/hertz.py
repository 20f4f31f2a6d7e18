"""Speed of elastic spheres beside linear springs: the same packing, in turn, in one process.

    python benchmarks/hertz.py [--grains 2000 20000] [--rounds 9] [--rest]

A bed in periodic space over fixed grains is tilted to 26 deg and left to flow with linear springs; its grains
then go on with each law, the springs forgotten, with the same step. A round times the same steps of every
law once, by the processor's time, in an order that moves on by one; ratios are taken within a round. In a
flow slow contacts of elastic spheres last longer, so that more pairs touch: time a step is what a user
has, time a touching pair what the law costs. With --rest the bed of walls.py stays at rest, where as many
pairs touch with either. Only the seam of an engine is used (`load`, `forget`, `advance`).
"""

import argparse
import json
import math
import os
import statistics
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import walls

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws import collision, hertz
from ryusa.laws.families import ContactTiming
from ryusa.model import ContactLaw, Scene, State
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.scene import EventRule

D, RHO, K_N, E, MU = 2.0e-3, 2650.0, 2.0e4, 0.7, 0.5  # [m], [kg/m3], [N/m], [-], [-]
M = RHO * math.pi / 6.0 * D**3  # [kg]
SPEED, NU = 0.1, 0.25  # at which both have the same contact time [m/s], [-]
LAYERS, STEPS = 12, 25.0  # of grains; in the shortest contact
BEFORE = 12_000  # steps of flow before
WARM, TIMED, PARTS = 300, 600, 6  # steps of each law before the clock and by the clock; parts of these


def laws(k_n: float = K_N) -> dict[str, ContactLaw]:
    """The laws that are compared, of the same contact time as linear springs of a stiffness [N/m]."""
    zeta = collision.zeta_no_tension(E)
    linear = ContactLaw(
        k_n=k_n, k_s=2.0 / 7.0 * k_n, mu=MU, e_n=E, e_s=E, zeta_n=zeta, zeta_s=collision.zeta_tension(E),
        timing=ContactTiming.AT_STEPS,
    )  # fmt: skip
    stiff = hertz.stiffness_hertz_for_time(collision.collision_time(M, k_n), SPEED, M, 0.0, True)
    young = hertz.modulus_for_stiffness(stiff, 0.25 * D, NU)
    elastic = elastic_spheres(
        M, 0.25 * D, youngs_modulus=young, poisson_ratio=NU, speed=SPEED, friction=MU, restitution=E
    )
    return {
        "linear": linear,
        "linear, exact timing": replace(linear, timing=ContactTiming.EXACT),
        "Hertz-Mindlin": elastic,
    }


def flow(n: int, law: ContactLaw, work: Path) -> tuple[Scene, State]:
    """About n grains that flow, without their springs; kept in a file of `work`."""
    rng = np.random.default_rng(3)
    side = max(6, round(math.sqrt(n / LAYERS)))
    pitch = 1.01 * D
    a, b, c = (
        one.ravel() for one in np.meshgrid(np.arange(side), np.arange(side), np.arange(LAYERS), indexing="ij")
    )
    x = np.column_stack([a, b, c + 1.1]) * pitch + rng.uniform(-0.004, 0.004, (len(a), 3)) * D
    under = c == 0
    bed = np.column_stack([a[under] * pitch, b[under] * pitch, rng.uniform(-0.3, 0.0, under.sum()) * D])
    made, first = scene(
        x, D, density=RHO, v=rng.normal(0.0, 0.1, x.shape), x_fixed=bed, d_fixed=D, contact=law,
        slope=math.radians(26.0), period=(side * pitch, side * pitch), events=EventRule.NONE,
        allow_overlap=True, dt=collision.collision_time(0.5 * M, K_N) / STEPS,
    )  # fmt: skip
    kept = work / f"flow-{n}-{BEFORE}.npz"
    if not kept.exists():
        engine = CpuEngine()
        engine.load(made, first)
        engine.advance(BEFORE).raise_if_any()
        now = engine.state()
        work.mkdir(parents=True, exist_ok=True)
        np.savez(kept, x=now.x, v=now.v, omega=now.omega)
    with np.load(kept) as file:
        return made, State(**{name: file[name] for name in file.files}, step=0, t=0.0)


def measure(made: Scene, now: State, known: dict[str, ContactLaw], rounds: int) -> dict[str, Any]:
    """Time a grain and step of each law, touching pairs, and ratios to linear springs at steps."""
    engines, pairs = {name: CpuEngine() for name in known}, dict[str, float]()
    names, times = list(engines), [dict[str, float]() for _ in range(rounds)]
    for k, row in enumerate(times):
        for name in names[k % len(names) :] + names[: k % len(names)]:
            engine, spent, touching = engines[name], 0.0, list[int]()
            engine.forget()
            engine.load(replace(made, contact=known[name]), now)
            engine.advance(WARM).raise_if_any()
            for _ in range(PARTS):
                begun = time.process_time()
                engine.advance(TIMED // PARTS).raise_if_any()
                spent += time.process_time() - begun
                touching.append(engine.tally().n_contact)
            row[name] = 1e9 * spent / TIMED / made.n_grain
            pairs[name] = statistics.mean(touching) / made.n_grain  # the same in each round
    ratios = {name: [row["linear"] / row[name] for row in times] for name in names[1:]}
    least = {name: min(row[name] for row in times) for name in names}
    return {
        "grains": made.n_grain,
        "touching pairs a grain": {name: round(one, 3) for name, one in pairs.items()},
        "ns a grain and step, least": {name: round(one, 1) for name, one in least.items()},
        "ns a grain and step, median": {
            name: round(statistics.median(row[name] for row in times), 1) for name in names
        },
        "ns a touching pair and step, least": {k: round(least[k] / pairs[k], 1) for k in names},
        "speed over linear at steps, median": {
            k: round(statistics.median(one), 3) for k, one in ratios.items()
        },
        "lower quartile": {k: round(statistics.quantiles(one, n=4)[0], 3) for k, one in ratios.items()},
        "of the least times": {k: round(least["linear"] / least[k], 3) for k in names[1:]},
        "load": round(os.getloadavg()[0], 1),
    }


def main() -> None:
    """Print one table for each number of grains."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grains", type=int, nargs="+", default=[2000, 20000])
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--rest", action="store_true")
    parser.add_argument("--work", type=Path, default=Path("build/benchmarks"), help="where beds are kept")
    given = parser.parse_args()
    for n in given.grains:
        if given.rest:
            made, now = walls.bed(n, 40_000, 1, given.work)
            k_n = walls.KEYS["stiffness"]
            made = replace(made, dt=collision.collision_time(0.5 * M, k_n) / STEPS)
        else:
            k_n = K_N
            made, now = flow(n, laws()["linear"], given.work)
        print(json.dumps(measure(made, now, laws(k_n), given.rounds), indent=1), flush=True)


if __name__ == "__main__":
    main()
