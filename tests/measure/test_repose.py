import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import CaseError, ResultsError
from ryusa.measure import snapshot, surface
from ryusa.measure.repose import STEEP

D = 0.002


def standing(make, x, *, d=None, v=None, omega=None, **changes):
    """A run of one frame with grains at x (n, 3) on a plane at z = 0 called floor."""
    n = len(x)
    d = np.full(n, D) if d is None else d
    scene = replace(
        make.scene(n),
        d=d,
        x_fixed=np.zeros((0, 3)),
        d_fixed=np.zeros(0),
        fixed_active=np.zeros(0, dtype=bool),
        plane_normal=np.array([[0.0, 0.0, 1.0]]),
        plane_point=np.zeros((1, 3)),
        plane_active=np.ones(1, dtype=bool),
        groups={"floor": (n, n + 1)},
        period=(math.inf, math.inf),
        **changes,
    )
    zero = np.zeros((1, n, 3))
    frames = SimpleNamespace(
        t=np.array([0.0]),
        x=x[None],
        v=zero if v is None else v[None],
        omega=zero if omega is None else omega[None],
    )
    return SimpleNamespace(case={}, frames=frames, scene=scene, contacts=None, tally={})


def triangle(tangent, columns=60, pitch=1.0):
    """Touching columns of grains whose tops lie on a line that falls to the right with `tangent`."""
    rows = []
    for k in range(columns):
        top = (columns - k) * D * pitch * tangent
        rows += [(k * D * pitch, 0.0, z) for z in np.arange(top - D / 2, 0.0, -D)]
    return np.array(rows)


@pytest.mark.parametrize("degrees", [12.0, 18.0, 25.0, 33.0, 40.0])
def test_the_slope_of_grains_on_an_exact_slope_is_found(make, degrees):
    found = surface(standing(make, triangle(math.tan(math.radians(degrees)))))
    assert math.degrees(found.angle) == pytest.approx(degrees, abs=0.5)
    assert math.degrees(found.error) < 0.3
    assert math.degrees(found.spread) < 3.0
    assert not found.flags
    assert found.at_rest
    assert found.floor == 0.0
    assert found.toe == pytest.approx(found.x.max(), abs=2 * D)


def test_the_left_side_is_the_mirror_of_the_right_one(make):
    x = triangle(math.tan(math.radians(30.0)))
    right = surface(standing(make, x))
    left = surface(standing(make, x * [-1, 1, 1]), side="left")
    with pytest.raises(CaseError, match=r"side = 'Left'.*Did you mean 'left'"):
        surface(standing(make, x), side="Left")
    assert left.angle == pytest.approx(right.angle, abs=1e-12)
    assert left.toe == pytest.approx(-right.toe)
    assert np.diff(left.x).min() > 0.0
    assert np.allclose(left.z, right.z[::-1])
    assert left.line[:, 0] == pytest.approx(-right.line[:, 0])


def test_rows_in_y_count_as_one(make):
    x = triangle(math.tan(math.radians(30.0)), columns=30)
    rows = np.concatenate([x + np.array([0.0, k * D, 0.0]) for k in range(3)])
    one = surface(standing(make, x))
    assert surface(standing(make, rows, plane_case=False)).angle == pytest.approx(one.angle, abs=1e-9)


def test_a_wall_of_grains_is_flagged_and_given_no_angle_of_repose(make):
    wall = np.array([(i * D, 0.0, (k + 0.5) * D) for i in range(10) for k in range(20)])
    found = surface(standing(make, wall))
    assert any("wall" in flag for flag in found.flags)
    assert not found.angle < STEEP


def test_a_thin_layer_of_grains_has_too_few_bins(make):
    found = surface(standing(make, np.array([(i * D, 0.0, 0.5 * D) for i in range(30)])))
    assert math.isnan(found.angle)
    assert "too few bins" in found.flags[0]
    assert not any("wall" in flag for flag in found.flags)


def test_where_walls_are_the_floor_the_lowest_grain_lies_on_it(make):
    run = standing(make, triangle(0.5))
    lowest = run.frames.x[0, :, 2].min() - D / 2
    run.scene = replace(
        run.scene,
        plane_normal=np.zeros((0, 3)),
        plane_point=np.zeros((0, 3)),
        plane_active=np.zeros(0, dtype=bool),
    )
    assert surface(run).floor == pytest.approx(lowest)


def test_grains_that_left_the_heap_or_lie_below_its_floor_are_not_part_of_it(make):
    x = triangle(math.tan(math.radians(25.0)), columns=40)
    gone = np.array([(0.2, 0.0, 0.5 * D), (0.21, 0.0, 0.5 * D), (0.05, 0.0, -5 * D)])
    with_gone = surface(standing(make, np.concatenate([x, gone])))
    assert with_gone.away == 3
    assert len(with_gone.grains) == len(x)
    assert with_gone.toe == surface(standing(make, x)).toe


def test_a_heap_is_at_rest_only_where_its_grains_neither_move_nor_spin(make):
    x = triangle(math.tan(math.radians(25.0)), columns=20)
    v, omega = np.zeros_like(x), np.zeros_like(x)
    v[0, 2] = 0.02
    omega[1, 1] = -50.0
    found = surface(standing(make, x, v=v, omega=omega), still=0.01)
    assert found.speed == pytest.approx(0.02)
    assert found.surface_speed == pytest.approx(0.05)
    assert found.moving == pytest.approx(2 / len(x))
    assert not found.at_rest


def test_the_run_out_starts_at_the_gate(make):
    x = triangle(math.tan(math.radians(25.0)), columns=20)
    run = standing(make, x)
    gate = {"gate": (len(x) + 1, len(x) + 2)}
    scene = replace(
        run.scene,
        plane_normal=np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]]),
        plane_point=np.array([[0.0, 0.0, 0.0], [0.03, 0.0, 0.0]]),
        plane_active=np.array([True, False]),
        groups=run.scene.groups | gate,
    )
    run.scene = scene
    found = surface(run)
    assert found.start == 0.03
    assert found.run_out == pytest.approx(found.toe - 0.03)
    assert len(snapshot(run).plane_point) == 1


def test_the_run_out_of_a_heap_behind_a_wall_called_gate_starts_at_its_foot(make):
    x = triangle(math.tan(math.radians(25.0)), columns=20)
    run = standing(make, x)
    bare = surface(run).start
    n = run.scene.n_partner
    run.scene = replace(run.scene, groups=run.scene.groups | {"gate": (n, n + 2)})  # of faces
    assert surface(run).start == bare


def test_other_sizes_and_scales_give_the_same_slope(make):
    rng = np.random.default_rng(3)
    x = triangle(math.tan(math.radians(30.0)), columns=50)
    d = D * rng.uniform(0.9, 1.0, len(x))
    small = surface(standing(make, x, d=d))
    large = surface(standing(make, 100 * x, d=100 * d))
    assert math.degrees(small.angle) == pytest.approx(30.0, abs=1.5)
    assert large.angle == pytest.approx(small.angle, abs=1e-9)
    assert large.still == pytest.approx(10 * small.still)


def test_a_moment_outside_the_run_and_a_wrong_fit_are_refused(make):
    run = standing(make, triangle(0.5, columns=20))
    with pytest.raises(ResultsError, match="no frame at t"):
        surface(run, t=3.0)
    with pytest.raises(ResultsError, match="fit"):
        surface(run, fit=(0.9, 0.1))


def test_a_snapshot_shows_the_lane_asked_for(make):
    t, x, _, events = make.hopping([2.0e-3] * 3, grain=1, n_grain=2)
    both = np.stack([x - [0, 0.008, 0], x], axis=1)
    run = make.run_of(t, both, both, events)
    assert snapshot(run).grains.tolist() == [0]
    one = snapshot(run, lane=1)
    assert one.grains.tolist() == [1]
    assert len(one.bed_x) == 20
    assert set(one.bed_x[:, 1]) == {0.008}
    assert one.lanes == 2
    assert (one.x[:, 0] < run.scene.period[0]).all()
    with pytest.raises(ResultsError, match="no lane 5"):
        snapshot(run, lane=5)


def test_a_bed_that_is_periodic_along_the_flow_is_refused(make):
    run = standing(make, triangle(0.5))
    run.scene = replace(run.scene, period=(0.2, math.inf))
    with pytest.raises(ResultsError, match="periodic along x"):
        surface(run)
