"""Transport of sediment: rates, layers, starts and stops, and stresses known in closed form."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from ryusa.errors import ResultsError
from ryusa.measure.entrainment import entrainment
from ryusa.measure.transport import kinetic_stress, transport
from ryusa.model import EVENT
from ryusa.model.scene import Water

D = 0.002
LENGTH, WIDTH = 20 * D, 5 * D
AREA = LENGTH * WIDTH
BALL = math.pi / 6 * D**3
RHO = 2650.0


@pytest.fixture
def ride(make):
    """A run of given centres [m] and velocities [m/s], (n_frame, n_grain, 3), in three dimensions."""

    def build(x, v=None, interval=0.01, d=D, water=None, plane=False):
        n_frame, n, _ = x.shape
        d = np.broadcast_to(d, n)
        scene = make.scene(n)
        scene = replace(
            scene, d=d, m=RHO * math.pi / 6 * d**3, slab_width=D, plane_case=plane,
            period=(LENGTH, math.inf if plane else WIDTH), gravity=np.array([0.6, 0.0, -9.8]),
            x_fixed=scene.x_fixed[:20], d_fixed=scene.d_fixed[:20], fixed_active=scene.fixed_active[:20],
            water=Water() if water is None else water,
        )  # fmt: skip
        v = np.zeros_like(x) if v is None else v
        return SimpleNamespace(
            case={"record": {}, "water": None if water is None else {"profile": "log rough"}},
            frames=SimpleNamespace(t=np.arange(n_frame) * interval, x=x, v=v, omega=0.0 * x),
            contacts=np.zeros(0, EVENT),
            scene=scene,
            tally={},
        )

    return build


def steady(speeds, n_frame=50, interval=0.01, z=3 * D):
    """Centres and velocities of grains that move along x at steady speeds [m/s]."""
    speeds = np.asarray(speeds, dtype=float)
    t = np.arange(n_frame) * interval
    x = np.zeros((n_frame, len(speeds), 3))
    x[:, :, 0] = t[:, None] * speeds
    x[:, :, 2] = z
    return x, np.broadcast_to(speeds[:, None] * [1.0, 0.0, 0.0], x.shape)


def test_the_rate_is_the_volume_that_crosses_any_line(ride):
    speeds = np.array([1.0, 2.0, 3.0, -1.0]) * LENGTH / 0.49  # whole periods from the first to the last frame
    d = D * np.array([1.0, 1.2, 0.7, 1.0])
    run = ride(*steady(speeds), d=d)
    found = transport(run)
    crossed = (np.array([1, 2, 3, -1]) * math.pi / 6 * d**3).sum()
    assert found.averages["q"].value == pytest.approx(crossed / (WIDTH * 0.49), rel=1e-12)
    assert found.averages["q"].error < 1e-12 * found.averages["q"].value
    assert found.flux.value.sum() * found.thickness == pytest.approx(found.averages["q"].value, rel=1e-12)
    np.testing.assert_allclose(found.q, found.averages["q"].value)
    assert len(found.rows()) == 49


def test_q_star_depends_on_water_gravity_and_diameter(ride):
    x, v = steady([0.5])
    g, q = math.hypot(0.6, 9.8), BALL * 0.5 / AREA
    dry = transport(ride(x, v))
    assert dry.excess == 1.0
    assert dry.averages["q_star"].value == pytest.approx(q / math.sqrt(g * D**3), rel=1e-12)
    assert math.isnan(dry.tau_star)
    wet = transport(ride(x, v, water=Water(u_star=0.1, rho_w=1000.0)))
    assert wet.averages["q_star"].value == pytest.approx(q / math.sqrt(1.65 * g * D**3), rel=1e-12)
    np.testing.assert_allclose(wet.q_star, wet.averages["q_star"].value)
    assert wet.tau_star == pytest.approx(0.01 / (1.65 * g * D))
    told = transport(ride(x, v), rho_w=1325.0, tau_star=0.2)
    assert (told.excess, told.tau_star) == (pytest.approx(1.0), 0.2)
    floating = transport(ride(x, v), rho_w=RHO)
    assert math.isnan(floating.averages["q_star"].value)
    assert floating.averages["q"].value == pytest.approx(q)


def test_a_rate_that_scatters_has_the_error_of_its_mean(ride):
    rng = np.random.default_rng(0)
    speeds = rng.normal(0.3, 0.1, (2001, 1))
    x = np.zeros((2001, 1, 3))
    x[1:, :, 0] = np.cumsum(speeds[:-1] * 0.01, axis=0)
    x[:, :, 2] = 3 * D
    v = speeds[:, :, None] * [1.0, 0.0, 0.0]
    found = transport(ride(x, v)).averages["q"]
    assert found.error == pytest.approx(BALL / AREA * 0.1 / math.sqrt(2000), rel=0.3)
    assert found.value == pytest.approx(BALL / AREA * 0.3, abs=4 * found.error)
    assert found.steady


def test_the_begin_suggested_comes_from_the_whole_run_and_leaves_the_window_alone(ride):
    """Grains slow down from ten times their speed within 0.2 s of 4 s."""
    rng = np.random.default_rng(1)
    t = np.arange(400) * 0.01
    speeds = (0.1 + np.exp(-t / 0.2))[:, None] * rng.normal(1.0, 0.2, (400, 3))
    x = np.zeros((400, 3, 3))
    x[1:, :, 0] = np.cumsum(speeds[:-1] * 0.01, axis=0)
    x[:, :, 2] = 3 * D
    run = ride(x, speeds[:, :, None] * [1.0, 0.0, 0.0])
    run.case["record"]["settle"] = 0.1
    for begin, words in ((None, "settles until 0.1 s"), (0.5, "0.1 s, the window begins at 0.5 s")):
        found = transport(run, begin)
        (note,) = (one for one in found.averages.notes if "MSER" in one)
        assert note.endswith(words)
        assert 0.6 < float(note.split("t = ")[1].split(" s")[0]) < 2.0
    assert not transport(run).averages["q"].steady
    assert transport(run).averages["q"].window[0] == pytest.approx(0.1)
    assert transport(run, 1.6).averages["q"].steady
    few = transport(run, end=0.25).averages.notes
    assert any("suggests no begin" in one for one in few)
    assert any("too few samples" in one for one in transport(run, end=0.15).averages.notes)


def test_a_frame_at_the_end_that_comes_early_weighs_less(ride):
    x, v = steady([0.5, 0.1])
    run = ride(x, v)
    run.frames.t = run.frames.t.copy()
    run.frames.t[-1] = run.frames.t[-2] + 1e-3
    x[-1, :, 0] = x[-2, :, 0] + 1e-3 * np.array([0.5, 0.1])
    assert transport(run).averages["q"].value == pytest.approx(BALL * 0.6 / AREA, rel=1e-12)


def test_the_layer_of_one_rolling_grain_is_the_middle_of_its_sphere(ride):
    found = transport(ride(*steady([0.5])), layer=0.01)
    u = np.roots([-2.0, 3.0, 0.0, -0.05])  # share of a sphere below the height u d: 3 u**2 - 2 u**3
    u = next(one.real for one in u if 0.0 < one.real < 0.5)
    low, high, thick = (found.averages[name] for name in ("layer_low", "layer_high", "layer_thickness"))
    assert low.value == pytest.approx((3 - 0.5 + u) * D, abs=1e-4 * D)
    assert high.value == pytest.approx((3 + 0.5 - u) * D, abs=1e-4 * D)
    assert thick.value == pytest.approx((1 - 2 * u) * D, abs=3e-4 * D)
    assert thick.error < 1e-9 * D


def test_the_level_of_a_layer_has_the_scatter_of_its_record(ride):
    """Fourteen records of grains at random heights scatter about their mean as far as their errors say."""
    levels = []
    for seed in range(14):
        rng = np.random.default_rng(seed)
        x, v = steady(np.full(40, 0.5), n_frame=300)
        x[:, :, 2] = rng.uniform(3 * D, 9 * D, x.shape[:2])
        levels.append(transport(ride(x, v)).averages["layer_high"])
    spread = np.std([one.value for one in levels], ddof=1)
    assert np.mean([one.error for one in levels]) == pytest.approx(spread, rel=0.5)


def test_grains_that_move_upstream_do_not_count_in_the_layer(ride):
    x, v = steady([0.5, -0.1])
    x[:, 1, 2] = 8 * D
    found = transport(ride(x, v), layer=0.05)
    alone = transport(ride(*steady([0.5])), layer=0.05)
    assert found.averages["layer_high"].value == pytest.approx(alone.averages["layer_high"].value)
    back = transport(ride(*steady([-0.5])))
    assert math.isnan(back.averages["layer_high"].value)


def paced(plan, interval=0.01, step=1e-3):
    """Grains that advance `step` [m] where the plan holds a one: rows of ones and zeros, a row per grain."""
    moves = np.array(plan, dtype=float).T
    x = np.zeros((len(moves) + 1, moves.shape[1], 3))
    x[1:, :, 0] = np.cumsum(moves * step, axis=0)
    x[:, :, 2] = 3 * D
    return x


def test_starts_and_stops_are_counted_when_they_begin(ride):
    plan = [
        [0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0],  # starts at 3, stops at 7
        [0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0],  # too short to be a start
        [1, 1, 1, 1, 0, 1, 1, 1, 1, 1, 1, 1],  # too short to be a stop
        [0, 0, 0, 1, 0, 1, 1, 1, 1, 1, 1, 1],  # starts at 5
        [1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0],  # stops at 8
    ]
    d = D * np.array([1.0, 1.0, 1.0, 1.1, 1.0])
    found = entrainment(ride(paced(plan), d=d), speed=0.05, duration=0.02)
    assert found.duration == pytest.approx(0.02)
    np.testing.assert_allclose(found.t, (np.arange(2, 11) + 0.5) * 0.01)
    np.testing.assert_array_equal(found.started, [0, 1, 0, 1, 0, 0, 0, 0, 0])
    np.testing.assert_array_equal(found.stopped, [0, 0, 0, 0, 0, 1, 1, 0, 0])
    rate = found.averages["entrainment"]
    assert rate.value == pytest.approx(2 / (AREA * 0.09))
    volume = found.averages["entrained_volume"]
    assert volume.value == pytest.approx(BALL * (1 + 1.1**3) / (AREA * 0.09))
    assert found.averages["deposition"].value == pytest.approx(2 / (AREA * 0.09))
    assert found.averages["moving_speed"].value == pytest.approx(0.1)
    some = ride(paced(plan[:1]))
    assert entrainment(some, speed=0.05).averages["moving"].value == pytest.approx(BALL * 4 / 12 / AREA)
    assert len(found.rows()) == 9


def test_motion_during_a_single_frame_counts_on_request(ride):
    plan = [[0, 1, 0, 1, 1, 0, 0, 1]]
    found = entrainment(ride(paced(plan)), speed=0.05, duration=0.0)
    np.testing.assert_array_equal(found.started, [1, 0, 1, 0, 0, 0, 1])
    assert [repr(row["started"]) for row in found.rows()] == ["1", "0", "1", "0", "0", "0", "1"]
    np.testing.assert_array_equal(found.stopped, [0, 1, 0, 0, 1, 0, 0])


def test_vibration_in_place_is_not_motion(ride):
    x, _ = steady([0.0, 0.0], n_frame=200)
    v = np.random.default_rng(0).normal(0.0, 1.0, x.shape)
    found = entrainment(ride(x, v))
    assert found.started.sum() == found.stopped.sum() == 0
    assert found.speed == pytest.approx(0.1 * math.sqrt(math.hypot(0.6, 9.8) * D))
    assert found.averages["moving"].value == 0.0


def test_in_the_long_run_as_many_grains_start_as_stop(ride):
    """A chain of starts at the rate a and stops at the rate b moves in a/(a + b) of its time."""
    rng = np.random.default_rng(1)
    moves = np.zeros((4000, 50))
    for k in range(1, len(moves)):
        toss = rng.random(50)
        moves[k] = np.where(moves[k - 1] > 0, toss > 0.1, toss < 0.05)
    found = entrainment(ride(paced(moves.T)), speed=0.05, duration=0.0)
    expected = 50 * 0.1 * 0.05 / 0.15 / (0.01 * AREA)
    for name in ("entrainment", "deposition"):
        assert found.averages[name].value == pytest.approx(expected, abs=4 * found.averages[name].error)
    moving = found.averages["moving"]
    assert moving.value == pytest.approx(50 * BALL / 3 / AREA, abs=4 * moving.error)


def test_a_gas_has_the_stress_of_its_fluctuations(ride):
    rng = np.random.default_rng(2)
    n, n_frame = 200, 300
    x = rng.uniform(0.0, 1.0, (n_frame, n, 3)) * [LENGTH, WIDTH, 10 * D] + [0.0, 0.0, 2 * D]
    root = np.linalg.cholesky([[0.04, 0.0, -0.01], [0.0, 0.02, 0.0], [-0.01, 0.0, 0.03]])
    v = rng.normal(size=x.shape) @ root.T + [0.3, 0.0, 0.0]
    found = kinetic_stress(ride(x, v))
    inside = (found.profiles.z > 3.5 * D) & (found.profiles.z < 10.5 * D)
    phi = n * BALL / (AREA * 10 * D)
    for layers, expected in (
        (found.xx, 0.04), (found.yy, 0.02), (found.zz, 0.03), (found.xz, -0.01),
    ):  # fmt: skip
        off = (layers.value - RHO * phi * expected)[inside] / layers.error[inside]
        assert np.sqrt(np.mean(off**2)) < 1.6
    off = (found.temperature.value - 0.03)[inside] / found.temperature.error[inside]
    assert np.sqrt(np.mean(off**2)) < 1.6
    assert "stress_xz_Pa" in found.rows()[0]


def test_a_rigid_body_in_motion_carries_no_stress(ride):
    rng = np.random.default_rng(3)
    x = rng.uniform(2 * D, 9 * D, (20, 30, 3))
    found = kinetic_stress(ride(x, np.broadcast_to([0.4, 0.0, -0.2], x.shape)))
    for one in (found.xx, found.yy, found.zz, found.xz):
        np.testing.assert_allclose(one.value, 0.0, atol=1e-12)


def test_the_shear_across_a_grain_counts_as_motion_by_a_twentieth(ride):
    rng = np.random.default_rng(4)
    n, shear = 400, 50.0
    x = rng.uniform(0.0, 1.0, (200, n, 3)) * [LENGTH, WIDTH, 8 * D] + [0.0, 0.0, 2 * D]
    v = shear * x[:, :, 2:] * [1.0, 0.0, 0.0]
    found = kinetic_stress(ride(x, v), layer=0.1)
    inside = (found.profiles.z > 4 * D) & (found.profiles.z < 8 * D)
    per_mass = found.xx.value / (RHO * found.profiles.phi.value)
    assert per_mass[inside].mean() == pytest.approx((shear * D) ** 2 / 20, rel=0.02)


def test_a_plane_scene_has_two_directions(ride):
    rng = np.random.default_rng(5)
    x = rng.uniform(0.0, 1.0, (200, 60, 3)) * [LENGTH, 0.0, 10 * D] + [0.0, 0.0, 2 * D]
    v = rng.normal(0.0, 0.2, x.shape) * [1.0, 0.0, 1.0]
    found = kinetic_stress(ride(x, v, plane=True))
    inside = (found.profiles.z > 3 * D) & (found.profiles.z < 9 * D)
    assert found.temperature.value[inside].mean() == pytest.approx(0.04, rel=0.05)
    both = 0.5 * (found.profiles.temperature_x.value + found.profiles.temperature_z.value)
    np.testing.assert_allclose(found.temperature.value, both, rtol=1e-9, atol=1e-14)


def test_stress_does_not_depend_on_the_chunks_of_frames(ride, monkeypatch):
    import importlib

    rng = np.random.default_rng(6)
    x = np.cumsum(rng.normal(1e-3, 1e-3, (40, 30, 3)), axis=0) + 5 * D
    run = ride(x, rng.normal(size=x.shape))
    whole = transport(run), entrainment(run), kinetic_stress(run)
    monkeypatch.setattr(importlib.import_module("ryusa.measure.transport"), "CHUNK", 210)
    again = transport(run), entrainment(run), kinetic_stress(run)
    np.testing.assert_array_equal(again[0].q, whole[0].q)
    np.testing.assert_array_equal(again[1].started, whole[1].started)
    np.testing.assert_array_equal(again[2].xz.value, whole[2].xz.value)


def test_what_cannot_be_measured_is_said(ride):
    run = ride(*steady([0.5], n_frame=10))
    with pytest.raises(ResultsError, match="1 frames"):
        transport(run, begin=0.09)
    with pytest.raises(ResultsError, match="too few"):
        entrainment(run, duration=0.06)
    run.scene = replace(run.scene, period=(math.inf, WIDTH))
    with pytest.raises(ResultsError, match="open along x"):
        transport(run)


def test_the_rate_is_given_in_the_units_of_the_trade_beside_the_formulae(ride):
    run = ride(*steady([0.5, 0.2, 0.1]), water=Water())
    found = transport(run, tau_star=0.297)
    q, mass = found.averages["q"], found.averages["q_mass"]
    assert mass.unit == "kg/s/m"
    assert mass.value == pytest.approx(2650.0 * q.value, rel=1e-12)
    assert any(
        one.startswith(
            "Meyer-Peter & Müller 1948, plane bed: q_star = 1 at tau_star = 0.297; measured over it"
        )
        and float(one.split()[-1]) == pytest.approx(found.averages["q_star"].value, rel=0.05)
        for one in found.averages.notes
    )
    below = transport(run, tau_star=0.03).averages.notes
    assert "Meyer-Peter & Müller 1948, plane bed: q_star = 0 at tau_star = 0.03" in below
