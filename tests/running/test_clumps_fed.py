"""Clumps that enter and leave: each counts once, as a whole, with the energy that it has; same bits."""

import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.engine.test_clumps_in_water import STILL

import ryusa
from ryusa.build import scene as scene_of
from ryusa.build.clumps import with_clumps
from ryusa.casefile.read import read_text
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.pool import GrainPool
from ryusa.engine.shared.passages import removed
from ryusa.formats.export import export
from ryusa.laws._family import evaluate
from ryusa.laws.families import ContactTiming
from ryusa.model import Exit, Feed, Traffic
from ryusa.model.clump import drag_form, shape
from ryusa.model.feeds import IN, OUT
from ryusa.model.scene import EventRule
from ryusa.results import Results, schema
from ryusa.running.runner import run_scene
from ryusa.running.stops import Stop

sys.path.insert(0, str(Path(__file__).parents[1] / "faults"))
from campaign import differences
from kinds import KINDS

CLUMPS_FED = KINDS["clumps-fed"]

G, D = 9.80665, 0.004
DOWN = (0.0, 0.0, -1.0)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return ryusa.run(read_text(CLUMPS_FED), tmp_path_factory.mktemp("fed") / "run", progress=False)


@pytest.mark.full
def test_a_clump_counts_once_with_its_own_mass_and_size(whole: Results) -> None:
    scene, rows = whole.scene, whole.passages
    bodies = scene.bodies
    assert bodies is not None
    of = bodies.of_grain(scene.n_grain)[rows["grain"]]
    made = of >= 0
    assert 20 < made.sum() < len(rows)
    assert np.array_equal(bodies.first[of[made]], rows["grain"][made])
    assert np.array_equal(bodies.m[of[made]], rows["m"][made])
    assert np.array_equal(bodies.d[of[made]], rows["d"][made])
    assert (rows["way"] == OUT).sum() > 5
    for grain in np.unique(rows["grain"]):  # in and out in turn: an id is never there twice
        ways = rows["way"][rows["grain"] == grain]
        assert ways.tolist() == [IN, OUT] * (len(ways) // 2) + [IN] * (len(ways) % 2)


@pytest.mark.full
def test_every_frame_holds_what_entered_less_what_left(whole: Results) -> None:
    scene, bodies = whole.scene, whole.bodies
    assert scene.bodies is not None
    assert bodies is not None
    heads = scene.heads
    for k, frame in enumerate(whole.frames):
        passed = whole.passages[whole.passages["step"] <= frame.step]
        there = np.isfinite(frame.x[:, 0])
        assert (there & heads).sum() == passed["way"].sum()
        balance = (passed["way"] * passed["m"]).sum()
        assert scene.m[there].sum() == pytest.approx(balance, rel=1e-12, abs=1e-15)
        moved = bodies[k]
        seen = np.isfinite(moved.x[:, 0])
        assert np.array_equal(seen, there[scene.bodies.first])
        members = np.repeat(seen, scene.bodies.count)
        assert np.array_equal(members, there[scene.bodies.members])
        at = moved.of_members(scene.bodies)[0][members]
        assert np.asarray(frame.x)[scene.bodies.members[members]] == pytest.approx(at, abs=1e-12)
    found = whole.measure("discharge", begin=0.0)
    assert found.n[-1] == whole.summary["traffic"]["present"] == (there & heads).sum()
    assert found.m[-1] == pytest.approx(scene.m[there].sum(), rel=1e-12)


@pytest.mark.full
def test_no_sphere_of_a_clump_enters_on_top_of_another(tmp_path: Path) -> None:
    text = CLUMPS_FED.replace('[stop]\ntime = "0.2 s"', '[stop]\ntime = "0.03 s"')
    text = text.replace('frames = "2 ms"', 'frames = "0.02 ms"').replace('at = "0.14 s"', 'at = "0.02 s"')
    case = read_text(text, {"feeds.0.rate": "2000 grains/s"})
    run = ryusa.run(case, tmp_path / "run", progress=False)
    scene, rows = run.scene, run.passages
    assert scene.bodies is not None
    of, checked = scene.bodies.of_grain(scene.n_grain), 0
    for row in rows[rows["way"] == IN]:
        k = int(np.searchsorted(run.frames.step, row["step"]))
        x = np.asarray(run.frames.x[k])
        late = (run.frames.step[k] - row["step"]) * scene.dt  # one may have come nearer since
        for i in scene.spheres_of(np.array([row["grain"]])).tolist():
            gap = np.linalg.norm(x - x[i], axis=1) - 0.5 * (scene.d + scene.d[i])
            others = np.isfinite(gap) & ((of != of[i]) | (of < 0)) & (np.arange(len(of)) != i)
            assert (gap[others] > -2.0 * late).all()
            checked += 1
    assert checked > 100


@pytest.mark.full
def test_orientations_at_entry_are_even(whole: Results) -> None:
    """The axes of clumps that enter point to all sides: the mean of n n^T is 1/3 of the unit matrix."""
    from ryusa.model.rigid_bodies import BodyState
    from ryusa.running.insertion import drawn_orientation

    feed = whole.scene.traffic.feeds[0]
    q = np.array([drawn_orientation(feed, 3, step, 1) for step in range(4000)])
    assert np.linalg.norm(q, axis=1) == pytest.approx(np.ones(4000), rel=1e-12)
    rod = with_clumps(*scene_of(x=np.zeros((1, 3)), d=D), [shape("dumbbell")])[0].bodies
    assert rod is not None
    none = np.zeros((1, 3))
    axes = np.array([BodyState(none, none, one[None], none, none[:, :2]).arms(rod)[1] for one in q])
    axes /= np.linalg.norm(axes, axis=1)[:, None]
    assert np.abs(axes.T @ axes / 4000 - np.eye(3) / 3.0).max() < 0.02
    assert np.abs(axes.mean(axis=0)).max() < 0.03


def falling(folder: Path, **how: Any) -> Results:
    """Dumbbells that fall freely from a disc to an exit half a metre below, and those already there spin."""
    n, first = 30, 5
    x = np.zeros((n, 3))
    x[:, 0] = np.arange(n) * 3.0 * D + 0.1
    x[:, 2] = 0.3
    scene, state = scene_of(x=x, d=D, dt=2.0e-5, stiffness=2000.0, timing=ContactTiming.AT_STEPS)
    omega = np.tile([30.0, -50.0, 20.0], (n, 1))
    state = replace(state, omega=omega)
    feed = Feed(
        "hose", centre=(0.0, 0.0, 0.5), normal=DOWN, radius=0.02, velocity=(0.0, 0.0, -0.5), rate=100.0,
        first=first, count=n - first, seed=3,
    )  # fmt: skip
    traffic = Traffic((feed,), (Exit("floor", point=(0.0, 0.0, 0.0), normal=DOWN),), 70, first)
    there = np.arange(n) < first
    x, v, omega = (np.where(there[:, None], one, np.nan) for one in (state.x, state.v, state.omega))
    scene = replace(scene, traffic=traffic, world_low=(-1.0, -1.0, -5.0), world_high=(2.0, 1.0, 5.0))
    state = replace(state, x=x, v=v, omega=omega, present=there)
    scene, state = with_clumps(scene, state, [shape("tetrahedron"), shape("blade")], form_of=np.arange(n) % 2)
    return run_scene(scene, state, folder, frames=0.01, stop=Stop(time=0.6), progress=False, **how)


def test_a_clump_passes_from_feed_to_exit_in_the_time_of_free_fall(tmp_path: Path) -> None:
    run = falling(tmp_path / "run")
    scene, rows = run.scene, run.passages
    assert scene.bodies is not None
    come, gone = rows[rows["way"] == IN], rows[rows["way"] == OUT]
    begin = dict(zip(come["grain"].tolist(), come["t"].tolist(), strict=True))
    assert come["t"] == pytest.approx(np.arange(25) / 100.0, abs=1e-12)
    speed = math.sqrt(0.25 + 2.0 * G * 0.5)
    fed = gone[np.isin(gone["grain"], come["grain"])]
    taken = np.array([row["t"] - begin[int(row["grain"])] for row in fed])
    assert len(fed) == 25
    assert taken == pytest.approx(np.full(25, (speed - 0.5) / G), rel=1e-11)
    assert fed["v"][:, 2] == pytest.approx(np.full(25, -speed), rel=1e-11)
    old = gone[~np.isin(gone["grain"], come["grain"])]
    assert old["t"] == pytest.approx(np.full(5, math.sqrt(2.0 * 0.3 / G)), rel=1e-4)
    # spin and rotation leave with those that had them: nothing is left of the account
    energy = run.tally["residual"][run.tally["kinetic"] > 0.0]
    assert energy.max() < 1e-6
    assert run.summary["traffic"]["present"] == 0
    assert run.tally["spin"][-1] == pytest.approx(0.0, abs=1e-18)
    assert run.tally["spin"][1] > 1e-7


@pytest.mark.full
def test_the_energy_account_closes_where_clumps_leave_out_of_contacts(whole: Results) -> None:
    assert whole.tally["residual"].max() < 2e-3


@pytest.mark.full
def test_any_number_of_threads_gives_the_same_bits(whole: Results, tmp_path: Path) -> None:
    ryusa.run(read_text(CLUMPS_FED), tmp_path / "run", progress=False, threads=2)
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.full
@pytest.mark.parametrize("beside", [-1, 0, 1])
def test_a_stopped_run_resumes_with_the_same_bits(
    whole: Results, tmp_path: Path, stop_at: Any, beside: int
) -> None:
    """Before, at and after an instant at which clumps enter."""
    interval = whole.scene.traffic.interval
    stop_at(round(0.55 * whole.summary["steps"] / interval) * interval + beside)
    first = ryusa.run(read_text(CLUMPS_FED), tmp_path / "run", progress=False)
    assert first.status == schema.STOPPED
    again = read_text((tmp_path / "run" / schema.CASE_TOML).read_text())
    assert ryusa.run(again, tmp_path / "run", progress=False, resume=True).status == schema.COMPLETE
    assert differences(whole.folder, tmp_path / "run") == []


@pytest.mark.full
def test_pictures_view_and_tables_show_those_that_are_there(whole: Results, tmp_path: Path) -> None:
    whole.draw("grains")
    whole.draw("discharge", begin=0.0)
    whole.view()
    whole.film(frames=3).save(tmp_path / "film.webp")
    [table] = export(whole, tmp_path / "grains.csv", "csv", at=float(whole.frames.t[-1]))
    there = int(np.isfinite(whole.frames.x[-1][:, 0]).sum())
    assert len(table.read_text().splitlines()) == there + 2 + int(whole.scene.fixed_active.sum())


def test_a_clump_taken_out_of_a_contact_leaves_no_imbalance() -> None:
    """Two that spin and collide without damping: one is taken away while they press on each other."""
    keys: dict[str, Any] = {"timing": ContactTiming.AT_STEPS, "restitution": 1.0, "friction": 0.3}
    x = np.array([[0.0, 0.0, 0.0], [1.7 * D, 0.1 * D, 0.2 * D], [0.0, 9.0 * D, 0.0]])
    scene, state = scene_of(x=x, d=D, stiffness=2000.0, dt=2.0e-6, **keys)
    omega = np.array([[20.0, -30.0, 10.0], [-15.0, 10.0, 40.0], [0.0, 0.0, 5.0]])
    v = np.array([[0.3, 0.0, 0.0], [-0.2, 0.1, 0.0], [0.0, 0.0, 0.0]])
    traffic = Traffic(exits=(Exit("far", point=(9.0, 0.0, 0.0), normal=(1.0, 0.0, 0.0)),), n_first=3)
    scene = replace(scene, traffic=traffic, world_low=(-1.0, -1.0, -5.0), world_high=(1.0, 1.0, 5.0))
    state = replace(state, v=v, omega=omega, present=np.ones(3, np.bool_))
    scene, state = with_clumps(scene, state, [shape("rod")])
    engine = GrainPool(CpuEngine())
    engine.load(scene, state)
    for _ in range(4000):
        engine.advance(10).raise_if_any()
        if len(engine.state().contacts) and engine.tally().spring_n > 0.2 * engine.tally().kinetic:
            break
    before = engine.state()
    assert before.tally is not None
    assert len(before.contacts) > 0
    held = before.tally.kinetic + before.tally.spin + before.tally.spring_n
    after, _ = removed(scene, before, np.array([3]))
    assert after.present.tolist() == [True] * 3 + [False] * 3 + [True] * 3
    engine.load(scene, after)
    engine.advance(200).raise_if_any()
    change = engine.tally().imbalance - before.tally.imbalance
    assert abs(change) < 1e-4 * held
    assert engine.tally().spring_n == 0.0


@pytest.mark.full
def test_clumps_fed_into_water_of_a_given_profile_settle_and_the_account_closes(tmp_path: Path) -> None:
    """They fall a long way through still water, and leave at the speed that the law of their form gives."""
    n = 8
    scene, state = scene_of(
        x=np.arange(3.0 * n).reshape(n, 3) * D, d=D, water=STILL, dt=1e-4,
        planes=[("deep", (0.0, 0.0, -100.0), (0.0, 0.0, 1.0))], timing=ContactTiming.AT_STEPS,
        events=EventRule.NONE,
    )  # fmt: skip
    feed = Feed(
        "hose", centre=(0.0, 0.0, 0.9), normal=DOWN, radius=0.02, velocity=(0.0, 0.0, -0.1), rate=4.0,
        count=n, seed=3,
    )  # fmt: skip
    traffic = Traffic((feed,), (Exit("floor", point=(0.0, 0.0, 0.0), normal=DOWN),), 20, 0)
    away = np.full((n, 3), np.nan)
    scene = replace(scene, traffic=traffic, world_low=(-1.0, -1.0, -5.0), world_high=(2.0, 1.0, 5.0))
    state = replace(state, x=away, v=away, omega=away, present=np.zeros(n, np.bool_))
    forms = [shape("tetrahedron"), shape("blade")]
    scene, state = with_clumps(scene, state, forms, form_of=np.arange(n) % 2)
    scene = replace(scene, dt=1e-4)
    run = run_scene(scene, state, tmp_path / "run", frames=2.0e-3, stop=Stop(time=6.0), progress=False)
    rows, bodies = run.passages, scene.bodies
    assert bodies is not None
    assert (rows["way"] == OUT).sum() > 4
    assert run.tally["residual"].max() < 1e-12
    assert run.tally["drag"][-1] < -0.9 * run.tally["switch"].max()
    for row in rows[rows["way"] == OUT]:
        k = np.searchsorted(run.frames.step, row["step"]) - 1  # the last frame in which it was there
        which = int(bodies.of_grain(scene.n_grain)[row["grain"]])
        speed = -float(run.bodies[k].v[which, 2])
        stokes, newton, sphericity = drag_form(STILL.drag_of_form, forms[which % 2], 2.65)
        re = speed * D / 1.0e-6
        c_d = evaluate(STILL.drag_of_form, re=re, stokes=stokes, newton=newton, sphericity=sphericity)
        assert 0.75 * c_d * speed**2 == pytest.approx(1.65 * G * D, rel=1e-6)
