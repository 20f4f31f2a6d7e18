"""Contacts that begin and end within steps (contact.timing = "exact") against closed forms and fine steps."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.engine.conftest import D, bits, pile, run
from tests.engine.heaps import EXACT, heap

from ryusa.build import build, scene
from ryusa.engine.cpu.engine import CpuEngine
from ryusa.laws import collision
from ryusa.laws.families import Arm, ContactTiming, Drag, Profile, Rebound, Rolling, Slip
from ryusa.laws.immersed import restitution_exponential, stokes_number
from ryusa.laws.rolling import reduced_radius
from ryusa.model import ContactLaw, RollingLaw, Water
from ryusa.model.scene import EventRule
from ryusa_studies.osada2004._parts import paper_run

SPEED, K_N, PHASES = 0.1, 1.0e4, 40


def impacts(
    e, partner, steps, plane=False, tension=False, timing=ContactTiming.EXACT, aslant=0.0, phase=None, **more
):
    """Impacts at `PHASES` phases of the first step of touch, far apart from each other: scene and engine."""
    phase = (np.arange(PHASES) + 0.5) / PHASES if phase is None else phase
    common = {
        "stiffness": K_N, "restitution": e, "tension": tension, "timing": timing, "plane_case": plane,
        "gravity": 0.0, "steps_per_contact": steps, **more,
    }  # fmt: skip
    still = np.zeros((PHASES, 3))
    still[:, 1] = 10.0 * D * np.arange(PHASES)
    twice = np.vstack([still, still + np.array([0.0, 0.0, 5.0 * D])])
    dt = scene(twice if partner == "free" else still, D, **common)[0].dt
    gap = (3.0 + phase) * SPEED * dt
    x, v = still.copy(), np.zeros((PHASES, 3))
    x[:, 2] = gap + (0.5 * D if partner == "wall" else D)
    v[:, 0], v[:, 2] = aslant * SPEED, -SPEED
    if partner == "free":
        x, v = np.vstack([x, still]), 0.5 * np.vstack([v, -v])
    elif partner == "fixed":
        common["x_fixed"] = still
    else:
        common["planes"] = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    made = scene(x, D, v=v, events=EventRule.ALL, **common)
    return made[0], run(made, int(4 * steps) + 10)


@pytest.mark.parametrize("plane", [False, True])
@pytest.mark.parametrize("partner", ["fixed", "wall", "free"])
@pytest.mark.parametrize("tension", [False, True])
@pytest.mark.parametrize("e", [0.1, 0.5, 0.9, 0.98])
def test_restitution_and_contact_time_are_exact_at_every_phase_of_touch(e, tension, partner, plane):
    for steps in (5, 6, 8, 15):
        fixed, engine = impacts(e, partner, steps, plane, tension)
        found = engine.events()
        m = fixed.m[0] * (0.5 if partner == "free" else 1.0)
        zeta = collision.zeta_for_restitution(e, tension)
        t_col = collision.contact_time(zeta, math.sqrt(K_N / m), tension)
        assert len(found) == PHASES
        assert found["closing_begin"] == pytest.approx(SPEED, rel=1e-11)
        assert -found["closing_end"] == pytest.approx(e * SPEED, rel=1e-11)
        assert found["t_end"] - found["t_begin"] == pytest.approx(t_col, rel=1e-11)
        assert found["impulse_n"] == pytest.approx(m * (1.0 + e) * SPEED, rel=1e-11)
        tally = engine.tally()
        assert tally.residual < 1e-11
        assert tally.spring_n == tally.spring_s == 0.0


@pytest.mark.parametrize("tension", [False, True])
@pytest.mark.parametrize("e", [0.1, 0.5, 0.9])
def test_a_contact_that_touches_and_leaves_at_steps_but_for_round_off_is_as_exact(e, tension):
    m = scene(np.zeros((1, 3)), D)[0].m[0]
    t_col = collision.contact_time(collision.zeta_for_restitution(e, tension), math.sqrt(K_N / m), tension)
    phase = np.concatenate([way * 10.0 ** np.linspace(-16, -6, PHASES // 2) for way in (-1.0, 1.0)])
    found = impacts(e, "fixed", 8, tension=tension, phase=phase, dt=t_col / 8)[1].events()
    assert len(found) == PHASES
    assert -found["closing_end"] == pytest.approx(e * SPEED, rel=1e-8)
    assert found["t_end"] - found["t_begin"] == pytest.approx(t_col, rel=1e-8)


@pytest.mark.parametrize("plane", [False, True])
@pytest.mark.parametrize("aslant", [0.5, 5.0])
def test_the_normal_motion_of_an_oblique_impact_on_a_wall_is_that_of_a_head_on_one(aslant, plane):
    fixed, engine = impacts(0.7, "wall", 8, plane=plane, aslant=aslant, friction=0.4)
    found = engine.events()
    assert found["closing_begin"] == pytest.approx(SPEED, rel=1e-11)
    assert -found["closing_end"] == pytest.approx(0.7 * SPEED, rel=1e-11)
    assert found["impulse_n"] == pytest.approx(fixed.m[0] * 1.7 * SPEED, rel=1e-11)


def test_a_law_given_by_its_damping_ratio_alone_is_as_exact():
    law = ContactLaw(
        k_n=K_N, k_s=0.0, mu=0.0, zeta_n=collision.zeta_no_tension(0.7), timing=ContactTiming.EXACT
    )
    assert math.isnan(law.e_n)
    found = impacts(0.7, "fixed", 8, contact=law)[1].events()
    assert -found["closing_end"] == pytest.approx(0.7 * SPEED, rel=1e-11)


@pytest.mark.full
@pytest.mark.parametrize("e", [0.5, 0.9])
@pytest.mark.parametrize("slip", [Slip.SPRING, Slip.TOTAL])
@pytest.mark.parametrize("aslant", [0.1, 0.5, 1.0, 2.0, 5.0])
def test_at_eight_steps_an_oblique_impact_is_as_exact_as_at_fifty_that_begin_at_steps(aslant, slip, e):
    """Worst error of the slip after the impact on a wall, over that before; sticking, sliding and both."""
    kind = {"slip": slip, "friction": 0.4, "aslant": aslant}
    fine = impacts(e, "wall", 4000, timing=ContactTiming.AT_STEPS, **kind)[1].events()
    right = np.mean(fine["slip_end"][:, 0] / fine["slip_begin"][:, 0])
    worst = {}
    for timing, steps in ((ContactTiming.EXACT, 8), (ContactTiming.AT_STEPS, 50)):
        found = impacts(e, "wall", steps, timing=timing, **kind)[1].events()
        worst[timing] = float(np.abs(found["slip_end"][:, 0] / found["slip_begin"][:, 0] - right).max())
    assert worst[ContactTiming.EXACT] < max(1.1 * worst[ContactTiming.AT_STEPS], 7.5e-3)


@pytest.mark.full
def test_the_immersed_rebound_is_exact_with_the_restitution_of_its_stokes_number():
    water = Water(profile=Profile.STILL, drag=Drag.NONE, rebound=Rebound.EXPONENTIAL, st_c=30.0)
    fixed, engine = impacts(0.9, "fixed", 8, water=water)
    found, m = engine.events(), float(fixed.m[0] + fixed.m_added[0])
    st = stokes_number(SPEED, m, reduced_radius(0.5 * D, 0.5 * D), water.rho_w, water.nu)
    e = restitution_exponential(0.9, st, water.st_c)
    assert 0.05 < e < 0.85
    assert -found["closing_end"] == pytest.approx(e * SPEED, rel=1e-9)


@pytest.mark.full
@pytest.mark.parametrize("plane", [False, True])
@pytest.mark.parametrize("steps", [5, 8])
def test_a_pile_comes_to_rest_as_quietly_as_with_many_steps(steps, plane):
    quiet = {}
    for timing, per_contact in ((ContactTiming.EXACT, steps), (ContactTiming.AT_STEPS, 50)):
        made = pile(n=200, plane_case=plane, timing=timing, steps_per_contact=per_contact)
        engine = run(made, int(0.6 / made[0].dt))
        tally = engine.tally()
        quiet[timing] = (tally.kinetic + tally.spin) / (made[0].m.sum() * 9.81 * D)
        assert tally.residual < 5e-3
    assert quiet[ContactTiming.EXACT] < max(10.0 * quiet[ContactTiming.AT_STEPS], 1e-6)


@pytest.mark.full
def test_resumed_after_any_step_a_run_gives_the_same_bits():
    """Rolling friction shares the inertia of a grain among its contacts: also where one has just ended."""
    made = heap(**EXACT | {"rolling": RollingLaw(Rolling.CONSTANT, Arm.REDUCED_RADIUS, 0.1), "stir": 0.5})

    def ended(first):
        parts, engine = [], CpuEngine()
        engine.load(*made)
        for n_steps in (first, 40 - first):
            engine.advance(n_steps).raise_if_any()
            parts.append(engine.events())
            kept, engine = engine.state(), CpuEngine()
            engine.load(made[0], kept)
        return bits(kept), np.sort(np.concatenate(parts)).tobytes(), kept.tally

    whole = ended(0)
    assert all(ended(first) == whole for first in range(1, 40))


def test_a_column_of_grains_at_rest_carries_its_weight():
    """Contacts that last are on the map: forces are the weights above, whatever the step."""
    n = 5
    x = [[0.0, 0.0, (k + 0.5) * D * 0.9999] for k in range(n)]
    floor = [("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    made = scene(
        x, D, planes=floor, timing=ContactTiming.EXACT, steps_per_contact=8.0, stiffness=1e3, restitution=0.5,
        allow_overlap=True, plane_case=True,
    )  # fmt: skip
    state = run(made, 20_000).state()
    weight = made[0].m[0] * 9.80665
    assert sorted(state.contacts.f_n) == pytest.approx([weight * k for k in range(1, 6)], rel=1e-9)


@pytest.mark.full
def test_static_friction_holds_up_to_the_coefficient_and_not_beyond():
    """A sphere without rotation on a slope: at rest below the angle of friction, sliding above it."""
    for excess in (0.99, 1.01):
        slope = math.atan(0.4 * excess)
        made = scene(
            [[0.0, 0.0, 0.5 * D]], D, planes=[("floor", (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))], friction=0.4,
            slip=Slip.TOTAL, slope=slope, rotation=False, timing=ContactTiming.EXACT, steps_per_contact=8.0,
            stiffness=1e3,
        )  # fmt: skip
        engine = run(made, 4000)
        before = float(engine.state().v[0, 0])
        engine.advance(4000).raise_if_any()
        gained = float(engine.state().v[0, 0]) - before
        wanted = 9.80665 * (math.sin(slope) - 0.4 * math.cos(slope)) * 4000 * made[0].dt
        assert gained == pytest.approx(max(wanted, 0.0), abs=1e-6)


def passing_by(miss, speed, law, dt, phase):
    """Velocity after a grain without friction met a fixed one off its centre by `miss` diameters [m/s]."""
    ahead = math.sqrt(1.0 - miss * miss) * D + (2.0 + phase) * speed * dt
    fixed, first = scene(
        [[ahead, 0.0, miss * D]], D, v=[[-speed, 0.0, 0.0]], x_fixed=[[0.0, 0.0, 0.0]], d_fixed=D,
        contact=law, dt=dt, gravity=0.0, rotation=False, plane_case=True,
    )  # fmt: skip
    n = int(2.5 * collision.contact_time(law.zeta_n, math.sqrt(law.k_n / fixed.m[0]), False) / dt)
    return run((replace(fixed, overlap_limit=math.inf), first), n + 8).state().v[0, [0, 2]]


def orbit(miss, speed, law, m):
    """The same by a fine integration in time of the motion in the plane [m/s]."""
    eta = 2.0 * law.zeta_n * math.sqrt(law.k_n * m)

    def force(y):
        r = math.hypot(y[0], y[1])
        return law.k_n * (D - r) - eta * (y[0] * y[2] + y[1] * y[3]) / r

    def rate(_, y):
        push = max(force(y), 0.0) / m / math.hypot(y[0], y[1])
        return [y[2], y[3], push * y[0], push * y[1]]

    def ends(t, y):
        return force(y) if t > 0.0 else 1.0

    ends.terminal, ends.direction = True, -1.0
    begin = [math.sqrt(1.0 - miss * miss) * D, miss * D, -speed, 0.0]
    return solve_ivp(rate, (0.0, 1.0), begin, events=ends, rtol=1e-11, atol=1e-14, max_step=1e-5).y[2:, -1]


# stiffness [N/m], speed [m/s]; velocity error over the speed that is allowed with exact timing: in the stable
# range of the paper, and on springs so soft that a grain passes a quarter and two thirds of d in a contact
SOFT = [(1e4, 0.3, 2e-4), (30.0, 0.3, 2e-3), (10.0, 0.5, 4e-3)]


@pytest.mark.full
@pytest.mark.parametrize("e", [0.7, 0.98])
@pytest.mark.parametrize(("k_n", "speed", "allowed"), SOFT)
def test_a_contact_that_turns_as_the_grains_pass_is_as_good_at_ten_steps_as_at_fifty(k_n, speed, allowed, e):
    worst = {}
    for timing, steps in ((ContactTiming.EXACT, 10.0), (ContactTiming.AT_STEPS, 50.0)):
        law = ContactLaw(
            k_n=k_n, k_s=0.0, mu=0.0, zeta_n=collision.zeta_for_restitution(e, False), timing=timing
        )
        m = float(scene([[0.0, 0.0, D]], D, contact=law)[0].m[0])
        dt = collision.contact_time(law.zeta_n, math.sqrt(k_n / m), False) / steps
        true = orbit(0.7, speed, law, m)
        errors = [passing_by(0.7, speed, law, dt, k / 8) - true for k in range(8)]
        worst[timing] = np.hypot(*np.transpose(errors)).max() / speed
    assert worst[ContactTiming.EXACT] < allowed
    if e == 0.7:  # nearly without damping a first touch at a step does no harm
        assert worst[ContactTiming.EXACT] < worst[ContactTiming.AT_STEPS]


def test_a_grain_that_leaves_faster_than_the_list_reaches_has_its_contact_closed():
    # The contact ends within a step and is closed in the next: by then the pair is 0.01 d apart.
    soft = {
        "build.height": "0.000192593 m", "build.height_step": "9.62964e-06 m", "build.speed": "2 m/s",
        "contact.parting": "tension", "contact.stiffness": "0.01 N/cm", "stop.time": "0.00784906 s",
        "record.frames": "0.00784906 s", "time.step": "9.62964019714e-05 s",
    }  # fmt: skip
    built = build(paper_run("drop", soft, 1).read())
    engine = CpuEngine()
    engine.load(built.scene, built.state)
    assert not engine.advance(round(0.00784906 / built.scene.dt))
    assert len(engine.state().contacts.i) == 0


@pytest.mark.parametrize("partner", ["plane", "grain"])
def test_a_grain_pushed_off_from_rest_meets_what_it_touches_within_the_first_step(partner):
    gate, back = ("gate", (0.499 * D, 0, 0), (-1, 0, 0)), ("back", (-0.5 * D, 0, 0), (1, 0, 0))
    planes, fixed_grains = ([gate, back], None) if partner == "plane" else ([gate], [[-D, 0.0, 0.0]])
    moves = []
    for speed in (0.0, -1.0e-3):  # at rest, nothing tells before the kick how far a grain will go
        fixed, first = scene(
            [[0.0, 0.0, 0.0]], D, planes=planes, x_fixed=fixed_grains, v=[[speed, 0.0, 0.0]], gravity=0.0,
            allow_overlap=True, timing=ContactTiming.EXACT,
        )  # fmt: skip
        engine = CpuEngine()
        engine.load(fixed, first)
        engine.advance(1).raise_if_any()
        assert len(engine.state().contacts) == 2
        moves.append(engine.state().v[0, 0])
    assert moves[0] == pytest.approx(moves[1], rel=0.1)
