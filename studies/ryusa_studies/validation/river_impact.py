"""The force of the front of a debris flow on a dam, against the bore that it reflects (design/0028)."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ryusa.cases import case_path
from ryusa.figures.comparison import Curve
from ryusa.laws.bore import reflected_bore
from ryusa.laws.families import SurfaceRule
from ryusa.measure.along_row import grains_along_row
from ryusa.measure.long_section import long_section, row_of
from ryusa.measure.walls import walls
from ryusa.model.arrays import Floats
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd, RowState
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Task, calculation, case_run
from ryusa.water.row import advance_row, row_at_rest
from ryusa_studies.validation.declared import declared

DECLARED = declared(__file__)

SEEDS = (1, 2)
CASE = "front_on_dam"
SPEEDS = (1.0, 1.5, 2.2)  # at which grains and water enter [m/s]
DEEP, FED = 0.03, 0.25  # how deep, and with which concentration [m], [-]
RHO_S, RHO_W, G, WIDTH = 2650.0, 1000.0, 9.80665, 0.032  # of the case, in SI
REACH, FLOW = (0.5, 0.65), 0.15  # where the flow is measured [m], and for how long [s]
ARRIVED = 0.4  # volume per area with which the grains have arrived there, in diameters
LATER, LONG = 0.05, 0.25  # when after the impact the mean of the force begins, and how long it is [s]
ALONE = (0.03, 1.5)  # depth [m] and speed [m/s] of the water alone


def against_a_wall() -> tuple[ColumnRow, RowState]:
    """Water alone, without friction and in one layer, that begins to run against a wall at x = 2 m.

    Its depth and speed are those of `ALONE`, and its segments 5 mm long.
    """
    (h, u), dx, n = ALONE, 0.005, 400
    column = Column(z_low=0.0, dz=0.25, n=2, depth=h, nu=1e-15, surface=SurfaceRule.VOLUME)
    inlet = RowEnd(EndKind.DISCHARGE, discharge=u * h, depth=h)
    row = ColumnRow(column, dx, np.zeros(n), G, inlet, RowEnd(EndKind.WALL))
    now = row_at_rest(row, np.full(n, h))
    speeds = np.full_like(now.u, u)
    speeds[-1] = 0.0
    return row, replace(now, u=speeds)


def water_alone() -> dict[str, Floats]:
    """Water against a wall: depths `h` [m] at the places `x` before the wall [m], after 0.8 s."""
    row, start = against_a_wall()
    now = advance_row(row, start, 0.8)
    return {"x": row.x - row.n_segment * row.dx, "h": now.surface[row.inner], "t": np.array(0.8)}


def _run(speed: float, seed: int) -> CaseRun:
    """Grains and water that enter at a speed."""
    rate = RHO_S * FED * speed * DEEP * WIDTH
    feeder = (
        '[{ name = "feeder", low = ["2 cm", "0 cm", "0.5 cm"], high = ["20 cm", "3.2 cm", "5.5 cm"], '
        f'velocity = ["{speed:g} m/s", "0 m/s", "0 m/s"], rate = "{rate:.4g} kg/s" }}]'
    )
    keys = {
        "feeds": feeder, "water.row.upstream.discharge": f"{(1.0 - FED) * speed * DEEP:.5g} m2/s",
        "stop.time": f"{0.55 + 1.1 / speed:.3g} s",
    }  # fmt: skip
    return case_run(case_path(f"validation/{CASE}.toml"), keys, seed=seed)


def alone() -> Task:
    """The water that runs against a wall."""
    return calculation(water_alone, seconds=1.0)


def tasks() -> Sequence[Task]:
    """Every speed with every seed: a minute each."""
    return [_run(speed, seed) for seed in SEEDS for speed in SPEEDS]


def struck(run: Results) -> dict[str, Floats]:
    """Speed, depth and concentration of the flow, and the force on the dam per width over time.

    Returns
    -------
    `u` [m/s], `h` [m] and concentration of the discharge `c` [-], means over `FLOW` since the grains have
    come to `REACH`, at `came` [s]; over the times `t` [s] the force of the `grains` and of the `water`
    [N/m], the latter that of still water as deep as the segment before the dam.
    """
    found = row_of(run)
    row = found.row
    reach = (row.x > REACH[0]) & (row.x < REACH[1])
    held = grains_along_row(run, row, np.arange(len(found.t))).volume[:, reach].mean(axis=1)
    came = float(found.t[np.flatnonzero(held > ARRIVED * run.scene.d_mean)[0]])
    flow = long_section(run, bed="rest", begin=came, end=came + FLOW)
    grains, both = flow.solid_discharge[reach].mean(), (flow.speed * flow.depth)[reach].mean()
    depth = float(flow.depth[reach].mean())
    forces = walls(run, begin=0.0)
    before = row.dams[0].first - 1
    deep = 0.5 * (found.depth[1:, before] + found.depth[:-1, before])
    return {
        "came": np.array(came), "h": np.array(depth), "u": np.array(float(both) / depth),
        "c": np.array(float(grains / both)), "t": forces.t,
        "grains": forces.force[:, forces.names.index("dam"), 0] / WIDTH,
        "water": 0.5 * RHO_W * row.g_z * deep**2,
    }  # fmt: skip


def of_force(one: dict[str, Floats]) -> dict[str, float]:
    """Force on a dam over that of the reflected bore, and what it depends on.

    Returns
    -------
    `ratio` of the mean from `LATER` after the impact on for `LONG`, `peak` of the largest; the Froude number
    `froude`; the `mean` over half rho g h**2, and over rho u**2 h as `drag` [-]. The impact is
    when the force first reaches half of that of the bore; nan in `ratio` if it never does, or the run ends
    before the window.
    """
    u, h, c = (float(one[key]) for key in ("u", "h", "c"))
    rho = RHO_W + (RHO_S - RHO_W) * c
    r = reflected_bore(u, h, G)[0] / h
    still = 0.5 * rho * G * h * h
    t, force = one["t"], one["grains"] + one["water"]
    above = np.flatnonzero(force > 0.5 * still * r * r)
    mean = math.nan
    if len(above) and t[above[0]] + LATER + LONG <= t[-1]:
        begin = float(t[above[0]]) + LATER
        mean = float(force[(t >= begin) & (t < begin + LONG)].mean())
    return {
        "ratio": mean / (still * r * r), "peak": float(force.max()) / (still * r * r), "mean": mean / still,
        "froude": u / math.sqrt(G * h), "drag": mean / (rho * u * u * h),
    }  # fmt: skip


def of_bore(found: Found) -> Finding:
    """Water alone against the closed form."""
    h, u = ALONE
    got = found[alone()]
    deep, celerity = reflected_bore(u, h, G)
    x, depth, place = got["x"], got["h"], -celerity * float(got["t"])
    plateau = float(depth[(x > 0.7 * place) & (x < 0.1 * place)].mean())
    k = int(np.flatnonzero(depth > 0.5 * (h + deep))[0])
    front = float(np.interp(0.5 * (h + deep), depth[k - 1 : k + 1], x[k - 1 : k + 1]))
    line = Curve("closed form", np.array([x[0], place, place, 0.0]), np.array([h, h, deep, deep]))
    return DECLARED["bore"].finding(
        [Curve("row", x, depth)], [line],
        {"depth": abs(plateau / deep - 1.0), "way": abs(front / place - 1.0)}, h=100.0 * h, u=u,
    )  # fmt: skip


def of_front(found: Found) -> Finding:
    """Forces of the fronts over that of the bore, against the Froude number."""
    forces = {(speed, seed): of_force(dict(found[_run(speed, seed)])) for seed in SEEDS for speed in SPEEDS}
    ratios = [one["ratio"] for one in forces.values()]
    worst = max(ratios, key=lambda ratio: math.inf if math.isnan(ratio) else abs(ratio - 1.0))
    numbers = np.linspace(0.5, max(one["froude"] for one in forces.values()) + 0.5, 60)
    law = np.array([reflected_bore(fr * math.sqrt(G * DEEP), DEEP, G)[0] / DEEP for fr in numbers]) ** 2
    curves = [
        Curve(
            f"seed {seed}", *(np.array([forces[v, seed][key] for v in SPEEDS]) for key in ("froude", "mean"))
        )
        for seed in SEEDS
    ]
    said = list[str]()
    for (speed, seed), one in forces.items():
        u, h, c = (float(found[_run(speed, seed)][key]) for key in ("u", "h", "c"))
        said.append(
            f"Entering at {speed:g} m/s, seed {seed}: comes with {u:.2f} m/s, {100.0 * h:.1f} cm deep, "
            f"c {c:.2f}, Froude number {one['froude']:.2f}; mean over that of the bore {one['ratio']:.2f}, "
            f"largest {one['peak']:.2f}, mean over rho u^2 h {one['drag']:.2f}"
        )
    peak = max(one["peak"] for one in forces.values())
    return DECLARED["front"].finding(
        curves, [Curve("reflected bore", numbers, law)],
        {"force": worst, "mean": float(np.mean(ratios)), "peak": peak}, said='. '.join(said),
    )  # fmt: skip
