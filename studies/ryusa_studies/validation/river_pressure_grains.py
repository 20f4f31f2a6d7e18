"""Grains under the pressure of a row: what sinks, what seeps, what rises (design/0030).

The limits are those that were asked for before the pressure knew of grains.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ryusa.build import scene
from ryusa.engine import registry
from ryusa.figures.comparison import Curve
from ryusa.laws.families import Buoyancy, Drag, Hindrance, Pressure, Profile
from ryusa.laws.porous import ergun_linear, ergun_quadratic
from ryusa.model import Water
from ryusa.model.arrays import Floats
from ryusa.model.row import ColumnRow, EndKind, PorousSolid, RowEnd
from ryusa.model.scene import EventRule
from ryusa.results import Results
from ryusa.study import CaseRun, Finding, Found, Level, Plan, Task, calculation
from ryusa.water.row import RowArrays, advance_row, row_at_rest
from ryusa.water.row_grains import GrainsInRow
from ryusa_studies.validation import river_immersed as immersed
from ryusa_studies.validation import river_pressure_beds as beds
from ryusa_studies.validation import river_scour as scour
from ryusa_studies.validation.declared import declared
from ryusa_studies.validation.river_pressure import BOTH, WALLS, G, water

TITLE = "Grains under the pressure along a row"
DECLARED = declared(__file__)
RHO, NU = 1000.0, 1e-6  # of the water [kg/m3], [m2/s]
D, PITCH, LAYERS = 0.002, 0.0026, 14  # of grains that sink: diameter, distances and layers [m]
DENSITIES = (2650.0, 1540.0, 1048.0)  # gravel, coal, polystyrene [kg/m3]
STEPS = {2650.0: 40, 1540.0: 50, 1048.0: 100}  # exchanges until they sink steadily


def sinking(density: float) -> dict[str, Floats]:
    """Pressure below a layer of grains that starts to sink in still water, over its weight in water.

    Returns
    -------
    Over the times `t` [s]: `borne`, and `momentum`, the same by the mean acceleration of the grains, to which
    that of the water belongs: what rises makes room for what sinks, (sigma - rho) phi H (g + dv/dt).
    """
    length = 16 * PITCH
    a, b = (one.ravel() for one in np.meshgrid(np.arange(16), np.arange(LAYERS)))
    at: Floats = np.column_stack([(a + 0.5) * PITCH, 0.0 * a, (b + 8.5) * PITCH]).astype(np.float64)
    given = Water(
        profile=Profile.COLUMN,
        drag=Drag.SCHILLER_NAUMANN,
        buoyancy=Buoyancy.STRESS,
        hindrance=Hindrance.DI_FELICE,
    )
    made, first = scene(
        at, D, density=density, water=given, gravity=G, slope=0.0, period=(length, math.inf), plane_case=True,
        dt=2e-5, events=EventRule.NONE,
    )  # fmt: skip
    made = replace(made, world_low=(-math.inf,) * 3)
    column = replace(water(PITCH, 40, 34 * PITCH, nu=NU), area=length * D)
    row = ColumnRow(column, length / 2, np.zeros(2), G, pressure=Pressure.FULL)
    engine = registry.create()
    engine.load(made, first)
    now = GrainsInRow.begin(made, row, at).at_rest(np.full(2, 34 * PITCH))
    grains, steps = GrainsInRow.begin(made, row, at, now), 1
    t, borne, speed = np.zeros((3, STEPS[density]))
    for one in range(len(t)):
        engine.set_fluid(grains.sampled)
        engine.advance(steps).raise_if_any()
        x, v, taken = engine.kinematics()
        now, steps = grains.exchange(now, x, v, taken, steps * made.dt), 100
        t[one], speed[one] = now.t, v[:, 2].mean()
        assert now.pressure is not None
        borne[one] = RHO * now.pressure[:, 0].mean() * length * D / (made.m_weight.sum() * G)
    return {"t": t, "borne": borne, "momentum": 1.0 + np.gradient(speed, t) / G}


# A dam of grains between levels, its water viscous so that Darcy's law holds
SEEPAGE = {"d": 0.005, "phi": 0.6, "length": 0.2, "high": 0.1, "low": 0.02, "nu": 1e-5}


def dupuit_surface(x: Floats) -> Floats:
    """Surface in the dam, x from its upper face, and beside it [m]."""
    fall = (SEEPAGE["high"] ** 2 - SEEPAGE["low"] ** 2) / SEEPAGE["length"]
    return np.sqrt(SEEPAGE["high"] ** 2 - fall * np.clip(x, 0.0, SEEPAGE["length"]))


def seeping(pressure: str) -> dict[str, Floats]:
    """Water that seeps through a rectangular dam of grains: discharge over Dupuit's, and its surface."""
    dx, dz = 0.005, 0.005
    dam, beside = round(SEEPAGE["length"] / dx), 20
    n = dam + 2 * beside
    inside = np.zeros((n, 1))
    inside[beside : beside + dam] = 1.0
    phi = SEEPAGE["phi"] * inside * np.ones(26)
    solid = PorousSolid.of_grains(phi, SEEPAGE["d"], SEEPAGE["nu"], inertia=False)
    high, low = (RowEnd(EndKind.LEVEL, level=SEEPAGE[one]) for one in ("high", "low"))
    column = water(dz, 26, SEEPAGE["high"])
    row = ColumnRow(column, dx, np.zeros(n), G, high, low, pressure=Pressure.of(pressure))
    start = dupuit_surface(row.x - beside * dx)
    now, arrays = row_at_rest(row, start, solid), RowArrays.of(row)
    before = advance_row(row, now, 9.0, solid=solid, arrays=arrays)
    now = advance_row(row, before, 1.0, solid=solid, arrays=arrays)
    conductivity = (1.0 - SEEPAGE["phi"]) * G / ergun_linear(SEEPAGE["phi"], SEEPAGE["d"], SEEPAGE["nu"])
    conductivity *= 1.0 - SEEPAGE["phi"]
    dupuit = conductivity * (SEEPAGE["high"] ** 2 - SEEPAGE["low"] ** 2) / (2.0 * SEEPAGE["length"])
    return {
        "x": row.x - beside * dx, "surface": now.surface[row.inner],
        "ratio": np.array((now.passed[-1] - before.passed[-1]) / dupuit),
    }  # fmt: skip


BED = {"d": 0.005, "phi": 0.55, "deep": 0.1, "speed": 0.005}  # through which water rises [m/s]


def rising() -> dict[str, Floats]:
    """Pressure over height in a bed through which water rises, beyond the hydrostatic one, over rho g."""
    dz, dx = 0.005, 0.02
    column = water(dz, 60, 0.12, nu=NU)
    profile = np.full(60, 1e-12)
    profile[0] = 1.0
    inlet = RowEnd(EndKind.DISCHARGE, discharge=BED["speed"] * dx, profile=profile)
    row = ColumnRow(column, dx, np.zeros(1), G, inlet, WALLS[1], pressure=Pressure.FULL)
    solid = PorousSolid.of_grains(
        np.where((column.z > 2 * dz) & (column.z < BED["deep"]), BED["phi"], 0.0)[None, :], BED["d"], NU
    )
    now = advance_row(row, row_at_rest(row, np.full(1, 0.12), solid), 2.0, solid=solid)
    assert now.pressure is not None
    inside = (column.z > 0.2 * BED["deep"]) & (column.z < 0.8 * BED["deep"])
    through = BED["speed"] / (1.0 - BED["phi"])
    law = (
        ergun_linear(BED["phi"], BED["d"], NU) * through + ergun_quadratic(BED["phi"], BED["d"]) * through**2
    )
    ergun = law / (1.0 - BED["phi"])
    p, z = now.pressure[1, inside], column.z[inside]
    slope = float(np.polyfit(z, p, 1)[0])
    return {"z": z, "head": p / G, "ergun": np.array(ergun / G), "ratio": np.array(-slope / ergun)}


def _sinking() -> list[Task]:
    return [calculation(sinking, density=one, seconds=0.2) for one in DENSITIES]


def _seeping() -> list[Task]:
    return [calculation(seeping, pressure=one, seconds=3.0) for one in BOTH]


def _rising() -> Task:
    return calculation(rising, seconds=0.1)


def tasks(plan: Plan) -> Sequence[Task]:
    """Ten minutes, without seepage and scour ten seconds when quick; at the full level three hours more."""
    every = [*_sinking(), _rising()]
    if plan.level is Level.QUICK:
        return every
    every += [*_seeping(), *scour.tasks()]
    return [*every, *immersed.tasks(), *beds.tasks()] if plan.level is Level.FULL else every


def measure(run: Results, one: CaseRun) -> dict[str, Floats]:
    """Numbers of a scour or of a bed; the other tasks are calculations."""
    return (scour if one.case == scour.CASE else beds).measure(run, one)


def judge(found: Found, plan: Plan) -> Sequence[Finding]:
    """Each beside a closed form; columns under water by experiments; beds by the limits of others."""
    every = [_borne(found), _rises(found)]
    if plan.level is Level.QUICK:
        return every
    every += [_seeps(found), *scour.judge(found)]
    return [*every, *immersed.judge(found), *beds.judge(found)] if plan.level is Level.FULL else every


def _borne(found: Found) -> Finding:
    runs: Mapping[float, Mapping[str, Floats]] = {
        one: found[task] for one, task in zip(DENSITIES, _sinking(), strict=True)
    }
    off = dict[str, float]()
    for density, run in runs.items():
        late = slice(3 * len(run["t"]) // 4, None)
        off[f"{density:g}"] = float(np.abs(run["borne"][late] - run["momentum"][late]).max())
    return DECLARED["sinking"].finding(
        [Curve(f"{one:g} kg/m3", run["t"], run["borne"]) for one, run in runs.items()],
        [Curve(f"by momentum, {one:g} kg/m3", run["t"], run["momentum"]) for one, run in runs.items()],
        {"off": off},
    )  # fmt: skip


def _seeps(found: Found) -> Finding:
    own, still = (found[one] for one in _seeping())
    x = np.linspace(0.0, SEEPAGE["length"], 60)
    off = abs(float(own["ratio"]) - 1.0)
    return DECLARED["dam"].finding(
        [Curve(word, run["x"], run["surface"]) for word, run in zip(BOTH, (own, still), strict=True)],
        [Curve("Dupuit", x, dupuit_surface(x))], {"discharge": off}, ratio=float(still["ratio"]),
    )  # fmt: skip


def _rises(found: Found) -> Finding:
    run = found[_rising()]
    line = run["head"][0] - run["ergun"] * (run["z"] - run["z"][0])
    return DECLARED["rising"].finding(
        [Curve("row", run["head"], run["z"])], [Curve("Ergun", line, run["z"])],
        {"gradient": abs(float(run["ratio"]) - 1.0)},
    )  # fmt: skip
