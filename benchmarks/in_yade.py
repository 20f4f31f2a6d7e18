"""Steps given grains inside YADE: `yade -n -x -j THREADS in_yade.py job.json`; prints its figures as JSON."""
# ruff: noqa: F821  (YADE hands its names to the script: O, ForceResetter, sphere ...)

import json
import sys
import time
from pathlib import Path

import numpy as np

job = json.loads(Path(sys.argv[1]).read_text())
kept = np.load(job["grains"])
law, plane = job["law"], job["plane"]
n = len(kept["x"])
period = [float(p) for p in kept["period"]]

# YADE joins two materials in series, and takes tan of the angle.
grain = O.materials.append(
    ViscElMat(
        kn=2.0 * law["k_n"], cn=2.0 * law["eta_n"], ks=2.0 * law["k_s"], cs=2.0 * law["eta_s"],
        density=law["density"], frictionAngle=float(np.arctan(law["mu"])),
    )
)  # fmt: skip
lift = 0.0
if np.isfinite(period[0]):
    # YADE's cell is periodic in z, too: a bed in the lower half of a tall one meets nothing above
    tall = float(kept["x"][:, 2].max()) + 40.0 * float(kept["d"].max())
    O.periodic = True
    O.cell.setBox(period[0], period[1], tall)
    lift = 4.0 * float(kept["d"].max())
for x, v, w, d in zip(kept["x"], kept["v"], kept["omega"], kept["d"], strict=True):
    body = sphere((x[0], x[1], x[2] + lift), 0.5 * d, material=grain)
    body.state.vel, body.state.angVel = tuple(v), tuple(w)
    if plane:
        body.state.blockedDOFs = "yXZ"
    O.bodies.append(body)
for x, d in zip(kept["x_fixed"], kept["d_fixed"], strict=True):
    O.bodies.append(sphere((x[0], x[1], x[2] + lift), 0.5 * d, material=grain, fixed=True))

g, slope = law["gravity"], job["slope"]
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], verletDist=job["skin"] * law["d"] / 2),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()], [Law2_ScGeom_ViscElPhys_Basic()]
    ),
    NewtonIntegrator(damping=0.0, gravity=(g * np.sin(slope), 0.0, -g * np.cos(slope))),
    VTKRecorder(iterPeriod=job["frame"], fileName="frames-", recorders=["spheres", "velocity"]),
]
O.dt = job["dt"]
O.run(job["warm"], wait=True)
begun = time.perf_counter()
O.run(job["steps"], wait=True)
found = {
    "loop": time.perf_counter() - begun,
    "pairs": O.interactions.countReal(),
    "threads": int(job["threads"]),
}
if job["final"]:
    bodies = [O.bodies[k].state for k in range(n)]
    x = np.array([[*body.pos] for body in bodies]) - (0.0, 0.0, lift)
    np.savez(
        job["final"],
        x=x,
        v=np.array([[*body.vel] for body in bodies]),
        omega=np.array([[*body.angVel] for body in bodies]),
    )
print("\nFOUND " + json.dumps(found), flush=True)
O.exitNoBacktrace(0)
