"""Clumps in the engine: rigid motion, impacts off the centre, conservation, the same bits."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.engine.conftest import D, bits, elastic_law, run

from ryusa.build import scene
from ryusa.build.clumps import random_orientations, with_clumps
from ryusa.build.walls import WallMotion, rectangle, with_walls
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.shared.energy_account import potential_energy
from ryusa.errors import CaseError
from ryusa.laws.families import ContactTiming
from ryusa.model import Term
from ryusa.model.clump import shape
from ryusa.model.scene import EventRule

FLOOR = ("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
KEYS = {"timing": ContactTiming.AT_STEPS, "events": EventRule.NONE}


def clumps(form, *, orientation=None, **keys):
    made = scene(**{**KEYS, "d": D, **keys})
    return with_clumps(*made, [shape(form)], orientation=orientation)


def block(form="rod", side=6, high=4, seed=1, **more):
    """Clumps in layers above a floor, periodic, stirred, turned at random; their number is 0.7 of all."""
    rng = np.random.default_rng(seed)
    pitch = 1.02 * D * shape(form).extent
    x = np.stack(np.meshgrid(*(np.arange(k) for k in (side, side, high)), indexing="ij"), -1).reshape(-1, 3)
    x = (x + np.array([0.0, 0.0, 0.6])) * pitch
    made = scene(
        x=x, d=D, v=rng.normal(0.0, 0.3, x.shape), planes=[FLOOR], period=(side * pitch, side * pitch),
        steps_per_contact=30.0, **{**KEYS, **more},
    )  # fmt: skip
    which = np.where(rng.uniform(size=len(x)) < 0.7, 0, -1)
    return with_clumps(*made, [shape(form)], form_of=which, orientation=random_orientations(len(x), rng))


def held(tally):
    return tally.kinetic + tally.spin + tally.potential + tally.spring_n + tally.spring_s


@pytest.mark.full
@pytest.mark.parametrize("law", [{}, {"contact": elastic_law(r=0.5 * D, friction=0.4, restitution=0.5)}])
def test_a_clump_of_one_sphere_does_as_the_sphere(law):
    how = {
        "x": [[0, 0, 0.75 * D], [0.25 * D, 0.35 * D, 2.0 * D]], "v": [[0.1, 0.02, -0.3], [0.0, 0.0, -1.0]],
        "omega": [[10.0, 20.0, 3.0], [0.0, 5.0, 0.0]], "planes": [FLOOR], **law,
    }  # fmt: skip
    alone = run(scene(d=D, **KEYS, **how), 4000)
    turned = random_orientations(2, np.random.default_rng(3))
    made = clumps("sphere", orientation=turned, **how)
    clump = run((replace(made[0], dt=scene(d=D, **KEYS, **how)[0].dt), made[1]), 4000)
    for name in ("x", "v"):
        assert np.allclose(getattr(clump.grains(), name), getattr(alone.grains(), name), rtol=1e-10)
    assert np.allclose(clump.grains().omega, alone.grains().omega, rtol=1e-9)
    assert held(clump.tally()) == pytest.approx(held(alone.tally()), rel=1e-10)


@pytest.mark.full
def test_a_clump_in_free_flight_keeps_its_energy_and_angular_momentum():
    """Thrown about its middle axis, so that it turns over: energy swings by the second order of the step."""
    made = clumps("blade", x=[[0, 0, 0]], v=[[0.1, 0, 0]], omega=[[0.1, 200.0, 0.2]], gravity=0.0, dt=1e-5)
    engine, first = CpuEngine(), made[1].bodies
    engine.load(*made)
    engine.advance(1)
    spin, lowest = engine.tally().spin, 1.0
    for _ in range(200):
        engine.advance(100)
        now = engine.state().bodies
        assert engine.tally().spin == pytest.approx(spin, rel=2e-6)
        _, q_x, _, q_z = now.q[0]
        lowest = min(lowest, 1.0 - 2.0 * (q_x**2 + q_z**2))  # cosine of the middle axis to y
    assert np.array_equal(now.momentum, first.momentum)
    assert engine.tally().spin == pytest.approx(spin, rel=2e-6)
    assert np.allclose(now.x[0], [0.1 * made[0].dt * 20_001, 0.0, 0.0], rtol=1e-12)
    assert lowest < -0.99  # it turned over
    x, _, omega = now.of_members(made[0].bodies)
    state = engine.grains()
    assert np.allclose(state.x, x, atol=1e-15)
    assert np.allclose(state.omega, omega, rtol=3e-3, atol=0.3)


@pytest.mark.full
@pytest.mark.parametrize("angle", [0.3, 0.8, 1.2])
def test_an_elastic_impact_off_the_centre_is_that_of_a_rigid_body(angle):
    """A dumbbell whose lower end hits a smooth floor: J = 2 u/(1/m + (a x n)^2/I) (any text on mechanics)."""
    half = 0.5 * angle
    q = [[math.cos(half), 0.0, math.sin(half), 0.0]]  # its long axis x turned towards -z
    made = clumps(
        "dumbbell", x=[[0, 0, 3.0 * D]], v=[[0, 0, -0.1]], orientation=q, planes=[FLOOR], gravity=0.0,
        restitution=1.0, friction=0.0, stiffness=1e6, steps_per_contact=100.0,
    )  # fmt: skip
    bodies = made[0].bodies
    lowest = float((made[1].x[:, 2] - 0.5 * made[0].d).min())
    steps = int((lowest / 0.1 + 2e-4) / made[0].dt)
    after = run(made, steps).state().bodies
    lever = float(made[1].bodies.arms(bodies)[1, 0])  # of the lower end
    m, inertia = float(bodies.m[0]), float(bodies.inertia[0, 1])
    impulse = 2.0 * 0.1 / (1.0 / m + lever**2 / inertia)
    assert after.v[0, 2] == pytest.approx(impulse / m - 0.1, rel=2e-3)
    assert after.spin(bodies)[0, 1] == pytest.approx(-impulse * lever / inertia, rel=2e-3)
    assert after.v[0, :2] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.full
@pytest.mark.parametrize("form", ["dumbbell", "tetrahedron", "blade"])
def test_bouncing_clumps_without_damping_keep_their_energy(form):
    """Two of them and a floor; what the energy is off by falls with the square of the step."""
    how = {
        "x": [[0, 0, 1.0 * D], [0.2 * D, 0.3 * D, 3.0 * D]], "v": [[0.1, 0.02, -0.3], [0.0, 0.0, -1.0]],
        "omega": [[10.0, 20.0, 3.0], [0.0, 5.0, 0.0]], "planes": [FLOOR], "restitution": 1.0, "friction": 0.0,
    }  # fmt: skip
    fixed, first = clumps(form, orientation=random_orientations(2, np.random.default_rng(3)), **how)
    off = []
    for finer in (1, 4):
        engine = CpuEngine()
        engine.load(replace(fixed, dt=fixed.dt / finer), first)
        engine.advance(1)
        start = held(engine.tally())
        worst = 0.0
        for _ in range(100):
            engine.advance(100 * finer).raise_if_any()
            worst = max(worst, abs(held(engine.tally()) / start - 1.0))
        off.append(worst)
        assert engine.tally().residual < 1e-5 / finer
    assert off[0] < 1e-3
    assert off[1] < off[0] / 4.0


@pytest.mark.full
def test_two_clumps_that_collide_keep_their_momenta():
    """With friction and damping: linear and angular momentum of both together, to round-off."""
    made = clumps(
        "tetrahedron", x=[[0, 0, 0], [0.3 * D, 0.2 * D, 2.2 * D]], v=[[0, 0, 0.5], [0, 0, -0.5]],
        omega=[[50.0, 20.0, -10.0], [0.0, 80.0, 5.0]], gravity=0.0, restitution=0.5, friction=0.6,
        orientation=random_orientations(2, np.random.default_rng(5)),
    )  # fmt: skip
    bodies = made[0].bodies

    def momenta(state):
        p = bodies.m[:, None] * state.v
        return np.concatenate([p.sum(axis=0), (np.cross(state.x, p) + state.momentum).sum(axis=0)])

    engine = run(made, 6000)
    assert engine.tally().terms[Term.SLIDE] + engine.tally().terms[Term.DASH_N] != 0.0  # they met
    before, after = momenta(made[1].bodies), momenta(engine.state().bodies)
    assert np.allclose(after[:3], before[:3], atol=1e-14 * bodies.m.sum())
    assert np.allclose(after[3:], before[3:], atol=1e-12 * bodies.m.sum() * D)


@pytest.mark.full
def test_a_tetrahedron_stands_on_a_slope_on_which_a_sphere_rolls_down():
    up, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [shape("tetrahedron").x[0]])  # one corner up
    q = [up.as_quat(scalar_first=True)]
    how = {"planes": [FLOOR], "slope": math.radians(15.0), "friction": 0.5, "restitution": 0.3}
    made = clumps("tetrahedron", x=[[0, 0, 0.75 * D]], orientation=q, **how)
    engine = run(made, int(0.1 / made[0].dt))
    state = engine.state()
    assert state.contacts.j.tolist() == [4, 4, 4]
    assert abs(state.bodies.v[0]).max() < 1e-5
    weight = made[0].bodies.m[0] * 9.80665 * math.cos(math.radians(15.0))
    assert state.contacts.f_n.sum() == pytest.approx(weight, rel=1e-4)
    sphere = run(scene(x=[[0, 0, 0.5 * D]], d=D, **KEYS, **how), 10_000)
    t = sphere.state().t
    assert sphere.state().v[0, 0] == pytest.approx(5.0 / 7.0 * 9.80665 * math.sin(how["slope"]) * t, rel=0.02)


@pytest.mark.full
def test_a_pile_gives_the_same_bits_for_any_threads_and_after_a_resume():
    """Members of one clump lie in several blocks, and cross the period."""
    made = block()
    wall = replace(rectangle("lid", (-1, -1, 20 * D), (2, 0, 0), (0, 2, 0)))
    made = (with_walls(made[0], [replace(wall, motion=WallMotion(velocity=(0.0, 0.0, -0.2)))]), made[1])
    one, two = run(made, 6000), run(made, 6000, threads=2)
    state = one.state()
    assert bits(state) == bits(two.state())
    assert one.tally() == two.tally()
    for cut in (1, 1234, 4001):
        first = run(made, cut)
        again = CpuEngine()
        again.load(made[0], first.state())
        again.advance(6000 - cut).raise_if_any()
        assert bits(again.state()) == bits(state)
        assert again.tally() == one.tally()
        for name in ("x", "v", "q", "momentum", "image"):
            assert np.array_equal(getattr(again.state().bodies, name), getattr(state.bodies, name))
    assert state.bodies.image.any()
    assert one.tally().residual < 2e-4
    x, _, _ = state.bodies.of_members(made[0].bodies)
    apart = state.x[made[0].bodies.members] - x
    for k in range(2):
        apart[:, k] -= made[0].period[k] * np.round(apart[:, k] / made[0].period[k])
    assert np.abs(apart).max() < 1e-12


def test_a_part_of_the_grains_may_be_clumps_and_ids_follow():
    fixed, state = block(side=4, high=2)
    bodies = fixed.bodies
    assert 0 < bodies.n < 32
    assert fixed.n_grain == 32 + 2 * bodies.n
    assert fixed.groups["grains"] == (0, fixed.n_grain)
    assert fixed.m.sum() == pytest.approx(32 * 2650.0 * math.pi / 6.0 * D**3, rel=1e-12)
    d, m = fixed.whole_grains()
    assert len(d) == 32
    outside = scene(x=[[1.5, 0.2, D]], d=D, period=(1.0, 1.0), **KEYS)
    there, moved = with_clumps(*outside, [shape("rod")])
    assert moved.image.tolist() == [[1, 0]] * 3
    assert moved.bodies.image.tolist() == [[1, 0]]
    assert potential_energy(there, moved) == pytest.approx(potential_energy(*outside), rel=1e-12)
    assert m == pytest.approx(2650.0 * math.pi / 6.0 * d**3)
    assert bodies.least_mass == pytest.approx(bodies.m * shape("rod").least_mass)
    assert np.array_equal(np.bincount(bodies.of_grain(fixed.n_grain) + 1)[1:], np.full(bodies.n, 3))
    assert len(state.x) == fixed.n_grain


def test_what_clumps_cannot_do_is_refused_by_name():
    exact = with_clumps(*scene(x=[[0, 0, D]], d=D), [shape("rod")])[0]
    assert "at steps" in CpuEngine().refuses(exact)[0]
    flat = with_clumps(*scene(x=[[0, 0, D]], d=D, plane_case=True, **KEYS), [shape("rod")])[0]
    assert "motion in space" in CpuEngine().refuses(flat)[0]
    fixed, state = clumps("rod", x=[[0, 0, D]])
    moved = replace(state, x=state.x + 0.01 * D)
    with pytest.raises(ValueError, match="not where its clump has it"):
        CpuEngine().load(fixed, moved)
    with pytest.raises(ValueError, match=r"state\.bodies must hold"):
        CpuEngine().load(fixed, replace(state, bodies=None))
    with pytest.raises(CaseError, match="form_of"):
        with_clumps(*scene(x=[[0, 0, D]], d=D, **KEYS), [shape("rod")], form_of=[1])
    with pytest.raises(CaseError, match="without clumps"):
        with_clumps(fixed, state, [shape("rod")])
