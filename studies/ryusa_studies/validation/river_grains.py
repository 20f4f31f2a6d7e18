"""Grains in a periodic row of columns: bed load as in one column, seepage, and rest (design/0027)."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.build import build
from ryusa.casefile import read
from ryusa.cases import case_path
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import SurfaceRule
from ryusa.laws.porous import ergun_linear, ergun_quadratic
from ryusa.model.arrays import Floats
from ryusa.model.row import ColumnRow
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, Task, Trial, calculation, case_run
from ryusa.water.coupling import steps_resolved
from ryusa.water.row_grains import GrainsInRow
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

SEEDS, SEGMENTS = (1, 2, 3, 4), 8
REACH = ("q_star", "discharge", "u_high", "u_low", "phi_low", "height")
AT_REST = 1e-3  # way over d of a grain that has not moved, on a level bed [-]
PROFILES = {"u": "speed", "phi": "concentration"}
MIDDLE = 4e-3, 14e-3  # heights between which a bed of 24 mm is even [m]
BEGIN, END = 2.0, 6.0  # times between which it is averaged [s]


def reach(seed: int, segments: int) -> dict[str, Floats]:
    """Means of the case `bedload_3d` in a periodic row; one segment is one column.

    Returns
    -------
    The numbers of `REACH`: transport rate [-], discharge [m2/s], speed of the water well
    above the bed and in the two diameters above water.zero [m/s], concentration there [-], mean height of
    the grains [m]; profiles over z [m] of the water `u` [m/s] and the concentration `phi` [-]; `residual`
    of momentum [-].
    """
    built = build(read(case_path("bedload_3d.toml"), {"seed": str(seed)}))
    fixed = built.scene
    assert fixed.column is not None
    column = replace(fixed.column, surface=SurfaceRule.VOLUME)
    row = ColumnRow(
        column, fixed.period[0] / segments, np.full(segments, column.z_low), -float(fixed.gravity[2])
    )
    surface = np.full(segments, column.z_surface)
    engine = registry.create()
    engine.load(fixed, built.state)
    state = GrainsInRow.begin(fixed, row, built.state.x).flowing(surface)
    grains = GrainsInRow.begin(fixed, row, built.state.x, state)
    volume, d = np.pi / 6.0 * fixed.d**3, float(fixed.d.mean())
    scale = math.sqrt((float(fixed.m.sum() / volume.sum()) / column.rho_w - 1.0) * 9.81 * d**3)
    low = (column.z > column.origin) & (column.z < column.origin + 2.0 * d)
    high = (column.z > column.origin + 10.0 * d) & (column.z < column.origin + 18.0 * d)
    t, steps, count = 0.0, 1, 0
    sums, of_u, of_phi = np.zeros(6), np.zeros(column.n), np.zeros(column.n)
    while t < END:
        engine.set_fluid(grains.sampled)
        engine.advance(steps).raise_if_any()
        time = steps * fixed.dt
        x, v, taken = engine.kinematics()
        state = grains.exchange(state, x, v, taken, time)
        t += time
        steps = steps_resolved(grains.fastest, fixed.dt, column.interval)
        if t > BEGIN:
            u, phi = state.u.mean(axis=0), grains.phi.mean(axis=0)
            through = float((state.content * state.u).sum(axis=1).mean())
            rate, height = (
                float(volume @ v[:, 0]) / column.area / scale,
                float(volume @ x[:, 2] / volume.sum()),
            )
            sums += rate, through, u[high].mean(), u[low].mean(), phi[low].mean(), height
            of_u, of_phi, count = of_u + u, of_phi + phi, count + 1
    means = dict(zip(REACH, (sums / count)[:, None], strict=True))
    return {
        "z": column.z - column.origin, "u": of_u / count, "phi": of_phi / count,
        "residual": np.array(grains.worst), **means,
    }  # fmt: skip


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Seepage through a bed that has settled, Ergun's for it, and how far its grains still moved.

    Returns
    -------
    Over the heights `z` [m]: discharge per height `w` [m/s] and concentration `phi` [-]; in the middle of the
    bed the mean `inside` and that of `ergun` [m/s]; the longest way of a grain over d, `moved` [-], that of
    half of them, `median`, and how many went farther than `AT_REST`, `moving`.
    """
    del one
    found, frames = run.row, run.frames
    assert found is not None
    begin, scene, c = float(run.case["record"]["settle"]), run.scene, found.row.column
    span = found.t >= begin - 1e-9
    between = 0.5 * (found.content + np.roll(found.content, 1, axis=1))
    w = (between * found.u)[span].mean(axis=(0, 1)) / c.dz
    phi = found.phi[span].mean(axis=(0, 1))
    middle = (c.z > MIDDLE[0]) & (c.z < MIDDLE[1])
    share, d = float(phi[middle].mean()), float((scene.d**3).sum() / (scene.d**2).sum())
    a, b = ergun_linear(share, d, c.nu), ergun_quadratic(share, d)
    pores = (math.sqrt(a * a + 4.0 * b * (1.0 - share) * c.g_x) - a) / (2.0 * b)
    first = int(np.flatnonzero(span)[0])
    way = np.linalg.norm(frames.x[-1] - frames.x[first], axis=1) / scene.d_mean
    return {
        "z": c.z, "w": w, "phi": phi, "inside": np.array(w[middle].mean()),
        "ergun": np.array((1.0 - share) * pores), "moved": np.array(way.max()),
        "moving": np.array(float((way > AT_REST).sum())),
        "median": np.array(float(np.median(way))),
    }  # fmt: skip


def _bed(level: bool) -> CaseRun:
    level_bed = {"motion.slope": "0", "stop.time": "1.2 s", "record.settle": "1 s"}
    return case_run(case_path("validation/seepage.toml"), level_bed if level else {})


def _reach(seed: int, segments: int) -> Task:
    return calculation(reach, seed=seed, segments=segments, seconds=90.0 if segments > 1 else 60.0)


def tasks(plan: Plan) -> Sequence[Task]:
    """Four seeds in a row and in one column, and two beds, at the full level alone: ten minutes or more."""
    if plan.level is not Level.FULL:
        return []
    return [*(_reach(seed, n) for seed in SEEDS for n in (1, SEGMENTS)), _bed(False), _bed(True)]


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Bed load, seepage and rest."""
    return [_as_one_column(found), _seepage(found)] if plan.level is Level.FULL else []


def _seepage(found: Found) -> Finding:
    """Water in the middle of a bed, and a bed under still water."""
    got, still = found[_bed(False)], found[_bed(True)]
    ours, ergun = float(got["inside"]), float(got["ergun"])
    bed = got["z"] < MIDDLE[1]
    z = got["z"][bed]
    return DECLARED["own-packing"].finding(
        [Curve("row", z, got["w"][bed])], [Curve("Ergun", z, np.full(len(z), ergun))],
        {"discharge": abs(ours / ergun - 1.0), "way": float(still["moved"])}, ergun=ours / ergun,
        low=1e3 * MIDDLE[0], high=1e3 * MIDDLE[1], moving=int(still["moving"]),
        median=float(still["median"]),
    )  # fmt: skip


def _as_one_column(found: Found) -> Finding:
    """Differences over their standard errors, which must be small enough to say something."""
    one, many = ([found[_reach(seed, n)] for seed in SEEDS] for n in (1, SEGMENTS))
    residual = max(float(run["residual"]) for run in (*one, *many))
    kind, errors, said = DECLARED["reach"], list[Trial](), list[str]()
    for name in REACH:
        a, b = (np.array([float(run[name][0]) for run in runs]) for runs in (one, many))
        error = math.hypot(a.std(ddof=1), b.std(ddof=1)) / math.sqrt(len(SEEDS))
        words = name.replace("_", " ")
        apart = abs(float(b.mean() - a.mean())) / error
        errors += [
            kind.trial("apart", apart, words), kind.trial("error", error / abs(float(a.mean())), words),
        ]  # fmt: skip
        said.append(f"{words} {a.mean():.4g} and {b.mean():.4g} +- {error:.2g}")
    z, d = one[0]["z"], 4.0e-3
    ours, theirs = (
        [
            Curve(name, z / d, np.mean([np.interp(z, run["z"], run[key]) for run in runs], axis=0))
            for key, name in PROFILES.items()
        ]
        for runs in (many, one)
    )
    errors.append(kind.trial("residual", residual))
    return kind.finding(ours, theirs, errors, begin=BEGIN, end=END, said="; ".join(said))
