"""Speed of elastic spheres beside linear springs: the same packing, in turn, in one process.

    python benchmarks/hertz.py [--grains 2000 20000] [--rounds 9]

A bed in periodic space over fixed grains is tilted to 26 deg and left to flow with linear springs; its grains
then go on with each law, the springs forgotten, with the same step. A round times every law once, in an order
that moves on by one; ratios are taken within a round. Only the seam of an engine is used (`load`, `advance`).
"""

import argparse
import json
import math
import statistics
import time
from dataclasses import replace
from typing import Any

import numpy as np

from ryusa.build import scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws import collision, hertz
from ryusa.laws.families import ContactTiming
from ryusa.model import ContactLaw, Scene, State
from ryusa.model.contact_law import elastic_spheres
from ryusa.model.contacts import Contacts
from ryusa.model.scene import EventRule

D, RHO, K_N, E, MU = 2.0e-3, 2650.0, 2.0e4, 0.7, 0.5  # [m], [kg/m3], [N/m], [-], [-]
M = RHO * math.pi / 6.0 * D**3  # [kg]
SPEED, NU = 0.1, 0.25  # at which both have the same contact time [m/s], [-]
LAYERS, STEPS = 12, 25.0  # of grains; in the shortest contact
BEFORE, WARM, TIMED = 12_000, 300, 200  # steps: of flow before, of each law before the clock, by the clock


def laws() -> dict[str, ContactLaw]:
    """The laws that are compared, of the same contact time."""
    zeta = collision.zeta_no_tension(E)
    linear = ContactLaw(
        k_n=K_N, k_s=2.0 / 7.0 * K_N, mu=MU, e_n=E, e_s=E, zeta_n=zeta, zeta_s=collision.zeta_tension(E),
        timing=ContactTiming.AT_STEPS,
    )  # fmt: skip
    stiff = hertz.stiffness_hertz_for_time(collision.collision_time(M, K_N), SPEED, M, 0.0, True)
    young = hertz.modulus_for_stiffness(stiff, 0.25 * D, NU)
    elastic = elastic_spheres(
        M, 0.25 * D, youngs_modulus=young, poisson_ratio=NU, speed=SPEED, friction=MU, restitution=E
    )
    return {
        "linear": linear,
        "linear, exact timing": replace(linear, timing=ContactTiming.EXACT),
        "Hertz-Mindlin": elastic,
    }


def flow(n: int, law: ContactLaw) -> tuple[Scene, State]:
    """About n grains that flow, without their springs."""
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
    engine = CpuEngine()
    engine.load(made, first)
    engine.advance(BEFORE).raise_if_any()
    now = engine.state()
    return made, State(now.x, now.v, now.omega, 0, 0.0, now.image, Contacts.none())


def measure(n: int, rounds: int) -> dict[str, Any]:
    """Grain steps per second of each law, and ratios to linear springs at steps."""
    known = laws()
    made, now = flow(n, known["linear"])
    engines: dict[str, CpuEngine] = {}
    for name, law in known.items():
        engines[name] = CpuEngine()
        engines[name].load(replace(made, contact=law), now)
        engines[name].advance(WARM).raise_if_any()
    names, rates = list(engines), [dict[str, float]() for _ in range(rounds)]
    for k, row in enumerate(rates):
        for name in names[k % len(names) :] + names[: k % len(names)]:
            begun = time.perf_counter()
            engines[name].advance(TIMED).raise_if_any()
            row[name] = made.n_grain * TIMED / (time.perf_counter() - begun)
    ratios = {name: [row[name] / row["linear"] for row in rates] for name in names[1:]}
    return {
        "grains": made.n_grain,
        "touching pairs a grain": {
            k: round(one.tally().n_contact / made.n_grain, 2) for k, one in engines.items()
        },
        "million grain steps a second": {
            name: round(1e-6 * statistics.median(row[name] for row in rates), 2) for name in names
        },
        "over linear at steps, median": {k: round(statistics.median(one), 3) for k, one in ratios.items()},
        "lower quartile": {k: round(statistics.quantiles(one, n=4)[0], 3) for k, one in ratios.items()},
    }


def main() -> None:
    """Print one table for each number of grains."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grains", type=int, nargs="+", default=[2000, 20000])
    parser.add_argument("--rounds", type=int, default=9)
    given = parser.parse_args()
    for n in given.grains:
        print(json.dumps(measure(n, given.rounds), indent=1))


if __name__ == "__main__":
    main()
