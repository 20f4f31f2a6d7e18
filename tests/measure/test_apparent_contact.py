"""Contact as a film shows it, against passes, pivots and rebounds whose length is known in closed form."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import CaseError, ResultsError
from ryusa.measure import apparent_contact
from ryusa.measure.apparent_contact import Stays
from ryusa.model import EVENT
from ryusa.model.scene import EventRule

D = 0.002  # m
FRAME = 1.0e-4  # s
V = 0.1  # m/s


@pytest.fixture
def filmed(make):
    """A run of free grains whose centres are x (n_frame, n_grain, 3) [m], beside `bed` (n, 3) and a floor."""

    def build(x, bed=(), period=(math.inf, math.inf), floor=False, frame=FRAME, contacts=(), step=1.0e-9):
        bed = np.reshape(np.array(bed, dtype=float), (-1, 3))
        scene = replace(
            make.scene(x.shape[1]), period=period, dt=step, x_fixed=bed,
            d_fixed=np.full(len(bed), D), fixed_active=np.ones(len(bed), dtype=bool),
            plane_normal=np.array([[0.0, 0.0, 1.0]]), plane_point=np.zeros((1, 3)),
            plane_active=np.array([floor]),
        )  # fmt: skip
        return SimpleNamespace(
            case={"record": {}}, scene=scene, contacts=np.array(list(contacts), dtype=EVENT),
            frames=SimpleNamespace(t=frame * np.arange(len(x)), x=x, v=0.0 * x, omega=0.0 * x),
        )  # fmt: skip

    return build


def pair(way, n_grain=2):
    """Centres of a grain at the origin and of one that is `way` (n_frame, 3) from it [m]."""
    x = np.zeros((len(way), n_grain, 3))
    x[:, 1] = way
    return x


def pass_by(beside, v=V, frame=FRAME):
    """Ways of a grain that passes at constant speed, its centre `beside` [m] at the nearest."""
    far = 2.0 * D
    along = np.arange(-far, far, v * frame)
    return np.stack([along, np.zeros_like(along), np.full_like(along, beside)], axis=1)


@pytest.mark.parametrize("eps", [0.02, 0.05, 0.1])
@pytest.mark.parametrize("beside", [0.0, 0.7, 1.0])
def test_a_grain_that_passes_at_constant_speed_stays_for_its_chord(filmed, eps, beside):
    found = apparent_contact(filmed(pair(pass_by(beside * D))), fps=2000.0, resolution=eps)
    chord = 2.0 * D * math.sqrt((1.0 + eps) ** 2 - beside**2)
    assert len(found.near.pair) == len(found.film.pair) == 1
    assert found["stay"].value == pytest.approx(chord / V, abs=FRAME)
    assert found["apparent_time"].value == pytest.approx(chord / V, abs=1.0 / 2000.0)
    assert found["unseen"].value == 0.0


@pytest.mark.parametrize("e", [1.0, 0.5])
def test_a_straight_rebound_lasts_the_way_in_and_the_way_out(filmed, make, e):
    eps, frame = 0.1, 2.0e-5
    t = np.arange(-0.01, 0.01, frame)
    gap = np.where(t < 0.0, -V * t, e * V * t)  # 0.2 d/v at e = 1
    touch = make.event(0, 1, 0.01, (0.0, 0.0), (0.0, -V), (0.0, e * V), duration=1.0e-4)
    run = filmed(pair(np.stack([0 * t, 0 * t, D + gap], axis=1)), frame=frame, contacts=[touch])
    found = apparent_contact(run, fps=10_000.0, resolution=eps)
    assert found["stay"].value == pytest.approx(eps * D / V * (1.0 + 1.0 / e), abs=frame)
    assert found["collision_time"].value == pytest.approx(1.0e-4)
    assert found.collisions.tolist() == [1]


def test_a_grain_that_pivots_over_its_neighbour_stays_for_its_arc(filmed):
    turn, eps = math.radians(60.0), 0.02  # from one pocket of touching grains to the next
    t = FRAME * np.arange(-200, 500)
    angle = np.clip(V / D * t, 0.0, turn)
    away = V * np.maximum(t - turn * D / V, 0.0) + np.maximum(-V * t, 0.0)  # comes, pivots, leaves, all at V
    radius = 1.001 * D + away
    way = np.stack([radius * np.sin(angle), 0.0 * t, radius * np.cos(angle)], axis=1)
    found = apparent_contact(filmed(way[:, None], bed=[(0.0, 0.0, 0.0)]), resolution=eps, fps=2000.0)
    expected = turn * D / V + 2.0 * (eps - 0.001) * D / V  # 1.05 d/v of pivot
    assert found["stay"].value == pytest.approx(expected, abs=FRAME)
    assert turn * D / V > 20.0 * eps * D / V


def shuttle(stay, n, fps, frame, seed=1):
    """Centres of two grains that are near for `stay` [s] n times, at random phases of a film."""
    rng = np.random.default_rng(seed)
    ends = np.cumsum(rng.uniform(2.0, 3.0, n) / fps + stay)
    t = frame * np.arange(round((ends[-1] + 2.0 / fps) / frame))
    which = np.minimum(np.searchsorted(ends, t, "right"), n - 1)
    near = (t >= ends[which] - stay) & (t < ends[which])
    return pair(np.stack([np.where(near, 1.01, 1.5) * D, 0.0 * t, 0.0 * t], axis=1))


@pytest.mark.parametrize("share", [0.3, 0.8, 1.7])
def test_a_film_shows_the_longer_of_stay_and_frame_interval_on_average(filmed, share):
    fps, n, frame = 100.0, 400, 1.0e-3
    found = apparent_contact(filmed(shuttle(share / fps, n, fps, frame), frame=frame), fps=fps)
    assert len(found.near.pair) == n
    assert found["stay"].value == pytest.approx(share / fps, abs=0.1 * frame)
    bound = 4.0 * 0.5 / math.sqrt(n)  # four standard errors of a share
    assert found["unseen"].value == pytest.approx(max(1.0 - share, 0.0), abs=bound)
    assert float(found.film.frames.sum()) / n == pytest.approx(share, abs=bound)  # frames counted in a stay
    assert found["apparent_time"].value == pytest.approx(max(share, 1.0) / fps, abs=bound / fps)


def test_a_film_needs_denser_frames_and_says_how_dense(filmed):
    run = filmed(pair(pass_by(D)))  # 10,000 frames per second
    apparent_contact(run, fps=2500.0)
    with pytest.raises(CaseError, match=r'fps = .2600.: .*record\.frames = "9\.615e-05 s".*at most 2500 fr'):
        apparent_contact(run, fps=2600.0)


def test_frames_that_come_late_by_a_step_are_dense_enough(filmed):
    run = filmed(pair(pass_by(D)), step=0.1 * FRAME)
    run.frames.t[1::2] += 0.1 * FRAME
    apparent_contact(run, fps=2500.0)
    run.frames.t[1::2] += 0.01 * FRAME
    with pytest.raises(CaseError, match="fps"):
        apparent_contact(run, fps=2500.0)


def test_a_window_without_two_frames_is_refused(filmed):
    run = filmed(pair(pass_by(D)))
    with pytest.raises(ResultsError, match="1 frames from t = 0 s"):
        apparent_contact(run, begin=0.0, end=0.5 * FRAME)
    with pytest.raises(ResultsError, match="has one frame"):
        apparent_contact(run, begin=0.0, end=0.005, fps=100.0)


def test_partners_are_free_fixed_grains_and_floors_and_images_across_the_sides(filmed):
    n, eps = 200, 0.05
    near = (np.arange(n) >= 50) & (np.arange(n) < 150)
    gap = np.where(near, 0.01, 0.3) * D
    box = (10.0 * D, 8.0 * D)
    x = np.zeros((n, 4, 3))
    x[:, :, 2] = 3.0 * D
    x[:, 0, 0], x[:, 1, 0] = 0.2 * D, 0.2 * D - D - gap  # a pair across x = 0
    x[:, 1, 0] += 3.0 * box[0]  # unwrapped centres, periods away
    x[:, 2], x[:, 3] = (3.0 * D, 0.4 * D, 5.0 * D), (6.0 * D, 4.0 * D, 0.0)
    x[:, 3, 2] = 0.5 * D + gap  # over the floor
    bed = [(3.0 * D, 8.0 * D - 0.6 * D - 0.0 * D, 5.0 * D)]
    x[:, 2, 1] += gap  # over a fixed grain across y = 0
    found = apparent_contact(filmed(x, bed=bed, period=box, floor=True), fps=2000.0, resolution=eps)
    assert sorted(zip(*(row[k] for k in ("i", "j")), strict=False) for row in []) == []
    assert {(row["i"], row["j"]) for row in found.series()} == {(0, 1), (2, 4), (3, 5)}
    np.testing.assert_allclose(found.near.duration, 100 * FRAME)


def test_stays_from_before_the_film_are_left_out_and_the_cut_ones_completed(filmed):
    n = 401
    t = np.arange(n)
    x = np.zeros((n, 8, 3))
    x[:, :, 0] = 20.0 * D * np.arange(8)
    spans = [(-1, 100), (20, 60), (100, 180), (351, 500)]  # frames; the last one is cut after 50
    for k, (low, high) in enumerate(spans):
        near = (t >= low) & (t < high)
        x[:, 2 * k + 1, 0] = x[:, 2 * k, 0] + np.where(near, 1.01, 1.5) * D
    found = apparent_contact(filmed(x), fps=2500.0)
    assert found.near.frames.tolist() == [40, 80, 50]
    assert found.near.cut.tolist() == [False, False, True]
    assert found["stay"].value == pytest.approx((40 + 80 + 80) / 3 * FRAME)  # Kaplan-Meier by hand
    assert found.near.median == pytest.approx(80 * FRAME)
    assert any("1 of 3 stays" in one for one in found.averages.notes)


def test_completed_durations_have_the_mean_of_the_lifetimes_that_were_cut():
    rng = np.random.default_rng(3)
    n, mean = 20_000, 30.0
    lives, ends = rng.geometric(1.0 / mean, n), rng.integers(1, 120, n)
    cut = ends <= lives
    stays = Stays(np.zeros(n, np.int64), np.ones(n, np.int64), np.minimum(lives, ends), cut, 1.0)
    assert 0.2 < stays.cut_share < 0.4
    within = mean * (1.0 - (1.0 - 1.0 / mean) ** 119)  # the mean if nothing lasted more than 119 frames
    assert stays.duration.mean() == pytest.approx(within, rel=0.01)
    assert stays.frames.mean() < 0.8 * mean
    assert stays.median == pytest.approx(np.median(lives), abs=1.0)


def test_all_stays_cut_count_as_they_are_and_have_no_median():
    stays = Stays(*np.ones((2, 3), np.int64), np.array([3, 5, 5]), np.ones(3, bool), 2.0)
    np.testing.assert_allclose(stays.duration, [9.0, 10.0, 10.0], atol=0.7)
    assert math.isnan(stays.median)
    assert math.isnan(Stays(*np.ones((3, 0), np.int64), np.ones(0, bool), 2.0).median)


def test_collisions_are_counted_in_the_stay_of_their_own_pair(filmed, make):
    n = 500
    t = np.arange(n)
    near = ((t >= 50) & (t < 150)) | ((t >= 300) & (t < 400))
    x = np.zeros((n, 4, 3))
    x[:, :, 0] = 20.0 * D * np.arange(4)
    x[:, 1, 0] = x[:, 0, 0] + np.where(near, 1.01, 1.5) * D
    x[:, 3, 0] = x[:, 2, 0] + np.where(near, 1.01, 1.5) * D

    def touch(i, frame, duration):
        return make.event(i, i + 1, frame * FRAME, (0, 0), (0, -V), (0, V), duration=duration)

    contacts = [touch(0, 60, 1e-4), touch(0, 80, 3e-4), touch(2, 350, 2e-4)]
    run = filmed(x, contacts=contacts)
    found = apparent_contact(run, fps=2000.0)
    by_pair = dict(
        zip(
            zip(found.near.pair.tolist(), found.near.first.tolist(), strict=True),
            found.collisions.tolist(),
            strict=True,
        )
    )
    assert sorted(by_pair.values()) == [0, 0, 1, 2]
    assert by_pair[(1, 50)] == 2
    assert found["collision_time"].value == pytest.approx(2e-4)
    assert found["collisions_per_stay"].value == pytest.approx(0.75)
    few = SimpleNamespace(**{**vars(run), "scene": replace(run.scene, events=EventRule.TRACKED)})
    assert apparent_contact(few, fps=2000.0)["collision_time"].n == 0


def test_nothing_near_gives_no_average(filmed):
    found = apparent_contact(filmed(pair(pass_by(1.5 * D))), fps=2000.0)
    assert found["apparent_time"].n == found["stay"].n == 0
    assert found.series() == []
