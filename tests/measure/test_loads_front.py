"""A moving bore that runs against a dam: found, and held against its closed form; a pond that fills is none.

The bands were fixed before the first run: 2 % of the force, as the depth behind a reflected bore is allowed
1 % (`ryusa validate river`), and 1 % of speed and depth of the bore that comes.
"""

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ryusa.figures.loads import loads as drawn
from ryusa.laws.bore import reflected_bore
from ryusa.laws.families import SurfaceRule
from ryusa.measure.loads import Loads, loads
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowDam, RowEnd
from ryusa.results.water import WaterFrames
from ryusa.water.row import advance_row, row_at_rest

FORCE, FLOW = 0.02, 0.01
G, RHO, DX, N, TALL = 9.80665, 1000.0, 0.005, 600, 0.25
DAM = RowDam("dam", 560, 570, TALL)
STILL, DEEP = 0.01, 0.04  # depth before and behind the bore [m]
SPEED = (DEEP - STILL) * math.sqrt(0.5 * G * (DEEP + STILL) / (DEEP * STILL))  # of the water behind it


def run_of(surface: Any, speed: Any, inlet: RowEnd, time: float, every: float, *, coarse: int = 1) -> Any:
    """Water without friction, in one layer, before a dam as high as a cell, behind which it is dry."""
    n, dx, first, end = N // coarse, DX * coarse, DAM.first // coarse, DAM.end // coarse
    solid = np.where((np.arange(n) >= first) & (np.arange(n) < end), 1, 0)
    column = Column(
        z_low=0.0, dz=TALL, n=2, depth=STILL, nu=1e-15, area=n * dx, surface=SurfaceRule.VOLUME
    )  # fmt: skip
    dams = (RowDam("dam", first, end, TALL),)
    row = ColumnRow(column, dx, np.zeros(n), G, inlet, RowEnd(EndKind.FREE_FALL), solid, dams=dams)
    now = row_at_rest(row, np.where(np.arange(n) < first, surface, 0.0))
    speeds = np.zeros_like(now.u)
    speeds[:first] = np.broadcast_to(speed, n)[:first, None]
    now, kept = replace(now, u=speeds), []
    t = np.arange(0.0, time, every)
    for k in range(len(t)):
        now = advance_row(row, now, every) if k else now
        kept.append(now)
    frames = {name: np.zeros((len(t), *shape)) for name, shape in row.frame_shapes().items()}
    frames |= {name: np.array([getattr(one, name) for one in kept]) for name in ("passed", "u")}
    frames |= {
        name: np.array([getattr(one, name)[row.inner] for one in kept])
        for name in ("surface", "volume", "content")
    }
    scene = SimpleNamespace(walls=None, n_grain=0, gravity=np.array([0.0, 0.0, -G]))
    return SimpleNamespace(case={}, scene=scene, row=WaterFrames(row, t, **frames))


@pytest.fixture(scope="module")
def struck() -> Loads:
    behind = np.arange(N) < 300
    inlet = RowEnd(EndKind.DISCHARGE, discharge=SPEED * DEEP, depth=DEEP)
    run = run_of(np.where(behind, DEEP, STILL), np.where(behind, SPEED, 0.0), inlet, 2.1, 0.02)
    return loads(run, window=0.3)


def test_the_mean_force_after_reflection_is_that_of_the_closed_form(struck: Loads) -> None:
    force = 0.5 * RHO * G * reflected_bore(SPEED, DEEP, G)[0] ** 2
    came = (DAM.first - 300) * DX * (DEEP - STILL) / (SPEED * DEEP)
    after = (struck.t > came + 0.05) & (struck.t < came + 0.55)
    assert struck.water[after, 0, 0].mean() / struck.width == pytest.approx(force, rel=FORCE)
    still = struck.water[struck.t < came - 0.05, 0, 0] / struck.width
    assert still == pytest.approx(np.full(len(still), 0.5 * RHO * G * STILL**2), rel=1e-9)


def test_the_front_is_found_with_its_speed_and_depth_and_printed_beside_formulae(struck: Loads) -> None:
    (front,) = struck.fronts
    assert front is not None
    assert front.u == pytest.approx(SPEED, rel=FLOW)
    assert front.h == pytest.approx(DEEP, rel=FLOW)
    assert front.c == 0.0
    assert struck["dam: largest over reflected bore"].value == pytest.approx(1.0, abs=FORCE)
    assert struck["dam: formula, rho u^2 h"].value == pytest.approx(RHO * SPEED**2 * DEEP, rel=3.0 * FLOW)
    assert any("front against dam" in one for one in struck.averages.notes)
    drawn(struck)


def test_a_pond_that_fills_is_no_front() -> None:
    inlet = RowEnd(EndKind.DISCHARGE, discharge=0.004)
    found = loads(run_of(STILL, 0.0, inlet, 12.0, 0.2, coarse=3))
    assert found.fronts == (None,)
    assert not any("front" in one.name or "formula" in one.name for one in found.averages.items)
    assert any(one.startswith("no formulae for a front against") for one in found.averages.notes)
