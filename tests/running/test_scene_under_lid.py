"""Grains under a lid in a scene of arrays: their contact forces, and stress over height.

Bands were set before the runs: 5 % of the load for what contacts must carry.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import ryusa
from ryusa import build
from ryusa.build.walls import SolidWall
from ryusa.errors import ResultsError
from ryusa.model import Scene, State
from ryusa.results import Results
from ryusa.running.stops import Stop

D, PRESSURE, DENSITY = 2.0e-3, 400.0, 2500.0
LENGTH, WIDTH = 5.5 * D, 4.4 * D
AREA = LENGTH * WIDTH
TOP = 0.0132
STOP = Stop(time=0.4, settle=0.2)


def under(top: SolidWall, walls: list[SolidWall], speed: float = 0.0, **law: object) -> tuple[Scene, State]:
    """5 x 4 x 5 grains on a lattice, not all of one size, under a lid that is pressed and drawn along."""
    lattice = np.stack(np.meshgrid(range(5), range(4), range(5), indexing="ij"), -1).reshape(-1, 3)
    x = (lattice + 0.5) * [1.1 * D, 1.1 * D, 1.12 * D] + [0.0, 0.0, 0.5 * D]
    d = D * (0.94 + 0.11 * (np.arange(len(x)) * 0.618 % 1.0))
    servo = build.Servo((0.0, 0.0, -1.0), 0.2, 0.01, pressure=PRESSURE)
    lid = replace(top, motion=build.WallMotion(velocity=(speed, 0.0, 0.0)), servo=servo)
    given = {"restitution": 0.4, "stiffness": 1500.0, "density": DENSITY, **law}
    return build.scene(x, d, walls=[*walls, lid], **given)


def cell() -> tuple[Scene, State]:
    """A periodic cell between two plates with ridges, whose lid is drawn along."""
    base = build.ridges("base", (0, 0, 0), (LENGTH, 0, 0), (0, WIDTH, 0), 5, 0.5 * D)
    top = build.ridges("lid", (0, WIDTH, TOP + 0.5 * D), (LENGTH, 0, 0), (0, -WIDTH, 0), 5, 0.5 * D)
    return under(top, [base], 0.1, friction=0.5, period=(LENGTH, WIDTH))


def box() -> tuple[Scene, State]:
    """A box without friction under a lid that is larger than it is."""
    long, wide, up = (LENGTH, 0, 0), (0, WIDTH, 0), (0, 0, 0.03)
    sides = [
        build.rectangle("floor", (0, 0, 0), long, wide),
        build.rectangle("left", (0, 0, 0), wide, up),
        build.rectangle("right", (LENGTH, 0, 0), wide, up),
        build.rectangle("front", (0, 0, 0), long, up),
        build.rectangle("back", (0, WIDTH, 0), long, up),
    ]
    top = build.rectangle("lid", (-D, -D, TOP), (LENGTH + 2 * D, 0, 0), (0, WIDTH + 2 * D, 0))
    return under(top, sides, friction=0.0)


def ran(made: tuple[Scene, State], folder: Path, stop: Stop = STOP, forces: bool = True) -> Results:
    return ryusa.run_scene(*made, folder, frames=0.005, stop=stop, forces=forces, progress=False)


def test_stress_in_steady_shear_is_that_on_the_lid_at_every_height(tmp_path: Path) -> None:
    run = ran(cell(), tmp_path / "run")
    found, walls = run.measure("contact_stress"), run.measure("walls")
    assert found.area == pytest.approx(AREA, rel=1e-12)
    assert found.deviation < 0.05 and found.deviation_along < 0.05
    core = (found.z > 2 * D) & (found.z < found.z[found.phi.value > 0.3].max() - D)
    on_lid = walls.force[:, 1].mean(axis=0) / AREA
    np.testing.assert_allclose(found.xz.value[core], on_lid[0], atol=0.05 * on_lid[2])
    assert np.ptp(found.xz.value[core]) < 0.05 * on_lid[2]
    assert (found.fabric_xz.value[core] < 0.0).all()  # contacts stand where shear compresses
    both = (found.fabric_xx.value + found.fabric_zz.value)[core]
    assert ((both > 0.5) & (both < 1.0)).all()
    assert {"fabric_xx", "fabric_zz_error"} <= set(found.rows()[0])


def test_a_settled_bed_carries_the_lid_and_the_grains_above(tmp_path: Path) -> None:
    """The vertical stress is p + rho g phi (h - z), and walls without friction take nothing of it.

    The grains come to rest, and what steps and dashpots exchange under the load does not end the run.
    """
    run = ran(box(), tmp_path / "run")
    found, layers = run.measure("contact_stress", begin=0.3), run.measure("profile", begin=0.3)
    assert found.area == pytest.approx(AREA, rel=1e-9)
    assert layers.area == pytest.approx(AREA, rel=1e-9)
    solid = float(run.scene.m.sum()) / DENSITY
    assert layers.phi.value.sum() * layers.thickness == pytest.approx(solid / AREA, rel=1e-9)
    above = np.interp(found.z, layers.z, np.cumsum(layers.phi.value[::-1])[::-1] - 0.5 * layers.phi.value)
    expected = PRESSURE + DENSITY * 9.80665 * layers.thickness * above
    core = (found.z > 1.5 * D) & (found.z < layers.z[layers.phi.value > 0.3].max() - D)
    np.testing.assert_allclose(found.zz.value[core], expected[core], rtol=0.05)
    assert found.deviation < 0.05
    assert run.tally["step"][-1] > 0.5 * run.tally["dash_n"][-1] and run.tally["kinetic"][-1] < 1e-15


def test_contact_forces_are_recorded_on_request_alone(tmp_path: Path) -> None:
    short = Stop(time=0.01)
    run = ran(cell(), tmp_path / "without", short, forces=False)
    with pytest.raises(ResultsError, match="holds no contact forces"):
        run.measure("contact_stress")
    run = ran(cell(), tmp_path / "with", short)
    assert run.scene.forces and run.case["record"]["forces"] is True
    assert not math.isnan(run.measure("contact_stress").deviation)


def test_a_ring_of_grains_has_no_profile_since_its_area_is_not_seen_from_its_middle(tmp_path: Path) -> None:
    angle = np.arange(24) * (2.0 * math.pi / 24.0)
    x = np.concatenate(
        [np.stack([0.01 * np.cos(angle), 0.01 * np.sin(angle), 0.0 * angle + z], 1) for z in (0.001, 0.004)]
    )
    tubes = [build.cylinder(f"tube {r:g}", (0, 0, -0.01), (0, 0, 0.04), r) for r in (0.0085, 0.0115)]
    floor = [("floor", (0, 0, 0), (0, 0, 1))]
    made = build.scene(x, D, walls=tubes, planes=floor, restitution=0.4, stiffness=1500.0, density=DENSITY)
    run = ran(made, tmp_path / "run", Stop(time=0.02), forces=False)
    with pytest.raises(ResultsError, match="open along x"):
        run.measure("profile", begin=0.0)
