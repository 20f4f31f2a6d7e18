"""Do the codes compared do the same? Single collisions to the last digits, then flows by their averages."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import workloads
from peer import Job, PeerError
from peer_ryusa import Ryusa
from speed import run
from workloads import DROP, DT, TOTAL, D, Grains, Workload, workload

APART = 0.01 * D  # gap of the two surfaces at the start
STEPS = 400  # of a collision, approach included
FLOW_STEPS = 8000  # 40 ms
NUDGE = 1.0e-7  # m/s between two runs of one code, whose difference is chaos alone


def collisions() -> tuple[Grains, list[str]]:
    """Pairs far apart from each other, each about to meet, and what they are."""
    # speeds along normal and tangent [m/s], spin [rad/s], is the partner fixed, size of the first [D]
    pairs = [
        ("free on free, sticks", 0.5, 0.3, 30.0, False, 1.0),
        ("free on free, slides", 0.3, 1.5, 0.0, False, 1.0),
        ("free on fixed, sticks", 0.5, 0.1, -20.0, True, 1.0),
        ("large on small", 0.5, 0.3, 0.0, False, 1.0 + workloads.POLY),
    ]
    x, v, w, d, x_fixed, d_fixed, names = [], [], [], [], [], [], []
    for k, (name, normal, tangent, spin, fixed, size) in enumerate(pairs):
        at = np.array([20.0 * D * k, 0.0, 0.0])
        n = np.array([math.cos(0.4), math.sin(0.4) * 0.6, math.sin(0.4) * 0.8])
        t = np.cross(n, [0.0, 0.0, 1.0])
        t /= np.linalg.norm(t)
        other = 2.0 - size
        x.append(at)
        v.append(normal * n + tangent * t)
        w.append([0.0, spin, 0.5 * spin])
        d.append(size * D)
        partner = at + (0.5 * (size + other) * D + APART) * n
        names.append(name)
        if fixed:
            x_fixed.append(partner)
            d_fixed.append(other * D)
        else:
            x.append(partner)
            v.append(np.zeros(3))
            w.append(np.zeros(3))
            d.append(other * D)
            names.append(name)
    inf = float("inf")
    grains = [np.array(a, dtype=np.float64) for a in (x, v, w, d, x_fixed, d_fixed)]
    return Grains(grains[0], grains[1], grains[2], grains[3], grains[4], grains[5], (inf, inf)), names


def law(peers: dict[str, list[Any]], work: Path) -> list[dict[str, Any]]:
    """Largest difference of velocity and surface speed after each collision, over the speed of approach."""
    grains, names = collisions()
    path = work / "collisions.npz"
    grains.save(str(path))
    rows: list[dict[str, Any]] = []
    ours = {slip: _final(Ryusa(slip), path, workload("W2", "1k"), 1, STEPS, work) for slip in (TOTAL, DROP)}
    for name, builds in peers.items():
        for build in builds:
            theirs = _final(build, path, workload("W2", "1k"), 1, STEPS, work)
            row: dict[str, Any] = {"code": name, "build": build.label, "slip": build.slip}
            if theirs is None:
                rows.append(row | {"failed": True})
                continue
            mine = ours[build.slip]
            off = np.maximum(
                np.linalg.norm(theirs["v"] - mine["v"], axis=1),
                np.linalg.norm(theirs["omega"] - mine["omega"], axis=1) * grains.d / 2,
            ) / np.linalg.norm(grains.v, axis=1).max()  # fmt: skip
            rows.append(
                row
                | {
                    what: float(f"{max(off[k] for k, one in enumerate(names) if one == what):.1e}")
                    for what in names
                }
            )
    slips = (
        np.linalg.norm(ours[TOTAL]["v"] - ours[DROP]["v"], axis=1) / np.linalg.norm(grains.v, axis=1).max()
    )
    between = {
        what: float(f"{max(slips[k] for k, one in enumerate(names) if one == what):.1e}") for what in names
    }
    return [*rows, {"code": "the two slip rules, in ryusa", "build": "", "slip": "", **between}]


def flows(
    files: dict[str, Path], peers: dict[str, list[Any]], steps: int, work: Path
) -> list[dict[str, Any]]:
    """Averages after the same time in every code; the second ryusa differs by a nudge of its first grain."""
    rows: list[dict[str, Any]] = []
    for name, path in files.items():
        load = workload(name, "2k")
        grains = Grains.load(str(path))
        nudged = work / f"nudged-{name}.npz"
        grains.v[0, 2] += NUDGE
        grains.save(str(nudged))
        codes: list[tuple[str, Any, Path]] = [
            ("ryusa", Ryusa(TOTAL), path),
            ("ryusa, nudged", Ryusa(TOTAL), nudged),
            ("ryusa", Ryusa(DROP), path),
            *((peer, builds[0], path) for peer, builds in peers.items()),
        ]
        for label, code, its in codes:
            last = _final(code, its, load, 1, steps, work)
            row: dict[str, Any] = {
                "workload": name,
                "code": label,
                "slip": code.slip,
                "t [ms]": 1e3 * steps * DT,
            }
            rows.append(row | (averages(load, grains, last) if last is not None else {"failed": True}))
    return rows


def averages(load: Workload, grains: Grains, last: dict[str, np.ndarray]) -> dict[str, float]:
    """What a flow has come to."""
    m = workloads.DENSITY * np.pi / 6 * grains.d**3
    v, w = last["v"], last["omega"]
    found = {
        "mean v_x [mm/s]": 1e3 * v[:, 0].mean(),
        "rms speed [mm/s]": 1e3 * math.sqrt((v**2).sum(axis=1).mean()),
        "energy a grain [nJ]": 1e9
        * 0.5
        * float((m * (v**2).sum(axis=1) + 0.1 * m * grains.d**2 * (w**2).sum(axis=1)).mean()),
        "mean height [d]": last["x"][:, 2].mean() / workloads.D,
    }
    if load.plane:
        found["front, 99 % [d]"] = float(np.quantile(last["x"][:, 0], 0.99)) / workloads.D
    return {name: float(f"{value:.4g}") for name, value in found.items()}


def _final(
    code: Any, path: Path, load: Workload, warm: int, steps: int, work: Path
) -> dict[str, np.ndarray] | None:
    """Last frame of a run."""
    final = work / "final.npz"
    job = Job(load, path, 1, warm, steps - warm, skin=0.1, final=final)
    try:
        run(code, job, work)
    except PeerError as error:
        print(f"    {error}", flush=True)
        return None
    with np.load(final) as kept:
        return {name: kept[name] for name in kept.files}
