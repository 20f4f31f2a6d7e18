"""Adhesion (contact.adhesion) against closed forms: rest, pull-off, sticking, friction, and its account."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.engine.conftest import D, M, bits, contact_law, elastic_law, pile, run
from tests.kernel_variants import full_but

from ryusa.build import scene
from ryusa.build.clumps import with_clumps
from ryusa.build.walls import WallMotion, rectangle, with_walls
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.engine.cuda.engine import CudaEngine
from ryusa.engine.shared.contact_history import forces_of_contacts
from ryusa.engine.shared.refusals import refusals
from ryusa.laws.families import Adhesion, Cap, ContactTiming, DampingLaw, Slip
from ryusa.model import Materials, RollingLaw, Term
from ryusa.model.clump import shape
from ryusa.model.contact_law import (
    attraction_of,
    pull_off_of,
    rest_overlap_of,
    shortest_contact_of,
    sticking_speed_of,
)
from ryusa.model.scene import EventRule

PULL = 20.0 * M * 9.8  # [N]
R = 0.5 * D  # reduced radius on a plane [m]
WORK = PULL / (2.0 * math.pi * R)  # of adhesion [J/m2]
LAWS = {
    "linear, constant": contact_law(zeta_n=0.12),
    "linear, constant, may pull": contact_law(zeta_n=0.12, tension=True),
    "linear, DMT": contact_law(k_n=300.0, zeta_n=0.12),
    "elastic, constant": elastic_law(0.05),
    "elastic, DMT, may pull": elastic_law(0.05, damping_law=DampingLaw.TSUJI),
    "elastic, contact area": elastic_law(0.05, youngs_modulus=1.0e7),
}
ELASTIC = tuple(name for name in LAWS if name.startswith("elastic"))  # by `make test`
AMOUNTS = {"constant": PULL, "DMT": WORK, "contact area": 2.0e5}


def sticky(name):
    """One of the laws, with its attraction."""
    word = name.split(", ")[1]
    return replace(LAWS[name], adhesion=Adhesion.of(word), adhesion_amount=AMOUNTS[word])


def on_a_plane(law, per_contact=400.0, height=0.5 * D, **more):
    """A grain over a floor, without gravity unless told otherwise."""
    dt = shortest_contact_of(law, M, R) / per_contact
    return scene(
        [[0.0, 0.0, height]], D, planes=[("floor", (0, 0, 0), (0, 0, 1))], contact=law, dt=dt,
        **({"gravity": 0.0, "allow_overlap": True} | more),
    )  # fmt: skip


@pytest.mark.parametrize("name", full_but(ELASTIC, LAWS))
def test_a_slow_impact_sticks_and_a_faster_one_parts(name):
    law = sticky(name)
    speed = sticking_speed_of(law, M, R)
    for factor in (0.98, 1.02):
        made = on_a_plane(law, 1000.0, 0.5 * D + 1e-9, v=[[0.0, 0.0, -factor * speed]])
        engine = run(made, 12_000)
        assert (len(engine.state().contacts) == 1) == (factor < 1.0)
        assert engine.tally().residual < 1e-9  # a straight way: what begins and ends at steps is in the books
        if factor > 1.0:
            assert engine.state().v[0, 2] > 0.0


@pytest.mark.parametrize("name", full_but(ELASTIC, LAWS))
def test_at_rest_the_overlap_is_that_of_the_attraction_as_a_load(name):
    law = sticky(name)
    pull, slope = attraction_of(law, R)
    rest = rest_overlap_of(law, R)
    engine = run(on_a_plane(law, 100.0, 0.5 * D - 0.9 * rest), 10_000)
    state, tally = engine.state(), engine.tally()
    assert 0.5 * D - state.x[0, 2] == pytest.approx(rest, rel=1e-6)
    spring = engine.state().contacts.f_n[0]
    assert spring == pytest.approx(pull + slope * rest, rel=1e-6)
    (force,) = forces_of_contacts(engine._scene, state, np.arange(1)).force
    assert np.abs(force).max() < 1e-5 * spring
    held = spring * rest * (0.4 if name.startswith("elastic") else 0.5)
    assert tally.spring_n == pytest.approx(held - (pull + 0.5 * slope * rest) * rest, rel=1e-5)


@pytest.mark.parametrize("name", full_but(ELASTIC, LAWS))
def test_a_grain_hangs_from_a_ceiling_as_long_as_its_pull_off_force_is_above_its_weight(name):
    law = sticky(name)
    hold = pull_off_of(law, R)
    for load in (0.97, 1.03):
        made = scene(
            [[0.0, 0.0, -0.5 * D + rest_overlap_of(law, R)]], D, planes=[("ceiling", (0, 0, 0), (0, 0, -1))],
            contact=law, dt=shortest_contact_of(law, M, R) / 50.0, gravity=0.0,
            allow_overlap=True,
        )  # fmt: skip
        engine = CpuEngine(threads=1)
        engine.load(*made)
        for k in range(240):  # loaded slowly, so that nothing swings
            weight = load * hold * min((k + 1) / 200.0, 1.0)
            loaded = replace(made[0], gravity=np.array([0.0, 0.0, -weight / M]))
            engine.load(loaded, engine.state())
            engine.advance(100).raise_if_any()
            if not len(engine.state().contacts):
                break
        assert (len(engine.state().contacts) == 1) == (load < 1.0)


@pytest.mark.full
@pytest.mark.parametrize("cap", [Cap.SPRING, Cap.TOTAL])
def test_friction_is_mu_times_the_push_of_load_and_attraction(cap):
    mu, c = 0.3, 2.0 * M
    slip = Slip.TOTAL if cap is Cap.TOTAL else Slip.SPRING_DROP
    for dry in (
        contact_law(mu=mu, cap=cap, slip=slip, cohesion=c),
        elastic_law(0.05, friction=mu, cap=cap, slip=slip, cohesion=c),
    ):
        law = replace(dry, adhesion=Adhesion.CONSTANT, adhesion_amount=PULL)
        rest, weight = rest_overlap_of(law, R, M * 9.8), M * 9.8
        made = on_a_plane(law, 100.0, 0.5 * D - rest, v=[[2.0, 0.0, 0.0]], gravity=9.8)
        engine = run(made, 400)
        first = engine.state()
        engine.advance(800).raise_if_any()
        last = engine.state()
        slowed = (first.v[0, 0] - last.v[0, 0]) / (last.t - first.t)
        assert last.v[0, 0] - R * last.omega[0, 1] > 0.1  # slides all the time
        assert slowed * M == pytest.approx(c + mu * (weight + PULL), rel=1e-3)


@pytest.mark.full
def test_an_attraction_of_nothing_changes_no_bit():
    made, state = pile(120, contact=contact_law(mu=0.4))
    none = run((made, state), 400)
    zero = replace(made, contact=replace(made.contact, adhesion=Adhesion.CONSTANT, adhesion_amount=0.0))
    zero = run((zero, state), 400)
    assert len(none.state().contacts) > 10
    assert bits(none.state())[:3] == bits(zero.state())[:3]
    assert none.tally() == zero.tally()


def sticky_pile(name, stir):
    return pile(contact=sticky(name), stir=stir)


@pytest.mark.parametrize(
    "name", full_but(ELASTIC, ["linear, DMT", "elastic, constant", "elastic, contact area"])
)
def test_any_number_of_threads_and_a_resumed_snapshot_give_the_same_bits(name):
    made = sticky_pile(name, 0.2)
    whole, many, first = run(made, 4000), run(made, 4000, threads=3), run(made, 2777)
    assert len(first.state().contacts) > 15
    resumed = CpuEngine(threads=2)
    resumed.load(made[0], first.state())
    resumed.advance(4000 - 2777).raise_if_any()
    assert bits(many.state()) == bits(whole.state()) == bits(resumed.state())
    assert many.tally() == whole.tally() == resumed.tally()


@pytest.mark.full
@pytest.mark.parametrize("name", ["linear, DMT", "elastic, constant", "elastic, contact area"])
def test_the_account_of_grains_that_stick_closes_as_without_adhesion(name):
    made, state = sticky_pile(name, 0.05)
    found = {}
    for law in (made.contact, replace(made.contact, adhesion=Adhesion.NONE, adhesion_amount=0.0)):
        tally = run((replace(made, contact=law), state), 12_000).tally()
        found[law.adhesion] = tally
        assert abs(tally.terms[Term.STEP]) < 0.05 * tally.terms[Term.START]
    stuck, loose = found[made.contact.adhesion], found[Adhesion.NONE]
    assert stuck.n_contact > loose.n_contact
    assert stuck.residual < max(2.0 * loose.residual, 1e-4)


@pytest.mark.full
def test_momentum_and_angular_momentum_of_a_free_pair_are_kept():
    law = replace(contact_law(mu=0.4, zeta_n=0.3), adhesion=Adhesion.CONSTANT, adhesion_amount=100.0 * PULL)
    made, first = scene(
        [[0.0, 0.0, 0.0], [1.2e-3, 0.4e-3, 1.54e-3]], D, v=[[0.2, 0.04, 0.1], [-0.1, 0.0, -0.2]],
        omega=[[50.0, 300.0, 20.0], [0.0, -100.0, 70.0]], contact=law, gravity=0.0, allow_overlap=True,
    )  # fmt: skip

    def momentum(state):
        p = made.m[:, None] * state.v
        return p.sum(axis=0), (np.cross(state.x, p) + made.inertia[:, None] * state.omega).sum(axis=0)

    engine = run((made, first), 3000)
    assert len(engine.state().contacts) == 1  # they turn about each other
    for before, after, size in zip(momentum(first), momentum(engine.state()), (5e-6, 1e-8), strict=True):
        assert after == pytest.approx(before, rel=0.0, abs=1e-11 * size)


@pytest.mark.full
def test_each_pair_of_materials_has_its_own_attraction():
    law = elastic_law(0.05)
    law = replace(law, adhesion=Adhesion.DMT, adhesion_amount=WORK)
    made, state = scene(
        [[0.0, 0.0, 0.4999 * D], [4.0 * D, 0.0, 0.4999 * D]], D, planes=[("floor", (0, 0, 0), (0, 0, 1))],
        contact=law, dt=shortest_contact_of(law, M, R) / 50.0, gravity=0.0,
            allow_overlap=True,
    )  # fmt: skip
    strong = replace(law, adhesion_amount=8.0 * WORK)
    made = replace(
        made,
        materials=Materials(
            ("grains", "clay"), np.array([0, 1, 1], np.int8), (law, strong, strong, law), (RollingLaw(),) * 4
        ),
    )
    engine = run((made, state), 6000)
    rest = 0.5 * D - engine.state().x[:, 2]
    assert rest == pytest.approx([4.0 * rest_overlap_of(law, R), rest_overlap_of(law, R)], rel=1e-6)
    assert engine.tally().residual < 1e-9


@pytest.mark.full
@pytest.mark.parametrize(
    "name",
    # elastic spheres on walls and elastic spheres that stick have faster tests of their own
    ["linear, DMT", pytest.param("elastic, constant", marks=pytest.mark.slow)],
)
def test_a_wall_lifts_a_grain_that_hangs_on_it_and_its_work_is_booked(name):
    law = sticky(name)
    wall = rectangle("ceiling", (-1, -1, 0), (2, 0, 0), (0, 2, 0))
    wall = replace(wall, motion=WallMotion(amplitude=(0, 0, 0.25 * D), frequency=4.0))
    rest = rest_overlap_of(law, R)
    made, first = scene(
        [[0.0, 0.0, -0.5 * D + rest]], D, contact=law, allow_overlap=True,
        dt=shortest_contact_of(law, M, R) / 30.0,
    )  # fmt: skip
    engine = run((with_walls(made, [wall]), first), round(0.0625 / made.dt))
    state, tally = engine.state(), engine.tally()
    assert len(state.contacts) == 1
    up = 0.25 * D * math.sin(2.0 * math.pi * 4.0 * state.t)
    assert up > 0.2 * D
    assert state.x[0, 2] == pytest.approx(up - 0.5 * D + rest, abs=1e-3 * D)
    swing = 0.5 * M * (state.v[0, 2]) ** 2
    assert tally.terms[Term.WALL] == pytest.approx(M * 9.80665 * up + swing, rel=0.02)
    assert tally.residual < 1e-3


@pytest.mark.full
def test_clumps_stick_by_each_of_their_spheres():
    law = replace(contact_law(zeta_n=0.12), adhesion=Adhesion.CONSTANT, adhesion_amount=PULL)
    form = shape("dumbbell")
    for load in (1.9, 2.1):  # times the pull-off force of one sphere
        made = scene(
            [[0.0, 0.0, 0.0]], D, planes=[("ceiling", (0, 0, 0), (0, 0, -1))], contact=law,
            dt=shortest_contact_of(law, M, R) / 50.0, gravity=0.0, allow_overlap=True,
        )  # fmt: skip
        fixed, first = with_clumps(*made, [form], orientation=[[1.0, 0.0, 0.0, 0.0]])
        high = float((first.x[:, 2] + 0.5 * fixed.d).max())
        lift = np.array([0.0, 0.0, rest_overlap_of(law, R) - high])
        first = replace(first, x=first.x + lift, bodies=replace(first.bodies, x=first.bodies.x + lift))
        assert np.ptp(first.x[:, 2]) < 1e-12  # both spheres touch
        engine = CpuEngine(threads=1)
        engine.load(fixed, first)
        for k in range(120):
            pull = load * PULL / float(fixed.bodies.m[0]) * min((k + 1) / 100.0, 1.0)
            engine.load(replace(fixed, gravity=np.array([0.0, 0.0, -pull])), engine.state())
            engine.advance(100).raise_if_any()
            if not len(engine.state().contacts):
                break
        assert len(engine.state().contacts) == (2 if load < 2.0 else 0)


@pytest.mark.full
def test_a_plane_scene_with_records_agrees_with_space():
    law = replace(contact_law(mu=0.4), adhesion=Adhesion.CONSTANT, adhesion_amount=5.0 * PULL)
    ends = []
    for plane_case in (True, False):
        made = scene(
            [[0.0, 0.0, 0.0], [1.6e-3, 0.0, 1.3e-3]], D, v=[[0.1, 0.0, 0.2], [-0.3, 0.0, -0.4]],
            omega=[[0.0, 90.0, 0.0], [0.0, -30.0, 0.0]], contact=law, gravity=0.0, plane_case=plane_case,
            events=EventRule.ALL,
        )  # fmt: skip
        engine = run(made, 2000)
        (event,) = engine.events()
        state, m = engine.state(), float(made[0].m[0])
        gained = m * (event["v_end"] - event["v_begin"])
        assert event["impulse"] == pytest.approx(gained, rel=2e-3, abs=2e-3 * np.abs(gained).max())
        ends.append(np.hstack([state.x, state.v, state.omega * 1e-3]))
    assert ends[0] == pytest.approx(ends[1], rel=1e-9, abs=1e-15)


def test_what_adhesion_cannot_have_is_refused_by_name():
    made, _ = on_a_plane(sticky("linear, constant"))
    for change, says in (
        ({"timing": ContactTiming.EXACT}, "adhesion needs contact.timing = 'at steps'"),
        ({"adhesion": Adhesion.CONTACT_AREA}, "'contact area' needs elastic spheres"),
        ({"adhesion_amount": -1.0}, "must be a number from 0 on"),
        ({"adhesion_amount": math.nan}, "must be a number from 0 on"),
    ):
        (reason,) = refusals(replace(made, contact=replace(made.contact, **change)))
        assert says in reason
    assert refusals(made) == ()
    assert any("adhesion is simulated by engine" in reason for reason in CudaEngine().refuses(made))
