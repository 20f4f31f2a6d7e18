"""Run by `mpirun -np N`: grains collide across the border of ranks; the first rank prints where they end."""

import json
import sys

import numpy as np
from tests.engine.heaps import COLUMN

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.laws.families import ContactTiming, Slip
from ryusa.model import Water
from ryusa.model.fluid import N_SAMPLED, SUBMERGED, U
from ryusa.model.scene import EventRule

D = 2.0e-3


def main() -> None:
    with registry.leading("lammps") as leads:
        if not leads:
            return
        column = sys.argv[1] == "column"
        rng = np.random.default_rng(2)
        x = 1.0002 * D * np.stack(np.meshgrid(*[np.arange(4)] * 3, indexing="ij"), -1).reshape(-1, 3)
        fixed, first = scene(
            x + np.array([0.5 * D, 0.5 * D, 0.0]), D, v=rng.normal(0.0, 0.05, x.shape),
            omega=rng.normal(0.0, 20.0, x.shape),
            period=(4.5 * D, 4.5 * D), planes=[("floor", (0, 0, -0.5001 * D), (0, 0, 1))], slip=Slip.TOTAL,
            timing=ContactTiming.AT_STEPS, events=EventRule.NONE, water=COLUMN if column else Water(),
            restitution=0.3,
        )  # fmt: skip
        engine = registry.create("lammps")
        engine.load(fixed, first)
        for k in range(3):
            if column:
                sampled = np.zeros((fixed.n_grain, N_SAMPLED))
                sampled[:, U], sampled[:, SUBMERGED] = 0.1 * k + first.x[:, 2], 1.0
                engine.set_fluid(sampled)
            engine.advance(200).raise_if_any()
        end, tally, impulse = engine.state(), engine.tally(), engine.kinematics()[2]
        print(json.dumps({
            "x": (end.x + fixed.period[0] * np.column_stack([end.image, np.zeros(len(end.x))])).tolist(),
            "v": end.v.tolist(), "omega": end.omega.tolist(), "impulse": impulse.tolist(),
            "kinetic": tally.kinetic, "spring_n": tally.spring_n, "n_contact": tally.n_contact,
            "overlap_max": tally.overlap_max, "restart": len(end.engine.arrays["restart"]),
        }))  # fmt: skip


if __name__ == "__main__":
    main()
