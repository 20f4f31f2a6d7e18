"""Runs with clumps: recorded, stopped and resumed with the same bits, measured."""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ryusa
from ryusa.casefile.read import read_text
from ryusa.catalogue import MEASURES, PICTURES
from ryusa.errors import ResultsError
from ryusa.results import Results, schema
from ryusa.results.scene_file import scene_digest

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences
from kinds import KINDS

CLUMPS, CLUMPS_IN_WATER = KINDS["clumps"], KINDS["clumps-water"]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return ryusa.run(read_text(CLUMPS), tmp_path_factory.mktemp("c") / "run", progress=False, threads=2)


def test_frames_hold_the_motion_of_clumps(whole: Results) -> None:
    scene, bodies = whole.scene, whole.bodies
    assert scene.bodies is not None
    assert bodies is not None
    assert bodies.q.shape == (len(whole.frames), scene.bodies.n, 4)
    for k in (0, len(whole.frames) - 1):
        moved, x = bodies[k], np.asarray(whole.frames.x_wrapped[k])
        apart = x[scene.bodies.members] - moved.of_members(scene.bodies)[0]
        for a in range(2):
            if np.isfinite(scene.period[a]):
                apart[:, a] -= scene.period[a] * np.round(apart[:, a] / scene.period[a])
        assert np.abs(apart).max() < 1e-12
        assert np.linalg.norm(moved.q, axis=1) == pytest.approx(1.0, abs=1e-14)
    moved = bodies[-1]
    spin = 0.5 * np.sum(moved.momentum * moved.spin(scene.bodies))
    alone = scene.bodies.of_grain(scene.n_grain) < 0
    spin += 0.5 * np.sum((scene.inertia[:, None] * np.asarray(whole.frames.omega[-1]) ** 2)[alone])
    assert whole.tally["spin"][-1] == pytest.approx(spin, rel=0.05)  # half a step apart
    assert whole.tally["residual"][-1] < 1e-3


def test_the_scene_is_read_as_it_was_written(whole: Results) -> None:
    assert scene_digest(whole.scene) == scene_digest(Results.open(whole.folder).scene)
    assert whole.scene.bodies is not None
    assert whole.scene.bodies.names == ("rod", "tetrahedron")


def test_a_stopped_run_of_clumps_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any
) -> None:
    stop_at(round(0.55 * whole.summary["steps"]))
    assert ryusa.run(read_text(CLUMPS), tmp_path / "run", progress=False).status == schema.STOPPED
    again = read_text((tmp_path / "run" / schema.CASE_TOML).read_text())
    assert ryusa.run(again, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.parametrize("entry", [one for one in (*MEASURES, *PICTURES) if not one.clumps])
def test_what_takes_spheres_for_grains_refuses_by_name(whole: Results, entry: Any) -> None:
    call = whole.measure if entry in MEASURES else whole.draw
    with pytest.raises(ResultsError, match="clumps"):
        call(entry.name)


def test_the_others_take_clumps(whole: Results) -> None:
    assert np.isfinite(whole.measure("energy").residual)
    assert len(whole.measure("sizes").d) == 120
    whole.draw("grains")
    whole.draw("energy")
    whole.draw("tracks", grains=[0, 1])


@pytest.fixture(scope="module")
def wet(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return ryusa.run(read_text(CLUMPS_IN_WATER), tmp_path_factory.mktemp("c") / "run", progress=False)


@pytest.mark.full
def test_a_stopped_run_of_clumps_in_water_resumes_with_the_same_bits(
    wet: Results, tmp_path: Path, stop_at: Any
) -> None:
    assert wet.summary["water"]["momentum_residual"] < 1e-9
    assert wet.tally["residual"][-1] < 1e-3
    stop_at(round(0.55 * wet.summary["steps"]))
    first = ryusa.run(read_text(CLUMPS_IN_WATER), tmp_path / "run", progress=False)
    assert first.status == schema.STOPPED
    again = read_text((tmp_path / "run" / schema.CASE_TOML).read_text())
    assert ryusa.run(again, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(wet.folder, tmp_path / "run") == []


@pytest.mark.full
def test_what_spheres_of_a_clump_share_counts_once(wet: Results) -> None:
    """Solid volume over the bed and its flux are those of the clumps, not of all their spheres."""
    scene, area = wet.scene, 0.016 * 0.012
    d, m = scene.whole_grains()
    solid = float((np.pi / 6.0 * d**3).sum())
    assert scene.solid_volume.sum() == pytest.approx(solid, rel=1e-12)
    assert (np.pi / 6.0 * scene.d**3).sum() > 1.05 * solid
    found = wet.measure("profile", begin=0.0)
    assert found.phi.value.sum() * found.thickness == pytest.approx(solid / area, rel=1e-12)
    assert found.d == pytest.approx(d.mean())
    assert found.density == pytest.approx(m.sum() / solid)
    carried = float(scene.m @ np.asarray(wet.frames.v[-1])[:, 0]) / 2650.0 / area
    assert found.q[-1] == pytest.approx(carried, rel=1e-12)
    phi = np.asarray(wet.water.phi[-1])
    assert wet.water.faces[1] > wet.water.faces[0]
    cell = float(wet.water.faces[1] - wet.water.faces[0])
    bed = float((np.pi / 6.0 * scene.d_fixed**3).sum())
    assert phi.sum() * cell * area <= (solid + bed) * (1.0 + 1e-9)
    for name in ("transport", "water"):
        wet.measure(name, begin=0.0)
    wet.draw("profile", begin=0.0)
