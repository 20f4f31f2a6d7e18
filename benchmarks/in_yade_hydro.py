"""Beads under YADE's column of water: `yade -n -x -j1 in_yade_hydro.py job.json`; prints its figures."""
# ruff: noqa: F821  (YADE hands its names to the script: O, ForceResetter, sphere ...)

import json
import sys
import time
from pathlib import Path

import numpy as np

job = json.loads(Path(sys.argv[1]).read_text())
kept = np.load(job["grains"])
d, side, depth = job["d"], job["side"], job["depth"]
# YADE joins two materials in series, and takes tan of the angle.
bead = O.materials.append(
    ViscElMat(
        kn=2.0 * job["k_n"], cn=2.0 * job["eta_n"], ks=2.0 * job["k_s"], cs=0.0, density=job["density"],
        frictionAngle=float(np.arctan(job["mu"])),
    )
)  # fmt: skip
# The cell is periodic in z, too: the bed stands a quarter up in one five times as high as the water.
ground = 1.25 * depth
O.periodic = True
O.cell.setBox(side, side, 5.0 * depth)
for x in kept["x_fixed"]:
    O.bodies.append(sphere((x[0], x[1], x[2] + ground), 0.5 * d, material=bead, fixed=True))
free = [O.bodies.append(sphere((x[0], x[1], x[2] + ground), 0.5 * d, material=bead)) for x in kept["x"]]
g = Vector3(job["g"] * np.sin(job["slope"]), 0.0, -job["g"] * np.cos(job["slope"]))
dz = depth / (job["cells"] - 1)
water = HydroForceEngine(
    densFluid=1000.0, viscoDyn=1.0e-3, zRef=ground, gravity=g, deltaZ=dz, expoRZ=3.1, lift=False,
    nCell=job["cells"], vCell=side * side * dz, radiusPart=0.5 * d, phiMax=job["phi_max"], ids=free,
)  # fmt: skip


def solve() -> None:
    """Profiles of the beads, then the water over the same time."""
    water.averageProfile()
    water.fluidResolution(job["every"], job["within"])


O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()], [Law2_ScGeom_ViscElPhys_Basic()]
    ),
    water,
    PyRunner(command="solve()", virtPeriod=job["every"]),
    NewtonIntegrator(damping=0.0, gravity=g),
]
O.dt = job["dt"]
water.initialization()
water.ReynoldStresses = np.ones(job["cells"]) * 1.0e-4
water.averageProfile()
water.fluidResolution(1.0, job["within"])
O.run(job["warm"], wait=True)
begun = time.process_time()
O.run(job["steps"], wait=True)
found = {
    "loop": time.process_time() - begun,
    "grains": len(free),
    "contacts": O.interactions.countReal(),
    "fastest water": float(max(water.vxFluid)),
}
print("\nFOUND " + json.dumps(found), flush=True)
O.exitNoBacktrace(0)
