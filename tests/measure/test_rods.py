"""Grains that keep contact and bearing are rods, grains that turn about each other or part are not."""

from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure import companions, rods

D = 0.002  # m, of the grains of conftest; their bed is 20 of them long
FRAME = 0.005  # s
SPEED = 0.2  # m/s: two diameters in a window of 0.02 s


@pytest.fixture
def made(make):
    """A run of grains whose centres follow paths (n_frame, n_grain, 2) in x and z [m]."""

    def build(paths, v=None):
        x = np.zeros((*paths.shape[:2], 3))
        x[:, :, 0], x[:, :, 2] = paths[:, :, 0], paths[:, :, 1]
        t = FRAME * np.arange(len(paths))
        frames = SimpleNamespace(t=t, x=x, v=0.0 * x if v is None else v, omega=0.0 * x)
        return SimpleNamespace(
            case={"record": {"settle": 0.0}}, frames=frames, scene=make.scene(paths.shape[1])
        )

    return build


def towed(starts, n_frame=41, speed=SPEED):
    """Grains that go downstream side by side; `starts` (n_grain, 2) in diameters."""
    way = speed * FRAME * np.arange(n_frame)[:, None, None] * np.array([1.0, 0.0])
    return D * np.asarray(starts, dtype=float)[None] + way


def rolling(rate, n_frame=41):
    """Two grains in touch that go downstream and turn about their middle at `rate` [rad/s]."""
    paths = towed([(0, 5), (1, 5)], n_frame)
    middle = paths.mean(axis=1)
    angle = rate * FRAME * np.arange(n_frame)
    arm = 0.5 * D * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.stack([middle - arm, middle + arm], axis=1)


def test_three_grains_in_touch_that_translate_are_one_rod_in_every_window(made):
    found = rods(made(towed([(0, 5), (1, 5), (1.5, 5 + np.sqrt(0.75))])), window=0.02)
    assert found.window == pytest.approx(0.02)
    assert len(found.begin) == 10
    assert found.share == found.kept == 1.0
    assert found.lengths.tolist() == [0, 0, 0, 10]
    assert found.mean_length == 3.0
    assert found.longest is not None
    assert found.longest.grains == (0, 1, 2)


def test_a_chain_is_one_rod_also_across_the_period(made):
    n = 5
    found = rods(made(towed([(18.5 + k, 5) for k in range(n)])), window=0.02)
    assert found.lengths.tolist() == [0] * n + [10]


def test_grains_that_separate_are_not_a_rod(made):
    paths = towed([(0, 5), (1, 5)])
    paths[:, 1, 0] += 0.05 * SPEED * FRAME * np.arange(len(paths))  # 0.1 d in a window
    found = rods(made(paths), window=0.02)
    assert found.movers.tolist() == [2] * 10
    assert found.share == 0.0
    assert found.longest is None


@pytest.mark.parametrize(("degrees", "bound"), [(14.0, 1.0), (16.0, 0.0)])
def test_grains_that_turn_about_each_other_by_the_bearing_in_a_window_are_no_rod(made, degrees, bound):
    found = rods(made(rolling(np.radians(degrees) / 0.02)), window=0.02)
    assert found.touching.tolist() == [2] * 10
    assert found.share == bound


def test_grains_that_stay_where_they_are_do_not_count(made):
    paths = towed([(0, 5), (1, 5)], speed=0.9 * D / 0.02)
    assert rods(made(paths), window=0.02).movers.sum() == 0
    assert rods(made(paths), window=0.02, way=0.8).share == 1.0


def test_the_window_is_five_times_the_time_of_a_grain_to_fall_through_itself(made):
    run = made(towed([(0, 5), (1, 5)]))
    expected = 5.0 * np.sqrt(D / np.linalg.norm(run.scene.gravity))
    assert abs(rods(run).window - expected) <= 0.5 * FRAME


def test_shuffled_paths_leave_a_rod_only_if_the_layer_moves_as_one(made):
    rigid = rods(made(towed([(0, 5), (1, 5), (3, 5), (4, 5)])), window=0.02)
    assert rigid.null_share == pytest.approx(1.0)
    paths = towed([(0, 5), (1, 5), (3, 5), (4, 5)])
    paths[:, 2:, 0] += 0.5 * SPEED * FRAME * np.arange(len(paths))[:, None]  # two rods of different speed
    found = rods(made(paths), end=0.1 * FRAME + 0.02 + FRAME, window=0.02, shuffles=300)
    assert found.share == 1.0
    # either pair keeps together where both grains are given ways of one speed
    assert found.null_share == pytest.approx(0.5, abs=0.06)


def test_a_run_shorter_than_a_window_is_refused(made):
    with pytest.raises(ResultsError, match="no window"):
        rods(made(towed([(0, 5), (1, 5)], n_frame=4)), window=0.02)


def test_companions_distinguishes_joint_from_separate_motion(made):
    paths = towed([(0, 5), (1, 5), (3, 5), (4, 5)])
    v = np.zeros((*paths.shape[:2], 3))
    v[:, :, 0] = [0.3, 0.3, 0.1, 0.1]
    assert companions(made(paths, v)) == pytest.approx(1.0)
    v[:, :, 0] = [0.3, 0.1, 0.3, 0.1]
    assert companions(made(paths, v)) == pytest.approx(-1.0)
