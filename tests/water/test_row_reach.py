"""A periodic row of columns against one column, with moving grains: the borders of columns stir no grain."""

import math
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from ryusa.build import build
from ryusa.casefile import read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws.families import SurfaceRule
from ryusa.model.column import STIFF
from ryusa.model.row import ColumnRow
from ryusa.water.row_grains import GrainsInRow

SEEDS, STATIONS = (1, 2, 3, 4), 8
BEGIN, END = 2.0, 6.0  # times between which it is averaged [s]
# Registered before the first run. Two samples of four seeds differ by more than this many standard errors in
# one case of a hundred (Student, 6 degrees of freedom, both sides).
LIMIT = 3.71
# largest standard error of the mean over the mean: above it the comparison would say nothing
MOST = {"q_star": 0.15, "discharge": 0.03, "u_high": 0.03, "u_low": 0.15, "phi_low": 0.15, "height": 0.03}


def reach(seed: int, n: int) -> dict[str, float]:
    """Means of the case `bedload_3d` in a row of n segments; one segment is one column."""
    text = files("ryusa.cases").joinpath("bedload_3d.toml").read_text(encoding="utf-8")
    built = build(read_text(text, {"seed": str(seed)}))
    fixed, column = built.scene, replace(built.scene.column, surface=SurfaceRule.VOLUME)
    row = ColumnRow(column, fixed.period[0] / n, np.full(n, column.z_low), -float(fixed.gravity[2]))
    surface = np.full(n, column.z_surface)
    engine = CpuEngine()
    engine.load(fixed, built.state)
    state = GrainsInRow.begin(fixed, row, built.state.x).flowing(surface)
    grains = GrainsInRow.begin(fixed, row, built.state.x, state)
    volume, d = np.pi / 6.0 * fixed.d**3, float(fixed.d.mean())
    scale = math.sqrt(1.65 * 9.81 * d**3)
    low = (column.z > column.origin) & (column.z < column.origin + 2.0 * d)
    high = (column.z > column.origin + 10.0 * d) & (column.z < column.origin + 18.0 * d)
    t, steps, found = 0.0, 1, []
    while t < END:
        engine.set_fluid(grains.sampled)
        engine.advance(steps).raise_if_any()
        time = steps * fixed.dt
        x, v, taken = engine.kinematics()
        state = grains.exchange(state, x, v, taken, time)
        t += time
        steps = max(min(column.interval, math.floor(STIFF / (grains.fastest * fixed.dt))), 1)
        if t > BEGIN:
            u, phi = state.u.mean(axis=0), grains.phi.mean(axis=0)
            found.append(
                (
                    float(volume @ v[:, 0]) / column.area / scale,
                    float((state.content * state.u).sum(axis=1).mean()),
                    u[high].mean(), u[low].mean(), phi[low].mean(), float(volume @ x[:, 2] / volume.sum()),
                )
            )  # fmt: skip
    assert grains.worst < 1e-9
    return dict(zip(MOST, np.mean(found, axis=0).tolist(), strict=True))


@pytest.mark.slow
def test_a_row_of_eight_stations_moves_as_much_as_one_column():
    column, row = ([reach(seed, n) for seed in SEEDS] for n in (1, STATIONS))
    apart = {}
    for name, most in MOST.items():
        a, b = (np.array([one[name] for one in of]) for of in (column, row))
        error = math.hypot(a.std(ddof=1), b.std(ddof=1)) / math.sqrt(len(SEEDS))
        assert error < most * abs(a.mean()), (name, a, b)
        apart[name] = (b.mean() - a.mean()) / error
        print(f"{name}: column {a.mean():.5g}, row {b.mean():.5g}, standard error {error:.2g}")
    assert max(map(abs, apart.values())) < LIMIT, apart
