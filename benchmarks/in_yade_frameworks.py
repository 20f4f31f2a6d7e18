"""Steps a case of frameworks.py inside YADE: `yade -n -x -j THREADS in_yade_frameworks.py job.json`."""
# ruff: noqa: F821  (YADE hands its names to the script: O, FrictMat, MatchMaker ...)

import json
import sys
from pathlib import Path

import numpy as np

job = json.loads(Path(sys.argv[1]).read_text())
kept, mesh = np.load(job["grains"]), np.load(job["mesh"])
kinds = [
    O.materials.append(FrictMat(young=young, poisson=job["nu"], density=rho, label=name))
    for name, young, rho in zip(job["materials"], job["young"], job["density"], strict=True)
]


def of_pairs(values):
    """Values of pairs of materials as YADE matches them."""
    n = range(len(kinds))
    return MatchMaker(
        matches=tuple((kinds[a], kinds[b], float(values[a][b])) for a in n for b in n if a <= b)
    )


faces = [O.bodies.append(facet([tuple(p) for p in corners], material=kinds[-1])) for corners in mesh]
ids = []
for x, v, d, of in zip(kept["x"], kept["v"], kept["d"], kept["of"], strict=True):
    body = sphere(tuple(x), 0.5 * d, material=kinds[of])
    body.state.vel = tuple(v)
    ids.append(O.bodies.append(body))
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()], verletDist=job["skin"]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom(hertzian=True)],
        [Ip2_FrictMat_FrictMat_MindlinPhys(
            en=of_pairs(job["restitution"]), frictAngle=of_pairs(np.arctan(job["friction"])))],
        [Law2_ScGeom_MindlinPhys_Mindlin(preventGranularRatcheting=False)],
    ),
    RotationEngine(
        dead=not job["spin"], rotateAroundZero=True, zeroPoint=(0, 0, 0), rotationAxis=(0, 1, 0),
        angularVelocity=job["spin"], ids=faces,
    ),
    NewtonIntegrator(damping=0.0, gravity=(0.0, 0.0, -job["gravity"])),
]  # fmt: skip
O.dt = job["dt"]
frames, there = [], set(ids)
for k in range(job["frames"] + 1):
    if k:
        O.run(job["every"], True)
    now = np.full((len(ids), 3), np.nan)
    for row, one in enumerate(ids):
        if one in there:
            now[row] = O.bodies[one].state.pos
            if now[row, 2] < job["out"]:
                O.bodies.erase(one)
                there.discard(one)
    frames.append(now)
np.savez(job["result"], t=job["dt"] * job["every"] * np.arange(len(frames)), x=np.array(frames, np.float32))
O.exitNoBacktrace(0)
