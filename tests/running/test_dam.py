"""The packaged dam: its walls carry the weight of the grains, and took the momentum that these lack."""

import math
from pathlib import Path

import numpy as np
import pytest

import ryusa
from ryusa.casefile.read import read
from ryusa.cases import case_path
from ryusa.results import Results

pytestmark = pytest.mark.full

COARSE = {"grains.diameter": "16 mm", "stop.time": "2 s"}  # a ninth of the grains


@pytest.fixture(scope="module")
def coarse(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return ryusa.run(
        read(case_path("dam.toml"), COARSE), tmp_path_factory.mktemp("dam") / "run", progress=False
    )


def test_bed_sides_and_dam_carry_the_weight_at_rest(coarse: Results) -> None:
    scene, there = coarse.scene, np.isfinite(np.asarray(coarse.frames.x[-1])[:, 0])
    weight = 9.81 * float(scene.m[there].sum())
    found = coarse.measure("walls", begin=1.8)
    force, slope = found.force.mean(axis=0).sum(axis=0), math.radians(42.0)
    # at rest but for the few that still roll over the dam or off its sides
    speed = np.linalg.norm(np.asarray(coarse.frames.v[-1])[there], axis=1)  # [m/s]
    assert np.median(speed) < 0.005
    assert float(scene.m[there] @ speed) < 0.02 * float(scene.m[there].sum()) * 9.81 * (2.0 - 1.8)
    assert force[0] == pytest.approx(weight * math.sin(slope), rel=0.02)
    assert force[2] == pytest.approx(-weight * math.cos(slope), rel=0.02)
    assert abs(force[1]) < 0.02 * weight
    dam = found.names.index("dam")
    assert found.force[:, dam, 0].mean() > 0.5 * force[0]  # steeper than the grains hold on the bed


def test_walls_took_what_weight_gave_and_the_grains_do_not_have(coarse: Results) -> None:
    """p_x = M g sin(slope) t - impulse on all walls, at every frame before the first grain is gone."""
    scene, slope = coarse.scene, math.radians(42.0)
    impulse = np.asarray(coarse.walls).reshape(len(coarse.frames), scene.n_wall, -1)[:, :, 0].sum(axis=1)
    t = np.asarray(coarse.tally["t"])
    given = 9.81 * float(scene.m.sum()) * math.sin(slope) * t
    had = np.array([float(scene.m @ np.asarray(v)[:, 0]) for v in coarse.frames.v])
    all_there = np.isfinite(had)
    assert t[all_there].max() > 0.9  # the dam was hit
    assert had[all_there].max() > 0.5  # [N s]
    assert had[all_there] == pytest.approx((given - impulse)[all_there], abs=2e-3 * given.max())


def test_the_dam_is_drawn(coarse: Results, tmp_path: Path) -> None:
    seen = ryusa.measure.snapshot(coarse, 1.0)
    names = coarse.scene_at(1.0).walls.active
    assert len(seen.wall_lines) == 4 * int(names.sum())  # rectangles; the gate is gone
    tops = seen.wall_lines[np.all(np.isclose(seen.wall_lines[:, :, 0], 1.0), axis=1)][:, :, 2]
    assert tops.max() == pytest.approx(0.08)
    coarse.draw("grains").savefig(tmp_path / "grains.png")
    coarse.draw("walls").savefig(tmp_path / "walls.png")
