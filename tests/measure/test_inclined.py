"""Uniform flow on an inclined bottom is the same in a level frame and in one along it."""

import math
from typing import Any

import numpy as np
import pytest
from tests.casefile.test_row import RIVER
from tests.measure.made_rows import CELLS, G, run_of

from ryusa.casefile import read_text
from ryusa.casefile.row.values import reaches
from ryusa.laws.families import BedKind, SurfaceRule
from ryusa.measure.depth_history import depth_history
from ryusa.measure.inclined import fall_of
from ryusa.measure.long_section import long_section
from ryusa.model.column import Column
from ryusa.model.row import ColumnRow, EndKind, RowEnd

ANGLE, DEPTH, DISCHARGE, LENGTH = math.radians(10.0), 0.02, 0.04, 0.8  # of the bottom; normal to it, along it
N = 8


def flow(turn: float, depth: float = DEPTH, *, ends: bool = True, solid: Any = None) -> Any:
    """Three frames of uniform flow over a bottom at `ANGLE`, by an x axis that falls by `turn` [rad]."""
    inclined = ANGLE - turn
    dx = LENGTH * math.cos(inclined) / N
    column = Column(0.0, 0.5e-3, CELLS, 0.02, area=1.0, bed=BedKind.MOVING, phi_max=0.6,
                    g_x=G * math.sin(turn), surface=SurfaceRule.VOLUME)  # fmt: skip
    bottom: Any = -math.tan(inclined) * dx * (np.arange(N) + 0.5)
    wall = RowEnd(EndKind.WALL) if ends else None
    row = ColumnRow(column, dx, bottom, G * math.cos(turn), wall, wall, solid=solid)
    t, x = np.arange(3) * 0.1, np.full((3, 1, 3), 1.0)
    stations = N + ends
    run = run_of(
        row, t, x, np.zeros_like(x), surface=np.tile(bottom + depth / math.cos(inclined), (3, 1)),
        discharge=np.full((3, stations), DISCHARGE), passed=np.tile(DISCHARGE * t[:, None], (1, stations)),
    )  # fmt: skip
    object.__setattr__(run.scene, "gravity", np.array([G * math.sin(turn), 0.0, -G * math.cos(turn)]))
    return run


@pytest.mark.parametrize("means", [{}, {"begin": 0.0}])
def test_froude_number_and_energy_head_do_not_depend_on_the_frame(means: dict[str, Any]) -> None:
    speed = DISCHARGE / DEPTH
    froude = speed / math.sqrt(G * math.cos(ANGLE) * DEPTH)
    critical = (DISCHARGE**2 / (G * math.cos(ANGLE))) ** (1.0 / 3.0)
    for turn in (0.0, 0.5 * ANGLE, ANGLE):
        run = flow(turn)
        found = long_section(run, **means)
        assert found.froude == pytest.approx(froude)
        assert found.critical * math.cos(ANGLE - turn) == pytest.approx(critical)
        head = found.elevation(found.energy) - found.elevation(found.surface)
        assert head == pytest.approx(speed**2 / (2.0 * G))
        assert depth_history(run, begin=0.0).froude == pytest.approx(froude)


def test_the_froude_number_of_uniform_flow_is_that_of_check() -> None:
    keys: dict[str, Any] = {"motion.gravity": f"{G} m/s2", "motion.slope": 0.0}
    bottom = [["0 m", "0 m"], ["4 m", f"{-4.0 * math.tan(ANGLE)} m"]]
    keys |= {"water.row.upstream.discharge": f"{DISCHARGE} m2/s", "water.row.bottom": bottom}
    case = read_text(RIVER, keys)
    (reach,) = reaches(case, DISCHARGE)
    assert reach.slope == pytest.approx(ANGLE)
    for turn in (0.0, ANGLE):
        assert long_section(flow(turn, reach.normal)).froude == pytest.approx(reach.froude)


def test_the_crest_of_a_closed_dam_is_level() -> None:
    solid = np.zeros(N, np.int64)
    solid[3:5] = 4
    fall = fall_of(flow(0.0, solid=solid).row.row)
    assert fall[3:5] == pytest.approx(0.0) and fall[[0, 2, 5, 7]] == pytest.approx(math.tan(ANGLE))


def test_a_bottom_that_repeats_is_inclined_at_its_ends_too() -> None:
    row = flow(ANGLE, ends=False).row.row
    wave = 0.01 * np.sin(2.0 * np.pi * np.arange(N) / N)
    object.__setattr__(row, "bottom", wave)
    assert fall_of(row)[0] == pytest.approx((wave[-1] - wave[1]) / (2.0 * row.dx))


def test_depth_and_section_take_the_gravity_of_their_moment() -> None:
    run = flow(0.0)
    later = {"gravity": np.array([G * math.sin(0.2), 0.0, -G * math.cos(0.2)])}
    run.scene_at = lambda t: type("Scene", (), {"gravity": run.scene.gravity} | (later if t > 0.05 else {}))
    history = depth_history(run, begin=0.0)
    for k, t in enumerate(history.t.tolist()):
        assert history.froude[k] == pytest.approx(long_section(run, t=t).froude)
    assert history.froude[1, 0] != pytest.approx(history.froude[0, 0], rel=1e-3)
