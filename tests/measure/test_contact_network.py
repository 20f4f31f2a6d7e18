"""Contact forces of arrangements whose forces follow from their weight, run until they are at rest."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ryusa.build import scene as scene_of
from ryusa.errors import ResultsError
from ryusa.measure import ContactNetwork, bounds, contact_network, snapshot
from ryusa.results import Results
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

D, G = 0.002, 9.8
FLOOR = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]


def run(folder: Path, forces: bool, time: float, **how) -> Results:
    how = {"restitution": 0.3, "gravity": G, "steps_per_contact": 20.0, "allow_overlap": True} | how
    scene, state = scene_of(**how)
    return run_scene(
        replace(scene, forces=forces), state, folder, frames=time / 5, stop=Stop(time=time), progress=False
    )


def by_height(found: ContactNetwork) -> np.ndarray:
    return np.argsort(np.minimum(found.begin[:, 2], found.end[:, 2]))


@pytest.mark.parametrize("forces", [True, False])
@pytest.mark.parametrize("plane", [True, False])
def test_each_contact_of_a_column_at_rest_carries_the_weight_above(tmp_path, forces, plane):
    x = np.array([(D, D, (k + 1.5) * D) for k in range(5)])
    bed = {"x_fixed": np.array([(D, D, 0.5 * D)])}
    one = run(tmp_path / "run", forces, 0.1, x=x, d=np.full(5, D), plane_case=plane, **bed)
    found = contact_network(one)
    assert found.recorded == forces
    order = by_height(found)
    weight = float(one.scene.m[0]) * G
    np.testing.assert_allclose(found.f_n[order], weight * np.arange(5, 0, -1), rtol=1e-6)
    lower, upper = np.minimum(found.begin, found.end)[order], np.maximum(found.begin, found.end)[order]
    np.testing.assert_allclose(upper[:, 2] - lower[:, 2], D, rtol=1e-3)
    assert (found.j[order[:1]], lower[0, 2]) == (5, 0.5 * D)  # from the centre of the fixed grain
    if forces:
        assert found.f_s.max() < 1e-9 * weight
        assert not found.sliding.any()
    else:
        assert np.isnan(found.f_s).all()


@pytest.mark.parametrize("forces", [True, False])
def test_a_contact_with_a_plane_ends_at_the_point_of_touch(tmp_path, forces):
    one = run(tmp_path / "run", forces, 0.05, x=np.array([(0.0, 0.0, 0.5 * D)]), d=[D], planes=FLOOR)
    found = contact_network(one)
    np.testing.assert_allclose(found.f_n, one.scene.m * G, rtol=1e-6)
    np.testing.assert_allclose(found.end, [(0.0, 0.0, 0.0)], atol=1e-12)
    assert found.rows()[0]["f_n_N"] == found.f_n[0]


@pytest.mark.full
@pytest.mark.parametrize("slides", [True, False])
def test_a_grain_on_an_incline_slides_above_the_friction_angle_and_sticks_below(tmp_path, slides):
    slope, mu = 0.4, math.tan(0.3 if slides else 0.5)  # slope as an angle
    one = run(
        tmp_path / "run", True, 0.05, x=np.array([(0.0, 0.0, 0.5 * D)]), d=[D], planes=FLOOR, rotation=False,
        slope=slope, friction=mu,
    )  # fmt: skip
    found = contact_network(one)
    weight = float(one.scene.m[0]) * G
    normal, along = weight * math.cos(slope), weight * math.sin(slope)
    np.testing.assert_allclose(found.f_n, normal, rtol=1e-4)
    assert found.sliding.tolist() == [slides]
    if not slides:
        np.testing.assert_allclose(found.f_s, along, rtol=1e-4)
    else:
        assert found.f_s[0] >= mu * normal * (1.0 - 1e-4)


def test_a_contact_across_a_periodic_limit_goes_to_the_nearest_image(tmp_path):
    x = np.array([(0.3 * D, D, 0.5 * D), (4.35 * D, D, 0.5 * D)])  # 0.95 D apart through the limit
    one = run(
        tmp_path / "run", True, 5e-5, x=x, d=[D, D], planes=FLOOR, period=(5 * D, math.inf), plane_case=True
    )
    found = contact_network(one, 0.0)
    assert len(found.i) == 0  # no step, no forces yet
    found = contact_network(one, 1e-5)
    both = found.j < 2
    assert both.sum() == 1
    assert np.linalg.norm(found.end - found.begin, axis=1)[both][0] == pytest.approx(0.95 * D, rel=1e-2)


def test_slices_share_out_all_contacts_once(tmp_path):
    rng = np.random.default_rng(1)
    places = np.stack(np.meshgrid(*[np.arange(4) * 0.98 * D] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    x = places + rng.uniform(-0.05, 0.05, places.shape) * D + [0.0, 0.0, 0.6 * D]
    for period in (math.inf, 4.0 * D):
        one = run(
            tmp_path / f"run{period}",
            True,
            5e-5,
            x=x,
            d=np.full(64, D),
            planes=FLOOR,
            period=(math.inf, period),
        )
        pieces = [contact_network(one, lane=k) for k in range(contact_network(one).slices)]
        assert len(pieces) >= 3
        whole = one.contact_forces(-1)
        found = sorted((i, j) for piece in pieces for i, j in zip(piece.i, piece.j, strict=True))
        assert found == sorted(zip(whole["i"], whole["j"], strict=True))
        for piece in pieces:
            assert set(piece.i) | set(piece.j[piece.j < 64]) <= set(piece.seen.grains)
            assert piece.slice_y[1] - piece.slice_y[0] == pytest.approx(D, rel=0.4)
        with pytest.raises(ResultsError, match="no slice 9"):
            contact_network(one, lane=9)


def test_bounds_hold_the_grains_and_speeds_of_all_frames(tmp_path):
    x = np.array([(0.0, 0.0, 4 * D), (3 * D, 0.0, 6 * D)])
    one = run(tmp_path / "run", False, 0.05, x=x, d=[D, D], planes=FLOOR, plane_case=True)
    found = bounds(one)
    for t in one.frames.t:
        seen = snapshot(one, float(t))
        assert found.left <= (seen.x[:, 0] - 0.5 * D).min()
        assert found.right >= (seen.x[:, 0] + 0.5 * D).max()
        assert found.bottom <= (seen.x[:, 2] - 0.5 * D).min()
        assert found.top >= (seen.x[:, 2] + 0.5 * D).max()
    assert found.top == pytest.approx(6.5 * D)
    assert 0.0 < found.speed <= max(np.linalg.norm(v, axis=1).max() for v in one.frames.v)
